//! The shell: a sheet around the surface, `max(0, iso - |f - iso|) iso / (iso - t / 2)`.
//!
//! `t` is the thickness in units of the field: inside is where f differs from iso by less than t / 2. In
//! units of length it is about t over the gradient. The field is largest, `iso^2 / (iso - t / 2)`, on the
//! child's surface, where its gradient jumps; it is 0 where the child's field is 0 (so the support stays),
//! and deep inside, from 2 iso on. A sheet of both sides needs t < 2 iso.

use jbt_ir::Domain;

use super::limit::below;
use super::member::{Operator, Syntax, Unary};
use crate::diagnostic::Diagnostic;
use crate::member::member;
use crate::skeleton::positive_part;

member! {
    /// A sheet around the surface.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Shell = "shell" {
        /// In units of the field: in (0, 2 iso).
        pub thickness: f64 [Positive],
    }
}

impl Operator for Shell {
    const SYNTAX: Syntax = Syntax::Labelled;
    const ASKS_ISO: bool = true;

    fn fault(&self, iso: f64) -> Option<Diagnostic> {
        below("the thickness of the shell", self.thickness, ("twice the iso-value", 2.0 * iso))
    }
}

impl Shell {
    /// What makes the field iso at half the thickness.
    fn factor(self, iso: f64) -> f64 {
        iso / (iso - 0.5 * self.thickness)
    }
}

impl Unary for Shell {
    const COLUMNS: &'static [&'static str] = &["factor"];

    fn push_columns(self, iso: f64, row: &mut Vec<f64>) {
        row.push(self.factor(iso));
    }

    fn field(self, f: f64, iso: f64) -> f64 {
        (iso - (f - iso).abs()).max(0.0) * self.factor(iso)
    }

    fn kink_distance(self, f: f64, iso: f64) -> f64 {
        (f - iso).abs().min(f.abs()).min((f - 2.0 * iso).abs())
    }

    fn is_non_negative(self, _: bool, _: bool) -> bool {
        true
    }

    fn emit<D: Domain>(d: &mut D, f: D::Real, row: &[D::Real], iso2: D::Real) -> D::Real {
        // Halving is exact, so that a field of 0 gives 0.
        let half = d.constant(0.5);
        let iso = d.mul(iso2, half);
        let difference = d.sub(f, iso);
        let away = d.abs(difference);
        let left = d.sub(iso, away);
        let left = positive_part(d, left);
        d.mul(left, row[0])
    }
}
