//! Guards: folds over one row around what can be left out as a whole.
//!
//! ```text
//! answer of an operand  ->  fold only (start, 0, ...) (): ... yield field, channels, probes     where the row runs: the answer
//!                                                                                               else: the field is `start`
//! ```
//!
//! What a guard starts with is what the operand counts as without its row. For folds, steps and unions
//! without negative operands it is 0: the operand is 0 there, or loses (a product and a blend below zero
//! become 0, as with the row). For other choices and the left side of a difference it is the lowest or
//! highest number, which never wins. It is finite, because a range with an infinite end says nothing.

use jbt_ir::{Domain, FoldKind, Rule, Value};

use super::Emitter;
use super::parts::GuardStart;
use crate::mixing::{Answer, GroupAnswer};
use crate::prune_info::DecisionKind;
use crate::recipe::{Owned, RowPlace};

impl Emitter<'_> {
    pub(super) fn open_guard(&mut self, place: RowPlace, start: GuardStart) {
        let field = self.builder.constant(start.number());
        let is_bare = self.scene.demand.is_bare(self.at(place).instance());
        self.open_only(place, if is_bare { Rule::Never } else { start.rule() }, &[field]);
    }

    /// The answer that has just been computed in the guard's row, as it is seen outside.
    pub(super) fn close_guard(&mut self, decision: Option<DecisionKind>) {
        let answer = self.answers.pop().expect("the operand has been defined");
        let mut next = vec![answer.field];
        for group in &answer.groups {
            next.extend(&group.channels);
            next.extend(group.share);
        }
        let table = self.row().table;
        let mut results = self.close_only(next, 1).into_iter();
        let mut result = || results.next().expect("as many as were carried out");
        let field = result();
        let groups = answer.groups.iter().map(|group| GroupAnswer {
            channels: group.channels.iter().map(|_| result()).collect(),
            share: group.share.map(|_| result()),
            // What the row computes where it runs may be anything.
            numbers: false,
        });
        let groups = groups.collect();
        self.probe_operand(table, decision, field);
        self.answers.push(Answer { field, groups, contest: answer.contest });
    }

    /// Opens a fold over one row, of what stands at a place. It carries out what is given here, and whatever
    /// else it is closed with.
    pub(super) fn open_only(&mut self, place: RowPlace, rule: Rule, initial: &[Value]) {
        self.probe_row();
        self.open_fold(Owned::Alone(place), (FoldKind::Guard, rule), initial);
    }

    /// Closes a fold over one row that was opened with so many values. What it carries out behind these
    /// begins at 0; probes come out too.
    pub(super) fn close_only(&mut self, mut next: Vec<Value>, opened: usize) -> Vec<Value> {
        let wanted = next.len();
        let probes = self.leave_row();
        next.extend(probes.iter().map(|probe| probe.value));
        let zero = self.builder.constant(0.0);
        for _ in opened..next.len() {
            self.builder.add_accumulator(zero);
        }
        self.rows.pop();
        let mut results = self.builder.end_fold(&next);
        self.probe_again(&probes, &results.split_off(wanted));
        results
    }
}
