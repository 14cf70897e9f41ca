//! The vertices of one brick, what they are made from, and what was done at them.

use super::super::brick::Bricks;
use super::super::crossing::Crossings;
use super::super::field::Field;
use super::super::options::Options;
use super::super::pull::{LANES, Lanes};
use super::bracket::CrossedEdges;
use super::seed::{Group, Seeds};
use crate::region::Box3;

/// What was done at vertices.
#[derive(Default)]
pub(in super::super) struct Done {
    /// Points at which the gradient was evaluated.
    pub(in super::super) gradient_evaluations: u64,
    /// Points at which everything was evaluated.
    pub(in super::super) full_evaluations: u64,
    /// Points at which the field was evaluated to look for jumps and to follow walls.
    pub(in super::super) jump_evaluations: u64,
    /// Vertices at jumps.
    pub(in super::super) jump_vertices: u64,
    /// Vertices the normals of which are to be compared with their triangles, ascending. A normal that is not
    /// known is zero.
    pub(in super::super) doubtful: Vec<u32>,
}

impl Done {
    pub(super) fn and(mut self, other: Self) -> Self {
        self.doubtful.extend(other.doubtful);
        Self {
            gradient_evaluations: self.gradient_evaluations + other.gradient_evaluations,
            full_evaluations: self.full_evaluations + other.full_evaluations,
            jump_evaluations: self.jump_evaluations + other.jump_evaluations,
            jump_vertices: self.jump_vertices + other.jump_vertices,
            doubtful: self.doubtful,
        }
    }
}

/// What the vertices of all bricks are made from.
pub(in super::super) struct Source<'a, F: Field> {
    pub(in super::super) field: &'a F,
    pub(in super::super) options: &'a Options,
    pub(in super::super) bricks: &'a Bricks,
    pub(in super::super) regions: &'a [F::Region],
    pub(in super::super) crossings: &'a Crossings,
}

/// A vertex of a cell with more than one sheet.
pub(super) struct Shared {
    pub(super) vertex: usize,
    /// How many of the cell's vertices are before it.
    pub(super) earlier: usize,
    /// Where it starts.
    pub(super) start: [f32; 3],
    /// How the field rises along the edges of its sheet.
    pub(super) rise: [f32; 3],
}

/// Three planes of numbers.
pub(super) type Planes = [Vec<f32>; 3];

/// The vertices of one brick, in planes that are filled up to whole [`LANES`].
#[derive(Default)]
pub(super) struct Batch {
    /// How many there are.
    pub(super) count: usize,
    pub(super) points: Planes,
    /// The cells of each [`LANES`] of them, and what is known from these.
    pub(super) seeds: Vec<Seeds>,
    pub(super) groups: Vec<Group>,
    pub(super) values: Vec<f32>,
    pub(super) gradient: Planes,
    /// One plane after the other, each for `count` vertices.
    pub(super) attributes: Vec<f32>,
    /// Those that share their cell with others.
    pub(super) shared: Vec<Shared>,
    /// Those whose normals are doubtful, ascending.
    pub(super) doubtful: Vec<usize>,
    /// Edges at vertices that were looked at twice.
    pub(super) crossed: CrossedEdges,
}

impl Batch {
    pub(super) fn resize(&mut self, count: usize) {
        self.count = count;
        let padded = count.next_multiple_of(LANES);
        let planes = [&mut self.points, &mut self.gradient];
        planes.into_iter().flatten().for_each(|plane| plane.resize(padded, 0.0));
        self.values.resize(padded, 0.0);
        self.seeds.resize(padded / LANES, Seeds::default());
        self.groups.resize(padded / LANES, Group::default());
    }

    /// The box in which a vertex stays.
    pub(super) fn bounds(&self, vertex: usize) -> Box3 {
        let group = &self.groups[vertex / LANES];
        Box3::new(group.low, group.high).map(|corner| corner.map(|plane| plane[vertex % LANES]))
    }
}

#[inline(always)]
pub(super) fn lane(plane: &[f32], chunk: usize) -> Lanes {
    *plane[chunk * LANES..].first_chunk().expect("planes are filled up")
}

#[inline(always)]
pub(super) fn lanes(planes: &Planes, chunk: usize) -> [Lanes; 3] {
    planes.each_ref().map(|plane| lane(plane, chunk))
}
