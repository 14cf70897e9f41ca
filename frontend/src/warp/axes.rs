//! Axes, and boxes about them: what several warps compute with.

use glam::DVec3;

use crate::bounds::Bounds;
use crate::field::{Field, FieldKind, FieldValue};

/// The parameter `axis`: a coordinate axis through the origin, z if it is not written.
pub(super) const AXIS: Field =
    Field { name: "axis", kind: FieldKind::Axis, default: Some(FieldValue::Vector([0.0, 0.0, 1.0])) };

/// The number of an axis: 0 is x, 1 is y, 2 is z.
pub(super) fn axis_of(value: &FieldValue) -> u8 {
    let axis = value.vector();
    if axis[0] != 0.0 {
        0
    } else if axis[1] != 0.0 {
        1
    } else {
        2
    }
}

/// The value of the parameter [`AXIS`].
pub(super) fn axis_value(axis: u8) -> FieldValue {
    FieldValue::Vector(DVec3::AXES[axis as usize].into())
}

/// An axis and the two behind it, in right-handed order.
pub(super) const fn order(axis: u8) -> [usize; 3] {
    let a = axis as usize;
    [a, (a + 1) % 3, (a + 2) % 3]
}

/// A box, turned by every angle about an axis, and `stretch` times as far from it.
pub(super) fn turned(axis: u8, child: Bounds, stretch: f64) -> Bounds {
    let [_, u, v] = order(axis);
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
