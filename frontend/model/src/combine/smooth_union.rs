//! The smooth union: see [`smooth`](super::smooth).

use jbt_ir::{Domain, Rule};

use super::member::{Operator, PairResult, OperatorReach, Step, Syntax};
use super::set::SetOperation;
use super::smooth;
use crate::member::member;

member! {
    /// A union that rounds where two fields differ by less than a width.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct SmoothUnion = "smooth_union" {
        /// In units of the field.
        pub width: f64 [Positive],
    }
}

impl Operator for SmoothUnion {
    const SYNTAX: Syntax = Syntax::Labelled;
}

impl Step for SmoothUnion {
    type Code = ();
    const COLUMNS: &'static [&'static str] = smooth::COLUMNS;

    fn code(self) {}

    fn push_columns(self, row: &mut Vec<f64>) {
        smooth::push_columns(self.width, row);
    }

    fn pair(self, sides: [f64; 2], iso: f64) -> PairResult<f64> {
        smooth::pair(SetOperation::Union, sides, self.width, iso)
    }

    fn kink_distance(self, sides: [f64; 2], iso: f64) -> f64 {
        smooth::kink_distance(SetOperation::Union, sides, iso)
    }

    fn reach(self) -> OperatorReach {
        OperatorReach::Any
    }

    fn is_non_negative(self, [left, right]: [bool; 2]) -> bool {
        left || right
    }

    fn rule((): (), non_negative: bool) -> Rule {
        if non_negative { Rule::Neutral } else { Rule::KeepOne }
    }

    fn emit<D: Domain>(
        (): (),
        d: &mut D,
        sides: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> PairResult<D::Real> {
        smooth::emit(SetOperation::Union, d, sides, row, iso2)
    }
}
