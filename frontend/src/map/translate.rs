//! The shift.

use glam::DAffine3;

use super::member::{Freedom, MapMember, MapShape};
use crate::field::FieldValue;
use crate::report::Fault;

/// A shift.
pub(super) struct Translate;

impl MapMember for Translate {
    const WORD: &'static str = "translate";
    const SHAPE: MapShape = MapShape::Vector;
    const FREEDOM: Freedom = Freedom::Fixed;

    fn affine(values: &[FieldValue]) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_translation(values[0].vector().into()))
    }
}
