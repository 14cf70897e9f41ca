//! The vertices of one brick, the data that they are made from, and counts of the work.

use super::super::brick::Bricks;
use super::super::crossing::{CrossedCell, Crossings};
use super::super::field::Field;
use super::super::options::Options;
use super::super::pull::{LANES, VertexLanes, VertexPlanes};
use super::super::sample::{BrickSamples, corners};
use super::again::SecondLooks;
use super::bracket::CrossedEdges;
use super::seed::{Bed, SeedGroup};
use super::side::SharpVertex;
use crate::boxes::Box3;

/// Counts of the work at vertices.
#[derive(Default)]
pub(in super::super) struct Done {
    /// Points at which the gradient was evaluated.
    pub(in super::super) gradient_evaluations: u64,
    /// Points at which everything was evaluated.
    pub(in super::super) full_evaluations: u64,
    /// Points at which the field was evaluated to find jumps, to follow walls and to settle strays.
    pub(in super::super) jump_evaluations: u64,
    /// Vertices at jumps.
    pub(in super::super) jump_vertices: u64,
    /// Vertices whose normals are to be compared with their triangles, ascending. An unknown normal is zero.
    pub(in super::super) doubtful: Vec<u32>,
    /// Vertices on edges and corners of the surface, ascending.
    pub(in super::super) sharp: Vec<SharpVertex>,
}

impl Done {
    pub(super) fn and(mut self, other: Self) -> Self {
        self.doubtful.extend(other.doubtful);
        self.sharp.extend(other.sharp);
        Self {
            gradient_evaluations: self.gradient_evaluations + other.gradient_evaluations,
            full_evaluations: self.full_evaluations + other.full_evaluations,
            jump_evaluations: self.jump_evaluations + other.jump_evaluations,
            jump_vertices: self.jump_vertices + other.jump_vertices,
            doubtful: self.doubtful,
            sharp: self.sharp,
        }
    }
}

/// The data that the vertices of all bricks are made from.
pub(in super::super) struct VertexSource<'a, F: Field> {
    pub(in super::super) field: &'a F,
    pub(in super::super) options: &'a Options,
    pub(in super::super) bricks: &'a Bricks,
    pub(in super::super) regions: &'a [F::Region],
    pub(in super::super) samples: &'a BrickSamples,
    pub(in super::super) crossings: &'a Crossings,
}

/// A vertex of a cell with more than one sheet.
pub(super) struct Shared {
    pub(super) vertex: usize,
    /// The number of the cell's vertices before it.
    pub(super) earlier: usize,
    /// Its start.
    pub(super) start: [f32; 3],
    /// The rise of the field along the edges of its sheet.
    pub(super) rise: [f32; 3],
}

/// The vertices of one brick, in planes padded to whole [`LANES`].
#[derive(Default)]
pub(super) struct VertexBatch {
    /// The number of vertices.
    pub(super) count: usize,
    /// The field at the points of the brick's closed box.
    pub(super) table: Vec<f32>,
    pub(super) points: VertexPlanes,
    pub(super) bed: Bed,
    /// For each [`LANES`] of vertices: the values derived from their cells.
    pub(super) groups: Vec<SeedGroup>,
    pub(super) values: Vec<f32>,
    pub(super) gradient: VertexPlanes,
    /// One plane after the other, each for `count` vertices.
    pub(super) attributes: Vec<f32>,
    /// Vertices that share their cell with others.
    pub(super) shared: Vec<Shared>,
    /// Vertices whose normals are doubtful, ascending.
    pub(super) doubtful: Vec<usize>,
    /// Vertices at jumps of the field.
    pub(super) jumped: Vec<usize>,
    /// Vertices that get a second look.
    pub(super) suspects: SecondLooks,
    /// Crossed edges at these.
    pub(super) crossed: CrossedEdges,
}

impl VertexBatch {
    pub(super) fn resize(&mut self, count: usize) {
        self.count = count;
        let padded = count.next_multiple_of(LANES);
        let planes = [&mut self.points, &mut self.gradient];
        planes.into_iter().flatten().for_each(|plane| plane.resize(padded, 0.0));
        self.values.resize(padded, 0.0);
        self.groups.resize(padded / LANES, SeedGroup::default());
    }

    /// The field at the corners of a cell of the brick.
    #[inline(always)]
    pub(super) fn corners(&self, bricks: &Bricks, cell: &CrossedCell) -> [f32; 8] {
        corners(&self.table, bricks.at(cell.number).in_table(), bricks.stride())
    }

    /// The box in which a vertex stays.
    pub(super) fn bounds(&self, vertex: usize) -> Box3 {
        let group = &self.groups[vertex / LANES];
        Box3::new(group.low, group.high).map(|corner| corner.map(|plane| plane[vertex % LANES]))
    }
}

#[inline(always)]
pub(super) fn lane(plane: &[f32], chunk: usize) -> VertexLanes {
    *plane[chunk * LANES..].first_chunk().expect("planes are filled up")
}

#[inline(always)]
pub(super) fn lanes(planes: &VertexPlanes, chunk: usize) -> [VertexLanes; 3] {
    planes.each_ref().map(|plane| lane(plane, chunk))
}
