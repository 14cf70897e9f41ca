//! Walking over trees and rewriting them, without recursion.
//!
//! ```text
//!       a                 Visit::Nodes, prefix   a b d c        each node once
//!      / \                Visit::Nodes, postfix  d b c a        (postfix: an order to build the tree in)
//!     b   c               Visit::Paths, prefix   a b d c d      each path from the root once: the tree unfolded
//!      \ /                Visit::Paths, postfix  d b d c a
//!       d                 Visit::Paths, infix    b d a c d      between children, as operators are written
//! ```
//!
//! In infix order a node comes between each two neighbours among its children, `x a y a z`: one time less than it has children. An only child comes
//! behind its node, as an operand behind a sign, and a leaf comes once.

use std::collections::{HashMap, HashSet};
use std::marker::PhantomData;

use crate::check::{CheckedTree, NodeId};
use crate::recipe::Recipe;
use crate::tree::Tree;

/// How often a shared node is visited.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Visit {
    /// Once; in infix order, with all its children once.
    Nodes,
    /// Once for each path from the root. Paths can be exponentially many: count before, or stop in time.
    Paths,
}

/// Where a node comes among its children.
#[derive(Clone, Copy, Debug)]
enum Order {
    Before,
    Between,
    Behind,
}

/// Nodes with children.
trait Nodes: Copy {
    type Node: Copy;

    fn children(self, node: Self::Node) -> impl DoubleEndedIterator<Item = Self::Node> + ExactSizeIterator;

    /// What tells nodes apart.
    fn identity(self, node: Self::Node) -> usize;
}

/// Any tree.
#[derive(Clone, Copy)]
struct Plain<'a>(PhantomData<&'a Tree>);

impl<'a> Nodes for Plain<'a> {
    type Node = &'a Tree;

    fn children(self, node: &'a Tree) -> impl DoubleEndedIterator<Item = &'a Tree> + ExactSizeIterator {
        node.node().children().iter()
    }

    fn identity(self, node: &'a Tree) -> usize {
        node.identity()
    }
}

/// What has passed the check.
impl Nodes for &CheckedTree {
    type Node = NodeId;

    fn children(self, node: NodeId) -> impl DoubleEndedIterator<Item = NodeId> + ExactSizeIterator {
        self.node(node).children.iter().copied()
    }

    fn identity(self, node: NodeId) -> usize {
        node.0 as usize
    }
}

/// A walk that is under way.
struct Walk<N: Nodes> {
    nodes: N,
    order: Order,
    stack: Vec<Todo<N::Node>>,
    seen: Option<HashSet<usize>>,
}

/// What comes next.
enum Todo<N> {
    /// All that is below a node, and itself.
    Open(N),
    /// The node itself.
    Visit(N),
}

impl<N: Nodes> Walk<N> {
    fn new(nodes: N, root: N::Node, order: Order, visit: Visit) -> Self {
        let seen = match visit {
            Visit::Nodes => Some(HashSet::new()),
            Visit::Paths => None,
        };
        Self { nodes, order, stack: vec![Todo::Open(root)], seen }
    }

    /// Puts a node and its children onto the stack, the last one first.
    fn open(&mut self, node: N::Node) {
        let count = self.nodes.children(node).len();
        let children = self.nodes.children(node).enumerate();
        match self.order {
            Order::Before => {
                self.stack.extend(children.rev().map(|(_, child)| Todo::Open(child)));
                self.stack.push(Todo::Visit(node));
            }
            Order::Behind => {
                self.stack.push(Todo::Visit(node));
                self.stack.extend(children.rev().map(|(_, child)| Todo::Open(child)));
            }
            Order::Between => {
                for (place, child) in children.rev() {
                    self.stack.push(Todo::Open(child));
                    if place > 0 {
                        self.stack.push(Todo::Visit(node));
                    }
                }
                if count < 2 {
                    self.stack.push(Todo::Visit(node));
                }
            }
        }
    }
}

impl<N: Nodes> Iterator for Walk<N> {
    type Item = N::Node;

