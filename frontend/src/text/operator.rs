//! Operators of a text that have numbers, or one child: what stands before their blocks.

use super::block::{Begun, Head};
use super::expression::Place;
use super::lex::Token;
use super::state::Parser;
use crate::combine::{Combinator, Family, SetOperation};
use crate::diagnostic::{Diagnostic, Span};
use crate::number::Number;
use crate::written::Written;

impl Parser<'_> {
    /// The operator that begins with one of [`WORDS`].
    pub(super) fn operator_head(&mut self, start: Token, word: &str) -> Begun {
        let smooth = |set: SetOperation| Combinator::Smooth(set, 0.0);
        match word {
            "smooth_union" => self.with_one(start, smooth(SetOperation::Union), "width"),
            "smooth_intersection" => self.with_one(start, smooth(SetOperation::Intersection), "width"),
            "smooth_difference" => self.with_one(start, smooth(SetOperation::Difference), "width"),
            "rfunction" => self.rfunction(start),
            "complement" => self.one_child(start, Combinator::Complement, Vec::new()),
            "clamp" => self.clamp(start),
            "shell" => {
                let thickness = self.labelled("thickness");
                self.one_child(start, Combinator::Shell(0.0), vec![thickness])
            }
            _ => {
                let by = self.labelled("by");
                self.one_child(start, Combinator::Offset(0.0), vec![by])
            }
        }
    }

    /// `ricci` and its exponent: the word has been read.
    pub(super) fn ricci(&mut self, start: Token) -> Begun {
        let exponent = self.expression(Place::Alone).number;
        self.many_children(start, Combinator::Ricci(0.0), vec![exponent])
    }

    /// A number that may have its name before it.
    fn labelled(&mut self, label: &str) -> Number {
        self.accept_word(label);
        self.expression(Place::Alone).number
    }

    fn with_one(&mut self, start: Token, combinator: Combinator, label: &str) -> Begun {
        let number = self.labelled(label);
        self.many_children(start, combinator, vec![number])
    }

    fn many_children(&mut self, start: Token, combinator: Combinator, numbers: Vec<Number>) -> Begun {
        let written = Written::Combine { combinator, numbers };
        self.block(start, Head::Operator(Box::new(written)))
    }

    fn one_child(&mut self, start: Token, combinator: Combinator, numbers: Vec<Number>) -> Begun {
        let written = Written::Combine { combinator, numbers };
        self.block(start, Head::Unary(Box::new(written)))
    }

    /// `clamp low A high B`, in either order.
    fn clamp(&mut self, start: Token) -> Begun {
        let (mut low, mut high) = (None, None);
        while let Some(word @ ("low" | "high")) = self.peek_word() {
            let token = self.next();
            let end = if word == "low" { &mut low } else { &mut high };
            if end.replace(self.expression(Place::Alone).number).is_some() {
                self.report(|| {
                    Diagnostic::error(Some(token.span()), format!("a second `{word}`"))
                        .expected("expected it once")
                });
            }
        }
        let (Some(low), Some(high)) = (low, high) else {
            self.expected_at(self.peek(), "expected `clamp low` and a number, `high` and a number");
            return self.block(start, Head::Broken);
        };
        self.one_child(start, Combinator::Clamp { low: 0.0, high: 0.0 }, vec![low, high])
    }

    /// `rfunction union alpha 0`: the set operation, then a family. R_0 if there is none.
    fn rfunction(&mut self, start: Token) -> Begun {
        let Some(set) = SetOperation::ALL.into_iter().find(|set| self.accept_word(set.name())) else {
            self.expected_at(self.peek(), "expected `union`, `intersection` or `difference`");
            return self.block(start, Head::Broken);
        };
        if self.accept_word("order") {
            return match self.order() {
                Some(order) => {
                    self.many_children(start, Combinator::RFunction(set, Family::Order(order)), Vec::new())
                }
                None => self.block(start, Head::Broken),
            };
        }
        let (family, number) = if self.accept_word("power") {
            (Family::Power(0.0), self.expression(Place::Alone).number)
        } else if self.accept_word("alpha") {
            (Family::Alpha(0.0), self.expression(Place::Alone).number)
        } else {
            (Family::Alpha(0.0), 0.0.into())
        };
        self.many_children(start, Combinator::RFunction(set, family), vec![number])
    }

    /// A whole number that follows no parameter: it selects code.
    fn order(&mut self) -> Option<u32> {
        let value = self.expression(Place::Alone);
        let (number, span): (Number, Span) = (value.number, value.span);
        let order = number.value();
        if !number.follows() && order.fract() == 0.0 && (0.0..=1e9).contains(&order) {
            return Some(order as u32);
        }
        if !order.is_nan() || number.follows() {
            self.report(|| {
                Diagnostic::error(Some(span), "the order of an R-function is no whole number")
                    .expected("expected a whole number that follows no parameter")
            });
        }
        None
    }
}
