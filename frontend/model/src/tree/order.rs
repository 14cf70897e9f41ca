//! Walks over trees, and rewriting.

use std::collections::HashMap;
use std::marker::PhantomData;

use super::Tree;
use crate::traverse::{Nodes, Order, Traversal, Visit};
use crate::written::Written;

/// Any tree.
#[derive(Clone, Copy)]
pub(crate) struct PlainNodes<'a>(PhantomData<&'a Tree>);

impl PlainNodes<'_> {
    pub(crate) const fn new() -> Self {
        Self(PhantomData)
    }
}

impl<'a> Nodes for PlainNodes<'a> {
    type Node = &'a Tree;

    fn children(self, node: &'a Tree) -> impl DoubleEndedIterator<Item = &'a Tree> + ExactSizeIterator {
        node.node().children().iter()
    }

    fn identity(self, node: &'a Tree) -> usize {
        node.identity()
    }
}

impl Tree {
    /// Parents before children, children in order.
    pub fn prefix(&self, visit: Visit) -> impl Iterator<Item = &Self> {
        Traversal::new(PlainNodes(PhantomData), self, Order::Before, visit)
    }

    /// Parents between their children, children in order: see [`traverse`](crate::traverse).
    pub fn infix(&self, visit: Visit) -> impl Iterator<Item = &Self> {
        Traversal::new(PlainNodes(PhantomData), self, Order::Between, visit)
    }

    /// Children before parents, in order.
    pub fn postfix(&self, visit: Visit) -> impl Iterator<Item = &Self> {
        Traversal::new(PlainNodes(PhantomData), self, Order::Behind, visit)
    }

    /// The tree with every node replaced for which `replace` returns another one.
    ///
    /// Bottom-up: `replace` sees each node once, with its children already replaced. What it does not replace
    /// stays as it is: shared nodes stay shared, untouched subtrees are those of the original.
    #[must_use]
    pub fn rewrite(&self, mut replace: impl FnMut(&Self) -> Option<Self>) -> Self {
        let mut done: HashMap<usize, Self> = HashMap::new();
        for tree in self.postfix(Visit::Nodes) {
            let old = tree.node().children();
            let new: Vec<Self> = old.iter().map(|child| done[&child.identity()].clone()).collect();
            let same = old.iter().zip(&new).all(|(a, b)| a.identity() == b.identity());
            let rebuilt = if same { tree.clone() } else { tree.with_children(new) };
            let result = replace(&rebuilt).unwrap_or(rebuilt);
            done.insert(tree.identity(), result);
        }
        done.remove(&self.identity()).unwrap_or_else(|| self.clone())
    }

    /// The same node, written in another way.
    pub(crate) fn with_written(&self, written: Written) -> Self {
        let node = self.node();
        Self::assemble(written, node.children().to_vec(), node.span()).labelled(node.label().cloned())
    }

    /// The same node over other children.
    pub(crate) fn with_children(&self, children: Vec<Self>) -> Self {
        let node = self.node();
        Self::assemble(node.written().clone(), children, node.span()).labelled(node.label().cloned())
    }
}
