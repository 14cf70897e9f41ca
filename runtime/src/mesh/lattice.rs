//! The lattice: the points at which a mesh evaluates the field.
//!
//! A coordinate is a function of a *global* integer index alone: `anchor + spacing * index` in f64 (a
//! product, then a sum, not fused), rounded once to f32. Every brick and every thread computes the same bits
//! for a corner, so a corner that several cells share is one point and is evaluated once. A lattice that has
//! [grown](Lattice::grown) counts from its old anchor, so its old corners keep their bits.

use crate::error::{Classified, ErrorKind};
use jbt_ir::limits::{MAX_LATTICE_POINTS, MAX_RESOLUTION};
use thiserror::Error;

/// The part of a cell that [`Lattice::covering`] may leave uncovered, so that a region of 1.3 at a spacing of
/// 0.13 has ten cells instead of, by the rounding of the quotient, eleven.
const UNCOVERED: f64 = 1e-6;

/// Why a lattice cannot be.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LatticeError {
    /// An origin, a region or a spacing is infinite or NaN, or becomes infinite in f32.
    #[error("the lattice reaches a coordinate that is not a finite number")]
    NotFinite,
    /// The spacing is zero or negative.
    #[error("the spacing of a lattice must be greater than zero, and it is {spacing}")]
    Spacing {
        /// The spacing that was asked for.
        spacing: f64,
    },
    /// The region is empty: its low corner is not below its high corner.
    #[error("the region is empty along {}: it goes from {low} to {high}", axis_name(*.axis))]
    EmptyRegion {
        /// 0, 1 or 2.
        axis: usize,
        /// Where the region begins.
        low: f64,
        /// Where it ends.
        high: f64,
    },
    /// No cells, or more than [`MAX_RESOLUTION`], along an axis.
    #[error("{cells} cells along {}; there must be from 1 to {MAX_RESOLUTION}", axis_name(*.axis))]
    Cells {
        /// 0, 1 or 2.
        axis: usize,
        /// The number that was asked for; `usize::MAX` stands for more than that.
        cells: usize,
    },
    /// More points than [`MAX_LATTICE_POINTS`], where all are to be visited.
    #[error("{} x {} x {} cells have more than {MAX_LATTICE_POINTS} corners", cells[0], cells[1], cells[2])]
    TooManyPoints {
        /// Cells along x, y and z.
        cells: [usize; 3],
    },
    /// Two neighbouring corners would have the same f32 coordinate.
    #[error("the spacing {spacing} is finer than f32 can tell apart near {coordinate} along {}", axis_name(*.axis))]
    TooFine {
        /// 0, 1 or 2.
        axis: usize,
        /// The spacing that was asked for.
        spacing: f64,
        /// The coordinate that two corners share.
        coordinate: f32,
    },
}

impl Classified for LatticeError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotFinite | Self::Spacing { .. } | Self::EmptyRegion { .. } => ErrorKind::Argument,
            Self::Cells { .. } | Self::TooManyPoints { .. } | Self::TooFine { .. } => ErrorKind::Limit,
        }
    }
}

fn axis_name(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}

/// A box of equal cubic cells, `cells[0] x cells[1] x cells[2]`, with its first corner at `origin`.
///
/// A value of this type has at most [`MAX_RESOLUTION`] cells along an axis, and strictly increasing finite
/// f32 coordinates.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Lattice {
    origin: [f64; 3],
    spacing: f64,
    cells: [usize; 3],
    /// The indices of the first corner, counted from the origin: not 0 only if the lattice has grown.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "is_anchor"))]
    first: [i64; 3],
}

/// Whether the first corner is the anchor.
#[cfg(feature = "serde")]
fn is_anchor(first: &[i64; 3]) -> bool {
    *first == [0; 3]
}

/// The cells by whose multiples a lattice grows: the largest bricks keep their places.
const GROWTH: i64 = super::error::MAX_BRICK as i64;

