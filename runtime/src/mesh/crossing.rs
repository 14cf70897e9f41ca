//! The cells that the surface crosses, and the faces that are flipped to keep the mesh manifold.
//!
//! If on an ambiguous face both segments lie on one sheet, in both of its cells, an edge of the mesh would
//! have four triangles. Flipping that face re-pairs two segments of one oriented cycle, which always splits
//! the cycle, in both cells. A flip never joins two sheets, so a good face stays good, and one pass over the
//! faces that are bad by default ends with all faces good. The pass is sequential, in the order of the cells;
//! such faces are rare.

use std::error::Error;

use jbt_ir::watch;

use crate::parallel::*;
use crate::progress::{Cancelled, Progress};
use crate::span::span;

use super::brick::{BrickSides, Bricks, NONE, direction, number, place, starts};
use super::cell::{CellCases, SheetEdges, case, default_edges, edges, sheets};
use super::error::MeshError;
use super::fill::{FilledVector, VectorPart};
use super::report::Sides;
use super::sample::BrickSamples;

/// A cell that the surface crosses.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct CrossedCell {
    /// The vertex of its first sheet, counted from the first vertex of its brick; the vertices of the other
    /// sheets follow.
    pub(crate) vertex: u32,
    /// Its number in its brick, in Morton order.
    pub(crate) number: u16,
    /// Which corners are inside, a bit each.
    pub(crate) signs: u8,
    /// Which faces are flipped, a bit each.
    pub(crate) flips: u8,
}

/// All crossing cells, in Morton order.
pub(crate) struct Crossings {
    pub(crate) cells: Vec<CrossedCell>,
    /// Where the cells of each brick begin, and the end.
    pub(crate) starts: Vec<usize>,
    /// Where the vertices of each brick begin, and the end.
    pub(crate) vertices: Vec<usize>,
    /// Where the quads of each brick begin, and the end.
    pub(crate) quads: Vec<usize>,
    /// The number of flipped faces.
    pub(crate) flipped_faces: u64,
    /// The sides of the lattice with a point inside.
    pub(crate) cut: Sides,
    /// Whether the mesh has a rim, at sides of the lattice. Otherwise it is closed.
    pub(crate) is_open: bool,
}

impl Crossings {
    /// The cells of a brick.
    pub(crate) fn of(&self, brick: usize) -> &[CrossedCell] {
        &self.cells[self.starts[brick]..self.starts[brick + 1]]
    }

    /// The number of vertices.
    pub(crate) fn vertex_count(&self) -> usize {
        self.vertices[self.vertices.len() - 1]
    }

    /// The number of quads.
    pub(crate) fn quad_count(&self) -> usize {
        self.quads[self.quads.len() - 1]
    }
}

/// Finds the crossing cells, flips faces, and numbers the vertices.
pub(crate) fn find<E: Error + Send + 'static>(
    bricks: &Bricks,
    samples: &BrickSamples,
    progress: &Progress<'_>,
) -> Result<Crossings, MeshError<E>> {
    let mut found = look(bricks, samples, progress)?;
    let flips = flip(bricks, &found.starts, &mut found.cells, &found.suspects);
    Ok(found.numbered(bricks, &flips, progress)?)
}

/// The crossing cells of all bricks, before faces are flipped.
pub(crate) struct UnflippedCells {
    pub(crate) cells: Vec<CrossedCell>,
    /// Where the cells of each brick begin, and the end.
    pub(crate) starts: Vec<usize>,
    /// Cells with a low face that is pinched by default: the brick and the cell, ascending.
    pub(crate) suspects: Vec<(usize, usize)>,
    /// What each brick has, as if no face were to be flipped.
    counts: Vec<BrickCounts>,
    cut: Sides,
}

impl UnflippedCells {
    /// The crossings, once faces are flipped: bricks with a flip are numbered anew.
    pub(crate) fn numbered(
        self,
        bricks: &Bricks,
        flips: &Flips,
        progress: &Progress<'_>,
    ) -> Result<Crossings, Cancelled> {
        span!("number");
        let Self { mut cells, mut counts, starts, suspects: _, cut } = self;
        for &brick in &flips.bricks {
            progress.breathe()?;
            counts[brick] = number_brick(bricks, brick, &mut cells[starts[brick]..starts[brick + 1]]);
        }
        let vertices = self::starts(counts.iter().map(|count| count.vertices as usize));
        let quads = self::starts(counts.iter().map(|count| count.quads));
        let is_open = counts.iter().any(|count| count.is_open);
        Ok(Crossings { cells, starts, vertices, quads, flipped_faces: flips.faces, cut, is_open })
    }

