//! Comments of a text: those in front of statements stay with them.

use super::lex::TokenKind;
use super::part::PART;
use super::state::Parser;
use jbt_model::diagnostic::escape;
use jbt_model::word::is_statement;

/// What a comment in front of the node of the model is kept by.
pub(super) const ROOT: &str = "root";
/// The same for one behind `jbt 1`, and for one at the end of the text.
pub(super) const HEAD: &str = "head";
pub(super) const END: &str = "end";

/// The comment in the blanks in front of a statement: its lines, each with `#`, and empty lines between them.
/// What stands behind something on its line is no part of it.
fn comment_of(gap: &str, is_start: bool) -> Option<String> {
    if !gap.contains(['#', '/']) {
        return None;
    }
    let gap = gap.replace("\r\n", "\n").replace('\r', "\n");
    let lines = gap.split('\n').skip(usize::from(!is_start));
    let mut kept: Vec<String> = Vec::new();
    for line in lines {
        let line = line.trim();
        let words = line.strip_prefix('#').or_else(|| line.strip_prefix("//"));
        match words {
            Some(words) => kept.push(escape(&format!("#{words}"))),
            None if kept.last().is_some_and(|last| !last.is_empty()) => kept.push(String::new()),
            None => {}
        }
    }
    while kept.last().is_some_and(String::is_empty) {
        kept.pop();
    }
    (!kept.is_empty()).then(|| kept.join("\n"))
}

impl Parser<'_> {
    /// Keeps the comment in front of the statement that is next; `is_first`: it stands behind the head.
    pub(super) fn keep_comment(&mut self, is_first: bool) {
        let token = self.peek();
        let gap = self.lexer.text(self.previous_end(), token.start).unwrap_or_default();
        let Some(comment) = comment_of(gap, self.previous_end() == self.lexer.start()) else { return };
        if self.is_included() {
            return;
        }
        if token.kind == TokenKind::End {
            self.comments.insert(END.to_owned(), comment.into());
            return;
        }
        let word = self.peek_word().unwrap_or_default();
        let name = self.peek_behind();
        let key = match word {
            "" => return,
            _ if name.is(b':') => ROOT.to_owned(),
            // They are printed behind parameters, and this stays where the head ends.
            "iso" | "origin" | "orientation" | "attribute" if is_first => HEAD.to_owned(),
            _ if self.begins_style(word) => format!("{word} {}", self.text(name)),
            _ if self.begins_definition(word) => return,
            _ if self.begins_part(word) => format!("{PART} {}", self.part_name()),
            "jbt" | "iso" | "origin" | "orientation" => word.to_owned(),
            _ if is_statement(word) && name.kind == TokenKind::Word => format!("{word} {}", self.text(name)),
            _ => ROOT.to_owned(),
        };
        self.comments.insert(key, comment.into());
    }
}
