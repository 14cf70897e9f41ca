//! The smooth intersection: see [`smooth`](super::smooth).

use super::member::{Operator, Syntax};
use super::set::SetOperation;
use super::set_step::SetStep;
use super::smooth::{self, Smooth};
use crate::member::member;

member! {
    /// An intersection that rounds where two fields differ by less than a width.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct SmoothIntersection = "smooth_intersection" {
        /// In units of the field.
        pub width: f64 [Positive],
    }
}

impl Operator for SmoothIntersection {
    const SYNTAX: Syntax = Syntax::Labelled;
}

impl SetStep for SmoothIntersection {
    type Formula = Smooth;
    const COLUMNS: &'static [&'static str] = smooth::COLUMNS;

    fn formula(self) -> Smooth {
        Smooth(SetOperation::Intersection)
    }

    fn number(self) -> f64 {
        self.width
    }
}