    /// Leaves out cells that are not to be kept, by their bricks.
    pub(crate) fn keep(&mut self, bricks: &Bricks, is_kept: impl Fn(usize, &CrossedCell) -> bool) {
        let (mut cells, mut starts) = (Vec::with_capacity(self.cells.len()), vec![0]);
        for brick in 0..bricks.len() {
            let of_brick = &self.cells[self.starts[brick]..self.starts[brick + 1]];
            cells.extend(of_brick.iter().filter(|cell| is_kept(brick, cell)));
            self.counts[brick] = number_brick(bricks, brick, &mut cells[starts[brick]..]);
            starts.push(cells.len());
        }
        (self.cells, self.starts) = (cells, starts);
        self.suspects.clear();
    }
}

/// What a brick has besides its cells and vertices: numbers and places in lists, on the way to a mesh. An
/// estimate.
const BRICK_BYTES: usize = 256;

/// Finds the crossing cells.
pub(crate) fn look<E: Error + Send + 'static>(
    bricks: &Bricks,
    samples: &BrickSamples,
    progress: &Progress<'_>,
) -> Result<UnflippedCells, MeshError<E>> {
    span!("cross");
    watch::take(BRICK_BYTES * bricks.len());
    let group = bricks.group();
    let groups = bricks.len().div_ceil(group);
    let rooms = Rooms::new(|| (Signs::new(bricks), FoundCells::default()));
    let of_group = |room: &mut Room<'_, (Signs, FoundCells)>, index: usize| {
        span!("cells of some bricks");
        progress.breathe()?;
        let (signs, found) = &mut **room;
        found.clear();
        for brick in index * group..bricks.len().min((index + 1) * group) {
            samples.gather_inside(bricks, brick, &mut signs.points);
            signs.find(bricks, brick, found);
        }
        // Once as it is, and once in the list of all.
        watch::take(2 * size_of_val(&*found.cells));
        // As large as it is, while it is in the cache.
        Ok(found.clone())
    };
    let found: Result<Vec<FoundCells>, Cancelled> = scatter(|watches| {
        let groups = in_pieces((0..groups).into_par_iter());
        groups.map_init(|| rooms.take(), |room, group| watches.hold(|| of_group(room, group))).collect()
    });
    let found = found?;
    let firsts = starts(found.iter().map(|found| found.cells.len()));
    let (mut suspects, mut cut) = (Vec::new(), Sides::default());
    let (mut counts, mut cell_counts) = (Vec::with_capacity(bricks.len()), Vec::with_capacity(bricks.len()));
    for (found, first) in found.iter().zip(&firsts) {
        progress.breathe()?;
        suspects.extend(found.suspects.iter().map(|&(brick, cell)| (brick as usize, first + cell as usize)));
        cell_counts.extend_from_slice(&found.cell_counts);
        counts.extend_from_slice(&found.counts);
        cut.add(found.cut);
    }
    let mut cells = FilledVector::new(firsts[found.len()])?;
    let parts = cells.parts(&firsts, 1, 1);
    let join = |(part, found): (VectorPart<'_, CrossedCell>, &FoundCells)| {
        progress.breathe()?;
        part.fill(&found.cells);
        Ok::<_, Cancelled>(())
    };
    scatter(|_| parts.into_par_iter().zip(&found).try_for_each(join))?;
    let starts = starts(cell_counts.into_iter());
    Ok(UnflippedCells { cells: cells.finish(), counts, starts, suspects, cut })
}

/// The crossing cells of some bricks.
#[derive(Clone, Default)]
struct FoundCells {
    cells: Vec<CrossedCell>,
    /// The number of cells of each brick, and what else it has.
    cell_counts: Vec<usize>,
    counts: Vec<BrickCounts>,
    /// Cells with a low face that is pinched by default: the brick, and the index among the found cells.
    suspects: Vec<(u32, u32)>,
    cut: Sides,
}

impl FoundCells {
    /// Forgets them, and keeps their room.
    fn clear(&mut self) {
        let Self { cells, cell_counts, counts, suspects, cut } = self;
        cells.clear();
        cell_counts.clear();
        counts.clear();
        suspects.clear();
        *cut = Sides::default();
    }
}

/// Places for eight crossed cells and one that is not; a power of two, so that none is beyond them.
const ROOM: usize = 16;

/// Room for the signs of one brick.
struct Signs {
    /// The number of points in its closed box.
    count: usize,
    /// A bit for each point: whether it is inside. Then, step by step, the bits of points beside it, too.
    points: Vec<u8>,
    pairs: Vec<u8>,
    /// For each point, the signs of the cell whose low corner it is.
    cells: Vec<u8>,
    /// Room for the crossed cells of a brick, and [`ROOM`] more.
    crossed: Vec<CrossedCell>,
}

