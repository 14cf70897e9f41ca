//! Bricks: cubes of cells that the surface may be in, their neighbours, and the order of their cells.
//!
//! ```text
//!      x---x---x---x---x        a brick of 4 x 4 cells (in the plane; in space it has 4 x 4 x 4);
//!      | a | b | e | f |        cells are numbered in Morton order: the bits of x, y and z
//!      o---o---o---o---x        interleaved, that of x lowest
//!      | 8 | 9 | c | d |
//!      o---o---o---o---x        o  points of its half-open box: its own
//!      | 2 | 3 | 6 | 7 |        x  points that belong to the bricks above, where there are any
//!      o---o---o---o---x
//!      | 0 | 1 | 4 | 5 |
//!      o---o---o---o---x
//! ```
//!
//! Bricks are aligned to multiples of their edge, which is a power of two, and are in Morton order as well.
//! So bricks and their cells, one after the other, run through all cells in Morton order for any edge.

use crate::boxes::Box3;

/// No brick.
pub(crate) const NONE: u32 = u32::MAX;
/// The neighbour of a brick in no direction: itself.
pub(crate) const SELF: usize = direction([0, 0, 0]);
/// The number of cells that a thread takes at a time: small enough to divide small meshes among threads,
/// large enough to make the overhead negligible.
const CELLS_AT_A_TIME: usize = 1 << 13;

/// The number of a direction, from steps of -1, 0 or 1 along the axes: 0 to 26.
pub(crate) const fn direction(steps: [i8; 3]) -> usize {
    ((steps[0] + 1) + 3 * (steps[1] + 1) + 9 * (steps[2] + 1)) as usize
}

/// The place of a cell within its brick, from its number in Morton order (of 15 bits).
#[inline]
pub(crate) fn place(number: u16) -> [usize; 3] {
    let gather = |bits: u16| {
        bits & 1 | bits >> 2 & 0b10 | bits >> 4 & 0b100 | bits >> 6 & 0b1000 | bits >> 8 & 0b1_0000
    };
    [gather(number), gather(number >> 1), gather(number >> 2)].map(usize::from)
}

/// The number of a cell within its brick. The inverse of [`place`].
pub(crate) fn number(place: [usize; 3]) -> u16 {
    let spread = |index: usize| (0..5).fold(0, |bits, bit| bits | (index >> bit & 1) << (3 * bit));
    (spread(place[0]) | spread(place[1]) << 1 | spread(place[2]) << 2) as u16
}

/// The bricks of a lattice, in Morton order.
pub(crate) struct Bricks {
    /// Cells along an edge: 2, 4, 8, 16 or 32.
    pub(crate) edge: usize,
    /// The coordinates of the lattice's points along x, y and z.
    pub(crate) axes: [Vec<f32>; 3],
    /// Where each brick is, in units of bricks.
    pub(crate) places: Vec<[u32; 3]>,
    /// The bricks around each one by [`direction`], or [`NONE`].
    pub(crate) neighbours: Vec<[u32; 27]>,
    /// The place of each cell of a brick, in Morton order.
    cells: Vec<At>,
    /// The sides of the lattice that each brick touches: bit `2 axis` for the low one, `2 axis + 1` for the
    /// high one.
    sides: Vec<u8>,
}

/// Where a cell is in its brick.
#[derive(Clone, Copy, Debug)]
pub(crate) struct At {
    /// Its low corner in a table of the brick's points: at most 33^3.
    table: u16,
    /// Its index along x, y and z.
    place: [u8; 3],
    /// The axes along which it is the first, a bit each.
    lows: u8,
    /// The sides of a whole brick that it touches, as in [`Bricks::sides`].
    sides: u8,
}

impl At {
    /// The place of its low corner in a table.
    #[inline(always)]
    pub(crate) fn in_table(self) -> usize {
        usize::from(self.table)
    }

    /// The axes along which it is the first, a bit each.
    #[inline(always)]
    pub(crate) fn lows(self) -> u8 {
        self.lows
    }

    /// Its index along x, y and z.
    #[inline(always)]
    pub(crate) fn place(self) -> [usize; 3] {
        self.place.map(usize::from)
    }
}

