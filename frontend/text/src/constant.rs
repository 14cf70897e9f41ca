//! Constants of leaves.
//!
//! ```text
//! constant material "steel" { child }
//! constant part 17 { child }                                 a whole number, or an expression that is one
//! ```

use super::expression::ExpressionPlace;
use super::lex::TokenKind;
use super::state::Parser;
use jbt_model::attribute::Precedence;
use jbt_model::constant::{LARGEST_CONSTANT, LeafConstant};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::parameter::Fixture;
use jbt_model::word::normalized;
use jbt_model::written::Written;

impl Parser<'_> {
    /// A constant whose word has just been taken; nothing after an error.
    pub(super) fn constant(&mut self, precedence: Precedence) -> Option<Written> {
        let Some(name) = self.peek_word() else {
            self.expected_at(self.peek(), "expected the name of a constant");
            return None;
        };
        self.next();
        let value = self.constant_value()?;
        Some(Written::Constant { name: normalized(name).into(), value, precedence })
    }

    /// Whether a number is what its text says. From the largest constant on, numbers that are not written out
    /// may have been rounded.
    fn is_exact(&self, value: f64, span: Span) -> bool {
        if value.abs() < LARGEST_CONSTANT as f64 {
            return true;
        }
        let written = self.source(span).trim_start_matches(['-', ' ']);
        written.parse() == Ok(LARGEST_CONSTANT)
    }

    /// Text in quotes, or a whole number; nothing after an error.
    fn constant_value(&mut self) -> Option<LeafConstant> {
        let token = self.peek();
        if token.kind == TokenKind::Quoted {
            self.next();
            return Some(self.text(token).trim_matches('"').into());
        }
        if token.is(b'{') {
            self.expected_at(token, "expected text in quotes, or a whole number");
            return None;
        }
        let number = self.expression(ExpressionPlace::Alone).number;
        let span = Span::new(token.start, self.previous_end());
        self.declares(Fixture::Declaration, &number, span);
        let value = number.value();
        if value.is_nan() {
            return None;
        }
        if value.fract() != 0.0 || !self.is_exact(value, span) {
            let is_large = value.abs() >= LARGEST_CONSTANT as f64;
            self.report(|| {
                let error = Diagnostic::error(Some(span), format!("a constant is {value}"));
                match is_large {
                    true => {
                        error.expected(format!("expected at most {LARGEST_CONSTANT} in magnitude, or text"))
                    }
                    false => error.expected("expected text in quotes, or a whole number"),
                }
            });
            return None;
        }
        Some(LeafConstant::Whole(value as i64))
    }
}
