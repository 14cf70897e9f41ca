//! The offset: `f iso / (iso - t)`. The surface of level `iso - t` becomes that of iso: a positive t fattens,
//! a negative one thins.
//!
//! It is a factor and not a shift, so that what is 0 stays 0 and the support with it. `t` is in units of the
//! field and below iso; in units of length the surface moves by about t over the gradient, and never out of
//! the support.

use jbt_ir::Domain;

use super::limit::below;
use super::member::{Operator, Syntax, Unary};
use crate::diagnostic::Diagnostic;
use crate::member::member;

member! {
    /// The surface moved to where the field is less than the iso-value by this.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Offset = "offset" {
        /// In units of the field, below iso; outwards if it is positive.
        pub by: f64 [Real],
    }
}

impl Operator for Offset {
    const SYNTAX: Syntax = Syntax::Labelled;
    const ASKS_ISO: bool = true;

    fn fault(&self, iso: f64) -> Option<Diagnostic> {
        below("the offset", self.by, ("the iso-value", iso))
    }
}

impl Offset {
    fn factor(self, iso: f64) -> f64 {
        iso / (iso - self.by)
    }
}

impl Unary for Offset {
    const COLUMNS: &'static [&'static str] = &["factor"];

    fn push_columns(self, iso: f64, row: &mut Vec<f64>) {
        row.push(self.factor(iso));
    }

    fn field(self, f: f64, iso: f64) -> f64 {
        f * self.factor(iso)
    }

    fn kink_distance(self, _: f64, _: f64) -> f64 {
        f64::INFINITY
    }

    fn is_non_negative(self, child: bool, _: bool) -> bool {
        child
    }

    fn emit<D: Domain>(d: &mut D, f: D::Real, row: &[D::Real], _: D::Real) -> D::Real {
        let product = d.mul(f, row[0]);
        // A tiny negative field may round to -0, and nothing is -0.
        let zero = d.constant(0.0);
        d.add(product, zero)
    }
}
