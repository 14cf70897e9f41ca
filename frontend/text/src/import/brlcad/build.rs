//! From objects to a tree: each object once, a use of it under the matrix of the use.
//!
//! An object has a tree with the colours of its regions, and one without colours where something above has
//! decided: below a region, and in what is subtracted, which shows the colour of what it is subtracted from.

use std::collections::{HashMap, HashSet};

use glam::{DAffine3, DMat3, DVec3};
use jbt_ir::limits::MAX_NODES;
use jbt_model::affine::map_bounds;
use jbt_model::bounds::Bounds;
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::report::{clip, nearest};
use jbt_model::tree::Tree;

use super::database::{Combination, Database, ObjectContent, ProgramStep, Properties};
use super::leaf::{self, Flaw, LeafStyle};
use super::operand::{CombinationSetting, PointSet, SetPart, colored, with_constant};
use super::solid::SolidKind;

/// How thick the field of a half space is, for the size of the largest solid.
const HALF_THICKNESS: f64 = 0.1;
/// How many members of combinations are worth one formula for all solids.
const MANY: usize = 256;
/// How far from a rotation counts as one.
const RIGID: f64 = 1e-6;
/// Names of a path that are shown from either end.
const PATH_ENDS: usize = 6;

/// The tree of an object, or of all that no other object refers to. `None` after a message.
pub(super) fn build(database: &mut Database, object: Option<&str>) -> Option<Tree> {
    let roots = roots(database, object)?;
    let count = database.objects.len();
    let mut builder = TreeBuilder {
        reach: reach(database),
        style: if database.members > MANY { LeafStyle::Alike } else { LeafStyle::Plain },
        states: std::iter::repeat_with(<[ObjectState; 2]>::default).take(count).collect(),
        path: Vec::new(),
        nodes: 0,
        notes: Vec::new(),
        noted: HashMap::new(),
        has_looks: database.objects.iter().any(|object| object.properties.has_looks())
            || !database.palette.is_empty(),
        database,
    };
    let mut whole = PointSet::MISSING;
    let setting = CombinationSetting { span: Span::default(), style: builder.style };
    for &root in &roots {
        let root = builder.run(root)?;
        whole = PointSet::combine(ProgramStep::Union, whole, root, setting);
    }
    if object.is_none() {
        builder.refuse_circles()?;
    }
    builder.note();
    let tree = whole.part(setting.span).map(|part| part.tree);
    if tree.is_none() {
        let named = object.map_or_else(|| "the file".to_owned(), |name| format!("`{}`", clip(name)));
        database.errors.add(|| Diagnostic::error(None, format!("{named} has no solid that can be read")));
    }
    tree
}

/// The objects to build. `None` after a message.
fn roots(database: &mut Database, object: Option<&str>) -> Option<Vec<u32>> {
    let Some(name) = object else {
        let mut used: HashSet<&[u8]> = HashSet::new();
        for object in &database.objects {
            if let ObjectContent::Combination(made) = &object.content {
                used.extend(made.members.iter().map(|member| database.at(member.name)));
            }
        }
        let is_top = |at: &usize| {
            let object = &database.objects[*at];
            !matches!(object.content, ObjectContent::Text) && !used.contains(database.at(object.name))
        };
        return Some((0..database.objects.len()).filter(is_top).map(|at| at as u32).collect());
    };
    if let Some(found) = database.find(name.as_bytes()) {
        return Some(vec![found]);
    }
    let names: Vec<String> = database.objects.iter().map(|object| database.text(object.name)).collect();
    database.errors.add(|| {
        let error = Diagnostic::error(None, format!("the file has no object `{}`", clip(name)));
        match nearest(name, names.iter().map(String::as_str)) {
            Some(near) => error.expected(format!("perhaps `{near}`")),
            None => error,
        }
    });
    None
}

