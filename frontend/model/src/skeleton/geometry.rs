//! Directions, frames and reaches in f64, for poses and bounds of skeletons.

use glam::{DAffine3, DMat3, DVec3};

use super::Metric;
use crate::diagnostic::Diagnostic;

/// `v` with length 1, whatever its length was; zero stays zero.
pub(crate) fn unit(v: DVec3) -> DVec3 {
    let size = v.abs().max_element();
    if size == 0.0 { DVec3::ZERO } else { (v / size).normalize() }
}

/// `v` with length 1; the z axis for zero.
pub(super) fn direction(v: DVec3) -> DVec3 {
    let unit = unit(v);
    if unit == DVec3::ZERO { DVec3::Z } else { unit }
}

/// Height along the unit vector `n`, and distance from its line.
pub(super) fn cylindrical(v: DVec3, n: DVec3) -> (f64, f64) {
    let h = v.dot(n);
    (h, (v - h * n).length())
}

/// How far the image of a circle about the unit vector `n` reaches along each axis.
pub(super) fn circle_reach(map: &DAffine3, n: DVec3, radius: f64) -> DVec3 {
    // Along an axis the circle reaches as far as the matrix row is long in the circle's plane.
    radius * DVec3::from_array([0, 1, 2].map(|axis| map.matrix3.row(axis).cross(n).length()))
}

/// The rotation that takes the z axis to the direction of `v`, or against it; the identity if the z axis is
/// already there, or if `v` is zero.
pub(super) fn along(v: DVec3) -> DMat3 {
    let z = unit(v);
    if z == DVec3::ZERO || z.z.abs() == 1.0 {
        return DMat3::IDENTITY;
    }
    let (x, y) = z.any_orthonormal_pair();
    DMat3::from_cols(x, y, z)
}

/// Takes the z axis to the direction of `v`: a rotation, or the reflection in the origin if that is enough;
/// the identity if `v` is zero.
pub(super) fn towards(v: DVec3) -> DMat3 {
    let z = unit(v);
    if z == DVec3::ZERO || z.z == 1.0 {
        return DMat3::IDENTITY;
    }
    if z.z == -1.0 {
        return -DMat3::IDENTITY;
    }
    let (x, y) = z.any_orthonormal_pair();
    DMat3::from_cols(x, y, z)
}

/// The rotation that takes the z axis to the direction of `normal`, and the x axis as near as possible to the
/// direction of `first`.
pub(super) fn frame(normal: DVec3, first: DVec3) -> DMat3 {
    let (z, first) = (unit(normal), unit(first));
    let across = |v: DVec3| v - v.dot(z) * z;
    // Twice, because the first difference of a direction near the normal is mostly rounding.
    let x = unit(across(across(first)));
    let x = if x == DVec3::ZERO { z.any_orthonormal_vector() } else { x };
    DMat3::from_cols(x, z.cross(x), z)
}

/// Whether two directions lie along one line, within f32. A zero direction lies along none.
fn are_along(a: DVec3, b: DVec3) -> bool {
    let (a, b) = (unit(a), unit(b));
    a != DVec3::ZERO && b != DVec3::ZERO && a.cross(b).length() < 1e-7
}

/// The fault of a direction along the normal that has to be across it; `what` is its name.
pub(super) fn along_normal(owner: &str, what: &str, normal: DVec3, direction: DVec3) -> Option<Diagnostic> {
    let error = || Diagnostic::error(None, format!("the `{what}` of the {owner} lies along its normal"));
    are_along(normal, direction).then(|| error().expected("expected a direction across it"))
}

/// How far the image of a ball reaches along each axis.
pub(super) fn ball_reach(map: &DAffine3, radius: f64) -> DVec3 {
    radius * Metric::EUCLIDEAN.reach(map.matrix3)
}