impl Lattice {
    /// A lattice of `cells` cells of edge `spacing`, its first corner at `origin`.
    ///
    /// # Errors
    /// See [`LatticeError`]; every limit is checked here, before anything is allocated.
    pub fn new(origin: [f64; 3], spacing: f64, cells: [usize; 3]) -> Result<Self, LatticeError> {
        if !spacing.is_finite() || origin.iter().any(|c| !c.is_finite()) {
            return Err(LatticeError::NotFinite);
        }
        if spacing <= 0.0 {
            return Err(LatticeError::Spacing { spacing });
        }
        Lattice { origin, spacing, cells, first: [0; 3] }.checked()
    }

    /// The lattice of the given spacing that begins at `low` and reaches `high` (or passes it by less than a
    /// cell).
    ///
    /// # Errors
    /// As [`Lattice::new`], and [`LatticeError::EmptyRegion`].
    pub fn covering(low: [f64; 3], high: [f64; 3], spacing: f64) -> Result<Self, LatticeError> {
        check_region(low, high)?;
        if spacing.is_nan() || spacing <= 0.0 {
            return Err(LatticeError::Spacing { spacing });
        }
        // The cast saturates, so that a quotient beyond any limit stays beyond it.
        let cells = [0, 1, 2].map(|a| (((high[a] - low[a]) / spacing - UNCOVERED).ceil() as usize).max(1));
        Lattice::new(low, spacing, cells)
    }

    /// The lattice with `resolution` cells along the longest side of a region, and cubic cells.
    ///
    /// # Errors
    /// As [`Lattice::covering`].
    pub fn with_resolution(low: [f64; 3], high: [f64; 3], resolution: usize) -> Result<Self, LatticeError> {
        check_region(low, high)?;
        let length = |axis: usize| high[axis] - low[axis];
        let longest = [1, 2].into_iter().fold(0, |best, a| if length(a) > length(best) { a } else { best });
        if resolution == 0 || resolution > MAX_RESOLUTION {
            return Err(LatticeError::Cells { axis: longest, cells: resolution });
        }
        Lattice::covering(low, high, length(longest) / resolution as f64)
    }

    /// The same lattice with more cells on any side, so many that it covers a box: its old corners are among
    /// the new ones, with the same coordinates. It grows by multiples of [`MAX_BRICK`](super::MAX_BRICK)
    /// cells, and never shrinks.
    ///
    /// # Errors
    /// As [`Lattice::new`], and [`LatticeError::EmptyRegion`].
    pub fn grown(&self, low: [f64; 3], high: [f64; 3]) -> Result<Self, LatticeError> {
        check_region(low, high)?;
        let mut grown = self.clone();
        for axis in 0..3 {
            let (first, end) = (self.first[axis], self.first[axis] + self.cells[axis] as i64);
            // The casts saturate at numbers that are beyond any limit.
            let place = |side: f64| (side - self.origin[axis]) / self.spacing;
            let below = first.saturating_sub((place(low[axis]) + UNCOVERED).floor() as i64).max(0);
            let above = ((place(high[axis]) - UNCOVERED).ceil() as i64).saturating_sub(end).max(0);
            let [below, above] =
                [below, above].map(|cells| cells.saturating_add(GROWTH - 1) / GROWTH * GROWTH);
            let cells = (self.cells[axis] as i64).saturating_add(below).saturating_add(above);
            if cells > MAX_RESOLUTION as i64 {
                return Err(LatticeError::Cells { axis, cells: cells as usize });
            }
            (grown.first[axis], grown.cells[axis]) = (first - below, cells as usize);
        }
        if grown == *self { Ok(grown) } else { grown.checked() }
    }

    /// Some cells of this lattice: its corners have the coordinates that they have here, to the bit.
    ///
    /// # Errors
    /// Cells that are not there, or none: [`LatticeError::Cells`].
    pub fn part(&self, first: [usize; 3], cells: [usize; 3]) -> Result<Self, LatticeError> {
        let mut part = self.clone();
        for axis in 0..3 {
            let end = first[axis].checked_add(cells[axis]);
            if cells[axis] == 0 || end.is_none_or(|end| end > self.cells[axis]) {
                return Err(LatticeError::Cells { axis, cells: cells[axis] });
            }
            part.first[axis] += first[axis] as i64;
            part.cells[axis] = cells[axis];
        }
        Ok(part)
    }

