//! Words where a number is expected: names of numbers and of lists, functions, constants.

use super::{ParsedOperand, Stacks, Waiting};
use crate::program::known::{COUNT, Value};
use crate::scope::FormulaScope;
use crate::state::Parser;
use crate::words::{CONSTANTS, constant};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::function::Function;
use jbt_model::number::{Number, NumberFormula};
use jbt_model::report::{clip, nearest};

impl Parser<'_> {
    /// Takes a word that is next. Returns whether an operand is still wanted, or nothing after an error that
    /// has lost the place.
    pub(super) fn word_operand(&mut self, stacks: &mut Stacks) -> Option<bool> {
        let token = self.next();
        let word = self.text(token);
        let at = token.start as u32;
        if let Some(variable) = self.variable(word, token) {
            let span = Span::new(token.start, self.previous_end());
            stacks.push_variable(variable.ok()?, span);
            return Some(false);
        }
        if self.peek().is(b'[')
            && let Some(elements) = self.elements_named(word).cloned()
        {
            let at = self.next().start as u32;
            stacks.open_index(elements, at);
            return Some(true);
        }
        if word == COUNT && self.counts_elements() {
            let count = self.element_count()?;
            stacks.push(count, Span::new(token.start, self.previous_end()));
            return Some(false);
        }
        let parameter = self.parameter(word).is_some() && !self.peek().is(b'(');
        let function = Function::named(word).filter(|_| !parameter);
        if let Some(function) = function.or_else(|| self.falloff_function(word, token)) {
            if !self.peek().is(b'(') {
                self.report_and_mute(|| {
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
        if let Some(number) = self.parameter(word).cloned() {
            self.push_copy(stacks, &number, token.span())?;
        } else if self.no_number(word, token.span()) {
            return None;
        } else {
            let value = constant(word).unwrap_or_else(|| self.unknown_number(word, token.span()));
            stacks.push(value, token.span());
        }
        Some(false)
    }

    /// Whether what follows the word `count` is a list in parentheses, and no element of a vector behind a
    /// parameter of that name.
    fn counts_elements(&self) -> bool {
        let behind = self.peek_behind();
        let is_list = || self.elements_named(self.text(behind)).is_some();
        self.peek().is(b'(') && (self.parameter(COUNT).is_none() || is_list())
    }

    /// A number that has a name: of a formula, all steps are copied, which counts as text that is read.
    fn push_copy(&mut self, stacks: &mut Stacks, number: &Number, span: Span) -> Option<()> {
        let steps = number.formula().map_or(0, |formula| formula.steps().len());
        if steps > 1 && !self.charge_copy(steps, span) {
            return None;
        }
        stacks.push_number(number, span);
        Some(())
    }

    /// The element of a list whose place has just been closed; `span` holds all of it. Returns whether
    /// another place is wanted, as that is a list, too.
    pub(super) fn finish_index(&mut self, stacks: &mut Stacks, list: u32, span: Span) -> Option<bool> {
        let place = stacks.operands.pop()?;
        let elements = std::mem::replace(&mut stacks.lists[list as usize], Value::unknown());
        let steps = stacks.steps.split_off(place.first as usize);
        let number = match place.depends {
            true => Number::with_formula(place.value, NumberFormula::new(steps, None)),
            false => place.value.into(),
        };
        match self.element(&elements, &ParsedOperand { number, span: place.span })? {
            Value::Number(number) => {
                self.push_copy(stacks, &number, span)?;
                Some(false)
            }
            value => match value.count().filter(|_| self.peek().is(b'[')) {
                Some(_) => {
                    self.next();
                    stacks.open_index(value, span.start);
                    Some(true)
                }
                None => {
                    let kind = value.kind();
                    self.report_and_mute(|| {
                        Diagnostic::error(Some(span), format!("this element is {kind}"))
                            .expected("expected a number")
                    });
                    None
                }
            },
        }
    }

    fn unknown_number(&mut self, word: &str, span: Span) -> f64 {
        self.report_with(|parser| {
            let builtin = Function::ALL
                .iter()
                .map(|function| function.name())
                .chain(CONSTANTS.iter().map(|(name, _)| *name));
            let error = Diagnostic::error(Some(span), format!("no parameter is named `{}`", clip(word)));
            if parser.scope.is_some() && parser.lets.contains_key(word) {
                return error.expected(format!("perhaps `field({word})`"));
            }
            let here = parser.scope.iter().flat_map(FormulaScope::words);
            match nearest(word, parser.parameter_names().chain(builtin).chain(here)) {
                Some(near) => error.expected(format!("perhaps `{near}`")),
                None => error.expected(format!("declare it above: param {} = 1", clip(word))),
            }
        });
        f64::NAN
    }
}
