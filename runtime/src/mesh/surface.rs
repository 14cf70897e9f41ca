//! The triangles: a quad around each crossed edge of the lattice, split along its shorter diagonal.
//!
//! A quad belongs to the last of the four cells around its edge, which has the edge at its low corner. The
//! other three cells may be in bricks below. So each brick sees its cells in a table with one more layer on
//! each low side, filled from those bricks.

use jbt_ir::memory::NoMemory;

use crate::parallel::*;
use crate::span::span;

use super::brick::{At, BrickSides, Bricks, NONE, direction, number};
use super::cell::{EDGE_CORNERS, SheetNumbers, default_numbers, low_turns, sheets_with_quads};
use super::crossing::{CrossedCell, Crossings};
use super::doubtful::{DoubtfulQuads, VertexSet};
use super::fill::{FilledVector, VectorPart, room_in};
use super::sample::BrickSamples;

/// Room for the triangles of all quads: where the samples were, if that is enough.
pub(super) fn room(crossings: &Crossings, samples: BrickSamples) -> Result<FilledVector<[u32; 3]>, NoMemory> {
    let count = 2 * crossings.quad_count();
    Ok(FilledVector::in_room(room_in(samples.into_room(), count)?, count))
}

/// The same for the few quads of an edit.
pub(super) fn room_of_few(crossings: &Crossings) -> FilledVector<[u32; 3]> {
    FilledVector::few(2 * crossings.quad_count())
}

/// Fills room for the triangles of all quads, in the order of the cells that own them; and the quads at
/// doubtful vertices. It asks at times whether to go on.
pub(crate) fn triangles<E: Send>(
    (bricks, crossings): (&Bricks, &Crossings),
    mut triangles: FilledVector<[u32; 3]>,
    (positions, doubtful): (&[[f32; 3]], &VertexSet),
    go_on: impl Fn() -> Result<(), E> + Sync,
) -> Result<(Vec<[u32; 3]>, DoubtfulQuads), E> {
    span!("triangles");
    let group = bricks.group();
    let groups = triangles.parts(&crossings.quads, group, 2);
    let rooms = Rooms::new(|| (Around::new(bricks), Vec::new()));
    let fill = |room: &mut Room<'_, MarkedQuads>,
                (index, mut triangles): (usize, VectorPart<'_, [u32; 3]>)| {
        span!("triangles of some bricks");
        go_on()?;
        let (around, marked) = &mut **room;
        let (first, mut found) = (index * group, Vec::new());
        for brick in first..bricks.len().min(first + group) {
            let count = crossings.quads[brick + 1] - crossings.quads[brick];
            if count == 0 {
                continue;
            }
            around.fill(bricks, (crossings, doubtful), brick);
            let pairs = &mut *triangles.take(2 * count).open().as_chunks_mut().0;
            marked.resize(marked.len().max(count), 0);
            let marks = split_quads(around, positions, pairs, marked);
            let quads = marked[..marks].iter().map(|&quad| quad as usize);
            let quads = quads.map(|quad| (crossings.quads[brick] + quad, pairs[quad]));
            found.extend(doubtful.quads(quads, positions));
        }
        Ok(found)
    };
    let found: Result<DoubtfulQuads, E> = scatter(|_| {
        let groups = in_pieces(groups.into_par_iter().enumerate());
        groups.map_init(|| rooms.take(), fill).collect()
    });
    let found = found?;
    Ok((triangles.finish(), found))
}

/// What finds the quads of a brick, and the numbers of those at marked cells.
type MarkedQuads = (Around, Vec<u32>);

/// A crossed cell: its first vertex, and the sheets of its edges.
#[derive(Clone, Copy, Default)]
struct CellVertices {
    vertex: u32,
    sheets: SheetNumbers,
}

impl CellVertices {
    /// The vertex at a corner of a quad that is in this cell.
    #[inline(always)]
    fn at(&self, corner: &Corner) -> u32 {
        self.vertex + self.sheets.at(corner.place)
    }
}

/// What makes entries of the cells of a brick.
struct CellEntry<'a> {
    /// The brick's first vertex.
    vertex: u32,
    sides: BrickSides,
    /// Cells with a vertex of the set are marked, and maybe some that share their sides with others.
    marked: &'a VertexSet,
}