/// The thickness of half spaces.
fn reach(database: &Database) -> f64 {
    let mut all = Bounds::EMPTY;
    for object in &database.objects {
        if let ObjectContent::Solid(solid) = &object.content
            && !matches!(solid.kind, SolidKind::Half | SolidKind::Planes)
            && let Ok(leaf) = leaf::leaf(solid, 1.0, LeafStyle::Plain)
            && leaf.bounds.is_finite()
        {
            let half = 0.5 * (leaf.bounds.max - leaf.bounds.min);
            all = all.hull(Bounds::new(-half, half));
        }
    }
    if all.is_empty() { 1.0 } else { HALF_THICKNESS * all.longest_side() }
}

/// The tree of an object, with colours or without.
#[derive(Default)]
enum ObjectState {
    #[default]
    New,
    Open,
    Done(Built),
}

/// An object that is built.
#[derive(Clone)]
struct Built {
    /// None if it is missing, or nothing is left of it.
    part: Option<SetPart>,
    /// The first colour in it.
    color: Option<[u8; 3]>,
    /// Whether a solid in it has a radius that belongs to no vector.
    has_radius: bool,
}

impl Built {
    const MISSING: Self = Self { part: None, color: None, has_radius: false };
}

/// What is to be done.
#[derive(Clone, Copy)]
enum BuildTask {
    /// Build an object: with colours or without.
    Enter { object: u32, is_plain: bool },
    /// Put a combination together whose members are built.
    Leave { object: u32, is_plain: bool },
}

/// A message about several places: the first one, and how many there are.
struct SolidNote {
    span: Span,
    message: String,
    count: usize,
}

struct TreeBuilder<'a, 'b> {
    database: &'a mut Database<'b>,
    reach: f64,
    style: LeafStyle,
    states: Vec<[ObjectState; 2]>,
    /// The combinations that are open, from the root down.
    path: Vec<u32>,
    nodes: usize,
    notes: Vec<SolidNote>,
    noted: HashMap<String, usize>,
    /// Whether anything has a colour or a constant.
    has_looks: bool,
}

impl TreeBuilder<'_, '_> {
    /// Builds a root. `None` after a message that ends it all.
    fn run(&mut self, root: u32) -> Option<PointSet> {
        let is_plain = self.is_plain(root, !self.has_looks);
        let mut tasks = vec![BuildTask::Enter { object: root, is_plain }];
        while let Some(task) = tasks.pop() {
            match task {
                BuildTask::Enter { object, is_plain } => self.enter(object, is_plain, &mut tasks)?,
                BuildTask::Leave { object, is_plain } => {
                    self.path.pop();
                    let built = self.put_together(object, is_plain)?;
                    self.states[object as usize][usize::from(is_plain)] = ObjectState::Done(built);
                }
            }
            if self.nodes > MAX_NODES {
                let message = format!("the model has more than {MAX_NODES} nodes");
                self.database.errors.add_last(Diagnostic::limit(None, message));
                return None;
            }
        }
        let built = self.built(root, is_plain);
        Some(built.part.map_or(PointSet::MISSING, |part| PointSet::one(part, built.color)))
    }

    /// Only combinations have colours of their own.
    fn is_plain(&self, object: u32, wanted: bool) -> bool {
        wanted || !matches!(self.database.objects[object as usize].content, ObjectContent::Combination(_))
    }

    fn built(&self, object: u32, is_plain: bool) -> Built {
        match &self.states[object as usize][usize::from(is_plain)] {
            ObjectState::Done(built) => built.clone(),
            ObjectState::New | ObjectState::Open => Built::MISSING,
        }
    }

