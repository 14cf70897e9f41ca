//! What stands where: the tree with affine and attribute nodes dissolved into positions and bindings.
//!
//! An *instance* is a node at a position with attribute bindings. A node that is reached twice with the
//! same of each is one instance with two uses; under other coordinates it is another one.

use std::borrow::Cow;
use std::slice::from_ref;

use glam::{DAffine3, DVec3};

use super::computed::Computed;
use super::demand::Demand;
use super::names::ComputedId;
pub(super) use super::names::{BindingsId, FieldId, InstanceId, PositionId, SpaceId};
use super::position::{MapKind, Position};
use super::run::{LeafNumbers, PointRun};
use jbt_model::check::{CheckedTree, NodeId};
use jbt_model::combine::{Combinator, MapCode, ReduceCode};
use jbt_model::expression::Expression;
use jbt_model::falloff::FalloffKind;
use jbt_model::kind::{NodeKind, Primitive};
use jbt_model::particles::Particles;
use jbt_model::skeleton::{Skeleton, SkeletonKind};
use jbt_model::warp::Warp;
use jbt_model::written::Written;

mod asked;
mod binding;
mod find;
mod particles;

/// What a leaf is bound to, of one attribute group.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct Bound {
    /// The attribute node.
    pub(super) node: NodeId,
    /// Where it stands, if what it gives depends on that.
    pub(super) at: Option<PositionId>,
}

/// The inside of a warp.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inside {
    pub(super) warp: NodeId,
    /// Where the warp stands.
    pub(super) position: PositionId,
    /// Whose field is its weight, if it has one: known once its instance is.
    pub(super) weight: Option<InstanceId>,
    /// How many instances, with different attributes, lead into it.
    pub(super) uses: u32,
}

/// A leaf at a position, or a run of particles.
#[derive(Clone, Debug)]
pub(super) struct LeafField {
    pub(super) node: NodeId,
    pub(super) position: PositionId,
    /// How many instances, with different attributes, have this field.
    pub(super) uses: u32,
    /// The map from the pose to the space in which the leaf is asked; rows hold its inverse. In the pose the
    /// skeleton is [`scale`](Self::scale) times as large as it was written. Of a run, that of the first one.
    pub(super) map: DAffine3,
    /// How many times as large as it was written the skeleton is in its pose. A similarity ends up here;
    /// other maps leave it at 1.
    pub(super) scale: f64,
    pub(super) code: LeafCode,
    /// Which particles it stands for, if it is no primitive.
    pub(super) run: Option<Box<PointRun>>,
}

/// What a leaf without computed attributes is as code.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct LeafCode {
    /// The inverse of its map.
    pub(super) map: MapKind,
    pub(super) skeleton: SkeletonKind,
    pub(super) falloff: FalloffKind,
    /// Whether the strength is a number of its row.
    pub(super) strong: bool,
}

#[derive(Clone, Debug)]
pub(super) enum InstanceKind {
    Leaf {
        field: FieldId,
        bindings: BindingsId,
        /// Of each attribute group, the value that is computed for it; empty if none is.
        computed: Box<[Option<ComputedId>]>,
    },
    Warp {
        position: PositionId,
        inside: SpaceId,
        child: InstanceId,
        /// What weighs it, in the space where the warp stands. It is always hoisted.
        weight: Option<InstanceId>,
    },
    /// An operator whose operands are alike: any number of them, in any order but for ties; the operands of a
    /// step in that of the file.
    Reduce {
        operator: Combinator,
        code: ReduceCode,
        children: Vec<InstanceId>,
    },
    Difference {
        left: InstanceId,
        right: InstanceId,
    },
    /// A map of one field.
    Map {
        code: MapCode,
        child: InstanceId,
    },
    /// A formula of the point and of the children's fields: a leaf with attributes of its own, if there are
    /// none.
    Expression {
        position: PositionId,
        /// What the sides of its box are counted from, in the space of the node.
        shift: DVec3,
        bindings: BindingsId,
        children: Vec<InstanceId>,
        /// As for a leaf.
        computed: Box<[Option<ComputedId>]>,
    },
    /// One child answers now; all have code.
    Select {
        children: Vec<InstanceId>,
        chosen: usize,
    },
}

