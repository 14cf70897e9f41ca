//! Loops and conditions.
//!
//! ```text
//! for i in 0 .. 6 { .. }            0 1 2 3 4 5: from the first number to before the second one
//! for t in 0 .. 1 step 0.25 { .. }  0 0.25 0.5 0.75
//! for p in path { .. }              the elements of a list
//! if i < 3 and big { .. } else if i == 4 { .. } else { .. }
//! ```

use std::sync::Arc;

use super::known::{BodyFrame, BodyKind, BodyLoop, Turns, Value};
use crate::block::Begun;
use crate::expression::{ExpressionPlace, ParsedOperand};
use crate::lex::{COMPARISON, RANGE, Token, TokenKind};
use crate::state::Parser;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::label::{CallTurn, LabelCall};

/// The words of loops and conditions.
pub(super) const FOR: &str = "for";
pub(super) const IF: &str = "if";
const ELSE: &str = "else";

impl<'a> Parser<'a> {
    /// Whether the word that has just been taken begins a loop.
    pub(crate) fn is_loop(&self, word: &str) -> bool {
        word == FOR && self.peek_word().is_some() && self.text(self.peek_behind()) == "in"
    }

    /// Whether a word begins a condition.
    pub(crate) fn is_condition(&self, word: &str) -> bool {
        word == IF && self.group(word).is_none()
    }

