//! Operands that do not decide: where another operand of a union is larger in the whole box, this operand can
//! be left out. One run of the range program tells it of all operands that have probes.

use jbt_ir::{Entity as _, Selection};
use jbt_lower::prune_info::PruneInfo;

use super::ranges::ProbeRanges;

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
    if info.decisions.is_empty() {
        return;
    }
    let firsts = firsts(selection);
    for decision in &info.decisions {
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
