//! The numbers of a scene: for every row, what its code asks for, in the order in which it asks.
//!
//! This goes through the instances as [`super::emit`] does, but through all members of a group and not the
//! first alone, and writes numbers where that declares columns. Numbers are derived in f64 and rounded once.

use glam::DVec3;
use jbt_ir::{Entity, Rows, Store, Table, Tables};

use super::columns::{self, Scribe};
use super::computed::{self, ComputedValue};
use super::emit::{Code, groups};
use super::instance::{BindingsId, FieldId, InstanceId, InstanceKind, LeafField, Scene, SpaceId};
use super::mixing::wants_order;
use super::names::ComputedId;
use super::shape::{Hoist, Shapes};
use jbt_model::attribute::{AttributeGroup, AttributeValue, Mixing, Textured};
use jbt_model::check::NodeId;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::query::{AnswerKind, Query};

/// The numbers, and what they belong to.
pub(super) struct Written {
    pub(super) tables: Tables,
    /// What is behind each row of each table.
    pub(super) members: Vec<Vec<Member>>,
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
        // Pieces have been written with their leaves.
        for row in writer.tables[table.index()].count..writer.members[table.index()].len() {
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
    Ok(Written { tables: Tables { tables }, members: writer.members })
}

enum Task {
    Use(InstanceId),
    Define(InstanceId),
    Order(u32),
    Hoist(Hoist),
    /// The members of a folded group become rows of the next child table.
    Rows(InstanceId, usize),
    /// The numbers of a formula, behind those of its children.
    Express(InstanceId),
    /// An operand that is written out: the row of the next child table, if it has a guard.
    Operand(InstanceId),
    /// One row of the next child table, active or not.
    Guard(Member, bool),
}

/// What is behind a row.
#[derive(Clone, Copy)]
pub(super) enum Member {
    /// What stands here: the scene, an operand, or a selector's child. And its place in the order of its
    /// operator, where that is a column.
    Operand(InstanceId, Option<u32>),
    /// What is hoisted and has a guard.
    Hoisted(Hoist),
    /// A piece of a leaf's skeleton, by its place among them.
    Piece(FieldId, u32),
}

impl Member {
    /// The tree node whose numbers stand in the row.
    pub(super) fn node(self, scene: &Scene<'_>) -> NodeId {
        match self {
            Self::Operand(id, _) | Self::Hoisted(Hoist::Instance(id)) => scene.instance(id).node,
            Self::Hoisted(Hoist::Field(field)) | Self::Piece(field, _) => scene.field(field).node,
            Self::Hoisted(Hoist::Computed(id)) => scene.computed(id).node,
            Self::Hoisted(Hoist::Space(space)) => scene.inside(space).expect("the world is not hoisted").warp,
        }
    }
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
    /// The table of the row in progress, and whether it is the first one there.
    table: Table,
    is_first: bool,
    row: Vec<f64>,
    /// The tables under the row in progress, the next one last.
    children: Vec<Table>,
    nodes: Vec<u32>,
    /// Empty between rows.
    tasks: Vec<Task>,
}

/// Numbers are pushed behind those of the row in progress.
impl Scribe for Writer<'_> {
    type Row = ();

