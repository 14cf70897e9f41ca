//! The smooth union: see [`smooth`](super::smooth).

use super::member::{Operator, Syntax};
use super::set::SetOperation;
use super::set_step::SetStep;
use super::smooth::{self, Smooth};
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

impl SetStep for SmoothUnion {
    type Formula = Smooth;
    const COLUMNS: &'static [&'static str] = smooth::COLUMNS;

    fn formula(self) -> Smooth {
        Smooth(SetOperation::Union)
    }

    fn number(self) -> f64 {
        self.width
    }
}
