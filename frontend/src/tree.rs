//! The BlobTree: an immutable directed acyclic graph with shared subtrees.
//!
//! ```text
//!            union                      leaves: a skeleton in a falloff
//!           /     \                     combinators: fields of the children become one field
//!      color        difference          affine, warp, attribute: change the question on its way down,
//!        |           /      \           or the answer on its way up; they have one child
//!      point      rotate    box
//!                    \      /
//!                     (shared)
//! ```
//!
//! Cloning a [`Tree`] is cheap and shares it. Everything that walks a tree is iterative, dropping it included: a chain of a
//! million nodes is a tree like any other.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use glam::DAffine3;

use crate::combine::Combinator;
use crate::diagnostic::Span;
use crate::falloff::Falloff;
use crate::skeleton::Skeleton;
use crate::traverse::Visit;
use crate::warp::Warp;

/// A leaf: a skeleton, and the field around it.
///
/// The field at squared distance `d^2` from the skeleton is `strength * falloff(d^2 / radius^2)`.
#[derive(Clone, PartialEq, Debug)]
pub struct Primitive {
    /// What the distance is measured to.
    pub skeleton: Skeleton,
    /// How the field fades.
    pub falloff: Falloff,
    /// The support radius: where the field reaches zero.
    pub radius: f64,
    /// The factor of the field; negative ones push surfaces away.
    pub strength: f64,
}

/// What a node does.
#[derive(Clone, PartialEq, Debug)]
pub enum NodeKind {
    /// A leaf.
    Primitive(Primitive),
    /// Fields of the children become one field.
    Combine(Combinator),
    /// The child stands elsewhere: the map takes the child's space to the parent's.
    Affine(DAffine3),
    /// The child is deformed.
    Warp(Warp),
    /// The leaves below have this attribute, unless another node of the same name stands nearer to them.
    Attribute {
        /// The attribute group.
        name: Arc<str>,
        /// One real for each channel of the group.
        values: Vec<f64>,
    },
}

/// A node and its children.
pub struct Node {
    kind: NodeKind,
    children: Vec<Tree>,
    span: Option<Span>,
}

impl Node {
    /// What it does.
    #[must_use]
    pub fn kind(&self) -> &NodeKind {
        &self.kind
    }

    /// Its children, in order.
    #[must_use]
    pub fn children(&self) -> &[Tree] {
        &self.children
    }

    /// Where it stands in its source text.
    #[must_use]
    pub fn span(&self) -> Option<Span> {
        self.span
    }
}

/// A shared, immutable tree. See the module.
#[derive(Clone)]
pub struct Tree(Arc<Node>);

impl Tree {
    /// A node over children. Anything can be built; [`Model::check`](crate::check) says whether it makes sense.
    #[must_use]
    pub fn new(kind: NodeKind, children: Vec<Self>) -> Self {
        Self(Arc::new(Node { kind, children, span: None }))
    }

    /// A node that stands at a place in a text.
    #[must_use]
    pub fn at(span: Span, kind: NodeKind, children: Vec<Self>) -> Self {
        Self(Arc::new(Node { kind, children, span: Some(span) }))
    }

    /// The root node.
    #[must_use]
    pub fn node(&self) -> &Node {
        &self.0
    }

    /// An identity for maps: equal for clones of one tree, as long as one of them lives.
    #[must_use]
    pub fn identity(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }
}

impl Drop for Node {
    /// Takes a tree apart without recursion: whatever only this node holds is moved to a list and emptied there.
    fn drop(&mut self) {
        let mut list: Vec<Tree> = std::mem::take(&mut self.children);
        while let Some(tree) = list.pop() {
            if let Some(mut node) = Arc::into_inner(tree.0) {
                list.append(&mut node.children);
            }
        }
    }
}

impl fmt::Debug for Node {
    /// The node alone: its children by number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of {} children", self.kind, self.children.len())
    }
}

impl fmt::Debug for Tree {
    /// Every node once, numbered, children first: a list and not a nest, so that depth and sharing do no harm.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut numbers = HashMap::new();
        let mut map = f.debug_map();
        for (number, tree) in self.postfix(Visit::Nodes).enumerate() {
            let children: Vec<usize> =
                tree.0.children.iter().map(|child| numbers[&child.identity()]).collect();
            numbers.insert(tree.identity(), number);
            map.entry(&number, &(&tree.0.kind, children));
        }
        map.finish()
    }
}

impl PartialEq for Tree {
    /// The same nodes with the same numbers in the same order; places in texts do not matter. Shared pairs are compared once.
    fn eq(&self, other: &Self) -> bool {
        let mut seen = std::collections::HashSet::new();
        let mut pairs = vec![(self, other)];
        while let Some((a, b)) = pairs.pop() {
            if a.identity() == b.identity() || !seen.insert((a.identity(), b.identity())) {
                continue;
            }
            let (a, b) = (a.node(), b.node());
            if a.kind != b.kind || a.children.len() != b.children.len() {
                return false;
            }
            pairs.extend(a.children.iter().zip(&b.children));
        }
        true
    }
}
