//! The crossed cells by blocks of 4^3 cells of the lattice, and the evidence of their corners for parts that
//! are too thin for the lattice.
//!
//! ```text
//!     .   .   .   .   .        A *lone* point is on the other side of both of its neighbours along an axis:
//! here o and all of its
//!     .   o   .   .   .        neighbours in the row. A *scrap* is on the other side of all that is around
//! it. What is thinner than
//!     .   .   o   .   .        a cell leaves nothing else; a smooth body has a few lone points where a line
//! of the lattice touches it.
//! ```
//!
//! All of this depends only on the signs of lattice points, so it is the same for bricks of any size.

use crate::mesh::brick::{Bricks, place};
use crate::mesh::crossing::{CrossedCell, Crossings};
use crate::morton::morton;

/// Cells along the edge of a block.
pub(super) const EDGE: usize = 4;
/// Bits of the place of a cell in a block.
const BITS: u32 = 6;
/// Along each axis the cells of a block at its low end, a bit each, and those at its high end.
const LOW: [u64; 3] = [layer(0, 0), layer(1, 0), layer(2, 0)];
const HIGH: [u64; 3] = [layer(0, 3), layer(1, 3), layer(2, 3)];

const fn layer(axis: usize, index: u64) -> u64 {
    let (mut cells, mut cell) = (0, 0);
    while cell < 64 {
        let along = (cell >> axis & 1) | (cell >> (axis + 3) & 1) << 1;
        if along == index {
            cells |= 1 << cell;
        }
        cell += 1;
    }
    cells
}

/// The place of each cell of a block, numbered in Morton order, in rows: x fastest, then y, then z.
const ROW: [u8; 64] = {
    let (mut rows, mut cell) = ([0; 64], 0_u8);
    while cell < 64 {
        let mut axis = 0;
        while axis < 3 {
            let along = (cell >> axis & 1) | (cell >> (axis + 3) & 1) << 1;
            rows[cell as usize] |= along << (2 * axis);
            axis += 1;
        }
        cell += 1;
    }
    rows
};
/// For each axis the distance of neighbours in rows, and the cells at the low and at the high end, a bit
/// each.
const STEPS: [u32; 3] = [1, 4, 16];
const FIRST: [u64; 3] = [0x1111_1111_1111_1111, 0x000f_000f_000f_000f, 0x0000_0000_0000_ffff];
const LAST: [u64; 3] = [FIRST[0] << 3, FIRST[1] << 12, FIRST[2] << 48];

/// For the corners of a cell that are inside, the crossed edges at its first corner, a bit for each axis.
const CROSSED: [u8; 256] = {
    let (mut crossed, mut signs) = ([0; 256], 0);
    while signs < 256 {
        let mut axis = 0;
        while axis < 3 {
            crossed[signs] |= (((signs ^ signs >> (1 << axis)) & 1) << axis) as u8;
            axis += 1;
        }
        signs += 1;
    }
    crossed
};

/// The inverse of [`morton`].
fn unwoven(code: u64) -> [u32; 3] {
    let gather = |mut bits: u64| {
        bits &= 0x1249_2492_4924_9249;
        for (shift, mask) in [
            (2, 0x10c3_0c30_c30c_30c3),
            (4, 0x100f_00f0_0f00_f00f),
            (8, 0x001f_0000_ff00_00ff),
            (16, 0x001f_0000_0000_ffff),
            (32, 0x0000_0000_001f_ffff),
        ] {
            bits = (bits | bits >> shift) & mask;
        }
        bits as u32
    };
    [gather(code), gather(code >> 1), gather(code >> 2)]
}

/// A place some steps away, unless it is below 0.
pub(super) fn step(place: [u32; 3], steps: [i32; 3]) -> Option<[u32; 3]> {
    let mut other = place;
    for (index, step) in other.iter_mut().zip(steps) {
        *index = index.checked_add_signed(step)?;
    }
    Some(other)
}

