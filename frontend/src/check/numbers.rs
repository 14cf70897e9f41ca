//! The check of numbers: of single ones, of several, of exponents and choices.

use std::ops::RangeInclusive;

use jbt_ir::limits;

use crate::diagnostic::{Diagnostic, Span};
use crate::report::Report;

/// Whether `value` is finite, at least `least` and not too large; an error otherwise.
pub(super) fn check_number(
    report: &mut Report,
    span: Option<Span>,
    what: &str,
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
    what: &str,
    value: f64,
    range: RangeInclusive<f64>,
) {
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
pub(super) fn check_numbers(report: &mut Report, span: Option<Span>, what: &str, values: &[f64], least: f64) {
    let good = |x: &f64| x.is_finite() && x.abs() <= limits::MAX_NUMBER && *x >= least;
    if !values.iter().all(good) {
        let shown: Vec<String> = values.iter().map(f64::to_string).collect();
        let at_least = if least == 0.0 { " of at least 0" } else { "" };
        report.add(|| {
            Diagnostic::error(span, format!("{what} is ({})", shown.join(" "))).expected(format!(
                "expected finite numbers{at_least}, at most {:e} in magnitude",
                limits::MAX_NUMBER
            ))
        });
    }
}

/// A whole number of at least 0 and not too large.
pub(super) fn check_count(report: &mut Report, span: Option<Span>, what: &str, value: f64) {
    // Written so that a NaN is refused as well.
    let fits = value.fract() == 0.0 && (0.0..=limits::MAX_COPIES).contains(&value);
    if !fits {
        report.add(|| {
            Diagnostic::error(span, format!("{what} is {value}"))
                .expected(format!("expected a whole number from 0 to {}", limits::MAX_COPIES))
        });
    }
}

/// The number of a selector has to be near the place of a child.
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

/// The exponent of a Ricci blend.
pub(super) fn check_exponent(report: &mut Report, span: Option<Span>, n: f64) {
    if !(1.0..=limits::MAX_RICCI_EXPONENT).contains(&n) {
        report.add(|| {
            Diagnostic::error(span, format!("the exponent of the Ricci blend is {n}"))
                .expected(format!("expected a number from 1 to {}", limits::MAX_RICCI_EXPONENT))
        });
    }
}
