//! A sheet of a cell with its crossings in order. The position and the normal of its vertex are computed from
//! it elsewhere.

use super::super::brick::{BrickSides, Bricks, place};
use super::super::cell::{EDGE_CORNERS, following, sheets_with_quads};
use super::super::crossing::CrossedCell;
use super::bracket::{Bracket, CrossedEdge, CrossedEdges};
use super::normal::sheet_normal;
use crate::boxes::Box3;

/// The error of a crossing after the last halving, in parts of its edge.
const ERROR: f32 = 1.0 / 8192.0;

/// The initial data of a vertex.
#[derive(Clone, Copy)]
pub(super) struct Start {
    /// The index of the vertex in the brick.
    pub(super) vertex: usize,
    /// The box in the cell in which the vertex stays: low and high corner.
    pub(super) bounds: Box3,
}

/// One sheet of a cell.
pub(super) struct Sheet {
    /// Its vertex.
    pub(super) start: Start,
    /// The corners that the sheet separates: those outside and those inside, a bit for each corner.
    pub(super) corners: [u8; 2],
    /// The edges that the sheet crosses, counter-clockwise as seen from outside: their numbers among the
    /// [`CrossedEdges`] of the brick.
    numbers: [u32; 12],
    /// Their numbers in the cell.
    edges: [u8; 12],
    /// The number of these edges.
    count: usize,
    /// The sum of the unit vectors along the edges, from inside to outside.
    pub(super) outward: [f32; 3],
    /// The edge of the cell.
    pub(super) size: f32,
    /// The cell.
    pub(super) cell: Box3,
}

impl Sheet {
    /// A sheet of a cell in a brick; its edges are added to the brick's edges. `values` are the field at the
    /// corners.
    pub(super) fn new(
        bricks: &Bricks,
        brick: usize,
        (cell, sheet): (&CrossedCell, u32),
        start: Start,
        values: &[f32; 8],
        crossed: &mut CrossedEdges,
    ) -> Self {
        let (origin, place) = (bricks.origin(brick), place(cell.number));
        let sides = BrickSides::new(bricks, brick).of(bricks.at(cell.number));
        let mask = sheets_with_quads(cell.signs, cell.flips, sides).edges(sheet);
        let next = following(cell.signs, cell.flips);
        let first = bricks.at(cell.number).in_table();
        let ends = [0, 1, 2].map(|axis| {
            let at = origin[axis] + place[axis];
            [bricks.axes[axis][at], bricks.axes[axis][at + 1]]
        });
        let position = |corner: usize| [0, 1, 2].map(|axis| ends[axis][corner >> axis & 1]);
        let size = (0..3).fold(0.0, |size, axis| (ends[axis][1] - ends[axis][0]).max(size));
        let mut made = Self {
            start,
            corners: [0; 2],
            numbers: [0; 12],
            edges: [0; 12],
            count: 0,
            outward: [0.0; 3],
            size,
            cell: Box3::new(position(0), position(7)),
        };
        let steps = [1, bricks.stride(), bricks.stride().pow(2)];
        let mut edge = mask.trailing_zeros() as usize;
        for _ in 0..mask.count_ones() {
            let [low, high] = EDGE_CORNERS[edge];
            let is_rising = cell.signs >> high & 1 == 1;
            let [outside, inside] = if is_rising { [low, high] } else { [high, low] };
            made.corners[0] |= 1 << outside;
            made.corners[1] |= 1 << inside;
            let at = first + (0..3).map(|axis| (low >> axis & 1) * steps[axis]).sum::<usize>();
            let ends = [outside, inside];
            let bracket = || Bracket { ends: ends.map(position), values: ends.map(|end| values[end]) };
            made.numbers[made.count] = crossed.number(at, edge / 4, || CrossedEdge::new(bracket()));
            made.edges[made.count] = edge as u8;
            made.count += 1;
            made.outward[edge / 4] += if is_rising { -1.0 } else { 1.0 };
            edge = usize::from(next[edge]);
        }
        made
    }

    /// Its edges by their numbers.
    pub(super) fn numbers(&self) -> &[u32] {
        &self.numbers[..self.count]
    }

    /// The numbers of these edges in the cell.
    pub(super) fn edges(&self) -> &[u8] {
        &self.edges[..self.count]
    }

    /// Its crossed edges, in order.
    pub(super) fn crossed<'a>(
        &'a self,
        crossed: &'a CrossedEdges,
    ) -> impl ExactSizeIterator<Item = &'a CrossedEdge> {
        self.numbers().iter().map(|&number| crossed.get(number))
    }

    /// Its normal, from its crossings: see [`sheet_normal`].
    pub(super) fn normal(&self, crossed: &CrossedEdges) -> Option<[f32; 3]> {
        let mut crossings = [[0.0; 3]; 12];
        for (place, edge) in crossings.iter_mut().zip(self.crossed(crossed)) {
            *place = edge.crossing();
        }
        sheet_normal(&crossings[..self.count], self.outward, ERROR * self.size)
    }
}
