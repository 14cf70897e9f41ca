//! A tree of boxes over the rows of a table, for questions about a small part of a large model.
//!
//! ```text
//! levels[1]   [        box of 8 boxes         ] ..
//! levels[0]   [ box of 16 rows ] [  ] .. 8 .. [  ] ..
//! order       rows in the order of their places on a Morton curve (Morton 1966)
//! ```
//!
//! There are no pointers: children of box i are the boxes from 8 i, rows of the lowest boxes those from 16 i.
//! A box holds the supports of its rows, so a row that reaches somewhere is under boxes that meet that place.
//! The rows under those are tested one by one. So the tree finds exactly the rows that a pass over all finds.

use std::ops::Range;

use jbt_ir::watch;

use super::cull::RowSupports;
use crate::boxes::Box3;
use crate::morton::morton;
use crate::parallel::*;

/// Rows under a box of the lowest level.
const ROWS: usize = 16;
/// Boxes under a box of the other levels.
const CHILDREN: usize = 8;
/// Bits of a place on the curve along each axis.
const BITS: u32 = 21;

/// A tree over the active rows of a table: see the module.
#[derive(Clone)]
pub(super) struct RowTree {
    /// Positions of rows among the active ones of the table.
    order: Vec<u32>,
    /// The lowest first. The last has at most [`CHILDREN`] boxes.
    levels: Vec<Vec<Box3>>,
}

/// What making the tree takes for a row: its middle, its place twice, and its part of the levels.
const TREE_BYTES: usize = 48;

