//! Marching squares in a block: segments of the contour, each with the vertex that it begins at.
//!
//! ```text
//!   3 --2-- 2      corners and edges of a cell, counter-clockwise. An edge from an inside corner to an outside one begins a segment, the
//!   |       |      other way round it ends one; so the inside is on the left, and every crossed edge begins one segment and ends one,
//!   3       1      in the two cells beside it.
//!   |       |      Two corners inside across from each other: the field at the middle of the cell says whether they are
//!   0 --0-- 1      joined. It is asked about the cell alone, so its answer does not depend on blocks.
//! ```
//!
//! Beyond the rectangle everything is outside: there is one more row of cells around it, of no width, in
//! which the contour follows the border.

use super::divide::CellSquare;
use super::grid::Grid;
use super::roots::{CutEdge, solve};
use super::slicer::Slicer;
use crate::error::EvalError;
use crate::prune::Region;
use crate::touched::Touched;

/// The name of an edge of the lattice: the axis that it is along, then the row, then the column of the point
/// at its upper end. One that leads to the lattice from beyond it has 0 along its axis, and one that leads
/// out of it has one more than the last point.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) struct EdgeKey(u64);

/// Bits of a row or a column: from 0 to 2^20 + 1.
const BITS: u32 = 21;

impl EdgeKey {
    fn new(axis: usize, column: u32, row: u32) -> Self {
        Self((axis as u64) << (2 * BITS) | u64::from(row) << BITS | u64::from(column))
    }

    /// The name of the edge after so many columns and rows were added below.
    fn moved(self, [columns, rows]: [u32; 2]) -> Self {
        Self::new(self.axis(), self.column() + columns, self.row() + rows)
    }

    /// The axis that it is along: 0 is u.
    pub(super) fn axis(self) -> usize {
        (self.0 >> (2 * BITS)) as usize
    }

    pub(super) fn row(self) -> u32 {
        (self.0 >> BITS) as u32 & ((1 << BITS) - 1)
    }

    pub(super) fn column(self) -> u32 {
        self.0 as u32 & ((1 << BITS) - 1)
    }
}

/// A piece of the contour, with the inside on its left.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContourSegment {
    /// The edges that it begins and ends at.
    pub(super) from: EdgeKey,
    pub(super) to: EdgeKey,
    /// The vertex where it begins.
    pub(super) place: [f32; 2],
    /// Whether the point at the lower end of the edge where it begins is inside.
    pub(super) low_inside: bool,
    /// Whether it begins on the border, at a point of the lattice.
    pub(super) border: bool,
}

/// The segments of a square, and the attributes of their vertices.
pub(super) struct Segments {
    pub(super) list: Vec<ContourSegment>,
    /// Plane by plane.
    pub(super) attributes: Vec<Vec<f32>>,
}

impl Segments {
    /// The segments after so many columns and rows were added below the lattice.
    pub(super) fn moved(&self, below: [u32; 2]) -> Self {
        let moved = |segment: &ContourSegment| ContourSegment {
            from: segment.from.moved(below),
            to: segment.to.moved(below),
            ..*segment
        };
        Self { list: self.list.iter().map(moved).collect(), attributes: self.attributes.clone() }
    }

    /// Whether both have the same bits.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let bits = |segment: &ContourSegment| {
            let ContourSegment { from, to, place, low_inside, border } = *segment;
            (from, to, place.map(f32::to_bits), low_inside, border)
        };
        let attributes = |segments: &Self| -> Vec<Vec<u32>> {
            segments
                .attributes
                .iter()
                .map(|plane| plane.iter().map(|value| value.to_bits()).collect())
                .collect()
        };
        self.list.iter().map(bits).eq(other.list.iter().map(bits)) && attributes(self) == attributes(other)
    }
}

/// A block of cells with the field at its points.
pub(super) struct CellBlock<'a> {
    slicer: &'a Slicer,
    grid: &'a Grid,
    /// The first and the last point.
    first: [u32; 2],
    last: [u32; 2],
    values: Vec<f32>,
}

/// A segment before its vertex is known.
struct SegmentDraft {
    segment: ContourSegment,
    edge: Option<CutEdge>,
}

impl<'a> CellBlock<'a> {
    /// Evaluates the points of a square.
    pub(super) fn new(
        slicer: &'a Slicer,
        grid: &'a Grid,
        square: &CellSquare,
        region: &Region,
    ) -> Result<Self, EvalError> {
        let [u, v] = grid.block(square.first, square.end.map(|end| end + 1));
        let mut values = Vec::new();
        slicer.values(region, [&u, &v], &mut values)?;
        Ok(Self { slicer, grid, first: square.first, last: square.end, values })
    }

    /// The field at a point of the block.
    fn value(&self, [i, j]: [u32; 2]) -> f32 {
        let width = (self.last[0] - self.first[0] + 1) as usize;
        self.values[(j - self.first[1]) as usize * width + (i - self.first[0]) as usize]
    }

