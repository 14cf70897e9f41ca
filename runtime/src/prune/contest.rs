//! Rows that win nowhere in a box: of the operands of a union or an intersection that are rows, those that
//! another row beats in the whole box.
//!
//! ```text
//! lanes:        each row of the contest with each box that it may matter in      one run of the row's own function
//! union:        best = the largest low end of a box, of the rows of one owner
//!               a row goes if its high end is below best, or equal and behind the row that has it
//! intersection: the same of the negative ranges
//! smooth ones:  a row goes if it is the smaller side of its step by the width, or if a later row is the larger one by it
//! difference:   what is subtracted goes where it cuts nothing, and what is left of where that is cut away   (limit)
//! ```
//!
//! A row that goes is beaten at every point by a row that stays, or equals one that comes before it. So no
//! field, gradient or attribute comes from it, and what is left out changes no bit. Rows that their supports
//! leave out have gone before.
//!
//! The function of a row ([`RowFunction`](jbt_ir::RowFunction)) has the ops of the program, so its range
//! encloses every f32 that engines compute.

use std::sync::OnceLock;

use jbt_ir::{Entity as _, Selection, Table, Tables, watch};
use jbt_lower::prune_info::{ContestGroup, ContestKind, PruneInfo, RowContest, StepFields};
use jbt_model::combine::Extreme;

use super::decide::firsts;
use super::lanes::{MetRow, RowInBox, RowRanges};
use super::limit::{DifferenceLimit, cut};
use super::ranges::ProbeRanges;
use super::winners::WinnerTree;
use crate::boxes::{ANYTHING, Box3, MAX_PARTS, Range};
use crate::compiler::Compiler;
use crate::error::EvalError;
use crate::kernel::BoundKernel;

/// A contest of fewer rows, over the whole model, is not worth a program.
const FEWEST_ROWS: usize = 8;
/// Fewer rows in a box are not looked at.
const FEWEST_IN_BOX: usize = 3;
/// The most contests of a model that have programs: those of the most rows.
const MOST_CONTESTS: usize = 24;
/// The most tables of a contest that have programs, one each: those of the most rows.
const MOST_GROUPS: usize = 64;

/// The contests of a model, with what runs their rows.
pub(super) struct Contests {
    compiler: Compiler,
    /// Those that are worth it.
    all: Vec<ContestRows>,
}

struct ContestRows {
    contest: RowContest,
    /// By group: made when it is first asked for. `None` if no ranges of the rows can be had.
    groups: Vec<OnceLock<Option<RowRanges>>>,
    /// Of the other side of a difference.
    other: OnceLock<Option<RowRanges>>,
    /// By group: made after many questions about small parts.
    trees: Vec<OnceLock<Option<WinnerTree>>>,
}

impl Contests {
    pub(super) fn new(compiler: &Compiler, info: &PruneInfo, tables: &Tables) -> Self {
        let rows = |contest: &RowContest| -> usize {
            contest
                .groups
                .iter()
                .filter(|group| group.rows)
                .map(|group| tables.tables[group.table].len())
                .sum()
        };
        let mut has_probe = vec![false; tables.tables.len()];
        info.decisions.iter().for_each(|decision| has_probe[decision.table.index()] = true);
        let worth = info.contests.iter().filter_map(|contest| worth(contest, &has_probe, tables));
        let mut worth: Vec<RowContest> = worth.filter(|contest| rows(contest) >= FEWEST_ROWS).collect();
        worth.sort_by_key(|contest| std::cmp::Reverse(rows(contest)));
        worth.truncate(MOST_CONTESTS);
        let with_rows = |contest: RowContest| ContestRows {
            groups: contest.groups.iter().map(|_| OnceLock::new()).collect(),
            other: OnceLock::new(),
            trees: contest.groups.iter().map(|_| OnceLock::new()).collect(),
            contest,
        };
        Self { compiler: compiler.clone(), all: worth.into_iter().map(with_rows).collect() }
    }

