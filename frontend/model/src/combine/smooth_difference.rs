//! The smooth difference: see [`smooth`](super::smooth).

use jbt_ir::{Domain, Rule};

use super::member::{Operator, PairResult, OperatorReach, Step, Syntax};
use super::set::SetOperation;
use super::smooth;
use crate::member::member;

member! {
    /// A difference that rounds where two fields differ by less than a width.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct SmoothDifference = "smooth_difference" {
        /// In units of the field.
        pub width: f64 [Positive],
    }
}

impl Operator for SmoothDifference {
    const SYNTAX: Syntax = Syntax::Labelled;
}

impl Step for SmoothDifference {
    type Code = ();
    const COLUMNS: &'static [&'static str] = smooth::COLUMNS;

    fn code(self) {}

    fn push_columns(self, row: &mut Vec<f64>) {
        smooth::push_columns(self.width, row);
    }

    fn pair(self, sides: [f64; 2], iso: f64) -> PairResult<f64> {
        smooth::pair(SetOperation::Difference, sides, self.width, iso)
    }

    fn kink_distance(self, sides: [f64; 2], iso: f64) -> f64 {
        smooth::kink_distance(SetOperation::Difference, sides, iso)
    }

    fn reach(self) -> OperatorReach {
        OperatorReach::Left
    }

    fn is_non_negative(self, [left, _]: [bool; 2]) -> bool {
        left
    }

    /// One zero limits the others to 0, or to 2 iso, and then the next changes nothing.
    fn rule((): (), _: bool) -> Rule {
        Rule::KeepOne
    }

    fn emit<D: Domain>(
        (): (),
        d: &mut D,
        sides: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> PairResult<D::Real> {
        smooth::emit(SetOperation::Difference, d, sides, row, iso2)
    }
}
