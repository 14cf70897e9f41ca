//! The lattice of both modes: the square from -2 to 2, 256 cells a side, 257 points.
//!
//! Points and squares are integers; their coordinates are multiples of 1/64, which f32 and f64 hold exactly.

/// Cells along a side of the whole square.
pub const CELLS: u32 = 256;
/// Lattice points along a side.
pub const POINTS: u32 = CELLS + 1;
/// The smallest coordinate along both axes.
const ORIGIN: f64 = -2.0;
/// The side of a cell.
pub const SPACING: f64 = 4.0 / CELLS as f64;

/// A cell or a point by its column and row; a cell has the number of its lowest corner.
pub type Place = [u32; 2];

/// The coordinate of the points of a column or row.
pub fn coordinate(index: u32) -> f64 {
    ORIGIN + SPACING * f64::from(index)
}

/// A rectangle of cells.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Block {
    /// Its lowest corner.
    pub low: Place,
    /// Cells along its sides.
    pub sides: [u32; 2],
}

impl Block {
    /// All cells.
    pub const WHOLE: Self = Self { low: [0, 0], sides: [CELLS; 2] };

    /// A single cell.
    pub const fn cell(low: Place) -> Self {
        Self { low, sides: [1; 2] }
    }

    /// Its four corners, around it.
    pub fn corners(&self) -> [Place; 4] {
        let ([x, y], [width, height]) = (self.low, self.sides);
        [[x, y], [x, y + height], [x + width, y + height], [x + width, y]]
    }

    /// Its four quarters, each at the corner of the same number.
    pub fn quarters(&self) -> [Self; 4] {
        let sides = self.sides.map(|side| side / 2);
        Self { sides, ..*self }.corners().map(|low| Self { low, sides })
    }

    /// Its halves along an axis: below, above.
    pub fn halves(&self, axis: usize) -> [Self; 2] {
        let mut below = *self;
        below.sides[axis] /= 2;
        let mut above = below;
        above.low[axis] += below.sides[axis];
        [below, above]
    }

    /// The coordinates of its sides along an axis.
    pub fn extent(&self, axis: usize) -> [f64; 2] {
        [self.low[axis], self.low[axis] + self.sides[axis]].map(coordinate)
    }
}

/// Whether the contour passes between some of a block's corners.
pub fn is_crossed(block: &Block, inside: impl FnMut(Place) -> bool) -> bool {
    let corners = block.corners().map(inside);
    corners.contains(&true) && corners.contains(&false)
}

/// Something for each lattice point.
#[derive(Clone, Debug)]
pub struct Lattice<T>(Vec<T>);

impl<T: Clone> Lattice<T> {
    /// The same everywhere.
    pub fn filled(value: T) -> Self {
        Self(vec![value; (POINTS * POINTS) as usize])
    }

    /// What a point has.
    pub fn at(&mut self, point: Place) -> &mut T {
        &mut self.0[(point[1] * POINTS + point[0]) as usize]
    }
}

/// All lattice points, row by row.
pub fn points() -> impl Iterator<Item = Place> {
    (0..POINTS).flat_map(|y| (0..POINTS).map(move |x| [x, y]))
}

/// All cells that the contour crosses, in order.
pub fn crossing_cells(mut inside: impl FnMut(Place) -> bool) -> Vec<Place> {
    let cells = (0..CELLS).flat_map(|x| (0..CELLS).map(move |y| [x, y]));
    cells.filter(|&cell| is_crossed(&Block::cell(cell), &mut inside)).collect()
}
