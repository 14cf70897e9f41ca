//! Operators and the folds over their groups of operands.

use std::rc::Rc;

use jbt_ir::{Domain as _, Entity, FoldKind, Rule, Schema, Value};

use super::parts::Guard;
use super::{Emitter, Reduce, TableCode, Task};
use crate::columns;
use crate::instance::{InstanceId, InstanceKind, SpaceId};
use crate::mixing::{Operator, State, beyond};
use crate::prune_info::{DecidedRows, DecisionKind};
use crate::shape::{bounded, non_negative};
use jbt_model::combine::ReduceCode;
use jbt_model::query::AnswerKind;

impl Emitter<'_> {
    /// An operator: its accumulators, and what is to be done for its operands.
    pub(super) fn begin_reduce(&mut self, id: InstanceId) {
        let instance = self.scene.instance(id);
        let InstanceKind::Reduce { operator, code, .. } = instance.kind else {
            unreachable!("only operators are reduced")
        };
        let groups = self.shapes.groups(id);
        let row = columns::operator(self, self.scene, instance.node, operator, code.columns());
        let operator = Operator {
            code,
            row,
            iso2: self.iso2.expect("the scene's row is open"),
            non_negative: non_negative(self.scene, groups),
            bounded: bounded(self.scene, groups),
            ordered: groups.len() > 1,
            moving: self.query.contains(AnswerKind::Gradient),
            mixing: Rc::clone(&self.mixing),
        };
        let state = State::new(&mut self.builder, &operator, &self.defaults);
        let guard = Guard::of(code, operator.non_negative);
        self.reduces.push(Reduce { operator, state, order: None, extreme: None, open: false });
        self.begin_operator();
        self.tasks.push(Task::FinishReduce);
        for group in groups.iter().rev() {
            if group.folded {
                self.tasks.extend([Task::CloseFold, Task::Step, Task::Use(group.members[0].0)]);
                self.tasks.push(Task::OpenFold);
            } else {
                for &(member, order) in group.members.iter().rev() {
                    // A step begins with its first operand.
                    let step = match code {
                        ReduceCode::Step(_) if order == 0 => Task::Seed,
                        ReduceCode::Step(_) | ReduceCode::Fold(_) | ReduceCode::Choice(_) => Task::Step,
                    };
                    self.tasks.extend([step, Task::Operand(member, guard), Task::Order]);
                }
            }
        }
    }

    /// Opens a fold over a new table under the innermost open row.
    pub(super) fn open_fold(
        &mut self,
        name: &str,
        space: SpaceId,
        kind: (FoldKind, Rule),
        initial: &[Value],
    ) -> Vec<Value> {
        let parent = self.rows.last().copied();
        let schema = Schema { name: name.to_owned(), columns: Vec::new(), parent, slots: Vec::new() };
        let table = self.builder.table(schema);
        if let Some(parent) = parent {
            self.tables[parent.index()].children.push(table);
        }
        self.rows.push(table);
        let probe = self.probes.as_ref().and_then(|probes| probes.point(space));
        self.tables.push(TableCode { children: Vec::new(), depth: self.rows.len(), space, probe });
        self.builder.begin_fold(table, kind, initial)
    }

    /// Opens the fold over the rows of a group; its first task gives the group its name.
    pub(super) fn open_group(&mut self) {
        let mut reduce = self.reduces.pop().expect("folds belong to operators");
        let Some(&Task::Use(member)) = self.tasks.last() else {
            unreachable!("the first member is used next")
        };
        let name = self.group_name(member);
        let extreme = self.decides_rows(reduce.operator.code, member);
        let mut initial = reduce.state.values();
        initial.extend(extreme.map(|extreme| self.builder.constant(beyond(extreme, false))));
        let rule = reduce.operator.code.rule(reduce.operator.non_negative);
        let (space, _) = *self.points.last().expect("a space is open");
        let mut params = self.open_fold(&name, space, (FoldKind::Rows, rule), &initial);
        reduce.extreme =
            extreme.map(|extreme| (extreme, params.pop().expect("it is the last that was given")));
        reduce.state.replace(&params);
        self.reduces.push(reduce);
        self.read_order();
    }

    /// Closes the fold over the rows of a group.
    pub(super) fn close_group(&mut self) {
        let table = self.rows.pop().expect("the fold is open");
        let reduce = self.reduces.last_mut().expect("folds belong to operators");
        let mut next = reduce.state.values();
        let extreme = reduce.extreme.take();
        next.extend(extreme.map(|(_, value)| value));
        let mut results = self.builder.end_fold(&next);
        if let Some((extreme, _)) = extreme {
            let value = results.pop().expect("it is the last that was carried out");
            let rows = DecidedRows::Each { free: self.is_free() };
            self.probe_operand(table, rows, Some(DecisionKind::of(extreme)), value);
        }
        let reduce = self.reduces.last_mut().expect("folds belong to operators");
        reduce.state.replace(&results);
    }

    /// The name of a table whose first row is this.
    pub(super) fn group_name(&self, id: InstanceId) -> String {
        match &self.scene.instance(id).kind {
            InstanceKind::Leaf { field, .. } => self.scene.field(*field).code.skeleton.name().to_owned(),
            InstanceKind::Warp { .. } => self.scene.warp(self.scene.instance(id).node).name().to_owned(),
            InstanceKind::Difference { .. } => "difference".to_owned(),
            InstanceKind::Map { .. } => self.scene.combinator(self.scene.instance(id).node).name().to_owned(),
            InstanceKind::Expression { .. } => "expression".to_owned(),
            InstanceKind::Select { .. } => "select".to_owned(),
            InstanceKind::Reduce { operator, .. } => operator.name().to_owned(),
        }
    }
}
