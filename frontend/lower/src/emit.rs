//! The code of a scene: every shape once, from its first instance.
//!
//! ```text
//! define(instance):  leaf        its point, squared distance, falloff, strength; attributes are columns
//!                      warp        its point in a new space, then the child there
//!                      difference  both sides, then the smaller
//!                      map         the child, then the map of its field
//!                      expression  each child; then the formula of the point and their fields
//!                      selector    for each child: a fold over one row, which is active or not
//!                      operator    for each group:  folded   open a fold over a table, define the first member, step, close
//!                                                   else     for each member: define, step; the first member of a step is the beginning
//! define under a guard: open a fold over a table of one row, define, close; the answer is what the fold carries out
//! ```
//!
//! An explicit stack of tasks takes the place of recursion, because a model may be a chain of any length:
//! what is pushed last is done first. Columns are declared when the code asks for them. The
//! [recipe](super::recipe) of their table says where their numbers come from, for every row.
//!
//! The range function is emitted in the same way, and carries probes out of its guards: see `probe`.

mod computed;
mod express;
mod fold;
mod guard;
mod hoist;
mod parts;
mod probe;
mod row;
mod select;

use rustc_hash::FxHashMap as HashMap;
use std::rc::Rc;

use jbt_ir::{Domain, FoldKind, Function, FunctionBuilder, Origin, Rule, Table, Value, limits};

use self::parts::{Guard, GuardStart, Probes};
use super::columns;
use super::instance::{FieldId, InstanceId, InstanceKind, Scene, SpaceId};
use super::mixing::{Answer, Operator, State, difference, mapped};
use super::names::ComputedId;
use super::prune_info::{ContestGroup, Decision, DecisionKind, RowContest};
use super::recipe::{Member, RowPlace, RowPlaces, RowStep};
use super::shape::Shapes;
use jbt_model::attribute::{AttributeGroup, Mixing};
use jbt_model::combine::{Extreme, MapCode};
use jbt_model::diagnostic::Diagnostic;
use jbt_model::query::{AnswerKind, Query};

/// A function, and what the rows need to know about it.
pub(super) struct Code {
    pub(super) function: Function,
    /// By table.
    pub(super) tables: Vec<TableCode>,
    /// Of a range function; others have none.
    pub(super) decisions: Vec<Decision>,
    pub(super) contests: Vec<RowContest>,
}

/// What the code says about a table.
pub(super) struct TableCode {
    /// How a row is filled.
    pub(super) recipe: Vec<RowStep>,
    /// How many folds are open in its rows.
    pub(super) depth: usize,
    /// The space in which its fold stands, for its first row.
    pub(super) space: SpaceId,
    /// The first of the three probes of the point in that space, in a range function, if all rows see the
    /// same point.
    pub(super) probe: Option<usize>,
}

/// Writes the code.
pub(super) fn emit(scene: &Scene<'_>, shapes: &Shapes, query: Query) -> Result<Code, Vec<Diagnostic>> {
    Emitter::new(scene, shapes, query, None).run()
}

/// Writes the range function.
pub(super) fn emit_ranges(scene: &Scene<'_>, shapes: &Shapes) -> Result<Code, Vec<Diagnostic>> {
    Emitter::new(scene, shapes, Query::FIELD, Some(Probes::default())).run()
}

/// Places are those of the row that is open when the task's turn comes.
enum Task {
    /// The answer of an instance, for one of its uses: computed here, if nothing has been kept.
    Use(RowPlace),
    /// What was computed here is what all uses see.
    Keep(InstanceId),
    /// What is hoisted to here is computed, for all uses.
    Hoist(RowPlace),
    LeaveSpace,
    /// The group of an operator.
    OpenFold(RowPlace, usize),
    CloseFold,
    /// An operand that is written out: under a guard, if it is worth one.
    Operand(RowPlace, Guard),
    OpenGuard(RowPlace, GuardStart),
    CloseGuard(Option<DecisionKind>),
    /// The children of a formula have their answers.
    Express(RowPlace),
    /// The next operand of an operator has its answer.
    Meet,
    FinishReduce,
    /// The first operand of a step has its answer: the others come to it.
    Seed,
    Difference,
    /// The child of a map has its answer; these are the map's numbers.
    Map(MapCode, Vec<Value>),
    OpenChild(RowPlace),
    CloseChild,
    FinishSelect,
    /// An operand that is written out: its place in the file is a number of the current row.
    Order(RowPlace),
}

