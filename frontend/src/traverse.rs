//! Walking over trees and rewriting them, without recursion.
//!
//! ```text
//!       a                 Visit::Nodes, prefix   a b d c        each node once
//!      / \                Visit::Nodes, postfix  d b c a        (postfix: an order to build the tree in)
//!     b   c               Visit::Paths, prefix   a b d c d      each path from the root once: the tree unfolded
//!      \ /                Visit::Paths, postfix  d b d c a
//!       d
//! ```

use std::collections::{HashMap, HashSet};

use crate::recipe::Recipe;
use crate::tree::Tree;

/// How often a shared node is visited.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Visit {
    /// Once.
    Nodes,
    /// Once for each path from the root. Paths can be exponentially many: count before, or stop in time.
    Paths,
}

/// The nodes of a tree, parents before children. See [`Tree::prefix`].
#[derive(Clone, Debug)]
pub struct Prefix<'a> {
    stack: Vec<&'a Tree>,
    seen: Option<HashSet<usize>>,
}

impl<'a> Iterator for Prefix<'a> {
    type Item = &'a Tree;

    fn next(&mut self) -> Option<&'a Tree> {
        loop {
            let tree = self.stack.pop()?;
            if self.seen.as_mut().is_none_or(|seen| seen.insert(tree.identity())) {
                self.stack.extend(tree.node().children().iter().rev());
                return Some(tree);
            }
        }
    }
}

/// The nodes of a tree, children before parents. See [`Tree::postfix`].
#[derive(Clone, Debug)]
pub struct Postfix<'a> {
    /// Each with whether its children were put above it.
    stack: Vec<(&'a Tree, bool)>,
    seen: Option<HashSet<usize>>,
}

impl<'a> Iterator for Postfix<'a> {
    type Item = &'a Tree;

    fn next(&mut self) -> Option<&'a Tree> {
        loop {
            let (tree, opened) = self.stack.pop()?;
            if opened {
                return Some(tree);
            }
            // A node that was opened before is done by now: all that stood above it in the stack was popped since, and it cannot
            // be open still, since no node is its own descendant.
            if self.seen.as_mut().is_none_or(|seen| seen.insert(tree.identity())) {
                self.stack.push((tree, true));
                self.stack.extend(tree.node().children().iter().rev().map(|child| (child, false)));
            }
        }
    }
}

impl Tree {
    /// Parents before children, children in order.
    #[must_use]
    pub fn prefix(&self, visit: Visit) -> Prefix<'_> {
        Prefix { stack: vec![self], seen: visit.seen() }
    }

    /// Children before parents, in order.
    #[must_use]
    pub fn postfix(&self, visit: Visit) -> Postfix<'_> {
        Postfix { stack: vec![(self, false)], seen: visit.seen() }
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

impl Visit {
    fn seen(self) -> Option<HashSet<usize>> {
        match self {
            Self::Nodes => Some(HashSet::new()),
            Self::Paths => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builder::{point, ring};
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
