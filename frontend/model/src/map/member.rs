//! What every affine map implements.

use glam::DAffine3;

use crate::member::Member;
use crate::report::Fault;

/// How much the linear part of an affine map can change, from least to most. The code of the map must serve
/// all these changes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Freedom {
    /// Not at all.
    Fixed,
    /// By a uniform scale.
    Scale,
    /// By a rotation and a uniform scale.
    Turn,
    /// In any way.
    Full,
}

/// What an affine map implements. Maps may share a word if their parameters tell them apart.
pub(super) trait MapMember: Member {
    /// Whether its parameters are written by name. Otherwise it has one parameter, whose value follows the
    /// word.
    const NAMED: bool = true;
    /// How much its linear part can change, where its numbers depend on parameters.
    const FREEDOM: Freedom;

    /// The map that takes the child's space to the parent's. An axis without a direction is a fault.
    fn affine(&self) -> Result<DAffine3, Fault>;
}
