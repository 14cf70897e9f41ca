//! Transformations of the scene language, for row vectors there and column vectors here.

use glam::{DAffine3, DMat3, DVec3};
use jbt_model::affine::sin_cos_degrees;

/// By degrees about x, then y, then z.
pub(super) fn rotation(degrees: DVec3) -> DMat3 {
    let [x, y, z] = degrees.to_array().map(sin_cos_degrees);
    let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, x.1, x.0), DVec3::new(0.0, -x.0, x.1));
    let about_y = DMat3::from_cols(DVec3::new(y.1, 0.0, -y.0), DVec3::Y, DVec3::new(y.0, 0.0, y.1));
    let about_z = DMat3::from_cols(DVec3::new(z.1, z.0, 0.0), DVec3::new(-z.0, z.1, 0.0), DVec3::Z);
    about_z * about_y * about_x
}

/// By degrees about an axis; `None` if that has no length.
pub(super) fn about(axis: DVec3, degrees: f64) -> Option<DMat3> {
    Some(DMat3::from_axis_angle(axis.try_normalize()?, degrees.to_radians()))
}

/// By factors along the axes, of which 0 counts as 1.
pub(super) fn scale(factors: DVec3) -> DAffine3 {
    DAffine3::from_scale(DVec3::select(factors.cmpeq(DVec3::ZERO), DVec3::ONE, factors))
}

/// Of four rows of three numbers for row vectors, the last one the shift.
pub(super) fn matrix(rows: &[f64; 12]) -> DAffine3 {
    DAffine3::from_cols_array(rows)
}