    fn enter(&mut self, object: u32, is_plain: bool, tasks: &mut Vec<BuildTask>) -> Option<()> {
        let states = &self.states[object as usize];
        if matches!(states[usize::from(is_plain)], ObjectState::Done(_)) {
            return Some(());
        }
        if states.iter().any(|state| matches!(state, ObjectState::Open)) {
            return self.circle(object);
        }
        let is_new = states.iter().all(|state| matches!(state, ObjectState::New));
        let entry = &self.database.objects[object as usize];
        let (span, properties) = (entry.span, entry.properties.clone());
        let built = match &entry.content {
            ObjectContent::Combination(made) => {
                let members = members(self.database, made, is_plain || properties.is_region);
                tasks.push(BuildTask::Leave { object, is_plain });
                self.states[object as usize][usize::from(is_plain)] = ObjectState::Open;
                self.path.push(object);
                for (found, name, is_plain) in members.into_iter().rev() {
                    match found {
                        Some(object) => {
                            tasks
                                .push(BuildTask::Enter { object, is_plain: self.is_plain(object, is_plain) });
                        }
                        None if is_new => self.missing(name),
                        None => {}
                    }
                }
                return Some(());
            }
            ObjectContent::Solid(solid) => match leaf::leaf(solid, self.reach, self.style) {
                Ok(leaf) => {
                    self.nodes += leaf.nodes;
                    // Half spaces have no box.
                    let bounds = if leaf.bounds.is_empty() { Bounds::EVERYWHERE } else { leaf.bounds };
                    let part = SetPart { tree: leaf.tree.named(&self.database.node_name(object)), bounds };
                    Built { part: Some(part), color: None, has_radius: leaf.has_radius }
                }
                Err(flaw) => {
                    let word = solid.kind.word();
                    self.add_note(object, span, &format!("this {word} is no solid: {flaw}; it is left out"));
                    Built::MISSING
                }
            },
            ObjectContent::Foreign(kind) => {
                let message = format!("a {kind} has no counterpart here; it is left out");
                self.add_note(object, span, &message);
                Built::MISSING
            }
            ObjectContent::Text => {
                self.add_note(object, span, "this is no solid; it is left out");
                Built::MISSING
            }
        };
        self.states[object as usize][usize::from(is_plain)] = ObjectState::Done(built);
        Some(())
    }

    /// The set of a combination whose members are built.
    fn put_together(&mut self, object: u32, is_plain: bool) -> Option<Built> {
        let entry = &self.database.objects[object as usize];
        let (span, properties) = (entry.span, entry.properties.clone());
        let ObjectContent::Combination(made) = &entry.content else { return Some(Built::MISSING) };
        let below = members(self.database, made, is_plain || properties.is_region);
        let mut operands = Vec::with_capacity(below.len());
        let mut has_radius = false;
        let mut problems = Vec::new();
        for ((found, name, is_plain), member) in below.into_iter().zip(&made.members) {
            let built =
                found.map_or(Built::MISSING, |found| self.built(found, self.is_plain(found, is_plain)));
            let matrix = member.matrix.map(|at| &made.matrices[at as usize]);
            let map = matrix.map_or(Ok(DAffine3::IDENTITY), affine);
            let map = match map {
                Ok(map) => map,
                Err(flaw) => {
                    problems.push((name, flaw));
                    continue;
                }
            };
            if built.has_radius && matrix.is_some_and(|matrix| !is_rigid(matrix)) {
                problems.push((name, String::new()));
            }
            has_radius |= built.has_radius;
            self.nodes += 2;
            operands.push(built.part.map_or(PointSet::MISSING, |part| {
                let moved = |SetPart { tree, bounds }| SetPart {
                    tree: Tree::at(span, map, vec![tree]),
                    bounds: map_bounds(&map, bounds),
                };
                let part = if map == DAffine3::IDENTITY { part } else { moved(part) };
                PointSet::one(part, built.color)
            }));
        }
        let setting = CombinationSetting { span, style: self.style };
        let is_whole = operands.len() == made.members.len();
        let set = if is_whole { evaluate(operands, &made.steps, setting) } else { Some(PointSet::MISSING) };
        self.tell(object, problems)?;
        let Some(set) = set else {
            let path = self.path_to(object);
            let message = format!("{path}: its steps do not fit its members");
            self.database.errors.add(|| Diagnostic::error(Some(span), message));
            return None;
        };
        let own = if is_plain { None } else { self.color(&properties) };
        let color = own.or(set.color);
        let part = set.part(span).map(|part| match own {
            Some(own) => SetPart { tree: colored(part.tree, own, properties.of_looks(), span), ..part },
            None => part,
        });
        let constants = properties.constants().filter(|_| !is_plain);
        let part = part.map(|part| constants.fold(part, |part, one| with_constant(part, one, span)));
        let part =
            part.map(|part| SetPart { tree: part.tree.named(&self.database.node_name(object)), ..part });
        Some(Built { color: color.filter(|_| part.is_some()), part, has_radius })
    }