/// An operator in progress.
struct Reduce {
    operator: Operator,
    state: State,
    /// The place in the file of the operand in progress.
    order: Option<Value>,
    /// Where operands are rows, and each may be left out while it is not zero: the extreme of their fields.
    extreme: Option<(Extreme, Value)>,
    /// The table whose rows are the operands in progress.
    rows: Option<Table>,
    /// The operands so far.
    groups: Vec<ContestGroup>,
    /// Whether operands have not been kept within bounds on the far side, the upper one of a union: that is
    /// done in the end.
    open: bool,
}

/// A row whose code is being written: the first of its table.
struct OpenRow {
    table: Table,
    places: RowPlaces,
}

struct Emitter<'a> {
    scene: &'a Scene<'a>,
    shapes: &'a Shapes,
    query: Query,
    /// The attribute groups that the query asks for, and how they mix.
    groups: &'a [AttributeGroup],
    mixing: Rc<[Mixing]>,
    builder: FunctionBuilder,
    tasks: Vec<Task>,
    answers: Vec<Answer>,
    /// The point in each space that is open.
    points: Vec<(SpaceId, [Value; 3])>,
    /// The innermost one last.
    rows: Vec<OpenRow>,
    tables: Vec<TableCode>,
    reduces: Vec<Reduce>,
    /// Selectors in progress: the answer so far, as accumulators.
    selects: Vec<Vec<Value>>,
    kept: HashMap<InstanceId, Answer>,
    kept_fields: HashMap<FieldId, Value>,
    kept_computed: HashMap<ComputedId, Vec<Value>>,
    kept_points: HashMap<SpaceId, [Value; 3]>,
    slots: u32,
    iso2: Option<Value>,
    defaults: Vec<Vec<Value>>,
    /// In a range function.
    probes: Option<Probes>,
}

impl<'a> Emitter<'a> {
    fn new(scene: &'a Scene<'a>, shapes: &'a Shapes, query: Query, probes: Option<Probes>) -> Self {
        let wanted = query.contains(AnswerKind::Attributes);
        let groups = if wanted { scene.tree.attributes() } else { &[] };
        Self {
            scene,
            shapes,
            query,
            groups,
            mixing: groups.iter().map(|group| group.mixing).collect(),
            builder: FunctionBuilder::new("model", &["x", "y", "z"]),
            tasks: Vec::new(),
            answers: Vec::new(),
            points: Vec::new(),
            rows: Vec::new(),
            tables: Vec::new(),
            reduces: Vec::new(),
            selects: Vec::new(),
            kept: HashMap::default(),
            kept_fields: HashMap::default(),
            kept_computed: HashMap::default(),
            kept_points: HashMap::default(),
            slots: 0,
            iso2: None,
            defaults: Vec::new(),
            probes,
        }
    }

    fn run(mut self) -> Result<Code, Vec<Diagnostic>> {
        self.start();
        while let Some(task) = self.tasks.pop() {
            jbt_ir::watch::look();
            self.work(task);
            self.check_limits()?;
        }
        Ok(self.finish())
    }

    /// Opens the scene's row.
    fn start(&mut self) {
        let point = std::array::from_fn(|axis| self.builder.input(axis));
        self.points.push((SpaceId(0), point));
        let zero = self.builder.constant(0.0);
        self.probe_row();
        self.open_table("scene", Member::root(self.scene), (FoldKind::Guard, Rule::Never), &[zero]);
        self.iso2 = Some(self.columns(RowPlace::ROW, columns::iso2())[0]);
        for (index, group) in self.groups.iter().enumerate() {
            let default = self.columns(RowPlace::ROW, columns::default(group, index));
            self.defaults.push(default);
        }
        self.tasks.push(Task::Use(RowPlace::ROW));
        self.hoist_all(SpaceId(0));
    }

    /// Closes the scene's row: its answer is the function's.
    fn finish(mut self) -> Code {
        let answer = self.answers.pop().expect("the root has an answer");
        let mut next = vec![answer.field];
        let zero = self.builder.constant(0.0);
        for group in &answer.groups {
            // The sign of a zero may depend on rows that add nothing; no answer shows it.
            next.extend(group.channels.iter().map(|&channel| self.builder.add(channel, zero)));
        }
        let results = self.close_only(next, 1);
        let mut names = vec!["field".to_owned()];
        for group in self.groups {
            names.extend((0..group.width()).map(|i| group.channel(i)));
        }
        let mut outputs: Vec<_> = names.into_iter().zip(results).collect();
        let (decisions, contests) =
            self.probes.map(|probes| probes.finish(&mut outputs, &mut self.tables)).unwrap_or_default();
        Code { function: self.builder.finish(&outputs), tables: self.tables, decisions, contests }
    }

