//! The scale along a direction.

use glam::{DAffine3, DVec3};

use super::axis::scale_along;
use super::member::{Freedom, MapMember};
use crate::member::member;
use crate::report::Fault;

member! {
    /// Scaled about the origin along a direction, and by 1 across it; a negative factor mirrors.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Stretch = "stretch" {
        /// A direction of any length but 0.
        pub axis: DVec3 [Direction],
        /// The factor, not 0.
        pub by: f64 [Real],
    }
}

impl MapMember for Stretch {
    const FREEDOM: Freedom = Freedom::Full;

    fn affine(&self) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_mat3(scale_along(self.axis, self.by)?))
    }
}
