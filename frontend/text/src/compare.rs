//! Two models, item by item: what is in one and not in the other, what is written otherwise, and what stands
//! in another order.
//!
//! ```text
//! compare(a, b):  equal hashes     the same
//!                 equal words      compare the children: equal hashes meet first, then equal names, then equal
//!                                  kinds, in order; the others are in one alone. Of those that meet, the longest
//!                                  run in the order of both stays in place, and the others have moved
//!                 other words      changed, and then as above
//! ```

use std::collections::HashSet;

use jbt_model::model::Model;

use crate::hash::{ModelHash, NodeHashes};
use crate::item::{ItemPlace, NodeItem, statements};
use crate::pairs::{Pair, Partners};

/// The most items of a comparison.
pub const MAX_DIFFERENCES: usize = 10_000;

/// A difference between two models. Words are those of a printed text, without what stands in blocks.
#[derive(Clone, PartialEq, Debug)]
pub struct ModelDifference {
    /// The way from the root: names, or words of kinds, with the numbers of children; empty for statements.
    pub path: String,
    /// How the first model has it; nothing if it is in the second alone.
    pub first: Option<String>,
    /// How the second model has it; nothing if it is in the first alone.
    pub second: Option<String>,
    /// Its places among its neighbours in both models, from 0, if it stands in another order there. The words
    /// are those of the node then, and a change of the words is a difference of its own.
    pub moved: Option<[usize; 2]>,
}

/// What two models differ in: statements first, then nodes in the order of the first one. At most
/// [`MAX_DIFFERENCES`]. Names of nodes and comments do not count, names of parts and the order of nodes do:
/// models with different hashes differ in something.
///
/// ```
/// use jbt_text::{compare, model};
/// let [a, b] = ["1", "2"].map(|r| {
///     model(&format!("jbt 1 union {{ hub: point {{ radius {r} }} point {{ radius 5 }} }}")).unwrap()
/// });
/// let found = compare(&a, &b);
/// assert_eq!(found.len(), 1);
/// assert_eq!(found[0].path, "union.0/hub");
/// assert_eq!(found[0].second.as_deref(), Some("point { radius 2 }"));
/// ```
#[must_use]
pub fn compare(first: &Model, second: &Model) -> Vec<ModelDifference> {
    let mut found = compare_statements(&statements(first), &statements(second));
    let search = ModelComparison {
        hashes: [NodeHashes::new(&first.root), NodeHashes::new(&second.root)],
        seen: HashSet::new(),
    };
    search.run(NodeItem::root(&first.root), NodeItem::root(&second.root), &mut found);
    found
}

/// What the statements differ in: those of one alone, then those that have moved.
fn compare_statements(first: &[String], second: &[String]) -> Vec<ModelDifference> {
    let mut partners = Partners::new(first.len(), second.len());
    partners.meet(first, second, &String::new());
    let (alone, met): (Vec<Pair>, Vec<Pair>) =
        partners.pairs().into_iter().partition(|pair| pair.places.contains(&None));
    let told = |Pair { places: [a, b], moved }| ModelDifference {
        path: String::new(),
        first: a.map(|at| first[at].clone()),
        second: b.map(|at| second[at].clone()),
        moved,
    };
    alone.into_iter().chain(met.into_iter().filter(|pair| pair.moved.is_some())).map(told).collect()
}

struct ModelComparison {
    hashes: [NodeHashes; 2],
    /// Pairs that have been compared: shared subtrees differ once.
    seen: HashSet<(usize, usize, [ItemPlace; 2])>,
}

/// Two nodes to compare.
struct NodePair<'a> {
    nodes: [Option<NodeItem<'a>>; 2],
    moved: Option<[usize; 2]>,
    path: String,
}

impl ModelComparison {
    fn run(mut self, first: NodeItem<'_>, second: NodeItem<'_>, found: &mut Vec<ModelDifference>) {
        let nodes = [Some(first), Some(second)];
        let mut stack = vec![NodePair { nodes, moved: None, path: first.name() }];
        while let Some(NodePair { nodes, moved, path }) = stack.pop() {
            if found.len() >= MAX_DIFFERENCES {
                return;
            }
            let [Some(a), Some(b)] = nodes else {
                let [first, second] = nodes.map(|node| node.map(NodeItem::words));
                found.push(ModelDifference { path, first, second, moved: None });
                continue;
            };
            let (words, others) = (a.words(), b.words());
            if moved.is_some() {
                let (first, second) = (Some(words.clone()), Some(others.clone()));
                found.push(ModelDifference { path: path.clone(), first, second, moved });
            }
            let equal = self.hashes[0].of(a) == self.hashes[1].of(b);
            let ids = (a.tree.identity(), b.tree.identity(), [a.place, b.place]);
            if equal || !self.seen.insert(ids) {
                continue;
            }
            if words != others {
                let (first, second) = (Some(words), Some(others));
                found.push(ModelDifference { path: path.clone(), first, second, moved: None });
            }
            stack.extend(self.below(a, b, &path).into_iter().rev());
        }
    }

    /// The children of two nodes that are to be compared: not those that are equal, and in place.
    fn below<'a>(&self, a: NodeItem<'a>, b: NodeItem<'a>, path: &str) -> Vec<NodePair<'a>> {
        let [first, second]: [Vec<NodeItem<'a>>; 2] = [a, b].map(|node| node.children().collect());
        let pairs = pairs(&self.hashes, &first, &second);
        let mut below = Vec::new();
        for (place, Pair { places: [a, b], moved }) in pairs.into_iter().enumerate() {
            let nodes = [a.map(|at| first[at]), b.map(|at| second[at])];
            let equal = match nodes {
                [Some(a), Some(b)] => self.hashes[0].of(a) == self.hashes[1].of(b),
                _ => false,
            };
            if let (Some(named), true) = (nodes[0].or(nodes[1]), !equal || moved.is_some()) {
                let path = format!("{path}.{place}/{}", named.name());
                below.push(NodePair { nodes, moved, path });
            }
        }
        below
    }
}

/// The children of two nodes as pairs.
fn pairs(hashes: &[NodeHashes; 2], first: &[NodeItem<'_>], second: &[NodeItem<'_>]) -> Vec<Pair> {
    let hash = |side: usize, nodes: &[NodeItem<'_>]| -> Vec<Option<ModelHash>> {
        nodes.iter().map(|&node| Some(hashes[side].of(node))).collect()
    };
    let name = |nodes: &[NodeItem<'_>]| -> Vec<String> {
        nodes.iter().map(|node| node.tree.node().name().map(str::to_owned).unwrap_or_default()).collect()
    };
    let kind = |nodes: &[NodeItem<'_>]| -> Vec<String> { nodes.iter().map(|node| node.kind()).collect() };
    let mut partners = Partners::new(first.len(), second.len());
    partners.meet(&hash(0, first), &hash(1, second), &None);
    if partners.is_open() {
        partners.meet(&name(first), &name(second), &String::new());
        partners.meet(&kind(first), &kind(second), &String::new());
    }
    partners.pairs()
}