impl Bricks {
    /// The bricks in these places, which are in Morton order.
    pub(crate) fn new(
        edge: usize,
        axes: [Vec<f32>; 3],
        places: Vec<[u32; 3]>,
        neighbours: Vec<[u32; 27]>,
    ) -> Self {
        let stride = edge + 1;
        let at = |number: usize| {
            let [x, y, z] = place(number as u16);
            let table = (x + stride * (y + stride * z)) as u16;
            let lows = u8::from(x == 0) | u8::from(y == 0) << 1 | u8::from(z == 0) << 2;
            let sides = touched([x, y, z], [edge; 3]);
            At { table, place: [x, y, z].map(|index| index as u8), lows, sides }
        };
        let cells = (0..edge.pow(3)).map(at).collect();
        let ends = axes.each_ref().map(|axis| axis.len() - 1);
        let sides_of = |place: &[u32; 3]| {
            (0..3).fold(0, |sides, axis| {
                let is_last = (place[axis] as usize + 1) * edge >= ends[axis];
                sides | u8::from(place[axis] == 0) << (2 * axis) | u8::from(is_last) << (2 * axis + 1)
            })
        };
        let sides = places.iter().map(sides_of).collect();
        Self { edge, axes, places, neighbours, cells, sides }
    }

    /// The number of bricks.
    pub(crate) fn len(&self) -> usize {
        self.places.len()
    }

    /// The number of bricks that a thread takes at a time.
    pub(crate) fn group(&self) -> usize {
        (CELLS_AT_A_TIME / self.edge.pow(3)).max(1)
    }

    /// Points along an edge: the stride of rows in a table of a brick's points (x fastest, then y, then z).
    pub(crate) fn stride(&self) -> usize {
        self.edge + 1
    }

    /// Points in a table.
    pub(crate) fn table_len(&self) -> usize {
        self.stride().pow(3)
    }

    /// The place of the first of each eight cells in Morton order.
    pub(crate) fn octets(&self) -> impl Iterator<Item = At> {
        self.cells.iter().step_by(8).copied()
    }

    /// Where each cell is, by its number. Loops that write hold this list; they would read its place anew for
    /// each cell.
    pub(crate) fn cells(&self) -> &[At] {
        &self.cells
    }

    /// Where a cell is.
    #[inline(always)]
    pub(crate) fn at(&self, number: u16) -> At {
        self.cells[usize::from(number)]
    }

    /// The first cell of a brick.
    pub(crate) fn origin(&self, brick: usize) -> [usize; 3] {
        self.places[brick].map(|index| index as usize * self.edge)
    }

    /// The cells of a brick along x, y and z: fewer than its edge where the lattice ends.
    pub(crate) fn extent(&self, brick: usize) -> [usize; 3] {
        let origin = self.origin(brick);
        [0, 1, 2].map(|axis| self.edge.min(self.axes[axis].len() - 1 - origin[axis]))
    }

    /// The sides of the lattice that a brick touches: bit `2 axis` for the low one, `2 axis + 1` for the high
    /// one.
    #[inline(always)]
    pub(crate) fn sides(&self, brick: usize) -> u8 {
        self.sides[brick]
    }
}

/// The sides of a box of this extent that a cell touches.
fn touched(place: [usize; 3], extent: [usize; 3]) -> u8 {
    (0..3).fold(0, |mask, axis| {
        let (low, high) = (place[axis] == 0, place[axis] + 1 == extent[axis]);
        mask | u8::from(low) << (2 * axis) | u8::from(high) << (2 * axis + 1)
    })
}

/// The sides of the lattice that the cells of a brick touch.
#[derive(Clone, Copy)]
pub(crate) struct BrickSides {
    /// Those of the brick.
    sides: u8,
    /// The brick's cells, if the lattice ends before the brick does.
    cut: Option<[usize; 3]>,
}

impl BrickSides {
    #[inline]
    pub(crate) fn new(bricks: &Bricks, brick: usize) -> Self {
        let sides = bricks.sides(brick);
        if sides == 0 {
            return Self { sides, cut: None };
        }
        let extent = bricks.extent(brick);
        Self { sides, cut: (extent != [bricks.edge; 3]).then_some(extent) }
    }

