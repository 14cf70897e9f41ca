//! Flips the faces that would pinch the mesh: ambiguous ones, all four crossings of which are on one sheet in
//! both of their cells. Such a face would give an edge of the mesh four triangles. Flipping it splits the
//! sheet in both cells and joins none.

use std::collections::BTreeSet;

use super::brick::{Brick, Flips};
use super::cell::sheets;
use super::scene::{BRICK, Scene};
use super::unit::{self, Unit};

/// Flips faces in the order of the lattice and makes their bricks again. Answers how many there were: few, if
/// any.
pub(super) fn flip(scene: &Scene, units: &mut [Unit]) -> u64 {
    let mut suspects: Vec<[usize; 3]> = units.iter().flat_map(|unit| unit.suspects.iter().copied()).collect();
    if suspects.is_empty() {
        return 0;
    }
    suspects.sort_unstable_by_key(|&[x, y, z]| [z, y, x]);
    let (mut flips, mut count, mut bricks) = (Flips::new(), 0, BTreeSet::new());
    for cell in suspects {
        for axis in (0..3).filter(|&axis| cell[axis] > 0) {
            let mut below = cell;
            below[axis] -= 1;
            let both = [(cell, 2 * axis), (below, 2 * axis + 1)];
            let is_pinched = both.iter().all(|&(cell, face)| {
                let flipped = flips.get(&cell).copied().unwrap_or(0);
                sheets(signs(scene, units, cell), flipped).pinched >> face & 1 == 1
            });
            if is_pinched {
                for (cell, face) in both {
                    *flips.entry(cell).or_insert(0) |= 1 << face;
                    bricks.insert(cell.map(|index| index / BRICK));
                }
                count += 1;
            }
        }
    }
    for place in bricks {
        if let Some((unit, index)) = find(scene, units, place) {
            unit::remake(scene, &mut units[unit], index, &flips);
        }
    }
    count
}

/// Where a brick is.
fn find(scene: &Scene, units: &[Unit], place: [usize; 3]) -> Option<(usize, usize)> {
    let unit = scene.unit_index(place);
    let index = units[unit].bricks.iter().position(|brick| brick.place == place)?;
    Some((unit, index))
}

/// The corners of a cell that are inside. A brick that is not there has none.
fn signs(scene: &Scene, units: &[Unit], cell: [usize; 3]) -> u8 {
    let brick: Option<&Brick> =
        find(scene, units, cell.map(|index| index / BRICK)).map(|(unit, index)| &units[unit].bricks[index]);
    let [x, y, z] = cell.map(|index| index % BRICK);
    brick.map_or(0, |brick| brick.cells[x + BRICK * (y + BRICK * z)].signs())
}
