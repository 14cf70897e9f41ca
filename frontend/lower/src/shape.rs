//! Which instances are alike: same node kinds, different numbers.
//!
//! A shape is what selects code. An operator whose only user is an equal one (numbers too, none of which
//! depends on a parameter) dissolves into that, if its member allows it (`flattens`). An instance with
//! several uses is *hoisted*: computed once, where its space begins, and seen by the others as a value. The
//! children of an operator form groups, one for each shape; a group is the rows of one table, unless its
//! shape holds tables of its own and there is one such child: that one is written out.
//!
//! What is written out, and is worth it, gets a *guard*: it is the one row of a table, so that it can be left
//! out where it does not matter.

mod key;

use rustc_hash::FxHashMap as HashMap;

pub(super) use self::key::ShapeId;
use self::key::{Content, ShapeKey};
use super::computed::ComputedShape;
use super::instance::{FieldId, InstanceId, InstanceKind, LeafCode, Scene, SpaceId, children};
use super::names::ComputedId;
pub(super) use super::names::Hoist;
use jbt_model::combine::ReduceCode;

/// The children of an operator that have one shape.
#[derive(Clone, Debug)]
pub(super) struct RowGroup {
    /// Whether they are rows of a table; otherwise they are written out one after the other.
    pub(super) folded: bool,
    /// Children, each with its place in the order of the file; of a run of particles, that of the first of
    /// the node.
    pub(super) members: Vec<(InstanceId, u32)>,
}

/// Operations of a formula that cost as much as a leaf.
const STEPS_OF_A_LEAF: usize = 16;

/// How many operations of formulas the attributes of a leaf take, where it stands.
fn steps_of(scene: &Scene<'_>, computed: &[Option<ComputedId>]) -> usize {
    let here = computed.iter().flatten().map(|&id| scene.computed(id)).filter(|computed| !computed.shared);
    here.map(|computed| computed.kind.steps()).sum()
}

/// The shapes of a scene.
pub(super) struct Shapes {
    /// Groups of each operator that has not been flattened into another.
    groups: HashMap<InstanceId, Vec<RowGroup>>,
    hoists: HashMap<SpaceId, Vec<Hoist>>,
    /// Of each instance, where it is computed. Not of those that have been flattened.
    contents: Vec<Content>,
}

impl Shapes {
    /// Finds the shape of every instance.
    pub(super) fn new(scene: &Scene<'_>) -> Self {
        Classifier::new(scene).run()
    }

    /// The groups of an operator, in the order of their code.
    pub(super) fn groups(&self, id: InstanceId) -> &[RowGroup] {
        &self.groups[&id]
    }

    /// Whether it holds a formula of the point, of which no support is known.
    pub(super) fn holds_formulas(&self, id: InstanceId) -> bool {
        self.contents[id.0 as usize].formulas
    }

    /// Whether an operand that is not a row is computed under a guard, inside of `depth` folds. What is
    /// hoisted is not: its value is there.
    pub(super) fn guards_operand(&self, scene: &Scene<'_>, id: InstanceId, depth: usize) -> bool {
        let content = self.contents[id.0 as usize];
        // Without tables of its own it may stand in a row, whose shape guards must not change.
        scene.instance(id).uses == 1 && content.written_out && content.wants_guard(depth)
    }

    /// Whether what is hoisted is computed under a guard, inside of `depth` folds: because some choices of
    /// selectors do without it, or because it is worth one.
    pub(super) fn guards_hoisted(&self, scene: &Scene<'_>, hoist: Hoist, depth: usize) -> bool {
        let worth = match hoist {
            Hoist::Instance(id) => self.contents[id.0 as usize].wants_guard(depth),
            Hoist::Field(_) | Hoist::Space(_) | Hoist::Computed(_) => false,
        };
        worth || scene.demand.is_guarded(hoist)
    }

    /// What is hoisted to the start of a space.
    pub(super) fn hoists(&self, space: SpaceId) -> &[Hoist] {
        self.hoists.get(&space).map_or(&[], Vec::as_slice)
    }
}

struct Classifier<'a> {
    scene: &'a Scene<'a>,
    names: HashMap<ShapeKey, ShapeId>,
    /// By shape.
    contents: Vec<Content>,
    /// The shape of each instance, as its user sees it.
    shapes: Vec<ShapeId>,
    /// The last leaf that computes no attribute, and its shape: the next one is like it as a rule.
    last_leaf: Option<(LeafCode, ShapeId)>,
    /// Whether an operator dissolves into its only user.
    flattened: Vec<bool>,
    /// Weighted warps whose points are hoisted already.
    entered: rustc_hash::FxHashSet<SpaceId>,
    result: Shapes,
}