    /// Whether no contest is worth it.
    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Of all rows of a table of many that meet in a contest, the positions of those that may win in a box,
    /// ascending, by a tree; and the ranges that it took. `None` if there is no tree, or too many may win.
    pub(super) fn winners(
        &self,
        lowered: &BoundKernel,
        table: Table,
        bounds: &Box3,
    ) -> Result<(Option<Vec<u32>>, u64), EvalError> {
        let (all, nothing) = (lowered.all(), (None, 0));
        // The rows of several owners are several contests.
        if all.starts(table).len() != 2 {
            return Ok(nothing);
        }
        for ContestRows { contest, trees, .. } in &self.all {
            let ContestKind::All(start) = contest.kind else { continue };
            let place = contest.groups.iter().position(|group| group.rows && group.table == table);
            let Some(place) = place else { continue };
            let known = trees[place].get();
            let known = known.unwrap_or_else(|| {
                // Made outside of the lock: while it is made, this thread may take work that asks for it.
                let group = &contest.groups[place];
                let made = WinnerTree::new(&self.compiler, lowered, group, all.active(table));
                trees[place].get_or_init(|| made)
            });
            return match known {
                Some(tree) => tree.winners(bounds, (contest.extreme, start)),
                None => Ok(nothing),
            };
        }
        Ok(nothing)
    }

    /// Clears the masks of rows that win nowhere, for each box. `lowered` is the range program, whose rows
    /// the selection selects; `probes` are the ranges of its probes, if they are known. Returns how many
    /// ranges of distances that took.
    pub(super) fn leave_out(
        &self,
        (lowered, info): (&BoundKernel, &PruneInfo),
        (selection, boxes): (&Selection, &[Box3]),
        probes: Option<ProbeRanges<'_>>,
        masks: &mut [u8],
    ) -> Result<u64, EvalError> {
        let mut evaluations = 0;
        if self.all.is_empty() {
            return Ok(evaluations);
        }
        let firsts = firsts(selection);
        for ContestRows { contest, groups, other, .. } in &self.all {
            let operands = |group: &&ContestGroup| group.rows;
            let rows = |group: &ContestGroup| selection.active(group.table).len();
            if contest.groups.iter().filter(operands).map(rows).sum::<usize>() < fewest_in_box(contest) {
                continue;
            }
            let enter = |group| entries(group, selection, &firsts, masks);
            let mut entered: Vec<Vec<RowInBox>> = contest.groups.iter().map(enter).collect();
            leave_few(contest, &mut entered);
            let mut round = ContestRound::default();
            for (index, (group, entered)) in contest.groups.iter().zip(&entered).enumerate() {
                if entered.is_empty() {
                    continue;
                }
                let made = groups[index].get_or_init(|| RowRanges::new(&self.compiler, lowered, group));
                let mut meet = |entry, range| round.meet((contest, info.iso2), index, entry, range);
                match made {
                    Some(ranges) => {
                        evaluations += ranges.distances() * entered.len() as u64;
                        ranges.find(entered, boxes, &mut meet)?;
                    }
                    None => entered.iter().for_each(|&entry| meet(entry, ANYTHING)),
                }
            }
            let limit = match contest.difference {
                None => None,
                Some(difference) => {
                    let made = || {
                        let made =
                            other.get_or_init(|| RowRanges::new(&self.compiler, lowered, &difference.other));
                        made.as_ref()
                    };
                    watch::take(entered.iter().map(|rows| size_of_val(&**rows)).sum());
                    let wanted: Vec<RowInBox> = entered.concat();
                    let mut limit =
                        DifferenceLimit::new((contest, difference, info.iso2), selection, &firsts);
                    evaluations += limit.find((&wanted, boxes), probes, made)?;
                    Some(limit)
                }
            };
            round.finish((contest, info.iso2), (selection, lowered.tables()), (probes, limit), masks);
        }
        Ok(evaluations)
    }
}

