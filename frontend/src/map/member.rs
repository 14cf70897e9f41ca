//! What every affine map states about itself.

use glam::DAffine3;

use crate::field::{Field, FieldValue};
use crate::report::Fault;

/// What stands behind the word of a map.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum MapShape {
    /// One number.
    Number,
    /// Three numbers in parentheses.
    Vector,
    /// The rows of a 3x4 matrix: 12 numbers in parentheses.
    Rows,
    /// These parameters, by name.
    Named(&'static [Field]),
}

/// How much the linear part of an affine map can change, from least to most: what its code has to be ready for.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Freedom {
    /// Not at all.
    Fixed,
    /// By a uniform scale.
    Scale,
    /// By a rotation and a uniform scale.
    Turn,
    /// In any way.
    Full,
}

/// What an affine map states about itself. Maps may share a word, if their shapes differ.
pub(super) trait MapMember {
    /// The word of the text format.
    const WORD: &'static str;
    /// What stands behind it.
    const SHAPE: MapShape;
    /// How much its linear part can change, where its numbers follow parameters.
    const FREEDOM: Freedom;

    /// The map that takes the child's space to the parent's. `values` are as the shape says: the numbers of
    /// [`MapShape::Rows`] are one list. An axis without a direction is a fault.
    fn affine(values: &[FieldValue]) -> Result<DAffine3, Fault>;
}