    /// The same lattice, if it keeps to the limits.
    fn checked(self) -> Result<Self, LatticeError> {
        for (axis, &cells) in self.cells.iter().enumerate() {
            if cells == 0 || cells > MAX_RESOLUTION {
                return Err(LatticeError::Cells { axis, cells });
            }
        }
        (0..3).try_for_each(|axis| self.check_axis(axis))?;
        Ok(self)
    }

    /// The first corner.
    pub fn origin(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.place(axis, 0))
    }

    /// The indices of the first corner, counted from the corner that was the first one before the lattice
    /// [grew](Self::grown).
    pub fn first(&self) -> [i64; 3] {
        self.first
    }

    /// The edge of a cell.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Cells along x, y and z.
    pub fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// Corners along x, y and z: one more than cells.
    pub fn points(&self) -> [usize; 3] {
        self.cells.map(|cells| cells + 1)
    }

    /// All corners: up to about 2^60.
    pub fn point_count(&self) -> u64 {
        self.points().iter().map(|&points| points as u64).product()
    }

    /// Whether all corners may be visited.
    ///
    /// # Errors
    /// [`LatticeError::TooManyPoints`] if there are more than [`MAX_LATTICE_POINTS`].
    pub fn check_points(&self) -> Result<(), LatticeError> {
        let few = self.point_count() <= MAX_LATTICE_POINTS as u64;
        if few { Ok(()) } else { Err(LatticeError::TooManyPoints { cells: self.cells }) }
    }

    /// The coordinate of the corners with this index along an axis (0, 1 or 2).
    pub fn coordinate(&self, axis: usize, index: usize) -> f32 {
        self.place(axis, index) as f32
    }

    /// As [`coordinate`](Self::coordinate), before it is rounded.
    fn place(&self, axis: usize, index: usize) -> f64 {
        // Whole numbers far below 2^53.
        self.origin[axis] + self.spacing * (self.first[axis] + index as i64) as f64
    }

    /// The coordinates along each axis.
    pub(crate) fn axes(&self) -> [Vec<f32>; 3] {
        [0, 1, 2].map(|axis| (0..=self.cells[axis]).map(|i| self.coordinate(axis, i)).collect())
    }

    fn check_axis(&self, axis: usize) -> Result<(), LatticeError> {
        let mut last = self.coordinate(axis, 0);
        if !last.is_finite() || !self.coordinate(axis, self.cells[axis]).is_finite() {
            return Err(LatticeError::NotFinite);
        }
        // Neighbours at least two steps of f32 apart, by the widest steps, still differ after rounding.
        let farthest = last.abs().max(self.coordinate(axis, self.cells[axis]).abs());
        if self.spacing >= 2.0 * f64::from(farthest.next_up() - farthest) {
            return Ok(());
        }
        for index in 1..=self.cells[axis] {
            let coordinate = self.coordinate(axis, index);
            if coordinate <= last {
                return Err(LatticeError::TooFine { axis, spacing: self.spacing, coordinate });
            }
            last = coordinate;
        }
        Ok(())
    }
}

