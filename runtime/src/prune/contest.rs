//! Rows that win nowhere in a box: of the operands of a union or an intersection that are rows, those that
//! another row beats in the whole box.
//!
//! ```text
//! lanes:        each row of the contest with each box that it may matter in      one run of the row's own function
//! union:        best = the largest low end of a box, of the rows of one owner
//!               a row goes if its high end is below best, or equal and behind the row that has it
//! intersection: the same of the negative ranges
//! ```
//!
//! A row that goes is beaten at every point by a row that stays, or equals one that comes before it. So no
//! field, gradient or attribute comes from it, and what is left out changes no bit. Rows that their supports
//! leave out have gone before.
//!
//! The function of a row ([`RowFunction`]) has the ops of the program, so its range encloses every f32 that
//! engines compute.

use std::sync::OnceLock;

use jbt_ir::{Entity as _, RowFunction, Selection, Table, Tables};
use jbt_lower::prune_info::{Contest, ContestGroup, PruneInfo};
use jbt_model::combine::Extreme;

use super::decide::firsts;
use super::ranges::ProbeRanges;
use crate::compiler::Compiler;
use crate::error::EvalError;
use crate::kernel::{BoundKernel, Purpose};
use crate::region::{Box3, Range};

/// A contest of fewer rows, over the whole model, is not worth a program.
const FEWEST_ROWS: usize = 8;
/// The same of rows that are tried by the range program as well ([`super::decide::Alone`]).
const FEWEST_TRIED_ROWS: usize = 48;
/// Fewer rows in a box are not looked at.
const FEWEST_IN_BOX: usize = 3;
/// The most contests of a model that have programs: those of the most rows.
const MOST_CONTESTS: usize = 24;
/// Lanes of a run: their planes stay in the nearest caches.
const MOST_LANES: usize = 1024;

/// The contests of a model, with what runs their rows.
pub(super) struct Contests {
    compiler: Compiler,
    /// Those that are worth it.
    all: Vec<ContestRows>,
}

struct ContestRows {
    contest: Contest,
    /// By group: made when it is first asked for. `None` if no ranges of the rows can be had.
    groups: Vec<OnceLock<Option<RowRanges>>>,
}

/// What gives the ranges of the rows of a table.
struct RowRanges {
    kernel: BoundKernel,
    /// Numbers of the rows, plane by plane.
    numbers: Vec<Vec<f32>>,
    /// Distances in the function.
    distances: u64,
}

/// A row in a box.
#[derive(Clone, Copy)]
struct RowInBox {
    row: u32,
    /// Its place among all active rows of the selection.
    place: u32,
    /// The position of the row that owns it.
    owner: u32,
    part: u8,
}

/// What is ahead so far, of the rows of one owner in a box.
#[derive(Clone, Copy)]
struct Ahead {
    low: f32,
    /// The row that has it; `None` for what comes before all rows.
    place: Option<(usize, u32)>,
}

impl Contests {
    pub(super) fn new(compiler: &Compiler, info: &PruneInfo, tables: &Tables) -> Self {
        let rows = |contest: &Contest| -> usize {
            contest.groups.iter().map(|group| tables.tables[group.table].len()).sum()
        };
        let is_tried = |contest: &Contest| {
            let tried = |group: &ContestGroup| info.decisions.iter().any(|it| it.table == group.table);
            contest.groups.iter().any(tried)
        };
        let mut worth: Vec<&Contest> = info
            .contests
            .iter()
            .filter(|contest| {
                let fewest = if is_tried(contest) { FEWEST_TRIED_ROWS } else { FEWEST_ROWS };
                rows(contest) >= fewest
            })
            .collect();
        worth.sort_by_key(|contest| std::cmp::Reverse(rows(contest)));
        worth.truncate(MOST_CONTESTS);
        let with_rows = |contest: &Contest| ContestRows {
            groups: contest.groups.iter().map(|_| OnceLock::new()).collect(),
            contest: contest.clone(),
        };
        Self { compiler: compiler.clone(), all: worth.into_iter().map(with_rows).collect() }
    }

    /// Whether the rows of a table meet in a contest.
    pub(super) fn meet(&self, table: Table) -> bool {
        self.all.iter().flat_map(|it| &it.contest.groups).any(|group| group.table == table)
    }

    /// Clears the masks of rows that win nowhere, for each box. `lowered` is the range program, whose rows
    /// the selection selects; `probes` are the ranges of its probes, if they are known. Returns how many
    /// ranges of distances that took.
    pub(super) fn leave_out(
        &self,
        lowered: &BoundKernel,
        (selection, boxes): (&Selection, &[Box3]),
        probes: Option<ProbeRanges<'_>>,
        masks: &mut [u8],
    ) -> Result<u64, EvalError> {
        let mut evaluations = 0;
        if self.all.is_empty() {
            return Ok(evaluations);
        }
        let firsts = firsts(selection);
        for ContestRows { contest, groups } in &self.all {
            let rows = |group: &ContestGroup| selection.active(group.table).len();
            if contest.groups.iter().map(rows).sum::<usize>() < FEWEST_IN_BOX {
                continue;
            }
            let mut round = Round::new(contest, selection, boxes.len());
            for (index, (group, made)) in contest.groups.iter().zip(groups).enumerate() {
                let first = firsts[group.table.index()];
                let entered = round.entered(group, (selection, first), masks);
                if entered.len() < FEWEST_IN_BOX {
                    continue;
                }
                let made = made.get_or_init(|| RowRanges::new(&self.compiler, lowered, group));
                let Some(ranges) = made else { continue };
                evaluations += ranges.distances * entered.len() as u64;
                ranges.find(&entered, boxes, &mut |entry, range| round.meet(index, entry, range))?;
            }
            round.finish(contest, probes, masks);
        }
        Ok(evaluations)
    }
}

