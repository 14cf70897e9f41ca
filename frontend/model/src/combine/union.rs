//! The union: the largest field. The child that has it wins; of equals, the first.

use super::extreme::Extreme;
use super::member::{Choice, Operator};
use crate::member::member;

member! {
    /// The largest field: what is inside of any.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Union = "union" {}
}

impl Operator for Union {}

impl Choice for Union {
    const EXTREME: Extreme = Extreme::Largest;
}
