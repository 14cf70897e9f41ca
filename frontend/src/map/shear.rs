//! The shear: what is at height h along a direction moves by h times a vector.

use glam::{DAffine3, DMat3};

use super::axis::{AXIS, outer, unit};
use super::member::{Freedom, MapMember, MapShape};
use crate::field::{Field, FieldKind, FieldValue};
use crate::report::Fault;

/// Along a direction of any length, by a vector which is as a rule across it.
pub(super) struct Shear;

impl MapMember for Shear {
    const WORD: &'static str = "shear";
    const SHAPE: MapShape =
        MapShape::Named(&[AXIS, Field { name: "by", kind: FieldKind::Position, default: None }]);
    const FREEDOM: Freedom = Freedom::Full;

    fn affine(values: &[FieldValue]) -> Result<DAffine3, Fault> {
        let by = values[1].vector().into();
        Ok(DAffine3::from_mat3(DMat3::IDENTITY + outer(by, unit(&values[0])?)))
    }
}
