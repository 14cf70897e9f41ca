//! Rotations about an axis through the origin, right-handed.

use glam::DAffine3;

use super::axis::{AXIS, unit};
use super::member::{Freedom, MapMember, MapShape};
use crate::affine::{rotation, sin_cos_degrees};
use crate::field::{Field, FieldKind, FieldValue};
use crate::report::Fault;

/// By an angle in degrees; quarter turns are exact.
pub(super) struct RotateDegrees;

impl MapMember for RotateDegrees {
    const WORD: &'static str = "rotate";
    const SHAPE: MapShape =
        MapShape::Named(&[AXIS, Field { name: "degrees", kind: FieldKind::Real, default: None }]);
    const FREEDOM: Freedom = Freedom::Turn;

    fn affine(values: &[FieldValue]) -> Result<DAffine3, Fault> {
        let turn = sin_cos_degrees(values[1].real());
        Ok(DAffine3::from_mat3(rotation(unit(&values[0])?, turn)))
    }
}

/// By an angle in radians.
pub(super) struct RotateRadians;

impl MapMember for RotateRadians {
    const WORD: &'static str = "rotate";
    const SHAPE: MapShape =
        MapShape::Named(&[AXIS, Field { name: "radians", kind: FieldKind::Real, default: None }]);
    const FREEDOM: Freedom = Freedom::Turn;

    fn affine(values: &[FieldValue]) -> Result<DAffine3, Fault> {
        let turn = values[1].real().sin_cos();
        Ok(DAffine3::from_mat3(rotation(unit(&values[0])?, turn)))
    }
}
