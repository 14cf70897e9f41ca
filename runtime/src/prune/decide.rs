//! Operands that do not decide: where another operand of a union is larger in the whole box, this operand can
//! be left out.

use jbt_ir::{Entity, Selection, Table};
use jbt_lower::prune_info::{DecidedRows, Decision, PruneInfo};

use super::ranges::ProbeRanges;
use crate::boxes::MAX_PARTS;

/// For each table, the index of its first row among all active rows of a selection.
pub(super) fn firsts(selection: &Selection) -> Vec<usize> {
    let mut firsts = vec![0; selection.tables()];
    let mut end = 0;
    for &table in selection.present() {
        firsts[table.index()] = end;
        end += selection.active(table).len();
    }
    firsts
}

/// Clears the masks of rows of operands that do not decide, for each such box. `probes` are the ranges that
/// the interval kernel gave for the boxes, with the rows of the selection.
pub(super) fn leave_out(info: &PruneInfo, probes: ProbeRanges<'_>, selection: &Selection, masks: &mut [u8]) {
    let decisions = || info.decisions.iter().filter(|decision| decision.rows == DecidedRows::All);
    if decisions().next().is_none() {
        return;
    }
    let firsts = firsts(selection);
    for decision in decisions() {
        let rows = selection.active(decision.table).len();
        if rows == 0 {
            continue;
        }
        for box_index in 0..probes.count() {
            // Comparisons with NaN are false, so an operand with an unknown range decides.
            let [operand, node] =
                [decision.operand, decision.node].map(|probe| probes.range(probe, box_index));
            if decision.kind.spares(operand, node, info.iso2) {
                let first = firsts[decision.table.index()];
                masks[first..first + rows].iter_mut().for_each(|mask| *mask &= !(1 << box_index));
            }
        }
    }
}

/// With fewer operands than this, one run with all of them is faster than one run for each.
const FEWEST: usize = 64;
/// The most rows of a table that are run one by one.
pub(super) const MOST_ALONE: usize = 64;
/// The most additional row runs that are allowed: rows that are no operands run in every selection.
const MOST_REPEATED: usize = 512;

/// Operands that are rows of tables, as selections that run one row of each table without the table's other
/// rows.
pub(super) struct Alone<'a> {
    decisions: Vec<&'a Decision>,
    /// For each table, the index of its first row among all active rows of the selection.
    firsts: Vec<usize>,
    /// For each active row of the selection, [`u8::MAX`] if it runs in every selection, else 0.
    always: Vec<u8>,
    /// The largest number of rows of a table.
    most: usize,
}

impl<'a> Alone<'a> {
    /// The selections for an outer selection, if running them is worth it. `is_met`: the rows of a table meet
    /// in a contest, which tells as much.
    pub(super) fn new(
        info: &'a PruneInfo,
        selection: &Selection,
        is_met: impl Fn(Table) -> bool,
    ) -> Option<Self> {
        let rows = |decision: &Decision| selection.active(decision.table).len();
        let (mut decisions, mut free) = (Vec::new(), true);
        for decision in &info.decisions {
            let DecidedRows::Each { free: it } = decision.rows else { continue };
            if (1..=MOST_ALONE).contains(&rows(decision)) && !is_met(decision.table) {
                free &= it;
                decisions.push(decision);
            }
        }
        let most = decisions.iter().map(|decision| rows(decision)).max()?;
        if decisions.iter().map(|decision| rows(decision)).sum::<usize>() < FEWEST {
            return None;
        }
        let places = places(&decisions, selection);
        let firsts = firsts(selection);
        let mut always = Vec::with_capacity(selection.len());
        let mut repeated = 0;
        for (table, place) in places.into_iter().enumerate() {
            let rows = selection.active(Table::new(table)).len();
            let runs = match place {
                TablePlace::Operand => true,
                TablePlace::Above => {
                    repeated += rows;
                    true
                }
                TablePlace::Elsewhere => {
                    repeated += if free { 0 } else { rows };
                    !free
                }
            };
            always.resize(always.len() + rows, if runs { u8::MAX } else { 0 });
        }
        let worth = repeated * most <= selection.len() + MOST_REPEATED;
        worth.then_some(Self { decisions, firsts, always, most })
    }

    /// The first row numbers of runs of [`MAX_PARTS`] selections.
    pub(super) fn runs(&self) -> impl Iterator<Item = usize> + use<> {
        (0..self.most).step_by(MAX_PARTS)
    }

    /// Selections in which one row of each table runs: row `run + part` in the selection at `part`.
    pub(super) fn selections(
        &self,
        selection: &Selection,
        run: usize,
        parts: &mut [Selection; MAX_PARTS],
    ) -> usize {
        let mut masks = self.always.clone();
        for decision in &self.decisions {
            let rows = selection.active(decision.table).len();
            let first = self.firsts[decision.table.index()];
            for (row, mask) in masks[first..first + rows].iter_mut().enumerate() {
                *mask = if row / MAX_PARTS == run / MAX_PARTS { 1 << (row % MAX_PARTS) } else { 0 };
            }
        }
        let count = MAX_PARTS.min(self.most - run);
        let all = u8::MAX >> (MAX_PARTS - count);
        masks.iter_mut().for_each(|mask| *mask &= all);
        selection.narrow(&mut masks, &mut parts[..count]);
        count
    }

    /// Records the boxes in which the rows with this number do not decide, a bit each. `probes` are the
    /// ranges for the whole selection, `alone` the ranges with these rows alone.
    pub(super) fn spare(
        &self,
        (selection, iso2): (&Selection, f32),
        row: usize,
        (probes, alone): (ProbeRanges<'_>, ProbeRanges<'_>),
        spared: &mut [u32],
    ) {
        for decision in &self.decisions {
            if row >= selection.active(decision.table).len() {
                continue;
            }
            let spared = &mut spared[self.firsts[decision.table.index()] + row];
            for box_index in 0..probes.count() {
                let operand = alone.range(decision.operand, box_index);
                let node = probes.range(decision.node, box_index);
                if decision.kind.spares(operand, node, iso2) {
                    *spared |= 1 << box_index;
                }
            }
        }
    }
}

/// The place of a table's rows relative to the operands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum TablePlace {
    /// Operands, or rows below one: they run with the operand.
    Operand,
    /// Rows above operands.
    Above,
    Elsewhere,
}

/// The place of each table.
fn places(decisions: &[&Decision], selection: &Selection) -> Vec<TablePlace> {
    let mut places = vec![TablePlace::Elsewhere; selection.tables()];
    for decision in decisions {
        places[decision.table.index()] = TablePlace::Operand;
    }
    for decision in decisions {
        let mut above = selection.parent(decision.table);
        while let Some(table) = above.filter(|table| places[table.index()] == TablePlace::Elsewhere) {
            places[table.index()] = TablePlace::Above;
            above = selection.parent(table);
        }
    }
    // Tables come after their parents.
    for table in 0..places.len() {
        let above = selection.parent(Table::new(table));
        if above.is_some_and(|above| places[above.index()] == TablePlace::Operand) {
            places[table] = TablePlace::Operand;
        }
    }
    places
}