/// A contest without the groups that are not worth a program; `None` if it needs those. What has a probe of
/// its own ([`super::decide`]) needs no program: a table of a single row.
fn worth(contest: &RowContest, has_probe: &[bool], tables: &Tables) -> Option<RowContest> {
    let count = |group: &ContestGroup| tables.tables[group.table].len();
    // To the probes, a side of a difference is an operator like any other.
    let is_told =
        |group: &ContestGroup| contest.difference.is_none() && has_probe[group.table.index()] && group.rows;
    let mut groups: Vec<(usize, ContestGroup)> = contest.groups.iter().copied().enumerate().collect();
    match contest.kind {
        // To know what one row does, a step needs all those before it.
        ContestKind::Steps(..) if groups.len() > MOST_GROUPS => return None,
        ContestKind::Steps(..) => {}
        ContestKind::All(_) => {
            groups.retain(|(_, group)| count(group) > 1 || !is_told(group));
            groups.sort_by_key(|(_, group)| std::cmp::Reverse(count(group)));
            groups.truncate(MOST_GROUPS);
            groups.sort_by_key(|&(place, _)| place);
        }
    }
    let groups = groups.into_iter().map(|(_, group)| group).collect();
    Some(RowContest { groups, ..contest.clone() })
}

/// The operands of a group in each box in which they may matter.
fn entries(group: &ContestGroup, selection: &Selection, firsts: &[usize], masks: &[u8]) -> Vec<RowInBox> {
    let (starts, active) = (selection.starts(group.table), selection.active(group.table));
    let first = firsts[group.table.index()];
    let mut entered = Vec::new();
    let mut enter = |owner: u32, position: u32| {
        let place = first + position as usize;
        let mut mask = masks[place];
        while mask != 0 {
            let part = mask.trailing_zeros() as u8;
            mask &= mask - 1;
            let row = active[position as usize];
            watch::take_for(&entered, 1);
            // Selections have fewer than 2^32 rows.
            entered.push(RowInBox { row, place: place as u32, owner, part, stays: !group.rows });
        }
    };
    if group.rows {
        for (owner, range) in (0..).zip(starts.windows(2)) {
            (range[0]..range[1]).for_each(|position| enter(owner, position));
        }
    } else {
        (0..active.len() as u32).for_each(|owner| enter(owner, owner));
    }
    entered
}

/// Fewer rows in a box are not looked at. A single row may be one that a difference does without.
fn fewest_in_box(contest: &RowContest) -> usize {
    if contest.difference.is_some() { 1 } else { FEWEST_IN_BOX }
}

/// Leaves boxes with few operands alone.
fn leave_few(contest: &RowContest, entered: &mut [Vec<RowInBox>]) {
    let mut counts = [0; MAX_PARTS];
    for (_, entered) in contest.groups.iter().zip(&*entered).filter(|(group, _)| group.rows) {
        entered.iter().for_each(|entry| counts[entry.part as usize] += 1);
    }
    for entered in entered {
        entered.retain(|entry| counts[entry.part as usize] >= fewest_in_box(contest));
    }
}

/// One contest in some boxes.
#[derive(Default)]
struct ContestRound {
    met: Vec<MetRow>,
}

impl ContestRound {
    /// An operand with its range comes to the contest.
    fn meet(
        &mut self,
        (contest, iso2): (&RowContest, f32),
        group: usize,
        entry: RowInBox,
        [low, high]: Range,
    ) {
        let [low, high] = match contest.kind {
            // The first group is what is left of.
            ContestKind::Steps(_, _, StepFields::Complements) if group > 0 => {
                [cut(iso2, high), cut(iso2, low)]
            }
            ContestKind::Steps(..) | ContestKind::All(_) => [low, high],
        };
        let [low, high] = match contest.extreme {
            Extreme::Largest => [low, high],
            Extreme::Smallest => [-high, -low],
        };
        watch::take_for(&self.met, 1);
        self.met.push(MetRow { entry, group, low, high });
    }