    /// The points at the corners of a cell, which has the number of its corner 2.
    fn corners([i, j]: [u32; 2]) -> [[u32; 2]; 4] {
        // A cell before the first column has no lower corners: they wrap, and are beyond the lattice as well.
        let (left, below) = (i.wrapping_sub(1), j.wrapping_sub(1));
        [[left, below], [i, below], [i, j], [left, j]]
    }

    fn is_inside(&self, point: [u32; 2]) -> bool {
        let here = (0..2).all(|axis| (self.first[axis]..=self.last[axis]).contains(&point[axis]));
        here && self.value(point) >= self.slicer.iso
    }

    /// The cells of the block, with those beyond the border that it touches: from the first to before the
    /// end.
    fn cells(&self) -> [[u32; 2]; 2] {
        let points = self.grid.points().map(|points| points as u32);
        let first = self.first.map(|first| if first == 0 { 0 } else { first + 1 });
        let end =
            [0, 1].map(|axis| self.last[axis] + if self.last[axis] + 1 == points[axis] { 2 } else { 1 });
        [first, end]
    }

    /// All segments of the block.
    pub(super) fn segments(&self, region: &Region) -> Result<Segments, EvalError> {
        let [first, end] = self.cells();
        let mut crossed = Vec::new();
        let mut saddles = Vec::new();
        for j in first[1]..end[1] {
            for i in first[0]..end[0] {
                let inside = Self::corners([i, j]).map(|corner| self.is_inside(corner));
                if inside == [true; 4] || inside == [false; 4] {
                    continue;
                }
                if inside[0] == inside[2] && inside[1] == inside[3] {
                    saddles.push([i, j]);
                }
                crossed.push(([i, j], inside));
            }
        }
        let joined = self.joined(region, &saddles)?;
        let mut joined = joined.into_iter();
        let mut drafts = Vec::with_capacity(crossed.len() + saddles.len());
        for (cell, inside) in crossed {
            let is_saddle = inside[0] == inside[2] && inside[1] == inside[3];
            let join = is_saddle && joined.next() == Some(true);
            self.draft(cell, inside, join, &mut drafts);
        }
        self.finish(region, &drafts)
    }

    /// Whether the inside corners of each ambiguous cell are joined: they are, if its middle is inside.
    fn joined(&self, region: &Region, saddles: &[[u32; 2]]) -> Result<Vec<bool>, EvalError> {
        if saddles.is_empty() {
            return Ok(Vec::new());
        }
        let middle = |axis: usize| {
            let at = |cell: &[u32; 2]| {
                let [low, high] =
                    [cell[axis] - 1, cell[axis]].map(|point| self.grid.axes[axis][point as usize]);
                0.5 * low + 0.5 * high
            };
            saddles.iter().map(at).collect::<Vec<f32>>()
        };
        let mut values = Vec::new();
        self.slicer.values(region, [&middle(0), &middle(1)], &mut values)?;
        Ok(values.iter().map(|&value| value >= self.slicer.iso).collect())
    }

    /// The segments of a cell.
    fn draft(&self, cell: [u32; 2], inside: [bool; 4], join: bool, drafts: &mut Vec<SegmentDraft>) {
        let corners = Self::corners(cell);
        let [i, j] = cell;
        // An edge at which a segment begins or ends has a point of the lattice, so nothing wraps here that is
        // used.
        let key = |edge: usize| match edge {
            0 => EdgeKey::new(0, i, j.wrapping_sub(1)),
            1 => EdgeKey::new(1, i, j),
            2 => EdgeKey::new(0, i, j),
            _ => EdgeKey::new(1, i.wrapping_sub(1), j),
        };
        let ends = |edge: usize| inside[edge] != inside[(edge + 1) % 4] && !inside[edge];
        for edge in (0..4).filter(|&edge| inside[edge] && !inside[(edge + 1) % 4]) {
            // Around the inside corner (clockwise from the edge), or, if it is joined to the other one,
            // around the outside corner.
            let step = if join { 1 } else { 3 };
            let mut to = (edge + step) % 4;
            while !ends(to) {
                to = (to + step) % 4;
            }
            let (near, far) = (corners[edge], corners[(edge + 1) % 4]);
            let (crossing, place) = self.crossing(edge % 2, near, far);
            drafts.push(SegmentDraft {
                segment: ContourSegment {
                    from: key(edge),
                    to: key(to),
                    place,
                    low_inside: edge == 0 || edge == 1,
                    border: crossing.is_none(),
                },
                edge: crossing,
            });
        }
    }

    /// The edge from an inside point to an outside one; on the border there is none, and the vertex is the
    /// inside point.
    fn crossing(&self, axis: usize, near: [u32; 2], far: [u32; 2]) -> (Option<CutEdge>, [f32; 2]) {
        let coordinate = |axis: usize, point: [u32; 2]| self.grid.axes[axis][point[axis] as usize];
        let place = [coordinate(0, near), coordinate(1, near)];
        let points = self.grid.points();
        if (far[axis] as usize) >= points[axis] {
            return (None, place);
        }
        let edge = CutEdge {
            axis,
            beside: place[1 - axis],
            ends: [place[axis], coordinate(axis, far)],
            values: [self.value(near), self.value(far)],
        };
        (Some(edge), place)
    }

