//! Vertices that Newton's steps left off the surface: at a crease two surfaces alternate in pulling.
//!
//! ```text
//! a stray goes on being pulled; what it passes on the way is remembered:
//!     the position nearest to the iso-value, one position inside, one position outside
//! if it has never been on one side, the nearest corner of the cell there takes the place
//! between the two sides lies the surface: halve the way from one to the other
//! the best position wins; it is within the cell, as everything on the way was
//! ```

use super::field::Field;
use super::pull::{LANES, VertexLanes, pull};
use crate::boxes::Box3;

/// The number of further pulls of a stray.
const ROUNDS: usize = 6;
/// The number of halvings of the segment from a position inside to a position outside.
const HALVINGS: usize = 10;
/// A vertex is a stray if its distance to the surface, estimated by its own gradient, is more than this part
/// of its cell.
const TOLERANCE: f32 = 1e-3;

/// Which vertices are far from the surface, 1 or 0 each, in cells with these low and high sides along x;
/// `square` is the squared length of the gradient. A gradient of NaN gives 0.
#[inline(always)]
pub(super) fn is_far(
    iso: f32,
    [low, high]: [&VertexLanes; 2],
    values: &VertexLanes,
    square: &VertexLanes,
) -> [u32; LANES] {
    let mut far = [0; LANES];
    for i in 0..LANES {
        let error = (values[i] - iso).abs();
        let is_off = error > TOLERANCE * (high[i] - low[i]) * square[i].sqrt();
        far[i] = u32::from(is_off) & u32::from(square[i] < f32::INFINITY);
    }
    far
}

/// Where a vertex may be.
#[derive(Clone, Copy)]
pub(super) struct VertexPlace {
    /// Its cell.
    pub(super) bounds: Box3,
    /// The corners that its sheet separates: those outside and those inside, a bit for each corner.
    pub(super) corners: [u8; 2],
}

impl VertexPlace {
    /// The nearest of the corners on one side of the sheet.
    fn corner(&self, inside: bool, from: [f32; 3]) -> Option<[f32; 3]> {
        let mask = self.corners[usize::from(inside)];
        let corners = (0..8).filter(|corner| mask >> corner & 1 == 1);
        let distance = |p: &[f32; 3]| (0..3).map(|axis| (p[axis] - from[axis]).powi(2)).sum::<f32>();
        corners.map(|corner| self.bounds.corner(corner)).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

/// A vertex off the surface.
pub(super) struct Stray {
    /// Its index in the batch.
    pub(super) index: usize,
    place: VertexPlace,
    position: [f32; 3],
    value: f32,
    gradient: [f32; 3],
    best: [f32; 3],
    error: f32,
    inside: Option<[f32; 3]>,
    outside: Option<[f32; 3]>,
}

impl Stray {
    /// A stray from a vertex with its field and gradient.
    pub(super) fn new(
        iso: f32,
        index: usize,
        place: VertexPlace,
        position: [f32; 3],
        value: f32,
        gradient: [f32; 3],
    ) -> Self {
        let error = (value - iso).abs();
        let mut stray = Self {
            index,
            place,
            position,
            value,
            gradient,
            best: position,
            error,
            inside: None,
            outside: None,
        };
        stray.note(iso);
        stray
    }

    /// The best position found.
    pub(super) fn best(&self) -> [f32; 3] {
        self.best
    }

    /// Records the current position.
    fn note(&mut self, iso: f32) {
        let error = (self.value - iso).abs();
        if error < self.error {
            (self.best, self.error) = (self.position, error);
        }
        let side = if self.value >= iso { &mut self.inside } else { &mut self.outside };
        *side = Some(self.position);
    }
}

/// Moves strays nearer to the surface. Returns the number of points at which the gradient was evaluated.
pub(super) fn settle<F: Field>(
    field: &F,
    region: &F::Region,
    iso: f32,
    strays: &mut [Stray],
) -> Result<u64, F::Error> {
    if strays.is_empty() {
        return Ok(0);
    }
    let plane = vec![0.0f32; strays.len()];
    let mut values = plane.clone();
    let mut gradient = [plane.clone(), plane.clone(), plane];
    let at = |strays: &[Stray]| {
        [0, 1, 2].map(|axis| strays.iter().map(|s| s.position[axis]).collect::<Vec<f32>>())
    };
    for _ in 0..ROUNDS {
        for stray in &mut *strays {
            stray.position = pull(iso, stray.position, stray.value, stray.gradient, stray.place.bounds);
        }
        let [x, y, z] = at(strays);
        field.gradient(region, &x, &y, &z, &mut values, gradient.each_mut().map(Vec::as_mut_slice))?;
        for (i, stray) in strays.iter_mut().enumerate() {
            stray.value = values[i];
            stray.gradient = gradient.each_ref().map(|plane| plane[i]);
            stray.note(iso);
        }
    }
    for stray in &mut *strays {
        stray.inside = stray.inside.or_else(|| stray.place.corner(true, stray.best));
        stray.outside = stray.outside.or_else(|| stray.place.corner(false, stray.best));
    }
    for _ in 0..HALVINGS {
        for stray in &mut *strays {
            if let (Some(inside), Some(outside)) = (stray.inside, stray.outside) {
                stray.position = [0, 1, 2].map(|axis| 0.5 * (inside[axis] + outside[axis]));
            }
        }
        let [x, y, z] = at(strays);
        field.gradient(region, &x, &y, &z, &mut values, gradient.each_mut().map(Vec::as_mut_slice))?;
        for (stray, &value) in strays.iter_mut().zip(&values) {
            stray.value = value;
            stray.note(iso);
        }
    }
    Ok((strays.len() * (ROUNDS + HALVINGS)) as u64)
}
