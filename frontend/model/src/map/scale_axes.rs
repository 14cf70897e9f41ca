//! The scale by another factor along each axis.

use glam::{DAffine3, DVec3};

use super::member::{Freedom, MapMember};
use crate::member::member;
use crate::report::Fault;

member! {
    /// Scaled about the origin, by another factor along each axis; a negative one mirrors.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct ScaleAxes = "scale" {
        /// The factors, none of them 0.
        pub by: DVec3 [Position],
    }
}

impl MapMember for ScaleAxes {
    const NAMED: bool = false;
    const FREEDOM: Freedom = Freedom::Full;

    fn affine(&self) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_scale(self.by))
    }
}
