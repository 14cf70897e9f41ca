//! Members: what is behind the rows of tables, and what stands at the places of a row.

use glam::{DAffine3, DVec3};

use crate::instance::{Bound, Inside, Instance, InstanceKind, Scene};
use crate::names::{ComputedId, FieldId, Hoist, InstanceId};
use crate::shape::Shapes;
use jbt_model::check::NodeId;
use jbt_model::combine::Combinator;

/// What stands at a place of a row, or is behind the row.
#[derive(Clone, Copy)]
pub(crate) enum Member {
    /// The scene, an operand, or a selector's child.
    Operand {
        id: InstanceId,
        /// Its place in the order of its operator.
        order: u32,
        /// Whether it is no child of a selector that has chosen another one.
        asked: bool,
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

    /// The tree node whose numbers it has.
    pub(crate) fn node(self, scene: &Scene<'_>) -> NodeId {
        match self {
            Self::Operand { id, .. } | Self::Hoisted(Hoist::Instance(id)) => scene.instance(id).node,
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
            Self::Operand { id, .. } | Self::Hoisted(Hoist::Instance(id)) => {
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
            Self::Piece(..) => true,
        }
    }

    /// An instance that stands there.
    pub(crate) fn instance(self) -> InstanceId {
        match self {
            Self::Operand { id, .. } | Self::Hoisted(Hoist::Instance(id)) => id,
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

    /// The map from the pose of a leaf, or from where a warp or a formula stands, to where it is asked.
    pub(crate) fn map<'s>(self, scene: &'s Scene<'_>) -> &'s DAffine3 {
        match self {
            Self::Hoisted(Hoist::Field(field)) | Self::Piece(field, _) => &scene.field(field).map,
            Self::Hoisted(Hoist::Space(_)) => &scene.position(self.inside(scene).position).map,
            Self::Hoisted(Hoist::Computed(id)) => &scene.computed(id).map,
            Self::Operand { id, .. } | Self::Hoisted(Hoist::Instance(id)) => match &scene.instance(id).kind {
                InstanceKind::Leaf { field, .. } => &scene.field(*field).map,
                InstanceKind::Warp { position, .. } | InstanceKind::Expression { position, .. } => {
                    &scene.position(*position).map
                }
                InstanceKind::Reduce { .. }
                | InstanceKind::Difference { .. }
                | InstanceKind::Map { .. }
                | InstanceKind::Select { .. } => unreachable!("it looks at no coordinates"),
            },
        }
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

    /// What is computed of an attribute group, if it is no number.
    pub(crate) fn computed(self, scene: &Scene<'_>, group: usize) -> Option<ComputedId> {
        if let Self::Hoisted(Hoist::Computed(id)) = self {
            return Some(id);
        }
        self.attributes(scene).1.get(group).copied().flatten()
    }
}
