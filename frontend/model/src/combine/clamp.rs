//! The clamp: the field, but at least `low` and at most `high`.
//!
//! With `low <= 0 <= high` the support stays; else the field is `low`, or `high`, where the child's is 0,
//! which is everywhere. A clamp to an interval that does not hold iso leaves no surface. Gradients jump where
//! the field meets a limit.

use jbt_ir::Domain;

use super::member::{Operator, Unary};
use crate::diagnostic::Diagnostic;
use crate::member::member;

member! {
    /// The field, but at least `low` and at most `high`.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Clamp = "clamp" {
        /// The smallest value.
        pub low: f64 [Real],
        /// The largest value.
        pub high: f64 [Real],
    }
}

impl Operator for Clamp {
    fn fault(&self, _: f64) -> Option<Diagnostic> {
        let Self { low, high } = self;
        (low > high).then(|| {
            Diagnostic::error(None, format!("the clamp is from {low} to {high}"))
                .expected("expected the low end to be at most the high end")
        })
    }
}

impl Unary for Clamp {
    const COLUMNS: &'static [&'static str] = &["low", "high"];

    fn push_columns(self, _: f64, row: &mut Vec<f64>) {
        // Adding 0 takes the sign from a zero: no field is -0.
        row.extend([self.low + 0.0, self.high + 0.0]);
    }

    fn field(self, f: f64, _: f64) -> f64 {
        f.max(self.low).min(self.high)
    }

    fn kink_distance(self, f: f64, _: f64) -> f64 {
        (f - self.low).abs().min((f - self.high).abs())
    }

    fn is_non_negative(self, child: bool, fixed: bool) -> bool {
        fixed && self.high >= 0.0 && (child || self.low >= 0.0)
    }

    fn emit<D: Domain>(d: &mut D, f: D::Real, row: &[D::Real], _: D::Real) -> D::Real {
        let above = d.max(row[0], f);
        d.min(row[1], above)
    }
}
