//! The statements of a program: `def NAME(arguments) { .. }` and `include "FILE"`.

use std::cell::Cell;
use std::rc::Rc;

use jbt_ir::limits::MAX_ARGUMENTS;

use super::known::{ProgramDefinition, Value};
use crate::lex::{Token, TokenKind};
use crate::state::Parser;
use crate::words::is_builtin;
use crate::words::is_reserved;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::clip;
use jbt_model::word::STYLE;

/// The words of its statements.
const DEFINE: &str = "def";
pub(super) const INCLUDE: &str = "include";

impl<'a> Parser<'a> {
    /// Whether a word that is next begins a statement of a program. Words are not kept for it: what follows
    /// tells.
    pub(crate) fn begins_definition(&self, word: &str) -> bool {
        let next = self.peek_behind().kind;
        match word {
            DEFINE => next == TokenKind::Word && self.group(word).is_none(),
            INCLUDE => next == TokenKind::Quoted && self.group(word).is_none(),
            _ => self.begins_style(word),
        }
    }

    /// A statement whose word has just been taken.
    pub(crate) fn definition_statement(&mut self, word: &str, token: Token) {
        match word {
            INCLUDE => {
                self.include(token);
            }
            STYLE => self.style_statement(),
            _ => self.define_statement(),
        }
    }

    fn define_statement(&mut self) {
        let Some((name, span)) = self.name("definition") else { return };
        let arguments = self.argument_names();
        let open = self.peek();
        if !open.is(b'{') {
            self.expected_at(open, "expected `{` and what the definition stands for");
            return;
        }
        self.report_again();
        let end = self.block_end();
        self.next();
        let body = self.lexer.place();
        let length = end.saturating_sub(open.end);
        self.jump_behind(end);
        if self.stopped {
            return;
        }
        let Some(arguments) = arguments else { return };
        let taken = is_reserved(name) || is_builtin(name) || self.group(name).is_some();
        if taken {
            self.report(|| Diagnostic::error(Some(span), format!("`{name}` means something else already")));
        } else if self.program.defines(name) {
            self.report(|| Diagnostic::error(Some(span), format!("a second `def {}`", clip(name))));
        } else {
            let number = self.program.definitions.len();
            let (open, is_wrong) = (open.start as u32, Cell::new(false));
            let made = ProgramDefinition { name, span, number, arguments, body, open, length, is_wrong };
            self.program.definitions.insert(name, Rc::new(made));
        }
    }

    /// `( NAME [= VALUE] , .. )`; nothing after an error.
    fn argument_names(&mut self) -> Option<Vec<(&'a str, Option<Value>)>> {
        let mut all: Vec<(&str, Option<Value>)> = Vec::new();
        if self.accept(b'(').is_none() {
            self.expected_at(self.peek(), "expected the names of its arguments: ( .. )");
            return None;
        }
        while self.accept(b')').is_none() {
            if !all.is_empty() && self.accept(b',').is_none() {
                self.expected_at(self.peek(), "expected `,` or `)`");
                return None;
            }
            let (name, span) = self.name("argument")?;
            let default = if self.accept(b'=').is_some() { Some(self.value()?) } else { None };
            self.check_local(name, span);
            if all.iter().any(|(other, _)| *other == name) {
                self.report(|| Diagnostic::error(Some(span), format!("a second argument `{}`", clip(name))));
            } else if all.len() == MAX_ARGUMENTS {
                let message = format!("a definition has {MAX_ARGUMENTS} arguments at most");
                self.report(|| Diagnostic::limit(Some(span), message));
                return None;
            } else {
                all.push((name, default));
            }
        }
        Some(all)
    }

    /// An argument or a variable may be called like what is outside, and not like what computes.
    pub(super) fn check_local(&mut self, name: &str, span: Span) {
        if is_builtin(name) {
            self.report(|| Diagnostic::error(Some(span), format!("`{name}` means something else already")));
        }
    }

    /// The place behind the `}` that closes the block whose `{` is next. Where none does, that is told, and
    /// it is the end of the text.
    pub(super) fn block_end(&mut self) -> usize {
        let start = self.peek().start;
        if let Some(&end) = self.program.ends.get(&start) {
            return end;
        }
        let place = self.lexer.place();
        self.skip_block();
        let end = self.previous_end();
        self.lexer.jump(place);
        self.program.ends.insert(start, end);
        end
    }

    /// Goes on behind a place of the text that is being read.
    pub(super) fn jump_behind(&mut self, end: usize) {
        self.lexer.resume(end);
    }
}
