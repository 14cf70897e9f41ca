//! Axes of maps, which are directions of any length.

use glam::{DMat3, DVec3};

use crate::field::{Field, FieldKind, FieldValue};
use crate::report::Fault;

/// The axis, through the origin.
pub(super) const AXIS: Field = Field { name: "axis", kind: FieldKind::Direction, default: None };

/// The unit vector of a direction; without one, a fault.
pub(super) fn unit(axis: &FieldValue) -> Result<DVec3, Fault> {
    let axis = DVec3::from(axis.vector());
    let unit = axis.normalize_or_zero();
    if unit == DVec3::ZERO && !axis.is_nan() {
        return Err(Fault { message: "the axis has no direction".to_owned(), help: None });
    }
    Ok(unit)
}

/// The matrix that takes q to `(axis . q) by`.
pub(super) fn outer(by: DVec3, axis: DVec3) -> DMat3 {
    DMat3::from_cols(by * axis.x, by * axis.y, by * axis.z)
}
