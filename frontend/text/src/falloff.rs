//! The falloff of a primitive: its name, and a block with its parameters where it has any.

use super::lex::{Token, TokenKind};
use super::primitive::{Slots, missing_error};
use super::state::Parser;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::falloff::FalloffKind;
use jbt_model::report::{clip, nearest};
use jbt_model::word::is_statement;
use jbt_model::written::WrittenFalloff;

impl Parser<'_> {
    /// What follows the word `falloff`, of a node or of a primitive. Nothing after an error.
    pub(super) fn falloff(&mut self, is_node: bool) -> Option<WrittenFalloff> {
        let token = self.peek();
        let names = || FalloffKind::ALL.iter().map(|kind| kind.name());
        let expected = || format!("expected one of {}", names().collect::<Vec<_>>().join(", "));
        let Some(word) = self.peek_word() else {
            self.expected_at(token, &expected());
            return None;
        };
        self.next();
        let Some(kind) = FalloffKind::named(word) else {
            self.report(|| {
                let near = nearest(word, names()).map(|near| format!("perhaps `{near}`"));
                Diagnostic::error(Some(token.span()), format!("no falloff is called `{}`", clip(word)))
                    .expected(near.unwrap_or_else(expected))
            });
            if self.peek().is(b'{') {
                self.skip_block();
            }
            return None;
        };
        // Behind a node's falloff without parameters stands the block of the node.
        if is_node && kind.fields().is_empty() {
            return Some(WrittenFalloff::new(kind, Vec::new()));
        }
        self.falloff_of(kind, token)
    }

    /// The parameters of a falloff whose word, `token`, has just been taken. Nothing after an error.
    pub(super) fn falloff_of(&mut self, kind: FalloffKind, token: Token) -> Option<WrittenFalloff> {
        let mut slots = Slots::new(kind.fields());
        if self.peek().is(b'{') && !self.falloff_block(kind, &mut slots) {
            return None;
        }
        let missing = slots.missing();
        if !missing.is_empty() {
            self.report(|| missing_error(token.span(), kind.name(), &missing));
        }
        slots.values().map(|fields| WrittenFalloff::new(kind, fields))
    }

    /// A block of parameters: in any order, each once. False if it does not end.
    fn falloff_block(&mut self, kind: FalloffKind, slots: &mut Slots<'_>) -> bool {
        let open = self.next();
        loop {
            let token = self.peek();
            match token.kind {
                TokenKind::Mark(b'}') => {
                    self.report_again();
                    self.next();
                    return true;
                }
                TokenKind::Word if !is_statement(self.text(token)) => {
                    self.next();
                    let word = self.text(token);
                    match kind.fields().iter().position(|field| field.name == word) {
                        Some(index) => {
                            self.report_again();
                            self.slot(slots, index, token);
                        }
                        None if self.is_muted() => {}
                        None => self.unknown_falloff_field(kind, word, token.span()),
                    }
                }
                TokenKind::Word | TokenKind::End => {
                    self.unclosed(open.start as u32, token);
                    return false;
                }
                TokenKind::Mark(_) | TokenKind::Number | TokenKind::Quoted | TokenKind::Unknown => {
                    self.expected_at(token, "expected a parameter or `}`");
                    self.skip_token();
                }
            }
        }
    }

    fn unknown_falloff_field(&mut self, kind: FalloffKind, word: &str, span: Span) {
        self.report_and_mute(|| {
            let known = || kind.fields().iter().map(|field| field.name);
            let message = format!("`{}` has no parameter `{}`", kind.name(), clip(word));
            let error = Diagnostic::error(Some(span), message);
            match nearest(word, known()) {
                Some(near) => error.expected(format!("perhaps `{near}`")),
                None if kind.fields().is_empty() => error.expected("expected `}`"),
                None => error.expected(format!("it has {}", known().collect::<Vec<_>>().join(", "))),
            }
        });
    }
}