fn check_region(low: [f64; 3], high: [f64; 3]) -> Result<(), LatticeError> {
    if low.iter().chain(&high).any(|c| !c.is_finite()) {
        return Err(LatticeError::NotFinite);
    }
    match (0..3).find(|&axis| low[axis] >= high[axis]) {
        Some(axis) => Err(LatticeError::EmptyRegion { axis, low: low[axis], high: high[axis] }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covers_its_region() {
        let lattice = Lattice::covering([-1.0; 3], [0.3, 0.31, 1.0], 0.13).unwrap();
        assert_eq!(lattice.cells(), [10, 11, 16]);
        assert_eq!(lattice.points(), [11, 12, 17]);
        assert_eq!(lattice.point_count(), 11 * 12 * 17);
        assert!(lattice.check_points().is_ok());
        assert_eq!(lattice.coordinate(0, 0), -1.0);
        assert_eq!(Lattice::with_resolution([0.0; 3], [1.0, 3.0, 2.0], 30).unwrap().cells(), [10, 30, 20]);
    }

    #[test]
    fn what_grows_keeps_its_corners() {
        let lattice = Lattice::covering([-0.1; 3], [0.9; 3], 0.07).unwrap();
        assert_eq!(lattice.cells(), [15; 3]);
        let grown = lattice.grown([-0.2, 0.0, 0.0], [0.5, 0.95, 4.0]).unwrap();
        assert_eq!((grown.first(), grown.cells()), ([-32, 0, 0], [47, 15, 79]));
        for index in 0..=15 {
            assert_eq!(grown.coordinate(0, index + 32).to_bits(), lattice.coordinate(0, index).to_bits());
        }
        assert_eq!(lattice.grown([0.0; 3], [0.5; 3]), Ok(lattice.clone()));
        assert!(matches!(lattice.grown([0.0; 3], [1e9; 3]), Err(LatticeError::Cells { axis: 0, .. })));
        assert!(matches!(lattice.grown([-1e300; 3], [1.0; 3]), Err(LatticeError::Cells { axis: 0, .. })));
    }

    #[test]
    fn limits_hold_at_their_value_and_one_past_it() {
        let cells = |cells| Lattice::new([0.0; 3], 0.5, cells).map(|lattice| lattice.point_count());
        assert_eq!(cells([4096; 3]), Ok(4097_u64.pow(3)));
        let checked = |cells| Lattice::new([0.0; 3], 0.5, cells).and_then(|lattice| lattice.check_points());
        assert_eq!(checked([1023; 3]), Ok(()));
        assert_eq!(
            checked([1024, 1023, 1023]),
            Err(LatticeError::TooManyPoints { cells: [1024, 1023, 1023] })
        );
        assert!(cells([MAX_RESOLUTION, 1, 1]).is_ok());
        let error = LatticeError::Cells { axis: 1, cells: MAX_RESOLUTION + 1 };
        assert_eq!(cells([1, MAX_RESOLUTION + 1, 1]), Err(error));
        assert_eq!(cells([1, 1, usize::MAX]), Err(LatticeError::Cells { axis: 2, cells: usize::MAX }));
        assert_eq!(cells([1, 1, 0]), Err(LatticeError::Cells { axis: 2, cells: 0 }));
        assert_eq!(cells([MAX_RESOLUTION; 3]), Ok((MAX_RESOLUTION as u64 + 1).pow(3)));
    }

    #[test]
    fn refuses_what_f32_cannot_hold() {
        let new = |origin: f64, spacing| Lattice::new([origin, 0.0, 0.0], spacing, [4; 3]);
        assert_eq!(new(f64::NAN, 1.0), Err(LatticeError::NotFinite));
        assert_eq!(new(0.0, f64::INFINITY), Err(LatticeError::NotFinite));
        assert_eq!(new(0.0, 1e38), Err(LatticeError::NotFinite));
        assert_eq!(new(0.0, 0.0), Err(LatticeError::Spacing { spacing: 0.0 }));
        assert_eq!(new(0.0, -1.0), Err(LatticeError::Spacing { spacing: -1.0 }));
        assert!(matches!(new(1e9, 1.0), Err(LatticeError::TooFine { axis: 0, .. })));
        let covering = |low, high, spacing| Lattice::covering([low; 3], [high; 3], spacing);
        assert!(matches!(covering(1.0, 1.0, 0.1), Err(LatticeError::EmptyRegion { axis: 0, .. })));
        assert!(matches!(covering(0.0, 1.0, f64::NAN), Err(LatticeError::Spacing { .. })));
        assert!(matches!(covering(0.0, 1.0, 1e-300), Err(LatticeError::Cells { axis: 0, .. })));
        assert!(matches!(covering(f64::NEG_INFINITY, 1.0, 1.0), Err(LatticeError::NotFinite)));
    }
}
