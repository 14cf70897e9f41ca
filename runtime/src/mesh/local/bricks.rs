//! The kept bricks of a mesh, and where they are.

use jbt_model::orientation::Orientation;
use rustc_hash::FxHashMap;

use super::slots::{BufferSlot, BufferSlots};
use crate::boxes::Box3;
use crate::mesh::brick::{Bricks, NONE, direction};
use crate::mesh::crossing::CrossedCell;
use crate::mesh::indexed::Mesh;
use crate::mesh::lattice::Lattice;
use crate::mesh::vertex::side::SharpVertex;
use crate::morton::morton;
use crate::touched::Touched;

/// The place of a brick in units of bricks, counted from the lattice's anchor.
pub(crate) type BrickPlace = [i32; 3];

/// A brick that the surface crosses.
pub(super) struct KeptBrick {
    pub(super) cells: Vec<CrossedCell>,
    /// The cells with a low face that is pinched by default, ascending.
    pub(super) suspects: Vec<u32>,
    /// The number of quads that belong to its cells.
    pub(super) quads: usize,
    /// In the buffers of vertices.
    pub(super) vertices: BufferSlot,
    /// In the buffer of triangles.
    pub(super) triangles: BufferSlot,
    /// Vertices whose normals are compared with their triangles, counted from the first one, and their
    /// normals before that.
    pub(super) doubtful: Vec<(u32, [f32; 3])>,
    /// Vertices on edges and corners of the surface, counted from the first one.
    pub(super) sharp: Vec<SharpVertex>,
    /// Corners of its triangles that show sides of such vertices.
    pub(super) corners: Vec<BrickCorner>,
}

/// A corner of a triangle of a brick that shows a side.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct BrickCorner {
    /// Three times the triangle, counted from the brick's first one, plus the corner.
    pub(super) corner: u32,
    /// The brick of the vertex, and the vertex, by its place among those on edges.
    pub(super) of: (BrickPlace, usize),
    pub(super) side: usize,
}

/// A mesh by bricks.
pub(crate) struct BrickMesh {
    pub(super) lattice: Lattice,
    /// Cells along the edge of a brick; 0 before there is any.
    pub(super) edge: usize,
    pub(super) bricks: FxHashMap<BrickPlace, KeptBrick>,
    /// Positions, normals, attributes and triangles of all bricks in their slots. Triangles that are in no
    /// slot, or in the unused end of one, are `[0, 0, 0]`.
    pub(super) buffers: Mesh,
    pub(super) vertex_slots: BufferSlots,
    pub(super) triangle_slots: BufferSlots,
}

impl BrickMesh {
    /// No bricks, of a lattice.
    pub(crate) fn new(lattice: Lattice, origin: [f64; 3], orientation: Orientation) -> Self {
        Self {
            lattice,
            edge: 0,
            bricks: FxHashMap::default(),
            buffers: Mesh { origin, orientation, ..Mesh::default() },
            vertex_slots: BufferSlots::default(),
            triangle_slots: BufferSlots::default(),
        }
    }

    pub(crate) fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// The buffers: see the fields.
    pub(crate) fn buffers(&self) -> &Mesh {
        &self.buffers
    }

    /// The number of bricks that the surface crosses.
    pub(crate) fn len(&self) -> usize {
        self.bricks.len()
    }

    /// The bricks of a lattice that boxes meet; `None` if that is best said as everywhere.
    pub(crate) fn touched(&self, lattice: &Lattice, boxes: &[Box3]) -> Option<Touched<3>> {
        if self.edge == 0 {
            return None;
        }
        Touched::by(&lattice.axes(), self.edge, boxes.iter().map(|bounds| [bounds.low, bounds.high]))
    }

    /// The bricks of a lattice from its first brick to its anchor.
    pub(super) fn shift(lattice: &Lattice, edge: usize) -> [i32; 3] {
        lattice.first().map(|first| (first / edge.max(1) as i64) as i32)
    }

    /// All bricks in Morton order.
    pub(crate) fn places(&self) -> Vec<BrickPlace> {
        self.in_order(self.bricks.keys().copied()).into_iter().map(|(_, place)| place).collect()
    }

    /// Bricks in Morton order, as places from the lattice's first brick and from its anchor.
    pub(super) fn in_order(&self, places: impl Iterator<Item = BrickPlace>) -> Vec<([u32; 3], BrickPlace)> {
        let shift = Self::shift(&self.lattice, self.edge);
        let from_first = |place: BrickPlace| [0, 1, 2].map(|axis| (place[axis] - shift[axis]) as u32);
        let mut places: Vec<_> = places.map(|place| (from_first(place), place)).collect();
        places.sort_unstable_by_key(|&(place, _)| morton(place));
        places
    }
}

/// Bricks in these places, in Morton order, with those of their neighbours that are below them along some
/// axes and beside them along none: all that flips and triangles ask for.
pub(super) fn linked(edge: usize, axes: [Vec<f32>; 3], places: Vec<[u32; 3]>) -> Bricks {
    let numbers: FxHashMap<[u32; 3], u32> =
        (0..).zip(&places).map(|(number, &place)| (place, number)).collect();
    let below = |&place: &[u32; 3]| {
        let mut neighbours = [NONE; 27];
        for axes in 0..8 {
            let steps = [0, 1, 2].map(|axis| -i8::from(axes >> axis & 1 == 1));
            let other = [0, 1, 2].map(|axis| place[axis].wrapping_add_signed(steps[axis].into()));
            neighbours[direction(steps)] = numbers.get(&other).copied().unwrap_or(NONE);
        }
        neighbours
    };
    let neighbours = places.iter().map(below).collect();
    Bricks::new(edge, axes, places, neighbours)
}

/// The place some bricks further.
pub(super) fn beside(place: BrickPlace, steps: [i32; 3]) -> BrickPlace {
    [0, 1, 2].map(|axis| place[axis] + steps[axis])
}

/// A brick, and the seven that are above it (`1`) or below it (`-1`) along some axes.
pub(super) fn octet(place: BrickPlace, side: i32) -> impl Iterator<Item = BrickPlace> {
    (0..8).map(move |axes: i32| beside(place, [0, 1, 2].map(|axis| side * (axes >> axis & 1))))
}

/// A brick and the 26 around it.
pub(super) fn around(place: BrickPlace) -> impl Iterator<Item = BrickPlace> {
    (0..27).map(move |n: i32| beside(place, [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1]))
}
