//! The code of a scene: every shape once, from its first occurrence.
//!
//! ```text
//! define(occurrence):  leaf        its point, squared distance, falloff, strength; attributes are columns
//!                      warp        its point in a new space, then the child there
//!                      difference  both sides, then the smaller
//!                      operator    for each group:  folded   open a fold over a table, define the first member, step, close
//!                                                   else     for each member: define, step
//! ```
//!
//! An explicit list of tasks takes the place of recursion, because a model may be a chain of any length. The columns of a row are
//! declared in the order in which the code asks for them; [`super::rows`] goes through the same order for every row.

use rustc_hash::FxHashMap as HashMap;
use std::rc::Rc;

use jbt_ir::{
    Domain, Entity, Function, FunctionBuilder, Origin, Part, Reduction, Schema, Table, Value, limits,
};

use super::mixing::{Answer, GroupAnswer, Operator, State, difference};
use super::occurrence::{FieldId, OccurrenceId, OccurrenceKind, Scene, SpaceId};
use super::position::MapKind;
use super::shape::{Lift, ReducerCode, Shapes, non_negative};
use crate::attribute::{AttributeGroup, Mixing};
use crate::check::CheckedTree;
use crate::combine::ricci::Exponent;
use crate::diagnostic::Diagnostic;
use crate::query::Query;

/// A function, and what the rows need to know about it.
pub(super) struct Code {
    pub(super) function: Function,
    /// The tables under each table, in the order in which a row meets them.
    pub(super) children: Vec<Vec<Table>>,
}

/// How many attribute groups a query asks for.
pub(super) fn groups(tree: &CheckedTree, query: Query) -> usize {
    if query.attributes { tree.attributes().len() } else { 0 }
}

/// Writes the code.
pub(super) fn emit(scene: &Scene<'_>, shapes: &Shapes, query: Query) -> Result<Code, Vec<Diagnostic>> {
    let mut emitter = Emitter::new(scene, shapes, query);
    emitter.start();
    while let Some(task) = emitter.tasks.pop() {
        emitter.work(task);
        emitter.check_limits()?;
    }
    Ok(emitter.finish())
}

enum Task {
    /// The answer of an occurrence, for one of its uses.
    Use(OccurrenceId),
    /// The answer of an occurrence, computed here.
    Define(OccurrenceId),
    /// What was computed here is what all uses see.
    Keep(OccurrenceId),
    LiftField(FieldId),
    /// The point in a space is what all uses see.
    LiftSpace(SpaceId),
    LeaveSpace,
    OpenFold,
    CloseFold,
    /// The next operand of an operator has its answer.
    Step,
    FinishReduce,
    Difference,
    /// An operand that is written out: its place in the file is a number of the current row.
    Order,
}

/// An operator in progress.
struct Reduce {
    operator: Operator,
    state: State,
    /// The place in the file of the operand in progress.
    order: Option<Value>,
}

struct Emitter<'a> {
    scene: &'a Scene<'a>,
    shapes: &'a Shapes,
    query: Query,
    mixing: Rc<[Mixing]>,
    builder: FunctionBuilder,
    tasks: Vec<Task>,
    answers: Vec<Answer>,
    /// The point in each space that is open.
    points: Vec<[Value; 3]>,
    /// The tables whose rows are open.
    rows: Vec<Table>,
    children: Vec<Vec<Table>>,
    reduces: Vec<Reduce>,
    kept: HashMap<OccurrenceId, Answer>,
    kept_fields: HashMap<FieldId, Value>,
    kept_points: HashMap<SpaceId, [Value; 3]>,
    slots: u32,
    iso2: Option<Value>,
    defaults: Vec<Vec<Value>>,
}

impl<'a> Emitter<'a> {
    fn new(scene: &'a Scene<'a>, shapes: &'a Shapes, query: Query) -> Self {
        let attributes = &scene.tree.attributes()[..groups(scene.tree, query)];
        Self {
            scene,
            shapes,
            query,
            mixing: attributes.iter().map(|group| group.mixing).collect(),
            builder: FunctionBuilder::new("model", &["x", "y", "z"]),
            tasks: Vec::new(),
            answers: Vec::new(),
            points: Vec::new(),
            rows: Vec::new(),
            children: Vec::new(),
            reduces: Vec::new(),
            kept: HashMap::default(),
            kept_fields: HashMap::default(),
            kept_points: HashMap::default(),
            slots: 0,
            iso2: None,
            defaults: Vec::new(),
        }
    }

