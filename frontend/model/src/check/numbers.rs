//! The check of numbers: single numbers, several numbers, exponents and choices.

use std::fmt;
use std::ops::RangeInclusive;

use jbt_ir::limits;

use crate::diagnostic::{Diagnostic, Span};
use crate::expression::{Expression, Form, Formula};
use crate::number::{Number, NumberFormula};
use crate::report::Report;
use crate::word::{COORDINATES, FIELD};

/// Whether `value` is finite, at least `least` and not too large; an error otherwise.
pub(super) fn check_number(
    report: &mut Report,
    span: Option<Span>,
    what: impl fmt::Display,
    value: f64,
    least: f64,
) -> bool {
    let fault = if !value.is_finite() {
        "a finite number".to_owned()
    } else if value.abs() > limits::MAX_NUMBER {
        format!("a number of at most {:e}", limits::MAX_NUMBER)
    } else if value < least {
        if least == 0.0 {
            "a number of at least 0".to_owned()
        } else {
            format!("a number of at least {least:e}")
        }
    } else {
        return true;
    };
    report
        .add(|| Diagnostic::error(span, format!("{what} is {value}")).expected(format!("expected {fault}")));
    false
}

/// A number has to be in a range.
pub(super) fn check_within(
    report: &mut Report,
    span: Option<Span>,
    what: impl fmt::Display,
    value: f64,
    range: RangeInclusive<f64>,
) {
    // Written so that a NaN is refused as well.
    if !range.contains(&value) {
        report.add(|| {
            Diagnostic::error(span, format!("{what} is {value}")).expected(format!(
                "expected a number from {} to {}",
                range.start(),
                range.end()
            ))
        });
    }
}

/// Three numbers, or an error that shows all of them.
pub(super) fn check_numbers(
    report: &mut Report,
    span: Option<Span>,
    what: impl fmt::Display,
    values: &[f64],
    least: f64,
) {
    let good = |x: &f64| x.is_finite() && x.abs() <= limits::MAX_NUMBER && *x >= least;
    if !values.iter().all(good) {
        let shown: Vec<String> = values.iter().map(f64::to_string).collect();
        let at_least = match least {
            0.0 => " of at least 0".to_owned(),
            f64::NEG_INFINITY => String::new(),
            least => format!(" of at least {least:e}"),
        };
        report.add(|| {
            Diagnostic::error(span, format!("{what} is ({})", shown.join(" "))).expected(format!(
                "expected finite numbers{at_least}, at most {:e} in magnitude",
                limits::MAX_NUMBER
            ))
        });
    }
}

/// A whole number of at least 0 and not too large.
pub(super) fn check_count(report: &mut Report, span: Option<Span>, what: impl fmt::Display, value: f64) {
    // Written so that a NaN is refused as well.
    let fits = value.fract() == 0.0 && (0.0..=limits::MAX_COPIES).contains(&value);
    if !fits {
        report.add(|| {
            Diagnostic::error(span, format!("{what} is {value}"))
                .expected(format!("expected a whole number from 0 to {}", limits::MAX_COPIES))
        });
    }
}

/// Checks the elements of a list; the error names the first bad element.
pub(super) fn check_list<const N: usize>(
    report: &mut Report,
    span: Option<Span>,
    what: &dyn Fn(usize) -> String,
    elements: &[[f64; N]],
    least: f64,
) {
    let good = |x: &f64| x.is_finite() && x.abs() <= limits::MAX_NUMBER && *x >= least;
    if let Some(index) = elements.iter().position(|element| !element.iter().all(good)) {
        check_numbers(report, span, what(index), &elements[index], least);
    }
    if elements.len() > limits::MAX_SKELETON_POINTS {
        let message = format!("a list of {} elements", elements.len());
        let help = format!("expected at most {}", limits::MAX_SKELETON_POINTS);
        report.add(|| Diagnostic::limit(span, message).expected(help));
    }
}

/// The number of a selector, rounded, has to be the index of a child.
pub(super) fn check_choice(report: &mut Report, span: Option<Span>, which: f64, count: usize) {
    // Written so that a NaN is refused as well.
    let fits = (0.0..count as f64).contains(&which.round());
    if !fits && count > 0 {
        report.add(|| {
            Diagnostic::error(span, format!("the selector chooses child {which} of {count}"))
                .expected(format!("expected a number from 0 to {}; the nearest whole one counts", count - 1))
        });
    }
}

/// The numbers of a formula, its divisors, its box, its length, and its children.
pub(super) fn check_expression(
    report: &mut Report,
    span: Option<Span>,
    expression: &Expression,
    (values, children): (usize, usize),
) {
    let form = expression.form();
    if children != form.children() {
        let message =
            format!("the expression has {children} children and {} numbers", expression.numbers.len());
        let expected = format!("expected {} and {}", form.children(), form.numbers());
        report.add(|| Diagnostic::error(span, message).expected(expected));
        return;
    }
    if form.results.len() != values {
        let plural = if values == 1 { "" } else { "s" };
        let message = format!("the expression has {} values", form.results.len());
        report.add(|| Diagnostic::error(span, message).expected(format!("expected {values} value{plural}")));
    }
    if !check_formula(report, span, "the expression", form, &expression.numbers) {
        return;
    }
    if let Some(bounds) = expression.bounds().filter(|bounds| bounds.is_empty()) {
        let (low, high) = (bounds.low(), bounds.high());
        let message = format!("the box of the expression goes from {low:?} to {high:?}");
        let expected = "expected the smallest corner, then the largest";
        report.add(|| Diagnostic::error(span, message).expected(expected));
    }
}

/// Checks the numbers of a formula, its divisors and its length. Returns whether the numbers are valid.
pub(super) fn check_formula(
    report: &mut Report,
    span: Option<Span>,
    what: impl fmt::Display,
    form: &Form,
    numbers: &[f64],
) -> bool {
    if form.steps() > limits::MAX_EXPRESSION_STEPS {
        let message = format!("{what} has {} operations", form.steps());
        let expected = format!("expected at most {}", limits::MAX_EXPRESSION_STEPS);
        report.add(|| Diagnostic::limit(span, message).expected(expected));
    }
    let mut error = |message: String, expected: String| {
        report.add(|| Diagnostic::error(span, message).expected(expected));
    };
    if numbers.len() != form.numbers() {
        error(format!("{what} has {} numbers", numbers.len()), format!("expected {}", form.numbers()));
        return false;
    }
    for number in form.divisors() {
        if numbers[number] == 0.0 {
            error("division by zero".to_owned(), "expected a divisor that is not 0".to_owned());
        }
    }
    let good = |value: &&f64| !(value.is_finite() && value.abs() <= limits::MAX_NUMBER);
    let bad = numbers.iter().find(good);
    if let Some(value) = bad {
        let most = limits::MAX_NUMBER;
        let expected = format!("expected finite numbers, at most {most:e} in magnitude");
        error(format!("a number of {what} is {value}"), expected);
    }
    bad.is_none()
}

/// In a formula of a field some words are reserved, so parameters may not have these names.
pub(super) fn check_words(report: &mut Report, formula: &Formula, span: Option<Span>) {
    let numbers = formula.numbers.iter().filter_map(Number::formula);
    let mut names = numbers.flat_map(NumberFormula::parameters).map(|(name, _)| name);
    if let Some(name) = names.find(|name| COORDINATES.contains(&&***name) || &***name == FIELD) {
        report.add(|| {
            Diagnostic::error(span, format!("an expression mentions the parameter `{name}`"))
                .expected("expected another name: this word means something else there")
        });
    }
}
