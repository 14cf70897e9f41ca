//! A tree over the rows of a contest, for questions about a small part of a large model: the rows that may
//! win there, in a time that goes by their number.
//!
//! ```text
//! levels[1]   [   hull of 8 hulls   ] ..       the function of a row with its numbers as ranges:
//! levels[0]   [ hull of 8 rows  ] ..           one run with the hulls as lanes gives the range of any row in them
//! order       rows by their first numbers on a Morton curve (Morton 1966)
//!
//! from the top:  best = the largest low end of all hulls so far, and of what the contest starts with
//!                a hull goes if its high end is below best; those that stay are opened
//! ```
//!
//! A hull holds a row, so some row is not below the low end of its range. The rows that are left go through
//! the contest itself, so which hulls stay decides about time alone. The first numbers of a row that differ
//! from row to row are where it stands, as leaves and formulas are written, and rows that stand near each
//! other have narrow hulls.

use jbt_ir::{RowFunction, Tables, watch};
use jbt_lower::prune_info::ContestGroup;
use jbt_model::combine::Extreme;

use super::lanes::{MOST_LANES, fill};
use crate::boxes::Box3;
use crate::compiler::Compiler;
use crate::error::EvalError;
use crate::kernel::{BoundKernel, Purpose};
use crate::morton::morton;
use crate::parallel::*;

/// Rows under a hull of the lowest level.
const ROWS: usize = 8;
/// Hulls under a hull of the other levels.
const CHILDREN: usize = 8;
/// Bits of a place on the curve along each axis.
const BITS: u32 = 21;

/// A tree over the active rows of a table.
pub(super) struct WinnerTree {
    kernel: BoundKernel,
    /// Distances in the function.
    distances: u64,
    /// Positions of rows among the active ones of the table.
    order: Vec<u32>,
    /// The lowest first. Of each, the low and the high ends of each number, plane by plane.
    levels: Vec<Vec<Vec<f32>>>,
}

impl WinnerTree {
    /// The tree of these active rows, at least one; `None` if no ranges of the rows can be had.
    pub(super) fn new(
        compiler: &Compiler,
        lowered: &BoundKernel,
        group: &ContestGroup,
        active: &[u32],
    ) -> Option<Self> {
        let function = &lowered.kernel.lowered;
        let RowFunction { function, numbers, distances } =
            RowFunction::new(function, lowered.tables(), group.table, group.field)?;
        let kernel = compiler.kernel(function, Purpose::Ranges, None).ok()?;
        let order = order(&numbers, active);
        let row = |&position: &u32| active[position as usize] as usize;
        let mut levels = vec![Vec::with_capacity(2 * numbers.len())];
        for plane in &numbers {
            let ends = |rows: &[u32]| {
                rows.iter()
                    .map(|position| plane[row(position)])
                    .fold(NOTHING, |[low, high], number| [low.min(number), high.max(number)])
            };
            let ends: Vec<[f32; 2]> = scatter(|_| order.par_chunks(ROWS).map(ends).collect());
            levels[0].extend([0, 1].map(|end| ends.iter().map(|ends| ends[end]).collect()));
        }
        while levels[levels.len() - 1].first().map_or(0, Vec::len) > CHILDREN {
            let below = &levels[levels.len() - 1];
            let hulls = below.iter().enumerate().map(|(plane, ends)| {
                let outer = if plane % 2 == 0 { f32::min } else { f32::max };
                ends.chunks(CHILDREN)
                    .map(|ends| ends.iter().copied().reduce(outer).unwrap_or(f32::NAN))
                    .collect()
            });
            levels.push(hulls.collect());
        }
        let has_numbers = !levels[0].is_empty();
        has_numbers.then(|| Self {
            kernel: compiler.bind(&kernel, Tables::default()),
            distances,
            order,
            levels,
        })
    }

    /// The positions of the rows that may win in a box, ascending, and the ranges of distances that it took.
    /// The positions are `None` if they are so many that a pass over all rows is as fast.
    pub(super) fn winners(
        &self,
        bounds: &Box3,
        (extreme, start): (Extreme, Option<f32>),
    ) -> Result<(Option<Vec<u32>>, u64), EvalError> {
        let most = self.order.len() / (2 * ROWS);
        // Who is open, and the range of each.
        watch::take(most * CHILDREN * size_of::<(usize, [f32; 2])>());
        let mut best = start.unwrap_or(f32::NEG_INFINITY);
        let mut open: Vec<usize> = (0..self.levels[self.levels.len() - 1][0].len()).collect();
        let mut evaluations = 0;
        for (level, hulls) in self.levels.iter().enumerate().rev() {
            evaluations += self.distances * open.len() as u64;
            let ranges = self.ranges(hulls, &open, bounds)?;
            let ranges = ranges.into_iter().map(|[low, high]| match extreme {
                Extreme::Largest => [low, high],
                Extreme::Smallest => [-high, -low],
            });
            let ranges: Vec<[f32; 2]> = ranges.collect();
            best = ranges.iter().fold(best, |best, range| best.max(range[0]));
            // What a contest starts with comes before all rows.
            let loses = |high: f32| high < best || start.is_some_and(|start| high <= start);
            let stay =
                open.iter().zip(&ranges).filter(|(_, range)| !loses(range[1])).map(|(&index, _)| index);
            if level == 0 {
                open = stay.collect();
            } else {
                let count = self.levels[level - 1][0].len();
                open = stay.flat_map(|index| index * CHILDREN..count.min((index + 1) * CHILDREN)).collect();
            }
            if open.len() > most {
                return Ok((None, evaluations));
            }
        }
        let rows = |&index: &usize| &self.order[index * ROWS..self.order.len().min((index + 1) * ROWS)];
        let mut found: Vec<u32> = open.iter().flat_map(rows).copied().collect();
        found.sort_unstable();
        Ok((Some(found), evaluations))
    }

