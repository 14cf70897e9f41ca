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
//! In infix order a node comes between each two neighbours among its children, `x a y a z`: one time less
//! than it has children. An only child comes behind its node, as an operand behind a sign, and a leaf comes
//! once.

use std::collections::HashSet;

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
pub(crate) enum Order {
    Before,
    Between,
    Behind,
}

/// Nodes with children.
pub(crate) trait Nodes: Copy {
    type Node: Copy;

    fn children(self, node: Self::Node) -> impl DoubleEndedIterator<Item = Self::Node> + ExactSizeIterator;

    /// What tells nodes apart.
    fn identity(self, node: Self::Node) -> usize;
}

/// A walk that is under way.
pub(crate) struct Traversal<N: Nodes> {
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

impl<N: Nodes> Traversal<N> {
    pub(crate) fn new(nodes: N, root: N::Node, order: Order, visit: Visit) -> Self {
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

impl<N: Nodes> Iterator for Traversal<N> {
    type Item = N::Node;

    fn next(&mut self) -> Option<N::Node> {
        loop {
            match self.stack.pop()? {
                Todo::Visit(node) => return Some(node),
                // A node that was opened before is done by now: all that stood above it in the stack was
                // popped since, and it cannot be open still, since no node is its own descendant.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builder::{point, ring};
    use crate::check::NodeId;
    use crate::combine::{Combinator, Union};
    use crate::kind::NodeKind;
    use crate::model::Model;
    use crate::skeleton::SkeletonKind;
    use crate::tree::Tree;
    use crate::written::Written;

    /// The picture of the module: a is a union, b and c are colours, d is a point.
    fn diamond() -> Tree {
        let d = point([0.0; 3], 1.0);
        d.color([1.0, 0.0, 0.0]) | d.translate([1.0, 0.0, 0.0])
    }

    fn letters<'a>(trees: impl Iterator<Item = &'a Tree>) -> String {
        let letter = |tree: &Tree| match tree.node().written() {
            Written::Combine { .. } | Written::Expression(_) => 'a',
            Written::Attribute { .. } | Written::Constant { .. } => 'b',
            Written::Map { .. } | Written::Warp { .. } | Written::FormulaWarp(_) | Written::Select(_) => 'c',
            Written::Primitive { .. } | Written::Particles(_) => 'd',
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
        let three = Tree::new(Combinator::from(Union {}), vec![b, c.clone(), c]);
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
                trees.map(|tree| tree.node().written().evaluated(0.5).expect("it means something")).collect()
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
        assert!(text.starts_with("{0: (Primitive {"), "{text}");
        assert!(text.ends_with(", 1: (Combine { combinator: Union, fields: [] }, [0, 0])}"), "{text}");
    }

    #[test]
    fn a_replaced_leaf_stays_shared() {
        let torus = ring([0.0; 3], [0.0, 0.0, 1.0], 1.0, 0.5);
        let is_point = |tree: &Tree| {
            matches!(tree.node().written(), Written::Primitive { skeleton: SkeletonKind::Point, .. })
        };
        let tree = diamond().rewrite(|tree| is_point(tree).then(|| torus.clone()));
        assert_eq!(tree.prefix(Visit::Nodes).count(), 4);
        assert!(
            tree.prefix(Visit::Paths)
                .filter(|t| t.node().children().is_empty())
                .all(|t| t.identity() == torus.identity())
        );
        assert!(matches!(torus.node().written(), Written::Primitive { skeleton: SkeletonKind::Ring, .. }));
    }

    #[test]
    fn what_is_not_replaced_is_the_original() {
        let tree = diamond();
        assert_eq!(tree.rewrite(|_| None).identity(), tree.identity());
        // Without the colour, the other side is untouched.
        let plain = tree.rewrite(|t| {
            let is_attribute = matches!(t.node().written(), Written::Attribute { .. });
            is_attribute.then(|| t.node().children()[0].clone())
        });
        assert_eq!(letters(plain.prefix(Visit::Paths)), "adcd");
        assert_eq!(plain.node().children()[1].identity(), tree.node().children()[1].identity());
    }
}