    /// Clears the masks of rows that win nowhere.
    fn finish(
        mut self,
        (contest, iso2): (&RowContest, f32),
        (selection, tables): (&Selection, &Tables),
        (probes, limit): (Option<ProbeRanges<'_>>, Option<DifferenceLimit<'_>>),
        masks: &mut [u8],
    ) {
        watch::take(size_of_val(&*self.met));
        // In a box, those of one owner in the order of operands.
        self.met.sort_by_key(|met| (met.entry.part, met.entry.owner, met.group, met.entry.place));
        let together =
            |a: &MetRow, b: &MetRow| (a.entry.part, a.entry.owner) == (b.entry.part, b.entry.owner);
        for rows in self.met.chunk_by(together) {
            let RowInBox { part, owner, .. } = rows[0].entry;
            let mut go = |met: &MetRow| {
                if !met.entry.stays {
                    masks[met.entry.place as usize] &= !(1 << part);
                }
            };
            match contest.kind {
                ContestKind::All(start) => {
                    // The range of the operator itself knows more operands than those that are rows.
                    let node = probes.zip(contest.node);
                    let node = node.map(|(probes, node)| probes.range(node, part.into()));
                    let below = node.map_or(f32::NEG_INFINITY, |[low, high]| match contest.extreme {
                        Extreme::Largest => low,
                        Extreme::Smallest => -high,
                    });
                    beaten(rows, start, below).for_each(&mut go);
                    limit.iter().flat_map(|limit| limit.beyond(rows)).for_each(&mut go);
                }
                ContestKind::Steps(table, column, fields) => {
                    let row = selection.active(table)[owner as usize];
                    let width = tables.tables[table].row(row as usize)[column];
                    // A complement that is not below this may be that of nothing, which gives no attributes.
                    let most = match fields {
                        StepFields::Plain => f32::INFINITY,
                        StepFields::Complements => iso2,
                    };
                    passed_over(rows, width.into(), most).for_each(&mut go);
                }
            }
        }
    }
}

/// The rows that win nowhere, of the rows of one owner in a box, where the largest field wins, or `start`.
/// Something is nowhere below `below`.
fn beaten(rows: &[MetRow], start: Option<f32>, below: f32) -> impl Iterator<Item = &MetRow> {
    let (mut ahead, mut leader) = (start.unwrap_or(f32::NEG_INFINITY), None);
    for met in rows {
        if met.low > ahead {
            (ahead, leader) = (met.low, Some((met.group, met.entry.place)));
        }
    }
    rows.iter().filter(move |met| {
        let is_behind = match leader {
            None => start.is_some(),
            // Between groups the order in the file decides.
            Some((group, place)) => group == met.group && place < met.entry.place,
        };
        met.high < ahead || (met.high == ahead && is_behind) || met.high < below
    })
}

