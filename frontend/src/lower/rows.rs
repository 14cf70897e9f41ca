//! The numbers of a scene: for every row, what its code asks for, in the order in which it asks.
//!
//! This goes through the occurrences as [`super::emit`] does, but through all members of a group and not the first alone, and writes
//! numbers where that declares columns. Numbers are derived in f64 and rounded once.

use jbt_ir::{Entity, Rows, Store, Table, Tables};

use super::emit::{Code, groups};
use super::mixing::wants_order;
use super::occurrence::{FieldId, LeafField, OccurrenceId, OccurrenceKind, Reducer, Scene, SpaceId};
use super::position::MapKind;
use super::shape::{Lift, ReducerCode, Shapes};
use crate::attribute::Mixing;
use crate::check::NodeId;
use crate::diagnostic::Diagnostic;
use crate::query::Query;
use crate::tree::NodeKind;

/// The numbers, and what they belong to.
pub(super) struct Written {
    pub(super) tables: Tables,
    /// The occurrence behind each row of each table.
    pub(super) members: Vec<Vec<OccurrenceId>>,
}

/// Writes the numbers.
pub(super) fn rows(
    scene: &Scene<'_>,
    shapes: &Shapes,
    query: Query,
    code: &Code,
) -> Result<Written, Vec<Diagnostic>> {
    let mut writer = Writer::new(scene, shapes, query, code);
    for table in code.function.tables.keys() {
        for row in 0..writer.members[table.index()].len() {
            writer.row(table, row);
        }
        let columns = code.function.tables[table].columns.len();
        assert_eq!(
            writer.tables[table.index()].numbers.len(),
            columns * writer.members[table.index()].len(),
            "rows and code agree on the columns of {table}"
        );
    }
    if !writer.errors.is_empty() {
        return Err(writer.errors);
    }
    let mut tables = Store::new();
    for rows in writer.tables {
        tables.push(rows);
    }
    let occurrences = |members: Vec<Member>| members.into_iter().map(|member| member.occurrence).collect();
    let members = writer.members.into_iter().map(occurrences).collect();
    Ok(Written { tables: Tables { tables }, members })
}

/// What is behind a row.
#[derive(Clone, Copy)]
struct Member {
    occurrence: OccurrenceId,
    /// Its place in the order of its operator, where that is a column.
    order: Option<u32>,
}

enum Task {
    Use(OccurrenceId),
    Define(OccurrenceId),
    Order(u32),
    LiftField(FieldId),
    LiftSpace(SpaceId),
    /// The members of a folded group become rows of the next child table.
    Rows(OccurrenceId, usize),
    /// An operand that is written out: the row of the next child table, if it has a guard.
    Operand(OccurrenceId),
    /// Under a guard: the row of the next child table.
    Guard(OccurrenceId),
}

struct Writer<'a> {
    scene: &'a Scene<'a>,
    shapes: &'a Shapes,
    code: &'a Code,
    query: Query,
    mixing: Vec<Mixing>,
    tables: Vec<Rows>,
    /// By table and row.
    members: Vec<Vec<Member>>,
    errors: Vec<Diagnostic>,
    row: Vec<f64>,
    nodes: Vec<u32>,
    /// Empty between rows.
    tasks: Vec<Task>,
}

impl<'a> Writer<'a> {
    fn new(scene: &'a Scene<'a>, shapes: &'a Shapes, query: Query, code: &'a Code) -> Self {
        let count = code.function.tables.len();
        let mut tables = vec![Rows::default(); count];
        for (rows, schema) in tables.iter_mut().zip(code.function.tables.values()) {
            rows.stride = schema.columns.len();
            rows.starts.push(0);
        }
        let mut members = vec![Vec::new(); count];
        members[0].push(Member { occurrence: scene.root, order: None });
        tables[0].active.push(0);
        tables[0].starts.push(1);
        let attributes = &scene.tree.attributes()[..groups(scene.tree, query)];
        let mixing = attributes.iter().map(|group| group.mixing).collect();
        Self {
            scene,
            shapes,
            code,
            query,
            mixing,
            tables,
            members,
            errors: Vec::new(),
            row: Vec::new(),
            nodes: Vec::new(),
            tasks: Vec::new(),
        }
    }

    /// Writes one row, and hands the rows of the tables under it out.
    fn row(&mut self, table: Table, index: usize) {
        let Member { occurrence: member, order } = self.members[table.index()][index];
        let mut tasks = std::mem::take(&mut self.tasks);
        let depth = self.code.tables[table.index()].depth;
        tasks.push(Task::Define(member));
        if table.index() == 0 {
            self.start(depth, &mut tasks);
        }
        if let Some(order) = order {
            self.row.push(f64::from(order));
        }
        let mut children = self.code.tables[table.index()].children.iter();
        let mut child = || *children.next().expect("the code has a table for each folded group and guard");
        while let Some(task) = tasks.pop() {
            match task {
                // It is computed where it is lifted to.
                Task::Use(id) if self.scene.occurrence(id).uses > 1 => {}
                Task::Use(id) | Task::Define(id) => self.define(id, depth, &mut tasks),
                Task::Order(order) => self.row.push(f64::from(order)),
                Task::LiftField(field) => self.leaf(field),
                Task::LiftSpace(space) => self.enter_warp(space, depth, &mut tasks),
                Task::Rows(id, group) => self.hand_out(child(), id, group),
                Task::Operand(id) => {
                    let guarded = self.shapes.guards_operand(self.scene, id, depth);
                    tasks.push(if guarded { Task::Guard(id) } else { Task::Use(id) });
                }
                Task::Guard(occurrence) => self.own(child(), &[Member { occurrence, order: None }]),
            }
        }
        self.tasks = tasks;
        self.flush(table, member);
    }

