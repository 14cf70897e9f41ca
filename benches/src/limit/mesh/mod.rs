//! The surface of a sum of blobs over a lattice, by hand: hierarchical culling, then dual marching cubes in the bricks that are left.
//!
//! ```text
//! for each unit of 4^3 bricks, in parallel:
//!     cull(unit, all blobs), cull(halves, its blobs), cull(brick of 8^3 cells, theirs):      (cull, unit)
//!         keep the blobs that reach the box; drop the box if a bound of the field says that no surface is in it
//!     sample the 9^3 corners of the brick, with the blobs that reach it                      (sample)
//!     for each sheet of each crossed cell: the mean of its crossings,                        (brick, cell)
//!         two Newton steps, each clamped to the cell; normal and colour there                (finish)
//! flip the few faces that would pinch the mesh, and do their bricks again                    (flip)
//! one quad, two triangles, for each crossed edge of the lattice                              (join)
//! ```
//!
//! The rule for sheets and ambiguous faces is that of `jbt::mesh`: one vertex for each sheet of a cell (Nielson 2004), and the
//! mesh is a closed manifold where the surface stays inside the lattice. Corners that bricks share are evaluated in each of them, with
//! the same bits: the coordinates are those of the lattice, and a blob that does not reach a brick adds exactly nothing in it, for
//! the bound by which it is dropped is made of the same operations, each of which is monotone.

mod brick;
mod cell;
mod cull;
mod finish;
mod flip;
mod join;
mod sample;
#[cfg(test)]
mod tests;
mod unit;

use rayon::prelude::*;

use crate::model::Blob;

use super::dense::Row;

use unit::Unit;

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
const BRICK: usize = 8;
/// Bricks along the edge of a unit: what a thread does at a time.
const UNIT: usize = 4;

/// What every part of the work reads.
struct Scene {
    rows: Vec<Row>,
    all: cull::Candidates,
    iso: f32,
    /// The coordinates of the lattice along each axis.
    axes: [Vec<f32>; 3],
    /// Cells, bricks and units along each axis.
    cells: [usize; 3],
    bricks: [usize; 3],
    units: [usize; 3],
}

impl Scene {
    fn new(blobs: &[Blob], lattice: &Lattice, iso: f32) -> Self {
        let coordinate = |axis: usize, index: usize| {
            (f64::from(lattice.origin[axis]) + f64::from(lattice.cell) * index as f64) as f32
        };
        let axes = [0, 1, 2].map(|axis| (0..lattice.counts[axis]).map(|i| coordinate(axis, i)).collect());
        let rows: Vec<Row> = blobs.iter().map(Row::new).collect();
        let cells = lattice.counts.map(|count| count - 1);
        let bricks = cells.map(|cells| cells.div_ceil(BRICK));
        let units = bricks.map(|bricks| bricks.div_ceil(UNIT));
        Self { all: cull::Candidates::all(&rows), rows, iso, axes, cells, bricks, units }
    }

    /// The place of a unit in a list of all, x fastest.
    fn unit_place(&self, index: usize) -> [usize; 3] {
        let [x, y, _] = self.units;
        [index % x, index / x % y, index / (x * y)]
    }

    /// The number of the unit that a brick is in.
    fn unit_index(&self, brick: [usize; 3]) -> usize {
        let [x, y, z] = brick.map(|index| index / UNIT);
        x + self.units[0] * (y + self.units[1] * z)
    }

    /// The number of a brick in a list of all, x fastest.
    fn brick_index(&self, [x, y, z]: [usize; 3]) -> usize {
        x + self.bricks[0] * (y + self.bricks[1] * z)
    }
}

/// Meshes the surface `field = iso` of a sum of blobs, on the threads of the rayon pool in which this is called. The result does not depend
/// on how many they are.
///
/// Triangles that the border of the lattice would cut are left out. Vertices are numbered brick by brick.
///
/// # Panics
/// The lattice has fewer than two corners along an axis, or the mesh more than 2^32 vertices.
#[must_use]
pub fn mesh(blobs: &[Blob], lattice: &Lattice, iso: f32) -> Mesh {
    assert!(lattice.counts.iter().all(|&count| count >= 2), "a lattice has a cell");
    let scene = Scene::new(blobs, lattice, iso);
    let count: usize = scene.units.iter().product();
    let mut units: Vec<Unit> =
        (0..count).into_par_iter().map(|index| unit::make(&scene, scene.unit_place(index))).collect();
    let flipped_faces = flip::flip(&scene, &mut units);
    let mut mesh = join::join(&scene, &units);
    mesh.statistics = Statistics {
        bricks: units.iter().map(|unit| unit.sampled).sum(),
        field_evaluations: units.iter().map(|unit| unit.field_evaluations).sum(),
        flipped_faces,
    };
    mesh
}
