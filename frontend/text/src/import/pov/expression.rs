//! Expressions of the scene language, by operator precedence on two explicit stacks.
//!
//! `<` is a bracket where an operand is expected, and a comparison behind one, if the innermost bracket is a
//! parenthesis. So a vector ends at its `>`, and what is compared stands in parentheses.

use jbt_model::diagnostic::{Diagnostic, Span};

use super::amount::{Amount, PovFunction, PovOperator, function};
use super::scan::PovToken;
use super::script::{PovValue, Script};

/// What waits for operands.
enum PovWaiting {
    Binary(PovOperator),
    Negate,
    Not,
    /// `c ?`, and then `c ? a :`.
    Question,
    Colon,
    Bracket(PovBracket, Span),
}

/// An open bracket.
enum PovBracket {
    Parenthesis,
    /// The number of operands before it.
    Vector(usize),
    /// A call, with the number of operands before it; `None` for a name that is no function here.
    Call(Option<PovFunction>, usize),
}

/// The state of reading an expression.
#[derive(Default)]
struct OperandStacks {
    operands: Vec<Amount>,
    waiting: Vec<PovWaiting>,
    /// The places of open brackets among what waits.
    open: Vec<usize>,
}

impl Script<'_> {
    /// An expression, up to the first token that is not a part of it.
    pub(super) fn expression(&mut self) -> Result<Amount, Diagnostic> {
        self.bracketed(OperandStacks::default())
    }

    /// A condition in its parentheses.
    pub(super) fn condition(&mut self) -> Result<bool, Diagnostic> {
        let span = self.scanner.expect(b'(')?;
        let mut stacks = OperandStacks::default();
        stacks.open(PovBracket::Parenthesis, span);
        let amount = self.bracketed(stacks)?;
        Ok(self.real(amount, span)? != 0.0)
    }

    fn bracketed(&mut self, mut stacks: OperandStacks) -> Result<Amount, Diagnostic> {
        let is_condition = !stacks.waiting.is_empty();
        loop {
            self.operand(&mut stacks)?;
            // What follows an operand, until another one is due.
            loop {
                let (token, span) = self.scanner.peek()?;
                if token == PovToken::Mark(b'.') {
                    self.access(&mut stacks)?;
                    continue;
                }
                let relational = stacks.innermost().is_some_and(|one| !matches!(one, PovBracket::Vector(_)));
                if let Some(operator) = operator(token, relational) {
                    self.scanner.next()?;
                    stacks.reduce(operator.precedence());
                    stacks.waiting.push(PovWaiting::Binary(operator));
                    break;
                }
                match token {
                    PovToken::Mark(b'?') if relational => {
                        self.scanner.next()?;
                        stacks.reduce(1);
                        stacks.waiting.push(PovWaiting::Question);
                        break;
                    }
                    PovToken::Mark(b':') if relational => {
                        self.scanner.next()?;
                        stacks.reduce(0);
                        if !matches!(stacks.waiting.last(), Some(PovWaiting::Question)) {
                            let error = self.scanner.unexpected(token, span);
                            return Err(error.expected("expected `condition ? a : b`"));
                        }
                        stacks.waiting.pop();
                        stacks.waiting.push(PovWaiting::Colon);
                        break;
                    }
                    PovToken::Mark(b',') if !stacks.waiting.is_empty() && stacks.takes_comma() => {
                        self.scanner.next()?;
                        stacks.reduce(0);
                        break;
                    }
                    PovToken::Mark(b')' | b'>') if stacks.innermost().is_some() => {
                        self.close(&mut stacks, token, span)?;
                        if is_condition && stacks.waiting.is_empty() {
                            return Ok(stacks.operands.pop().unwrap_or(Amount::Unknown(span)));
                        }
                    }
                    _ => {
                        stacks.reduce(0);
                        return match stacks.waiting.last() {
                            None => Ok(stacks.operands.pop().unwrap_or(Amount::Unknown(span))),
                            Some(PovWaiting::Bracket(_, open)) => {
                                let error = self.scanner.unexpected(token, span);
                                let line = self.scanner.shown(*open);
                                Err(error.expected(format!("expected the end of `{line}` before it")))
                            }
                            Some(_) => Err(self.scanner.unexpected(token, span).expected("expected `:`")),
                        };
                    }
                }
            }
        }
    }

    /// One operand, with the signs and brackets before it.
    fn operand(&mut self, stacks: &mut OperandStacks) -> Result<(), Diagnostic> {
        loop {
            let (token, span) = self.scanner.next()?;
            match token {
                PovToken::Mark(b'+') => {}
                PovToken::Mark(b'-') => stacks.waiting.push(PovWaiting::Negate),
                PovToken::Mark(b'!') => stacks.waiting.push(PovWaiting::Not),
                PovToken::Mark(b'(') => stacks.open(PovBracket::Parenthesis, span),
                PovToken::Mark(b'<') => {
                    let before = stacks.operands.len();
                    stacks.open(PovBracket::Vector(before), span);
                }
                PovToken::Number(number) => {
                    stacks.operands.push(Amount::Number(number));
                    return Ok(());
                }
                PovToken::Text => {
                    stacks.operands.push(Amount::Unknown(span));
                    return Ok(());
                }
                PovToken::Word => {
                    let word = self.scanner.word(span);
                    let known = self.value(word).is_some();
                    if !known && self.scanner.peek()?.0 == PovToken::Mark(b'(') {
                        self.scanner.next()?;
                        self.spend(1, span)?;
                        let call = PovBracket::Call(function(word), stacks.operands.len());
                        stacks.open(call, span);
                        if self.scanner.peek()?.0 == PovToken::Mark(b')') {
                            let (token, span) = self.scanner.peek()?;
                            return self.close(stacks, token, span);
                        }
                        continue;
                    }
                    let amount = self.named(word, span)?;
                    stacks.operands.push(amount);
                    return Ok(());
                }
                PovToken::Mark(_)
                | PovToken::AtMost
                | PovToken::AtLeast
                | PovToken::Unequal
                | PovToken::End => {
                    return Err(self
                        .scanner
                        .unexpected(token, span)
                        .expected("expected a number or a vector"));
                }
            }
        }
    }

    /// The amount of a name. A name that has none is no error before it is used.
    fn named(&mut self, word: &str, span: Span) -> Result<Amount, Diagnostic> {
        let vector = |x, y, z, t, size| Amount::Vector([x, y, z, t, 0.0], size);
        if let Some(value) = self.value(word) {
            let amount = if let PovValue::Amount(amount) = value { *amount } else { Amount::Unknown(span) };
            self.asked += 1;
            self.skip_arguments()?;
            return Ok(amount);
        }
        Ok(match word {
            "x" => vector(1.0, 0.0, 0.0, 0.0, 3),
            "y" => vector(0.0, 1.0, 0.0, 0.0, 3),
            "z" => vector(0.0, 0.0, 1.0, 0.0, 3),
            "t" => vector(0.0, 0.0, 0.0, 1.0, 4),
            "u" => vector(1.0, 0.0, 0.0, 0.0, 2),
            "v" => vector(0.0, 1.0, 0.0, 0.0, 2),
            "pi" => Amount::Number(std::f64::consts::PI),
            "on" | "yes" | "true" => Amount::Number(1.0),
            "off" | "no" | "false" => Amount::Number(0.0),
            "clock" | "frame_number" | "clock_on" => Amount::Number(0.0),
            "version" => Amount::Number(3.7),
            _ => {
                self.skip_arguments()?;
                super::colors::color(word).map_or(Amount::Unknown(span), |[r, g, b, filter]| {
                    Amount::Vector([r, g, b, filter, 0.0], 5)
                })
            }
        })
    }

    /// Goes over the place in an array, and the arguments of a macro.
    fn skip_arguments(&mut self) -> Result<(), Diagnostic> {
        loop {
            match self.scanner.peek()?.0 {
                PovToken::Mark(b'[') => self.skip_balanced(b'[', b']')?,
                PovToken::Mark(b'(') => self.skip_balanced(b'(', b')')?,
                _ => return Ok(()),
            }
        }
    }

    /// Goes over brackets and what they hold, at the opening one.
    pub(super) fn skip_balanced(&mut self, open: u8, close: u8) -> Result<(), Diagnostic> {
        let begin = self.scanner.peek()?.1;
        let mut depth = 0usize;
        loop {
            match self.scanner.next()?.0 {
                PovToken::Mark(mark) if mark == open => depth += 1,
                PovToken::Mark(mark) if mark == close => depth = depth.saturating_sub(1),
                PovToken::End => return Err(Diagnostic::error(Some(begin), "the bracket is not closed")),
                _ => {}
            }
            if depth == 0 {
                return Ok(());
            }
        }
    }

    /// `.x` and the like, behind an operand.
    fn access(&mut self, stacks: &mut OperandStacks) -> Result<(), Diagnostic> {
        self.scanner.next()?;
        let (word, span) = self.scanner.expect_word("the name of a component")?;
        let place = match word {
            "x" | "u" | "red" => 0,
            "y" | "v" | "green" => 1,
            "z" | "blue" => 2,
            "t" | "filter" => 3,
            "transmit" => 4,
            _ => return Err(self.scanner.unexpected(PovToken::Word, span).expected("expected x, y, z or t")),
        };
        if let Some(last) = stacks.operands.last_mut() {
            *last = last.component(place);
        }
        Ok(())
    }

    /// Closes the innermost bracket, at its mark.
    fn close(&mut self, stacks: &mut OperandStacks, token: PovToken, span: Span) -> Result<(), Diagnostic> {
        self.scanner.next()?;
        stacks.reduce(0);
        let Some(PovWaiting::Bracket(bracket, open)) = stacks.waiting.pop() else {
            return Err(self.scanner.unexpected(token, span).expected("expected `:`"));
        };
        stacks.open.pop();
        let fits = match bracket {
            PovBracket::Vector(_) => token == PovToken::Mark(b'>'),
            PovBracket::Parenthesis | PovBracket::Call(..) => token == PovToken::Mark(b')'),
        };
        if !fits {
            let mark = if matches!(bracket, PovBracket::Vector(_)) { '>' } else { ')' };
            return Err(self.scanner.unexpected(token, span).expected(format!("expected `{mark}`")));
        }
        match bracket {
            PovBracket::Parenthesis => {}
            PovBracket::Vector(before) => {
                let numbers: Vec<Amount> = stacks.operands.drain(before..).collect();
                let amount = self.make_vector(&numbers, Span { start: open.start, end: span.end })?;
                stacks.operands.push(amount);
            }
            PovBracket::Call(function, before) => {
                let arguments: Vec<Amount> = stacks.operands.drain(before..).collect();
                let value = match function {
                    None => Amount::Unknown(open),
                    Some(function) => {
                        self.asked +=
                            usize::from(matches!(function, PovFunction::Random | PovFunction::Seed));
                        function
                            .call(&arguments, &mut self.streams)
                            .map_err(|message| Diagnostic::error(Some(open), message))?
                    }
                };
                stacks.operands.push(value);
            }
        }
        Ok(())
    }

    fn make_vector(&self, numbers: &[Amount], span: Span) -> Result<Amount, Diagnostic> {
        if !(2..=5).contains(&numbers.len()) {
            let message = format!("a vector of {} numbers", numbers.len());
            return Err(Diagnostic::error(Some(span), message).expected("expected two to five"));
        }
        let mut all = [0.0; 5];
        for (slot, number) in all.iter_mut().zip(numbers) {
            match *number {
                Amount::Number(number) => *slot = number,
                Amount::Unknown(span) => return Ok(Amount::Unknown(span)),
                Amount::Vector(..) => {
                    return Err(Diagnostic::error(Some(span), "a vector within a vector"));
                }
            }
        }
        Ok(Amount::Vector(all, numbers.len()))
    }
}