#[derive(Clone, Debug)]
pub(super) struct Instance {
    pub(super) node: NodeId,
    pub(super) kind: InstanceKind,
    /// The space in which it is asked.
    pub(super) space: SpaceId,
    /// How many places ask for it.
    pub(super) uses: u32,
    /// Whether its field can never be negative.
    pub(super) non_negative: bool,
    /// Whether its field is never further from 0 than
    /// [`LARGEST_FIELD`](jbt_model::expression::LARGEST_FIELD), wherever the point is.
    pub(super) bounded: bool,
}

/// All instances of a tree, children before parents.
pub(super) struct Scene<'a> {
    pub(super) tree: &'a CheckedTree,
    pub(super) instances: Vec<Instance>,
    pub(super) fields: Vec<LeafField>,
    pub(super) root: InstanceId,
    positions: Vec<Position>,
    /// Of each set of bindings, what each attribute group is bound to.
    bindings: Vec<Option<Bound>>,
    /// Attribute values that are computed.
    pub(super) computed: Vec<Computed>,
    /// By the numbers of spaces without that of the world, which is 0.
    pub(super) insides: Vec<Inside>,
    pub(super) demand: Demand,
    /// Whether a leaf is a run of particles. Where none is nobody has to look.
    has_runs: bool,
}

impl<'a> Scene<'a> {
    pub(super) fn instance(&self, id: InstanceId) -> &Instance {
        &self.instances[id.0 as usize]
    }

    pub(super) fn field(&self, id: FieldId) -> &LeafField {
        &self.fields[id.0 as usize]
    }

    pub(super) fn position(&self, id: PositionId) -> &Position {
        &self.positions[id.0 as usize]
    }

    /// What each attribute group is bound to, `None` for the default.
    pub(super) fn bindings(&self, id: BindingsId) -> &[Option<Bound>] {
        let groups = self.tree.attributes().len();
        &self.bindings[id.0 as usize * groups..][..groups]
    }

    pub(super) fn computed(&self, id: ComputedId) -> &Computed {
        &self.computed[id.0 as usize]
    }

    /// How many spaces `outer` is outside of `space`, in which it lies.
    pub(super) fn spaces_between(&self, outer: SpaceId, mut space: SpaceId) -> u32 {
        let mut count = 0;
        while space != outer {
            let inside = self.inside(space).expect("the world is the outermost space");
            space = self.position(inside.position).space;
            count += 1;
        }
        count
    }