    /// Finds the vertices, and what they have.
    fn finish(&self, region: &Region, drafts: &[SegmentDraft]) -> Result<Segments, EvalError> {
        let edges: Vec<CutEdge> = drafts.iter().filter_map(|draft| draft.edge).collect();
        let mut field =
            |points: [&[f32]; 2], values: &mut Vec<f32>| self.slicer.values(region, points, values);
        let mut places = solve(&edges, self.slicer.iso, &mut field)?.into_iter();
        let list = drafts.iter().map(|draft| {
            let place = draft.edge.and_then(|_| places.next()).unwrap_or(draft.segment.place);
            ContourSegment { place, ..draft.segment }
        });
        with_attributes(self.slicer, region, list.collect())
    }
}

/// The segments along the border of a square that is inside as a whole: one for each side that is on the
/// border, and one for each corner.
pub(super) fn border(
    slicer: &Slicer,
    grid: &Grid,
    square: &CellSquare,
    region: &Region,
) -> Result<Option<Segments>, EvalError> {
    let [last_u, last_v] = grid.points().map(|points| points as u32 - 1);
    let ([a, b], [c, d]) = (square.first, square.end);
    let mut list = Vec::new();
    let mut push = |from: EdgeKey, to: EdgeKey, [i, j]: [u32; 2], low_inside: bool| {
        let place = [grid.axes[0][i as usize], grid.axes[1][j as usize]];
        list.push(ContourSegment { from, to, place, low_inside, border: true });
    };
    // Edges that lead out of the lattice: to the left, below, to the right, above.
    let left = |j: u32| EdgeKey::new(0, 0, j);
    let below = |i: u32| EdgeKey::new(1, i, 0);
    let right = |j: u32| EdgeKey::new(0, last_u + 1, j);
    let above = |i: u32| EdgeKey::new(1, i, last_v + 1);
    let sides = [a == 0, b == 0, c == last_u, d == last_v];
    if sides[1] {
        push(below(a), below(c), [a, b], false);
    }
    if sides[1] && sides[2] {
        push(below(c), right(b), [c, b], false);
    }
    if sides[2] {
        push(right(b), right(d), [c, b], true);
    }
    if sides[2] && sides[3] {
        push(right(d), above(c), [c, d], true);
    }
    if sides[3] {
        push(above(c), above(a), [c, d], true);
    }
    if sides[3] && sides[0] {
        push(above(a), left(d), [a, d], true);
    }
    if sides[0] {
        push(left(d), left(b), [a, d], false);
    }
    if sides[0] && sides[1] {
        push(left(b), below(a), [a, b], false);
    }
    if list.is_empty() { Ok(None) } else { with_attributes(slicer, region, list).map(Some) }
}

/// The smallest squares of a square that lie along the border of the lattice, and are touched.
pub(super) fn along_border(
    square: &CellSquare,
    leaf: u32,
    (grid, touched): (&Grid, Option<&Touched<2>>),
) -> Vec<CellSquare> {
    let last = grid.points().map(|points| points as u32 - 1);
    let starts = |axis: usize| (square.first[axis]..square.end[axis]).step_by(leaf as usize);
    let is_at_side = |axis: usize, first: u32| first == 0 || first + leaf >= last[axis];
    let ends: Vec<u32> = starts(0).filter(|&u| is_at_side(0, u)).collect();
    let mut along = Vec::new();
    for v in starts(1) {
        let us: &mut dyn Iterator<Item = u32> =
            if is_at_side(1, v) { &mut starts(0) } else { &mut ends.iter().copied() };
        along.extend(us.map(|u| CellSquare {
            first: [u, v],
            end: [(u + leaf).min(square.end[0]), (v + leaf).min(square.end[1])],
            size: leaf,
        }));
    }
    let has = |part: &CellSquare| {
        touched.is_none_or(|touched| touched.has_brick(part.first.map(|cell| cell / leaf)))
    };
    along.retain(has);
    along
}

fn with_attributes(
    slicer: &Slicer,
    region: &Region,
    list: Vec<ContourSegment>,
) -> Result<Segments, EvalError> {
    let Some(full) = slicer.full.as_ref().filter(|_| !list.is_empty()) else {
        return Ok(Segments { list, attributes: Vec::new() });
    };
    let [u, v] = [0, 1].map(|axis| list.iter().map(|segment| segment.place[axis]).collect::<Vec<f32>>());
    let mut planes = vec![vec![0.0; list.len()]; full.layout().names().len()];
    let mut answers: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    slicer.eval(full, region, [&u, &v], &mut answers)?;
    // The field comes first, and is known.
    planes.remove(0);
    Ok(Segments { list, attributes: planes })
}