impl<'a> Classifier<'a> {
    fn new(scene: &'a Scene<'a>) -> Self {
        let result = Shapes { groups: HashMap::default(), hoists: HashMap::default(), contents: Vec::new() };
        let flattened = flattened(scene);
        Self {
            scene,
            names: HashMap::default(),
            contents: Vec::new(),
            shapes: Vec::with_capacity(scene.instances.len()),
            last_leaf: None,
            flattened,
            entered: rustc_hash::FxHashSet::default(),
            result,
        }
    }

    fn run(mut self) -> Shapes {
        // First of all: what is hoisted behind them may hold leaves that are bound to them.
        for (index, computed) in self.scene.computed.iter().enumerate().filter(|(_, it)| it.shared) {
            let hoist = Hoist::Computed(ComputedId(index as u32));
            self.result.hoists.entry(computed.space).or_default().push(hoist);
        }
        for (index, field) in self.scene.fields.iter().enumerate() {
            if field.uses > 1 {
                let space = self.scene.position(field.position).space;
                self.result.hoists.entry(space).or_default().push(Hoist::Field(FieldId(index as u32)));
            }
        }
        for (index, inside) in self.scene.insides.iter().enumerate() {
            let space = SpaceId(index as u32 + 1);
            // A weighted one comes behind its weight.
            if self.scene.is_shared(space) && inside.weight.is_none() {
                let outside = self.scene.position(inside.position).space;
                self.result.hoists.entry(outside).or_default().push(Hoist::Space(space));
            }
        }
        for index in 0..self.scene.instances.len() {
            let id = InstanceId(index as u32);
            self.hoist_weighted(id);
            let shape = self.shape(id);
            let instance = self.scene.instance(id);
            self.result.contents.push(self.contents[shape.0 as usize]);
            let shape = if instance.uses > 1 {
                self.result.hoists.entry(instance.space).or_default().push(Hoist::Instance(id));
                self.name(ShapeKey::Hoisted(id), Content::HOISTED)
            } else {
                shape
            };
            self.shapes.push(shape);
        }
        self.result
    }

    /// Hoists the point inside of a weighted warp that several instances share, when the first of them is
    /// met: its weight, and whatever that is made of, came before.
    fn hoist_weighted(&mut self, id: InstanceId) {
        let instance = self.scene.instance(id);
        let InstanceKind::Warp { inside, weight: Some(_), .. } = instance.kind else { return };
        let shared = self.scene.is_shared(inside);
        if shared && self.entered.insert(inside) {
            self.result.hoists.entry(instance.space).or_default().push(Hoist::Space(inside));
        }
    }

    fn name(&mut self, key: ShapeKey, content: Content) -> ShapeId {
        let next = ShapeId(self.contents.len() as u32);
        let id = *self.names.entry(key).or_insert(next);
        if id == next {
            self.contents.push(content);
        }
        id
    }

    fn of(&self, id: InstanceId) -> (ShapeId, Content) {
        let shape = self.shapes[id.0 as usize];
        (shape, self.contents[shape.0 as usize])
    }

    /// The shape of an instance whose children have theirs.
    fn shape(&mut self, id: InstanceId) -> ShapeId {
        jbt_ir::watch::look();
        let instance = self.scene.instance(id);
        match &instance.kind {
            InstanceKind::Leaf { field, computed, .. } if self.scene.field(*field).uses > 1 => {
                let computed = self.computed(computed, instance.space);
                self.name(ShapeKey::LeafOf(*field, computed), Content::HOISTED)
            }
            InstanceKind::Leaf { field, computed, .. } => self.leaf(*field, computed, instance.space),
            InstanceKind::Warp { .. } => self.warp(id),
            InstanceKind::Difference { left, right } => {
                let ((left, content), (right, other)) = (self.of(*left), self.of(*right));
                self.name(ShapeKey::Difference { left, right }, content.and(other))
            }
            InstanceKind::Map { code, child } => {
                let (child, content) = self.of(*child);
                self.name(ShapeKey::Map { code: *code, child }, content)
            }
            InstanceKind::Expression { .. } => self.expression(id),
            InstanceKind::Select { children, .. } => {
                let children = children.iter().map(|child| self.of(*child).0).collect();
                // Each child is a row of a table of its own.
                self.name(ShapeKey::Select(children), Content::ROWS)
            }
            InstanceKind::Reduce { .. } if self.flattened[id.0 as usize] => {
                // Its user asks for its children; nobody asks for its shape.
                self.name(ShapeKey::Hoisted(id), Content::HOISTED)
            }
            InstanceKind::Reduce { code, .. } => self.reduce(id, *code),
        }
    }

