//! Two models, item by item: what is in one and not in the other, and what is written otherwise.
//!
//! ```text
//! compare(a, b):  equal hashes     the same
//!                 equal words      compare the children: equal hashes meet first, then equal names, then equal
//!                                  kinds, in order; the others are in one alone
//!                 equal kinds      changed, and then as above
//! ```

use std::collections::{HashMap, HashSet};

use jbt_model::model::Model;
use jbt_model::tree::Tree;
use jbt_model::written::Written;

use crate::hash::{ModelHash, hashes};
use crate::item::{node_words, statements};

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
}

/// What two models differ in: statements first, then nodes in the order of the first one. At most
/// [`MAX_DIFFERENCES`]. Names and comments do not count.
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
    let mut found = Vec::new();
    let [a, b] = [statements(first), statements(second)];
    let only = |of: &[String], others: &[String]| -> Vec<String> {
        let others: HashSet<&String> = others.iter().collect();
        of.iter().filter(|one| !others.contains(one)).cloned().collect()
    };
    let statement = |first: Option<String>, second: Option<String>| ModelDifference {
        path: String::new(),
        first,
        second,
    };
    found.extend(only(&a, &b).into_iter().map(|one| statement(Some(one), None)));
    found.extend(only(&b, &a).into_iter().map(|one| statement(None, Some(one))));
    let search =
        ModelComparison { hashes: [hashes(&first.root), hashes(&second.root)], seen: HashSet::new() };
    search.run(&first.root, &second.root, &mut found);
    found
}

struct ModelComparison {
    hashes: [HashMap<usize, ModelHash>; 2],
    /// Pairs that have been compared: shared subtrees differ once.
    seen: HashSet<(usize, usize)>,
}

impl ModelComparison {
    fn run(mut self, first: &Tree, second: &Tree, found: &mut Vec<ModelDifference>) {
        let mut stack = vec![(Some(first), Some(second), word(first))];
        while let Some((a, b, path)) = stack.pop() {
            if found.len() >= MAX_DIFFERENCES {
                return;
            }
            let (Some(a), Some(b)) = (a, b) else {
                let (first, second) = (a.map(node_words), b.map(node_words));
                found.push(ModelDifference { path, first, second });
                continue;
            };
            let equal = self.hashes[0][&a.identity()] == self.hashes[1][&b.identity()];
            if equal || !self.seen.insert((a.identity(), b.identity())) {
                continue;
            }
            let (words, others) = (node_words(a), node_words(b));
            if words != others {
                found.push(ModelDifference { path: path.clone(), first: Some(words), second: Some(others) });
            }
            let pairs = self.pairs(a.node().children(), b.node().children());
            for (place, (a, b)) in pairs.into_iter().enumerate().rev() {
                let name = a.or(b).map(word).unwrap_or_default();
                stack.push((a, b, format!("{path}.{place}/{name}")));
            }
        }
    }

    /// Children that belong together, in the order of the first ones.
    fn pairs<'a>(&self, first: &'a [Tree], second: &'a [Tree]) -> Vec<(Option<&'a Tree>, Option<&'a Tree>)> {
        let mut partners: Vec<Option<usize>> = vec![None; first.len()];
        let mut taken = vec![false; second.len()];
        let hash = |side: usize, tree: &Tree| format!("{}", self.hashes[side][&tree.identity()]);
        let name = |tree: &Tree| tree.node().name().map(str::to_owned).unwrap_or_default();
        let kind = |tree: &Tree| kind(tree);
        let keys: [[Vec<String>; 2]; 3] = [
            [
                first.iter().map(|tree| hash(0, tree)).collect(),
                second.iter().map(|tree| hash(1, tree)).collect(),
            ],
            [first.iter().map(name).collect(), second.iter().map(name).collect()],
            [first.iter().map(kind).collect(), second.iter().map(kind).collect()],
        ];
        for [of, others] in &keys {
            let mut waiting: HashMap<&str, Vec<usize>> = HashMap::new();
            for (place, key) in others.iter().enumerate().rev().filter(|(place, _)| !taken[*place]) {
                waiting.entry(key).or_default().push(place);
            }
            for (place, key) in of.iter().enumerate() {
                if partners[place].is_none() && !key.is_empty() {
                    partners[place] = waiting.get_mut(key.as_str()).and_then(Vec::pop);
                    partners[place].into_iter().for_each(|partner| taken[partner] = true);
                }
            }
        }
        let pair = |(tree, partner): (&'a Tree, &Option<usize>)| (Some(tree), partner.map(|at| &second[at]));
        let mut pairs: Vec<_> = first.iter().zip(&partners).map(pair).collect();
        pairs.extend(
            second.iter().zip(&taken).filter(|(_, taken)| !**taken).map(|(tree, _)| (None, Some(tree))),
        );
        pairs
    }
}

/// The word for a node: its name, or that of its kind.
fn word(tree: &Tree) -> String {
    tree.node().name().map_or_else(|| kind(tree), str::to_owned)
}

/// The first word of a node.
fn kind(tree: &Tree) -> String {
    match tree.node().written() {
        Written::Attribute { name, .. } => name.to_string(),
        _ => node_words(tree).split([' ', '{', '(']).next().unwrap_or_default().to_owned(),
    }
}
