//! Rectangles of a plane, and the points in them at which the field is asked.

use jbt_ir::limits::MAX_PIXELS;
use thiserror::Error;

use crate::error::{Classified, ErrorKind};
use crate::mesh::{Lattice, LatticeError};
use crate::polygonize::Fineness;

/// A rectangle in coordinates of a plane, with u to the right and v upwards. Its corners are finite and in
/// order.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Rectangle {
    low: [f64; 2],
    high: [f64; 2],
}

/// Why there is no such rectangle, or no lattice over it.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RectangleError {
    /// A corner is not finite.
    #[error("the corners of a rectangle must be finite")]
    NotFinite,
    /// It is empty, or its corners are not in order.
    #[error(
        "every number of the first corner must be below that of the second: from {low:?} to {high:?} is no rectangle"
    )]
    Order {
        /// What was given.
        low: [f64; 2],
        /// What was given.
        high: [f64; 2],
    },
}

impl Classified for RectangleError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotFinite | Self::Order { .. } => ErrorKind::Argument,
        }
    }
}

impl Rectangle {
    /// The rectangle between two corners.
    ///
    /// # Errors
    /// Corners that are not finite, or not in order along both axes.
    pub fn new(low: [f64; 2], high: [f64; 2]) -> Result<Self, RectangleError> {
        if low.iter().chain(&high).any(|side| !side.is_finite())
            || (0..2).any(|axis| !(high[axis] - low[axis]).is_finite())
        {
            return Err(RectangleError::NotFinite);
        }
        if (0..2).any(|axis| low[axis] >= high[axis]) {
            return Err(RectangleError::Order { low, high });
        }
        Ok(Self { low, high })
    }

    /// The rectangle somewhere else. A sum with 0 would lose the sign of a zero.
    pub(super) fn moved(&self, by: [f64; 2]) -> Result<Self, RectangleError> {
        let moved = |corner: [f64; 2]| [0, 1].map(|axis| corner[axis] + by[axis]);
        if by == [0.0; 2] { Ok(*self) } else { Self::new(moved(self.low), moved(self.high)) }
    }

    /// The smallest corner.
    #[must_use]
    pub fn low(&self) -> [f64; 2] {
        self.low
    }

    /// The largest corner.
    #[must_use]
    pub fn high(&self) -> [f64; 2] {
        self.high
    }

    /// Its width and height.
    #[must_use]
    pub fn sides(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.high[axis] - self.low[axis])
    }
}

/// Coordinates of points along u and v: a rectangle of square cells, its first corner that of the rectangle
/// that was asked for. It reaches the last one, or passes it by less than a cell.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Grid {
    /// The coordinates along u and v.
    pub(super) axes: [Vec<f32>; 2],
    /// The edge of a cell.
    pub(super) spacing: f64,
}

/// Square cells in a plane: the lattice of a contour, in coordinates from the [origin](super::Slicer::origin)
/// of its slicer.
#[derive(Clone, PartialEq, Debug)]
pub struct ContourLattice(Lattice);

impl ContourLattice {
    /// Cells over a rectangle: a lattice of one layer.
    pub(super) fn covering(rectangle: &Rectangle, fineness: Fineness) -> Result<Self, LatticeError> {
        let sides = rectangle.sides();
        let longest = usize::from(sides[1] > sides[0]);
        let spacing = match fineness {
            Fineness::Cell(cell) if cell > 0.0 => cell,
            Fineness::Cell(spacing) => return Err(LatticeError::Spacing { spacing }),
            Fineness::Resolution(0) => return Err(LatticeError::Cells { axis: longest, cells: 0 }),
            Fineness::Resolution(cells) => sides[longest] / cells as f64,
        };
        let ([low_u, low_v], [high_u, high_v]) = (rectangle.low, rectangle.high);
        Lattice::covering([low_u, low_v, 0.0], [high_u, high_v, spacing], spacing).map(Self)
    }

    /// The same cells, and more of them on any side, so that they cover a rectangle: see [`Lattice::grown`].
    pub(super) fn grown(&self, rectangle: &Rectangle) -> Result<Self, LatticeError> {
        let ([low_u, low_v], [high_u, high_v]) = (rectangle.low, rectangle.high);
        self.0.grown([low_u, low_v, 0.0], [high_u, high_v, self.0.spacing()]).map(Self)
    }

    /// How many columns and rows of cells were added below when this lattice grew from an earlier one.
    pub(super) fn growth(&self, from: &Self) -> [u32; 2] {
        [0, 1].map(|axis| (from.0.first()[axis] - self.0.first()[axis]) as u32)
    }

    /// The edge of a cell.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.0.spacing()
    }

    /// Cells along u and v.
    #[must_use]
    pub fn cells(&self) -> [usize; 2] {
        let [u, v, _] = self.0.cells();
        [u, v]
    }
}