/// One contest in some boxes.
struct Round {
    extreme: Extreme,
    owners: usize,
    /// By box and owner.
    ahead: Vec<Ahead>,
    /// Each row in each box, with its group and the high end of its range.
    met: Vec<(RowInBox, usize, f32)>,
}

impl Round {
    fn new(contest: &Contest, selection: &Selection, boxes: usize) -> Self {
        let owners = selection.starts(contest.groups[0].table).len() - 1;
        let ahead = Ahead { low: contest.start.unwrap_or(f32::NEG_INFINITY), place: None };
        Self { extreme: contest.extreme, owners, ahead: vec![ahead; boxes * owners], met: Vec::new() }
    }

    /// The rows of a group in each box in which they may matter.
    fn entered(
        &self,
        group: &ContestGroup,
        (selection, first): (&Selection, usize),
        masks: &[u8],
    ) -> Vec<RowInBox> {
        let (starts, active) = (selection.starts(group.table), selection.active(group.table));
        let mut entered = Vec::new();
        for owner in 0..self.owners {
            for position in starts[owner]..starts[owner + 1] {
                let place = first + position as usize;
                let mut mask = masks[place];
                while mask != 0 {
                    let part = mask.trailing_zeros() as u8;
                    mask &= mask - 1;
                    let row = active[position as usize];
                    // Selections have fewer than 2^32 rows.
                    entered.push(RowInBox { row, place: place as u32, owner: owner as u32, part });
                }
            }
        }
        entered
    }

    /// The place of what is ahead of a row.
    fn of(&self, entry: RowInBox) -> usize {
        entry.part as usize * self.owners + entry.owner as usize
    }

    /// A row with its range comes to the contest, in the order of rows.
    fn meet(&mut self, group: usize, entry: RowInBox, [low, high]: Range) {
        let [low, high] = match self.extreme {
            Extreme::Largest => [low, high],
            Extreme::Smallest => [-high, -low],
        };
        let place = self.of(entry);
        let ahead = &mut self.ahead[place];
        if low > ahead.low {
            *ahead = Ahead { low, place: Some((group, entry.place)) };
        }
        self.met.push((entry, group, high));
    }

    /// Clears the masks of rows that win nowhere.
    fn finish(self, contest: &Contest, probes: Option<ProbeRanges<'_>>, masks: &mut [u8]) {
        for &(entry, group, high) in &self.met {
            let ahead = self.ahead[self.of(entry)];
            let is_behind = match ahead.place {
                None => contest.start.is_some(),
                Some((other, place)) => other == group && place < entry.place,
            };
            // The range of the operator itself knows more operands than those that are rows.
            let node = probes.zip(contest.node).map(|(probes, node)| probes.range(node, entry.part.into()));
            let below = node.is_some_and(|[low, upper]| match self.extreme {
                Extreme::Largest => high < low,
                Extreme::Smallest => high < -upper,
            });
            if high < ahead.low || (high == ahead.low && is_behind) || below {
                masks[entry.place as usize] &= !(1 << entry.part);
            }
        }
    }
}

impl RowRanges {
    fn new(compiler: &Compiler, lowered: &BoundKernel, group: &ContestGroup) -> Option<Self> {
        let function = &lowered.kernel.lowered;
        let RowFunction { function, numbers, distances } =
            RowFunction::new(function, lowered.tables(), group.table, group.field)?;
        // What no program can be had for is not left out.
        let kernel = compiler.kernel(function, Purpose::RowRanges, None).ok()?;
        Some(Self { kernel: compiler.bind(&kernel, Tables::default()), numbers, distances })
    }

    /// The range of each row in its box.
    fn find(
        &self,
        entered: &[RowInBox],
        boxes: &[Box3],
        met: &mut dyn FnMut(RowInBox, Range),
    ) -> Result<(), EvalError> {
        let most = MOST_LANES.next_multiple_of(self.kernel.kernel.block());
        let mut planes: Vec<Vec<f32>> = vec![Vec::with_capacity(most); 6 + self.numbers.len()];
        for entered in entered.chunks(most) {
            // Whole blocks run in place.
            let lanes = entered.len().next_multiple_of(self.kernel.kernel.block());
            let (point, numbers) = planes.split_at_mut(6);
            let part = |entry: &RowInBox| &boxes[entry.part as usize];
            for axis in 0..3 {
                fill(&mut point[2 * axis], lanes, entered.iter().map(|entry| part(entry).low[axis]));
                fill(&mut point[2 * axis + 1], lanes, entered.iter().map(|entry| part(entry).high[axis]));
            }
            for (plane, numbers) in numbers.iter_mut().zip(&self.numbers) {
                fill(plane, lanes, entered.iter().map(|entry| numbers[entry.row as usize]));
            }
            let inputs: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
            let (mut low, mut high) = (vec![0.0; lanes], vec![0.0; lanes]);
            self.kernel.run(self.kernel.all(), &inputs, &mut [&mut low, &mut high])?;
            for ((&entry, &low), &high) in entered.iter().zip(&low).zip(&high) {
                met(entry, [low, high]);
            }
        }
        Ok(())
    }
}

/// Fills a plane; lanes behind the last number repeat it.
fn fill(plane: &mut Vec<f32>, lanes: usize, numbers: impl Iterator<Item = f32>) {
    plane.clear();
    plane.extend(numbers);
    plane.resize(lanes, plane.last().copied().unwrap_or(0.0));
}
