//! How instances are found: a walk from the root that remembers what it has met, by node, position and
//! bindings.

use glam::{DAffine3, DVec3};
use jbt_ir::watch;
use rustc_hash::FxHashMap as HashMap;

use super::asked;
use super::{
    BindingsId, Bound, FieldId, Inside, Instance, InstanceId, InstanceKind, LeafCode, LeafField, PositionId,
    Scene, SpaceId, children,
};
use crate::computed::share;
use crate::demand::Demand;
use crate::names::ComputedId;
use crate::position::{Position, PositionKey, Trails, position_key};
use jbt_model::check::{CheckedTree, NodeId};
use jbt_model::combine::{Combinator, Extreme, OperatorForm, ReduceCode, Union};
use jbt_model::expression::Expression;
use jbt_model::kind::{NodeKind, Primitive, chosen};
use jbt_model::origin::ModelOrigin;
use jbt_model::written::{Freedom, Written};

impl<'a> Scene<'a> {
    /// Finds every instance, without recursion. All attribute groups count, whatever is asked: so the
    /// tables of a tree, which are made of its instances, have the same rows for every query.
    pub(crate) fn new(tree: &'a CheckedTree) -> Self {
        Finder::new(tree).run()
    }
}

/// What is known of an instance besides its place in the lists: its names, lists of its own. An estimate.
const INSTANCE_BYTES: usize = 128;

/// A node and what its ancestors say about it.
type Key = (NodeId, PositionId, BindingsId);

/// A node on its way to becoming an instance.
struct Frame {
    key: Key,
    /// Children that are done.
    children: Vec<InstanceId>,
    /// The inside of a warp.
    inside: Option<(SpaceId, PositionId)>,
}

/// What is known so far.
pub(super) struct Finder<'a> {
    pub(super) scene: Scene<'a>,
    /// Numbers of the file are keys here: a hash that nobody can prepare for.
    position_names: std::collections::HashMap<PositionKey, PositionId>,
    trails: Trails,
    pub(super) bindings_names: HashMap<Box<[Option<Bound>]>, BindingsId>,
    /// How many sets of bindings there are.
    pub(super) bindings_count: u32,
    /// The bindings of the path in progress.
    pub(super) bound: Vec<Option<Bound>>,
    /// By attribute node, where that or the leaf stands, and the leaf, if it is the leaf's.
    pub(super) computed_names: HashMap<(NodeId, PositionId, Option<NodeId>), ComputedId>,
    field_names: HashMap<(NodeId, PositionId), FieldId>,
    inside_names: HashMap<(NodeId, PositionId), (SpaceId, PositionId)>,
    known: HashMap<Key, InstanceId>,
    /// For each node, whether one path leads to it from the root: then it is met once, and nothing has to be
    /// remembered of it.
    once: Vec<bool>,
    /// Whether there is a selector.
    selects: bool,
    /// No attribute is bound: what a weight's attributes are does not matter.
    unbound: BindingsId,
    stack: Vec<Frame>,
}

impl<'a> Finder<'a> {
    pub(super) fn new(tree: &'a CheckedTree) -> Self {
        // As much as there is room for below.
        let each = size_of::<Instance>() + size_of::<LeafField>() / 2 + size_of::<Position>() / 4;
        watch::take(tree.nodes().len() * each);
        let once: Vec<bool> = tree.uses().iter().map(|&uses| uses == 1).collect();
        let scene = Scene {
            tree,
            // Large ones are moved as they grow: there is room for a tree without sharing.
            instances: Vec::with_capacity(once.len()),
            fields: Vec::with_capacity(once.len() / 2),
            root: InstanceId(0),
            positions: Vec::with_capacity(once.len() / 4),
            bindings: Vec::with_capacity(once.len() / 4),
            computed: Vec::new(),
            insides: Vec::new(),
            demand: Demand::ALL,
            has_runs: false,
        };
        Self {
            scene,
            position_names: std::collections::HashMap::new(),
            trails: Trails::default(),
            bindings_names: HashMap::default(),
            bindings_count: 0,
            bound: Vec::new(),
            computed_names: HashMap::default(),
            field_names: HashMap::default(),
            inside_names: HashMap::default(),
            known: HashMap::default(),
            once,
            selects: false,
            unbound: BindingsId(0),
            stack: Vec::new(),
        }
    }