    /// The shape of a leaf with its own field.
    fn leaf(&mut self, field: FieldId, computed: &[Option<ComputedId>], space: SpaceId) -> ShapeId {
        let code = self.scene.field(field).code;
        let is_plain = computed.is_empty();
        if let Some((last, shape)) = self.last_leaf
            && is_plain
            && last == code
        {
            return shape;
        }
        let key = ShapeKey::Leaf(code, self.computed(computed, space));
        let tables = code.skeleton.pieces().is_some();
        let leaves = 1 + steps_of(self.scene, computed) / STEPS_OF_A_LEAF;
        let shape = self.name(key, Content { tables, leaves, ..Content::LEAF });
        if is_plain {
            self.last_leaf = Some((code, shape));
        }
        shape
    }

    /// The shape of a warp, with what is below it.
    fn warp(&mut self, id: InstanceId) -> ShapeId {
        let instance = self.scene.instance(id);
        let InstanceKind::Warp { position, inside, child, weight } = &instance.kind else {
            unreachable!("it is a warp")
        };
        let (child, mut content) = self.of(*child);
        let weight = weight.map(|weight| self.of(weight).0);
        // A weight is a hoisted value.
        content.written_out |= weight.is_some();
        if self.scene.is_shared(*inside) {
            content.written_out = true;
            return self.name(ShapeKey::Inside { space: *inside, child }, content);
        }
        // What is hoisted to the start of this space has to be visible to all of it, so the warp
        // stands alone.
        let hoists = self.result.hoists.get(inside);
        let pinned = hoists.map(|_| *inside);
        content.written_out |= pinned.is_some();
        content.leaves = content.leaves.saturating_add(hoists.map_or(0, Vec::len));
        let map = self.scene.position(*position).kind();
        let warp = self.scene.warp(instance.node).code();
        let key = ShapeKey::Warp { map, warp, child, weight, pinned };
        self.name(key, content)
    }

    /// The shape of an operator, whose children of one shape are a group.
    fn reduce(&mut self, id: InstanceId, code: ReduceCode) -> ShapeId {
        let groups = self.group(id, code);
        let content = groups.iter().fold(Content::HOISTED, |all, group| {
            let of = |member: &(InstanceId, u32)| self.of(member.0).1;
            match group.folded {
                true => all.and(Content { formulas: of(&group.members[0]).formulas, ..Content::ROWS }),
                false => group.members.iter().fold(all, |all, member| all.and(of(member))),
            }
        });
        let key = ShapeKey::Reduce {
            code,
            non_negative: non_negative(self.scene, &groups),
            groups: groups
                .iter()
                .map(|group| {
                    let (shape, _) = self.of(group.members[0].0);
                    (shape, if group.folded { 0 } else { group.members.len() })
                })
                .collect(),
        };
        self.result.groups.insert(id, groups);
        self.name(key, content)
    }

    /// The shape of a formula: its form, and whether it asks for the point.
    fn expression(&mut self, id: InstanceId) -> ShapeId {
        let instance = self.scene.instance(id);
        let InstanceKind::Expression { position, children, computed, .. } = &instance.kind else {
            unreachable!("only formulas have forms")
        };
        let form = self.scene.expression(instance.node).shared_form();
        let steps = form.steps() + steps_of(self.scene, computed);
        let formulas = children.is_empty();
        let own = Content { leaves: 1 + steps / STEPS_OF_A_LEAF, formulas, ..Content::LEAF };
        let content = children.iter().fold(own, |all, &child| all.and(self.of(child).1));
        let key = ShapeKey::Expression {
            map: form.asks_point().then(|| self.scene.position(*position).kind()),
            form,
            vanishes: self.scene.vanishes(instance.node),
            non_negative: instance.non_negative,
            children: children.iter().map(|&child| self.of(child).0).collect(),
            computed: self.computed(computed, instance.space),
        };
        self.name(key, content)
    }

    /// What computed values are as code, for a leaf in a space.
    fn computed(&self, computed: &[Option<ComputedId>], space: SpaceId) -> Box<[Option<ComputedShape>]> {
        let shape = |id: ComputedId| {
            let computed = self.scene.computed(id);
            if computed.shared {
                return ComputedShape::Shared(id);
            }
            let up = self.scene.spaces_between(computed.space, space);
            ComputedShape::Here { up, map: computed.map_kind, kind: computed.kind.clone() }
        };
        computed.iter().map(|id| id.map(shape)).collect()
    }

