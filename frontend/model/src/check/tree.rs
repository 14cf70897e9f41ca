//! The result of the check: an arena of nodes.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DAffine3;
use jbt_ir::watch;

use super::arena::{CheckedNode, Children, Lineage, NodeId, Paths};
use super::dependence::Dependence;
use crate::affine;
use crate::attribute::AttributeGroup;
use crate::bounds::Bounds;
use crate::combine::extent::Extent;
use crate::diagnostic::{Diagnostic, Diagnostics, SourceText};
use crate::kind::{NodeKind, Primitive};
use crate::orientation::Orientation;
use crate::origin::ModelOrigin;
use crate::parameter::Parameter;

/// A valid model as an arena: children before parents, shared nodes once, the root last.
#[derive(Clone, Debug)]
pub struct CheckedTree {
    pub(super) iso: f64,
    pub(super) attributes: Vec<AttributeGroup>,
    pub(super) nodes: Arc<Vec<CheckedNode>>,
    /// Of the nodes.
    pub(super) paths: Paths,
    pub(super) parameters: Vec<Parameter>,
    pub(super) dependence: Arc<Dependence>,
    pub(super) origin: ModelOrigin,
    pub(super) orientation: Orientation,
    /// The text that spans refer to.
    pub(super) source: Option<SourceText>,
    /// The tree that it was made of, if it is an edit of another one.
    pub(super) lineage: Option<Lineage>,
}

impl PartialEq for CheckedTree {
    /// Equal nodes, attributes and parameters; the source text does not count.
    fn eq(&self, other: &Self) -> bool {
        let Self { iso, attributes, nodes, parameters, dependence, origin, orientation, .. } = self;
        *iso == other.iso
            && *attributes == other.attributes
            && *nodes == other.nodes
            && *parameters == other.parameters
            && *dependence == other.dependence
            && *origin == other.origin
            && *orientation == other.orientation
    }
}

impl CheckedTree {
    /// Messages about this tree, located in the text that it came from.
    #[must_use]
    pub fn diagnostics(&self, list: Vec<Diagnostic>) -> Diagnostics {
        Diagnostics::new(list, self.source.clone())
    }

    /// The field value of the surface.
    #[must_use]
    pub fn iso(&self) -> f64 {
        self.iso
    }

    /// The attribute groups, `color` first.
    #[must_use]
    pub fn attributes(&self) -> &[AttributeGroup] {
        &self.attributes
    }

    /// The point from which its local coordinates count, in programs, lattices, boxes and meshes. The tree
    /// itself, its [support](Self::support) and the oracle use world coordinates.
    ///
    /// The model sets it, or the check finds it; other values of parameters keep it.
    #[must_use]
    pub fn origin(&self) -> ModelOrigin {
        self.origin
    }

    /// The same tree with another origin, for example the origin of the model that it is an edit of. The
    /// origin's coordinates are finite.
    #[must_use]
    pub fn with_origin(&self, origin: ModelOrigin) -> Self {
        Self { origin, ..self.clone() }
    }

    /// How the model stands.
    #[must_use]
    pub fn orientation(&self) -> Orientation {
        self.orientation
    }

    /// All nodes.
    #[must_use]
    pub fn nodes(&self) -> &[CheckedNode] {
        &self.nodes
    }

    /// A node.
    #[must_use]
    #[inline]
    pub fn node(&self, id: NodeId) -> &CheckedNode {
        &self.nodes[id.0 as usize]
    }

    /// The root.
    #[must_use]
    pub fn root(&self) -> NodeId {
        NodeId(self.nodes.len() as u32 - 1)
    }

    /// The number of paths from the root to each node: 1 for the root, more below shared subtrees. In the
    /// order of [`nodes`](Self::nodes).
    #[must_use]
    pub fn uses(&self) -> &[u64] {
        &self.paths.uses
    }

    /// The number of paths from the root to each node, as [`uses`](Self::uses), but only through the chosen
    /// child of each selector.
    #[must_use]
    pub fn asked(&self) -> &[u64] {
        &self.paths.asked
    }

    /// The number of paths from the root to leaves, only through the chosen child of each selector.
    #[must_use]
    pub fn leaf_uses(&self) -> u64 {
        self.paths.leaf_uses
    }

    /// A leaf under maps, the nearest first, each with the node of this tree that gives its weight, if it has
    /// one. The maps come from a checked tree, or are products of such maps, so they are not checked again.
    /// The origin is the world's.
    pub fn leaf_under(
        &self,
        leaf: Primitive,
        maps: impl IntoIterator<Item = (NodeKind, Option<NodeId>)>,
    ) -> Self {
        let mut nodes = vec![CheckedNode {
            kind: NodeKind::Primitive(leaf),
            children: Children::new(),
            span: None,
            label: None,
        }];
        for (kind, weight) in maps {
            let mut children = Children::from_slice(&[NodeId(nodes.len() as u32 - 1)]);
            children.extend(weight.map(|weight| self.copy_below(weight, &mut nodes)));
            nodes.push(CheckedNode { kind, children, span: None, label: None });
        }
        self.of_nodes(nodes)
    }

