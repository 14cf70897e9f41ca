//! The clamp: the field, but at least `low` and at most `high`.
//!
//! With `low <= 0 <= high` the support stays; else the field is `low`, or `high`, where the child's is 0,
//! which is everywhere. A clamp to an interval that does not hold iso leaves no surface. Gradients jump where
//! the field meets a limit.

use jbt_ir::Domain;

use super::member::Unary;

/// See the module.
#[derive(Clone, Copy)]
pub(super) struct Clamp;

impl Unary for Clamp {
    const COLUMNS: &'static [&'static str] = &["low", "high"];

    fn columns(self, numbers: &[f64], _: f64, row: &mut Vec<f64>) {
        // Adding 0 takes the sign from a zero: no field is -0.
        row.extend(numbers.iter().map(|number| number + 0.0));
    }

    fn field(self, f: f64, numbers: &[f64], _: f64) -> f64 {
        f.max(numbers[0]).min(numbers[1])
    }

    fn kink_distance(self, f: f64, numbers: &[f64], _: f64) -> f64 {
        (f - numbers[0]).abs().min((f - numbers[1]).abs())
    }

    fn is_non_negative(self, child: bool, numbers: &[f64]) -> bool {
        numbers[1] >= 0.0 && (child || numbers[0] >= 0.0)
    }

    fn emit<D: Domain>(self, d: &mut D, f: D::Real, row: &[D::Real], _: D::Real) -> D::Real {
        let above = d.max(row[0], f);
        d.min(row[1], above)
    }
}