    /// The operands of an operator, those of flattened ones among them, by shape.
    fn group(&self, id: InstanceId, code: ReduceCode) -> Vec<RowGroup> {
        match code {
            ReduceCode::Step(_) => return self.runs(id),
            ReduceCode::Fold(_) | ReduceCode::Choice(_) => {}
        }
        let mut by_shape: HashMap<ShapeId, Vec<(InstanceId, u32)>> = HashMap::default();
        let mut stack = vec![id];
        let mut order = 0;
        while let Some(next) = stack.pop() {
            match &self.scene.instance(next).kind {
                InstanceKind::Reduce { children, .. } if next == id || self.flattened[next.0 as usize] => {
                    stack.extend(children.iter().rev());
                }
                InstanceKind::Reduce { .. }
                | InstanceKind::Leaf { .. }
                | InstanceKind::Warp { .. }
                | InstanceKind::Map { .. }
                | InstanceKind::Expression { .. }
                | InstanceKind::Select { .. }
                | InstanceKind::Difference { .. } => {
                    by_shape.entry(self.of(next).0).or_default().push((next, order));
                    order += self.scene.run(next).map_or(1, |run| run.places);
                }
            }
        }
        let mut by_shape: Vec<_> = by_shape.into_iter().collect();
        by_shape.sort_unstable_by_key(|(shape, _)| *shape);
        by_shape
            .into_iter()
            .map(|(_, members)| RowGroup { folded: self.is_folded(&members), members })
            .collect()
    }

    /// The operands of a step: the first alone, the others as runs of one shape.
    fn runs(&self, id: InstanceId) -> Vec<RowGroup> {
        let mut members = children(&self.scene.instance(id).kind).zip(0..);
        let first = members.next().expect("an operator has children");
        let mut groups = vec![RowGroup { folded: false, members: vec![first] }];
        for member in members {
            let shape = self.of(member.0).0;
            match groups.last_mut() {
                Some(run) if run.members[0].1 > 0 && self.of(run.members[0].0).0 == shape => {
                    run.members.push(member);
                }
                _ => groups.push(RowGroup { folded: false, members: vec![member] }),
            }
        }
        for run in &mut groups[1..] {
            run.folded = self.is_folded(&run.members);
        }
        groups
    }

    /// Whether operands of one shape are rows of a table.
    fn is_folded(&self, members: &[(InstanceId, u32)]) -> bool {
        let first = members[0].0;
        let hoisted = self.scene.instance(first).uses > 1;
        let written_out = self.of(first).1.written_out;
        !written_out || (members.len() > 1 && !hoisted && !self.is_leaf(first))
    }

    fn is_leaf(&self, id: InstanceId) -> bool {
        matches!(self.scene.instance(id).kind, InstanceKind::Leaf { .. })
    }
}

/// Whether no operand can be negative.
pub(super) fn non_negative(scene: &Scene<'_>, groups: &[RowGroup]) -> bool {
    let mut members = groups.iter().flat_map(|group| &group.members);
    members.all(|(member, _)| scene.instance(*member).non_negative)
}

/// Whether no operand is further from 0 than [`LARGEST_FIELD`](jbt_model::expression::LARGEST_FIELD).
pub(super) fn bounded(scene: &Scene<'_>, groups: &[RowGroup]) -> bool {
    groups.iter().flat_map(|group| &group.members).all(|(member, _)| scene.instance(*member).bounded)
}

/// Which operators dissolve into the operator that uses them: equal ones, one use, and the same answers
/// either way.
fn flattened(scene: &Scene<'_>) -> Vec<bool> {
    let mut flattened = vec![false; scene.instances.len()];
    for instance in &scene.instances {
        let InstanceKind::Reduce { operator, children, .. } = &instance.kind else { continue };
        let fixed = |node| scene.tree.dependent(node).is_none();
        for child in children {
            let inner = scene.instance(*child);
            if let InstanceKind::Reduce { operator: nested, children: operands, .. } = &inner.kind {
                let non_negative = || operands.iter().all(|id| scene.instance(*id).non_negative);
                // Neither may depend on a parameter: exponents that are equal now may differ later.
                let fixed = fixed(instance.node) && fixed(inner.node);
                let like = fixed && nested == operator && inner.uses == 1;
                flattened[child.0 as usize] = like && operator.flattens(non_negative());
            }
        }
    }
    flattened
}
