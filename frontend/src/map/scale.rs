//! Scales about the origin.

use glam::{DAffine3, DVec3};

use super::member::{Freedom, MapMember, MapShape};
use crate::field::FieldValue;
use crate::report::Fault;

/// By one factor.
pub(super) struct Scale;

impl MapMember for Scale {
    const WORD: &'static str = "scale";
    const SHAPE: MapShape = MapShape::Number;
    const FREEDOM: Freedom = Freedom::Scale;

    fn affine(values: &[FieldValue]) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_scale(DVec3::splat(values[0].real())))
    }
}

/// By another factor along each axis.
pub(super) struct ScaleAxes;

impl MapMember for ScaleAxes {
    const WORD: &'static str = "scale";
    const SHAPE: MapShape = MapShape::Vector;
    const FREEDOM: Freedom = Freedom::Full;

    fn affine(values: &[FieldValue]) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_scale(values[0].vector().into()))
    }
}