impl Signs {
    fn new(bricks: &Bricks) -> Self {
        let count = bricks.table_len();
        let padded = vec![0; count + bricks.stride().pow(2)];
        let crossed = vec![CrossedCell::default(); bricks.edge.pow(3) + ROOM];
        Self { count, points: padded.clone(), pairs: padded.clone(), cells: padded, crossed }
    }

    /// Appends the crossing cells of a brick.
    fn find(&mut self, bricks: &Bricks, brick: usize, found: &mut FoundCells) {
        let (extent, sides) = (bricks.extent(brick), bricks.sides(brick));
        if sides != 0 {
            self.find_cut(bricks, extent, sides, &mut found.cut);
        }
        let is_cut = extent.iter().any(|&cells| cells < bricks.edge);
        let (before, mut counts) = (found.cells.len(), BrickCounts::default());
        if is_cut || self.is_mixed() {
            self.join(bricks.stride());
            if is_cut {
                self.clear_beyond(bricks.stride(), extent);
            }
            counts = self.push_cells(bricks, brick, found);
        }
        let cells = &mut found.cells[before..];
        found.cell_counts.push(cells.len());
        found.counts.push(if sides == 0 { counts } else { number_brick(bricks, brick, cells) });
    }

    /// Whether some points are inside and some are not.
    fn is_mixed(&self) -> bool {
        let points = &self.points[..self.count];
        let (any, all) = points.iter().fold((0, 1), |(any, all), bit| (any | bit, all & bit));
        any != all
    }

    /// The signs of all cells, from the signs of points: first pairs along x, then squares, then cubes.
    fn join(&mut self, stride: usize) {
        let count = self.count;
        join::<1>(&self.points, 1, &mut self.cells[..count]);
        join::<2>(&self.cells, stride, &mut self.pairs[..count]);
        join::<4>(&self.pairs, stride * stride, &mut self.cells[..count]);
    }

    /// Clears the signs of points at the lattice's end, which have no cells.
    fn clear_beyond(&mut self, stride: usize, extent: [usize; 3]) {
        for (index, signs) in self.cells.iter_mut().enumerate() {
            let place = [index % stride, index / stride % stride, index / (stride * stride)];
            if (0..3).any(|axis| place[axis] >= extent[axis]) {
                *signs = 0;
            }
        }
    }

    /// The sides of the lattice on which this brick has a point inside.
    fn find_cut(&self, bricks: &Bricks, extent: [usize; 3], sides: u8, cut: &mut Sides) {
        let stride = bricks.stride();
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let steps = [1, stride, stride * stride];
            let any = |index: usize| {
                (0..=extent[c]).any(|k| {
                    (0..=extent[b])
                        .any(|j| self.points[index * steps[axis] + j * steps[b] + k * steps[c]] == 1)
                })
            };
            cut.low[axis] |= sides >> (2 * axis) & 1 == 1 && any(0);
            cut.high[axis] |= sides >> (2 * axis + 1) & 1 == 1 && any(extent[axis]);
        }
    }

    /// Appends the crossing cells of a brick, and numbers their vertices as inside the lattice. Returns what
    /// the brick has there.
    fn push_cells(&mut self, bricks: &Bricks, brick: usize, found: &mut FoundCells) -> BrickCounts {
        let stride = bricks.stride();
        let layer = stride * stride;
        let (before, mut count, mut counts) = (found.cells.len(), 0, BrickCounts::default());
        for (octet, at) in bricks.octets().enumerate() {
            let cells = &self.cells[at.in_table()..][..layer + stride + 2];
            let pairs = [0, stride, layer, layer + stride]
                .map(|at| u64::from(u16::from_le_bytes([cells[at], cells[at + 1]])));
            let signs = pairs[0] | pairs[1] << 16 | pairs[2] << 32 | pairs[3] << 48;
            // Most cells are on one side of the surface, and usually so are the next seven.
            if signs == 0 || signs == u64::MAX {
                continue;
            }
            // In the others crossed cells are unpredictable, so there is no branch: each cell is written, and
            // the next one overwrites it unless it is crossed.
            let (first, mut cases) = (count, CellCases::default());
            let room: &mut [CrossedCell; ROOM] = self.crossed[first..].first_chunk_mut().expect("room");
            for (rest, signs) in (0..).zip(signs.to_le_bytes()) {
                let (vertex, number) = (counts.vertices + cases.sheets(), (octet as u16) << 3 | rest);
                room[cases.crossed() % ROOM] = CrossedCell { vertex, number, signs, flips: 0 };
                cases = cases.and(case(signs));
            }
            count += cases.crossed();
            counts.vertices += cases.sheets();
            counts.quads += cases.quads();
            if cases.pinched_low() > 0 {
                let cells = (before..).zip(&self.crossed[..count]).skip(first);
                let pinched = cells.filter(|(_, cell)| case(cell.signs).pinched_low() > 0);
                found.suspects.extend(pinched.map(|(index, _)| (brick as u32, index as u32)));
            }
        }
        found.cells.extend_from_slice(&self.crossed[..count]);
        counts
    }
}

