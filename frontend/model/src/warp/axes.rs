//! Axes, and boxes about them: shared by several warps.

use crate::axis::Axis;
use crate::bounds::Bounds;

/// The box around a box that is turned by every angle about an axis and scaled by `stretch` away from the
/// axis.
pub(super) fn turned(axis: Axis, child: Bounds, stretch: f64) -> Bounds {
    let [_, u, v] = axis.order();
    let reach = |axis: usize| child.min[axis].abs().max(child.max[axis].abs());
    let radius = reach(u).hypot(reach(v)) * stretch;
    let mut turned = child;
    for axis in [u, v] {
        turned.min[axis] = -radius;
        turned.max[axis] = radius;
    }
    turned
}

/// The largest magnitude of a coordinate in a box; 0 if nothing is in it.
pub(super) fn farthest(child: Bounds) -> f64 {
    if child.is_empty() { 0.0 } else { child.min.abs().max(child.max.abs()).max_element() }
}

/// A bound of a few roundings in f32, relative to the rounded numbers: 2^-19.
pub(super) const ROUNDINGS: f64 = 1.0 / (1 << 19) as f64;

/// A bound of the underflow of products of f32 numbers and coordinates: 2^-80.
pub(super) const UNDERFLOW: f64 = 1.0 / (1_u128 << 80) as f64;