/// The blocks that the surface crosses, in Morton order.
pub(super) struct CrossedBlocks<'a> {
    cells: &'a [CrossedCell],
    codes: Vec<u64>,
    /// The crossed cells of each block, a bit each in Morton order.
    masks: Vec<u64>,
    /// The index of the first cell of each block.
    firsts: Vec<usize>,
    /// The edges along each axis that are crossed and begin at the first corner of a cell: a bit for each
    /// cell, in rows.
    edges: Vec<[u64; 3]>,
}

/// The evidence of the corners of a block's cells.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct BlockSigns {
    /// Crossed edges of the lattice that begin in the block.
    pub(super) edges: u32,
    /// Edges at lone points, counted once for each lone end.
    pub(super) lone: u32,
    /// A lone point or a scrap, by its place in the lattice.
    pub(super) first: Option<[u32; 3]>,
    /// Whether `first` is a scrap.
    pub(super) is_scrap: bool,
}

impl<'a> CrossedBlocks<'a> {
    pub(super) fn new(bricks: &Bricks, crossings: &'a Crossings) -> Self {
        let mut crossed = Self {
            cells: &crossings.cells,
            codes: Vec::new(),
            masks: Vec::new(),
            firsts: Vec::new(),
            edges: Vec::new(),
        };
        let bits = 3 * bricks.edge.ilog2();
        for (brick, &place) in bricks.places.iter().enumerate() {
            let before = morton(place) << bits;
            let mut first = crossings.starts[brick];
            for cells in crossings.of(brick).chunk_by(|a, b| a.number >> BITS == b.number >> BITS) {
                let code = (before | u64::from(cells[0].number)) >> BITS;
                // Small bricks share a block.
                if crossed.codes.last() != Some(&code) {
                    crossed.codes.push(code);
                    crossed.masks.push(0);
                    crossed.firsts.push(first);
                    crossed.edges.push([0; 3]);
                }
                let last = crossed.codes.len() - 1;
                let (mut mask, mut edges) = (crossed.masks[last], crossed.edges[last]);
                for cell in cells {
                    let bit = (before | u64::from(cell.number)) & ((1 << BITS) - 1);
                    mask |= 1 << bit;
                    let begin = CROSSED[usize::from(cell.signs)];
                    for (axis, edges) in edges.iter_mut().enumerate() {
                        *edges |= u64::from(begin >> axis & 1) << ROW[bit as usize];
                    }
                }
                (crossed.masks[last], crossed.edges[last]) = (mask, edges);
                first += cells.len();
            }
        }
        crossed
    }

    /// The number of blocks.
    pub(super) fn len(&self) -> usize {
        self.codes.len()
    }

    /// The place of a block, in units of blocks.
    pub(super) fn place(&self, block: usize) -> [u32; 3] {
        unwoven(self.codes[block])
    }

    /// The crossed cells of a block, by their indices among all.
    pub(super) fn cells(&self, block: usize) -> std::ops::Range<usize> {
        self.firsts[block]..self.firsts[block] + self.masks[block].count_ones() as usize
    }

    /// The first block that has this code or a larger one.
    pub(super) fn first_from(&self, code: u64, near: usize) -> usize {
        let (mut low, mut high) = (near.min(self.len()), near.min(self.len()));
        let mut stride = 1;
        while low > 0 && self.codes[low - 1] >= code {
            high = low - 1;
            low = low.saturating_sub(stride);
            stride *= 2;
        }
        while high < self.len() && self.codes[high] < code {
            low = high + 1;
            high = (high + stride).min(self.len());
            stride *= 2;
        }
        low + self.codes[low..high].partition_point(|&other| other < code)
    }

    fn find(&self, code: u64, near: usize) -> Option<usize> {
        let first = self.first_from(code, near);
        (self.codes.get(first) == Some(&code)).then_some(first)
    }

