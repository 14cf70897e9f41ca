//! Blocks of a lattice: where they are.

use super::super::error::MAX_BRICK;
use super::super::lattice::Lattice;
use crate::boxes::Box3;

/// A cube of cells of a lattice, aligned to multiples of its edge.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LatticeBlock {
    edge: usize,
    place: [u32; 3],
}

/// The cells by which reaches grow: those of the bricks that a mesh is made of.
const REACH: usize = 8;

impl LatticeBlock {
    /// The reach that suffices nearly always, in cells.
    pub const REACH: usize = REACH;

    /// The block of a lattice in this place, in units of blocks; `None` if there is no such block, or if the
    /// edge is no power of two from 32 on.
    #[must_use]
    pub fn new(lattice: &Lattice, edge: usize, place: [u32; 3]) -> Option<Self> {
        let is_edge = edge.is_power_of_two() && edge >= MAX_BRICK;
        let is_there = |axis: usize| {
            (place[axis] as usize).checked_mul(edge).is_some_and(|first| first < lattice.cells()[axis])
        };
        (is_edge && (0..3).all(is_there)).then_some(Self { edge, place })
    }

    /// Where it is, in units of blocks.
    #[must_use]
    pub fn place(&self) -> [u32; 3] {
        self.place
    }

    /// The first cell and the one behind the last along each axis, with `more` cells on every side as far as
    /// the lattice has them.
    #[must_use]
    pub fn cells(&self, lattice: &Lattice, more: usize) -> [[usize; 3]; 2] {
        let first = self.place.map(|index| index as usize * self.edge);
        let end = |axis: usize| (first[axis] + self.edge).saturating_add(more).min(lattice.cells()[axis]);
        [first.map(|index| index.saturating_sub(more)), [end(0), end(1), end(2)]]
    }

    /// The closed box of the points that are looked at for a reach in cells, a multiple of
    /// [`REACH`](Self::REACH), in coordinates about the model's origin.
    #[must_use]
    pub fn bounds(&self, lattice: &Lattice, reach: usize) -> Box3 {
        let [low, end] = self.cells(lattice, reach);
        let corner = |indices: [usize; 3]| [0, 1, 2].map(|axis| lattice.coordinate(axis, indices[axis]));
        Box3::new(corner(low), corner(end))
    }

    /// Whether the whole lattice is within this reach.
    #[must_use]
    pub fn is_whole(&self, lattice: &Lattice, reach: usize) -> bool {
        self.cells(lattice, reach) == [[0; 3], lattice.cells()]
    }
}
