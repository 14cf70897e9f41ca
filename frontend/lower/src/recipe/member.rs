//! Members: what is behind the rows of tables, and what stands at the places of a row.

use glam::{DAffine3, DVec3};

use crate::instance::{Bound, Inside, Instance, InstanceKind, LeafField, Scene};
use crate::names::{ComputedId, FieldId, Hoist, InstanceId};
use crate::run::{LeafNumbers, PointRun};
use crate::shape::Shapes;
use jbt_model::check::NodeId;
use jbt_model::combine::Combinator;
use jbt_model::particles::Particles;
use jbt_model::skeleton::Skeleton;

/// What stands at a place of a row, or is behind the row.
#[derive(Clone, Copy)]
pub(crate) enum Member {
    /// The scene, an operand, or a selector's child. A run of particles stands for all of them, and for the
    /// first one.
    Operand {
        id: InstanceId,
        /// Its place in the order of its operator.
        order: u32,
        /// Whether it is no child of a selector that has chosen another one.
        asked: bool,
    },
    /// One of particles.
    Particle {
        /// Their run.
        id: InstanceId,
        /// Its place in the order of the operator.
        order: u32,
        /// Its place in the arrays of the node.
        place: u32,
    },
    /// What is hoisted, where it is computed.
    Hoisted(Hoist),
    /// A piece of a leaf's skeleton, by its place among them.
    Piece(FieldId, u32),
}

impl Member {
    /// That of the scene's row.
    pub(crate) fn root(scene: &Scene<'_>) -> Self {
        Self::Operand { id: scene.root, order: 0, asked: true }
    }

    /// The members of a group of an operator.
    pub(crate) fn members(self, shapes: &Shapes, group: usize) -> impl Iterator<Item = Self> {
        let group = &shapes.groups(self.instance())[group];
        group.members.iter().map(|&(id, order)| Self::Operand { id, order, asked: true })
    }

    /// How many rows it is.
    pub(crate) fn rows(self, scene: &Scene<'_>) -> usize {
        self.run(scene).map_or(1, |(_, run, _)| run.len())
    }

