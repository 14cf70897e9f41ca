//! Named parameters of a model: what stands in its formulas and can be set at run time.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use crate::diagnostic::{Diagnostic, Span};
use crate::function::Function;
use crate::number::{Number, NumberFormula, ParameterValues, Step};
use crate::report::{clip, nearest};
use crate::tree::Tree;
use crate::word::{is_identifier, is_statement, normalized};

/// A named parameter of a model.
#[derive(Clone, Debug)]
pub struct Parameter {
    pub(crate) name: Arc<str>,
    /// May depend on parameters before this one; evaluated for their present values.
    pub(crate) default: Number,
    /// What was set instead of the default.
    pub(crate) setting: Option<f64>,
    /// Where it is declared in its source text.
    pub(crate) span: Option<Span>,
    /// Where it stands in what stays as it was read.
    pub(crate) declares: Option<(Fixture, Span)>,
    /// Which values it may have.
    pub(crate) range: Option<ParameterRange>,
    /// What people call it.
    pub(crate) label: Option<Arc<str>>,
}

/// What stays as it was read, so that a parameter that it depends on can only be set before.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Fixture {
    /// A declaration of attributes, or of the origin.
    Declaration,
    /// A loop or a condition, which decides which nodes there are.
    Expansion,
}

/// The values that a parameter may have, and how far apart a slider puts them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ParameterRange {
    /// The smallest value.
    pub low: f64,
    /// The largest value.
    pub high: f64,
    /// From one value of a slider to the next, above 0: a hint, other values in the range are fine.
    pub step: Option<f64>,
}

impl ParameterRange {
    /// Whether a value is in the range. Any multiple of the step and what is between are.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// What is wrong with the range.
    #[must_use]
    pub fn fault(&self) -> Option<&'static str> {
        let finite = self.low.is_finite() && self.high.is_finite() && self.step.is_none_or(f64::is_finite);
        if !(finite && self.low < self.high) {
            Some("expected the smallest value, then a larger one")
        } else if self.step.is_some_and(|step| step <= 0.0 || step > self.high - self.low) {
            Some("expected a step above 0, at most as large as the range")
        } else {
            None
        }
    }
}

impl Parameter {
    /// A parameter that nobody has set.
    #[must_use]
    pub fn new(name: &str, default: impl Into<Number>) -> Self {
        let (name, default) = (normalized(name).into(), default.into());
        Self { name, default, setting: None, span: None, declares: None, range: None, label: None }
    }

    /// The same that may have the values of a range alone; others are errors, also those that are set.
    #[must_use]
    pub fn within(self, range: ParameterRange) -> Self {
        Self { range: Some(range), ..self }
    }

    /// The same with words that people know it by.
    #[must_use]
    pub fn labelled(self, label: &str) -> Self {
        Self { label: Some(label.into()), ..self }
    }

    /// Which values it may have, if not any.
    #[must_use]
    pub fn range(&self) -> Option<ParameterRange> {
        self.range
    }

    /// The words that people know it by.
    #[must_use]
    pub fn label(&self) -> Option<&str> {
        self.label.as_deref()
    }

    /// The message about a value that is out of its range.
    #[must_use]
    pub fn out_of_range(&self) -> Option<Diagnostic> {
        let range = self.range.filter(|range| !range.contains(self.value()))?;
        let message = format!("the parameter `{}` is {}", clip(&self.name), self.value());
        let expected = format!("expected a number from {} to {}", range.low, range.high);
        Some(Diagnostic::error(self.span, message).expected(expected))
    }

    /// A parameter that a text declares at a place; `setting`: what was set instead of its default.
    #[must_use]
    pub fn declared(name: &str, default: Number, setting: Option<f64>, span: Span) -> Self {
        Self { setting, span: Some(span), ..Self::new(name, default) }
    }

    /// The number that is this parameter.
    #[must_use]
    pub fn reference(&self) -> Number {
        let step = Step::Parameter { name: Arc::clone(&self.name), default: self.value() };
        Number::with_formula(self.value(), NumberFormula::new(vec![step], None))
    }

    /// Notes what depends on the parameter and stays as it was read: no setting reaches it.
    pub fn declares(&mut self, what: Fixture, span: Span) {
        self.declares = Some((what, span));
    }

