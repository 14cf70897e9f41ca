//! The offset: `f iso / (iso - t)`. The surface of level `iso - t` becomes that of iso: a positive t fattens,
//! a negative one thins.
//!
//! It is a factor and not a shift, so that what is 0 stays 0 and the support with it. `t` is in units of the
//! field and below iso; in units of length the surface moves by about t over the gradient, and never out of
//! the support.

use jbt_ir::Domain;

use super::member::Unary;

/// See the module.
#[derive(Clone, Copy)]
pub(super) struct Offset;

fn factor(by: f64, iso: f64) -> f64 {
    iso / (iso - by)
}

impl Unary for Offset {
    const COLUMNS: &'static [&'static str] = &["factor"];

    fn columns(self, numbers: &[f64], iso: f64, row: &mut Vec<f64>) {
        row.push(factor(numbers[0], iso));
    }

    fn field(self, f: f64, numbers: &[f64], iso: f64) -> f64 {
        f * factor(numbers[0], iso)
    }

    fn kink_distance(self, _: f64, _: &[f64], _: f64) -> f64 {
        f64::INFINITY
    }

    fn is_non_negative(self, child: bool, _: &[f64]) -> bool {
        child
    }

    fn emit<D: Domain>(self, d: &mut D, f: D::Real, row: &[D::Real], _: D::Real) -> D::Real {
        let product = d.mul(f, row[0]);
        // A tiny negative field may round to -0, and nothing is -0.
        let zero = d.constant(0.0);
        d.add(product, zero)
    }
}
