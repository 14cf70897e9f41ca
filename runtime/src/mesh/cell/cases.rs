//! The numbers of sheets, quads and pinched faces of cells without flipped faces, inside the lattice.

use super::{DEFAULT, Sheets};

/// What loops over cells ask of cases without flipped faces, inside the lattice; of one, or of up to eight
/// cells together: a byte for each number, so that one addition adds all of them.
#[derive(Clone, Copy, Default)]
pub(crate) struct CellCases(u32);

impl CellCases {
    const NONE: Self = Self(0);

    const fn of_one(signs: usize) -> Self {
        let differs =
            (signs ^ signs >> 1) & 1 | ((signs ^ signs >> 2) & 1) << 1 | ((signs ^ signs >> 4) & 1) << 2;
        let Sheets { count, pinched, .. } = DEFAULT[signs];
        let is_pinched_low = pinched & 0b01_0101 != 0;
        Self(
            count as u32
                | differs.count_ones() << 8
                | (is_pinched_low as u32) << 16
                | ((count != 0) as u32) << 24,
        )
    }

    /// These and another cell.
    #[inline(always)]
    pub(crate) fn and(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }

    /// How many sheets there are. None if the surface does not cross the cell.
    #[inline(always)]
    pub(crate) fn sheets(self) -> u32 {
        self.0 & 0xFF
    }

    /// How many edges at low corners are crossed: each has a quad.
    #[inline(always)]
    pub(crate) fn quads(self) -> usize {
        (self.0 >> 8 & 0xFF) as usize
    }

    /// How many cells have a pinched low face.
    #[inline(always)]
    pub(crate) fn pinched_low(self) -> u32 {
        self.0 >> 16 & 0xFF
    }

    /// How many cells the surface crosses.
    #[inline(always)]
    pub(crate) fn crossed(self) -> usize {
        (self.0 >> 24) as usize
    }
}

static CASES: [CellCases; 256] = {
    let mut cases = [CellCases::NONE; 256];
    let mut signs = 0;
    while signs < 256 {
        cases[signs] = CellCases::of_one(signs);
        signs += 1;
    }
    cases
};

/// The case of these signs.
#[inline(always)]
pub(crate) fn case(signs: u8) -> CellCases {
    CASES[usize::from(signs)]
}

/// The crossed edges at the low corner of a cell, as numbers of turns: twice the axis, and one more if the
/// edge's high end is inside. Four, of which this many count.
#[inline(always)]
pub(crate) fn low_turns(signs: u8) -> ([u8; 4], usize) {
    static TURNS: [[u8; 4]; 256] = {
        let mut turns = [[0; 4]; 256];
        let mut signs = 0;
        while signs < 256 {
            let (mut count, mut axis) = (0, 0);
            while axis < 3 {
                let end = signs >> (1 << axis) & 1;
                if (signs ^ end) & 1 == 1 {
                    turns[signs][count] = (2 * axis + end) as u8;
                    count += 1;
                }
                axis += 1;
            }
            signs += 1;
        }
        turns
    };
    (TURNS[usize::from(signs)], case(signs).quads())
}