    /// What stays as it was read, and depends on it: setting it takes reading the text again.
    #[must_use]
    pub fn fixture(&self) -> Option<Fixture> {
        self.declares.map(|(what, _)| what)
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The present value of its default. It may depend on the parameters before this one.
    #[must_use]
    pub fn default(&self) -> f64 {
        self.default.value()
    }

    /// Its value: the default, unless another one was set.
    #[must_use]
    pub fn value(&self) -> f64 {
        self.setting.unwrap_or_else(|| self.default())
    }

    /// Where it is declared in its source text.
    #[must_use]
    pub fn span(&self) -> Option<Span> {
        self.span
    }

    /// What its value comes from.
    pub fn source(&self) -> Number {
        self.setting.map_or_else(|| self.default.clone(), Number::from)
    }
}

impl PartialEq for Parameter {
    /// The same name and range, and a value that comes from the same number: one that is set to its default
    /// is one that has it.
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
            && self.range == other.range
            && self.label == other.label
            && self.source() == other.source()
    }
}

/// Evaluates all parameters, in order. An error names the place of a formula, if it has one.
pub(crate) fn refresh(parameters: &mut [Parameter]) -> Result<ParameterValues, Vec<Diagnostic>> {
    let (mut known, mut errors) = (ParameterValues::new(), Vec::new());
    for parameter in parameters {
        match parameter.default.refreshed(&known) {
            Ok(default) => parameter.default = default,
            // A default that is not used need not make sense.
            Err(_) if parameter.setting.is_some() => {}
            Err(error) => errors.push(error),
        }
        known.insert(Arc::clone(&parameter.name), parameter.value());
    }
    if errors.is_empty() { Ok(known) } else { Err(errors) }
}

/// Whether a name may be that of a parameter: a formula with it reads back as it was.
pub(crate) fn is_name(name: &str) -> bool {
    let builtin =
        Function::named(name).is_some_and(Function::is_reserved) || name == "pi" || is_statement(name);
    !builtin && is_identifier(name)
}

/// Adds the parameters that stand in a tree and not in the list, each with the default that its first use
/// gives it. Two uses with different defaults are an error.
pub(crate) fn collect(
    declared: &[Parameter],
    iso: &Number,
    root: &Tree,
) -> (Vec<Parameter>, Vec<Diagnostic>) {
    let mut all = Collector { parameters: declared.to_vec(), ..Collector::default() };
    for parameter in declared {
        // What a text declares stands, whatever its uses remember; defaults of Rust are given by every use.
        let given = (parameter.span.is_none() && !parameter.default.depends_on_parameters())
            .then(|| parameter.default());
        all.defaults.insert(Arc::clone(&parameter.name), given);
    }
    all.take(iso.formula(), None);
    // Only what mentions parameters is visited.
    let mut stack: Vec<&Tree> = vec![root];
    let mut seen = HashSet::new();
    while let Some(tree) = stack.pop() {
        if !tree.node().depends_on_parameters() || !seen.insert(tree.identity()) {
            continue;
        }
        for number in tree.node().written().dependent_numbers() {
            all.take(number.formula(), tree.node().span());
        }
        stack.extend(tree.node().children().iter().rev());
    }
    (all.parameters, all.errors)
}

#[derive(Default)]
struct Collector {
    parameters: Vec<Parameter>,
    /// The default that every use has to give, of each parameter; nothing if uses do not matter.
    defaults: HashMap<Arc<str>, Option<f64>>,
    errors: Vec<Diagnostic>,
}

impl Collector {
    fn take(&mut self, formula: Option<&NumberFormula>, span: Option<Span>) {
        for (name, default) in formula.into_iter().flat_map(NumberFormula::parameters) {
            let first = *self.defaults.entry(Arc::clone(name)).or_insert_with(|| {
                self.parameters.push(Parameter { name: Arc::clone(name), ..Parameter::new("", default) });
                Some(default)
            });
            if let Some(first) = first
                && first.to_bits() != default.to_bits()
            {
                let message =
                    format!("the parameter `{}` has two defaults: {first} and {default}", clip(name));
                self.errors.push(Diagnostic::error(span, message));
            }
        }
    }
}

/// The message about a parameter that is not there.
pub fn unknown(name: &str, parameters: &[Parameter]) -> Diagnostic {
    const SHOWN: usize = 20;
    let error = Diagnostic::error(None, format!("the model has no parameter `{}` to set", clip(name)));
    let names = || parameters.iter().map(Parameter::name);
    let known: Vec<&str> = names().take(SHOWN).collect();
    error.expected(match (nearest(name, names()), known.len()) {
        (_, 0) => "it has none".to_owned(),
        (Some(near), _) => format!("perhaps `{near}`; it has {}", known.join(", ")),
        (None, _) => format!("it has {}", known.join(", ")),
    })
}

/// The message about a value that is no number.
pub fn not_finite(name: &str) -> Diagnostic {
    Diagnostic::error(None, format!("the value of `{}` is not finite", clip(name)))
}
