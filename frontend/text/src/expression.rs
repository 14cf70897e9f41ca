//! Numbers are expressions. They are evaluated while they are read, on two explicit stacks (Dijkstra 1961).
//!
//! ```text
//! operators from weak to strong:   + -    * /    unary -    ^ (to the right)
//! -2^2 = -(2^2)     2^-1 = 1/2     2^3^2 = 2^(3^2)
//! ```
//!
//! A number that could not be computed is NaN from there on, and is reported once: where it arose.
//!
//! What depends on parameters is written down as a formula besides. Both stacks meet the operands in the
//! order of the text, so the steps of the formula come out in postfix order, each operand's after those of
//! the operand before it.

use jbt_ir::limits::MAX_EXPRESSION_DEPTH;

use super::lex::{COMPARISON, Token, TokenKind};
use super::program::known::Value;
use super::state::Parser;
use jbt_model::diagnostic::{Diagnostic, Span};
pub use jbt_model::function::Function;
use jbt_model::number::{Binary, Number, NumberFormula, Step, Variable};
use jbt_model::report::clip;
use jbt_model::word::is_statement;

mod word;

/// What waits on the operator stack.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Waiting {
    Binary(Binary),
    Negate,
    Group,
    /// A function and the place of its first argument on the operand stack.
    Call(Function, u32),
    /// The place of an element in brackets, of a list with this number.
    Index(u32),
}

impl Waiting {
    /// How strongly it binds; groups do not bind.
    const fn strength(self) -> u8 {
        match self {
            Self::Binary(binary) => binary.strength(),
            Self::Negate => 3,
            Self::Group | Self::Call(..) | Self::Index(_) => 0,
        }
    }

    const fn is_open(self) -> bool {
        matches!(self, Self::Group | Self::Call(..) | Self::Index(_))
    }
}

/// A number and the text that it came from.
#[derive(Clone, Debug)]
pub(super) struct ParsedOperand {
    pub(super) number: Number,
    pub(super) span: Span,
}

/// An operand on the stack.
#[derive(Clone, Copy, Debug)]
struct StackedOperand {
    value: f64,
    span: Span,
    /// Where its steps begin in the list; they end where those of the next operand begin.
    first: u32,
    /// Whether it depends on a parameter; otherwise its only step is its value.
    depends: bool,
}

/// Where an expression stands, which decides where it ends.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum ExpressionPlace {
    /// By itself: it goes on as long as operators follow.
    Alone,
    /// Directly inside a vector: a `+` or `-` with a blank before it and none after it begins the next
    /// element.
    Element,
}

/// The two stacks, and the steps of the operands on theirs.
#[derive(Default)]
struct Stacks {
    operands: Vec<StackedOperand>,
    steps: Vec<Step>,
    waiting: Vec<(Waiting, u32)>,
    /// How many groups, calls and places of elements wait.
    open: usize,
    /// The lists whose elements are picked.
    lists: Vec<Value>,
}

impl Stacks {
    /// A plain number.
    fn push(&mut self, value: f64, span: Span) {
        let first = self.steps.len() as u32;
        self.steps.push(Step::Literal(value));
        self.operands.push(StackedOperand { value, span, first, depends: false });
    }

    /// What is no number before there is a point. Nothing is computed of it, so its value is NaN.
    fn push_variable(&mut self, variable: Variable, span: Span) {
        let first = self.steps.len() as u32;
        self.steps.push(Step::Variable(variable));
        self.operands.push(StackedOperand { value: f64::NAN, span, first, depends: true });
    }

    /// A number that is made already.
    fn push_number(&mut self, number: &Number, span: Span) {
        match number.formula() {
            None => self.push(number.value(), span),
            Some(formula) => {
                let first = self.steps.len() as u32;
                self.steps.extend_from_slice(formula.steps());
                self.operands.push(StackedOperand { value: number.value(), span, first, depends: true });
            }
        }
    }

    /// What became of the operands whose steps begin at `first`: `step` on top of theirs, or a value, if they
    /// are plain.
    fn push_result(&mut self, value: f64, span: Span, first: u32, step: Option<Step>) {
        match step {
            Some(step) => {
                self.steps.push(step);
                self.operands.push(StackedOperand { value, span, first, depends: true });
            }
            None => {
                self.steps.truncate(first as usize);
                self.push(value, span);
            }
        }
    }

    /// A place in brackets, of one of these elements.
    fn open_index(&mut self, elements: Value, at: u32) {
        self.open += 1;
        self.waiting.push((Waiting::Index(self.lists.len() as u32), at));
        self.lists.push(elements);
    }

    /// The only operand that is left.
    fn finish(&mut self) -> Option<ParsedOperand> {
        let part = self.operands.pop()?;
        let number = if part.depends {
            Number::with_formula(part.value, NumberFormula::new(self.steps.clone(), Some(part.span)))
        } else {
            Number::from(part.value)
        };
        Some(ParsedOperand { number, span: part.span })
    }
}

