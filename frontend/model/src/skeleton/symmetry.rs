//! Rotations that a skeleton in its pose does not feel.

use glam::{DMat3, DVec3};

use super::{along, towards};

/// Which rotations a skeleton in its pose does not feel: they need not be done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Symmetry {
    /// All.
    Ball,
    /// Those about the z axis, and turning it round.
    Axis,
    /// Those about the z axis.
    Arrow,
    /// None.
    None,
}

impl Symmetry {
    /// A rotation (or reflection) that does the same to such a skeleton as `turn`; the identity, if that will
    /// do.
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