    /// Opens the scene's row.
    fn start(&mut self) {
        let point = std::array::from_fn(|axis| self.builder.input(axis));
        self.points.push(point);
        let channels = self.defaults_width();
        let zeros = vec![self.builder.constant(0.0); 1 + channels];
        self.open_fold("scene", Reduction::Only, &zeros);
        self.iso2 = Some(self.column("iso2"));
        for group in &self.scene.tree.attributes()[..self.mixing.len()] {
            let default = (0..group.width()).map(|i| self.column(&group.channel(i))).collect();
            self.defaults.push(default);
        }
        self.tasks.push(Task::Use(self.scene.root));
        self.enter_space(SpaceId(0));
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
        let results = self.builder.end_fold(&next);
        let mut names = vec!["field".to_owned()];
        for group in &self.scene.tree.attributes()[..self.mixing.len()] {
            names.extend((0..group.width()).map(|i| group.channel(i)));
        }
        let outputs: Vec<_> = names.into_iter().zip(results).collect();
        Code { function: self.builder.finish(&outputs), children: self.children }
    }

    /// Number of attribute channels that the query asks for.
    fn defaults_width(&self) -> usize {
        self.scene.tree.attributes()[..self.mixing.len()].iter().map(AttributeGroup::width).sum()
    }

    fn check_limits(&self) -> Result<(), Vec<Diagnostic>> {
        let function = self.builder.function();
        let limit = |what: &str, limit: usize| {
            let message = format!("the model has too many different parts: more than {limit} {what}");
            Err(vec![Diagnostic::limit(None, message)])
        };
        if function.values.len() > limits::MAX_VALUES {
            return limit("values in its program", limits::MAX_VALUES);
        }
        if function.tables.len() > limits::MAX_TABLES {
            return limit("tables", limits::MAX_TABLES);
        }
        if self.builder.fold_depth() > limits::MAX_FOLD_DEPTH {
            return limit("operators of many like children inside each other", limits::MAX_FOLD_DEPTH);
        }
        Ok(())
    }

    fn work(&mut self, task: Task) {
        match task {
            Task::Use(id) => match self.kept.get(&id) {
                Some(answer) => self.answers.push(answer.clone()),
                None => self.define(id),
            },
            Task::Define(id) => self.define(id),
            Task::Keep(id) => {
                let answer = self.answers.pop().expect("it has just been defined");
                self.kept.insert(id, answer);
            }
            Task::LiftField(field) => {
                let value = self.leaf(field);
                self.kept_fields.insert(field, value);
            }
            Task::LiftSpace(space) => {
                self.tasks.push(Task::LeaveSpace);
                self.enter_warp(space);
                self.kept_points.insert(space, *self.points.last().expect("the warp has been entered"));
            }
            Task::LeaveSpace => {
                self.points.pop();
            }
            Task::OpenFold => self.open_group(),
            Task::CloseFold => {
                self.rows.pop();
                let reduce = self.reduces.last_mut().expect("folds belong to operators");
                let next = reduce.state.values();
                let results = self.builder.end_fold(&next);
                reduce.state.replace(&results);
            }
            Task::Order => self.read_order(),
            Task::Step => {
                let operand = self.answers.pop().expect("the operand has been defined");
                let reduce = self.reduces.last_mut().expect("steps belong to operators");
                let order = reduce.order.take();
                reduce.state.step(&mut self.builder, &reduce.operator, &operand, order);
            }
            Task::FinishReduce => {
                let reduce = self.reduces.pop().expect("it was started");
                let answer = reduce.state.finish(&mut self.builder, &reduce.operator, &self.defaults);
                self.answers.push(answer);
            }
            Task::Difference => {
                let right = self.answers.pop().expect("the right side has been defined");
                let left = self.answers.pop().expect("the left side has been defined");
                let iso2 = self.iso2.expect("the scene's row is open");
                self.answers.push(difference(&mut self.builder, &left, &right, iso2, &self.defaults));
            }
        }
    }