impl Parser<'_> {
    /// A number. After an error that has lost the place, NaN.
    pub(super) fn expression(&mut self, place: ExpressionPlace) -> ParsedOperand {
        let sign = self.accept(b'-');
        let token = self.peek();
        if token.kind != TokenKind::Number {
            return self.expression_after(place, sign, None);
        }
        self.next();
        let value = self.literal(token.span());
        let goes_on = match self.peek().kind {
            TokenKind::Mark(mark) => {
                Binary::of_mark(mark).is_some_and(|binary| !self.begins_element(binary, place))
            }
            TokenKind::Number | TokenKind::Word | TokenKind::Quoted | TokenKind::Unknown | TokenKind::End => {
                false
            }
        };
        if goes_on {
            return self.expression_after(place, sign, Some((&value.into(), token.span())));
        }
        // Most numbers stand alone.
        let start = sign.map_or(token.start, |sign| sign.start);
        let value = if sign.is_some() { -value } else { value };
        ParsedOperand { number: value.into(), span: Span::new(start, token.end) }
    }

    /// A number whose first operand has been read.
    pub(super) fn expression_from(&mut self, place: ExpressionPlace, first: &ParsedOperand) -> ParsedOperand {
        self.expression_after(place, None, Some((&first.number, first.span)))
    }

    /// A number whose minus sign has been read, or its first operand, or both.
    fn expression_after(
        &mut self,
        place: ExpressionPlace,
        sign: Option<Token>,
        first: Option<(&Number, Span)>,
    ) -> ParsedOperand {
        let mut stacks = Stacks::default();
        stacks.waiting.extend(sign.map(|sign| (Waiting::Negate, sign.start as u32)));
        let wanted = first.is_none();
        if let Some((number, span)) = first {
            stacks.push_number(number, span);
        }
        let lost = ParsedOperand { number: f64::NAN.into(), span: self.peek().span() };
        self.finished(&mut stacks, wanted, place).unwrap_or(lost)
    }

    /// Whether a `+` or `-` begins the next element of a vector.
    fn begins_element(&self, binary: Binary, place: ExpressionPlace) -> bool {
        let additive = matches!(binary, Binary::Add | Binary::Subtract);
        place == ExpressionPlace::Element && additive && self.leans_right()
    }

    /// The number that the stacks, the text and the place lead to; nothing after an error that has lost the
    /// place.
    fn finished(
        &mut self,
        stacks: &mut Stacks,
        mut wanted: bool,
        place: ExpressionPlace,
    ) -> Option<ParsedOperand> {
        loop {
            if stacks.waiting.len().max(stacks.operands.len()) >= MAX_EXPRESSION_DEPTH {
                let message = format!("more than {MAX_EXPRESSION_DEPTH} operators wait in one expression");
                self.give_up(Diagnostic::limit(Some(self.peek().span()), message));
                return None;
            }
            if wanted {
                match self.operand(stacks) {
                    Some(still) => wanted = still,
                    None => return None,
                }
            } else {
                match self.operator(stacks, place) {
                    Some(true) => wanted = true,
                    Some(false) => {}
                    None => break,
                }
            }
        }
        if let Some(&(waiting, at)) = stacks.waiting.iter().rev().find(|(waiting, _)| waiting.is_open()) {
            let is_index = matches!(waiting, Waiting::Index(_));
            let found = self.describe(self.peek());
            let compared = self.peek().is(COMPARISON);
            self.report_and_mute(|| {
                let (opened, closed) = if is_index { ('[', ']') } else { ('(', ')') };
                let span = Span::new(at as usize, at as usize + 1);
                let hint = if compared { "; comparisons have no parentheses around them" } else { "" };
                Diagnostic::error(Some(span), format!("this `{opened}` is not closed"))
                    .expected(format!("expected `{closed}` before {found}{hint}"))
            });
            return None;
        }
        self.reduce(stacks, 0);
        stacks.finish()
    }

    /// Takes what may begin an operand. Returns whether one is still wanted, or nothing if none can begin
    /// here.
    fn operand(&mut self, stacks: &mut Stacks) -> Option<bool> {
        let token = self.peek();
        let at = token.start as u32;
        match token.kind {
            TokenKind::Number => {
                self.next();
                let value = self.literal(token.span());
                stacks.push(value, token.span());
                Some(false)
            }
            TokenKind::Word if is_statement(self.text(token)) => {
                self.expected_at(token, "expected a number");
                None
            }
            TokenKind::Word => self.word_operand(stacks),
            TokenKind::Mark(b'-') => {
                self.next();
                stacks.waiting.push((Waiting::Negate, at));
                Some(true)
            }
            TokenKind::Mark(b'+') => {
                self.next();
                Some(true)
            }
            TokenKind::Mark(b'(') => {
                self.next();
                stacks.open += 1;
                stacks.waiting.push((Waiting::Group, at));
                Some(true)
            }
            TokenKind::Mark(_) | TokenKind::Quoted | TokenKind::Unknown | TokenKind::End => {
                self.expected_at(token, "expected a number");
                None
            }
        }
    }

    /// Takes what may follow an operand. Returns whether another one is wanted, or nothing if the expression
    /// ends here.
    fn operator(&mut self, stacks: &mut Stacks, place: ExpressionPlace) -> Option<bool> {
        let token = self.peek();
        let TokenKind::Mark(mark) = token.kind else {
            return None;
        };
        match (mark, Binary::of_mark(mark)) {
            (_, Some(binary)) => {
                if stacks.open == 0 && self.begins_element(binary, place) {
                    return None;
                }
                self.next();
                // Operators of equal strength group to the left, powers to the right.
                self.reduce(stacks, binary.strength() + u8::from(binary == Binary::Power));
                stacks.waiting.push((Waiting::Binary(binary), token.start as u32));
                Some(true)
            }
            (b']', None) if stacks.open > 0 => {
                self.reduce(stacks, 0);
                let Some(&(Waiting::Index(list), at)) = stacks.waiting.last() else { return None };
                self.next();
                stacks.waiting.pop();
                stacks.open -= 1;
                self.finish_index(stacks, list, Span::new(at as usize, token.end))
            }
            (b')', None) if stacks.open > 0 => {
                self.reduce(stacks, 0);
                if matches!(stacks.waiting.last(), Some((Waiting::Index(_), _))) {
                    return None;
                }
                self.next();
                stacks.open -= 1;
                if let Some((waiting, at)) = stacks.waiting.pop() {
                    self.finish_group(stacks, waiting, Span::new(at as usize, token.end));
                }
                Some(false)
            }
            (b',', None) if stacks.open > 0 => {
                self.reduce(stacks, 0);
                if let Some((Waiting::Call(..), _)) = stacks.waiting.last() {
                    self.next();
                    return Some(true);
                }
                None
            }
            _ => None,
        }
    }

    /// Computes the waiting operators that bind at least as strongly as `strength`, down to the nearest open
    /// group.
    fn reduce(&mut self, stacks: &mut Stacks, strength: u8) {
        while let Some(&(waiting, at)) = stacks.waiting.last() {
            if waiting.is_open() || waiting.strength() < strength {
                return;
            }
            stacks.waiting.pop();
            let Some(right) = stacks.operands.pop() else {
                return;
            };
            match waiting {
                Waiting::Binary(binary) => {
                    let Some(left) = stacks.operands.pop() else {
                        return;
                    };
                    self.binary(stacks, binary, left, right);
                }
                Waiting::Negate => {
                    let span = Span { start: at, end: right.span.end };
                    let step = right.depends.then_some(Step::Negate);
                    stacks.push_result(-right.value, span, right.first, step);
                }
                Waiting::Group | Waiting::Call(..) | Waiting::Index(_) => stacks.operands.push(right),
            }
        }
    }

    /// Computes a group or a call whose parenthesis has just been closed; `span` holds all of it.
    fn finish_group(&mut self, stacks: &mut Stacks, waiting: Waiting, span: Span) {
        let Waiting::Call(function, first) = waiting else {
            if let Some(operand) = stacks.operands.last_mut() {
                operand.span = span;
            }
            return;
        };
        let parts: Vec<StackedOperand> = stacks.operands.drain(first as usize..).collect();
        let arguments: Vec<f64> = parts.iter().map(|part| part.value).collect();
        let (fewest, most) = function.arity();
        let (name, count) = (function.name(), arguments.len());
        let is_call = (fewest..=most).contains(&count);
        let value = if !is_call {
            self.report(|| {
                let plural = if fewest == 1 { "" } else { "s" };
                Diagnostic::error(
                    Some(span),
                    format!("`{name}` takes {fewest} argument{plural}, not {count}"),
                )
            });
            f64::NAN
        } else if arguments.iter().any(|x| x.is_nan()) {
            f64::NAN
        } else {
            self.computed(function.compute(&arguments), span)
        };
        // No formula may hold what cannot be called: it is computed again, with other values.
        let depends = is_call && parts.iter().any(|part| part.depends);
        let step = depends.then_some(Step::Call(function, count as u32));
        let begin = parts.first().map_or(stacks.steps.len() as u32, |part| part.first);
        stacks.push_result(value, span, begin, step);
    }

    fn binary(&mut self, stacks: &mut Stacks, binary: Binary, left: StackedOperand, right: StackedOperand) {
        let span = Span { start: left.span.start, end: right.span.end };
        let (a, b) = (left.value, right.value);
        let value =
            if a.is_nan() || b.is_nan() { f64::NAN } else { self.computed(binary.compute(a, b), span) };
        let step = (left.depends || right.depends).then_some(Step::Binary(binary));
        stacks.push_result(value, span, left.first, step);
    }

    /// The value, or NaN and a message where there is none.
    fn computed(&mut self, value: Result<f64, String>, span: Span) -> f64 {
        value.unwrap_or_else(|message| {
            self.report(|| Diagnostic::error(Some(span), message));
            f64::NAN
        })
    }

    fn literal(&mut self, span: Span) -> f64 {
        let digits = self.source(span);
        let value: f64 = digits.parse().unwrap_or(f64::INFINITY);
        let finite =
            if value.is_finite() { Ok(value) } else { Err(format!("{} is too large", clip(digits))) };
        self.computed(finite, span)
    }
}