    fn check_limits(&self) -> Result<(), Vec<Diagnostic>> {
        let function = self.builder.function();
        let limit = |what: &str, limit: usize| {
            let message = format!("the model has too many different parts: more than {limit} {what}");
            // The place is that of the part whose row is being written.
            let node = self.row().places.at(RowPlace::ROW).node(self.scene);
            Err(vec![Diagnostic::limit(self.scene.tree.node(node).span, message)])
        };
        if function.values.len() > limits::MAX_VALUES {
            return limit("values in its program", limits::MAX_VALUES);
        }
        if function.tables.len() > limits::MAX_TABLES {
            return limit("tables", limits::MAX_TABLES);
        }
        // A leaf opens and closes the fold over its pieces at once, so the deepest fold need not be open now.
        if self.tables.last().is_some_and(|table| table.depth > limits::MAX_FOLD_DEPTH) {
            return limit("operators of many like children inside each other", limits::MAX_FOLD_DEPTH);
        }
        Ok(())
    }

    fn work(&mut self, task: Task) {
        match task {
            Task::Use(place) => match self.kept.get(&self.at(place).instance()) {
                Some(answer) => self.answers.push(answer.clone()),
                None => self.define(place),
            },
            Task::Keep(id) => {
                let answer = self.answers.pop().expect("it has just been defined");
                self.kept.insert(id, Answer { contest: None, ..answer });
            }
            Task::Hoist(place) => self.hoist(place),
            Task::LeaveSpace => {
                self.points.pop();
            }
            Task::Operand(place, guard) => {
                let id = self.at(place).instance();
                if self.shapes.guards_operand(self.scene, id, self.builder.fold_depth()) {
                    self.tasks.push(Task::CloseGuard(guard.decision));
                    self.tasks.push(Task::Use(RowPlace::ROW));
                    self.tasks.push(Task::OpenGuard(place, guard.start));
                } else {
                    self.tasks.push(Task::Use(place));
                }
            }
            Task::OpenGuard(place, start) => self.open_guard(place, start),
            Task::CloseGuard(decision) => self.close_guard(decision),
            Task::Express(place) => self.express(place),
            Task::OpenChild(place) => self.open_child(place),
            Task::CloseChild => self.close_child(),
            Task::FinishSelect => self.finish_select(),
            Task::OpenFold(place, group) => self.open_group(place, group),
            Task::CloseFold => self.close_group(),
            Task::Order(place) => self.read_order(place),
            Task::Meet => self.meet(),
            Task::FinishReduce => self.finish_reduce(),
            Task::Seed => self.seed(),
            Task::Map(code, row) => self.map(code, &row),
            Task::Difference => self.difference(),
        }
    }

    /// The last answer comes to its operator.
    fn meet(&mut self) {
        let operand = self.answers.pop().expect("the operand has been defined");
        self.enter_contest(operand.field);
        let reduce = self.reduces.last_mut().expect("steps belong to operators");
        let order = reduce.order.take();
        if let Some((extreme, value)) = &mut reduce.extreme {
            *value = extreme.step(&mut self.builder, operand.field, *value);
        }
        reduce.state.meet(&mut self.builder, &reduce.operator, &operand, order);
    }

    /// The field of an operand, or of operands that are rows, comes to the contest of its operator.
    fn enter_contest(&mut self, field: Value) {
        let here = self.row().table;
        let reduce = self.reduces.last_mut().expect("operands belong to operators");
        let rows = reduce.rows.is_some();
        reduce.groups.push(ContestGroup { table: reduce.rows.unwrap_or(here), field, rows });
    }

    /// An operator answers.
    fn finish_reduce(&mut self) {
        let reduce = self.reduces.pop().expect("it was started");
        let mut answer = reduce.state.finish(&mut self.builder, &reduce.operator, &self.defaults);
        if reduce.open {
            answer.field = self.closed(reduce.operator.code, answer.field);
        }
        let contest = reduce.operator.contest(reduce.groups, &self.builder);
        answer.contest = self.end_operator(answer.field, contest);
        self.answers.push(answer);
    }

