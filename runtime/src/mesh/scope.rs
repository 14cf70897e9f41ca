//! Which boxes of a lattice a division looks at.

use crate::touched::Touched;

/// What is looked at.
#[derive(Clone, Copy)]
pub(crate) enum DivisionScope<'a> {
    /// The whole lattice.
    Everything,
    /// Boxes that an edit has touched. Ranges are computed of bricks alone: there are few boxes on the way,
    /// and the largest have the most rows.
    Touched(&'a Touched<3>),
    /// The cells from the first corner to before the second one. Ranges are computed of boxes that are
    /// inside: of the field elsewhere nothing needs to be known.
    Cells([[usize; 3]; 2]),
}

impl DivisionScope<'_> {
    /// Whether any part of a box is looked at, by its first cell and its edge.
    pub(super) fn has(self, first: [usize; 3], size: usize) -> bool {
        match self {
            Self::Everything => true,
            Self::Touched(touched) => touched.has(first, size),
            Self::Cells([low, end]) => {
                (0..3).all(|axis| first[axis] < end[axis] && first[axis] + size > low[axis])
            }
        }
    }

    /// Whether a box of a lattice of so many cells is only on the way to smaller ones.
    pub(super) fn passes(self, first: [usize; 3], size: usize, cells: [usize; 3]) -> bool {
        match self {
            Self::Everything => false,
            Self::Touched(touched) => size > touched.edge(),
            Self::Cells([low, end]) => (0..3)
                .any(|axis| first[axis] < low[axis] || (first[axis] + size).min(cells[axis]) > end[axis]),
        }
    }
}
