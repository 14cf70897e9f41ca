//! A mesh that follows its model: a ball is dragged through a thousand others, and whoever shows the mesh
//! copies what has changed.
//!
//! ```text
//! cargo run --release -p jbt --example live
//! ```
#![allow(clippy::print_stdout, reason = "an example prints")]

use std::error::Error;
use std::time::{Duration, Instant};

use jbt::build::{param, point};
use jbt::live::LiveChange;
use jbt::mesh::Mesh;
use jbt::{Compiler, Fineness, LiveMesh, Model, Polygonize, Tree};

/// A copy of the buffers, as a GPU has one.
struct Shown {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Shown {
    fn new(buffers: &Mesh) -> Self {
        let Mesh { positions, normals, triangles, .. } = buffers.clone();
        Self { positions, normals, triangles }
    }

    /// Copies what an edit has written; returns how many numbers that were.
    fn follow(&mut self, buffers: &Mesh, change: &LiveChange) -> usize {
        self.positions.resize(buffers.positions.len(), [0.0; 3]);
        self.normals.resize(buffers.normals.len(), [0.0; 3]);
        self.triangles.resize(buffers.triangles.len(), [0; 3]);
        let mut copied = 0;
        for range in change.written_vertices() {
            self.positions[range.clone()].copy_from_slice(&buffers.positions[range.clone()]);
            self.normals[range.clone()].copy_from_slice(&buffers.normals[range.clone()]);
            copied += 6 * range.len();
        }
        for range in change.written_triangles() {
            self.triangles[range.clone()].copy_from_slice(&buffers.triangles[range.clone()]);
            copied += 3 * range.len();
        }
        copied
    }
}

/// Balls on a jittered grid: the same ones every time.
fn balls() -> Vec<Tree> {
    let jitter = |n: usize| (n as f64 * 0.618).fract() - 0.5;
    let ball = |n: usize| {
        let place = [n % 10, n / 10 % 10, n / 100].map(|index| index as f64);
        let place = std::array::from_fn(|axis| place[axis] + 0.6 * jitter(3 * n + axis));
        point(place, 0.9).color([0.2 + 0.8 * jitter(n).abs(), 0.4, 0.7])
    };
    (0..1000).map(ball).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut leaves = balls();
    leaves.push(point((4.5, 4.5, 4.5), param("size", 1.4)).color([1.0, 0.6, 0.1]));
    let settings = Polygonize { fineness: Fineness::Resolution(128), ..Polygonize::default() };
    let model = Model::new(Tree::sum(leaves.iter().cloned()));
    let start = Instant::now();
    let mut live = LiveMesh::new(&Compiler::new(), &model, settings).run()?;
    println!("{} bricks in {:.1?}", live.bricks().count(), start.elapsed());
    let mut shown = Shown::new(live.buffers());

    let (mut longest, mut copied) = (Duration::ZERO, 0);
    for step in 0..100 {
        // The tree of a leaf is new, those of the others are shared: so the edit is that of one leaf.
        let x = -2.0 + 0.13 * f64::from(step);
        leaves[500] = point([x, 4.2, 4.8], 1.2).color([1.0, 0.3, 0.3]);
        let model = Model::new(Tree::sum(leaves.iter().cloned()));
        let start = Instant::now();
        let change = live.replace(&model).run()?;
        longest = longest.max(start.elapsed());
        copied += shown.follow(live.buffers(), &change);
    }
    println!("100 steps: {longest:.1?} at most, {} numbers copied for each", copied / 100);

    let start = Instant::now();
    let change = live.set(&[("size", 1.6)]).run()?;
    println!("a parameter: {:.1?}, {} bricks", start.elapsed(), change.changed.len() + change.added.len());
    shown.follow(live.buffers(), &change);
    assert_eq!(shown.triangles, live.buffers().triangles);

    // What a full run makes.
    let full = settings.over(live.compiled(), live.lattice()).run()?;
    assert_eq!(live.compact(), full.mesh);
    println!("{} triangles, as in a full run", full.mesh.triangles.len());
    Ok(())
}
