//! Nodes of a checked tree, and the numbers of paths to them.

use std::sync::Arc;

use jbt_ir::limits;
use smallvec::SmallVec;

use crate::diagnostic::{Diagnostic, Span};
use crate::kind::NodeKind;
use crate::label::NodeLabel;
use crate::report::Report;

/// The name of a node of a checked tree: its index in [`CheckedTree::nodes`](super::CheckedTree::nodes).
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct NodeId(pub u32);

/// The children of a node. Up to four of them take no allocation.
pub type Children = SmallVec<[NodeId; 4]>;

/// A node of a checked tree.
#[derive(Clone, PartialEq, Debug)]
pub struct CheckedNode {
    /// What it does.
    pub kind: NodeKind,
    /// Its children, in order. They come before it in the arena.
    pub children: Children,
    /// Where it stands in its source text: a primitive from its name to `}`, a node with children its words
    /// before the block. Errors of the check about any of its numbers have this place.
    pub span: Option<Span>,
    /// What its text says about it besides what it means.
    pub label: Option<Arc<NodeLabel>>,
}

impl CheckedNode {
    /// Its name, if it has one.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.label.as_ref()?.name.as_deref()
    }
}

/// Which nodes of a tree differ from those of the tree that it was made of.
#[derive(Clone, Debug)]
pub(super) struct Lineage {
    /// All nodes of that tree.
    pub(super) from: Arc<Vec<CheckedNode>>,
    /// Ascending.
    pub(super) changed: Arc<[NodeId]>,
}

/// How many paths lead from the root to each node: see [`CheckedTree::uses`](super::CheckedTree::uses) and
/// [`asked`](super::CheckedTree::asked).
#[derive(Clone, Debug)]
pub(super) struct Paths {
    /// Paths through all children.
    pub(super) uses: Arc<[u64]>,
    /// Paths through children that are asked.
    pub(super) asked: Arc<[u64]>,
    /// Paths to leaves, through children that are asked.
    pub(super) leaf_uses: u64,
}

impl Paths {
    /// The numbers of paths in an arena.
    pub(super) fn new(nodes: &[CheckedNode]) -> Self {
        let uses: Arc<[u64]> = paths(nodes, |node| &node.children).into();
        let selects = nodes.iter().any(|node| matches!(node.kind, NodeKind::Select(_)));
        let asked = match selects {
            true => paths(nodes, |node| node.kind.asked(&node.children)).into(),
            false => Arc::clone(&uses),
        };
        let leaves = nodes.iter().zip(&*asked).map(|(node, uses)| uses.saturating_mul(leaves_in(&node.kind)));
        let leaf_uses = leaves.fold(0, u64::saturating_add);
        Self { uses, asked, leaf_uses }
    }
}

/// How many leaves with a skeleton a node is.
fn leaves_in(kind: &NodeKind) -> u64 {
    match kind {
        NodeKind::Primitive(_) => 1,
        NodeKind::Particles(particles) => particles.len() as u64,
        NodeKind::Combine(_)
        | NodeKind::Expression(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Warp(_)
        | NodeKind::Attribute { .. }
        | NodeKind::Constant { .. } => 0,
    }
}

/// The number of paths from the root to each node, over the children that `below` gives. Children come before
/// their parents.
fn paths(nodes: &[CheckedNode], below: impl Fn(&CheckedNode) -> &[NodeId]) -> Vec<u64> {
    let mut paths = vec![0_u64; nodes.len()];
    if let Some(root) = paths.last_mut() {
        *root = 1;
    }
    for (index, node) in nodes.iter().enumerate().rev() {
        for child in below(node) {
            let child = child.0 as usize;
            paths[child] = paths[child].saturating_add(paths[index]);
        }
    }
    paths
}

/// Checks the number of paths from the root to all nodes: a bound of the work of lowering, and of its rows.
/// Particles, whose numbers somebody has, count where they are used again.
pub(super) fn check_instances(report: &mut Report, nodes: &[CheckedNode], most: usize) {
    let paths = paths(nodes, |node| &node.children);
    let mut uses = paths.iter().fold(0, |all: u64, paths| all.saturating_add(*paths));
    let what = if uses > most as u64 { "nodes" } else { "nodes and pieces" };
    let mut particles = 0_u64;
    for (&paths, node) in paths.iter().zip(nodes) {
        // Pieces take longer to count than nodes.
        if uses > most as u64 {
            break;
        }
        let rows = match &node.kind {
            // Each piece is a row as well.
            NodeKind::Primitive(leaf) => {
                paths.saturating_mul(leaf.skeleton.piece_count(leaf.radius, most) as u64)
            }
            NodeKind::Particles(these) => {
                particles = particles.saturating_add(paths.saturating_mul(these.len() as u64));
                (paths - 1).saturating_mul(these.len() as u64)
            }
            NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Warp(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => 0,
        };
        uses = uses.saturating_add(rows);
    }
    let span = nodes.last().and_then(|root| root.span);
    if uses > most as u64 {
        let count = if uses == u64::MAX { "more than 10^19".to_owned() } else { uses.to_string() };
        report.add(|| {
            Diagnostic::limit(span, format!("unfolded, the tree has {count} {what}; it may have {most}"))
                .expected("share fewer subtrees")
        });
    } else if particles > limits::MAX_PARTICLES as u64 {
        let most = limits::MAX_PARTICLES;
        let message = format!("the tree has {particles} particles; it may have {most}");
        report.add(|| Diagnostic::limit(span, message).expected("expected fewer particles"));
    }
}
