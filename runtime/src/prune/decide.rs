//! Operands that do not decide: in a box where another operand of a union is larger everywhere, this one need
//! not be known.

use jbt_ir::{Entity, Selection, Table};
use jbt_lower::guide::{DecidedRows, Decision, Guide};

use super::ranges::Probes;
use crate::region::MAX_PARTS;

/// Where the rows of each table that is present begin among all active rows of a selection.
pub(super) fn firsts(selection: &Selection) -> Vec<usize> {
    let mut firsts = vec![0; selection.tables()];
    let mut end = 0;
    for &table in selection.present() {
        firsts[table.index()] = end;
        end += selection.active(table).len();
    }
    firsts
}

/// Takes the rows of operands that do not decide out of the masks, for each box where that is so. `probes`
/// are what the interval kernel gave for the boxes with the rows of the selection.
pub(super) fn leave_out(guide: &Guide, probes: Probes<'_>, selection: &Selection, masks: &mut [u8]) {
    let decisions = || guide.decisions.iter().filter(|decision| decision.rows == DecidedRows::All);
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
            // Comparisons with what is no number are false, so whatever is not known decides.
            let [operand, node] =
                [decision.operand, decision.node].map(|probe| probes.range(probe, box_index));
            if decision.kind.spares(operand, node, guide.iso2) {
                let first = firsts[decision.table.index()];
                masks[first..first + rows].iter_mut().for_each(|mask| *mask &= !(1 << box_index));
            }
        }
    }
}

/// Fewer operands than this run together faster than one by one.
const FEWEST: usize = 64;
/// The most rows of a table that are run one by one.
const MOST_ALONE: usize = 64;
/// How many rows more than there are may run in all, because those that are no operands run every time.
const MOST_REPEATED: usize = 512;

/// Operands that are rows of tables, as selections that run each of them without the others of its table.
pub(super) struct Alone<'a> {
    decisions: Vec<&'a Decision>,
    /// Where the rows of each table begin among all active rows of the selection.
    firsts: Vec<usize>,
    /// Of each active row of the selection, [`u8::MAX`] if it runs every time, 0 if not.
    always: Vec<u8>,
    /// The most rows of a table.
    most: usize,
}

impl<'a> Alone<'a> {
    /// Those of a selection, if running them is worth it.
    pub(super) fn new(guide: &'a Guide, selection: &Selection) -> Option<Self> {
        let rows = |decision: &Decision| selection.active(decision.table).len();
        let (mut decisions, mut free) = (Vec::new(), true);
        for decision in &guide.decisions {
            let DecidedRows::Each { free: it } = decision.rows else { continue };
            if (1..=MOST_ALONE).contains(&rows(decision)) {
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
                Place::Operand => true,
                Place::Above => {
                    repeated += rows;
                    true
                }
                Place::Elsewhere => {
                    repeated += if free { 0 } else { rows };
                    !free
                }
            };
            always.resize(always.len() + rows, if runs { u8::MAX } else { 0 });
        }
        let worth = repeated * most <= selection.len() + MOST_REPEATED;
        worth.then_some(Self { decisions, firsts, always, most })
    }

    /// Numbers of the rows that begin a run of [`MAX_PARTS`] selections.
    pub(super) fn runs(&self) -> impl Iterator<Item = usize> + use<> {
        (0..self.most).step_by(MAX_PARTS)
    }

    /// Selections in which of each table one row runs: of the selection at `part`, the one at `run + part`.
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

    /// Notes the boxes in which the rows at this number do not decide, a bit each. `probes` are what the
    /// interval kernel gave for the whole selection, and `alone` for these rows alone.
    pub(super) fn spare(
        &self,
        (selection, iso2): (&Selection, f32),
        row: usize,
        (probes, alone): (Probes<'_>, Probes<'_>),
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

/// What the rows of a table are to the operands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// Operands, or rows under one: they run with it.
    Operand,
    /// What operands hang under.
    Above,
    Elsewhere,
}

/// That of each table.
fn places(decisions: &[&Decision], selection: &Selection) -> Vec<Place> {
    let mut places = vec![Place::Elsewhere; selection.tables()];
    for decision in decisions {
        places[decision.table.index()] = Place::Operand;
    }
    for decision in decisions {
        let mut above = selection.parent(decision.table);
        while let Some(table) = above.filter(|table| places[table.index()] == Place::Elsewhere) {
            places[table.index()] = Place::Above;
            above = selection.parent(table);
        }
    }
    // Tables come after those that own them.
    for table in 0..places.len() {
        let above = selection.parent(Table::new(table));
        if above.is_some_and(|above| places[above.index()] == Place::Operand) {
            places[table] = Place::Operand;
        }
    }
    places
}
