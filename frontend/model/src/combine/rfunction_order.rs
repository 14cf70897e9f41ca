//! R-functions by R_0^m: see [`rvachev`](super::rvachev).

use jbt_ir::{Domain, Rule};

use super::member::{Operator, PairResult, OperatorReach, Step};
use super::rvachev::{Family, RvachevOperation};
use super::set::SetOperation;
use crate::member::member;

member! {
    /// Union, intersection or difference by R_0^m, which has m continuous derivatives.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct RFunctionOrder = "rfunction" {
        /// The set operation.
        pub set: SetOperation [Choice(SetOperation::WORDS)],
        /// m.
        pub order: u32 [Whole { least: 1, most: 4 }],
    }
}

impl Operator for RFunctionOrder {}

impl RFunctionOrder {
    const fn operation(self) -> RvachevOperation {
        RvachevOperation(self.set, Family::Order(self.order))
    }
}

impl Step for RFunctionOrder {
    type Code = (SetOperation, u32);

    fn code(self) -> (SetOperation, u32) {
        (self.set, self.order)
    }

    fn pair(self, sides: [f64; 2], iso: f64) -> PairResult<f64> {
        self.operation().pair(sides, 0.0, iso)
    }

    fn kink_distance(self, sides: [f64; 2], iso: f64) -> f64 {
        self.operation().kink_distance(sides, 0.0, iso)
    }

    fn reach(self) -> OperatorReach {
        OperatorReach::Any
    }

    fn is_non_negative(self, _: [bool; 2]) -> bool {
        true
    }

    fn rule(_: (SetOperation, u32), _: bool) -> Rule {
        Rule::Never
    }

    fn emit<D: Domain>(
        (set, order): (SetOperation, u32),
        d: &mut D,
        sides: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> PairResult<D::Real> {
        RvachevOperation(set, Family::Order(order)).emit(d, sides, row, iso2)
    }
}
