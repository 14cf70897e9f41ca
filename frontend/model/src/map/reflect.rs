//! The mirror image.

use glam::{DAffine3, DVec3};

use super::axis::scale_along;
use super::member::{Freedom, MapMember};
use crate::member::member;
use crate::report::Fault;

member! {
    /// A mirror image in the plane through the origin that is normal to `axis`.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Reflect = "reflect" {
        /// A direction of any length but 0.
        pub axis: DVec3 [Direction],
    }
}

impl MapMember for Reflect {
    const FREEDOM: Freedom = Freedom::Full;

    fn affine(&self) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_mat3(scale_along(self.axis, -1.0)?))
    }
}
