//! Directives: declarations, loops and choices. They may stand wherever something new may begin.

use jbt_ir::limits::MAX_BLOCK_DEPTH;
use jbt_model::diagnostic::{Diagnostic, Span};

use super::amount::Amount;
use super::colors;
use super::open::{PovBlock, PovFrame};
use super::scan::PovToken;
use super::script::{PovValue, Script};

/// How far beyond its last value a loop may go, for rounding.
const SLACK: f64 = 1e-10;

/// Bytes of a loop that count as a step each time around.
const STEP_BYTES: usize = 8;

impl Script<'_> {
    /// A directive, whose `#` has been read.
    pub(super) fn directive(&mut self) -> Result<(), Diagnostic> {
        let (word, span) = self.scanner.expect_word("the name of a directive")?;
        self.spend(1, span)?;
        match word {
            "declare" | "local" => self.declaration(),
            "undef" => {
                let (name, _) = self.scanner.expect_word("a name")?;
                self.forget(name);
                Ok(())
            }
            "if" => {
                let holds = self.condition()?;
                self.branch(holds, span)
            }
            "ifdef" | "ifndef" => {
                self.scanner.expect(b'(')?;
                let (name, _) = self.scanner.expect_word("a name")?;
                let known = self.value(name).is_some() || colors::color(name).is_some();
                if self.scanner.peek()?.0 == PovToken::Mark(b'[') {
                    self.skip_balanced(b'[', b']')?;
                }
                self.scanner.expect(b')')?;
                self.branch(known == (word == "ifdef"), span)
            }
            "else" | "elseif" => match self.blocks.pop() {
                Some((PovBlock::If | PovBlock::Switch, begin)) => self.skip_to_end(begin).map(|_| ()),
                _ => Err(lonely(word, span)),
            },
            "while" => {
                let condition = self.scanner.place();
                self.turn(condition, span)
            }
            "for" => self.for_loop(span),
            "switch" => self.switch(span),
            "case" | "range" => match self.blocks.last() {
                // The case before goes on into this one.
                Some((PovBlock::Switch, _)) => self.skip_balanced(b'(', b')'),
                _ => Err(lonely(word, span)),
            },
            "break" => self.break_out(span),
            "end" => self.end(span),
            "include" => self.include(span),
            "macro" => self.macro_definition(span),
            "version" => self.version(),
            "default" => {
                self.scanner.expect(b'{')?;
                self.open(PovFrame::default_look(), span)
            }
            "debug" | "warning" | "statistics" | "render" => self.text_line(),
            "error" => Err(Diagnostic::error(Some(span), "the scene itself ends here with an error")),
            _ => {
                let message = format!("the directive #{} is not read", self.scanner.shown(span));
                Err(Diagnostic::error(Some(span), message))
            }
        }
    }

    fn block(&mut self, block: PovBlock, span: Span) -> Result<(), Diagnostic> {
        if self.blocks.len() == MAX_BLOCK_DEPTH {
            let message = format!("more than {MAX_BLOCK_DEPTH} directives within each other");
            return Err(Diagnostic::limit(Some(span), message));
        }
        self.blocks.push((block, span));
        Ok(())
    }

    /// Takes the first branch of a choice, or looks for another one.
    fn branch(&mut self, holds: bool, span: Span) -> Result<(), Diagnostic> {
        if holds {
            return self.block(PovBlock::If, span);
        }
        loop {
            match self.skip(span, &["else", "elseif", "end"])? {
                "else" => return self.block(PovBlock::If, span),
                "elseif" => {
                    if self.condition()? {
                        return self.block(PovBlock::If, span);
                    }
                }
                _ => return Ok(()),
            }
        }
    }

    /// Evaluates the condition of a loop, and goes around once more or behind it.
    fn turn(&mut self, condition: usize, span: Span) -> Result<(), Diagnostic> {
        let asked = self.asked;
        if self.condition()? {
            let constant = self.asked == asked;
            return self.block(PovBlock::While { condition, constant }, span);
        }
        self.skip_to_end(span).map(|_| ())
    }

    fn for_loop(&mut self, span: Span) -> Result<(), Diagnostic> {
        self.scanner.expect(b'(')?;
        let (name, _) = self.scanner.expect_word("the name of the counter")?;
        let name = name.to_owned();
        let mut numbers = [0.0, 0.0, 1.0];
        let mut count = 0;
        while self.scanner.accept(b',')? {
            let at = self.scanner.peek()?.1;
            let amount = self.expression()?;
            let number = self.real(amount, at)?;
            *numbers.get_mut(count).ok_or_else(|| Diagnostic::error(Some(at), "too many numbers"))? = number;
            count += 1;
        }
        self.scanner.expect(b')')?;
        let [value, last, step] = numbers;
        if count < 2 || step == 0.0 {
            let error = Diagnostic::error(Some(span), "the loop has no range");
            return Err(error.expected("expected (name, first, last), with a step that is not 0"));
        }
        let body = self.scanner.place();
        self.count_on(PovBlock::For { name, value, last, step, body }, span)
    }

    /// Goes around a counting loop, or behind it.
    fn count_on(&mut self, block: PovBlock, span: Span) -> Result<(), Diagnostic> {
        let PovBlock::For { name, value, last, step, .. } = &block else { return Ok(()) };
        let over = if *step > 0.0 { *value > last + SLACK } else { *value < last - SLACK };
        let value = PovValue::Amount(Amount::Number(*value));
        let name = name.clone();
        self.declare(&name, value);
        if over { self.skip_to_end(span).map(|_| ()) } else { self.block(block, span) }
    }

    /// Goes to the case of a value.
    fn switch(&mut self, span: Span) -> Result<(), Diagnostic> {
        self.scanner.expect(b'(')?;
        let amount = self.expression()?;
        let value = self.real(amount, span)?;
        self.scanner.expect(b')')?;
        loop {
            match self.skip(span, &["case", "range", "else", "end"])? {
                "else" => return self.block(PovBlock::Switch, span),
                "end" => return Ok(()),
                word => {
                    self.scanner.expect(b'(')?;
                    let amount = self.expression()?;
                    let low = self.real(amount, span)?;
                    let mut high = low;
                    if word == "range" {
                        self.scanner.expect(b',')?;
                        let amount = self.expression()?;
                        high = self.real(amount, span)?;
                    }
                    self.scanner.expect(b')')?;
                    if value >= low - SLACK && value <= high + SLACK {
                        return self.block(PovBlock::Switch, span);
                    }
                }
            }
        }
    }

    /// Ends the innermost loop or case.
    fn break_out(&mut self, span: Span) -> Result<(), Diagnostic> {
        loop {
            match self.blocks.pop() {
                Some((PovBlock::If, begin)) => {
                    self.skip_to_end(begin)?;
                }
                Some((_, begin)) => return self.skip_to_end(begin).map(|_| ()),
                None => return Err(lonely("break", span)),
            }
        }
    }

    fn end(&mut self, span: Span) -> Result<(), Diagnostic> {
        let behind = self.scanner.place();
        match self.blocks.pop() {
            None => Err(lonely("end", span)),
            Some((PovBlock::If | PovBlock::Switch, _)) => Ok(()),
            Some((PovBlock::While { condition, constant }, begin)) => {
                if constant && !self.scanner.holds(condition, behind, b"break") {
                    let error = Diagnostic::error(Some(begin), "the loop never ends");
                    return Err(error.expected("expected a condition that can change"));
                }
                self.spend(1 + (behind - condition) / STEP_BYTES, begin)?;
                self.scanner.go(condition);
                self.turn(condition, begin)
            }
            Some((PovBlock::For { name, value, last, step, body }, begin)) => {
                self.spend(1 + (behind - body) / STEP_BYTES, begin)?;
                self.scanner.go(body);
                self.count_on(PovBlock::For { name, value: value + step, last, step, body }, begin)
            }
        }
    }

    /// Goes behind the `#end` of a directive.
    fn skip_to_end(&mut self, span: Span) -> Result<&'static str, Diagnostic> {
        self.skip(span, &["end"])
    }

    /// Goes behind the next of some directives that belongs to this one.
    fn skip(&mut self, begin: Span, wanted: &[&'static str]) -> Result<&'static str, Diagnostic> {
        let mut depth = 0usize;
        loop {
            let (token, _) = self.scanner.next()?;
            match token {
                PovToken::End => {
                    let error = Diagnostic::error(Some(begin), "the directive has no end");
                    return Err(error.expected("expected `#end`"));
                }
                PovToken::Mark(b'#') => {}
                _ => continue,
            }
            let Some(word) = self.scanner.peek_word()? else { continue };
            self.scanner.next()?;
            if depth == 0
                && let Some(found) = wanted.iter().find(|one| **one == word)
            {
                return Ok(found);
            }
            match word {
                "if" | "ifdef" | "ifndef" | "while" | "for" | "switch" | "macro" => depth += 1,
                "end" => depth = depth.saturating_sub(1),
                _ => {}
            }
        }
    }

    /// `NAME = value`, with or without a semicolon.
    fn declaration(&mut self) -> Result<(), Diagnostic> {
        let (name, span) = self.scanner.expect_word("a name")?;
        if self.scanner.peek()?.0 == PovToken::Mark(b'[') {
            // An array's member: no name of its own, so its value has no reader.
            self.skip_balanced(b'[', b']')?;
        }
        self.scanner.expect(b'=')?;
        let name = name.to_owned();
        if let Some(value) = self.begin_value(&name, span)? {
            self.declare(&name, value);
            self.scanner.accept(b';')?;
        }
        Ok(())
    }

    /// A macro, which is kept by name alone.
    fn macro_definition(&mut self, span: Span) -> Result<(), Diagnostic> {
        let (name, _) = self.scanner.expect_word("a name")?;
        let name = name.to_owned();
        self.skip_to_end(span)?;
        self.declare(&name, PovValue::Other);
        Ok(())
    }

    fn version(&mut self) -> Result<(), Diagnostic> {
        while matches!(self.scanner.peek_word()?, Some("unofficial" | "official" | "patch")) {
            self.scanner.next()?;
        }
        self.expression()?;
        self.scanner.accept(b';')?;
        Ok(())
    }

    /// What a directive says to people.
    fn text_line(&mut self) -> Result<(), Diagnostic> {
        self.expression()?;
        self.scanner.accept(b';')?;
        Ok(())
    }
}

fn lonely(word: &str, span: Span) -> Diagnostic {
    Diagnostic::error(Some(span), format!("#{word} has no beginning"))
}
