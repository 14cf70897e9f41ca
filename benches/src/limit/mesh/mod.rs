//! The surface of a sum of blobs over a lattice, by hand: hierarchical culling, then dual marching cubes in
//! the bricks that are left.
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
//! The rule for sheets and ambiguous faces is that of `jbt::mesh`: one vertex for each sheet of a cell
//! (Nielson 2004), and the mesh is a closed manifold where the surface stays inside the lattice. Corners that
//! bricks share are evaluated in each of them, with the same bits: the coordinates are those of the lattice,
//! and a blob that does not reach a brick adds exactly nothing in it, for the bound by which it is dropped is
//! made of the same operations, each of which is monotone.

mod brick;
mod cell;
mod cull;
mod finish;
mod flip;
mod join;
mod sample;
mod scene;
#[cfg(test)]
mod tests;
mod unit;

use rayon::prelude::*;

use crate::model::Blob;

pub use scene::{Lattice, Mesh, Statistics};

use scene::Scene;
use unit::Unit;

/// Meshes the surface `field = iso` of a sum of blobs, on the threads of the rayon pool in which this is
/// called. The result does not depend on how many they are.
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
