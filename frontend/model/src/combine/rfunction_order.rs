//! R-functions by R_0^m: see [`rvachev`](super::rvachev).

use super::member::Operator;
use super::rvachev::{Family, Rvachev};
use super::set::SetOperation;
use super::set_step::SetStep;
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

impl SetStep for RFunctionOrder {
    type Formula = Rvachev;

    fn formula(self) -> Rvachev {
        Rvachev(self.set, Family::Order(self.order))
    }

    fn number(self) -> f64 {
        // The order is code.
        0.0
    }
}
