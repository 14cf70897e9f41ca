//! A crossing of the surface with an edge of a cell, and its normal.

/// The cosine of the angle between normals, 25 degrees, from which on an edge is sharp.
pub(super) const SHARP: f64 = 0.906;

/// A crossing of the surface with an edge, seen from a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    pub(super) place: [f32; 3],
    /// A place next to it where the field is that of its side.
    pub(super) seen: [f32; 3],
    /// The unit normal away from the inside.
    pub(super) normal: [f64; 3],
    /// Which operands decide; none where the field jumps.
    pub(super) signature: Option<u32>,
}

/// The product of two vectors.
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