/// The operator of a token; comparisons only where they may stand.
fn operator(token: PovToken, relational: bool) -> Option<PovOperator> {
    let found = match token {
        PovToken::Mark(b'+') => PovOperator::Add,
        PovToken::Mark(b'-') => PovOperator::Subtract,
        PovToken::Mark(b'*') => PovOperator::Multiply,
        PovToken::Mark(b'/') => PovOperator::Divide,
        PovToken::Mark(b'|') => PovOperator::Or,
        PovToken::Mark(b'&') => PovOperator::And,
        PovToken::Mark(b'<') => PovOperator::Less,
        PovToken::Mark(b'>') => PovOperator::Greater,
        PovToken::Mark(b'=') => PovOperator::Equal,
        PovToken::AtMost => PovOperator::AtMost,
        PovToken::AtLeast => PovOperator::AtLeast,
        PovToken::Unequal => PovOperator::Unequal,
        PovToken::Word | PovToken::Number(_) | PovToken::Text | PovToken::Mark(_) | PovToken::End => {
            return None;
        }
    };
    (relational || found.precedence() > 3).then_some(found)
}

impl OperandStacks {
    fn open(&mut self, bracket: PovBracket, span: Span) {
        self.open.push(self.waiting.len());
        self.waiting.push(PovWaiting::Bracket(bracket, span));
    }

