//! The search for parts that no cell shows: in blocks of 4^3 cells that the surface does not cross, whose
//! range does not exclude it.
//!
//! ```text
//! chunk of 8^3 cells, not crossed ─ ranges of its blocks ─► a block is *open* if the other side may be in it
//! open block ─ ranges of 2^3 cells ─► of cells ─► of halved cells ─► ...
//!                 8 boxes a step, the best first; a point on the other side in the middle of one ends it
//! ```
//!
//! A step costs one credit, and boxes that it proves empty pay for further steps: the search goes on while it
//! makes progress, and takes at most [`MAX_STEPS`]. Chunks are boxes of the division, whose regions are found
//! by repeated halving of the lattice; so the search is a function of the lattice, for bricks of any size.
//!
//! A chunk that the surface crosses is left out: nearly all of space beside a smooth surface is in such
//! chunks, and searching them would cost more than the mesh.

use super::crossed::{CrossedBlocks, EDGE, bits};
use crate::boxes::{ANYTHING, Box3, MAX_PARTS, Range};
use crate::mesh::brick::{box_of, place};
use crate::mesh::error::MeshError;
use crate::mesh::field::Field;
use crate::morton::morton;

/// The most steps of eight boxes for a block. A speck usually takes nine: two down to its cell, and one for
/// each halving.
pub(super) const MAX_STEPS: u32 = 32;
/// The most boxes that may stay open in a block, over all steps. A speck leaves one or two of eight open.
/// Where ranges are wide, or the field is near iso everywhere, half of them stay open, and the search ends
/// soon.
const MAX_OPEN: u32 = 40;
/// The number of halvings of a cell: parts of a fiftieth of a cell are found.
const HALVINGS: u32 = 6;
/// The credit of a step that proves all of its boxes empty. A sheet passes through at most six of eight
/// boxes, so the search for a sheet pays for itself. Where ranges prove nothing the search ends with its
/// first step.
const GAIN: f32 = 4.0;
/// The ops of a point from which on a block gets a region of its own.
const COSTLY: u64 = 1000;

/// The result for a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BlockOutcome {
    /// Nothing is there.
    Empty,
    /// This point is on the other side.
    Missed([f32; 3]),
    /// The search ended undecided.
    Unproven,
}

/// The results for the blocks of a chunk.
#[derive(Default)]
pub(super) struct ChunkFindings {
    /// Points on the other side, each with the place of its block.
    pub(super) missed: Vec<([u32; 3], [f32; 3])>,
    pub(super) unproven: u64,
    pub(super) boxes: u64,
}

/// The inputs that are the same for all blocks.
pub(super) struct ThinSearch<'a, F: Field> {
    pub(super) field: &'a F,
    pub(super) axes: &'a [Vec<f32>; 3],
    pub(super) iso: f32,
    pub(super) crossed: &'a CrossedBlocks<'a>,
    /// The places of the blocks that the surface may cross, in Morton order, and their regions, if the
    /// division reached their size.
    pub(super) blocks: Option<Blocks<'a, F::Region>>,
}

type Blocks<'a, R> = (&'a [[u32; 3]], &'a [R]);

/// A box that may hold a point of the other side.
#[derive(Clone, Copy)]
struct OpenBox {
    bounds: Box3,
    /// How far the range extends beyond iso.
    reach: f32,
    /// The remaining halvings.
    halvings: u32,
}

/// A search in one block.
struct BlockSearch<'a, R> {
    region: &'a R,
    /// Whether the corners of its cells are inside.
    inside: bool,
    credit: f32,
    steps: u32,
    /// The number of boxes that stayed open so far.
    opened: u32,
    open: Vec<OpenBox>,
    unproven: bool,
}

