//! Values: numbers, vectors, colours, lists, and what has one of them as its name.
//!
//! ```text
//! let gap = 0.3                     a number
//! let path = [(0 0 0) (1 0 0.5)]    a list of vectors
//! path[1]   gap * 2   "#ff8800"   srgb(1 0.5 0)   [1 2 3]   use hub
//! ```

use jbt_ir::limits::{MAX_LIST_DEPTH, MAX_SKELETON_POINTS};

use super::known::{COUNT, Value};
use crate::expression::{ExpressionPlace, ParsedOperand};
use crate::lex::{Token, TokenKind};
use crate::state::Parser;
use crate::value::Elements;
use crate::words::{NAMES_FIRST, constant};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::function::Function;
use jbt_model::number::Number;
use jbt_model::report::clip;
use jbt_model::word::is_statement;

impl<'a> Parser<'a> {
    /// Whether what is next is a value and no node.
    pub(super) fn begins_plain(&self) -> bool {
        let token = self.peek();
        match token.kind {
            TokenKind::Number | TokenKind::Quoted => true,
            TokenKind::Mark(mark) => matches!(mark, b'(' | b'[' | b'-' | b'+'),
            TokenKind::Word => {
                let word = self.text(token);
                let called = self.peek_behind().is(b'(');
                // A name in front of a node.
                if is_statement(word) || self.peek_behind().is(b':') {
                    return false;
                }
                if called && (Function::named(word).is_some() || word == "srgb" || word == COUNT) {
                    return true;
                }
                let bound = self.program.value(word).is_some() || self.parameter(word).is_some();
                // What has such a name had it before these words began nodes.
                let is_node = self.begins_node(word) && !(bound && NAMES_FIRST.contains(&word));
                !is_node && (bound || constant(word).is_some())
            }
            TokenKind::Unknown | TokenKind::End => false,
        }
    }

    /// The value that is next; nothing, after a message, if there is none.
    pub(crate) fn value(&mut self) -> Option<Value> {
        self.value_in(ExpressionPlace::Alone, 0)
    }

    fn value_in(&mut self, place: ExpressionPlace, depth: usize) -> Option<Value> {
        let token = self.peek();
        if token.is(b'[') {
            return self.list_value(depth);
        }
        if token.kind == TokenKind::Quoted || self.begins_srgb() {
            return self.color(None).map(|all| Value::Numbers(all.numbers.into()));
        }
        if token.is(b'(') {
            let all = self.number_or_elements_in(place)?;
            return Some(match &all.numbers[..] {
                [number] if all.count == 1 => Value::Number(number.clone()),
                _ => Value::Numbers(all.numbers.into()),
            });
        }
        if self.peek_word() == Some("use") {
            self.next();
            return Some(Value::Tree(self.use_node()));
        }
        match self.bound(place)? {
            Some((value, _)) => Some(value),
            None => {
                let number = self.expression(place).number;
                (!self.is_muted()).then_some(Value::Number(number))
            }
        }
    }

    /// A list whose `[` is next.
    fn list_value(&mut self, depth: usize) -> Option<Value> {
        let open = self.next();
        if depth == MAX_LIST_DEPTH {
            let message = format!("lists stand {MAX_LIST_DEPTH} deep in each other at most");
            self.give_up(Diagnostic::limit(Some(open.span()), message));
            return None;
        }
        let mut list = Vec::new();
        while self.accept(b']').is_none() {
            let token = self.peek();
            if token.kind == TokenKind::End || token.is(b'{') || token.is(b'}') {
                self.report_and_mute(|| Diagnostic::error(Some(open.span()), "this `[` is not closed"));
                return None;
            }
            if !list.is_empty() {
                self.accept(b',');
            }
            list.push(self.value_in(ExpressionPlace::Element, depth + 1)?);
            if list.len() > MAX_SKELETON_POINTS {
                let message = format!("a list has {MAX_SKELETON_POINTS} elements at most");
                self.give_up(Diagnostic::limit(Some(open.span()), message));
                return None;
            }
        }
        Some(Value::List(list.into()))
    }

    /// A name that stands for what is no number, with what picks elements of it; the place of all. An element
    /// that is a number may be the first operand of an expression. Outer nothing after an error; inner
    /// nothing if no such name is next.
    fn bound(&mut self, place: ExpressionPlace) -> Option<Option<(Value, Span)>> {
        let token = self.peek();
        let Some(mut value) = self.list_named(token) else { return Some(None) };
        self.next();
        while self.peek().is(b'[') && self.peek().start == self.previous_end() {
            if value.count().is_none() {
                break;
            }
            self.next();
            let index = self.expression(ExpressionPlace::Alone);
            if self.accept(b']').is_none() {
                self.expected_at(self.peek(), "expected `]` behind the place of an element");
                return None;
            }
            value = self.element(&value, &index)?;
        }
        let span = Span::new(token.start, self.previous_end());
        if let Value::Number(number) = &value {
            let first = ParsedOperand { number: number.clone(), span };
            let operand = self.expression_from(place, &first);
            return (!self.is_muted()).then_some(Some((Value::Number(operand.number), operand.span)));
        }
        Some(Some((value, span)))
    }