    fn define(&mut self, id: OccurrenceId) {
        match &self.scene.occurrence(id).kind {
            OccurrenceKind::Leaf { field, .. } => {
                let value = self.kept_fields.get(field).copied().unwrap_or_else(|| self.leaf(*field));
                let groups = self.leaf_attributes();
                self.answers.push(Answer { field: value, groups });
            }
            OccurrenceKind::Warp { inside, child, .. } => {
                self.tasks.extend([Task::LeaveSpace, Task::Use(*child)]);
                match self.kept_points.get(inside) {
                    Some(&point) => self.points.push(point),
                    None => self.enter_warp(*inside),
                }
            }
            OccurrenceKind::Difference { left, right } => {
                self.tasks.extend([Task::Difference, Task::Use(*right), Task::Use(*left)]);
            }
            OccurrenceKind::Reduce { .. } => self.begin_reduce(id),
        }
    }

    /// Computes the point inside a warp, and what is lifted to the start of its space.
    fn enter_warp(&mut self, space: SpaceId) {
        let inside = self.scene.inside(space).expect("the world is no warp's inside");
        let map = MapKind::of(&self.scene.position(inside.position).map);
        let outer = *self.points.last().expect("a space is open");
        let row = self.columns(map.columns());
        let point = map.emit(&mut self.builder, outer, &row);
        let kind = self.scene.warp(inside.warp).kind();
        let row = self.columns(kind.columns());
        let point = kind.emit(&mut self.builder, point, &row);
        self.points.push(point);
        self.enter_space(space);
    }

    /// Puts what is lifted to the start of a space on top of the tasks.
    fn enter_space(&mut self, space: SpaceId) {
        for lift in self.shapes.lifts(space).iter().rev() {
            match lift {
                Lift::Field(field) => self.tasks.push(Task::LiftField(*field)),
                Lift::Space(space) => self.tasks.push(Task::LiftSpace(*space)),
                Lift::Occurrence(id) => self.tasks.extend([Task::Keep(*id), Task::Define(*id)]),
            }
        }
    }

    fn begin_reduce(&mut self, id: OccurrenceId) {
        let occurrence = self.scene.occurrence(id);
        let OccurrenceKind::Reduce { reducer, .. } = &occurrence.kind else {
            unreachable!("only operators are reduced")
        };
        let groups = self.shapes.groups(id);
        let code = ReducerCode::of(*reducer);
        let exponent = match code {
            ReducerCode::RicciInteger(n) => Some(Exponent::Integer(n)),
            ReducerCode::RicciGeneral => {
                let [n, inverse] = self.columns(&["exponent", "inverse_exponent"])[..] else {
                    unreachable!("two columns were asked for")
                };
                Some(Exponent::General(n, inverse))
            }
            ReducerCode::Sum | ReducerCode::Union | ReducerCode::Intersection => None,
        };
        let operator = Operator {
            code,
            exponent,
            non_negative: non_negative(self.scene, *reducer, groups),
            ordered: groups.len() > 1,
            moving: self.query.gradient,
            mixing: Rc::clone(&self.mixing),
        };
        let state = State::new(&mut self.builder, &operator, &self.defaults);
        self.reduces.push(Reduce { operator, state, order: None });
        self.tasks.push(Task::FinishReduce);
        for group in groups.iter().rev() {
            if group.folded {
                self.tasks.extend([Task::CloseFold, Task::Step, Task::Use(group.members[0].0)]);
                self.tasks.push(Task::OpenFold);
            } else {
                for (member, _) in group.members.iter().rev() {
                    self.tasks.extend([Task::Step, Task::Use(*member), Task::Order]);
                }
            }
        }
    }
}

