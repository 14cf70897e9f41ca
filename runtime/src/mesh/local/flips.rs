//! Flips of faces where some bricks are new.
//!
//! Faces are flipped in the order of their cells, and a flip may make one beside it needless (see
//! [`crossing`](super::super::crossing)). So a flip depends on those before it along a *chain*: cells joined
//! by faces that are pinched, by default, in both of their cells. Chains are short as a rule; all bricks that
//! share one with a new brick, as it is or as it was, are flipped anew.

use rustc_hash::{FxHashMap, FxHashSet};

use super::bricks::{BrickMesh, BrickPlace, beside, linked};
use crate::mesh::brick::{Bricks, place};
use crate::mesh::cell::default_sheets;
use crate::mesh::crossing::{CrossedCell, Flips, UnflippedCells, flip};
use crate::mesh::lattice::Lattice;
use crate::morton::morton;
use crate::touched::Touched;

/// What flips depend on.
pub(super) struct FlipChain<'a> {
    pub(super) mesh: &'a BrickMesh,
    /// That of the new bricks.
    pub(super) lattice: &'a Lattice,
    /// The new bricks.
    pub(super) bricks: &'a Bricks,
    /// The places in which bricks are new, or no more.
    pub(super) touched: &'a Touched<3>,
}

/// Cells of a brick, and those of them that have a low face which is pinched by default.
type Pinched<'a> = (&'a [CrossedCell], Vec<u32>);

impl FlipChain<'_> {
    /// Flips faces of the new bricks. If faces of other bricks are flipped otherwise than before, it returns
    /// the places of these bricks as well, from the first one of the lattice.
    pub(super) fn flip(&self, found: &mut UnflippedCells) -> (Flips, Vec<[u32; 3]>) {
        let others = self.others(found);
        if others.is_empty() {
            let flips = flip(self.bricks, &found.starts, &mut found.cells, &found.suspects);
            return (flips, Vec::new());
        }
        let number = self.numbers();
        let shift = BrickMesh::shift(self.lattice, self.bricks.edge);
        let from_first = |place: BrickPlace| [0, 1, 2].map(|axis| (place[axis] - shift[axis]) as u32);
        let mut places: Vec<[u32; 3]> = self.bricks.places.clone();
        places.extend(others.iter().map(|&place| from_first(place)));
        places.sort_unstable_by_key(|&place| morton(place));
        let (mut cells, mut starts, mut suspects) = (Vec::new(), vec![0], Vec::new());
        for (brick, &place) in places.iter().enumerate() {
            let before = cells.len();
            if let Some(&new) = number.get(&place) {
                let range = found.starts[new]..found.starts[new + 1];
                suspects.extend(
                    self.new_suspects(found, new).into_iter().map(|cell| (brick, before + cell as usize)),
                );
                cells.extend_from_slice(&found.cells[range]);
            } else {
                let kept = &self.mesh.bricks[&self.to_anchor(place)];
                suspects.extend(kept.suspects.iter().map(|&cell| (brick, before + cell as usize)));
                cells.extend(kept.cells.iter().map(|cell| CrossedCell { flips: 0, ..*cell }));
            }
            starts.push(cells.len());
        }
        let all = linked(self.bricks.edge, self.bricks.axes.clone(), places);
        let mut flips = flip(&all, &starts, &mut cells, &suspects);
        let (mut flipped_new, mut changed) = (Vec::new(), Vec::new());
        for (brick, &place) in all.places.iter().enumerate() {
            let flipped = &cells[starts[brick]..starts[brick + 1]];
            if let Some(&new) = number.get(&place) {
                let range = found.starts[new]..found.starts[new + 1];
                found.cells[range].copy_from_slice(flipped);
                if flips.bricks.binary_search(&brick).is_ok() {
                    flipped_new.push(new);
                }
            } else {
                let kept = &self.mesh.bricks[&self.to_anchor(place)].cells;
                if kept.iter().zip(flipped).any(|(old, new)| old.flips != new.flips) {
                    changed.push(place);
                }
            }
        }
        flips.bricks = flipped_new;
        (flips, changed)
    }

    /// The other bricks that share a chain with a new one, as it is or as it was.
    fn others(&self, found: &UnflippedCells) -> Vec<BrickPlace> {
        let number = self.numbers();
        let (mut seen, mut others) = (FxHashSet::default(), Vec::new());
        let mut list: Vec<BrickPlace> = self.touched.bricks().map(|place| self.to_anchor(place)).collect();
        while let Some(brick) = list.pop() {
            if !seen.insert(brick) {
                continue;
            }
            let new = self.to_first(brick).filter(|place| self.touched.has_brick(*place));
            if new.is_none() {
                others.push(brick);
            }
            let mut own: Vec<Pinched<'_>> = self.kept(brick).into_iter().collect();
            if let Some(&new) = new.and_then(|place| number.get(&place)) {
                let cells = &found.cells[found.starts[new]..found.starts[new + 1]];
                own.push((cells, self.new_suspects(found, new)));
            }
            for axis in 0..3 {
                let step = |by: i32| beside(brick, std::array::from_fn(|a| if a == axis { by } else { 0 }));
                let (below, above) = (step(-1), step(1));
                if !self.is_touched(below)
                    && own.iter().any(|pinched| meets_below(pinched, axis))
                    && self.mesh.bricks.contains_key(&below)
                {
                    list.push(below);
                }
                if !self.is_touched(above)
                    && self.kept(above).is_some_and(|pinched| meets_below(&pinched, axis))
                {
                    list.push(above);
                }
            }
        }
        others
    }

    fn numbers(&self) -> FxHashMap<[u32; 3], usize> {
        self.bricks.places.iter().enumerate().map(|(number, &place)| (place, number)).collect()
    }

    fn is_touched(&self, brick: BrickPlace) -> bool {
        self.to_first(brick).is_some_and(|place| self.touched.has_brick(place))
    }

    /// A brick as it was.
    fn kept(&self, brick: BrickPlace) -> Option<Pinched<'_>> {
        let kept = self.mesh.bricks.get(&brick)?;
        Some((&kept.cells, kept.suspects.clone()))
    }

    fn new_suspects(&self, found: &UnflippedCells, brick: usize) -> Vec<u32> {
        let first = found.suspects.partition_point(|&(other, _)| other < brick);
        let mine = found.suspects[first..].iter().take_while(|&&(other, _)| other == brick);
        mine.map(|&(_, cell)| (cell - found.starts[brick]) as u32).collect()
    }

    /// A place from the lattice's anchor.
    fn to_anchor(&self, place: [u32; 3]) -> BrickPlace {
        let shift = BrickMesh::shift(self.lattice, self.bricks.edge);
        [0, 1, 2].map(|axis| place[axis] as i32 + shift[axis])
    }

    /// A place from the lattice's first brick; `None` if it is below that.
    fn to_first(&self, place: BrickPlace) -> Option<[u32; 3]> {
        let shift = BrickMesh::shift(self.lattice, self.bricks.edge);
        let steps = [0, 1, 2].map(|axis| u32::try_from(place[axis] - shift[axis]).ok());
        let [Some(x), Some(y), Some(z)] = steps else { return None };
        Some([x, y, z])
    }
}

/// Whether a face that is pinched by default leads to the brick below along an axis.
fn meets_below((cells, suspects): &Pinched<'_>, axis: usize) -> bool {
    suspects.iter().any(|&cell| {
        let cell = &cells[cell as usize];
        place(cell.number)[axis] == 0 && default_sheets(cell.signs).pinched(2 * axis)
    })
}