impl<'a> CellEntry<'a> {
    fn new(bricks: &Bricks, (crossings, marked): (&Crossings, &'a VertexSet), brick: usize) -> Self {
        let vertex = crossings.vertices[brick] as u32;
        Self { vertex, sides: BrickSides::new(bricks, brick), marked }
    }

    #[inline(always)]
    fn vertices(&self, cell: &CrossedCell, at: At) -> CellVertices {
        let sides = self.sides.of(at);
        let sheets = if sides == 0 && cell.flips == 0 {
            default_numbers(cell.signs)
        } else {
            sheets_with_quads(cell.signs, cell.flips, sides).numbers()
        };
        let vertex = self.vertex + cell.vertex;
        let mark = if sheets.is_one() {
            self.marked.has(vertex)
        } else {
            (vertex..vertex.saturating_add(4)).fold(0, |any, vertex| any | self.marked.has(vertex))
        };
        CellVertices { vertex, sheets: sheets.with_mark(mark as u32) }
    }
}

/// One of the four cells around an edge, relative to the last one.
#[derive(Clone, Copy, Default)]
struct Corner {
    /// The distance in the table back from the last cell.
    back: u32,
    /// The place of the edge's sheet in [`SheetNumbers`].
    place: u32,
}

/// The cells of a brick and the cells just below it. Entries of cells that are not crossed are arbitrary.
pub(super) struct Around {
    /// x fastest, then y, then z; each begins with the layer below the brick.
    table: Vec<CellVertices>,
    /// Room for the indices of some crossed cells of a brick.
    chosen: Vec<u16>,
    /// The quads of the brick: eight times the place of the last cell around the edge, plus the number of its
    /// turn.
    quads: Vec<u32>,
    /// The four cells around an edge along an axis, counter-clockwise as seen from the edge's high end or, if
    /// the inside is there, from its low end: for `2 axis` and `2 axis + 1`.
    turns: [[Corner; 4]; 8],
    /// The place of the brick's first cell.
    first: usize,
    /// The distances of cells along the axes.
    steps: [usize; 3],
}

impl Around {
    pub(super) fn new(bricks: &Bricks) -> Self {
        let stride = bricks.stride();
        let steps = [1, stride, stride * stride];
        let table = vec![CellVertices::default(); bricks.table_len()];
        let mut turns = [[Corner::default(); 4]; 8];
        for axis in 0..3 {
            let (b, c) = (steps[(axis + 1) % 3] as u32, steps[(axis + 2) % 3] as u32);
            // A cell that lies back along an axis has the edge on its high side there.
            let edges = [(b + c, 3), (c, 2), (0, 0), (b, 1)];
            let turn = edges.map(|(back, edge)| Corner { back, place: 2 * (4 * axis as u32 + edge) });
            turns[2 * axis] = turn;
            turns[2 * axis + 1] = [turn[3], turn[2], turn[1], turn[0]];
        }
        let first = steps.iter().sum();
        Self { table, chosen: Vec::new(), quads: Vec::new(), turns, first, steps }
    }

    /// Finds the quads of a brick, and fills the part of the table that they read.
    fn fill(&mut self, bricks: &Bricks, of: (&Crossings, &VertexSet), brick: usize) {
        let lows = self.enter_own(bricks, of, brick);
        // The cells around an edge are back along two axes at most.
        for below in 1..7 {
            if (0..8).all(|low| lows >> low & 1 == 0 || low & below != below) {
                continue;
            }
            let is_below = [0, 1, 2].map(|axis| below >> axis & 1 == 1);
            let other = bricks.neighbours[brick][direction(is_below.map(|is| -i8::from(is)))];
            if other != NONE {
                // Its last layer is just below the first one of this brick.
                let last = number(is_below.map(|is| if is { bricks.edge - 1 } else { 0 }));
                let back: usize =
                    (0..3).filter(|&axis| is_below[axis]).map(|axis| bricks.edge * self.steps[axis]).sum();
                self.enter_layer(bricks, of, other as usize, last, self.first.wrapping_sub(back));
            }
        }
    }

    /// Enters the cells of a brick into the table, and finds its quads: crossed edges at the low corners of
    /// its cells with all four cells around them. Returns the low sides of the brick that these cells touch,
    /// as a set of sets of axes.
    fn enter_own(
        &mut self,
        bricks: &Bricks,
        (crossings, marked): (&Crossings, &VertexSet),
        brick: usize,
    ) -> u8 {
        /// For each set of low sides of the lattice that a cell touches: the edges at its low corner, a bit
        /// for each axis, that touch no other than the side across.
        const INNER: [u8; 8] = [0b111, 0b001, 0b010, 0, 0b100, 0, 0, 0];
        /// Room for the quads of a cell, and one that is not to stay.
        const ROOM: usize = 4;
        let enter = CellEntry::new(bricks, (crossings, marked), brick);
        let sides = bricks.sides(brick);
        let cut = sides & 1 | sides >> 1 & 2 | sides >> 2 & 4;
        let (cells, places) = (crossings.of(brick), bricks.cells());
        let Self { table, quads, first, .. } = self;
        quads.resize(quads.len().max(3 * cells.len() + ROOM), 0);
        // Entries that are not to stay are overwritten: a branch would be mispredicted for every third cell.
        let (mut count, mut lows) = (0, 0);
        for cell in cells {
            let at = places[usize::from(cell.number)];
            let place = at.in_table() + *first;
            table[place] = enter.vertices(cell, at);
            let low = at.lows();
            lows |= 1 << low;
            let room: &mut [u32; ROOM] = quads[count..].first_chunk_mut().expect("room");
            let (turns, mut of_cell) = low_turns(cell.signs);
            for (quad, turn) in room.iter_mut().zip(turns) {
                *quad = 8 * place as u32 + u32::from(turn);
            }
            if low & cut != 0 {
                of_cell = keep_inner(room, of_cell, INNER[usize::from(low & cut)]);
            }
            count += of_cell;
        }
        debug_assert_eq!(count, crossings.quads[brick + 1] - crossings.quads[brick]);
        lows
    }

