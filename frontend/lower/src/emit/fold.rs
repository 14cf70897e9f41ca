//! Operators and the folds over their groups of operands.

use std::rc::Rc;

use jbt_ir::{Domain as _, Entity, FoldKind, Rule, Schema, Table, Value};

use super::parts::Guard;
use super::{Emitter, OpenRow, Reduce, TableCode, Task};
use crate::columns;
use crate::mixing::{Operator, State, beyond};
use crate::prune_info::DecisionKind;
use crate::recipe::{Lead, Member, Owned, RowPlace, RowPlaces, RowStep};
use crate::shape::{bounded, non_negative};
use jbt_model::attribute::AttributeGroup;
use jbt_model::combine::ReduceCode;

impl Emitter<'_> {
    /// An operator: its accumulators, and what is to be done for its operands.
    pub(super) fn begin_reduce(&mut self, place: RowPlace, code: ReduceCode) {
        let groups = self.shapes.groups(self.at(place).instance());
        let row = self.columns(place, columns::operator(code.columns()));
        let operator = Operator {
            code,
            row,
            iso2: self.iso2.expect("the scene's row is open"),
            non_negative: non_negative(self.scene, groups),
            bounded: bounded(self.scene, groups),
            ordered: groups.len() > 1,
            ranged: self.probes.is_some(),
            moving: self.query.is_differentiated() || self.groups.iter().any(AttributeGroup::turns),
            mixing: Rc::clone(&self.mixing),
        };
        let state = State::new(&mut self.builder, &operator, &self.defaults);
        let guard = Guard::of(code, operator.non_negative);
        self.reduces.push(Reduce {
            operator,
            state,
            order: None,
            extreme: None,
            rows: None,
            groups: Vec::new(),
            open: false,
        });
        self.begin_operator();
        self.tasks.push(Task::FinishReduce);
        for (index, group) in groups.iter().enumerate().rev() {
            if group.folded {
                self.tasks.extend([Task::CloseFold, Task::Meet, Task::Use(RowPlace::ROW)]);
                self.tasks.push(Task::OpenFold(place, index));
            } else {
                for operand in self.lead(Lead::Members(place, index)).rev() {
                    // A step begins with its first operand, which is alone in the first group.
                    let step = match code {
                        ReduceCode::Step(_) if index == 0 => Task::Seed,
                        ReduceCode::Step(_) | ReduceCode::Fold(_) | ReduceCode::Choice(_) => Task::Meet,
                    };
                    self.tasks.extend([step, Task::Operand(operand, guard), Task::Order(operand)]);
                }
            }
        }
    }

    /// The first of the rows that the innermost open row owns.
    fn first(&self, owned: Owned) -> Member {
        match owned {
            Owned::Alone(place) => self.at(place),
            Owned::Members(place, group) => {
                self.at(place).members(self.shapes, group).next().expect("no group is empty")
            }
            Owned::Pieces(place) => Member::Piece(self.at(place).field(self.scene), 0),
        }
    }

    /// Opens a fold over rows that the innermost open row owns.
    pub(super) fn open_fold(
        &mut self,
        owned: Owned,
        kind: (FoldKind, Rule),
        initial: &[Value],
    ) -> Vec<Value> {
        let first = self.first(owned);
        let table = Table::new(self.tables.len());
        self.record(RowStep::Rows(table, owned));
        self.open_table(first.name(self.scene), first, kind, initial)
    }

    /// Opens a fold over a new table, whose first row this is.
    pub(super) fn open_table(
        &mut self,
        name: &str,
        first: Member,
        kind: (FoldKind, Rule),
        initial: &[Value],
    ) -> Vec<Value> {
        let parent = self.rows.last().map(|row| row.table);
        let schema = Schema { name: name.to_owned(), columns: Vec::new(), parent, slots: Vec::new() };
        let table = self.builder.table(schema);
        self.rows.push(OpenRow { table, places: RowPlaces::of(first) });
        let (space, _) = *self.points.last().expect("a space is open");
        let probe = self.probes.as_ref().and_then(|probes| probes.point(space));
        self.tables.push(TableCode { recipe: Vec::new(), depth: self.rows.len(), space, probe });
        self.builder.begin_fold(table, kind, initial)
    }

    /// Opens the fold over the rows of a group.
    pub(super) fn open_group(&mut self, place: RowPlace, group: usize) {
        let mut reduce = self.reduces.pop().expect("folds belong to operators");
        let owned = Owned::Members(place, group);
        let extreme = self.decides_rows(reduce.operator.code, self.first(owned).instance());
        let mut initial = reduce.state.values();
        initial.extend(extreme.map(|extreme| self.builder.constant(beyond(extreme, false))));
        let rule = reduce.operator.rule();
        let mut params = self.open_fold(owned, (FoldKind::Rows, rule), &initial);
        reduce.extreme =
            extreme.map(|extreme| (extreme, params.pop().expect("it is the last that was given")));
        reduce.state.replace(&params);
        reduce.rows = Some(self.row().table);
        self.reduces.push(reduce);
        self.read_order(RowPlace::ROW);
    }

    /// Closes the fold over the rows of a group.
    pub(super) fn close_group(&mut self) {
        let table = self.rows.pop().expect("the fold is open").table;
        let reduce = self.reduces.last_mut().expect("folds belong to operators");
        let mut next = reduce.state.values();
        let extreme = reduce.extreme.take();
        reduce.rows = None;
        next.extend(extreme.map(|(_, value)| value));
        let mut results = self.builder.end_fold(&next);
        if let Some((extreme, _)) = extreme {
            let value = results.pop().expect("it is the last that was carried out");
            self.probe_operand(table, Some(DecisionKind::of(extreme)), value);
        }
        let reduce = self.reduces.last_mut().expect("folds belong to operators");
        reduce.state.replace(&results);
    }
}
