//! Limits of numbers by the iso-value.

use crate::diagnostic::Diagnostic;

/// The fault of a number of the field that has to stay below a limit, so far that the rest is a number of
/// f32.
pub(super) fn below(what: &str, value: f64, (name, limit): (&str, f64)) -> Option<Diagnostic> {
    // Written so that a NaN limit, whose error has been told, is none.
    (value > limit * (1.0 - 1e-6)).then(|| {
        Diagnostic::error(None, format!("{what} is {value}"))
            .expected(format!("expected a number below {name}, {limit}"))
    })
}