/// Tables, columns and leaves.
impl Emitter<'_> {
    fn open_fold(&mut self, name: &str, reduction: Reduction, initial: &[Value]) -> Vec<Value> {
        let parent = self.rows.last().copied();
        let schema = Schema { name: name.to_owned(), columns: Vec::new(), parent, slots: Vec::new() };
        let table = self.builder.table(schema);
        self.children.push(Vec::new());
        if let Some(parent) = parent {
            self.children[parent.index()].push(table);
        }
        self.rows.push(table);
        self.builder.begin_fold(table, reduction, initial)
    }

    /// Opens the fold over the rows of a group; its first task gives the group its name.
    fn open_group(&mut self) {
        let mut reduce = self.reduces.pop().expect("folds belong to operators");
        let reduction = match reduce.operator.code {
            ReducerCode::Sum => Reduction::Sum,
            ReducerCode::RicciInteger(_) | ReducerCode::RicciGeneral => Reduction::Ricci,
            ReducerCode::Union => Reduction::Union,
            ReducerCode::Intersection => Reduction::Intersection,
        };
        let name = match self.tasks.last() {
            Some(Task::Use(id)) => self.group_name(*id),
            _ => unreachable!("the first member is used next"),
        };
        let initial = reduce.state.values();
        let params = self.open_fold(&name, reduction, &initial);
        reduce.state.replace(&params);
        self.reduces.push(reduce);
        self.read_order();
    }

    fn group_name(&self, id: OccurrenceId) -> String {
        match &self.scene.occurrence(id).kind {
            OccurrenceKind::Leaf { field, .. } => {
                self.scene.primitive(*field).skeleton.kind().name().to_owned()
            }
            OccurrenceKind::Warp { .. } => {
                self.scene.warp(self.scene.occurrence(id).node).kind().name().to_owned()
            }
            OccurrenceKind::Difference { .. } => "difference".to_owned(),
            OccurrenceKind::Reduce { reducer, .. } => match ReducerCode::of(*reducer) {
                ReducerCode::Sum => "sum".to_owned(),
                ReducerCode::RicciInteger(_) | ReducerCode::RicciGeneral => "ricci".to_owned(),
                ReducerCode::Union => "union".to_owned(),
                ReducerCode::Intersection => "intersection".to_owned(),
            },
        }
    }

    /// The place in the file of the operand that follows, where ties need it.
    fn read_order(&mut self) {
        let wanted = self.reduces.last().expect("operands belong to operators").operator.wants_order();
        if wanted {
            let order = self.column("order");
            self.reduces.last_mut().expect("it was there a line ago").order = Some(order);
        }
    }

    fn column(&mut self, name: &str) -> Value {
        let table = *self.rows.last().expect("the scene's row is open");
        let column = self.builder.add_column(table, name);
        self.builder.column(table, column)
    }

    fn columns(&mut self, names: &[&str]) -> Vec<Value> {
        names.iter().map(|name| self.column(name)).collect()
    }

    /// The field of a leaf.
    fn leaf(&mut self, field: FieldId) -> Value {
        let primitive = self.scene.primitive(field);
        let slot = self.slots;
        self.slots += 1;
        self.builder.add_slot(*self.rows.last().expect("the scene's row is open"), slot);
        let map = MapKind::of_leaf(&self.scene.field(field).map);
        let skeleton = primitive.skeleton.kind();
        let outer = *self.points.last().expect("a space is open");
        self.builder.set_origin(Origin::leaf(slot, Part::Position));
        let row = self.columns(map.columns());
        let point = map.emit(&mut self.builder, outer, &row);
        let row = self.columns(skeleton.columns());
        let square = skeleton.emit(&mut self.builder, point, &row);
        self.builder.mark(square, Origin::leaf(slot, Part::Distance));

        self.builder.set_origin(Origin::leaf(slot, Part::Falloff));
        let slope = self.column("neg_inv_r2");
        let (zero, one) = (self.builder.constant(0.0), self.builder.constant(1.0));
        let left = self.builder.fma(square, slope, one);
        let left = self.builder.max(left, zero);
        let mut value = primitive.falloff.emit(&mut self.builder, left);
        if primitive.strength != 1.0 {
            let strength = self.column("strength");
            let product = self.builder.mul(strength, value);
            // Where the falloff is 0, a negative strength makes -0 of it, and sums must not depend on what adds nothing.
            value = self.builder.add(product, zero);
        }
        self.builder.set_origin(Origin::SHARED);
        value
    }

    /// The attributes of a leaf: numbers of its row.
    fn leaf_attributes(&mut self) -> Vec<GroupAnswer> {
        let groups = &self.scene.tree.attributes()[..self.mixing.len()];
        let answer = |group: &AttributeGroup| {
            let names = (0..group.width()).map(|i| group.channel(i));
            names.map(|name| self.column(&name)).collect()
        };
        let channels: Vec<Vec<Value>> = groups.iter().map(answer).collect();
        channels.into_iter().map(|channels| GroupAnswer { channels, share: None, numbers: true }).collect()
    }
}
