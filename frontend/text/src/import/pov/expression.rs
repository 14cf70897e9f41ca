//! Expressions of the scene language, by operator precedence on two explicit stacks.
//!
//! `<` is a bracket where an operand is expected, and a comparison behind one, if the innermost bracket is a
//! parenthesis. So a vector ends at its `>`, and what is compared stands in parentheses.

use jbt_model::diagnostic::{Diagnostic, Span};

use super::amount::{Amount, Function, Operator, function};
use super::scan::Token;
use super::script::{Script, Value};

/// What waits for operands.
enum Waiting {
    Binary(Operator),
    Negate,
    Not,
    /// `c ?`, and then `c ? a :`.
    Question,
    Colon,
    Bracket(Bracket, Span),
}

/// An open bracket.
enum Bracket {
    Parenthesis,
    /// The number of operands before it.
    Vector(usize),
    /// A call, with the number of operands before it; `None` for a name that is no function here.
    Call(Option<Function>, usize),
}

/// The state of reading an expression.
#[derive(Default)]
struct Stacks {
    operands: Vec<Amount>,
    waiting: Vec<Waiting>,
    /// The places of open brackets among what waits.
    open: Vec<usize>,
}

impl Script<'_> {
    /// An expression, up to the first token that is not a part of it.
    pub(super) fn expression(&mut self) -> Result<Amount, Diagnostic> {
        self.bracketed(Stacks::default())
    }

    /// A condition in its parentheses.
    pub(super) fn condition(&mut self) -> Result<bool, Diagnostic> {
        let span = self.scanner.expect(b'(')?;
        let mut stacks = Stacks::default();
        stacks.open(Bracket::Parenthesis, span);
        let amount = self.bracketed(stacks)?;
        Ok(self.real(amount, span)? != 0.0)
    }

    fn bracketed(&mut self, mut stacks: Stacks) -> Result<Amount, Diagnostic> {
        let is_condition = !stacks.waiting.is_empty();
        loop {
            self.operand(&mut stacks)?;
            // What follows an operand, until another one is due.
            loop {
                let (token, span) = self.scanner.peek()?;
                if token == Token::Mark(b'.') {
                    self.access(&mut stacks)?;
                    continue;
                }
                let relational = stacks.innermost().is_some_and(|one| !matches!(one, Bracket::Vector(_)));
                if let Some(operator) = operator(token, relational) {
                    self.scanner.next()?;
                    stacks.reduce(operator.precedence());
                    stacks.waiting.push(Waiting::Binary(operator));
                    break;
                }
                match token {
                    Token::Mark(b'?') if relational => {
                        self.scanner.next()?;
                        stacks.reduce(1);
                        stacks.waiting.push(Waiting::Question);
                        break;
                    }
                    Token::Mark(b':') if relational => {
                        self.scanner.next()?;
                        stacks.reduce(0);
                        if !matches!(stacks.waiting.last(), Some(Waiting::Question)) {
                            let error = self.scanner.unexpected(token, span);
                            return Err(error.expected("expected `condition ? a : b`"));
                        }
                        stacks.waiting.pop();
                        stacks.waiting.push(Waiting::Colon);
                        break;
                    }
                    Token::Mark(b',') if !stacks.waiting.is_empty() && stacks.takes_comma() => {
                        self.scanner.next()?;
                        stacks.reduce(0);
                        break;
                    }
                    Token::Mark(b')' | b'>') if stacks.innermost().is_some() => {
                        self.close(&mut stacks, token, span)?;
                        if is_condition && stacks.waiting.is_empty() {
                            return Ok(stacks.operands.pop().unwrap_or(Amount::Unknown(span)));
                        }
                    }
                    _ => {
                        stacks.reduce(0);
                        return match stacks.waiting.last() {
                            None => Ok(stacks.operands.pop().unwrap_or(Amount::Unknown(span))),
                            Some(Waiting::Bracket(_, open)) => {
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
    fn operand(&mut self, stacks: &mut Stacks) -> Result<(), Diagnostic> {
        loop {
            let (token, span) = self.scanner.next()?;
            match token {
                Token::Mark(b'+') => {}
                Token::Mark(b'-') => stacks.waiting.push(Waiting::Negate),
                Token::Mark(b'!') => stacks.waiting.push(Waiting::Not),
                Token::Mark(b'(') => stacks.open(Bracket::Parenthesis, span),
                Token::Mark(b'<') => {
                    let before = stacks.operands.len();
                    stacks.open(Bracket::Vector(before), span);
                }
                Token::Number(number) => {
                    stacks.operands.push(Amount::Number(number));
                    return Ok(());
                }
                Token::Text => {
                    stacks.operands.push(Amount::Unknown(span));
                    return Ok(());
                }
                Token::Word => {
                    let word = self.scanner.word(span);
                    let known = self.value(word).is_some();
                    if !known && self.scanner.peek()?.0 == Token::Mark(b'(') {
                        self.scanner.next()?;
                        self.spend(1, span)?;
                        let call = Bracket::Call(function(word), stacks.operands.len());
                        stacks.open(call, span);
                        if self.scanner.peek()?.0 == Token::Mark(b')') {
                            let (token, span) = self.scanner.peek()?;
                            return self.close(stacks, token, span);
                        }
                        continue;
                    }
                    let amount = self.named(word, span)?;
                    stacks.operands.push(amount);
                    return Ok(());
                }
                Token::Mark(_) | Token::AtMost | Token::AtLeast | Token::Unequal | Token::End => {
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
            let amount = if let Value::Amount(amount) = value { *amount } else { Amount::Unknown(span) };
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
                Token::Mark(b'[') => self.skip_balanced(b'[', b']')?,
                Token::Mark(b'(') => self.skip_balanced(b'(', b')')?,
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
                Token::Mark(mark) if mark == open => depth += 1,
                Token::Mark(mark) if mark == close => depth = depth.saturating_sub(1),
                Token::End => return Err(Diagnostic::error(Some(begin), "the bracket is not closed")),
                _ => {}
            }
            if depth == 0 {
                return Ok(());
            }
        }
    }

    /// `.x` and the like, behind an operand.
    fn access(&mut self, stacks: &mut Stacks) -> Result<(), Diagnostic> {
        self.scanner.next()?;
        let (word, span) = self.scanner.expect_word("the name of a component")?;
        let place = match word {
            "x" | "u" | "red" => 0,
            "y" | "v" | "green" => 1,
            "z" | "blue" => 2,
            "t" | "filter" => 3,
            "transmit" => 4,
            _ => return Err(self.scanner.unexpected(Token::Word, span).expected("expected x, y, z or t")),
        };
        if let Some(last) = stacks.operands.last_mut() {
            *last = last.component(place);
        }
        Ok(())
    }

    /// Closes the innermost bracket, at its mark.
    fn close(&mut self, stacks: &mut Stacks, token: Token, span: Span) -> Result<(), Diagnostic> {
        self.scanner.next()?;
        stacks.reduce(0);
        let Some(Waiting::Bracket(bracket, open)) = stacks.waiting.pop() else {
            return Err(self.scanner.unexpected(token, span).expected("expected `:`"));
        };
        stacks.open.pop();
        let fits = match bracket {
            Bracket::Vector(_) => token == Token::Mark(b'>'),
            Bracket::Parenthesis | Bracket::Call(..) => token == Token::Mark(b')'),
        };
        if !fits {
            let mark = if matches!(bracket, Bracket::Vector(_)) { '>' } else { ')' };
            return Err(self.scanner.unexpected(token, span).expected(format!("expected `{mark}`")));
        }
        match bracket {
            Bracket::Parenthesis => {}
            Bracket::Vector(before) => {
                let numbers: Vec<Amount> = stacks.operands.drain(before..).collect();
                let amount = self.make_vector(&numbers, Span { start: open.start, end: span.end })?;
                stacks.operands.push(amount);
            }
            Bracket::Call(function, before) => {
                let arguments: Vec<Amount> = stacks.operands.drain(before..).collect();
                let value = match function {
                    None => Amount::Unknown(open),
                    Some(function) => {
                        self.asked += usize::from(matches!(function, Function::Random | Function::Seed));
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
fn operator(token: Token, relational: bool) -> Option<Operator> {
    let found = match token {
        Token::Mark(b'+') => Operator::Add,
        Token::Mark(b'-') => Operator::Subtract,
        Token::Mark(b'*') => Operator::Multiply,
        Token::Mark(b'/') => Operator::Divide,
        Token::Mark(b'|') => Operator::Or,
        Token::Mark(b'&') => Operator::And,
        Token::Mark(b'<') => Operator::Less,
        Token::Mark(b'>') => Operator::Greater,
        Token::Mark(b'=') => Operator::Equal,
        Token::AtMost => Operator::AtMost,
        Token::AtLeast => Operator::AtLeast,
        Token::Unequal => Operator::Unequal,
        Token::Word | Token::Number(_) | Token::Text | Token::Mark(_) | Token::End => return None,
    };
    (relational || found.precedence() > 3).then_some(found)
}

impl Stacks {
    fn open(&mut self, bracket: Bracket, span: Span) {
        self.open.push(self.waiting.len());
        self.waiting.push(Waiting::Bracket(bracket, span));
    }

    /// The innermost bracket that is open.
    fn innermost(&self) -> Option<&Bracket> {
        match &self.waiting[*self.open.last()?] {
            Waiting::Bracket(bracket, _) => Some(bracket),
            Waiting::Binary(_) | Waiting::Negate | Waiting::Not | Waiting::Question | Waiting::Colon => None,
        }
    }

    fn takes_comma(&self) -> bool {
        matches!(self.innermost(), Some(Bracket::Vector(_) | Bracket::Call(..)))
    }

    /// Applies what waits and binds at least as close as this; down to the innermost bracket or `?`.
    fn reduce(&mut self, precedence: u8) {
        loop {
            let binds = match self.waiting.last() {
                Some(Waiting::Binary(operator)) => operator.precedence() >= precedence,
                Some(Waiting::Negate | Waiting::Not) => true,
                Some(Waiting::Colon) => precedence == 0,
                Some(Waiting::Question | Waiting::Bracket(..)) | None => false,
            };
            if !binds {
                return;
            }
            let mut pop = || self.operands.pop().unwrap_or(Amount::Number(0.0));
            let value = match self.waiting.pop() {
                Some(Waiting::Binary(operator)) => {
                    let b = pop();
                    operator.apply(pop(), b)
                }
                Some(Waiting::Negate) => pop().negated(),
                Some(Waiting::Not) => pop().not(),
                Some(Waiting::Colon) => {
                    let (b, a, condition) = (pop(), pop(), pop());
                    match condition {
                        Amount::Number(0.0) => b,
                        Amount::Number(_) | Amount::Vector(..) => a,
                        Amount::Unknown(span) => Amount::Unknown(span),
                    }
                }
                Some(Waiting::Question | Waiting::Bracket(..)) | None => return,
            };
            self.operands.push(value);
        }
    }
}
