//! The complement: `2 iso - f` has the surface of f with inside and outside exchanged.
//!
//! It is signed, and 2 iso where f is 0: so its support is all of space, and a model whose root it is has to
//! be given a region. An intersection with something bounded is bounded again: `a & !b` reaches as far as a
//! and b do.

use jbt_ir::Domain;

use super::member::{Operator, Unary};
use crate::member::member;

member! {
    /// Inside and outside exchanged: `2 iso - f`. It is unbounded.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Complement = "complement" {}
}

impl Operator for Complement {}

impl Unary for Complement {
    const REVERSES: bool = true;

    fn field(self, f: f64, iso: f64) -> f64 {
        2.0 * iso - f
    }

    fn kink_distance(self, _: f64, _: f64) -> f64 {
        f64::INFINITY
    }

    fn is_non_negative(self, _: bool, _: bool) -> bool {
        false
    }

    fn emit<D: Domain>(d: &mut D, f: D::Real, _: &[D::Real], iso2: D::Real) -> D::Real {
        d.sub(iso2, f)
    }
}