    /// Matrices that make no map, which are errors, and those of which BRL-CAD makes something else.
    fn tell(&mut self, object: u32, problems: Vec<(Span, String)>) -> Option<()> {
        for (name, flaw) in problems {
            let path = format!("{}/{}", self.path_to(object), clip(&self.database.text(name)));
            if flaw.is_empty() {
                let message =
                    "a matrix scales a solid with a radius of its own, whose radius BRL-CAD would keep";
                self.add_note_at(path, name, message);
            } else {
                self.database.errors.add(|| Diagnostic::error(Some(name), format!("{path}: {flaw}")));
                return None;
            }
        }
        Some(())
    }

    /// The colour of a combination: its own, or what the file has for the number of its region.
    fn color(&self, properties: &Properties) -> Option<[u8; 3]> {
        let of_region = || properties.region.filter(|_| properties.is_region);
        properties.color.or_else(|| self.database.palette_color(of_region()?))
    }

    /// An object that is below itself.
    fn circle(&mut self, object: u32) -> Option<()> {
        let start = self.path.iter().position(|&open| open == object).unwrap_or(0);
        let within = self.path.split_off(start);
        let path = self.shown(within.iter().copied().chain([object]));
        let span = self.database.objects[object as usize].span;
        let message = format!("an object contains itself: {path}");
        self.database.errors.add(|| Diagnostic::error(Some(span), message));
        None
    }

    /// Combinations that no root reaches contain themselves, or are below such.
    fn refuse_circles(&mut self) -> Option<()> {
        for object in 0..self.states.len() as u32 {
            let is_new = self.states[object as usize].iter().all(|state| matches!(state, ObjectState::New));
            if is_new && !matches!(self.database.objects[object as usize].content, ObjectContent::Text) {
                self.run(object)?;
            }
        }
        Some(())
    }

    fn missing(&mut self, name: Span) {
        let shown = clip(&self.database.text(name));
        let path = format!("{}/{shown}", self.shown(self.path.iter().copied()));
        self.add_note_at(path, name, &format!("there is no object `{shown}`; the set is made without it"));
    }

    fn path_to(&self, object: u32) -> String {
        self.shown(self.path.iter().copied().chain([object]))
    }

    /// A path, shortened in its middle.
    fn shown(&self, path: impl Iterator<Item = u32>) -> String {
        let path: Vec<u32> = path.collect();
        let mut shown = String::new();
        for (at, &object) in path.iter().enumerate() {
            if at >= PATH_ENDS && at + PATH_ENDS < path.len() {
                if at == PATH_ENDS {
                    shown.push_str("/..");
                }
                continue;
            }
            shown.push('/');
            shown.push_str(&clip(&self.database.text(self.database.objects[object as usize].name)));
        }
        shown
    }

    fn add_note(&mut self, object: u32, span: Span, message: &str) {
        self.add_note_at(self.path_to(object), span, message);
    }

    /// Notes something; what is said again is counted.
    fn add_note_at(&mut self, path: String, span: Span, message: &str) {
        let next = self.notes.len();
        let at = *self.noted.entry(message.to_owned()).or_insert(next);
        if at == next {
            self.notes.push(SolidNote { span, message: format!("{path}: {message}"), count: 0 });
        }
        self.notes[at].count += 1;
    }