    /// A loop whose word, `start`, has just been taken.
    pub(crate) fn for_node(&mut self, start: Token) -> Begun<'a> {
        let Some((variable, at)) = self.name("variable") else { return Begun::Nothing };
        self.check_local(variable, at);
        self.accept_word("in");
        let turns = self.turns(start);
        let span = Span::new(start.start, self.previous_end());
        if !self.peek().is(b'{') {
            self.expected_at(self.peek(), "expected `{`, or an operator");
            self.skip_arguments();
            if self.peek().is(b'{') {
                self.skip_block();
            }
            return Begun::Leaf(self.broken.clone());
        }
        self.report_again();
        let open = self.peek();
        let end = self.block_end();
        let Some(turns) = turns.filter(|_| !self.stopped) else {
            self.jump_behind(end);
            return Begun::Leaf(self.broken.clone());
        };
        let (count, length) = (turns.count(), end - open.end);
        let what = || format!("{count} turns of this loop");
        if count == 0.0 {
            self.program.has_expanded = true;
            self.jump_behind(end);
            return Begun::Done;
        }
        self.next();
        let body = self.lexer.place();
        // Loops in loops are refused with the outermost one, where their numbers stand in the text.
        let inner = if self.program.depth == 0 { self.turns_inside(end) } else { 0.0 };
        if !self.affords(count * (inner + 1.0), span, &what()) || !self.charge(count, length, span, &what()) {
            return Begun::Nothing;
        }
        self.lexer.jump(body);
        let made = BodyLoop { variable, turns, begun: 0, body, span };
        self.open_body(open, span, BodyKind::BodyLoop(Box::new(made)))
    }

    /// How many turns the loops of a body have at least, which ends at a place: those whose ranges are plain
    /// numbers, and that stand in no condition.
    fn turns_inside(&mut self, end: usize) -> f64 {
        let mut all = 0.0;
        // How often what is in each open brace is read.
        let mut times = vec![1.0];
        let mut next = 1.0;
        while self.peek().end < end {
            let token = self.next();
            let now = times.last().copied().unwrap_or(0.0);
            match token.kind {
                TokenKind::Mark(b'{') => times.push(std::mem::replace(&mut next, now)),
                TokenKind::Mark(b'}') => {
                    times.pop();
                    next = times.last().copied().unwrap_or(0.0);
                }
                TokenKind::Word if self.is_loop(self.text(token)) => {
                    let _ = (self.next(), self.next());
                    let number = |parser: &mut Self| match parser.peek().kind {
                        TokenKind::Number => {
                            let token = parser.next();
                            parser.text(token).parse().unwrap_or(0.0)
                        }
                        _ => f64::NAN,
                    };
                    let low = number(self);
                    let high = if self.accept(RANGE).is_some() { number(self) } else { f64::NAN };
                    let turns = if self.peek().is(b'{') { (high - low).max(0.0) } else { 0.0 };
                    next = now * turns;
                    all += next;
                }
                TokenKind::Word if matches!(self.text(token), IF | ELSE) => next = 0.0,
                TokenKind::Word
                | TokenKind::Mark(_)
                | TokenKind::Number
                | TokenKind::Quoted
                | TokenKind::Unknown => {}
                TokenKind::End => break,
            }
        }
        all
    }

    /// The turns of a loop, from behind its `in`; nothing after an error.
    fn turns(&mut self, start: Token) -> Option<Turns> {
        let first = self.value()?;
        if self.accept(RANGE).is_none() {
            let Some(elements) = first.elements() else {
                let span = Span::new(start.start, self.previous_end());
                let kind = first.kind();
                self.report(|| {
                    Diagnostic::error(Some(span), format!("a loop goes over {kind}"))
                        .expected("expected a list, or a range: for i in 0 .. 3 { .. }")
                });
                return None;
            };
            return Some(Turns::Elements(elements));
        }
        let high = self.expression(ExpressionPlace::Alone);
        let step = if self.accept_word("step") {
            self.expression(ExpressionPlace::Alone)
        } else {
            ParsedOperand { number: 1.0.into(), span: high.span }
        };
        let span = Span::new(start.start, self.previous_end());
        let Value::Number(low) = first else {
            let kind = first.kind();
            self.report(|| Diagnostic::error(Some(span), format!("a range begins with {kind}")));
            return None;
        };
        let decide = [&low, &high.number, &step.number].map(|number| self.decides(number, span));
        if decide.contains(&false) {
            return None;
        }
        let (low, high, width) = (low.value(), high.number.value(), step.number.value());
        if low.is_nan() || high.is_nan() || width.is_nan() || self.is_muted() {
            return None;
        }
        if width == 0.0 {
            let error = Diagnostic::error(Some(step.span), "the step of this loop is 0");
            self.report(|| error.expected("expected a number above 0, or below it to count down"));
            return None;
        }
        let count = (high - low) / width;
        // What rounding has put just above a whole number is that number.
        let near = if (count - count.round()).abs() < 1e-9 * count.abs().max(1.0) {
            count.round()
        } else {
            count.ceil()
        };
        Some(Turns::Numbers { first: low, step: width, count: near.max(0.0) })
    }

    /// The next turn of a loop, if there is one: its variable has its value, and the cursor is at its body.
    pub(super) fn turn(&mut self, frame: &mut BodyFrame<'a>) -> bool {
        let wrong = self.report.count() > frame.errors;
        let BodyKind::BodyLoop(made) = &mut frame.kind else { return false };
        // What is wrong once is wrong each time.
        if made.begun as f64 >= made.turns.count() || wrong || self.stopped {
            return false;
        }
        let place = made.begun;
        let (value, turn) = match &made.turns {
            Turns::Numbers { first, step, .. } => {
                let number = first + step * place as f64;
                (Value::Number(number.into()), CallTurn::Number(number))
            }
            Turns::Elements(elements) => (elements[place].clone(), CallTurn::Element(place)),
        };
        made.begun += 1;
        let call = LabelCall {
            name: made.variable.into(),
            turn: Some(turn),
            span: made.span,
            above: frame.around.clone(),
        };
        self.program.calls = Some(Arc::new(call));
        self.program.bind(made.variable, value);
        self.lexer.jump(made.body);
        true
    }

    /// A condition whose word, `start`, has just been taken: the cursor goes to the block that counts.
    pub(crate) fn if_node(&mut self, start: Token) -> Begun<'a> {
        loop {
            let holds = self.condition();
            let open = self.peek();
            if !open.is(b'{') {
                self.expected_at(open, "expected `{`, or `<`, `==` and so on, or `and`");
                while !matches!(self.peek().kind, TokenKind::Mark(b'{' | b'}') | TokenKind::End) {
                    self.next();
                }
                if self.peek().is(b'{') {
                    self.report_again();
                    self.skip_block();
                    self.skip_else();
                }
                return Begun::Leaf(self.broken.clone());
            }
            self.program.has_expanded = true;
            let span = Span::new(start.start, self.previous_end());
            match holds.filter(|_| !self.is_muted()) {
                Some(true) => {
                    self.next();
                    return self.open_body(open, span, BodyKind::Branch);
                }
                Some(false) => self.skip_block(),
                None => {
                    self.report_again();
                    self.skip_block();
                    self.skip_else();
                    return Begun::Leaf(self.broken.clone());
                }
            }
            if self.stopped || !self.accept_else() {
                return Begun::Done;
            }
            if self.accept_word(IF) {
                continue;
            }
            let open = self.peek();
            if !open.is(b'{') {
                self.expected_at(open, "expected `{` or `if`");
                return Begun::Leaf(self.broken.clone());
            }
            self.next();
            return self.open_body(open, span, BodyKind::Branch);
        }
    }

    /// Takes an `else` that is no name of a node.
    fn accept_else(&mut self) -> bool {
        !self.begins_named() && self.accept_word(ELSE)
    }

    /// Past all that stands behind a block for other cases.
    pub(super) fn skip_else(&mut self) {
        while !self.stopped && self.accept_else() {
            if self.accept_word(IF) {
                while !matches!(self.peek().kind, TokenKind::Mark(b'{' | b'}') | TokenKind::End) {
                    self.next();
                }
            }
            if self.peek().is(b'{') {
                self.skip_block();
            }
        }
    }

    /// `comparison { ( "and" | "or" ) comparison }`, where `and` binds before `or`; nothing after an error.
    fn condition(&mut self) -> Option<bool> {
        let mut any = Some(false);
        let mut all = self.comparison();
        loop {
            if self.is_muted() {
                return None;
            }
            if self.accept_word("and") {
                let next = self.comparison();
                all = all.zip(next).map(|(all, next)| all && next);
            } else if self.accept_word("or") {
                any = any.zip(all).map(|(any, all)| any || all);
                all = self.comparison();
            } else {
                return any.zip(all).map(|(any, all)| any || all);
            }
        }
    }

    /// `[ "not" ] number [ comparison number ]`: a number alone holds if it is not 0.
    fn comparison(&mut self) -> Option<bool> {
        let mut holds = true;
        while self.accept_word("not") {
            holds = !holds;
        }
        let left = self.decided();
        if self.is_muted() || !self.peek().is(COMPARISON) {
            return left.map(|left| (left != 0.0) == holds);
        }
        let token = self.next();
        let right = self.decided();
        let (left, right) = (left?, right?);
        let found = match self.text(token) {
            "<" => left < right,
            "<=" => left <= right,
            ">" => left > right,
            ">=" => left >= right,
            "==" => left == right,
            _ => left != right,
        };
        Some(found == holds)
    }

    /// A number on which nodes depend; nothing after an error.
    fn decided(&mut self) -> Option<f64> {
        let operand = self.expression(ExpressionPlace::Alone);
        let decides = self.decides(&operand.number, operand.span);
        let value = operand.number.value();
        (decides && !value.is_nan()).then_some(value)
    }
}
