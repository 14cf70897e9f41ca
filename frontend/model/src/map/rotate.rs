//! The rotation by degrees.

use glam::{DAffine3, DVec3};

use super::axis::unit;
use super::member::{Freedom, MapMember};
use crate::affine::{rotation, sin_cos_degrees};
use crate::member::member;
use crate::report::Fault;

member! {
    /// Turned about an axis through the origin, right-handed. Quarter turns are exact.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Rotate = "rotate" {
        /// The axis through the origin, of any length but 0.
        pub axis: DVec3 [Direction],
        /// The angle.
        pub degrees: f64 [Real],
    }
}

impl MapMember for Rotate {
    const FREEDOM: Freedom = Freedom::Turn;

    fn affine(&self) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_mat3(rotation(unit(self.axis)?, sin_cos_degrees(self.degrees))))
    }
}
