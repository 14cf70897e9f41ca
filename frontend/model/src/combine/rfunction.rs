//! R-functions by R_alpha: see [`rvachev`](super::rvachev).

use jbt_ir::{Domain, Rule};

use super::member::{Operator, PairResult, OperatorReach, Step};
use super::rvachev::{Family, RvachevOperation};
use super::set::SetOperation;
use crate::member::member;

member! {
    /// Union, intersection or difference by R_alpha.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct RFunction = "rfunction" {
        /// The set operation.
        pub set: SetOperation [Choice(SetOperation::WORDS)],
        /// From -0.9 (the roundest) through 0 (R_0) to 1 (minimum and maximum).
        pub alpha: f64 [Within { least: -0.9, most: 1.0 }] = Real(0.0),
    }
}

impl Operator for RFunction {}

impl RFunction {
    const fn operation(self) -> RvachevOperation {
        RvachevOperation(self.set, Family::Alpha)
    }
}

impl Step for RFunction {
    type Code = SetOperation;
    const COLUMNS: &'static [&'static str] = &["alpha", "rest"];

    fn code(self) -> SetOperation {
        self.set
    }

    fn push_columns(self, row: &mut Vec<f64>) {
        self.operation().columns(self.alpha, row);
    }

    fn pair(self, sides: [f64; 2], iso: f64) -> PairResult<f64> {
        self.operation().pair(sides, self.alpha, iso)
    }

    fn kink_distance(self, sides: [f64; 2], iso: f64) -> f64 {
        self.operation().kink_distance(sides, self.alpha, iso)
    }

    fn reach(self) -> OperatorReach {
        OperatorReach::Any
    }

    fn is_non_negative(self, _: [bool; 2]) -> bool {
        true
    }

    fn rule(_: SetOperation, _: bool) -> Rule {
        Rule::Never
    }

    fn emit<D: Domain>(
        set: SetOperation,
        d: &mut D,
        sides: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> PairResult<D::Real> {
        RvachevOperation(set, Family::Alpha).emit(d, sides, row, iso2)
    }
}