    /// The last answer is the first one of its operator.
    fn seed(&mut self) {
        let operand = self.answers.pop().expect("the operand has been defined");
        self.enter_contest(operand.field);
        let reduce = self.reduces.last_mut().expect("steps belong to operators");
        reduce.state.seed(&mut self.builder, &operand);
    }

    /// The last answer goes through a map of the field.
    fn map(&mut self, code: MapCode, row: &[Value]) {
        let child = self.answers.pop().expect("the child has been defined");
        let iso2 = self.iso2.expect("the scene's row is open");
        let before = self.builder.set_origin(Origin::CREASE);
        let field = code.emit(&mut self.builder, child.field, row, iso2);
        self.builder.set_origin(before);
        self.answers.push(mapped(&mut self.builder, field, &child, &self.defaults));
    }

    /// The last two answers are the sides of a difference.
    fn difference(&mut self) {
        let right = self.answers.pop().expect("the right side has been defined");
        let left = self.answers.pop().expect("the left side has been defined");
        let iso2 = self.iso2.expect("the scene's row is open");
        let answer = difference(&mut self.builder, &left, &right, iso2, &self.defaults);
        self.end_difference(answer.field, [&left, &right]);
        self.answers.push(answer);
    }

    fn define(&mut self, place: RowPlace) {
        let id = self.at(place).instance();
        match &self.scene.instance(id).kind {
            InstanceKind::Leaf { field, .. } => {
                let value = self.kept_fields.get(field).copied().unwrap_or_else(|| self.leaf(place));
                let groups = self.leaf_attributes(place);
                self.answers.push(Answer::new(value, groups));
            }
            InstanceKind::Warp { inside, .. } => {
                // The other one is its weight, which is hoisted.
                let child = self.operands(place).next().map(Task::Use);
                self.tasks.push(Task::LeaveSpace);
                self.tasks.extend(child);
                match self.kept_points.get(inside) {
                    Some(&point) => self.points.push((*inside, point)),
                    None => {
                        let point = self.point_inside(place);
                        self.enter_space(*inside, point);
                    }
                }
            }
            InstanceKind::Difference { .. } => {
                self.begin_operator();
                self.tasks.push(Task::Difference);
                let sides = self.operands(place).rev().zip([Guard::RIGHT, Guard::LEFT]);
                self.tasks.extend(sides.map(|(side, guard)| Task::Operand(side, guard)));
            }
            InstanceKind::Map { code, .. } => {
                let row = self.columns(place, columns::operator(code.columns()));
                self.tasks.push(Task::Map(*code, row));
                let child = self.operands(place).map(|child| Task::Operand(child, Guard::ZERO));
                self.tasks.extend(child);
            }
            InstanceKind::Expression { .. } => {
                self.tasks.push(Task::Express(place));
                let children = self.operands(place).map(|child| Task::Operand(child, Guard::ZERO));
                self.tasks.extend(children.rev());
            }
            InstanceKind::Select { .. } => self.select(place),
            InstanceKind::Reduce { code, .. } => self.begin_reduce(place, *code),
        }
    }

    /// The point inside a warp.
    fn point_inside(&mut self, place: RowPlace) -> [Value; 3] {
        let inside = self.at(place).inside(self.scene);
        let kind = self.scene.position(inside.position).kind();
        let (_, outer) = *self.points.last().expect("a space is open");
        let row = self.columns(place, columns::map(kind));
        let point = kind.emit(&mut self.builder, outer, &row);
        let code = self.scene.warp(inside.warp).code();
        let row = self.columns(place, columns::warp(&code));
        let origin = if code.creases() { Origin::CREASE } else { self.builder.origin() };
        let before = self.builder.set_origin(origin);
        let inner = match inside.weight {
            None => code.emit(&mut self.builder, point, &row),
            Some(weight) => {
                // It was computed where the space began in which the warp stands, at the point in that space.
                let weight = self.kept[&weight].field;
                code.emit_weighted(&mut self.builder, point, &row, weight)
            }
        };
        self.builder.set_origin(before);
        inner
    }

    /// Enters a space at this point.
    fn enter_space(&mut self, space: SpaceId, point: [Value; 3]) {
        self.points.push((space, point));
        self.probe_point(space, point);
        self.hoist_all(space);
    }
}
