//! The rotation by radians.

use glam::{DAffine3, DVec3};

use super::axis::unit;
use super::member::{Freedom, MapMember};
use crate::affine::rotation;
use crate::member::member;
use crate::report::Fault;

member! {
    /// Turned about an axis through the origin, right-handed.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct RotateRadians = "rotate" {
        /// The axis through the origin, of any length but 0.
        pub axis: DVec3 [Direction],
        /// The angle.
        pub radians: f64 [Real],
    }
}

impl MapMember for RotateRadians {
    const FREEDOM: Freedom = Freedom::Turn;

    fn affine(&self) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_mat3(rotation(unit(self.axis)?, self.radians.sin_cos())))
    }
}