    /// A subtree as a tree of its own, with the iso-value of this tree, no parameters, and an origin found
    /// for the subtree.
    #[must_use]
    pub fn subtree(&self, root: NodeId) -> Self {
        let mut nodes = Vec::new();
        self.copy_below(root, &mut nodes);
        let tree = self.of_nodes(nodes);
        Self { origin: ModelOrigin::of(tree.support()), ..tree }
    }

    /// The tree in other coordinates, with the iso-value and the attributes of this tree and no parameters.
    /// It is this tree under one more affine node, whose map takes points of this tree's space to the new
    /// space: an invertible map given by rows, with the shift as last column. An origin other than the
    /// world's is mapped too.
    #[must_use]
    pub fn mapped(&self, rows: [[f64; 4]; 3]) -> Self {
        let column = |place: usize| rows.map(|row| row[place]);
        let columns: [[f64; 3]; 4] = std::array::from_fn(column);
        watch::take(size_of_val(&*self.nodes));
        let mut nodes = self.nodes.to_vec();
        let map = DAffine3::from_cols_array_2d(&columns);
        let children = Children::from_slice(&[self.root()]);
        nodes.push(CheckedNode { kind: NodeKind::Affine(map), children, span: None, label: None });
        let mapped = || ModelOrigin::new(map.transform_point3(self.origin.point().into()).to_array());
        let origin = if self.origin.is_world() { self.origin } else { mapped() };
        Self { origin, ..self.of_nodes(nodes) }
    }

    /// Appends a copy of a subtree to `nodes`; returns the index of its root.
    pub(super) fn copy_below(&self, root: NodeId, nodes: &mut Vec<CheckedNode>) -> NodeId {
        let mut copies: BTreeMap<NodeId, NodeId> = BTreeMap::new();
        // Children come before their parents, so the walk over the descendants goes from the last to the
        // first.
        let mut below = std::collections::BTreeSet::from([root]);
        let mut order = Vec::new();
        while let Some(id) = below.pop_last() {
            below.extend(&self.node(id).children);
            order.push(id);
        }
        for id in order.into_iter().rev() {
            copies.insert(id, NodeId(nodes.len() as u32));
            let node = self.node(id);
            let children = node.children.iter().map(|child| copies[child]).collect();
            nodes.push(CheckedNode { children, ..node.clone() });
        }
        copies[&root]
    }

    pub(super) fn of_nodes(&self, nodes: Vec<CheckedNode>) -> Self {
        Self {
            iso: self.iso,
            attributes: self.attributes.clone(),
            paths: Paths::new(&nodes),
            nodes: Arc::new(nodes),
            parameters: Vec::new(),
            dependence: Arc::default(),
            origin: ModelOrigin::WORLD,
            orientation: self.orientation,
            source: self.source.clone(),
            lineage: None,
        }
    }
}

impl CheckedTree {
    /// A box that holds the support of the field: outside of it the field is exactly zero. Empty if the field
    /// is zero everywhere.
    ///
    /// Its sides may be infinite, for example for a half space. Cost: linear in the number of nodes, shared
    /// nodes counted once.
    #[must_use]
    pub fn support(&self) -> Bounds {
        watch::take(self.nodes.len() * size_of::<Extent>());
        let mut done: Vec<Extent> = Vec::with_capacity(self.nodes.len());
        let mut children: Vec<Extent> = Vec::new();
        for node in &*self.nodes {
            children.clear();
            children.extend(node.children.iter().map(|id| done[id.0 as usize]));
            done.push(node_extent(&node.kind, &children, self.iso));
        }
        done.last().map_or(Bounds::EMPTY, |root| root.support)
    }

    /// The [support](Self::support) in local coordinates.
    #[must_use]
    pub fn local_support(&self) -> Bounds {
        self.origin.local_bounds(self.support())
    }
}

/// The extent of a node, from the extents of its children.
pub(super) fn node_extent(kind: &NodeKind, children: &[Extent], iso: f64) -> Extent {
    match kind {
        NodeKind::Primitive(leaf) => {
            let support = leaf.skeleton.bounds_within(leaf.radius);
            Extent { support, negative: if leaf.strength < 0.0 { support } else { Bounds::EMPTY } }
        }
        NodeKind::Particles(particles) => particles.extent(),
        NodeKind::Combine(combinator) if children.len() == 1 && combinator.passes_single() => children[0],
        NodeKind::Combine(combinator) => combinator.extent(children, iso),
        NodeKind::Expression(expression) => {
            let signs: Vec<bool> = children.iter().map(|child| child.negative.is_empty()).collect();
            let hull = || children.iter().fold(Bounds::EMPTY, |all, child| all.hull(child.support));
            let reach = if expression.vanishes() { hull() } else { Bounds::EVERYWHERE };
            let support = expression.bounds().map_or(reach, |bounds| reach.intersection(bounds));
            let support = if support.is_empty() { Bounds::EMPTY } else { support };
            Extent {
                support,
                negative: if expression.non_negative(&signs) { Bounds::EMPTY } else { support },
            }
        }
        NodeKind::Select(_) => kind.asked(children)[0],
        NodeKind::Affine(map) => children[0].map(|bounds| affine::map_bounds(map, bounds)),
        NodeKind::Warp(_) if children.len() > 1 => children[0].weighted(&children[1]),
        NodeKind::Warp(warp) => children[0].map(|bounds| warp.forward_bounds(bounds)),
        NodeKind::Attribute { .. } | NodeKind::Constant { .. } => children[0],
    }
}
