//! Parts of a text: solids of their own, with names.
//!
//! ```text
//! part "hub" { cylinder { .. } }
//! part "rim" { torus { .. } }
//! ```

use super::lex::{Token, TokenKind};
use super::state::Parser;
use jbt_model::combine::{Combinator, Union};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::clip;
use jbt_model::tree::Tree;
use jbt_model::word::{is_identifier, is_statement, normalized};

/// The word for a part, in front of its name in quotes.
pub(super) const PART: &str = "part";

impl<'a> Parser<'a> {
    /// Whether the word that is next begins a part. Without quotes behind it, it is a name like any other.
    pub(super) fn begins_part(&self, word: &str) -> bool {
        word == PART && self.peek_behind().kind == TokenKind::Quoted
    }

    /// The name behind the word that is next.
    pub(super) fn part_name(&self) -> String {
        normalized(self.text(self.peek_behind()).trim_matches('"')).into_owned()
    }

    /// `part "NAME" { nodes }`.
    pub(super) fn part_statement(&mut self, start: Token) {
        let name = self.part_name();
        self.next();
        let span = Span::new(start.start, self.next().end);
        if !is_identifier(&name) {
            self.report(|| {
                Diagnostic::error(Some(span), format!("a part is called `{}`", clip(&name)))
                    .expected("expected letters, digits and underscores, beginning with a letter")
            });
        } else if self.parts.iter().any(|part| part.node().name() == Some(&name)) {
            self.report(|| Diagnostic::error(Some(span), format!("a second part `{}`", clip(&name))));
        } else if self.is_included() {
            self.report(|| {
                Diagnostic::error(Some(span), "a file that is included has a part")
                    .expected("expected parts in the scene's own text")
            });
        }
        self.count_node(span);
        let Some(open) = self.open() else { return };
        let solids = self.nodes_of_part(open);
        if solids.is_empty() {
            self.report(|| {
                Diagnostic::error(Some(span), format!("the part `{}` has no node", clip(&name)))
                    .expected("expected one, or `empty`")
            });
        }
        self.parts.push(Tree::part_of(&name, solids, Some(span)));
    }

    /// The nodes up to the brace that ends a part.
    fn nodes_of_part(&mut self, open: Token) -> Vec<Tree> {
        let mut solids = Vec::new();
        loop {
            let token = self.peek();
            let word = self.peek_word();
            match token.kind {
                TokenKind::Mark(b'}') => {
                    self.report_again();
                    self.next();
                    return solids;
                }
                TokenKind::End => {
                    self.unclosed(open.start as u32, token);
                    return solids;
                }
                TokenKind::Word if !word.is_some_and(|word| self.ends_part(word)) => {
                    solids.extend(self.nodes());
                }
                TokenKind::Word
                | TokenKind::Mark(_)
                | TokenKind::Number
                | TokenKind::Quoted
                | TokenKind::Unknown => {
                    self.expected_at(token, "expected a node or `}`");
                    self.skip_token();
                }
            }
        }
    }

    /// Whether the word that is next begins a statement.
    fn ends_part(&self, word: &str) -> bool {
        let begins =
            is_statement(word) || self.begins_part(word) || word != "include" && self.begins_definition(word);
        begins && !self.begins_named()
    }

    /// The union of the parts, if there are some.
    pub(super) fn root_of_parts(&mut self) {
        let parts = std::mem::take(&mut self.parts);
        let Some(span) = parts.first().and_then(|part| part.node().span()) else { return };
        if let Some(root) = &self.root {
            let at = root.node().span().unwrap_or(span);
            self.report(|| {
                Diagnostic::error(Some(at), "a node beside parts")
                    .expected("expected it in a part: part \"body\" { .. }")
            });
        }
        self.root = Some(Tree::at(span, Combinator::from(Union {}), parts));
    }
}