    /// The sides that a cell touches, as in [`Bricks::sides`].
    #[inline(always)]
    pub(crate) fn of(self, at: At) -> u8 {
        self.sides & self.cut.map_or(at.sides, |extent| touched(at.place(), extent))
    }
}

/// The closed box of the cells from `first` to before `end` (along each axis; no further than the lattice).
pub(crate) fn box_of(axes: &[Vec<f32>; 3], first: [usize; 3], end: [usize; 3]) -> Box3 {
    let last = |axis: usize| end[axis].min(axes[axis].len() - 1);
    Box3 {
        low: [0, 1, 2].map(|axis| axes[axis][first[axis]]),
        high: [0, 1, 2].map(|axis| axes[axis][last(axis)]),
    }
}

/// Divides a slice among groups of bricks; the part of brick `b` is from `starts[b]` to `starts[b + 1]`,
/// times `width`.
pub(crate) fn split<'a, T>(
    mut slice: &'a mut [T],
    starts: &[usize],
    group: usize,
    width: usize,
) -> Vec<&'a mut [T]> {
    let bricks = starts.len() - 1;
    let part = |first: usize| {
        let length = width * (starts[bricks.min(first + group)] - starts[first]);
        let (part, rest) = std::mem::take(&mut slice).split_at_mut(length);
        slice = rest;
        part
    };
    (0..bricks).step_by(group).map(part).collect()
}

/// The prefix sums of the numbers: the sum before each, then the sum of all.
pub(crate) fn starts(counts: impl ExactSizeIterator<Item = usize>) -> Vec<usize> {
    let mut starts = Vec::with_capacity(counts.len() + 1);
    let mut sum = 0;
    starts.push(sum);
    for count in counts {
        sum += count;
        starts.push(sum);
    }
    starts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_places() {
        for cell in 0..1 << 15 {
            assert_eq!(number(place(cell)), cell);
        }
        assert_eq!(place(1), [1, 0, 0]);
        assert_eq!(place(0b110), [0, 1, 1]);
        assert_eq!(number([31; 3]), (1 << 15) - 1);
    }

    #[test]
    fn a_brick_at_the_end_is_cut() {
        let axis = |cells: u8| (0..=cells).map(f32::from).collect::<Vec<f32>>();
        let places = vec![[0, 0, 0], [1, 0, 0]];
        let bricks = Bricks::new(4, [axis(7), axis(4), axis(2)], places, vec![[NONE; 27]; 2]);
        assert_eq!((bricks.extent(0), bricks.extent(1)), ([4, 4, 2], [3, 4, 2]));
        assert_eq!((bricks.sides(0), bricks.sides(1)), (0b11_1101, 0b11_1110));
        let sides_of = |brick: usize, place| BrickSides::new(&bricks, brick).of(bricks.at(number(place)));
        assert_eq!((sides_of(1, [2, 1, 0]), sides_of(1, [3, 1, 1])), (0b01_0010, 0b10_0000));
        assert_eq!((sides_of(0, [3, 1, 0]), sides_of(0, [0, 3, 1])), (0b01_0000, 0b10_1001));
        let whole = Bricks::new(4, [axis(8), axis(4), axis(4)], vec![[1, 0, 0]], vec![[NONE; 27]]);
        assert_eq!(BrickSides::new(&whole, 0).of(whole.at(number([3, 0, 1]))), 0b00_0110);
        assert_eq!(
            box_of(&bricks.axes, [4, 0, 0], [8; 3]),
            Box3 { low: [4.0, 0.0, 0.0], high: [7.0, 4.0, 2.0] }
        );
        for cell in 0..64 {
            let ([x, y, z], at) = (place(cell), bricks.at(cell));
            assert_eq!((at.place(), at.in_table()), ([x, y, z], x + 5 * (y + 5 * z)));
        }
    }

    #[test]
    fn slices_are_split_by_groups() {
        let mut numbers = [1, 2, 3, 4, 5, 6];
        let starts = starts([1, 0, 2].into_iter());
        assert_eq!(starts, [0, 1, 1, 3]);
        let parts = split(&mut numbers, &starts, 2, 2);
        assert_eq!(parts, [&[1, 2][..], &[3, 4, 5, 6]]);
    }
}
