//! Measures of triangles.

use crate::vector::{Vector3, cross, dot, minus};

/// The corners of a triangle of vertices.
#[must_use]
pub fn corners(positions: &[[f32; 3]], triangle: [u32; 3]) -> [Vector3; 3] {
    triangle.map(|vertex| positions[vertex as usize].map(f64::from))
}

/// The vector along the normal of a triangle, as long as twice its area.
#[must_use]
pub fn area_vector([p, q, r]: [Vector3; 3]) -> Vector3 {
    cross(minus(q, p), minus(r, p))
}

/// The volume in a closed surface, by the divergence theorem about the first vertex; positive if triangles
/// are counter-clockwise from outside.
#[must_use]
pub fn volume(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> f64 {
    let about = positions.first().map_or([0.0; 3], |first| first.map(f64::from));
    let of = |&triangle: &[u32; 3]| {
        let [p, q, r] = corners(positions, triangle).map(|corner| minus(corner, about));
        dot(p, cross(q, r)) / 6.0
    };
    triangles.iter().map(of).sum()
}
