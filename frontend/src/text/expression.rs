//! Numbers are expressions. They are evaluated while they are read, on two explicit stacks (Dijkstra 1961).
//!
//! ```text
//! operators from weak to strong:   + -    * /    unary -    ^ (to the right)
//! -2^2 = -(2^2)     2^-1 = 1/2     2^3^2 = 2^(3^2)
//! ```
//!
//! A number that could not be computed is NaN from there on, and is reported once: where it arose.

use std::f64::consts::PI;

use jbt_ir::limits::MAX_EXPRESSION_DEPTH;

use super::lex::TokenKind;
use super::parse::{Parser, is_statement};
use crate::diagnostic::{Diagnostic, Span};
use crate::report::{clip, nearest};

/// A function of the text format.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Function {
    Sqrt,
    Sin,
    Cos,
    Abs,
    Exp,
    Ln,
    Min,
    Max,
    Pow,
}

const FUNCTIONS: &[(&str, Function)] = &[
    ("sqrt", Function::Sqrt),
    ("sin", Function::Sin),
    ("cos", Function::Cos),
    ("abs", Function::Abs),
    ("exp", Function::Exp),
    ("ln", Function::Ln),
    ("min", Function::Min),
    ("max", Function::Max),
    ("pow", Function::Pow),
];

const CONSTANTS: &[(&str, f64)] = &[("pi", PI)];

/// Whether a word means something else already where a number may stand, so that no parameter may have it.
pub(super) fn is_builtin(word: &str) -> bool {
    is_statement(word) || function(word).is_some() || constant(word).is_some()
}

fn function(word: &str) -> Option<Function> {
    FUNCTIONS.iter().find(|(name, _)| *name == word).map(|&(_, function)| function)
}

fn constant(word: &str) -> Option<f64> {
    CONSTANTS.iter().find(|(name, _)| *name == word).map(|&(_, value)| value)
}

impl Function {
    /// The allowed numbers of arguments.
    const fn arity(self) -> (usize, usize) {
        match self {
            Self::Sqrt | Self::Sin | Self::Cos | Self::Abs | Self::Exp | Self::Ln => (1, 1),
            Self::Min | Self::Max => (1, usize::MAX),
            Self::Pow => (2, 2),
        }
    }

    fn name(self) -> &'static str {
        FUNCTIONS.iter().find(|(_, function)| *function == self).map_or("", |(name, _)| name)
    }

    /// The value; `arguments` are as many as [`arity`](Self::arity) allows.
    fn apply(self, arguments: &[f64]) -> f64 {
        let x = arguments[0];
        match self {
            Self::Sqrt => x.sqrt(),
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Abs => x.abs(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Min => arguments.iter().copied().fold(x, f64::min),
            Self::Max => arguments.iter().copied().fold(x, f64::max),
            Self::Pow => x.powf(arguments[1]),
        }
    }
}

/// What waits on the operator stack.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Waiting {
    Binary(u8),
    Negate,
    Group,
    /// A function and the place of its first argument on the operand stack.
    Call(Function, u32),
}

impl Waiting {
    /// How strongly it binds; groups do not bind.
    const fn strength(self) -> u8 {
        match self {
            Self::Binary(b'+' | b'-') => 1,
            Self::Binary(b'*' | b'/') => 2,
            Self::Negate => 3,
            Self::Binary(_) => 4,
            Self::Group | Self::Call(..) => 0,
        }
    }

    const fn is_open(self) -> bool {
        matches!(self, Self::Group | Self::Call(..))
    }
}

/// A value and the text that it came from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Operand {
    pub(super) value: f64,
    pub(super) span: Span,
}

/// Where an expression stands, which decides where it ends.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Place {
    /// By itself: it goes on as long as operators follow.
    Alone,
    /// Directly inside a vector: a `+` or `-` with a blank before it and none after it begins the next element.
    Element,
}

