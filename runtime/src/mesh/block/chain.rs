//! Whether all faces are known that decide about flips in a block.
//!
//! Flips depend on each other along chains of cells that share faces pinched, by default, in both cells (see
//! [`crossing`](super::super::crossing)). A chain that leaves what is known goes on, nobody knows how.

use rustc_hash::{FxHashMap, FxHashSet};

use super::super::brick::Bricks;
use super::super::cell::default_sheets;
use super::super::crossing::{UnflippedCells, below};
use super::cells::{cell_of, is_in};

/// Whether no chain leads from the cells near a block to beyond the known ones.
pub(super) fn is_complete(
    bricks: &Bricks,
    found: &UnflippedCells,
    near: [[usize; 3]; 2],
    known: [[usize; 3]; 2],
) -> bool {
    let mut list = leaving(bricks, found, known);
    if list.is_empty() {
        return true;
    }
    let links = links(bricks, found);
    let mut seen: FxHashSet<usize> = list.iter().copied().collect();
    while let Some(cell) = list.pop() {
        let brick = found.starts.partition_point(|&first| first <= cell) - 1;
        if is_in(cell_of(bricks, brick, &found.cells[cell]), near) {
            return false;
        }
        for &other in links.get(&cell).into_iter().flatten() {
            if seen.insert(other) {
                list.push(other);
            }
        }
    }
    true
}

/// The cells with a pinched face towards cells that are not known.
fn leaving(bricks: &Bricks, found: &UnflippedCells, known: [[usize; 3]; 2]) -> Vec<usize> {
    let mut leaving = Vec::new();
    for brick in 0..bricks.len() {
        let (origin, extent) = (bricks.origin(brick), bricks.extent(brick));
        let at = |axis: usize| {
            let has = |cell: usize| (origin[axis]..origin[axis] + extent[axis]).contains(&cell);
            let ends = known[1][axis] < bricks.axes[axis].len() - 1;
            [known[0][axis] > 0 && has(known[0][axis]), ends && has(known[1][axis] - 1)]
        };
        let sides = [at(0), at(1), at(2)];
        if sides == [[false; 2]; 3] {
            continue;
        }
        for index in found.starts[brick]..found.starts[brick + 1] {
            let cell = &found.cells[index];
            let place = cell_of(bricks, brick, cell);
            if !is_in(place, known) {
                continue;
            }
            let sheets = default_sheets(cell.signs);
            let leaves = |axis: usize| {
                sides[axis][0] && place[axis] == known[0][axis] && sheets.pinched(2 * axis)
                    || sides[axis][1] && place[axis] + 1 == known[1][axis] && sheets.pinched(2 * axis + 1)
            };
            if (0..3).any(leaves) {
                leaving.push(index);
            }
        }
    }
    leaving
}

/// Pairs of cells that share a face which is pinched in both, both ways.
fn links(bricks: &Bricks, found: &UnflippedCells) -> FxHashMap<usize, Vec<usize>> {
    let mut links: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
    for &(brick, upper) in &found.suspects {
        for axis in 0..3 {
            let pinched = |cell: usize, face: usize| default_sheets(found.cells[cell].signs).pinched(face);
            if !pinched(upper, 2 * axis) {
                continue;
            }
            let lower = below(bricks, &found.starts, &found.cells, brick, upper, axis);
            if let Some(lower) = lower.filter(|&lower| pinched(lower, 2 * axis + 1)) {
                links.entry(upper).or_default().push(lower);
                links.entry(lower).or_default().push(upper);
            }
        }
    }
    links
}