    /// The numbers of the scene itself.
    fn start(&mut self, depth: usize, tasks: &mut Vec<Task>) {
        self.row.push(2.0 * self.scene.tree.iso());
        for group in &self.scene.tree.attributes()[..self.mixing.len()] {
            self.row.extend(&group.default);
        }
        self.enter_space(SpaceId(0), depth, tasks);
    }

    fn enter_warp(&mut self, space: SpaceId, depth: usize, tasks: &mut Vec<Task>) {
        let inside = self.scene.inside(space).expect("the world is no warp's inside");
        let map = self.scene.position(inside.position).map;
        MapKind::of(&map).push_columns(&map, &mut self.row);
        self.scene.warp(inside.warp).columns(&mut self.row);
        self.enter_space(space, depth, tasks);
    }

    fn enter_space(&self, space: SpaceId, depth: usize, tasks: &mut Vec<Task>) {
        for lift in self.shapes.lifts(space).iter().rev() {
            tasks.push(match lift {
                Lift::Field(field) => Task::LiftField(*field),
                Lift::Space(space) => Task::LiftSpace(*space),
                Lift::Occurrence(id) if self.shapes.guards_lift(*id, depth) => Task::Guard(*id),
                Lift::Occurrence(id) => Task::Define(*id),
            });
        }
    }

    fn define(&mut self, id: OccurrenceId, depth: usize, tasks: &mut Vec<Task>) {
        let occurrence = self.scene.occurrence(id);
        match &occurrence.kind {
            OccurrenceKind::Leaf { field, bindings } => {
                if self.scene.field(*field).uses == 1 {
                    self.leaf(*field);
                }
                let bindings = self.scene.bindings(*bindings);
                for (group, binding) in self.scene.tree.attributes()[..self.mixing.len()].iter().zip(bindings)
                {
                    self.row.extend(binding.map_or(&group.default[..], |node| self.attribute(node)));
                }
            }
            OccurrenceKind::Warp { inside, child, .. } => {
                tasks.push(Task::Use(*child));
                if !self.scene.is_shared(*inside) {
                    self.enter_warp(*inside, depth, tasks);
                }
            }
            OccurrenceKind::Difference { left, right } => {
                tasks.extend([Task::Operand(*right), Task::Operand(*left)]);
            }
            OccurrenceKind::Reduce { reducer, .. } => {
                let code = ReducerCode::of(*reducer);
                if let (Reducer::Ricci(n), ReducerCode::RicciGeneral) = (reducer, code) {
                    self.row.extend([*n, 1.0 / n]);
                }
                let groups = self.shapes.groups(id);
                let ordered = wants_order(code, groups.len() > 1, self.query.gradient, &self.mixing);
                for (index, group) in groups.iter().enumerate().rev() {
                    if group.folded {
                        tasks.push(Task::Rows(id, index));
                        continue;
                    }
                    for &(member, order) in group.members.iter().rev() {
                        tasks.push(Task::Operand(member));
                        if ordered {
                            tasks.push(Task::Order(order));
                        }
                    }
                }
            }
        }
    }

    /// Makes the members of a group rows of `child`, owned by the row in progress.
    fn hand_out(&mut self, child: Table, id: OccurrenceId, group: usize) {
        let OccurrenceKind::Reduce { reducer, .. } = &self.scene.occurrence(id).kind else {
            unreachable!("only operators have groups")
        };
        let groups = self.shapes.groups(id);
        let ordered =
            wants_order(ReducerCode::of(*reducer), groups.len() > 1, self.query.gradient, &self.mixing);
        let member = |&(occurrence, order)| Member { occurrence, order: ordered.then_some(order) };
        let members: Vec<Member> = groups[group].members.iter().map(member).collect();
        self.own(child, &members);
    }

    /// These are the rows of `child` that the row in progress owns.
    fn own(&mut self, child: Table, owned: &[Member]) {
        let (rows, members) = (&mut self.tables[child.index()], &mut self.members[child.index()]);
        rows.active.extend((members.len()..members.len() + owned.len()).map(|row| row as u32));
        members.extend(owned);
        rows.starts.push(rows.active.len() as u32);
    }

    fn leaf(&mut self, field: FieldId) {
        self.nodes.push(self.scene.field(field).node.0);
        let primitive = self.scene.primitive(field);
        let LeafField { map, scale, .. } = self.scene.field(field);
        MapKind::of_leaf(map).push_columns(map, &mut self.row);
        primitive.skeleton.columns(*scale, &mut self.row);
        self.row.push(-(scale * primitive.radius).powi(-2));
        if primitive.strength != 1.0 {
            self.row.push(primitive.strength);
        }
    }

    fn attribute(&self, node: NodeId) -> &'a [f64] {
        match &self.scene.tree.node(node).kind {
            NodeKind::Attribute { values, .. } => values,
            NodeKind::Primitive(_) | NodeKind::Combine(_) | NodeKind::Affine(_) | NodeKind::Warp(_) => {
                unreachable!("bindings name attribute nodes")
            }
        }
    }

    /// Rounds the row and appends it to its table.
    fn flush(&mut self, table: Table, member: OccurrenceId) {
        let rows = &mut self.tables[table.index()];
        rows.count += 1;
        rows.nodes.append(&mut self.nodes);
        for number in self.row.drain(..) {
            let rounded = number as f32;
            if !rounded.is_finite() && self.errors.len() < jbt_ir::limits::MAX_ERRORS {
                let node = self.scene.tree.node(self.scene.occurrence(member).node);
                let message = format!("a number derived from this part leaves the range of f32: {number:e}");
                let help = "the part is too small, too large or too far away once all transforms are applied";
                self.errors.push(Diagnostic::error(node.span, message).expected(help));
            }
            rows.numbers.push(rounded);
        }
    }
}