    /// Enters into the table the cells of a brick whose number has all of these bits, relative to the brick's
    /// first cell.
    fn enter_layer(
        &mut self,
        bricks: &Bricks,
        (crossings, marked): (&Crossings, &VertexSet),
        brick: usize,
        bits: u16,
        first: usize,
    ) {
        let enter = CellEntry::new(bricks, (crossings, marked), brick);
        let cells = crossings.of(brick);
        // Ascending; the first one that may have all bits has no others.
        let cells = &cells[cells.partition_point(|cell| cell.number < bits)..];
        // First their indices, without a branch, which would be mispredicted for every third cell.
        let mut count = 0;
        self.chosen.resize(self.chosen.len().max(cells.len()), 0);
        for (index, cell) in (0..).zip(cells) {
            self.chosen[count] = index;
            count += usize::from(cell.number & bits == bits);
        }
        for &index in &self.chosen[..count] {
            let cell = &cells[usize::from(index)];
            let at = bricks.at(cell.number);
            self.table[first.wrapping_add(at.in_table())] = enter.vertices(cell, at);
        }
    }

    /// Visits the quads of a brick: with their places among these, the last cell's place in the table, and
    /// the vertex of each corner with the number of the crossed edge in its cell.
    pub(super) fn visit(
        &mut self,
        bricks: &Bricks,
        crossings: &Crossings,
        brick: usize,
        mut visit: impl FnMut(usize, usize, [(u32, u32); 4]),
    ) {
        self.fill(bricks, (crossings, &VertexSet::NONE), brick);
        for quad in 0..crossings.quads[brick + 1] - crossings.quads[brick] {
            let code = self.quads[quad];
            let (at, turn) = ((code / 8) as usize, self.turns[(code % 8) as usize]);
            visit(
                quad,
                at - self.first,
                turn.map(|corner| (self.cell(at, &corner).at(&corner), corner.place / 2)),
            );
        }
    }

    /// The cell at a corner of a quad, from the place of its last cell.
    #[inline(always)]
    fn cell(&self, at: usize, corner: &Corner) -> &CellVertices {
        &self.table[at - corner.back as usize]
    }
}

/// Keeps those of the first quads that are around an edge along one of these axes (a bit each). Returns how
/// many.
#[cold]
fn keep_inner(quads: &mut [u32; 4], count: usize, axes: u8) -> usize {
    let mut kept = 0;
    for n in 0..count {
        if axes >> (quads[n] % 8 / 2) & 1 == 1 {
            quads[kept] = quads[n];
            kept += 1;
        }
    }
    kept
}

/// The two triangles of each quad of a brick. The quads at marked cells are counted, and their numbers are
/// written to `marked`, which has room for all.
#[cfg_attr(feature = "levels", multiversion::multiversion(targets("x86_64+avx2")))]
fn split_quads(
    around: &Around,
    positions: &[[f32; 3]],
    pairs: &mut [[[u32; 3]; 2]],
    marked: &mut [u32],
) -> usize {
    let mut count = 0;
    for (number, (pair, &quad)) in (0..).zip(pairs.iter_mut().zip(&around.quads)) {
        let (at, turn) = ((quad / 8) as usize, &around.turns[(quad % 8) as usize]);
        let (mut vertices, mut is_marked) = ([0; 4], 0);
        for (vertex, corner) in vertices.iter_mut().zip(turn) {
            let cell = around.cell(at, corner);
            *vertex = cell.at(corner);
            is_marked |= cell.sheets.mark();
        }
        *pair = halves(vertices, |vertex| positions[vertex as usize]);
        // Without a branch, as above.
        marked[count] = number;
        count += is_marked as usize;
    }
    count
}

/// Splits a quad along its shorter diagonal, or from its first vertex if they are equal.
#[inline(always)]
pub(super) fn halves([p, q, r, s]: [u32; 4], at: impl Fn(u32) -> [f32; 3]) -> [[u32; 3]; 2] {
    let distance = |p: u32, q: u32| {
        let (p, q) = (at(p), at(q));
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from(p[axis]) - f64::from(q[axis]));
        x * x + y * y + z * z
    };
    // In both ways q r s or p q r comes first: a selection instead of a branch, which would be mispredicted
    // half of the time.
    let (d, e) = if distance(p, r) <= distance(q, s) { (p, r) } else { (s, q) };
    [[q, r, d], [e, s, p]]
}

// The numbers of the edges above are those of the cell's table.
const _: () = {
    let mut edge = 0;
    while edge < 12 {
        let (axis, b, c) = (edge / 4, edge & 1, edge >> 1 & 1);
        assert!(EDGE_CORNERS[edge][0] == b << ((axis + 1) % 3) | c << ((axis + 2) % 3));
        edge += 1;
    }
};