    fn next(&mut self) -> Option<N::Node> {
        loop {
            match self.stack.pop()? {
                Todo::Visit(node) => return Some(node),
                // A node that was opened before is done by now: all that stood above it in the stack was popped since, and it cannot
                // be open still, since no node is its own descendant.
                Todo::Open(node) => {
                    let identity = self.nodes.identity(node);
                    if self.seen.as_mut().is_none_or(|seen| seen.insert(identity)) {
                        self.open(node);
                    }
                }
            }
        }
    }
}

/// A checked tree is an arena in postfix order, [`CheckedTree::nodes`]; these are for paths, and for other orders.
impl CheckedTree {
    /// Parents before children, children in order.
    pub fn prefix(&self, visit: Visit) -> impl Iterator<Item = NodeId> {
        Walk::new(self, self.root(), Order::Before, visit)
    }

    /// Parents between their children, children in order: see [`traverse`](crate::traverse).
    pub fn infix(&self, visit: Visit) -> impl Iterator<Item = NodeId> {
        Walk::new(self, self.root(), Order::Between, visit)
    }

    /// Children before parents, in order.
    pub fn postfix(&self, visit: Visit) -> impl Iterator<Item = NodeId> {
        Walk::new(self, self.root(), Order::Behind, visit)
    }
}

impl Tree {
    /// Parents before children, children in order.
    pub fn prefix(&self, visit: Visit) -> impl Iterator<Item = &Self> {
        Walk::new(Plain(PhantomData), self, Order::Before, visit)
    }

    /// Parents between their children, children in order: see [`traverse`](crate::traverse).
    pub fn infix(&self, visit: Visit) -> impl Iterator<Item = &Self> {
        Walk::new(Plain(PhantomData), self, Order::Between, visit)
    }

    /// Children before parents, in order.
    pub fn postfix(&self, visit: Visit) -> impl Iterator<Item = &Self> {
        Walk::new(Plain(PhantomData), self, Order::Behind, visit)
    }

    /// The tree with every node replaced for which `replace` returns another one.
    ///
    /// Bottom-up: `replace` sees each node once, with its children already replaced. What it does not replace stays as it is: shared
    /// nodes stay shared, untouched subtrees are those of the original.
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

    /// A node of another recipe in the same place of the text, over the same children.
    pub(crate) fn with_recipe(&self, recipe: Recipe) -> Self {
        let other = Self::of(recipe, self.node().children().to_vec());
        let node = other.node();
        Self::assemble(
            node.kind().clone(),
            node.recipe().cloned(),
            node.children().to_vec(),
            self.node().span(),
        )
    }

    /// The same node over other children.
    pub(crate) fn with_children(&self, children: Vec<Self>) -> Self {
        let node = self.node();
        Self::assemble(node.kind().clone(), node.recipe().cloned(), children, node.span())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builder::{point, ring};
    use crate::combine::Combinator;
    use crate::model::Model;
    use crate::skeleton::{Ring, Skeleton};
    use crate::tree::NodeKind;

    /// The picture of the module: a is a union, b and c are colours, d is a point.
    fn diamond() -> Tree {
        let d = point([0.0; 3], 1.0);
        d.color([1.0, 0.0, 0.0]) | d.translate([1.0, 0.0, 0.0])
    }

    fn letters<'a>(trees: impl Iterator<Item = &'a Tree>) -> String {
        let letter = |tree: &Tree| match tree.node().kind() {
            NodeKind::Combine(_) | NodeKind::Expression(_) => 'a',
            NodeKind::Attribute { .. } => 'b',
            NodeKind::Affine(_) | NodeKind::Warp(_) | NodeKind::Select(_) => 'c',
            NodeKind::Primitive(_) => 'd',
        };
        trees.map(letter).collect()
    }

