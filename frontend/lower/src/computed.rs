//! Attribute values that are computed at the point: textures, uv, formulas.
//!
//! An attribute node that gives numbers ends up in the rows of the leaves below it. One that gives a function
//! ends up there too: as the map to the space of the function, and the function's own numbers. So leaves
//! under a thousand checkers of their own are rows of one table.
//!
//! ```text
//! leaf bound to a texture     its row: map, numbers of the texture, both values     code: t at the mapped point, (1 - t) a + t b
//! leaf bound to uv            its row: map to the skeleton's frame, uv columns, a 2x3 matrix
//! leaf bound to a formula     its row: map, numbers of the formula                  code: min(max(F, -largest), largest), and 0 for a NaN
//! direction inside a warp     its row: the direction in the space of the warp       code: J^-1 of it, J being the slopes of the point there
//! ```
//!
//! A texture or formula that several leaves see in the same coordinates is evaluated once: it is hoisted to
//! the start of its space, and all of them take its value. Then the leaves differ in code from those of other
//! textures, so only the [`MAX_SHARED`] textures with the most leaves are hoisted; the others are evaluated
//! for each leaf.
//!
//! All this is there for queries that ask for attributes; for others, rows have no such columns.
//!
//! To add another kind of computed value: a variant of [`AttributeValue`] and one of [`ComputedKind`], its
//! columns in `columns`, its code in `emit/computed.rs`, and what the oracle makes of it.

use std::sync::Arc;

use glam::DAffine3;
use jbt_ir::{Domain, FunctionBuilder, Value};

use super::names::{ComputedId, SpaceId};
use super::position::MapKind;
use jbt_model::attribute::{AttributeValue, Textured, UvMap};
use jbt_model::check::{CheckedTree, NodeId};
use jbt_model::expression::{Expression, Form, LARGEST_FIELD};
use jbt_model::kind::NodeKind;
use jbt_model::skeleton::{Skeleton, SkeletonKind};
use jbt_model::texture::TextureKind;

/// How many textures and formulas may be hoisted, because several leaves share them.
pub(super) const MAX_SHARED: usize = 32;

/// The function: what selects code.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub(super) enum ComputedKind {
    Texture(TextureKind),
    Uv(SkeletonKind),
    Formula(Arc<Form>),
    /// Directions inside of a warp that are the same everywhere in their space.
    Numbers,
}

/// A function in coordinates.
#[derive(Clone, Debug)]
pub(super) struct Computed {
    pub(super) kind: ComputedKind,
    /// The attribute node.
    pub(super) node: NodeId,
    /// The leaf whose uv it is.
    pub(super) leaf: Option<NodeId>,
    /// The space of whose points the map takes the inverse.
    pub(super) space: SpaceId,
    /// The map from the function's space.
    pub(super) map: DAffine3,
    /// What the inverse of the map is as code.
    pub(super) map_kind: MapKind,
    /// How many leaf instances are bound to it.
    pub(super) uses: u32,
    /// Whether it is hoisted to the start of its space.
    pub(super) shared: bool,
}

/// What a computed value is as code, for the leaf that has it.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub(super) enum ComputedShape {
    /// Computed in the leaf's row, from the point so many spaces outside of the leaf's.
    Here { up: u32, map: MapKind, kind: ComputedKind },
    /// Hoisted.
    Shared(ComputedId),
}

impl ComputedKind {
    /// Whether its values are finite at every point, infinite ones and NaN too.
    pub(super) const fn is_finite(&self) -> bool {
        match self {
            // Formulas are kept within bounds.
            Self::Texture(_) | Self::Uv(_) | Self::Formula(_) | Self::Numbers => true,
        }
    }

    /// How many operations of a formula it takes.
    pub(super) fn steps(&self) -> usize {
        match self {
            Self::Texture(_) | Self::Uv(_) | Self::Numbers => 0,
            Self::Formula(form) => form.steps(),
        }
    }
}

impl Computed {
    /// The texture with its values.
    pub(super) fn textured<'a>(&self, tree: &'a CheckedTree) -> &'a Textured {
        let AttributeValue::Textured(value) = attribute(tree, self.node) else {
            unreachable!("the kind is that of the node")
        };
        value
    }

    /// The skeleton whose uv it is, and their map.
    pub(super) fn uv<'a>(&self, tree: &'a CheckedTree) -> (&'a Skeleton, &'a UvMap) {
        let (AttributeValue::Uv(map), Some(leaf)) = (attribute(tree, self.node), self.leaf) else {
            unreachable!("the kind is that of the node, and a uv has its leaf")
        };
        (tree.node(leaf).kind.uv_skeleton(), map)
    }

    /// The formula.
    pub(super) fn formula<'a>(&self, tree: &'a CheckedTree) -> &'a Expression {
        let AttributeValue::Expressed(expression) = attribute(tree, self.node) else {
            unreachable!("the kind is that of the node")
        };
        expression
    }
}

/// The value within bounds, and 0 instead of a NaN.
pub(super) fn kept(d: &mut FunctionBuilder, value: Value) -> Value {
    let bounds = [-LARGEST_FIELD, LARGEST_FIELD, 0.0];
    let [lowest, largest, zero] = bounds.map(|number| d.constant(number));
    let is_number = d.eq(value, value);
    let value = d.select(is_number, value, zero);
    let value = d.max(value, lowest);
    d.min(value, largest)
}

/// What an attribute node gives.
pub(super) fn attribute(tree: &CheckedTree, node: NodeId) -> &AttributeValue {
    match &tree.node(node).kind {
        NodeKind::Attribute { value, .. } => value,
        NodeKind::Primitive(_)
        | NodeKind::Particles(_)
        | NodeKind::Combine(_)
        | NodeKind::Expression(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Constant { .. }
        | NodeKind::Warp(_) => unreachable!("bindings name attribute nodes"),
    }
}

/// Decides which textures and formulas are hoisted: those with the most leaves; of equals those that are met
/// first.
pub(super) fn share(computed: &mut [Computed]) {
    let mut candidates: Vec<&mut Computed> = computed.iter_mut().filter(|it| it.uses > 1).collect();
    candidates.sort_by_key(|it| std::cmp::Reverse(it.uses));
    candidates.into_iter().take(MAX_SHARED).for_each(|it| it.shared = true);
}
