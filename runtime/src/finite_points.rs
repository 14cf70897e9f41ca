//! Points with a coordinate that is not finite, as a caller's own arithmetic may leave them.
//!
//! ```text
//! an infinity     counts as the largest finite number of its sign
//! a NaN           has no answer: field and gradient are NaN there, which is outside, attributes the defaults
//! ```
//!
//! Programs know nothing of this. Whoever calls them looks at all points first, which costs a comparison a
//! coordinate and nothing a row.

use jbt_ir::memory::{NoMemory, room};

use crate::buffer::Layout;

/// Whether all points are places: each coordinate is finite.
pub fn are_finite(points: &[&[f32]; 3]) -> bool {
    // In chunks, so that a long plane is left at the first of them that has something else.
    let finite = |plane: &[f32]| plane.iter().fold(true, |all, x| all & (x.abs() < f32::INFINITY));
    points.iter().all(|plane| plane.chunks(1 << 12).all(finite))
}

/// Points with a place for each: infinities are the largest numbers, NaNs are 0.
///
/// # Errors
/// There is no memory for them.
pub fn made_finite(points: &[&[f32]; 3]) -> Result<[Vec<f32>; 3], NoMemory> {
    let place = |&x: &f32| if x.is_nan() { 0.0 } else { x.clamp(f32::MIN, f32::MAX) };
    let mut placed = [room(points[0].len())?, room(points[1].len())?, room(points[2].len())?];
    placed.iter_mut().zip(points).for_each(|(placed, plane)| placed.extend(plane.iter().map(place)));
    Ok(placed)
}

/// Writes the answers of points that have a NaN for a coordinate over what was answered in the places that
/// stood in for them.
pub fn blank(layout: &Layout, points: &[&[f32]; 3], answers: &mut [&mut [f32]]) {
    let blanks = layout.blanks();
    for index in 0..points[0].len() {
        if points.iter().any(|plane| plane[index].is_nan()) {
            for (plane, &blank) in answers.iter_mut().zip(&blanks) {
                plane[index] = blank;
            }
        }
    }
}