impl<F: Field> ThinSearch<'_, F> {
    /// Searches all blocks in a box of this many cells along an edge, 8 or more.
    pub(super) fn chunk(
        &self,
        (size, at): (usize, [u32; 3]),
        region: &F::Region,
        near: &mut usize,
        found: &mut ChunkFindings,
    ) -> Result<(), MeshError<F::Error>> {
        let half = size / 2;
        if half == EDGE {
            *near = self.crossed.first_from(morton(at) << 3, *near);
            if self.crossed.is_in_chunk(*near, at) {
                return Ok(());
            }
            if let Some(blocks) = self.blocks {
                return self.divided(blocks, (at, region), *near, found);
            }
        }
        let (mut boxes, mut places) = ([Box3::default(); MAX_PARTS], [[0; 3]; MAX_PARTS]);
        let mut count = 0;
        for child in 0..8_u32 {
            let place = [0, 1, 2].map(|axis| 2 * at[axis] + (child >> axis & 1));
            let first = place.map(|index| index as usize * half);
            if (0..3).all(|axis| first[axis] + 1 < self.axes[axis].len()) {
                (boxes[count], places[count]) =
                    (box_of(self.axes, first, first.map(|index| index + half)), place);
                count += 1;
            }
        }
        if count == 0 {
            return Ok(());
        }
        let boxes = &boxes[..count];
        let may_cross = |range: Range| !(range[0] >= self.iso || range[1] < self.iso);
        if half == EDGE {
            let ranges = self.ranges(region, boxes)?;
            for n in (0..count).filter(|&n| may_cross(ranges[n])) {
                self.block(places[n], (boxes[n], region, None), *near, found)?;
            }
            return Ok(());
        }
        let (mut kept, mut regions) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut wants = |n: usize, range: Range| {
            if may_cross(range) {
                kept.push(n);
            }
            may_cross(range)
        };
        self.field.split(region, boxes, &mut wants, &mut regions).map_err(MeshError::Field)?;
        for (n, region) in kept.into_iter().zip(regions) {
            self.chunk((half, places[n]), &region, near, found)?;
        }
        Ok(())
    }

    /// Searches the blocks of a chunk that the division has kept: those whose ranges contain iso.
    fn divided(
        &self,
        (places, regions): Blocks<'_, F::Region>,
        (chunk, around): ([u32; 3], &F::Region),
        near: usize,
        found: &mut ChunkFindings,
    ) -> Result<(), MeshError<F::Error>> {
        let first = places.partition_point(|&place| morton(place) >> 3 < morton(chunk));
        let inside = places[first..].iter().take_while(|place| place.map(|index| index >> 1) == chunk);
        for (&place, region) in inside.zip(&regions[first..]) {
            let first = place.map(|index| index as usize * EDGE);
            let bounds = box_of(self.axes, first, first.map(|index| index + EDGE));
            self.block(place, (bounds, around, Some(region)), near, found)?;
        }
        Ok(())
    }

    /// Searches a block in a chunk of this region. The block's own region is used if the chunk's is costly.
    fn block(
        &self,
        at: [u32; 3],
        (bounds, region, own): (Box3, &F::Region, Option<&F::Region>),
        near: usize,
        found: &mut ChunkFindings,
    ) -> Result<(), MeshError<F::Error>> {
        let free = self.free(at, near);
        if free == 0 {
            return Ok(());
        }
        let narrowed;
        let region = match own {
            _ if self.field.work(region).ops <= COSTLY => region,
            Some(own) => own,
            None => {
                let mut own = Vec::with_capacity(1);
                self.field.narrow(region, &[bounds], &mut own).map_err(MeshError::Field)?;
                narrowed = own.pop().expect("one box has one region");
                &narrowed
            }
        };
        let corner = bounds.low.map(|coordinate| [coordinate]);
        let mut value = [0.0];
        self.field.field(region, &corner[0], &corner[1], &corner[2], &mut value).map_err(MeshError::Field)?;
        let mut block = BlockSearch {
            region,
            inside: value[0] >= self.iso,
            credit: 1.0,
            steps: 0,
            opened: 0,
            open: Vec::new(),
            unproven: false,
        };
        let outcome = self.search(&mut block, at, free, found)?;
        match outcome {
            BlockOutcome::Empty => {}
            BlockOutcome::Missed(point) => found.missed.push((at, point)),
            BlockOutcome::Unproven => found.unproven += 1,
        }
        Ok(())
    }

    /// The cells of a block that are in the lattice and have no crossed neighbours, a bit each.
    fn free(&self, at: [u32; 3], near: usize) -> u64 {
        let is_cut = |axis: usize| (at[axis] as usize + 1) * EDGE + 1 > self.axes[axis].len();
        let free = self.crossed.free(at, near);
        if !(0..3).any(is_cut) {
            return free;
        }
        let is_there = |&bit: &u64| {
            let place = place(bit as u16);
            (0..3).all(|axis| at[axis] as usize * EDGE + place[axis] + 1 < self.axes[axis].len())
        };
        bits(free).filter(is_there).fold(0, |free, bit| free | 1 << bit)
    }

    fn search(
        &self,
        block: &mut BlockSearch<'_, F::Region>,
        at: [u32; 3],
        free: u64,
        found: &mut ChunkFindings,
    ) -> Result<BlockOutcome, MeshError<F::Error>> {
        let first = at.map(|index| index as usize * EDGE);
        let cells = |bit: u64, size: usize| {
            let place = place(bit as u16);
            let low = [0, 1, 2].map(|axis| first[axis] + place[axis]);
            box_of(self.axes, low, low.map(|index| index + size))
        };
        let octants: Vec<u64> = (0..8).filter(|octant| free >> (8 * octant) & 0xff != 0).collect();
        let boxes: Vec<Box3> = octants.iter().map(|octant| cells(8 * octant, 2)).collect();
        let ranges = self.ask(block, &boxes, found)?;
        let mut left: Vec<(f32, u64)> = Vec::new();
        for (octant, range) in octants.into_iter().zip(ranges) {
            left.extend(self.reach(block, range).map(|reach| (reach, octant)));
        }
        left.sort_by(|a, b| a.0.total_cmp(&b.0));
        while let Some((_, octant)) = left.pop() {
            if !block.may_go_on() {
                return Ok(BlockOutcome::Unproven);
            }
            let boxes: Vec<Box3> =
                bits(free >> (8 * octant) & 0xff).map(|bit| cells(8 * octant + bit, 1)).collect();
            if let Some(point) = self.divide(block, &boxes, HALVINGS, found)? {
                return Ok(BlockOutcome::Missed(point));
            }
            while let Some(open) = block.open.pop() {
                if !block.may_go_on() {
                    return Ok(BlockOutcome::Unproven);
                }
                let Some(parts) = parts(&open.bounds).filter(|_| open.halvings > 0) else {
                    block.unproven = true;
                    continue;
                };
                if let Some(point) = self.divide(block, &parts, open.halvings - 1, found)? {
                    return Ok(BlockOutcome::Missed(point));
                }
            }
        }
        Ok(if block.unproven { BlockOutcome::Unproven } else { BlockOutcome::Empty })
    }

    /// Computes the ranges of some boxes and puts those that stay open on the list, the best last; or returns
    /// a point on the other side.
    fn divide(
        &self,
        block: &mut BlockSearch<'_, F::Region>,
        boxes: &[Box3],
        halvings: u32,
        found: &mut ChunkFindings,
    ) -> Result<Option<[f32; 3]>, MeshError<F::Error>> {
        let ranges = self.ask(block, boxes, found)?;
        let mut open = [OpenBox { bounds: Box3::default(), reach: 0.0, halvings }; MAX_PARTS];
        let mut count = 0;
        for (&bounds, range) in boxes.iter().zip(ranges) {
            if let Some(reach) = self.reach(block, range) {
                open[count] = OpenBox { bounds, reach, halvings };
                count += 1;
            }
        }
        let open = &mut open[..count];
        if open.is_empty() {
            return Ok(None);
        }
        let mut planes = [[0.0; MAX_PARTS]; 3];
        for (n, part) in open.iter().enumerate() {
            (0..3).for_each(|axis| planes[axis][n] = part.bounds.middle(axis));
        }
        let mut values = [0.0; MAX_PARTS];
        let [x, y, z] = planes.each_ref().map(|plane| &plane[..count]);
        self.field.field(block.region, x, y, z, &mut values[..count]).map_err(MeshError::Field)?;
        if let Some(n) = (0..count).find(|&n| (values[n] >= self.iso) != block.inside) {
            return Ok(Some([x[n], y[n], z[n]]));
        }
        open.sort_by(|a, b| a.reach.total_cmp(&b.reach));
        block.open.extend_from_slice(open);
        Ok(None)
    }

    /// How far a range extends beyond iso on the other side; `None` if it does not.
    fn reach(&self, block: &BlockSearch<'_, F::Region>, [low, high]: Range) -> Option<f32> {
        let reach = if block.inside { self.iso - low } else { high - self.iso };
        let is_clear = if block.inside { low >= self.iso } else { high < self.iso };
        (!is_clear).then_some(reach)
    }

    /// The ranges of some boxes; counts the cost.
    fn ask(
        &self,
        block: &mut BlockSearch<'_, F::Region>,
        boxes: &[Box3],
        found: &mut ChunkFindings,
    ) -> Result<[Range; MAX_PARTS], MeshError<F::Error>> {
        found.boxes += boxes.len() as u64;
        let ranges = self.ranges(block.region, boxes)?;
        let clear = ranges[..boxes.len()].iter().filter(|&&range| self.reach(block, range).is_none()).count();
        block.steps += 1;
        block.opened += (boxes.len() - clear) as u32;
        block.credit += GAIN * clear as f32 / boxes.len() as f32 - 1.0;
        Ok(ranges)
    }

    fn ranges(&self, region: &F::Region, boxes: &[Box3]) -> Result<[Range; MAX_PARTS], MeshError<F::Error>> {
        let mut ranges = [ANYTHING; MAX_PARTS];
        self.field.ranges(region, boxes, &mut ranges[..boxes.len()]).map_err(MeshError::Field)?;
        Ok(ranges)
    }
}

impl<R> BlockSearch<'_, R> {
    fn may_go_on(&self) -> bool {
        self.credit > 0.0 && self.steps < MAX_STEPS && self.opened < MAX_OPEN
    }
}

/// The eight parts of a box that is halved along all axes; `None` if f32 has no middle for it.
fn parts(bounds: &Box3) -> Option<[Box3; 8]> {
    let middle = [0, 1, 2].map(|axis| bounds.middle(axis));
    let splits = |axis: usize| bounds.low[axis] < middle[axis] && middle[axis] < bounds.high[axis];
    (0..3).all(splits).then(|| {
        std::array::from_fn(|part| {
            let is_high = |axis: usize| part >> axis & 1 == 1;
            Box3 {
                low: [0, 1, 2].map(|axis| if is_high(axis) { middle[axis] } else { bounds.low[axis] }),
                high: [0, 1, 2].map(|axis| if is_high(axis) { bounds.high[axis] } else { middle[axis] }),
            }
        })
    })
}