    /// The run of particles that it stands for: its instance, and the place of the first particle of its node
    /// in the order of the operator.
    pub(crate) fn run<'s>(self, scene: &'s Scene<'_>) -> Option<(InstanceId, &'s PointRun, u32)> {
        match self {
            Self::Operand { id, order, .. } => Some((id, scene.run(id)?, order)),
            Self::Particle { .. } | Self::Hoisted(_) | Self::Piece(..) => None,
        }
    }

    /// The particle with this number of a run.
    pub(crate) fn particle((id, run, order): (InstanceId, &PointRun, u32), number: usize) -> Self {
        // There are at most limits::MAX_PARTICLES.
        let place = run.place(number) as u32;
        Self::Particle { id, order: order + place, place }
    }

    /// The place in the arrays of particles of the one that it is, or stands for; 0 if it is no particle.
    fn place(self, scene: &Scene<'_>) -> usize {
        match self {
            Self::Particle { place, .. } => place as usize,
            Self::Operand { id, .. } => scene.run(id).map_or(0, |run| run.place(0)),
            Self::Hoisted(_) | Self::Piece(..) => 0,
        }
    }

    /// The particles of which it is, or stands for, one, and its place in their arrays; `None` of any other
    /// leaf or formula.
    pub(crate) fn one_of<'s>(self, scene: &Scene<'s>) -> Option<(&'s Particles, usize)> {
        let (Self::Operand { id, .. } | Self::Particle { id, .. }) = self else { return None };
        scene.run(id)?;
        Some((scene.particles(scene.instance(id).node), self.place(scene)))
    }

    /// The numbers of a leaf.
    pub(crate) fn numbers<'s>(self, scene: &Scene<'s>) -> LeafNumbers<'s> {
        self.leaf(scene).1
    }

    /// The field and the numbers of a leaf.
    pub(crate) fn leaf<'f, 's>(self, scene: &'f Scene<'s>) -> (&'f LeafField, LeafNumbers<'s>) {
        let field = scene.field(self.field(scene));
        (field, scene.leaf_numbers(field, self.place(scene)))
    }

    /// The tree node whose numbers it has.
    pub(crate) fn node(self, scene: &Scene<'_>) -> NodeId {
        match self {
            Self::Operand { id, .. } | Self::Particle { id, .. } | Self::Hoisted(Hoist::Instance(id)) => {
                scene.instance(id).node
            }
            Self::Hoisted(Hoist::Field(field)) | Self::Piece(field, _) => scene.field(field).node,
            Self::Hoisted(Hoist::Computed(id)) => scene.computed(id).node,
            Self::Hoisted(Hoist::Space(space)) => scene.inside(space).expect("the world is not hoisted").warp,
        }
    }

    /// The name of a table whose first row it is.
    pub(crate) fn name(self, scene: &Scene<'_>) -> &'static str {
        match self {
            Self::Piece(..) => "pieces",
            Self::Hoisted(Hoist::Field(field)) => scene.field(field).code.skeleton.name(),
            Self::Hoisted(Hoist::Space(_)) => scene.warp(self.node(scene)).name(),
            Self::Hoisted(Hoist::Computed(_)) => unreachable!("it has no table"),
            Self::Operand { id, .. } | Self::Particle { id, .. } | Self::Hoisted(Hoist::Instance(id)) => {
                let Instance { node, kind, .. } = scene.instance(id);
                match kind {
                    InstanceKind::Leaf { field, .. } => scene.field(*field).code.skeleton.name(),
                    InstanceKind::Warp { .. } => scene.warp(*node).name(),
                    InstanceKind::Difference { .. } => "difference",
                    InstanceKind::Map { .. } => scene.combinator(*node).name(),
                    InstanceKind::Expression { .. } => "expression",
                    InstanceKind::Select { .. } => "select",
                    InstanceKind::Reduce { operator, .. } => operator.name(),
                }
            }
        }
    }

    /// Whether somebody asks for it now.
    pub(crate) fn is_asked(self, scene: &Scene<'_>) -> bool {
        match self {
            Self::Operand { asked, .. } => asked,
            Self::Hoisted(hoist) => scene.demand.is_asked(hoist),
            Self::Particle { .. } | Self::Piece(..) => true,
        }
    }

    /// An instance that stands there.
    pub(crate) fn instance(self) -> InstanceId {
        match self {
            Self::Operand { id, .. } | Self::Particle { id, .. } | Self::Hoisted(Hoist::Instance(id)) => id,
            Self::Hoisted(Hoist::Field(_) | Hoist::Space(_) | Hoist::Computed(_)) | Self::Piece(..) => {
                unreachable!("it is no instance")
            }
        }
    }

    /// The field of a leaf.
    pub(crate) fn field(self, scene: &Scene<'_>) -> FieldId {
        if let Self::Hoisted(Hoist::Field(field)) | Self::Piece(field, _) = self {
            return field;
        }
        let InstanceKind::Leaf { field, .. } = scene.instance(self.instance()).kind else {
            unreachable!("only leaves have fields of their own")
        };
        field
    }

    /// The inside of a warp.
    pub(crate) fn inside<'s>(self, scene: &'s Scene<'_>) -> &'s Inside {
        let known = |space| scene.inside(space).expect("the world is no warp's inside");
        if let Self::Hoisted(Hoist::Space(space)) = self {
            return known(space);
        }
        let InstanceKind::Warp { inside, .. } = scene.instance(self.instance()).kind else {
            unreachable!("only warps have insides")
        };
        known(inside)
    }

    /// Uses the map from the pose of a leaf, or from where a warp or a formula stands, to where it is asked.
    /// It is large: only particles' maps are made for this.
    pub(crate) fn with_map(self, scene: &Scene<'_>, work: impl FnOnce(&DAffine3)) {
        let map = match self {
            Self::Hoisted(Hoist::Field(field)) | Self::Piece(field, _) => &scene.field(field).map,
            Self::Hoisted(Hoist::Space(_)) => &scene.position(self.inside(scene).position).map,
            Self::Hoisted(Hoist::Computed(id)) => &scene.computed(id).map,
            Self::Operand { id, .. } | Self::Particle { id, .. } | Self::Hoisted(Hoist::Instance(id)) => {
                match &scene.instance(id).kind {
                    InstanceKind::Leaf { field, .. } => {
                        let field = scene.field(*field);
                        if field.run.is_some() {
                            return work(&scene.leaf_map(field, self.place(scene)));
                        }
                        &field.map
                    }
                    InstanceKind::Warp { position, .. } | InstanceKind::Expression { position, .. } => {
                        &scene.position(*position).map
                    }
                    InstanceKind::Reduce { .. }
                    | InstanceKind::Difference { .. }
                    | InstanceKind::Map { .. }
                    | InstanceKind::Select { .. } => unreachable!("it looks at no coordinates"),
                }
            }
        };
        work(map);
    }

    /// An operator.
    pub(crate) fn operator(self, scene: &Scene<'_>) -> Combinator {
        let Instance { node, kind, .. } = scene.instance(self.instance());
        // The union of what a difference subtracts has no node of its own.
        if let InstanceKind::Reduce { operator, .. } = kind { *operator } else { scene.combinator(*node) }
    }

    /// What the sides of a formula's box are counted from.
    pub(crate) fn shift(self, scene: &Scene<'_>) -> DVec3 {
        let InstanceKind::Expression { shift, .. } = scene.instance(self.instance()).kind else {
            unreachable!("only formulas have boxes")
        };
        shift
    }

    /// By attribute group, what a leaf is bound to, and what is computed of that. If nothing is, there may be
    /// none of these.
    pub(crate) fn attributes<'s>(
        self,
        scene: &'s Scene<'_>,
    ) -> (&'s [Option<Bound>], &'s [Option<ComputedId>]) {
        let (InstanceKind::Leaf { bindings, computed, .. }
        | InstanceKind::Expression { bindings, computed, .. }) = &scene.instance(self.instance()).kind
        else {
            unreachable!("only leaves have attributes of their own")
        };
        (scene.bindings(*bindings), computed)
    }

    /// The map of what is computed of an attribute group. The uv of a particle has one of its own.
    pub(crate) fn map_of_computed(self, scene: &Scene<'_>, group: usize) -> DAffine3 {
        let computed = scene.computed(self.computed(scene, group).expect("it is no number"));
        match self.one_of(scene) {
            Some((particles, place)) if computed.leaf.is_some() => {
                let point: Skeleton = particles.point(place).into();
                scene.position(scene.field(self.field(scene)).position).of_uv(&point, false).0
            }
            Some(_) | None => computed.map,
        }
    }

    /// What is computed of an attribute group, if it is no number.
    pub(crate) fn computed(self, scene: &Scene<'_>, group: usize) -> Option<ComputedId> {
        if let Self::Hoisted(Hoist::Computed(id)) = self {
            return Some(id);
        }
        self.attributes(scene).1.get(group).copied().flatten()
    }
}
