//! Axes of maps, which are directions of any length.

use glam::{DMat3, DVec3};

use crate::report::Fault;

/// The unit vector of a direction; without one, a fault.
pub(super) fn unit(axis: DVec3) -> Result<DVec3, Fault> {
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

/// The scale by a factor along a direction of any length, and by 1 across it; exact along simple ones.
pub(super) fn scale_along(axis: DVec3, factor: f64) -> Result<DMat3, Fault> {
    unit(axis)?;
    let axis = axis / axis.abs().max_element();
    Ok(DMat3::IDENTITY + outer((factor - 1.0) / axis.length_squared() * axis, axis))
}
