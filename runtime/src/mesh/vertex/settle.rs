//! Vertices that Newton's steps left off the surface: at a crease two surfaces alternate in pulling.
//!
//! ```text
//! a stray goes on being pulled until it is settled, by its own gradient; what it passes is remembered:
//!     the position nearest to the iso-value, one position inside, one position outside
//! of those that are not settled then:
//!     if one has never been on one side, the nearest corner of the cell there takes the place
//!     between the two sides lies the surface: halve the way from one to the other
//! the best position wins; it is within the cell, as everything on the way was
//! ```

use super::super::field::Field;
use super::super::pull::{LANES, VertexLanes, pull};
use super::bracket::{Bracket, BracketPoints};
use crate::boxes::Box3;

/// The number of further pulls of a stray.
const ROUNDS: usize = 6;
/// The number of halvings of the segment from a position inside to a position outside.
const HALVINGS: usize = 10;
/// A vertex is a stray if its distance to the surface, estimated by its own gradient, is more than this part
/// of its cell.
const TOLERANCE: f32 = 1e-3;
/// A stray is settled if its distance to the surface is at most this part of its cell.
const SETTLED: f32 = TOLERANCE / 64.0;

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
    /// The last positions outside and inside.
    sides: [Option<([f32; 3], f32)>; 2],
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
        let (best, error) = (position, (value - iso).abs());
        let mut stray = Self { index, place, position, value, gradient, best, error, sides: [None; 2] };
        stray.note(iso, position, value);
        stray
    }

    /// The best position found.
    pub(super) fn best(&self) -> [f32; 3] {
        self.best
    }

    /// Records a position with the field there.
    fn note(&mut self, iso: f32, position: [f32; 3], value: f32) {
        let error = (value - iso).abs();
        if error < self.error {
            (self.best, self.error) = (position, error);
        }
        self.sides[usize::from(value >= iso)] = Some((position, value));
    }

    /// Whether its position is on the surface, by its own gradient.
    fn is_settled(&self, iso: f32) -> bool {
        let Box3 { low, high } = self.place.bounds;
        let [x, y, z] = self.gradient;
        (self.value - iso).abs() <= SETTLED * (high[0] - low[0]) * (x * x + y * y + z * z).sqrt()
    }

    /// A way from outside to inside.
    fn way(&self) -> Option<Bracket> {
        // Nobody has asked for the field at a corner.
        let corner = |inside| Some((self.place.corner(inside, self.best)?, f32::NAN));
        let [outside, inside] = self.sides;
        let (outside, inside) = (outside.or_else(|| corner(false))?, inside.or_else(|| corner(true))?);
        Some(Bracket { ends: [outside.0, inside.0], values: [outside.1, inside.1] })
    }
}

/// Moves strays nearer to the surface. Returns the numbers of points at which the gradient was evaluated, and
/// the field alone.
pub(super) fn settle<F: Field>(
    field: &F,
    region: &F::Region,
    iso: f32,
    strays: &mut [Stray],
    points: &mut BracketPoints,
) -> Result<[u64; 2], F::Error> {
    let mut left: Vec<&mut Stray> = strays.iter_mut().collect();
    let mut pulls = 0;
    for _ in 0..ROUNDS {
        if left.is_empty() {
            break;
        }
        for stray in &mut left {
            stray.position = pull(iso, stray.position, stray.value, stray.gradient, stray.place.bounds);
        }
        let (values, gradient) =
            points.ask_gradient(field, region, left.iter().map(|stray| stray.position))?;
        for (i, stray) in left.iter_mut().enumerate() {
            stray.value = values[i];
            stray.gradient = gradient.each_ref().map(|plane| plane[i]);
            stray.note(iso, stray.position, stray.value);
        }
        pulls += left.len() as u64;
        left.retain(|stray| !stray.is_settled(iso));
    }
    let (mut left, mut ways): (Vec<&mut Stray>, Vec<Bracket>) =
        left.into_iter().filter_map(|stray| stray.way().map(|way| (stray, way))).unzip();
    let halvings = points.halve(field, region, iso, &mut ways, HALVINGS)?;
    for (stray, Bracket { ends, values }) in left.iter_mut().zip(ways) {
        ends.into_iter().zip(values).for_each(|(end, value)| stray.note(iso, end, value));
    }
    Ok([pulls, halvings])
}
