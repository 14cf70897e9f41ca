//! Parameters of a text: their defaults, ranges and labels.

use super::expression::ExpressionPlace;
use super::lex::{RANGE, TokenKind};
use super::state::Parser;
use super::words::is_builtin;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::parameter::{Fixture, Parameter, ParameterRange};
use jbt_model::report::clip;
use jbt_model::word::normalized;

impl Parser<'_> {
    pub(super) fn param_statement(&mut self) {
        let Some((name, span)) = self.name("parameter") else {
            return;
        };
        self.equals();
        let lost = self.is_muted();
        let default = if lost { f64::NAN.into() } else { self.expression(ExpressionPlace::Alone).number };
        if is_builtin(name) {
            self.report(|| Diagnostic::error(Some(span), format!("`{name}` means something else already")));
        } else if self.references.contains_key(name) {
            self.report(|| Diagnostic::error(Some(span), format!("a second parameter `{}`", clip(name))));
        } else if self.program.value(name).is_some() {
            self.report(|| Diagnostic::error(Some(span), format!("a second `{}`", clip(name))));
        } else {
            let set = self.options.parameters.iter().rev().find(|(set, _)| normalized(set) == name);
            let setting = set.map(|&(_, value)| value);
            let parameter = Parameter::declared(name, default, setting, span);
            let parameter = if lost { parameter } else { self.control(parameter) };
            if self.program.out_of_range.is_none() && !parameter.value().is_nan() {
                self.program.out_of_range = parameter.out_of_range();
            }
            self.references.insert(name, parameter.reference());
            self.parameters.push(parameter);
        }
    }

    /// What may stand behind the default of a parameter: `in LOW .. HIGH step STEP "Label"`.
    fn control(&mut self, mut parameter: Parameter) -> Parameter {
        if self.peek_word() == Some("in") {
            let start = self.next().start;
            let number = |parser: &mut Self| {
                let operand = parser.expression(ExpressionPlace::Alone);
                parser.declares(Fixture::Declaration, &operand.number, operand.span);
                operand.number.value()
            };
            let low = number(self);
            if self.accept(RANGE).is_none() {
                self.expected_at(self.peek(), "expected `..` and the largest value");
                return parameter;
            }
            let high = number(self);
            let step = self.accept_word("step").then(|| number(self));
            let range = ParameterRange { low, high, step };
            let span = Span::new(start, self.previous_end());
            match range.fault().filter(|_| !(low.is_nan() || high.is_nan())) {
                Some(fault) => {
                    self.report(|| {
                        Diagnostic::error(Some(span), "this range makes no sense").expected(fault)
                    });
                }
                None => parameter = parameter.within(range),
            }
        }
        if self.peek().kind == TokenKind::Quoted {
            let token = self.next();
            parameter = parameter.labelled(self.text(token).trim_matches('"'));
        }
        parameter
    }
}
