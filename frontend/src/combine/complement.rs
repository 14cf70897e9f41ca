//! The complement: `2 iso - f` has the surface of f with inside and outside exchanged.
//!
//! It is signed, and 2 iso where f is 0: so its support is all of space, and a model whose root it is has to
//! be given a region. An intersection with something bounded is bounded again: `a & !b` reaches as far as a
//! and b do.

use jbt_ir::Domain;

use super::member::Unary;

/// See the module.
#[derive(Clone, Copy)]
pub(super) struct Complement;

impl Unary for Complement {
    const COLUMNS: &'static [&'static str] = &[];

    fn columns(self, _: &[f64], _: f64, _: &mut Vec<f64>) {}

    fn field(self, f: f64, _: &[f64], iso: f64) -> f64 {
        2.0 * iso - f
    }

    fn kink_distance(self, _: f64, _: &[f64], _: f64) -> f64 {
        f64::INFINITY
    }

    fn is_non_negative(self, _: bool, _: &[f64]) -> bool {
        false
    }

    fn emit<D: Domain>(self, d: &mut D, f: D::Real, _: &[D::Real], iso2: D::Real) -> D::Real {
        d.sub(iso2, f)
    }
}