/// The rows that change nothing in any step, of the rows of one owner in a box in their order. In a step, the
/// larger side is the result if the sides are apart by `width`. In real numbers the result is at least the
/// largest field so far, and at most that and `width`:
///
/// ```text
/// passed over    a row that is below the largest low end before it by `width`
/// begins anew    a row that is above the largest high end before it by twice `width`: all before it go
/// ```
///
/// Of complements, only one that is below `most` takes the attributes with it: its negative is above `-most`.
fn passed_over(rows: &[MetRow], width: f64, most: f32) -> impl Iterator<Item = &MetRow> {
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    let mut first = 0;
    let mut passed = Vec::with_capacity(rows.len());
    for (index, met) in rows.iter().enumerate() {
        passed.push(f64::from(met.high) + width <= low);
        // Each step may round by half a unit.
        let rounding = f64::from(f32::EPSILON) * (index + 1) as f64 * (high.abs() + 2.0 * width);
        if index > 0 && met.low > -most && f64::from(met.low) >= high + 2.0 * width + rounding {
            first = index;
        }
        low = low.max(met.low.into());
        high = high.max(met.high.into());
    }
    rows.iter().enumerate().filter(move |&(index, _)| passed[index] || index < first).map(|(_, met)| met)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of one owner with these ranges, in a group each if they say so.
    fn rows(ranges: &[(f32, f32, usize)]) -> Vec<MetRow> {
        let met = |(place, &(low, high, group)): (u32, &(f32, f32, usize))| {
            let entry = RowInBox { row: place, place, owner: 0, part: 0, stays: false };
            MetRow { entry, group, low, high }
        };
        (0..).zip(ranges).map(met).collect()
    }

    fn beaten_of(ranges: &[(f32, f32, usize)], start: Option<f32>, below: f32) -> Vec<u32> {
        beaten(&rows(ranges), start, below).map(|met| met.entry.place).collect()
    }

    #[test]
    fn rows_below_the_best_are_beaten() {
        let apart = [(0.0, 1.0, 0), (2.0, 3.0, 0), (1.5, 2.5, 0), (0.0, 1.9, 0)];
        assert_eq!(beaten_of(&apart, None, f32::NEG_INFINITY), [0, 3]);
        assert_eq!(beaten_of(&apart, None, 2.75), [0, 2, 3], "something is above");
        assert_eq!(beaten_of(&apart, Some(4.0), f32::NEG_INFINITY), [0, 1, 2, 3]);
        // Of equal ones the first wins: of rows in their order, of groups in that of the file, which nobody
        // knows here.
        let equal = [(0.0, 1.0, 0), (1.0, 1.0, 0), (0.5, 1.0, 0), (1.0, 1.0, 1)];
        assert_eq!(beaten_of(&equal, None, f32::NEG_INFINITY), [2]);
        assert_eq!(
            beaten_of(&equal, Some(1.0), f32::NEG_INFINITY),
            [0, 1, 2, 3],
            "the start comes before all"
        );
    }

    fn passed_of(ranges: &[(f32, f32)], width: f64, most: f32) -> Vec<u32> {
        let ranges: Vec<_> = ranges.iter().map(|&(low, high)| (low, high, 0)).collect();
        passed_over(&rows(&ranges), width, most).map(|met| met.entry.place).collect()
    }

    #[test]
    fn steps_pass_over_what_is_apart() {
        let any = f32::INFINITY;
        // Below the largest low end so far by the width, or not quite.
        assert_eq!(passed_of(&[(1.0, 1.25), (0.0, 0.5), (0.0, 0.5625)], 0.5, any), [1]);
        assert_eq!(
            passed_of(&[(0.0, 0.5), (1.0, 1.25)], 0.5, any),
            [] as [u32; 0],
            "those before it are not"
        );
        // Above the largest high end so far by twice the width, and by what two steps may round.
        assert_eq!(passed_of(&[(0.0, 1.0), (2.001, 3.0)], 0.5, any), [0]);
        assert_eq!(passed_of(&[(0.0, 1.0), (1.5, 3.0)], 0.5, any), [] as [u32; 0]);
        assert_eq!(passed_of(&[(0.0, 1.0), (2.0_f32.next_up(), 3.0)], 0.5, any), [] as [u32; 0]);
        assert_eq!(passed_of(&[(0.0, 1.0), (0.5, 0.75), (3.0, 4.0), (0.0, 4.0)], 0.5, any), [0, 1]);
        // Complements that are not below iso2 give no attributes.
        assert_eq!(passed_of(&[(-4.0, -3.0), (-1.0, -0.5)], 0.5, 1.0), [] as [u32; 0]);
        assert_eq!(passed_of(&[(-4.0, -3.0), (-0.75, -0.5)], 0.5, 1.0), [0]);
    }
}