    #[test]
    fn orders() {
        let tree = diamond();
        assert_eq!(letters(tree.prefix(Visit::Nodes)), "abdc");
        assert_eq!(letters(tree.prefix(Visit::Paths)), "abdcd");
        assert_eq!(letters(tree.postfix(Visit::Nodes)), "dbca");
        assert_eq!(letters(tree.postfix(Visit::Paths)), "dbdca");
        assert_eq!(letters(tree.infix(Visit::Nodes)), "bdac");
        assert_eq!(letters(tree.infix(Visit::Paths)), "bdacd");
    }

    #[test]
    fn infix_is_between_all_children() {
        let d = point([0.0; 3], 1.0);
        let [b, c] = [d.color([1.0, 0.0, 0.0]), d.translate([1.0, 0.0, 0.0])];
        let three = Tree::new(NodeKind::Combine(Combinator::Union), vec![b, c.clone(), c]);
        assert_eq!(letters(three.infix(Visit::Paths)), "bdacdacd");
        // What was there already is left out, not the node in front of it.
        assert_eq!(letters(three.infix(Visit::Nodes)), "bdaca");
        assert_eq!(letters(d.infix(Visit::Nodes)), "d");
    }

    #[test]
    fn checked_trees_have_the_same_orders() {
        let tree = diamond();
        let checked = Model::new(tree.clone()).check().expect("a good model");
        for visit in [Visit::Nodes, Visit::Paths] {
            let kinds = |ids: &mut dyn Iterator<Item = NodeId>| -> Vec<NodeKind> {
                ids.map(|id| checked.node(id).kind.clone()).collect()
            };
            let plain = |trees: &mut dyn Iterator<Item = &Tree>| -> Vec<NodeKind> {
                trees.map(|tree| tree.node().kind().clone()).collect()
            };
            assert_eq!(kinds(&mut checked.prefix(visit)), plain(&mut tree.prefix(visit)));
            assert_eq!(kinds(&mut checked.infix(visit)), plain(&mut tree.infix(visit)));
            assert_eq!(kinds(&mut checked.postfix(visit)), plain(&mut tree.postfix(visit)));
        }
        let arena: Vec<u32> = checked.postfix(Visit::Nodes).map(|id| id.0).collect();
        assert_eq!(arena, [0, 1, 2, 3]);
    }

    #[test]
    fn debugging_lists_each_node_once() {
        let ball = point([0.0; 3], 1.0);
        let text = format!("{:?}", &ball | &ball);
        assert!(text.starts_with("{0: (Primitive("), "{text}");
        assert!(text.ends_with(", 1: (Combine(Union), [0, 0])}"), "{text}");
    }

    #[test]
    fn a_replaced_leaf_stays_shared() {
        let torus = ring([0.0; 3], [0.0, 0.0, 1.0], 1.0, 0.5);
        let is_point = |tree: &Tree| matches!(tree.node().kind(), NodeKind::Primitive(leaf) if matches!(leaf.skeleton, Skeleton::Point(_)));
        let tree = diamond().rewrite(|tree| is_point(tree).then(|| torus.clone()));
        assert_eq!(tree.prefix(Visit::Nodes).count(), 4);
        assert!(
            tree.prefix(Visit::Paths)
                .filter(|t| t.node().children().is_empty())
                .all(|t| t.identity() == torus.identity())
        );
        let expected =
            Skeleton::from(Ring { center: glam::DVec3::ZERO, normal: glam::DVec3::Z, radius: 1.0 });
        assert!(matches!(torus.node().kind(), NodeKind::Primitive(leaf) if leaf.skeleton == expected));
    }

    #[test]
    fn what_is_not_replaced_is_the_original() {
        let tree = diamond();
        assert_eq!(tree.rewrite(|_| None).identity(), tree.identity());
        // Without the colour, the other side is untouched.
        let plain = tree.rewrite(|t| match t.node().kind() {
            NodeKind::Attribute { .. } => Some(t.node().children()[0].clone()),
            NodeKind::Primitive(_)
            | NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Warp(_) => None,
        });
        assert_eq!(letters(plain.prefix(Visit::Paths)), "adcd");
        assert_eq!(plain.node().children()[1].identity(), tree.node().children()[1].identity());
    }
}