/// The box that holds nothing.
const NOTHING: Box3 = Box3 { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

impl RowTree {
    /// The tree of these active rows, at least one.
    pub(super) fn new(supports: &RowSupports, active: &[u32]) -> Self {
        watch::take(active.len() * TREE_BYTES);
        let middle_of = |&row: &u32| {
            watch::look();
            middle(&supports.reach_box(row))
        };
        let middles: Vec<[f32; 3]> = active.iter().map(middle_of).collect();
        let is_finite = |middle: &&[f32; 3]| middle.iter().all(|side| side.is_finite());
        let around = middles
            .iter()
            .filter(is_finite)
            .fold(NOTHING, |hull, &at| hull.joined(&Box3 { low: at, high: at }));
        let mut places: Vec<(u64, u32)> =
            middles.iter().zip(0..).map(|(middle, position)| (code(middle, &around), position)).collect();
        scatter(|_| places.par_sort_unstable_by_key(|&place| place));
        let order = places.into_iter().map(|(_, position)| position).collect();
        let mut tree = Self { order, levels: Vec::new() };
        let mut count = active.len().div_ceil(ROWS);
        loop {
            tree.levels.push(vec![NOTHING; count]);
            let level = tree.levels.len() - 1;
            for index in 0..count {
                watch::look();
                tree.fit(level, index, supports, active);
            }
            if count <= CHILDREN {
                return tree;
            }
            count = count.div_ceil(CHILDREN);
        }
    }

    /// The positions that a box of the lowest level holds.
    fn rows(&self, index: usize) -> &[u32] {
        &self.order[index * ROWS..self.order.len().min((index + 1) * ROWS)]
    }

    /// The boxes under a box of another level.
    fn children(&self, level: usize, index: usize) -> Range<usize> {
        index * CHILDREN..self.levels[level - 1].len().min((index + 1) * CHILDREN)
    }

    /// Computes a box again.
    fn fit(&mut self, level: usize, index: usize, supports: &RowSupports, active: &[u32]) {
        self.levels[level][index] = if level == 0 {
            let boxes =
                self.rows(index).iter().map(|&position| supports.reach_box(active[position as usize]));
            boxes.fold(NOTHING, |hull, other| hull.joined(&other))
        } else {
            self.levels[level - 1][self.children(level, index)]
                .iter()
                .fold(NOTHING, |hull, other| hull.joined(other))
        };
    }

    /// The support of the row at a position has changed. Rows keep their order, so the tree gets worse when
    /// rows go far.
    pub(super) fn refit(&mut self, position: u32, supports: &RowSupports, active: &[u32]) {
        let Some(place) = self.order.iter().position(|&it| it == position) else { return };
        let mut index = place / ROWS;
        for level in 0..self.levels.len() {
            self.fit(level, index, supports, active);
            index /= CHILDREN;
        }
    }

    /// The positions of the rows that reach a place, ascending: of those whose box meets `bounds` the ones
    /// that `reaches` says. `None` if there are more than `most`.
    pub(super) fn reached(
        &self,
        bounds: &Box3,
        most: usize,
        reaches: impl Fn(u32) -> bool,
    ) -> Option<Vec<u32>> {
        let top = self.levels.len() - 1;
        let mut open: Vec<(usize, usize)> = (0..self.levels[top].len()).map(|index| (top, index)).collect();
        let mut found = Vec::new();
        while let Some((level, index)) = open.pop() {
            if !self.levels[level][index].meets(bounds) {
                continue;
            }
            if level > 0 {
                open.extend(self.children(level, index).map(|child| (level - 1, child)));
                continue;
            }
            watch::take_for(&found, self.rows(index).len());
            found.extend(self.rows(index).iter().filter(|&&position| reaches(position)));
            if found.len() > most {
                return None;
            }
        }
        found.sort_unstable();
        Some(found)
    }
}

fn middle(bounds: &Box3) -> [f32; 3] {
    std::array::from_fn(|axis| 0.5 * bounds.low[axis] + 0.5 * bounds.high[axis])
}

/// The place of a point on the Morton curve through a box. What is not finite comes last.
fn code(at: &[f32; 3], around: &Box3) -> u64 {
    if !at.iter().all(|side| side.is_finite()) {
        return u64::MAX;
    }
    morton(std::array::from_fn(|axis| {
        let (low, high) = (f64::from(around.low[axis]), f64::from(around.high[axis]));
        let part = (f64::from(at[axis]) - low) / (high - low).max(f64::MIN_POSITIVE);
        (part * f64::from((1_u32 << BITS) - 1)) as u32
    }))
}

#[cfg(test)]
mod tests {
    use super::super::cull::Boxes;
    use super::*;
    use jbt_lower::prune_info::Support;

    /// Supports of any kind: balls, points, flat boxes, nothing, everything, near zero and far away.
    fn support(rng: &mut fastrand::Rng) -> Support {
        let scale = [1.0, 1.0, 1.0, 1e-20, 1e5][rng.usize(0..5)];
        let low: [f32; 3] = std::array::from_fn(|_| scale * (2.0 * rng.f32() - 1.0));
        let high = low.map(|side| side + [0.0, 0.1, -0.1][rng.usize(0..3)] * rng.f32());
        let radius = [0.0, 1e-30, 0.1, 1.0][rng.usize(0..4)] * scale;
        match rng.u8(0..40) {
            0 => Support::EVERYWHERE,
            1 => Support { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3], radius_squared: radius },
            2 => Support { low, high, radius_squared: f32::INFINITY },
            _ => Support { low, high, radius_squared: radius * radius },
        }
    }

    #[test]
    fn the_tree_finds_what_a_pass_finds() {
        let mut rng = fastrand::Rng::with_seed(3);
        let mut narrow = 0;
        for count in [1, 15, 16, 17, 128, 129, 1000, 5000] {
            let mut supports: Vec<Support> = (0..count).map(|_| support(&mut rng)).collect();
            let mut rows = RowSupports::new(&supports.clone().into());
            // Not all rows are active.
            let active: Vec<u32> = (0..count).filter(|row| count < 20 || row % 7 != 0).collect();
            let mut tree = RowTree::new(&rows, &active);
            for round in 0..200 {
                let middle = supports[rng.usize(0..supports.len())].low;
                let low = middle.map(|side| side + [0.0, 1e-25, 0.2][rng.usize(0..3)] * (rng.f32() - 0.5));
                let low = if low.iter().all(|side| side.is_finite()) { low } else { [0.0; 3] };
                let bounds = Box3::new(low, low.map(|side| side + [0.0, 0.1][rng.usize(0..2)] * rng.f32()));
                let boxes = Boxes::new(&[bounds]);
                let reaches = |position: u32| rows.reach(active[position as usize], &boxes) != 0;
                let expected: Vec<u32> =
                    (0..active.len() as u32).filter(|&position| reaches(position)).collect();
                match tree.reached(&bounds, active.len() / 8, reaches) {
                    Some(found) => {
                        narrow += 1;
                        assert_eq!(found, expected, "{bounds:?}");
                    }
                    None => assert!(expected.len() > active.len() / 8),
                }
                if round % 4 == 0 {
                    let position = rng.usize(0..active.len());
                    let row = active[position] as usize;
                    supports[row] = support(&mut rng);
                    rows = RowSupports::new(&supports.clone().into());
                    tree.refit(position as u32, &rows, &active);
                }
            }
        }
        assert!(narrow > 400, "{narrow}");
    }

    #[test]
    fn boxes_of_a_tree_are_small() {
        let mut rng = fastrand::Rng::with_seed(5);
        let ball = |rng: &mut fastrand::Rng| {
            let at = std::array::from_fn(|_| 3.0 + 8.0 * rng.f32());
            Support { low: at, high: at, radius_squared: 1e-4 }
        };
        let supports: Vec<Support> = (0..4096).map(|_| ball(&mut rng)).collect();
        let active: Vec<u32> = (0..4096).collect();
        let tree = RowTree::new(&RowSupports::new(&supports.into()), &active);
        // Boxes of 16, of 128 and of 1,024 rows, each with its share of a space of 8^3: half of them are not
        // much larger.
        for (level, (count, most)) in [(256, 2.5), (32, 5.0), (4, 8.1)].into_iter().enumerate() {
            let side = |bounds: &Box3| (0..3).map(|k| bounds.high[k] - bounds.low[k]).fold(0.0, f32::max);
            let mut sides: Vec<f32> = tree.levels[level].iter().map(side).collect();
            assert_eq!(sides.len(), count);
            sides.sort_unstable_by(f32::total_cmp);
            assert!(sides[count / 2] < most, "level {level}: {}", sides[count / 2]);
        }
    }
}
