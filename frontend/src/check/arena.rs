//! Nodes of a checked tree, and how many paths lead to them.

use crate::diagnostic::{Diagnostic, Span};
use crate::report::Report;
use crate::tree::NodeKind;

/// The name of a node of a checked tree: its place in [`CheckedTree::nodes`](super::CheckedTree::nodes).
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct NodeId(pub u32);

/// A node of a checked tree.
#[derive(Clone, PartialEq, Debug)]
pub struct CheckedNode {
    /// What it does.
    pub kind: NodeKind,
    /// Its children, in order. They come before it in the arena.
    pub children: Vec<NodeId>,
    /// Where it stands in its source text.
    pub span: Option<Span>,
}

/// The number of paths from the root to each node, through these children of each. Children come before their parents.
pub(super) fn paths(nodes: &[CheckedNode], below: impl Fn(&CheckedNode) -> &[NodeId]) -> Vec<u64> {
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

/// Counts the paths from the root to all nodes: what lowering may have to go through, and rows in the end.
pub(super) fn check_occurrences(report: &mut Report, nodes: &[CheckedNode], most: usize) {
    let weights = nodes.iter().map(|node| match &node.kind {
        // Each piece is a row as well.
        NodeKind::Primitive(leaf) => 1 + leaf.skeleton.piece_count(leaf.radius, most) as u64,
        NodeKind::Combine(_)
        | NodeKind::Expression(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Warp(_)
        | NodeKind::Attribute { .. } => 1,
    });
    let paths = paths(nodes, |node| &node.children);
    let mut uses = paths.iter().fold(0, |all: u64, paths| all.saturating_add(*paths));
    let what = if uses > most as u64 { "nodes" } else { "nodes and pieces" };
    for (paths, weight) in paths.into_iter().zip(weights) {
        // Pieces take longer to count than nodes.
        if uses > most as u64 {
            break;
        }
        uses = uses.saturating_add(paths.saturating_mul(weight - 1));
    }
    if uses > most as u64 {
        let span = nodes.last().and_then(|root| root.span);
        let count = if uses == u64::MAX { "more than 10^19".to_owned() } else { uses.to_string() };
        report.add(|| {
            Diagnostic::limit(span, format!("unfolded, the tree has {count} {what}; it may have {most}"))
                .expected("share fewer subtrees")
        });
    }
}