    /// What a word stands for, if that is no number.
    fn list_named(&self, token: Token) -> Option<Value> {
        if token.kind != TokenKind::Word {
            return None;
        }
        match self.program.value(self.text(token))? {
            Value::Number(_) => None,
            value => Some(value.clone()),
        }
    }

    /// What has elements and is called by this word.
    pub(crate) fn elements_named(&self, word: &str) -> Option<&Value> {
        self.program.value(word).filter(|value| value.count().is_some())
    }

    /// The element of a place from 0; nothing, after a message, if there is none.
    pub(crate) fn element(&mut self, all: &Value, index: &ParsedOperand) -> Option<Value> {
        if !self.decides(&index.number, index.span) {
            self.mute();
            return None;
        }
        let (place, count) = (index.number.value(), all.count().unwrap_or_default());
        if place.fract() == 0.0 && place >= 0.0 && place < count as f64 {
            return all.element(place as usize);
        }
        if !place.is_nan() {
            self.report(|| {
                Diagnostic::error(Some(index.span), format!("there is no element {place} of {count}"))
                    .expected("expected a whole number from 0 on")
            });
        }
        self.mute();
        None
    }

    /// The number of elements of what is named next, in parentheses, behind the word `count`.
    pub(crate) fn element_count(&mut self) -> Option<f64> {
        self.accept(b'(')?;
        let token = self.peek();
        let count = self.peek_word().and_then(|word| self.elements_named(word)).and_then(Value::count);
        if count.is_none() {
            self.expected_at(token, "expected the name of a list");
        } else {
            self.next();
            if self.accept(b')').is_none() {
                self.expected_at(self.peek(), "expected `)`");
            }
        }
        count.map(|count| count as f64)
    }

    /// The numbers of a name that stands for a vector, if one is next.
    pub(crate) fn bound_elements(&mut self) -> Option<Elements> {
        let token = self.peek();
        let value = self.list_named(token)?;
        let (value, span) = self.bound(ExpressionPlace::Alone)?.unwrap_or((value, token.span()));
        match value {
            Value::Numbers(numbers) if !self.charge_elements(numbers.len(), span) => None,
            Value::Numbers(numbers) => {
                Some(Elements { count: numbers.len(), numbers: numbers.to_vec(), span })
            }
            Value::Number(number) => Some(Elements { count: 1, numbers: vec![number], span }),
            Value::List(_) | Value::Tree(_) => {
                let kind = value.kind();
                self.report(|| Diagnostic::error(Some(span), format!("this is {kind}, and no vector")));
                self.mute();
                None
            }
        }
    }

    /// The elements of a name that stands for a list, if one is next: each as so many numbers. NaNs after an
    /// error.
    pub(crate) fn bound_list(&mut self, width: usize) -> Option<Vec<Vec<Number>>> {
        let token = self.peek();
        self.list_named(token)?;
        let (value, span) = self.bound(ExpressionPlace::Alone)??;
        if !self.charge_elements(value.count().unwrap_or_default(), span) {
            return Some(Vec::new());
        }
        let elements = value.elements().unwrap_or_default();
        let numbers = |value: &Value| match value {
            Value::Number(number) => vec![number.clone()],
            Value::Numbers(numbers) => numbers.to_vec(),
            Value::List(_) | Value::Tree(_) => Vec::new(),
        };
        let all: Vec<Vec<Number>> = elements.iter().map(numbers).collect();
        if let Some(place) = all.iter().position(|numbers| numbers.len() != width) {
            let kind = elements[place].kind();
            let plural = if width == 1 { "" } else { "s" };
            self.report(|| {
                Diagnostic::error(Some(span), format!("element {place} of this list is {kind}"))
                    .expected(format!("expected {width} number{plural} in each"))
            });
            self.mute();
            return Some(vec![vec![f64::NAN.into(); width]]);
        }
        Some(all)
    }

    /// The message about a name that stands for something else than a number.
    pub(crate) fn no_number(&mut self, word: &str, span: Span) -> bool {
        let Some(kind) = self.program.value(word).map(Value::kind) else { return false };
        self.report_and_mute(|| {
            let help = match kind {
                "a node" => format!("expected a number; a node is `use {}`", clip(word)),
                _ => format!("expected a number, as {}[0]", clip(word)),
            };
            Diagnostic::error(Some(span), format!("`{}` is {kind}", clip(word))).expected(help)
        });
        true
    }
}