    /// Makes warnings of the notes.
    fn note(&mut self) {
        for SolidNote { span, message, count } in std::mem::take(&mut self.notes) {
            self.database.warnings.add(|| {
                let more = count - 1;
                let others = if more == 0 { String::new() } else { format!(", and {more} more like it") };
                Diagnostic::warning(Some(span), format!("{message}{others}"))
            });
        }
    }
}

/// The members of a combination: the object, if there is one, its name, and whether it is built without
/// colours, as what is subtracted is.
fn members(database: &Database, made: &Combination, is_plain: bool) -> Vec<(Option<u32>, Span, bool)> {
    let count = made.members.len();
    // Where runs of subtracted members begin and end.
    let mut begins = vec![0i64; count + 1];
    let (mut starts, mut next) = (Vec::new(), 0);
    for step in &made.steps {
        match step {
            ProgramStep::Member => {
                starts.push(next);
                next = count.min(next + 1);
            }
            ProgramStep::Complement => {}
            ProgramStep::Union
            | ProgramStep::Intersection
            | ProgramStep::Difference
            | ProgramStep::Exclusive => {
                let right = starts.pop().unwrap_or(next);
                if *step == ProgramStep::Difference {
                    begins[right] += 1;
                    begins[next] -= 1;
                }
            }
        }
    }
    let mut depth = 0;
    let member = |(member, begins): (&super::database::MemberUse, &i64)| {
        depth += begins;
        (database.find(database.at(member.name)), member.name, is_plain || depth > 0)
    };
    made.members.iter().zip(&begins).map(member).collect()
}

/// The result of steps on members; `None` if they do not fit.
fn evaluate(operands: Vec<PointSet>, steps: &[ProgramStep], setting: CombinationSetting) -> Option<PointSet> {
    if steps.is_empty() {
        let union = |all, one| PointSet::combine(ProgramStep::Union, all, one, setting);
        return Some(operands.into_iter().fold(PointSet::MISSING, union));
    }
    let mut members = operands.into_iter();
    let mut stack: Vec<PointSet> = Vec::new();
    for &step in steps {
        let result = match step {
            ProgramStep::Member => members.next()?,
            ProgramStep::Complement => stack.pop()?.complement(setting.span),
            ProgramStep::Union
            | ProgramStep::Intersection
            | ProgramStep::Difference
            | ProgramStep::Exclusive => {
                let (right, left) = (stack.pop()?, stack.pop()?);
                PointSet::combine(step, left, right, setting)
            }
        };
        stack.push(result);
    }
    let whole = stack.pop()?;
    (stack.is_empty() && members.next().is_none()).then_some(whole)
}

/// The map of a matrix by rows, whose last entry divides.
pub(super) fn affine(m: &[f64; 16]) -> Result<DAffine3, Flaw> {
    let scale = m[15];
    if m[12..15].iter().any(|entry| entry.abs() > 1e-12 * scale.abs()) {
        return Err("its matrix is a perspective".to_owned());
    }
    let row = |at: usize| DVec3::new(m[4 * at], m[4 * at + 1], m[4 * at + 2]) / scale;
    let matrix = DMat3::from_cols(row(0), row(1), row(2)).transpose();
    let translation = DVec3::new(m[3], m[7], m[11]) / scale;
    let map = DAffine3 { matrix3: matrix, translation };
    if !map.is_finite() || matrix.determinant() == 0.0 {
        return Err("its matrix has no inverse".to_owned());
    }
    Ok(map)
}

/// Whether the upper part of a matrix is a rotation or a reflection.
fn is_rigid(m: &[f64; 16]) -> bool {
    let row = |at: usize| DVec3::new(m[4 * at], m[4 * at + 1], m[4 * at + 2]);
    let matrix = DMat3::from_cols(row(0), row(1), row(2));
    (matrix * matrix.transpose()).abs_diff_eq(DMat3::IDENTITY, RIGID)
}
