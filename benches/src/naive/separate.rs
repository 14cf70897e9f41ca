//! One walk for each answer, as BlobTree systems were written before answers were fused.
//!
//! ```text
//! field        1 walk
//! gradient     3 walks     forward differences, given the field
//! attributes   1 walk      which evaluates the fields again, to weigh with
//! ```
//!
//! Five evaluations of each primitive in all. (Central differences would take three more; a system that does
//! not hand the field on to its normals takes one more: six.)

use super::Walker;

/// The step of the differences, in units of space: a power of two, so that `x + STEP` is mostly exact.
pub const STEP: f32 = 1.0 / 1024.0;

/// How often each primitive is evaluated at a point for all answers.
pub const WALKS: usize = 5;

/// Field, gradient and attributes at points: planes as for [`Walker::full`]. Panics where that does.
pub fn separate(walker: &Walker, points: [&[f32]; 3], outs: &mut [&mut [f32]]) {
    let [field, x, y, z, channels @ ..] = outs else { panic!("field and gradient have four planes") };
    differences(walker, points, [field, x, y, z]);
    walker.attributes(points, channels);
}

/// Field and gradient, by four walks: `outs` are the planes of the field and of the gradient's x, y and z.
/// Panics if lengths differ.
pub fn differences(walker: &Walker, points: [&[f32]; 3], [field, gradient @ ..]: [&mut [f32]; 4]) {
    walker.field(points, field);
    let mut moved = Vec::new();
    for (axis, slope) in gradient.into_iter().enumerate() {
        moved.clear();
        moved.extend(points[axis].iter().map(|x| x + STEP));
        let mut ahead = points;
        ahead[axis] = &moved;
        walker.field(ahead, slope);
        for (i, slope) in slope.iter_mut().enumerate() {
            // The step that was really made, after rounding.
            *slope = (*slope - field[i]) / (moved[i] - points[axis][i]);
        }
    }
}