    /// Whether a block is in a chunk, of eight blocks.
    pub(super) fn is_in_chunk(&self, block: usize, chunk: [u32; 3]) -> bool {
        self.codes.get(block).is_some_and(|&code| code >> 3 == morton(chunk))
    }

    /// The corners of a cell that are inside; `None` if it is not crossed.
    fn signs(&self, cell: [u32; 3], near: usize) -> Option<u8> {
        let code = morton(cell);
        let block = self.find(code >> BITS, near)?;
        self.signs_in(block, code & ((1 << BITS) - 1))
    }

    fn signs_in(&self, block: usize, bit: u64) -> Option<u8> {
        let mask = self.masks[block];
        let before = (mask & ((1 << bit) - 1)).count_ones() as usize;
        (mask >> bit & 1 == 1).then(|| self.cells[self.firsts[block] + before].signs)
    }

    /// Examines the corners of a block's cells.
    pub(super) fn look(&self, block: usize) -> BlockSigns {
        let (origin, mask) = (self.place(block), self.masks[block]);
        let cells = &self.cells[self.cells(block)];
        let (mut found, mut lone): (BlockSigns, Option<(u32, usize)>) = (BlockSigns::default(), None);
        for axis in 0..3 {
            let edges = self.edges[block][axis];
            let behind = if edges & LAST[axis] == 0 { 0 } else { self.edges_behind(block, axis) };
            let next = (edges & !FIRST[axis]) >> STEPS[axis] | (behind & FIRST[axis]) << (3 * STEPS[axis]);
            let both = edges & next;
            found.edges += edges.count_ones();
            if both != 0 {
                found.lone += 2 * both.count_ones();
                let first = (both.trailing_zeros(), axis);
                lone = Some(lone.map_or(first, |lone| lone.min(first)));
            }
        }
        if let Some((bit, axis)) = lone {
            let mut point = [0, 1, 2].map(|axis| origin[axis] * EDGE as u32 + (bit >> (2 * axis) & 3));
            point[axis] += 1;
            found.first = Some(point);
            let is_scrap = |&(bit, cell): &(u64, &CrossedCell)| {
                matches!(cell.signs, 0x80 | 0x7f) && self.is_scrap(self.cell(origin, bit), cell.signs, block)
            };
            if let Some((bit, _)) = bits(mask).zip(cells).find(is_scrap) {
                found.first = Some(self.cell(origin, bit).map(|index| index + 1));
                found.is_scrap = true;
            }
        }
        found
    }

    /// The crossed edges along an axis in the block behind another block's high side.
    fn edges_behind(&self, block: usize, axis: usize) -> u64 {
        let mut steps = [0; 3];
        steps[axis] = 1;
        let other = step(self.place(block), steps).and_then(|place| self.find(morton(place), block));
        other.map_or(0, |other| self.edges[other][axis])
    }

    /// The cells without crossed neighbours, a bit each, in a block whose chunk has no crossed cell.
    pub(super) fn free(&self, at: [u32; 3], near: usize) -> u64 {
        // Layers of 6 x 6 cells, a bit each in rows of 8: the block, and one cell more on each side.
        let mut layers = [0_u64; EDGE + 2];
        for direction in 1..8_u32 {
            // The neighbouring chunks that the block touches.
            let outwards =
                [0, 1, 2].map(|axis| (direction >> axis & 1) as i32 * (2 * (at[axis] & 1) as i32 - 1));
            let Some(chunk) = step(at.map(|index| index >> 1), outwards) else { continue };
            let first = self.first_from(morton(chunk) << 3, near);
            for block in (first..).take_while(|&block| self.is_in_chunk(block, chunk)) {
                let place = self.place(block);
                let steps = [0, 1, 2].map(|axis| place[axis].wrapping_sub(at[axis]) as i32);
                if steps.iter().all(|step| step.abs() <= 1) {
                    self.mark(block, steps, &mut layers);
                }
            }
        }
        if layers == [0; EDGE + 2] {
            return !0;
        }
        for layer in &mut layers {
            *layer |= *layer << 1 | *layer >> 1;
            *layer |= *layer << 8 | *layer >> 8;
        }
        let beside: [u64; EDGE] = std::array::from_fn(|z| layers[z] | layers[z + 1] | layers[z + 2]);
        let is_free = |&bit: &usize| {
            let [x, y, z] = [0, 2, 4].map(|shift| ROW[bit] >> shift & 3);
            beside[usize::from(z)] >> (x + 1 + 8 * (y + 1)) & 1 == 0
        };
        (0..64).filter(is_free).fold(0, |free, bit| free | 1 << bit)
    }

