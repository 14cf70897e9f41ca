//! Files that a scene includes: each is read once, where it is first named. What it defines has its name from
//! then on, and its node is a node wherever the file is named again.

use std::sync::Arc;

use jbt_ir::limits::MAX_INCLUDE_DEPTH;

use super::known::Included;
use crate::files::NamedFile;
use crate::lex::{TextPlace, Token, TokenKind};
use crate::state::Parser;
use crate::texts::TextFile;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::label::LabelCall;
use jbt_model::report::clip;
use jbt_model::tree::Tree;
use jbt_model::word::normalized;

impl<'a> Parser<'a> {
    /// Whether a word that has just been taken begins a file where a node stands.
    pub(crate) fn is_include(&self, word: &str) -> bool {
        word == super::definition::INCLUDE
            && self.peek().kind == TokenKind::Quoted
            && self.group(word).is_none()
    }

    /// The node of a file whose word, `start`, has just been taken.
    pub(crate) fn include_node(&mut self, start: Token) -> Tree {
        let errors = self.report.count();
        let root = self.include(start);
        if root.is_none() && self.report.count() == errors {
            let span = Span::new(start.start, self.previous_end());
            self.report(|| {
                Diagnostic::error(Some(span), "this file has no node")
                    .expected("expected a scene; what only defines names stands outside of all nodes")
            });
        }
        root.unwrap_or_else(|| self.broken.clone())
    }

    /// Reads the file whose name is next, unless it has been read, and gives its node.
    pub(super) fn include(&mut self, start: Token) -> Option<Tree> {
        let token = self.next();
        let name = self.text(token).trim_matches('"');
        self.program.has_expanded = true;
        let file = self.named_file(name, token, "include")?;
        if let Some(at) = self.program.open.iter().position(|(identity, _)| *identity == file.identity) {
            let paths = self.program.open[at..].iter().map(|(_, path)| path.as_str()).chain([&*file.path]);
            let circle: Vec<&str> = paths.collect();
            let message = format!("`{}` includes itself", clip(&file.path));
            let help = format!("the circle is {}", circle.join(", "));
            self.report(|| Diagnostic::error(Some(token.span()), message).expected(help));
            return None;
        }
        if let Some(known) = self.program.included.get(&file.identity) {
            return known.root.clone();
        }
        if self.program.open.len() == MAX_INCLUDE_DEPTH {
            let message = format!("files include each other more than {MAX_INCLUDE_DEPTH} deep");
            self.give_up(Diagnostic::limit(Some(token.span()), message));
            return None;
        }
        let text = self.scene_text(&file, token)?;
        let span = Span::new(start.start, token.end);
        let root = self.read_included(text, span);
        self.program.included.insert(file.identity.clone(), Included { root: root.clone() });
        root
    }

    /// The file of a name; nothing after a message, in which no word of the file stands.
    pub(crate) fn named_file(&mut self, name: &str, token: Token, what: &str) -> Option<Arc<NamedFile>> {
        let from = self.program.open.last().map(|(_, path)| path.clone());
        // Texts count to what is expanded.
        let most = if what == "include" { self.program.left } else { usize::MAX };
        match self.program.files.read_at_most(name, from.as_deref(), most) {
            Ok(file) => Some(file),
            Err(error) => {
                let message = format!("cannot {what} `{}`: {error}", clip(name));
                let span = Some(token.span());
                self.report(|| {
                    let made = if error.is_limit() {
                        Diagnostic::limit(span, message)
                    } else {
                        Diagnostic::error(span, message)
                    };
                    match error.help() {
                        Some(help) => made.expected(help),
                        None => made,
                    }
                });
                None
            }
        }
    }

    /// The text of a file, if it is a scene. What is no scene is not quoted.
    fn scene_text(&mut self, file: &Arc<NamedFile>, token: Token) -> Option<&'a TextFile> {
        let text = std::str::from_utf8(&file.bytes).ok().map(|text| normalized(text).into_owned());
        let text = text.filter(|text| {
            let place = TextPlace::start(text, 0);
            let mut lexer = crate::lex::Lexer::new(text);
            lexer.jump(place);
            let first = lexer.next();
            lexer.text(first.start, first.end) == Some("jbt")
        });
        let Some(text) = text else {
            let message = format!("`{}` is no scene", clip(&file.path));
            self.report(|| {
                Diagnostic::error(Some(token.span()), message)
                    .expected("expected a text that begins with `jbt 1`")
            });
            return None;
        };
        self.program.left = self.program.left.saturating_sub(text.len());
        self.program.texts.add(Arc::clone(file), text)
    }

    /// Reads a text from its first word to its end, and goes on where the cursor is.
    fn read_included(&mut self, file: &'a TextFile, span: Span) -> Option<Tree> {
        let place = self.lexer.place();
        let visible = std::mem::replace(&mut self.program.visible, self.program.locals.len());
        let around = self.program.calls.take();
        let call =
            LabelCall { name: file.file.path.as_str().into(), turn: None, span, above: around.clone() };
        self.program.calls = Some(Arc::new(call));
        let (root, muted) = (self.root.take(), self.muted);
        let (ended, scope) = (self.ended, self.scope.take());
        self.program.open.push((file.file.identity.clone(), file.file.path.clone()));
        (self.muted, self.ended) = (false, false);
        self.lexer.jump(TextPlace::start(&file.text, file.base));
        self.file();
        self.program.open.pop();
        self.program.calls = around;
        self.program.visible = visible;
        (self.muted, self.ended, self.scope) = (muted, ended, scope);
        if self.stopped {
            self.lexer.finish();
        } else {
            self.lexer.jump(place);
        }
        std::mem::replace(&mut self.root, root)
    }
}
