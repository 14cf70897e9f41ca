//! Cells of bricks by their place in the whole lattice.

use super::super::brick::{Bricks, place as number_place};
use super::super::crossing::CrossedCell;

/// Whether a cell is in a box of cells.
pub(super) fn is_in(cell: [usize; 3], [low, end]: [[usize; 3]; 2]) -> bool {
    (0..3).all(|axis| (low[axis]..end[axis]).contains(&cell[axis]))
}

/// Where a cell of a brick is in the lattice.
pub(super) fn cell_of(bricks: &Bricks, brick: usize, cell: &CrossedCell) -> [usize; 3] {
    let (origin, place) = (bricks.origin(brick), number_place(cell.number));
    [0, 1, 2].map(|axis| origin[axis] + place[axis])
}
