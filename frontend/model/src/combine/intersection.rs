//! The intersection: the smallest field. The child that has it wins; of equals, the first.

use super::extreme::Extreme;
use super::member::{Choice, Operator};
use crate::member::member;

member! {
    /// The smallest field: what is inside of all.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Intersection = "intersection" {}
}

impl Operator for Intersection {}

impl Choice for Intersection {
    const EXTREME: Extreme = Extreme::Smallest;
}
