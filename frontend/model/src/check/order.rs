//! Walks over checked trees.

use super::arena::NodeId;
use super::tree::CheckedTree;
use crate::traverse::{Nodes, Order, Traversal, Visit};

/// The nodes of a checked tree.
impl Nodes for &CheckedTree {
    type Node = NodeId;

    fn children(self, node: NodeId) -> impl DoubleEndedIterator<Item = NodeId> + ExactSizeIterator {
        self.node(node).children.iter().copied()
    }

    fn identity(self, node: NodeId) -> usize {
        node.0 as usize
    }
}

/// A checked tree is an arena in postfix order, [`CheckedTree::nodes`]; these walks are for paths and for
/// other orders.
impl CheckedTree {
    /// Parents before children, children in order.
    pub fn prefix(&self, visit: Visit) -> impl Iterator<Item = NodeId> {
        Traversal::new(self, self.root(), Order::Before, visit)
    }

    /// Parents between their children, children in order: see [`traverse`](crate::traverse).
    pub fn infix(&self, visit: Visit) -> impl Iterator<Item = NodeId> {
        Traversal::new(self, self.root(), Order::Between, visit)
    }

    /// Children before parents, in order.
    pub fn postfix(&self, visit: Visit) -> impl Iterator<Item = NodeId> {
        Traversal::new(self, self.root(), Order::Behind, visit)
    }
}