    /// The primitive of a leaf that is no run.
    pub(super) fn primitive(&self, field: FieldId) -> &'a Primitive {
        self.primitive_of(self.field(field))
    }

    fn primitive_of(&self, field: &LeafField) -> &'a Primitive {
        match &self.tree.node(field.node).kind {
            NodeKind::Primitive(primitive) => primitive,
            NodeKind::Particles(_)
            | NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Warp(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => {
                unreachable!("leaf fields without a run are made of primitives")
            }
        }
    }

    /// The particles of a node that a run is of.
    pub(super) fn particles(&self, node: NodeId) -> &'a Particles {
        match &self.tree.node(node).kind {
            NodeKind::Particles(particles) => particles,
            NodeKind::Primitive(_)
            | NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Warp(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => unreachable!("runs are made of particles"),
        }
    }

    /// The run of particles that an instance is, if it is one.
    pub(super) fn run(&self, id: InstanceId) -> Option<&PointRun> {
        if !self.has_runs {
            return None;
        }
        match &self.instance(id).kind {
            InstanceKind::Leaf { field, .. } => self.field(*field).run.as_deref(),
            InstanceKind::Warp { .. }
            | InstanceKind::Reduce { .. }
            | InstanceKind::Difference { .. }
            | InstanceKind::Map { .. }
            | InstanceKind::Expression { .. }
            | InstanceKind::Select { .. } => None,
        }
    }

    /// The map of a leaf, or of one of particles by its place in their arrays: see [`LeafField::map`].
    pub(super) fn leaf_map(&self, field: &LeafField, place: usize) -> DAffine3 {
        if field.run.is_none() {
            return field.map;
        }
        let at = self.particles(field.node).at(place);
        DAffine3 { translation: self.position(field.position).map.transform_point3(at), ..field.map }
    }

    /// The skeleton of a leaf, or of one of particles by its place in their arrays.
    pub(super) fn leaf_skeleton(&self, id: FieldId, place: usize) -> Cow<'a, Skeleton> {
        let field = self.field(id);
        match &field.run {
            None => Cow::Borrowed(&self.primitive(id).skeleton),
            Some(_) => Cow::Owned(self.particles(field.node).point(place).into()),
        }
    }

    /// The numbers of a leaf, or of one of particles by its place in their arrays.
    pub(super) fn leaf_numbers(&self, field: &LeafField, place: usize) -> LeafNumbers<'a> {
        if field.run.is_none() {
            let Primitive { radius, strength, falloff, .. } = self.primitive_of(field);
            return LeafNumbers { radius: *radius, strength: *strength, falloff };
        }
        let particles = self.particles(field.node);
        LeafNumbers {
            radius: particles.radius(place),
            strength: particles.strength(place),
            falloff: particles.falloff(),
        }
    }

    pub(super) fn expression(&self, node: NodeId) -> &'a Expression {
        match &self.tree.node(node).kind {
            NodeKind::Expression(expression) => expression,
            NodeKind::Combine(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Primitive(_)
            | NodeKind::Particles(_)
            | NodeKind::Warp(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => {
                unreachable!("only formulas have expressions")
            }
        }
    }

    /// A number of an expression, if it is the same for all values of the parameters.
    pub(super) fn fixed_number(&self, node: NodeId, number: usize) -> Option<f64> {
        let depends = match self.tree.dependent(node) {
            Some(Written::Expression(formula)) => formula.numbers[number].depends_on_parameters(),
            Some(_) | None => false,
        };
        (!depends).then(|| self.expression(node).numbers()[number])
    }

    /// Whether an expression is 0 wherever its children are, for all values of the parameters.
    pub(super) fn vanishes(&self, node: NodeId) -> bool {
        self.expression(node).form().vanishes(|number| self.fixed_number(node, number))
    }

    /// What a space is the inside of; `None` for the world.
    pub(super) fn inside(&self, space: SpaceId) -> Option<&Inside> {
        self.insides.get((space.0 as usize).checked_sub(1)?)
    }

    /// Whether several instances lead into a space: then its points are computed once, for all of them.
    pub(super) fn is_shared(&self, space: SpaceId) -> bool {
        self.inside(space).is_some_and(|inside| inside.uses > 1)
    }

    /// The place of the attribute group that a computed value is for.
    pub(super) fn group_of(&self, id: ComputedId) -> usize {
        let name = self.attribute_name(self.computed(id).node);
        let group = self.tree.attributes().iter().position(|group| &*group.name == name);
        group.expect("the check knows all groups")
    }

    /// What an operator does.
    pub(super) fn combinator(&self, node: NodeId) -> Combinator {
        match &self.tree.node(node).kind {
            NodeKind::Combine(combinator) => *combinator,
            NodeKind::Primitive(_)
            | NodeKind::Particles(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Warp(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => {
                unreachable!("operators are made of combinators")
            }
        }
    }

    /// Whether what leaves are bound to counts whatever stands nearer to them.
    pub(super) fn overrides(&self, bound: Bound) -> bool {
        self.tree.node(bound.node).kind.overrides()
    }

    /// The attribute group that a node names.
    pub(super) fn attribute_name(&self, node: NodeId) -> &'a str {
        match &self.tree.node(node).kind {
            NodeKind::Attribute { name, .. } => name,
            NodeKind::Primitive(_)
            | NodeKind::Particles(_)
            | NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Warp(_)
            | NodeKind::Constant { .. } => unreachable!("bindings name attribute nodes"),
        }
    }

    pub(super) fn warp(&self, node: NodeId) -> &'a Warp {
        match &self.tree.node(node).kind {
            NodeKind::Warp(warp) => warp,
            NodeKind::Particles(_)
            | NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Primitive(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => {
                unreachable!("spaces are the insides of warps")
            }
        }
    }
}

/// The instances that one asks for: behind a warp's child comes its weight.
pub(super) fn children(kind: &InstanceKind) -> impl Iterator<Item = InstanceId> {
    let (children, last): (&[InstanceId], Option<InstanceId>) = match kind {
        InstanceKind::Leaf { .. } => (&[], None),
        InstanceKind::Warp { child, weight, .. } => (from_ref(child), *weight),
        InstanceKind::Map { child, .. } => (from_ref(child), None),
        InstanceKind::Difference { left, right } => (from_ref(left), Some(*right)),
        InstanceKind::Reduce { children, .. }
        | InstanceKind::Expression { children, .. }
        | InstanceKind::Select { children, .. } => (children, None),
    };
    children.iter().copied().chain(last)
}
