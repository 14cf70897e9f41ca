//! Scales along a direction: mirror images, and others.

use glam::{DAffine3, DMat3, DVec3};

use super::axis::{AXIS, outer, unit};
use super::member::{Freedom, MapMember, MapShape};
use crate::field::{Field, FieldKind, FieldValue};
use crate::report::Fault;

/// A mirror image in the plane through the origin that is normal to a direction of any length.
pub(super) struct Reflect;

impl MapMember for Reflect {
    const WORD: &'static str = "reflect";
    const SHAPE: MapShape = MapShape::Named(&[AXIS]);
    const FREEDOM: Freedom = Freedom::Full;

    fn affine(values: &[FieldValue]) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_mat3(along(&values[0], -1.0)?))
    }
}

/// A scale about the origin by a factor along a direction of any length, and by 1 across it; a negative factor mirrors.
pub(super) struct Stretch;

impl MapMember for Stretch {
    const WORD: &'static str = "stretch";
    const SHAPE: MapShape =
        MapShape::Named(&[AXIS, Field { name: "by", kind: FieldKind::Real, default: None }]);
    const FREEDOM: Freedom = Freedom::Full;

    fn affine(values: &[FieldValue]) -> Result<DAffine3, Fault> {
        Ok(DAffine3::from_mat3(along(&values[0], values[1].real())?))
    }
}

/// The scale by a factor along a direction; exact along simple ones.
fn along(axis: &FieldValue, factor: f64) -> Result<DMat3, Fault> {
    unit(axis)?;
    let axis = DVec3::from(axis.vector());
    let axis = axis / axis.abs().max_element();
    Ok(DMat3::IDENTITY + outer((factor - 1.0) / axis.length_squared() * axis, axis))
}