/// The two stacks.
#[derive(Default)]
struct Stacks {
    operands: Vec<Operand>,
    waiting: Vec<(Waiting, u32)>,
    /// How many groups and calls wait.
    open: usize,
}

impl Parser<'_> {
    /// A number. After an error that has lost the place, NaN.
    pub(super) fn expression(&mut self, place: Place) -> Operand {
        self.expression_from(place, None)
    }

    /// A number whose first operand has been read.
    pub(super) fn expression_from(&mut self, place: Place, first: Option<Operand>) -> Operand {
        let lost = Operand { value: f64::NAN, span: self.peek().span() };
        let mut stacks = Stacks::default();
        let mut wanted = first.is_none();
        stacks.operands.extend(first);
        loop {
            if stacks.waiting.len().max(stacks.operands.len()) >= MAX_EXPRESSION_DEPTH {
                let message = format!("more than {MAX_EXPRESSION_DEPTH} operators wait in one expression");
                self.give_up(Diagnostic::limit(Some(self.peek().span()), message));
                return lost;
            }
            if wanted {
                match self.operand(&mut stacks) {
                    Some(still) => wanted = still,
                    None => return lost,
                }
            } else {
                match self.operator(&mut stacks, place) {
                    Some(true) => wanted = true,
                    Some(false) => {}
                    None => break,
                }
            }
        }
        if let Some(&(_, at)) = stacks.waiting.iter().rev().find(|(waiting, _)| waiting.is_open()) {
            let found = self.describe(self.peek());
            self.lose_place(|| {
                Diagnostic::error(Some(Span::new(at as usize, at as usize + 1)), "this `(` is not closed")
                    .expected(format!("expected `)` before {found}"))
            });
            return lost;
        }
        self.reduce(&mut stacks, 0);
        stacks.operands.pop().unwrap_or(lost)
    }

    /// Takes what may begin an operand. Returns whether one is still wanted, or nothing if none can begin here.
    fn operand(&mut self, stacks: &mut Stacks) -> Option<bool> {
        let token = self.peek();
        let at = token.start as u32;
        match token.kind {
            TokenKind::Number => {
                self.next();
                let value = self.literal(token.span());
                stacks.operands.push(Operand { value, span: token.span() });
                Some(false)
            }
            TokenKind::Word if is_statement(self.text(token)) => {
                self.expected_at(token, "expected a number");
                None
            }
            TokenKind::Word => {
                self.next();
                let word = self.text(token);
                if let Some(function) = function(word) {
                    if !self.peek().is(b'(') {
                        self.lose_place(|| {
                            Diagnostic::error(Some(token.span()), format!("`{word}` is a function"))
                                .expected(format!("expected its arguments: {word}(...)"))
                        });
                        return None;
                    }
                    self.next();
                    stacks.open += 1;
                    stacks.waiting.push((Waiting::Call(function, stacks.operands.len() as u32), at));
                    return Some(true);
                }
                let value = constant(word).or_else(|| self.parameter(word));
                let value = value.unwrap_or_else(|| self.unknown_number(word, token.span()));
                stacks.operands.push(Operand { value, span: token.span() });
                Some(false)
            }
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
            TokenKind::Mark(_) | TokenKind::Unknown | TokenKind::End => {
                self.expected_at(token, "expected a number");
                None
            }
        }
    }

    /// Takes what may follow an operand. Returns whether another one is wanted, or nothing if the expression ends here.
    fn operator(&mut self, stacks: &mut Stacks, place: Place) -> Option<bool> {
        let token = self.peek();
        let TokenKind::Mark(mark) = token.kind else {
            return None;
        };
        match mark {
            b'+' | b'-' | b'*' | b'/' | b'^' => {
                let additive = matches!(mark, b'+' | b'-');
                if place == Place::Element && stacks.open == 0 && additive && self.leans_right() {
                    return None;
                }
                self.next();
                let operator = Waiting::Binary(mark);
                // Operators of equal strength group to the left, powers to the right.
                self.reduce(stacks, operator.strength() + u8::from(mark == b'^'));
                stacks.waiting.push((operator, token.start as u32));
                Some(true)
            }
            b')' if stacks.open > 0 => {
                self.next();
                self.reduce(stacks, 0);
                stacks.open -= 1;
                if let Some((waiting, at)) = stacks.waiting.pop() {
                    self.finish_group(stacks, waiting, Span::new(at as usize, token.end));
                }
                Some(false)
            }
            b',' if stacks.open > 0 => {
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

    /// Computes the waiting operators that bind at least as strongly as `strength`, down to the nearest open group.
    fn reduce(&mut self, stacks: &mut Stacks, strength: u8) {
        while let Some(&(waiting, at)) = stacks.waiting.last() {
            if waiting.is_open() || waiting.strength() < strength {
                return;
            }
            stacks.waiting.pop();
            let Some(right) = stacks.operands.pop() else {
                return;
            };
            let result = match waiting {
                Waiting::Binary(mark) => {
                    let Some(left) = stacks.operands.pop() else {
                        return;
                    };
                    self.binary(mark, left, right)
                }
                Waiting::Negate => {
                    Operand { value: -right.value, span: Span { start: at, end: right.span.end } }
                }
                Waiting::Group | Waiting::Call(..) => right,
            };
            stacks.operands.push(result);
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
        let arguments: Vec<f64> = stacks.operands.drain(first as usize..).map(|o| o.value).collect();
        let (fewest, most) = function.arity();
        let (name, count) = (function.name(), arguments.len());
        let value = if count < fewest || count > most {
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
            let value = function.apply(&arguments);
            self.finite(value, span, || {
                let shown: Vec<String> = arguments.iter().map(|&x| super::print::number(x)).collect();
                format!("{name}({}) is not a finite number", shown.join(", "))
            })
        };
        stacks.operands.push(Operand { value, span });
    }

    fn binary(&mut self, mark: u8, left: Operand, right: Operand) -> Operand {
        let span = Span { start: left.span.start, end: right.span.end };
        let (a, b) = (left.value, right.value);
        if a.is_nan() || b.is_nan() {
            return Operand { value: f64::NAN, span };
        }
        if mark == b'/' && b == 0.0 {
            self.report(|| Diagnostic::error(Some(span), "division by zero"));
            return Operand { value: f64::NAN, span };
        }
        let value = match mark {
            b'+' => a + b,
            b'-' => a - b,
            b'*' => a * b,
            b'/' => a / b,
            _ => a.powf(b),
        };
        let value = self.finite(value, span, || {
            let (a, b) = (super::print::number(a), super::print::number(b));
            match mark {
                b'^' => format!("pow({a}, {b}) is not a finite number"),
                _ => format!("{a} {} {b} is not a finite number", char::from(mark)),
            }
        });
        Operand { value, span }
    }

    /// The value, or NaN and a message where it is not finite.
    fn finite(&mut self, value: f64, span: Span, message: impl FnOnce() -> String) -> f64 {
        if value.is_finite() {
            return value;
        }
        self.report(|| Diagnostic::error(Some(span), message()));
        f64::NAN
    }

    fn literal(&mut self, span: Span) -> f64 {
        let digits = self.source(span);
        let value = digits.parse().unwrap_or(f64::INFINITY);
        self.finite(value, span, || format!("{} is too large", clip(digits)))
    }

    fn unknown_number(&mut self, word: &str, span: Span) -> f64 {
        self.report_with(|parser| {
            let builtin =
                FUNCTIONS.iter().map(|(name, _)| *name).chain(CONSTANTS.iter().map(|(name, _)| *name));
            let error = Diagnostic::error(Some(span), format!("no parameter is named `{}`", clip(word)));
            match nearest(word, parser.parameter_names().chain(builtin)) {
                Some(near) => error.expected(format!("perhaps `{near}`")),
                None => error.expected(format!("declare it above: param {} = 1", clip(word))),
            }
        });
        f64::NAN
    }
}