    pub(super) fn run(mut self) -> Scene<'a> {
        let world = self.name_position(Position::world(self.scene.tree.origin()));
        self.bound = vec![None; self.scene.tree.attributes().len()];
        self.unbound = self.name_bindings();
        let root = self.resolve((self.scene.tree.root(), world, self.unbound));
        let mut done = self.enter(root);
        while let Some(frame) = self.stack.last_mut() {
            watch::look();
            if let Some(id) = done.take() {
                frame.children.push(id);
            }
            let (node, position, bindings) = frame.key;
            match self.scene.tree.node(node).children.get(frame.children.len()) {
                Some(&child) => {
                    let key = match frame.inside {
                        Some(_) if !frame.children.is_empty() => (child, position, self.unbound),
                        Some((_, inside)) => (child, inside, bindings),
                        None => (child, position, bindings),
                    };
                    let key = self.resolve(key);
                    done = self.enter(key);
                }
                None => {
                    let frame = self.stack.pop().expect("the loop looked at it");
                    done = Some(self.leave(frame));
                }
            }
        }
        self.scene.root = done.expect("the last frame was the root");
        self.scene.instances[self.scene.root.0 as usize].uses += 1;
        share(&mut self.scene.computed);
        if self.selects {
            self.scene.demand = asked::demand(&self.scene);
        }
        self.scene
    }

    /// Walks through affine, attribute and pass-through nodes to the node that does something.
    fn resolve(&mut self, (mut node, position, bindings): Key) -> Key {
        // Where the path has come to, once a map has moved it.
        let mut moved: Option<Position> = None;
        let mut rebound = false;
        loop {
            let data = self.scene.tree.node(node);
            match &data.kind {
                NodeKind::Affine(inner) => {
                    let Position { space, map, trail } =
                        moved.unwrap_or_else(|| *self.scene.position(position));
                    let trail = match self.scene.tree.dependent(node) {
                        None => trail.fixed(inner, self.scene.tree.depends_on_parameters()),
                        Some(written) => {
                            let name = self.trails.name(
                                position_key(space, trail.name, &trail.since),
                                node,
                                written,
                            );
                            trail.free(name, written.freedom())
                        }
                    };
                    moved = Some(Position { space, map: map * *inner, trail });
                }
                // Programs know no constants.
                NodeKind::Constant { .. } => {}
                NodeKind::Attribute { name, value, .. } => {
                    let groups = self.scene.tree.attributes();
                    let group = groups.iter().position(|group| group.name == *name);
                    let above = if rebound { &self.bound[..] } else { self.scene.bindings(bindings) };
                    let stays =
                        |group: &usize| above[*group].is_some_and(|bound| self.scene.overrides(bound));
                    if let Some(group) = group.filter(|group| !stays(group)) {
                        let placed = value.is_placed() || groups[group].turns();
                        let place = || moved.unwrap_or_else(|| *self.scene.position(position));
                        let at = placed.then(place).map(|place| self.name_position(place));
                        if !std::mem::replace(&mut rebound, true) {
                            self.bound.clear();
                            self.bound.extend_from_slice(self.scene.bindings(bindings));
                        }
                        self.bound[group] = Some(Bound { node, at });
                    }
                }
                NodeKind::Combine(combinator) if data.children.len() == 1 && combinator.passes_single() => {}
                NodeKind::Select(_) if data.children.len() == 1 => {}
                NodeKind::Combine(_)
                | NodeKind::Expression(_)
                | NodeKind::Select(_)
                | NodeKind::Primitive(_)
                | NodeKind::Particles(_)
                | NodeKind::Warp(_) => {
                    // Nobody asks again for what is met once and has nothing below it that others meet: it
                    // needs no name.
                    let alone = self.once[node.0 as usize] && data.children.is_empty();
                    let position = match (moved, alone) {
                        (None, _) => position,
                        (Some(place), false) => self.name_position(place),
                        (Some(place), true) => self.push_position(place),
                    };
                    let bindings = match (rebound, alone) {
                        (false, _) => bindings,
                        (true, false) => self.name_bindings(),
                        (true, true) => self.push_bindings(),
                    };
                    return (node, position, bindings);
                }
            }
            node = data.children[0];
        }
    }

    /// The instance, if it is known; otherwise it goes on the stack.
    fn enter(&mut self, key: Key) -> Option<InstanceId> {
        if !self.once[key.0.0 as usize]
            && let Some(&known) = self.known.get(&key)
        {
            return Some(known);
        }
        let node = self.scene.tree.node(key.0);
        let frame = Frame { key, children: Vec::new(), inside: None };
        if node.children.is_empty() {
            return Some(self.leave(frame));
        }
        let is_warp = matches!(node.kind, NodeKind::Warp(_));
        let inside = is_warp.then(|| self.name_inside(key.0, key.1));
        self.stack.push(Frame { inside, ..frame });
        None
    }

    /// Makes an instance of a node whose children are done, and remembers it if it can be met again.
    fn leave(&mut self, frame: Frame) -> InstanceId {
        let key = frame.key;
        let Scene { instances, fields, positions, .. } = &self.scene;
        let grown = watch::growth(instances, 1) + watch::growth(fields, 1) + watch::growth(positions, 1);
        watch::take(INSTANCE_BYTES + grown);
        let id = self.close(frame);
        if !self.once[key.0.0 as usize] {
            self.known.insert(key, id);
        }
        id
    }

    /// Makes an instance of a node whose children are done.
    fn close(&mut self, frame: Frame) -> InstanceId {
        let (node, position, bindings) = frame.key;
        let kind = match &self.scene.tree.node(node).kind {
            NodeKind::Primitive(primitive) => {
                let field = self.field(node, primitive, position);
                let computed = self.computed(bindings, (node, 1), position);
                InstanceKind::Leaf { field, bindings, computed }
            }
            NodeKind::Particles(particles) => self.particles(node, particles, position, bindings),
            NodeKind::Warp(_) => {
                let (inside, _) = frame.inside.expect("a warp's frame has its inside");
                let weight = frame.children.get(1).copied();
                self.scene.insides[inside.0 as usize - 1].weight = weight;
                InstanceKind::Warp { position, inside, child: frame.children[0], weight }
            }
            NodeKind::Combine(combinator) => self.operator(node, *combinator, position, frame.children),
            NodeKind::Expression(expression) => {
                let children = frame.children;
                let is_leaf = children.is_empty();
                let computed =
                    if is_leaf { self.computed(bindings, (node, 1), position) } else { Box::default() };
                let (position, shift) = self.near_box(node, expression, position);
                InstanceKind::Expression { position, shift, bindings, children, computed }
            }
            NodeKind::Select(which) => {
                self.selects = true;
                InstanceKind::Select { children: frame.children, chosen: chosen(*which) }
            }
            NodeKind::Affine(_) | NodeKind::Attribute { .. } | NodeKind::Constant { .. } => {
                unreachable!("resolve walks through these")
            }
        };
        self.push(node, position, kind)
    }

    /// Where a formula is asked that compares the point with the sides of its box and with nothing else: in
    /// coordinates that begin near the box, and where these begin. In a model that counts from the world they
    /// are those of its space.
    fn near_box(
        &mut self,
        node: NodeId,
        expression: &Expression,
        position: PositionId,
    ) -> (PositionId, DVec3) {
        let is_world = self.scene.tree.origin().is_world();
        let Some(bounds) = expression.bounds().filter(|_| !is_world && !expression.form().asks_coordinates())
        else {
            return (position, DVec3::ZERO);
        };
        let shift = DVec3::from(ModelOrigin::of(bounds).point());
        let inner = DAffine3::from_translation(shift);
        let Position { space, map, trail } = *self.scene.position(position);
        let trail = match self.scene.tree.dependent(node) {
            None if shift == DVec3::ZERO => return (position, shift),
            None => trail.fixed(&inner, false),
            // A box that depends on parameters may come near and go far.
            Some(written) => {
                let name = self.trails.name(position_key(space, trail.name, &trail.since), node, written);
                trail.free(name, Freedom::Fixed)
            }
        };
        (self.name_position(Position { space, map: map * inner, trail }), shift)
    }

    /// The instance of an operator whose children are done.
    fn operator(
        &mut self,
        node: NodeId,
        combinator: Combinator,
        position: PositionId,
        children: Vec<InstanceId>,
    ) -> InstanceKind {
        let depends = self.scene.tree.dependent(node).is_some();
        let operator = if depends { combinator } else { combinator.simplest() };
        match operator.form(depends) {
            OperatorForm::Reduce(code) => InstanceKind::Reduce { operator, code, children },
            OperatorForm::Difference => self.difference(node, position, &children),
            OperatorForm::Map(code) => InstanceKind::Map { code, child: children[0] },
        }
    }

    /// The field of a leaf at a position.
    fn field(&mut self, node: NodeId, primitive: &Primitive, position: PositionId) -> FieldId {
        let next = FieldId(self.scene.fields.len() as u32);
        let once = self.once[node.0 as usize];
        let id = if once { next } else { *self.field_names.entry((node, position)).or_insert(next) };
        if id == next {
            let written = self.scene.tree.dependent(node);
            let turns = written.is_some_and(Written::skeleton_turns);
            let (map, scale, inverse) = self.scene.position(position).of_skeleton(&primitive.skeleton, turns);
            let strong =
                primitive.strength != 1.0 || written.is_some_and(Written::strength_depends_on_parameters);
            let falloff = primitive.falloff.code(written.is_some_and(Written::falloff_depends_on_parameters));
            let code = LeafCode { map: inverse, skeleton: primitive.skeleton.kind(), falloff, strong };
            self.scene.fields.push(LeafField { node, position, uses: 0, map, scale, code, run: None });
        }
        self.scene.fields[id.0 as usize].uses += 1;
        id
    }

    /// The first child without the union of the others.
    fn difference(&mut self, node: NodeId, position: PositionId, children: &[InstanceId]) -> InstanceKind {
        let right = match children[1..] {
            [only] => only,
            _ => {
                let (operator, children) = (Union {}.into(), children[1..].to_vec());
                let code = ReduceCode::Choice(Extreme::Largest);
                self.push(node, position, InstanceKind::Reduce { operator, code, children })
            }
        };
        InstanceKind::Difference { left: children[0], right }
    }

    pub(super) fn push(&mut self, node: NodeId, position: PositionId, kind: InstanceKind) -> InstanceId {
        let space = self.scene.position(position).space;
        let (non_negative, bounded) = (self.non_negative(node, &kind), self.bounded(&kind));
        children(&kind).for_each(|child| self.scene.instances[child.0 as usize].uses += 1);
        if let InstanceKind::Warp { weight: Some(weight), .. } = kind {
            // The point inside uses it once more, so that it is hoisted: known before any row that enters.
            self.scene.instances[weight.0 as usize].uses += 1;
        }
        self.scene.instances.push(Instance { node, kind, space, uses: 0, non_negative, bounded });
        InstanceId(self.scene.instances.len() as u32 - 1)
    }

    fn non_negative(&self, node: NodeId, kind: &InstanceKind) -> bool {
        let of = |id: &InstanceId| self.scene.instance(*id).non_negative;
        match kind {
            InstanceKind::Leaf { field, .. } => {
                let leaf = self.scene.field(*field);
                if let Some(run) = &leaf.run {
                    return run.non_negative;
                }
                let written = self.scene.tree.dependent(leaf.node);
                let depends = written.is_some_and(Written::strength_depends_on_parameters);
                self.scene.primitive(*field).strength >= 0.0 && !depends
            }
            InstanceKind::Warp { child, .. } => of(child),
            InstanceKind::Difference { left, .. } => of(left),
            InstanceKind::Map { child, .. } => {
                let fixed = self.scene.tree.dependent(node).is_none();
                self.scene.combinator(node).is_non_negative(&mut std::iter::once(of(child)), fixed)
            }
            InstanceKind::Expression { children, .. } => {
                let signs: Vec<bool> = children.iter().map(of).collect();
                let known = |number: usize| self.scene.fixed_number(node, number);
                let positive = |number| known(number).is_some_and(|value| value >= 0.0);
                self.scene.expression(node).form().non_negative(&signs, positive)
            }
            InstanceKind::Select { children, .. } => children.iter().all(of),
            InstanceKind::Reduce { operator, children, .. } => {
                let fixed = self.scene.tree.dependent(node).is_none();
                operator.is_non_negative(&mut children.iter().map(of), fixed)
            }
        }
    }

    /// Of a formula, and of whatever gives the field of one of its children and nothing else.
    fn bounded(&self, kind: &InstanceKind) -> bool {
        let of = |id: &InstanceId| self.scene.instance(*id).bounded;
        match kind {
            InstanceKind::Expression { .. } => true,
            InstanceKind::Warp { child, .. } => of(child),
            InstanceKind::Select { children, .. }
            | InstanceKind::Reduce { code: ReduceCode::Choice(_), children, .. } => children.iter().all(of),
            InstanceKind::Leaf { .. }
            | InstanceKind::Difference { .. }
            | InstanceKind::Map { .. }
            | InstanceKind::Reduce { .. } => false,
        }
    }

    /// The space inside a warp at a position, and the position of the warp's child there.
    fn name_inside(&mut self, warp: NodeId, position: PositionId) -> (SpaceId, PositionId) {
        let once = self.once[warp.0 as usize];
        if !once && let Some(&(space, inside)) = self.inside_names.get(&(warp, position)) {
            self.scene.insides[space.0 as usize - 1].uses += 1;
            return (space, inside);
        }
        self.scene.insides.push(Inside { warp, position, weight: None, uses: 1 });
        let space = SpaceId(self.scene.insides.len() as u32);
        let inside = self.name_position(Position::start(space));
        if !once {
            self.inside_names.insert((warp, position), (space, inside));
        }
        (space, inside)
    }

    fn name_position(&mut self, position: Position) -> PositionId {
        let Position { space, trail, .. } = position;
        let next = PositionId(self.scene.positions.len() as u32);
        let key = position_key(space, trail.name, &trail.since);
        let id = *self.position_names.entry(key).or_insert(next);
        if id == next { self.push_position(position) } else { id }
    }

    fn push_position(&mut self, position: Position) -> PositionId {
        self.scene.positions.push(position);
        PositionId(self.scene.positions.len() as u32 - 1)
    }
}
