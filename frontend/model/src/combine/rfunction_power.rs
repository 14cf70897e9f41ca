//! R-functions by R_p: see [`rvachev`](super::rvachev).

use jbt_ir::{Domain, Rule};

use super::member::{Operator, PairResult, OperatorReach, Step};
use super::rvachev::{Family, RvachevOperation};
use super::set::SetOperation;
use crate::member::member;

member! {
    /// Union, intersection or difference by R_p.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct RFunctionPower = "rfunction" {
        /// The set operation.
        pub set: SetOperation [Choice(SetOperation::WORDS)],
        /// p: 2 is R_0.
        pub power: f64 [Within { least: 1.1, most: 64.0 }],
    }
}

impl Operator for RFunctionPower {}

impl RFunctionPower {
    const fn operation(self) -> RvachevOperation {
        RvachevOperation(self.set, Family::Power)
    }
}

impl Step for RFunctionPower {
    type Code = SetOperation;
    const COLUMNS: &'static [&'static str] = &["power", "inverse_power", "rest"];

    fn code(self) -> SetOperation {
        self.set
    }

    fn push_columns(self, row: &mut Vec<f64>) {
        self.operation().columns(self.power, row);
    }

    fn pair(self, sides: [f64; 2], iso: f64) -> PairResult<f64> {
        self.operation().pair(sides, self.power, iso)
    }

    fn kink_distance(self, sides: [f64; 2], iso: f64) -> f64 {
        self.operation().kink_distance(sides, self.power, iso)
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
        RvachevOperation(set, Family::Power).emit(d, sides, row, iso2)
    }
}
