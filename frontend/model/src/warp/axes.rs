//! Axes, and boxes about them: what several warps compute with.

use crate::axis::Axis;
use crate::bounds::Bounds;

/// A box, turned by every angle about an axis, and `stretch` times as far from it.
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

/// More than a few roundings of f32 take, relative to the numbers that are rounded: 2^-19.
pub(super) const ROUNDINGS: f64 = 1.0 / (1 << 19) as f64;

/// More than underflow takes from products of numbers in f32 and coordinates: 2^-80.
pub(super) const UNDERFLOW: f64 = 1.0 / (1_u128 << 80) as f64;
