//! What is meshed, what comes of it, and what every part of the work reads.

use super::cull::Candidates;
use crate::limit::dense::Row;
use crate::model::Blob;

/// A box of equal cubic cells.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lattice {
    /// The first corner.
    pub origin: [f32; 3],
    /// The edge of a cell. Greater than zero, and so large that corners side by side differ in f32.
    pub cell: f32,
    /// Corners along x, y and z: one more than cells. At least 2.
    pub counts: [usize; 3],
}

/// Triangles with normals and colours.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// One for each vertex.
    pub positions: Vec<[f32; 3]>,
    /// One for each vertex, of length 1, away from the inside; zero where the gradient is.
    pub normals: Vec<[f32; 3]>,
    /// One for each vertex: red, green and blue.
    pub colors: Vec<[f32; 3]>,
    /// Three indices of vertices each, counter-clockwise when seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// What it took.
    pub statistics: Statistics,
}

/// What a mesh took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Bricks whose corners were sampled.
    pub bricks: u64,
    /// Fields of one blob at one corner of a brick.
    pub field_evaluations: u64,
    /// Ambiguous faces that were resolved the other way, to keep the mesh manifold.
    pub flipped_faces: u64,
}

/// Cells along the edge of a brick.
pub(super) const BRICK: usize = 8;
/// Bricks along the edge of a unit: what a thread does at a time.
pub(super) const UNIT: usize = 4;

/// What every part of the work reads.
pub(super) struct Scene {
    pub(super) rows: Vec<Row>,
    pub(super) all: Candidates,
    pub(super) iso: f32,
    /// The coordinates of the lattice along each axis.
    pub(super) axes: [Vec<f32>; 3],
    /// Cells, bricks and units along each axis.
    pub(super) cells: [usize; 3],
    pub(super) bricks: [usize; 3],
    pub(super) units: [usize; 3],
}

impl Scene {
    pub(super) fn new(blobs: &[Blob], lattice: &Lattice, iso: f32) -> Self {
        let coordinate = |axis: usize, index: usize| {
            (f64::from(lattice.origin[axis]) + f64::from(lattice.cell) * index as f64) as f32
        };
        let axes = [0, 1, 2].map(|axis| (0..lattice.counts[axis]).map(|i| coordinate(axis, i)).collect());
        let rows: Vec<Row> = blobs.iter().map(Row::new).collect();
        let cells = lattice.counts.map(|count| count - 1);
        let bricks = cells.map(|cells| cells.div_ceil(BRICK));
        let units = bricks.map(|bricks| bricks.div_ceil(UNIT));
        Self { all: Candidates::all(&rows), rows, iso, axes, cells, bricks, units }
    }

    /// The place of a unit in a list of all, x fastest.
    pub(super) fn unit_place(&self, index: usize) -> [usize; 3] {
        let [x, y, _] = self.units;
        [index % x, index / x % y, index / (x * y)]
    }

    /// The number of the unit that a brick is in.
    pub(super) fn unit_index(&self, brick: [usize; 3]) -> usize {
        let [x, y, z] = brick.map(|index| index / UNIT);
        x + self.units[0] * (y + self.units[1] * z)
    }

    /// The number of a brick in a list of all, x fastest.
    pub(super) fn brick_index(&self, [x, y, z]: [usize; 3]) -> usize {
        x + self.bricks[0] * (y + self.bricks[1] * z)
    }
}