    /// The ranges of any row in some hulls of a level, in a box.
    fn ranges(&self, hulls: &[Vec<f32>], open: &[usize], bounds: &Box3) -> Result<Vec<[f32; 2]>, EvalError> {
        let block = self.kernel.kernel.block();
        let mut planes: Vec<Vec<f32>> = vec![Vec::new(); 6 + hulls.len()];
        let mut found = Vec::with_capacity(open.len());
        for open in open.chunks(MOST_LANES.next_multiple_of(block)) {
            let lanes = open.len().next_multiple_of(block);
            let (point, numbers) = planes.split_at_mut(6);
            for axis in 0..3 {
                fill(&mut point[2 * axis], lanes, open.iter().map(|_| bounds.low[axis]));
                fill(&mut point[2 * axis + 1], lanes, open.iter().map(|_| bounds.high[axis]));
            }
            for (plane, ends) in numbers.iter_mut().zip(hulls) {
                fill(plane, lanes, open.iter().map(|&index| ends[index]));
            }
            let inputs: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
            let (mut low, mut high) = (vec![0.0; lanes], vec![0.0; lanes]);
            self.kernel.run(self.kernel.all(), &inputs, &mut [&mut low, &mut high])?;
            found.extend(low.into_iter().zip(high).take(open.len()).map(|(low, high)| [low, high]));
        }
        Ok(found)
    }
}

/// The ends of nothing.
const NOTHING: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

/// The positions of rows, by their first three numbers that differ, on a Morton curve.
fn order(numbers: &[Vec<f32>], active: &[u32]) -> Vec<u32> {
    let ends = |plane: &Vec<f32>| {
        active
            .iter()
            .map(|&row| plane[row as usize])
            .filter(|number| number.is_finite())
            .fold(NOTHING, |[low, high], number| [low.min(number), high.max(number)])
    };
    let axes: Vec<(&Vec<f32>, [f32; 2])> = numbers
        .iter()
        .map(|plane| (plane, ends(plane)))
        .filter(|(_, [low, high])| low < high)
        .take(3)
        .collect();
    let code = |row: u32| {
        let mut place = [0; 3];
        for (place, (plane, [low, high])) in place.iter_mut().zip(&axes) {
            let (low, high) = (f64::from(*low), f64::from(*high));
            let part = (f64::from(plane[row as usize]) - low) / (high - low);
            *place = (part * f64::from((1_u32 << BITS) - 1)) as u32;
        }
        morton(place)
    };
    watch::take(2 * active.len() * size_of::<(u64, u32)>());
    let mut places: Vec<(u64, u32)> =
        active.iter().zip(0..).map(|(&row, position)| (code(row), position)).collect();
    scatter(|_| places.par_sort_unstable_by_key(|&place| place));
    places.into_iter().map(|(_, position)| position).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_follow_each_other_stand_near_each_other() {
        let mut rng = fastrand::Rng::with_seed(1);
        let count = 4096;
        let planes: Vec<Vec<f32>> =
            (0..3).map(|_| (0..count).map(|_| 8.0 * rng.f32() - 4.0).collect()).collect();
        // Numbers that are all the same say nothing; behind three others nobody looks.
        let same = vec![0.5; count];
        let numbers =
            [same.clone(), planes[0].clone(), planes[1].clone(), same.clone(), planes[2].clone(), same]
                .to_vec();
        let active: Vec<u32> = (0..count as u32).filter(|row| row % 5 != 0).collect();
        let order = order(&numbers, &active);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..active.len() as u32), "each position once");
        let mut apart: Vec<f32> = order
            .windows(2)
            .map(|pair| {
                let [a, b] = [pair[0], pair[1]].map(|position| active[position as usize] as usize);
                planes.iter().map(|plane| (plane[a] - plane[b]).abs()).fold(0.0, f32::max)
            })
            .collect();
        apart.sort_unstable_by(f32::total_cmp);
        // There are 15 rows along each side of 8; two at random are some 4 apart.
        assert!(apart[apart.len() / 2] < 1.0, "{}", apart[apart.len() / 2]);
    }
}
