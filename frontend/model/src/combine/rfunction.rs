//! R-functions by R_alpha: see [`rvachev`](super::rvachev).

use super::member::Operator;
use super::rvachev::{Family, Rvachev};
use super::set::SetOperation;
use super::set_step::SetStep;
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

impl SetStep for RFunction {
    type Formula = Rvachev;
    const COLUMNS: &'static [&'static str] = &["alpha", "rest"];

    fn formula(self) -> Rvachev {
        Rvachev(self.set, Family::Alpha)
    }

    fn number(self) -> f64 {
        self.alpha
    }
}
