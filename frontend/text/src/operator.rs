//! Operators of a text: what stands between their words and their blocks.
//!
//! ```text
//! word  [set operation]  numbers  {
//!                        name number name number    in any order: an operator with names
//!                        [name] number              one number: with a label, or without
//! ```
//!
//! Operators of one word differ in the names of their numbers.

use super::block::{Begun, Head};
use super::expression::ExpressionPlace;
use super::lex::Token;
use super::state::Parser;
use jbt_model::combine::{CombinatorKind, SetOperation, Syntax};
use jbt_model::diagnostic::Diagnostic;
use jbt_model::field::{Field, FieldKind, FieldValue};
use jbt_model::report::clip;
use jbt_model::written::{FieldNumber, Written};

impl<'a> Parser<'a> {
    /// The operator that begins with the word of a kind, which has been taken.
    pub(super) fn combinator(&mut self, start: Token, first: CombinatorKind) -> Begun<'a> {
        if first.fields().is_empty() && !first.takes_one() {
            return self.block(start, Head::Combine(first));
        }
        let read = match (first.syntax(), first.fields()) {
            (Syntax::Named, _) => self.named_numbers(first.name()),
            (Syntax::Labelled | Syntax::Alone, [field]) => {
                if first.syntax() == Syntax::Labelled {
                    self.accept_word(field.name);
                }
                Some((first, vec![self.field_value(field.kind)]))
            }
            (Syntax::Labelled | Syntax::Alone, _) => unreachable!("without names there is one number"),
        };
        let head = match read {
            None => Head::Broken,
            Some((combinator, fields)) => {
                let written = Box::new(Written::Combine { combinator, fields });
                if combinator.takes_one() { Head::Unary(written) } else { Head::Operator(written) }
            }
        };
        self.block(start, head)
    }

    /// The set operation of an operator that has one, then its numbers behind their names, which tell the
    /// kind among those of a word. Nothing after an error.
    fn named_numbers(&mut self, word: &str) -> Option<(CombinatorKind, Vec<FieldNumber>)> {
        let mut kinds: Vec<CombinatorKind> = CombinatorKind::named(word).collect();
        let mut values: Vec<(&'static str, FieldNumber)> = Vec::new();
        if let Some(field) = kinds[0].fields().iter().find(|field| is_set(field)) {
            let Some(place) = SetOperation::WORDS.iter().position(|set| self.accept_word(set)) else {
                self.expected_at(self.peek(), "expected `union`, `intersection` or `difference`");
                return None;
            };
            values.push((field.name, FieldValue::Real(place as f64).into()));
        }
        while let Some((token, field)) = self.next_named(&kinds) {
            if values.iter().any(|(name, _)| *name == field.name) {
                self.report(|| {
                    Diagnostic::error(Some(token.span()), format!("a second `{}`", field.name))
                        .expected("expected it once")
                });
            }
            let value = match field.kind {
                FieldKind::Whole { .. } => self.whole(word, field.name)?,
                kind => self.field_value(kind),
            };
            values.push((field.name, value));
            kinds.retain(|kind| kind.fields().iter().any(|other| other.name == field.name));
        }
        let value = |field: &Field| {
            let written = values.iter().find(|(name, _)| *name == field.name).map(|(_, value)| value.clone());
            written.or_else(|| field.default.clone().map(FieldNumber::from))
        };
        let complete = |kind: &CombinatorKind| kind.fields().iter().map(value).collect::<Option<Vec<_>>>();
        let found = kinds.iter().find_map(|kind| Some((*kind, complete(kind)?)));
        if found.is_none() {
            let names: Vec<&str> = kinds[0].fields().iter().filter(|f| !is_set(f)).map(|f| f.name).collect();
            let numbers = names.join("` and a number, `");
            self.expected_at(self.peek(), &format!("expected `{word} {numbers}` and a number"));
        }
        found
    }

    /// The name that is next, if it is that of a number of one of these kinds, which is taken.
    fn next_named(&mut self, kinds: &[CombinatorKind]) -> Option<(Token, &'static Field)> {
        let word = self.peek_word()?;
        let mut fields = kinds.iter().flat_map(|kind| kind.fields()).filter(|field| !is_set(field));
        let field = fields.find(|field| field.name == word)?;
        Some((self.next(), field))
    }

    /// A whole number that depends on no parameter: it selects code.
    fn whole(&mut self, word: &str, name: &str) -> Option<FieldNumber> {
        let value = self.expression(ExpressionPlace::Alone);
        let (number, span) = (value.number, value.span);
        let whole = number.value();
        if !number.depends_on_parameters() && whole.fract() == 0.0 && (0.0..=1e9).contains(&whole) {
            return Some(FieldNumber::Real(number));
        }
        if !whole.is_nan() || number.depends_on_parameters() {
            self.report(|| {
                let what = format!("the `{name}` of the {} is no whole number", clip(word));
                Diagnostic::error(Some(span), what)
                    .expected("expected a whole number that depends on no parameter")
            });
        }
        None
    }
}

/// Whether a parameter is written as a set operation, in front of the numbers.
fn is_set(field: &Field) -> bool {
    field.kind == FieldKind::Choice(SetOperation::WORDS)
}