    /// The innermost bracket that is open.
    fn innermost(&self) -> Option<&PovBracket> {
        match &self.waiting[*self.open.last()?] {
            PovWaiting::Bracket(bracket, _) => Some(bracket),
            PovWaiting::Binary(_)
            | PovWaiting::Negate
            | PovWaiting::Not
            | PovWaiting::Question
            | PovWaiting::Colon => None,
        }
    }

    fn takes_comma(&self) -> bool {
        matches!(self.innermost(), Some(PovBracket::Vector(_) | PovBracket::Call(..)))
    }

    /// Applies what waits and binds at least as close as this; down to the innermost bracket or `?`.
    fn reduce(&mut self, precedence: u8) {
        loop {
            let binds = match self.waiting.last() {
                Some(PovWaiting::Binary(operator)) => operator.precedence() >= precedence,
                Some(PovWaiting::Negate | PovWaiting::Not) => true,
                Some(PovWaiting::Colon) => precedence == 0,
                Some(PovWaiting::Question | PovWaiting::Bracket(..)) | None => false,
            };
            if !binds {
                return;
            }
            let mut pop = || self.operands.pop().unwrap_or(Amount::Number(0.0));
            let value = match self.waiting.pop() {
                Some(PovWaiting::Binary(operator)) => {
                    let b = pop();
                    operator.apply(pop(), b)
                }
                Some(PovWaiting::Negate) => pop().negated(),
                Some(PovWaiting::Not) => pop().not(),
                Some(PovWaiting::Colon) => {
                    let (b, a, condition) = (pop(), pop(), pop());
                    match condition {
                        Amount::Number(0.0) => b,
                        Amount::Number(_) | Amount::Vector(..) => a,
                        Amount::Unknown(span) => Amount::Unknown(span),
                    }
                }
                Some(PovWaiting::Question | PovWaiting::Bracket(..)) | None => return,
            };
            self.operands.push(value);
        }
    }
}
