//! Operands that do not decide: in a box where another operand of a union is larger everywhere, this one need not be known.

use jbt_frontend::lower::guide::{Decision, Guide};
use jbt_ir::{Entity, Selection, Table};

use crate::region::{MAX_PARTS, Range};

/// Takes the rows of operands that do not decide out of the masks, for each box where that is so. `probes` are what the interval kernel
/// gave for `count` boxes with the rows of the selection.
pub(super) fn leave_out(
    guide: &Guide,
    probes: &[[f32; MAX_PARTS]],
    count: usize,
    selection: &Selection,
    masks: &mut [u8],
) {
    if guide.decisions.is_empty() {
        return;
    }
    let mut firsts = Vec::with_capacity(selection.tables());
    let mut first = 0;
    for table in 0..selection.tables() {
        firsts.push(first);
        first += selection.active(Table::new(table)).len();
    }
    for decision in &guide.decisions {
        let rows = selection.active(decision.table).len();
        for box_index in 0..count {
            if spares(decision, guide.iso2, probes, box_index) {
                let first = firsts[decision.table.index()];
                masks[first..first + rows].iter_mut().for_each(|mask| *mask &= !(1 << box_index));
            }
        }
    }
}

/// Whether an operand does not decide in a box. Comparisons with what is no number are false, so whatever is not known decides.
fn spares(decision: &Decision, iso2: f32, probes: &[[f32; MAX_PARTS]], box_index: usize) -> bool {
    // The field's own range comes before those of the probes.
    let range = |probe: usize| -> Range { [0, 1].map(|end| probes[2 * (1 + probe) + end][box_index]) };
    decision.kind.spares(range(decision.operand), range(decision.node), iso2)
}