    fn columns<N: AsRef<str>>(
        &mut self,
        names: impl IntoIterator<Item = N>,
        numbers: impl FnOnce(&mut Vec<f64>),
    ) {
        let before = self.row.len();
        numbers(&mut self.row);
        if self.is_first {
            // The other rows of a table have the same shape.
            let declared = &self.code.function.tables[self.table].columns[before..self.row.len()];
            assert!(
                declared
                    .iter()
                    .map(String::as_str)
                    .eq(names.into_iter().map(|name| name.as_ref().to_owned())),
                "code declares {declared:?} where rows have other numbers"
            );
        }
    }
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
        members[0].push(Member::Operand(scene.root, None));
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
            table: Table::new(0),
            is_first: true,
            row: Vec::new(),
            children: Vec::new(),
            nodes: Vec::new(),
            tasks: Vec::new(),
        }
    }

    /// Writes one row, and hands the rows of the tables under it out.
    fn row(&mut self, table: Table, index: usize) {
        let member = self.members[table.index()][index];
        let mut tasks = std::mem::take(&mut self.tasks);
        let depth = self.code.tables[table.index()].depth;
        (self.table, self.is_first) = (table, index == 0);
        self.children.clear();
        self.children.extend(self.code.tables[table.index()].children.iter().rev());
        match member {
            Member::Operand(member, order) => {
                tasks.push(Task::Use(member));
                if let Some(order) = order {
                    columns::order(self, order);
                }
            }
            Member::Hoisted(Hoist::Field(field)) => self.leaf(field),
            Member::Hoisted(Hoist::Computed(id)) => self.hoisted(id),
            Member::Hoisted(Hoist::Space(space)) => self.warp(space),
            Member::Hoisted(Hoist::Instance(id)) => tasks.push(Task::Define(id)),
            Member::Piece(..) => unreachable!("pieces are written with their leaves"),
        }
        if table.index() == 0 {
            self.start(&mut tasks);
        }
        while let Some(task) = tasks.pop() {
            match task {
                // It is computed where it is hoisted to.
                Task::Use(id) if self.scene.instance(id).uses > 1 => {}
                Task::Use(id) | Task::Define(id) => self.define(id, &mut tasks),
                Task::Order(order) => columns::order(self, order),
                Task::Express(id) => self.express(id),
                Task::Hoist(hoist) => self.hoist(hoist, depth, &mut tasks),
                Task::Rows(id, group) => self.hand_out(id, group),
                Task::Operand(id) => {
                    let guarded = self.shapes.guards_operand(self.scene, id, depth);
                    let guard = Task::Guard(Member::Operand(id, None), true);
                    tasks.push(if guarded { guard } else { Task::Use(id) });
                }
                Task::Guard(member, active) => {
                    self.own(&[member], active);
                }
            }
        }
        self.tasks = tasks;
        self.flush(table, member);
    }

    /// The numbers of the scene itself.
    fn start(&mut self, tasks: &mut Vec<Task>) {
        columns::iso2(self, self.scene);
        for group in &self.scene.tree.attributes()[..self.mixing.len()] {
            columns::channels(self, group, &group.default);
        }
        self.enter_space(SpaceId(0), tasks);
    }

    fn enter_warp(&mut self, space: SpaceId, tasks: &mut Vec<Task>) {
        self.warp(space);
        self.enter_space(space, tasks);
    }

    fn warp(&mut self, space: SpaceId) {
        let inside = self.scene.inside(space).expect("the world is no warp's inside");
        let position = self.scene.position(inside.position);
        columns::map(self, position.kind(), &position.map);
        columns::warp(self, self.scene, space);
    }

    /// What is hoisted: here, or in a row of its own.
    fn hoist(&mut self, hoist: Hoist, depth: usize, tasks: &mut Vec<Task>) {
        let guarded = self.shapes.guards_hoisted(self.scene, hoist, depth);
        match hoist {
            Hoist::Computed(id) if !self.mixing.is_empty() => self.hoisted(id),
            Hoist::Computed(_) => {}
            Hoist::Field(field) if !guarded => self.leaf(field),
            Hoist::Space(space) if !guarded => self.enter_warp(space, tasks),
            Hoist::Instance(id) if !guarded => tasks.push(Task::Define(id)),
            // Only the point is computed under the guard.
            Hoist::Space(space) => self.enter_space(space, tasks),
            Hoist::Field(_) | Hoist::Instance(_) => {}
        }
        if guarded {
            tasks.push(Task::Guard(Member::Hoisted(hoist), self.scene.demand.is_asked(hoist)));
        }
    }

    fn enter_space(&self, space: SpaceId, tasks: &mut Vec<Task>) {
        tasks.extend(self.shapes.hoists(space).iter().rev().map(|&hoist| Task::Hoist(hoist)));
    }

    fn define(&mut self, id: InstanceId, tasks: &mut Vec<Task>) {
        let instance = self.scene.instance(id);
        match &instance.kind {
            InstanceKind::Leaf { field, bindings, computed } => {
                if self.scene.field(*field).uses == 1 {
                    self.leaf(*field);
                }
                self.attributes(*bindings, computed);
            }
            InstanceKind::Warp { inside, child, .. } => {
                tasks.push(Task::Use(*child));
                if !self.scene.is_shared(*inside) {
                    self.enter_warp(*inside, tasks);
                }
            }
            InstanceKind::Difference { left, right } => {
                tasks.extend([Task::Operand(*right), Task::Operand(*left)]);
            }
            InstanceKind::Map { code, child } => {
                let operator = self.scene.combinator(instance.node);
                columns::operator(self, self.scene, instance.node, operator, code.columns());
                tasks.push(Task::Operand(*child));
            }
            InstanceKind::Expression { children, .. } => {
                tasks.push(Task::Express(id));
                tasks.extend(children.iter().rev().map(|&child| Task::Operand(child)));
            }
            InstanceKind::Select { children, chosen } => {
                for (place, &child) in children.iter().enumerate().rev() {
                    tasks.push(Task::Guard(Member::Operand(child, None), place == *chosen));
                }
            }
            InstanceKind::Reduce { operator, code, .. } => {
                columns::operator(self, self.scene, instance.node, *operator, code.columns());
                let groups = self.shapes.groups(id);
                let ordered = wants_order(
                    *code,
                    groups.len() > 1,
                    self.query.contains(AnswerKind::Gradient),
                    &self.mixing,
                );
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

    /// Makes the members of a group rows of the next child table, owned by the row in progress.
    fn hand_out(&mut self, id: InstanceId, group: usize) {
        let InstanceKind::Reduce { code, .. } = &self.scene.instance(id).kind else {
            unreachable!("only operators have groups")
        };
        let groups = self.shapes.groups(id);
        let ordered =
            wants_order(*code, groups.len() > 1, self.query.contains(AnswerKind::Gradient), &self.mixing);
        let member = |&(instance, order)| Member::Operand(instance, ordered.then_some(order));
        let members: Vec<Member> = groups[group].members.iter().map(member).collect();
        self.own(&members, true);
    }

    /// These are the rows of the next child table that the row in progress owns, active or not.
    fn own(&mut self, owned: &[Member], active: bool) -> Table {
        let child = self
            .children
            .pop()
            .expect("the code has a table for each folded group, guard and fold of pieces");
        let (rows, members) = (&mut self.tables[child.index()], &mut self.members[child.index()]);
        if active {
            rows.active.extend((members.len()..members.len() + owned.len()).map(|row| row as u32));
        }
        members.extend(owned);
        rows.starts.push(rows.active.len() as u32);
        child
    }

    fn leaf(&mut self, field: FieldId) {
        self.nodes.push(self.scene.field(field).node.0);
        let LeafField { map, code, .. } = self.scene.field(field);
        columns::map(self, code.map, map);
        columns::skeleton(self, self.scene, field);
        if let Some(pieces) = code.skeleton.pieces() {
            columns::beyond(self, self.scene, field);
            self.pieces(field, pieces.columns.len());
        }
        columns::slope(self, self.scene, field);
        columns::falloff(self, self.scene, field);
        if code.strong {
            columns::strength(self, self.scene, field);
        }
    }

    /// The numbers of a formula: the map to its space, its own, and those of the leaf that it is without
    /// children.
    fn express(&mut self, id: InstanceId) {
        let instance = self.scene.instance(id);
        let InstanceKind::Expression { position, shift, bindings, children, computed } = &instance.kind
        else {
            unreachable!("only formulas are expressed")
        };
        let expression = self.scene.expression(instance.node);
        if expression.form().asks_point() {
            let position = self.scene.position(*position);
            columns::map(self, position.kind(), &position.map);
        }
        columns::formula(self, expression, *shift);
        if children.is_empty() {
            self.attributes(*bindings, computed);
        }
    }

    /// Writes the rows of a leaf's pieces.
    fn pieces(&mut self, field: FieldId, columns: usize) {
        let (primitive, scale) = (self.scene.primitive(field), self.scene.field(field).scale);
        let mut numbers = Vec::new();
        primitive.skeleton.pieces(scale, primitive.radius, &mut numbers);
        // At most limits::MAX_INSTANCES.
        let members: Vec<Member> =
            (0..numbers.len() / columns).map(|piece| Member::Piece(field, piece as u32)).collect();
        let table = self.own(&members, true);
        for (member, piece) in members.into_iter().zip(numbers.chunks_exact(columns)) {
            self.append(table, member, piece);
        }
    }

    /// The attributes of a leaf: numbers, and the numbers of what is computed in its row.
    fn attributes(&mut self, bindings: BindingsId, computed: &[Option<ComputedId>]) {
        let bindings = self.scene.bindings(bindings);
        let groups = &self.scene.tree.attributes()[..self.mixing.len()];
        for (index, (group, bound)) in groups.iter().zip(bindings).enumerate() {
            match (computed.get(index).copied().flatten(), bound) {
                (Some(id), _) if self.scene.computed(id).shared => {}
                (Some(id), _) => self.computed(id, group),
                (None, Some(bound)) => match computed::attribute(self.scene.tree, bound.node) {
                    AttributeValue::Numbers(numbers) => columns::channels(self, group, numbers),
                    AttributeValue::Textured(_) | AttributeValue::Uv(_) | AttributeValue::Expressed(_) => {
                        unreachable!("it is computed")
                    }
                },
                (None, None) => columns::channels(self, group, &group.default),
            }
        }
    }

    fn computed(&mut self, id: ComputedId, group: &AttributeGroup) {
        let computed = self.scene.computed(id);
        columns::map(self, computed.map_kind, &computed.map);
        match computed.value(self.scene.tree) {
            ComputedValue::Texture(kind, Textured { texture, a, b }) => {
                columns::texture(self, kind, texture);
                columns::channels(self, group, a);
                columns::channels(self, group, b);
            }
            ComputedValue::Uv(skeleton, map) => {
                columns::uv(self, skeleton);
                columns::uv_map(self, map);
            }
            ComputedValue::Formula(expression) => columns::formula(self, expression, DVec3::ZERO),
        }
    }

    /// What is computed in front of the leaves that share it.
    fn hoisted(&mut self, id: ComputedId) {
        let group = self.scene.group_of(id);
        self.computed(id, &self.scene.tree.attributes()[group]);
    }

    /// Rounds the row and appends it to its table.
    fn flush(&mut self, table: Table, member: Member) {
        self.tables[table.index()].nodes.append(&mut self.nodes);
        let mut row = std::mem::take(&mut self.row);
        self.append(table, member, &row);
        row.clear();
        self.row = row;
    }

    /// Rounds numbers and appends them as a row.
    fn append(&mut self, table: Table, member: Member, row: &[f64]) {
        let rows = &mut self.tables[table.index()];
        rows.count += 1;
        rows.numbers.extend(row.iter().map(|&number| number as f32));
        for &number in row.iter().filter(|number| !(**number as f32).is_finite()) {
            self.complain(member, number);
        }
    }

    /// A number of a row is none in f32.
    #[cold]
    fn complain(&mut self, member: Member, number: f64) {
        if self.errors.len() < jbt_ir::limits::MAX_ERRORS {
            let node = self.scene.tree.node(member.node(self.scene));
            let message = format!("a number derived from this part leaves the range of f32: {number:e}");
            let help = "the part is too small, too large or too far away once all transforms are applied";
            self.errors.push(Diagnostic::error(node.span, message).expected(help));
        }
    }
}
