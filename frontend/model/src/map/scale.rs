//! The uniform scale.

use glam::{DAffine3, DVec3};

use super::member::{Freedom, MapMember};
use crate::member::member;
use crate::report::Fault;

member! {
    /// Scaled about the origin.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Scale = "scale" {
        /// The factor, not 0; a negative one mirrors.
        pub by: f64 [Real],
    }
}

impl MapMember for Scale {
    const NAMED: bool = false;
    const FREEDOM: Freedom = Freedom::Scale;

    fn affine(&self) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_scale(DVec3::splat(self.by)))
    }
}