    /// Marks the crossed cells of a neighbouring block, `steps` away, that touch this block.
    fn mark(&self, block: usize, steps: [i32; 3], layers: &mut [u64; EDGE + 2]) {
        let mut mask = self.masks[block];
        for axis in 0..3 {
            mask &= [HIGH[axis], !0, LOW[axis]][(steps[axis] + 1) as usize];
        }
        for bit in bits(mask) {
            let along =
                |axis: usize| i32::from(ROW[bit as usize] >> (2 * axis) & 3) + EDGE as i32 * steps[axis] + 1;
            layers[along(2) as usize] |= 1 << (along(0) + 8 * along(1));
        }
    }

    /// The place of a cell of a block.
    fn cell(&self, origin: [u32; 3], bit: u64) -> [u32; 3] {
        let place = place(bit as u16);
        [0, 1, 2].map(|axis| origin[axis] * EDGE as u32 + place[axis] as u32)
    }

    /// Whether the last corner of a cell is alone on its side in all eight cells around it.
    fn is_scrap(&self, cell: [u32; 3], signs: u8, near: usize) -> bool {
        (1..8_u8).all(|other| {
            let cell = [0, 1, 2].map(|axis| cell[axis] + u32::from(other >> axis & 1));
            let alone = 1 << (7 ^ other);
            self.signs(cell, near) == Some(if signs == 0x80 { alone } else { !alone })
        })
    }
}

/// The bits that are set, the lowest first.
pub(super) fn bits(mut mask: u64) -> impl Iterator<Item = u64> {
    std::iter::from_fn(move || {
        let bit = (mask != 0).then(|| u64::from(mask.trailing_zeros()))?;
        mask &= mask - 1;
        Some(bit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_woven_of_places() {
        let mut rng = fastrand::Rng::with_seed(1);
        for _ in 0..1000 {
            let place = [0; 3].map(|_| rng.u32(0..1 << 20));
            let code = morton(place);
            let expected = (0..20).fold(0, |code, bit| {
                (0..3).fold(code, |code, axis| code | u64::from(place[axis] >> bit & 1) << (3 * bit + axis))
            });
            assert_eq!((code, unwoven(code)), (expected, place));
        }
    }

    #[test]
    fn codes_are_found_from_anywhere() {
        let codes: Vec<u64> = (0..100).map(|n| n * n).collect();
        let crossed = CrossedBlocks {
            cells: &[],
            masks: vec![0; 100],
            firsts: vec![0; 100],
            edges: vec![[0; 3]; 100],
            codes,
        };
        for near in [0, 1, 17, 99, 100, 200] {
            for code in 0..10_000 {
                let expected = crossed.codes.partition_point(|&other| other < code);
                assert_eq!(crossed.first_from(code, near), expected, "{code} from {near}");
            }
        }
    }

    #[test]
    fn layers_are_the_sides_of_a_block() {
        for bit in 0..64_u64 {
            for axis in 0..3 {
                let along = place(bit as u16)[axis];
                assert_eq!((LOW[axis] >> bit & 1 == 1, HIGH[axis] >> bit & 1 == 1), (along == 0, along == 3));
                let row = ROW[bit as usize];
                assert_eq!(
                    (FIRST[axis] >> row & 1 == 1, LAST[axis] >> row & 1 == 1),
                    (along == 0, along == 3)
                );
            }
        }
    }
}
