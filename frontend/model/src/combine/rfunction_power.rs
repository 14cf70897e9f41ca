//! R-functions by R_p: see [`rvachev`](super::rvachev).

use super::member::Operator;
use super::rvachev::{Family, Rvachev};
use super::set::SetOperation;
use super::set_step::SetStep;
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

impl SetStep for RFunctionPower {
    type Formula = Rvachev;
    const COLUMNS: &'static [&'static str] = &["power", "inverse_power", "rest"];

    fn formula(self) -> Rvachev {
        Rvachev(self.set, Family::Power)
    }

    fn number(self) -> f64 {
        self.power
    }
}
