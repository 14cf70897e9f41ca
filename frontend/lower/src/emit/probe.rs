//! Probes: numbers of a point that the range function carries out of its folds.
//!
//! A probe is one number for a point, so it can only be taken where no fold over several rows is open: in the
//! row of the scene and in the rows of guards in it. It comes out of each of these folds as one more
//! accumulator, which begins at 0.

use jbt_ir::{Table, Value};

use super::parts::{Operand, Probe, Probes};
use super::{Emitter, TableCode};
use crate::instance::{InstanceId, SpaceId};
use crate::mixing::Answer;
use crate::prune_info::{
    ContestDifference, ContestGroup, Decision, DecisionKind, DifferenceSide, RowContest,
};
use jbt_model::combine::{Extreme, ReduceCode};

impl Probes {
    /// The first of the three probes of the point in a space.
    pub(super) fn point(&self, space: SpaceId) -> Option<usize> {
        self.points.get(&space).copied()
    }

    fn take(&mut self, value: Value) -> usize {
        let name = self.count;
        self.count += 1;
        self.open.last_mut().expect("a row is open").push(Probe { name, value });
        name
    }

    /// The operator with this field is done. Returns its probe, if one is wanted.
    fn end(&mut self, field: Value) -> Option<usize> {
        let first = self.outer.pop().expect("the operator has begun");
        if self.operands.len() == first {
            return None;
        }
        let node = self.take(field);
        for Operand { table, kind, name } in self.operands.split_off(first) {
            self.decisions.push(Decision { table, operand: name, node, kind });
        }
        Some(node)
    }

    /// Makes outputs of the probes that somebody uses, and gives them their final names in the tables,
    /// decisions and contests.
    pub(super) fn finish(
        self,
        outputs: &mut Vec<(String, Value)>,
        tables: &mut [TableCode],
    ) -> (Vec<Decision>, Vec<RowContest>) {
        let mut used = vec![false; self.count];
        for first in tables.iter().filter_map(|table| table.probe) {
            used[first..first + 3].fill(true);
        }
        for decision in &self.decisions {
            used[decision.operand] = true;
            used[decision.node] = true;
        }
        let mut values: Vec<Option<Value>> = vec![None; self.count];
        for contest in &self.contests {
            let nodes = [contest.node, contest.difference.and_then(|difference| difference.node)];
            nodes.into_iter().flatten().for_each(|node| used[node] = true);
        }
        for probe in &self.results {
            values[probe.name] = Some(probe.value);
        }
        let mut names = vec![0; self.count];
        let before = outputs.len();
        for (name, value) in values.into_iter().enumerate().filter(|&(name, _)| used[name]) {
            names[name] = outputs.len() - before;
            let value = value.expect("every probe comes out of the scene's row");
            outputs.push((format!("probe{}", names[name]), value));
        }
        for probe in tables.iter_mut().filter_map(|table| table.probe.as_mut()) {
            *probe = names[*probe];
        }
        let rename = |decision: Decision| Decision {
            operand: names[decision.operand],
            node: names[decision.node],
            ..decision
        };
        let name = |node: Option<usize>| node.map(|node| names[node]);
        let contest = |contest: RowContest| RowContest {
            node: name(contest.node),
            difference: contest.difference.map(|it| ContestDifference { node: name(it.node), ..it }),
            ..contest
        };
        let contests = self.contests.into_iter().map(contest).collect();
        (self.decisions.into_iter().map(rename).collect(), contests)
    }
}

impl Emitter<'_> {
    /// The probes, if there are any in this function and one could be taken here.
    fn probes_here(&mut self) -> Option<&mut Probes> {
        let rows = self.rows.len();
        self.probes.as_mut().filter(|probes| probes.open.len() == rows)
    }

    /// The row of the scene or of a guard is about to be opened.
    pub(super) fn probe_row(&mut self) {
        if let Some(probes) = self.probes_here() {
            probes.open.push(Vec::new());
        }
    }

    /// The probes in the row of a scene or guard that is about to be closed.
    pub(super) fn leave_row(&mut self) -> Vec<Probe> {
        self.probes_here().and_then(|probes| probes.open.pop()).unwrap_or_default()
    }

    /// The probes in a row that has been closed, as they are seen outside.
    pub(super) fn probe_again(&mut self, inner: &[Probe], results: &[Value]) {
        let Some(probes) = &mut self.probes else { return };
        let outer = probes.open.last_mut().unwrap_or(&mut probes.results);
        outer.extend(inner.iter().zip(results).map(|(probe, &value)| Probe { value, ..*probe }));
    }

    /// The point in a space.
    pub(super) fn probe_point(&mut self, space: SpaceId, point: [Value; 3]) {
        if let Some(probes) = self.probes_here() {
            let first = point.map(|coordinate| probes.take(coordinate))[0];
            probes.points.insert(space, first);
        }
    }

    /// The operands of an operator come next.
    pub(super) fn begin_operator(&mut self) {
        if let Some(probes) = &mut self.probes {
            probes.outer.push(probes.operands.len());
        }
    }

    /// The field of an operand that a guard has carried out, or of the operands that are the rows of a table.
    pub(super) fn probe_operand(&mut self, table: Table, decision: Option<DecisionKind>, field: Value) {
        if let (Some(kind), Some(probes)) = (decision, self.probes_here()) {
            let name = probes.take(field);
            probes.operands.push(Operand { table, kind, name });
        }
    }

    /// What to keep of operands that are about to become rows, so that they may be left out while they are
    /// not zero. Supports say nothing about formulas; of other rows they say enough.
    pub(super) fn decides_rows(&mut self, code: ReduceCode, member: InstanceId) -> Option<Extreme> {
        let extreme = match code {
            ReduceCode::Choice(extreme) => extreme,
            ReduceCode::Fold(_) | ReduceCode::Step(_) => return None,
        };
        (self.shapes.holds_formulas(member) && self.probes_here().is_some()).then_some(extreme)
    }

    /// The field of the operator whose operands have been met, and the rows of which one has won, if there
    /// are any.
    ///
    /// Returns the contest's number.
    pub(super) fn end_operator(&mut self, field: Value, contest: Option<RowContest>) -> Option<usize> {
        let probes = self.probes.as_mut()?;
        let node = probes.end(field);
        let contest = contest?;
        probes.contests.push(RowContest { node, ..contest });
        Some(probes.contests.len() - 1)
    }

    /// The field of a difference, whose sides have been met.
    pub(super) fn end_difference(&mut self, field: Value, [left, right]: [&Answer; 2]) {
        let Some(probes) = &mut self.probes else { return };
        let node = probes.end(field);
        let sides = [(DifferenceSide::Left, left, right), (DifferenceSide::Right, right, left)];
        if sides.iter().all(|(_, this, _)| this.contest.is_none()) {
            return;
        }
        let node = node.or_else(|| self.probes_here().map(|probes| probes.take(field)));
        let table = self.row().table;
        let Some(probes) = &mut self.probes else { return };
        for (side, this, other) in sides {
            let Some(contest) = this.contest else { continue };
            let other = ContestGroup { table, field: other.field, rows: false };
            probes.contests[contest].difference = Some(ContestDifference { side, other, node });
        }
    }
}
