//! The shift.

use glam::{DAffine3, DVec3};

use super::member::{Freedom, MapMember};
use crate::member::member;
use crate::report::Fault;

member! {
    /// Shifted.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Translate = "translate" {
        /// By how much.
        pub by: DVec3 [Position],
    }
}

impl MapMember for Translate {
    const NAMED: bool = false;
    const FREEDOM: Freedom = Freedom::Fixed;

    fn affine(&self) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_translation(self.by))
    }
}
