//! Rotations that leave a skeleton in its pose unchanged.

use glam::{DMat3, DVec3};

use super::{along, towards};

/// The rotations that leave a skeleton in its pose unchanged: a row leaves them out.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Symmetry {
    /// All.
    Ball,
    /// Rotations about the z axis, and half turns that reverse it.
    Axis,
    /// Rotations about the z axis.
    Arrow,
    /// None.
    None,
}

impl Symmetry {
    /// A rotation (or reflection) with the same effect on such a skeleton as `turn`; the identity, if
    /// possible.
    #[must_use]
    pub fn simplest(self, turn: DMat3) -> DMat3 {
        let simplest = match self {
            Self::Ball => DMat3::IDENTITY,
            Self::Axis => along(turn.z_axis),
            Self::Arrow if turn.z_axis.abs_diff_eq(DVec3::NEG_Z, 1e-12) => -DMat3::IDENTITY,
            Self::Arrow => towards(turn.z_axis),
            Self::None => turn,
        };
        if simplest.abs_diff_eq(DMat3::IDENTITY, 1e-12) { DMat3::IDENTITY } else { simplest }
    }
}
