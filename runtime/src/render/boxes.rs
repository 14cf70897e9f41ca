//! Boxes, eight at a time, and segments of rays that enter them.

use super::vector::along;
use crate::trace::Ray;

/// Boxes of a node.
pub const WIDE: usize = 8;
/// A number for each of them.
pub type EightLanes = [f32; WIDE];

/// The part by which the far side of a box is moved away, beyond the rounding of three operations.
pub const SLACK: f32 = 1.0 + 1e-6;
/// The least magnitude of a direction's coordinate that is divided by.
const FLAT: f32 = 1e-30;
/// Every coordinate of a box that is missing. With infinity, its near and its far side would change places.
const FAR_AWAY: f32 = f32::MAX;

/// A part of a ray that begins at its origin, relative to the model's origin.
#[derive(Clone, Copy)]
pub struct RayPart {
    pub origin: [f32; 3],
    /// A unit vector.
    pub direction: [f32; 3],
    /// The length of the part.
    pub reach: f32,
}

impl RayPart {
    /// The part of a ray in its span.
    pub fn of(ray: &Ray) -> Self {
        Self {
            origin: along(ray.origin, ray.span[0], ray.direction).map(|x| x as f32),
            direction: ray.direction.map(|x| x as f32),
            reach: (ray.span[1] - ray.span[0]) as f32,
        }
    }
}

/// A box: its smallest and its largest corner.
pub type Corners = [[f32; 3]; 2];

pub const NOWHERE: Corners = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

#[inline(always)]
pub fn joined([low, high]: Corners, [other_low, other_high]: &Corners) -> Corners {
    [
        [0, 1, 2].map(|axis| low[axis].min(other_low[axis])),
        [0, 1, 2].map(|axis| high[axis].max(other_high[axis])),
    ]
}

/// Eight boxes. What is missing is a point beyond any ray.
#[derive(Clone)]
pub struct BoxNode {
    pub low: [EightLanes; 3],
    pub high: [EightLanes; 3],
}

impl BoxNode {
    pub const EMPTY: Self = Self { low: [[FAR_AWAY; WIDE]; 3], high: [[FAR_AWAY; WIDE]; 3] };

    /// The node of up to eight boxes, and the box around them.
    pub fn new(boxes: &[Corners]) -> (Self, Corners) {
        let mut node = Self::EMPTY;
        for (lane, [low, high]) in boxes.iter().enumerate() {
            for axis in 0..3 {
                node.low[axis][lane] = low[axis];
                node.high[axis][lane] = high[axis];
            }
        }
        (node, boxes.iter().fold(NOWHERE, joined))
    }

    /// The distance at which a ray enters each box, or infinity (Kay and Kajiya 1986: slabs).
    #[inline(always)]
    pub fn enter(&self, origin: [f32; 3], inverse: [f32; 3], reach: f32) -> EightLanes {
        let (mut near, mut far) = ([0.0_f32; WIDE], [reach; WIDE]);
        for axis in 0..3 {
            for i in 0..WIDE {
                let low = (self.low[axis][i] - origin[axis]) * inverse[axis];
                let high = (self.high[axis][i] - origin[axis]) * inverse[axis];
                let (first, last) = if low < high { (low, high) } else { (high, low) };
                near[i] = if first > near[i] { first } else { near[i] };
                far[i] = if last < far[i] { last } else { far[i] };
            }
        }
        let mut entered = [f32::INFINITY; WIDE];
        for i in 0..WIDE {
            entered[i] = if near[i] <= far[i] * SLACK { near[i] } else { f32::INFINITY };
        }
        entered
    }
}

/// The inverse of a direction's coordinates, all finite.
#[inline(always)]
pub fn inverse(direction: [f32; 3]) -> [f32; 3] {
    direction.map(|x| 1.0 / if x.abs() < FLAT { FLAT.copysign(x) } else { x })
}

/// A bit for each lane that is finite.
#[inline(always)]
pub fn finite_lanes(lanes: &EightLanes) -> u32 {
    let mut bits = [0; WIDE];
    for i in 0..WIDE {
        bits[i] = u32::from(lanes[i] < f32::INFINITY) << i;
    }
    bits.iter().fold(0, |mask, bit| mask | bit)
}

#[inline(always)]
pub fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