impl Grid {
    /// The corners of cells.
    pub(super) fn corners(lattice: &ContourLattice) -> Self {
        let [u, v, _] = lattice.0.axes();
        Self { axes: [u, v], spacing: lattice.spacing() }
    }

    /// Pixels that fill a rectangle, with `samples` x `samples` points each, in the middles of its equal
    /// parts; `None` if there are too many.
    pub(super) fn pixels(
        rectangle: &Rectangle,
        fineness: Fineness,
        samples: usize,
    ) -> Result<Option<Self>, LatticeError> {
        let ContourLattice(lattice) = ContourLattice::covering(rectangle, fineness)?;
        let [width, height, _] = lattice.cells();
        let points = width.checked_mul(height).and_then(|pixels| pixels.checked_mul(samples * samples));
        if points.is_none_or(|points| points > MAX_PIXELS) {
            return Ok(None);
        }
        let step = lattice.spacing() / samples as f64;
        let axis = |axis: usize, pixels: usize| {
            let at = |index: usize| (lattice.origin()[axis] + step * (index as f64 + 0.5)) as f32;
            (0..pixels * samples).map(at).collect()
        };
        Ok(Some(Self { axes: [axis(0, width), axis(1, height)], spacing: step }))
    }

    /// Points along u and v.
    pub(super) fn points(&self) -> [usize; 2] {
        self.axes.each_ref().map(Vec::len)
    }

    /// The closed rectangle from a first point to a last one.
    pub(super) fn bounds(&self, first: [u32; 2], last: [u32; 2]) -> [[f32; 2]; 2] {
        [first, last].map(|point| [0, 1].map(|axis| self.axes[axis][point[axis] as usize]))
    }

    /// The points from a first one to before an end, u fastest: their coordinates along u and v.
    pub(super) fn block(&self, first: [u32; 2], end: [u32; 2]) -> [Vec<f32>; 2] {
        let side = |axis: usize| &self.axes[axis][first[axis] as usize..end[axis] as usize];
        let (us, vs) = (side(0), side(1));
        let mut u = Vec::with_capacity(us.len() * vs.len());
        let mut v = Vec::with_capacity(us.len() * vs.len());
        for &at in vs {
            u.extend_from_slice(us);
            v.resize(u.len(), at);
        }
        [u, v]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_are_in_order_and_finite() {
        assert!(Rectangle::new([0.0; 2], [1.0; 2]).is_ok());
        for (low, high) in [([0.0, 0.0], [0.0, 1.0]), ([1.0, 0.0], [0.0, 1.0])] {
            assert_eq!(Rectangle::new(low, high), Err(RectangleError::Order { low, high }));
        }
        for high in [f64::NAN, f64::INFINITY] {
            assert_eq!(Rectangle::new([0.0; 2], [1.0, high]), Err(RectangleError::NotFinite));
        }
        assert_eq!(Rectangle::new([f64::MIN; 2], [f64::MAX; 2]), Err(RectangleError::NotFinite));
    }

    #[test]
    fn corners_and_pixels() {
        let rectangle = Rectangle::new([0.0, 0.0], [2.0, 1.0]).unwrap();
        let corners = Grid::corners(&ContourLattice::covering(&rectangle, Fineness::Resolution(4)).unwrap());
        assert_eq!(corners.axes, [vec![0.0, 0.5, 1.0, 1.5, 2.0], vec![0.0, 0.5, 1.0]]);
        let pixels = Grid::pixels(&rectangle, Fineness::Resolution(2), 2).unwrap().unwrap();
        assert_eq!(pixels.axes, [vec![0.25, 0.75, 1.25, 1.75], vec![0.25, 0.75]]);
        let [u, v] = pixels.block([1, 0], [3, 2]);
        assert_eq!((u, v), (vec![0.75, 1.25, 0.75, 1.25], vec![0.25, 0.25, 0.75, 0.75]));
    }

    #[test]
    fn limits_hold_at_their_value_and_one_past_it() {
        let square = Rectangle::new([0.0; 2], [1.0; 2]).unwrap();
        let edge = MAX_PIXELS.isqrt();
        assert_eq!(edge * edge, MAX_PIXELS);
        let fits = |cells: usize, samples| {
            Grid::pixels(&square, Fineness::Resolution(cells), samples).unwrap().is_some()
        };
        assert!(fits(edge / 4, 4) && !fits(edge / 4 + 1, 4));
        for fineness in [Fineness::Resolution(0), Fineness::Resolution((1 << 20) + 1)] {
            let made = ContourLattice::covering(&square, fineness);
            assert!(matches!(made, Err(LatticeError::Cells { .. })));
        }
        for cell in [0.0, -1.0, f64::NAN] {
            let made = ContourLattice::covering(&square, Fineness::Cell(cell));
            assert!(matches!(made, Err(LatticeError::Spacing { .. })), "{made:?}");
        }
    }
}