/// Combines the bits at each place with the bits `step` places further, shifted by `WIDTH`.
fn join<const WIDTH: usize>(bits: &[u8], step: usize, joined: &mut [u8]) {
    for ((joined, near), far) in joined.iter_mut().zip(bits).zip(&bits[step..]) {
        *joined = near | far << WIDTH;
    }
}

/// Faces that have been flipped.
#[derive(Default)]
pub(crate) struct Flips {
    /// How many.
    pub(crate) faces: u64,
    /// The bricks whose cells they belong to, ascending.
    pub(crate) bricks: Vec<usize>,
}

/// Flips faces until none is pinched in both of its cells.
pub(crate) fn flip(
    bricks: &Bricks,
    starts: &[usize],
    cells: &mut [CrossedCell],
    suspects: &[(usize, usize)],
) -> Flips {
    span!("flip");
    let mut flips = Flips::default();
    for &(brick, upper) in suspects {
        for axis in 0..3 {
            // An earlier flip may have split one of the sheets already.
            let pinched = |cells: &[CrossedCell], cell: usize, face: usize| {
                let CrossedCell { signs, flips, .. } = cells[cell];
                sheets(signs, flips).pinched(face)
            };
            if !pinched(cells, upper, 2 * axis) {
                continue;
            }
            let Some(lower) = below(bricks, starts, cells, brick, upper, axis) else { continue };
            if pinched(cells, lower, 2 * axis + 1) {
                cells[upper].flips |= 1 << (2 * axis);
                cells[lower].flips |= 1 << (2 * axis + 1);
                flips.faces += 1;
                let other = starts.partition_point(|&start| start <= lower) - 1;
                flips.bricks.extend([brick, other]);
            }
        }
    }
    flips.bricks.sort_unstable();
    flips.bricks.dedup();
    flips
}

/// The crossed cell below a crossed cell of a brick along an axis; `None` at the lattice's end, or if the
/// cell there is not crossed.
pub(crate) fn below(
    bricks: &Bricks,
    starts: &[usize],
    cells: &[CrossedCell],
    brick: usize,
    cell: usize,
    axis: usize,
) -> Option<usize> {
    let mut place = place(cells[cell].number);
    let mut brick = brick;
    if place[axis] == 0 {
        let mut step = [0; 3];
        step[axis] = -1;
        let other = bricks.neighbours[brick][direction(step)];
        if other == NONE {
            return None;
        }
        (brick, place[axis]) = (other as usize, bricks.edge);
    }
    place[axis] -= 1;
    let range = starts[brick]..starts[brick + 1];
    let found = cells[range.clone()].binary_search_by_key(&number(place), |cell| cell.number);
    found.ok().map(|index| range.start + index)
}

/// What a brick has.
#[derive(Clone, Copy, Default)]
struct BrickCounts {
    vertices: u32,
    quads: usize,
    /// Whether the mesh has a rim here.
    is_open: bool,
}

/// Numbers the vertices of a brick, and counts them and the quads.
fn number_brick(bricks: &Bricks, brick: usize, cells: &mut [CrossedCell]) -> BrickCounts {
    let sides = BrickSides::new(bricks, brick);
    let mut counts = BrickCounts::default();
    for cell in cells {
        cell.vertex = counts.vertices;
        let touched = sides.of(bricks.at(cell.number));
        if touched == 0 && cell.flips == 0 {
            let case = case(cell.signs);
            counts.vertices += case.sheets();
            counts.quads += case.quads();
            continue;
        }
        let differs = |corner: u8| usize::from((cell.signs ^ cell.signs >> corner) & 1);
        let mut count = |sheets: &[SheetEdges]| {
            counts.vertices += sheets.iter().filter(|sheet| sheet.have_quad(touched)).count() as u32;
            counts.is_open |= sheets.iter().any(|sheet| sheet.have_rim(touched));
        };
        if cell.flips == 0 {
            count(default_edges(cell.signs));
        } else {
            count(&edges(cell.signs, cell.flips));
        }
        let [x, y, z] = [0, 2, 4].map(|side| usize::from(touched >> side & 1 == 0));
        counts.quads += differs(1) * y * z + differs(2) * z * x + differs(4) * x * y;
    }
    counts
}
