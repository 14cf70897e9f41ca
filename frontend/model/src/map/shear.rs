//! The shear: what is at height h along a direction moves by h times a vector.

use glam::{DAffine3, DMat3, DVec3};

use super::axis::{outer, unit};
use super::member::{Freedom, MapMember};
use crate::member::member;
use crate::report::Fault;

member! {
    /// Sheared: what is at height h along a direction moves by h times `by`.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Shear = "shear" {
        /// A direction of any length but 0.
        pub axis: DVec3 [Direction],
        /// The vector, as a rule across the direction.
        pub by: DVec3 [Position],
    }
}

impl MapMember for Shear {
    const FREEDOM: Freedom = Freedom::Full;

    fn affine(&self) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_mat3(DMat3::IDENTITY + outer(self.by, unit(self.axis)?)))
    }
}
