//! Structural sharing: subtrees that are equal become one.
//!
//! ```text
//! sum                          sum
//! ├─ ring { radius 1 }    ►    ├─┐
//! └─ ring { radius 1 }         └─┴─ ring { radius 1 }
//! ```
//!
//! Children come before parents, so two nodes are equal if their words and numbers are, and if their children
//! have become the same ones.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::mem::discriminant;

use super::Tree;
use crate::number::{Number, Step};
use crate::particles::NumberArray;
use crate::traverse::Visit;
use crate::written::{Written, WrittenParticles};

impl Tree {
    /// The same tree, of which equal subtrees are one: of the same words, numbers of the same bits that
    /// follow the same parameters in the same way, and the same names. What is shared already stays shared.
    ///
    /// Cost: linear in the number of nodes.
    ///
    /// ```
    /// use jbt_model::builder::point;
    /// use jbt_model::traverse::Visit;
    ///
    /// let pair = point([0; 3], 1) + point([0; 3], 1);
    /// assert_eq!(pair.prefix(Visit::Nodes).count(), 3);
    /// assert_eq!(pair.share().prefix(Visit::Nodes).count(), 2);
    /// ```
    #[must_use]
    pub fn share(&self) -> Self {
        let mut known: HashMap<u64, Vec<Self>> = HashMap::new();
        self.rewrite(|tree| {
            let alike = known.entry(hash(tree)).or_default();
            if let Some(first) = alike.iter().find(|other| is_same(other, tree)) {
                return Some(first.clone());
            }
            alike.push(tree.clone());
            None
        })
    }

    /// How many nodes there are, shared ones counted once.
    #[must_use]
    pub fn count(&self) -> usize {
        self.prefix(Visit::Nodes).count()
    }
}

fn hash(tree: &Tree) -> u64 {
    let mut hasher = DefaultHasher::new();
    let node = tree.node();
    discriminant(node.written()).hash(&mut hasher);
    node.written().numbers().for_each(|number| number.value().to_bits().hash(&mut hasher));
    if let Written::Particles(particles) = node.written() {
        // Enough to tell most apart.
        particles.positions.len().hash(&mut hasher);
        particles.positions.iter().take(9).for_each(|number| number.to_bits().hash(&mut hasher));
    }
    node.children().iter().for_each(|child| child.identity().hash(&mut hasher));
    node.name().hash(&mut hasher);
    hasher.finish()
}

/// Whether two nodes over children that are shared are equal to the bit.
fn is_same(a: &Tree, b: &Tree) -> bool {
    let (a, b) = (a.node(), b.node());
    let same_bits = |(a, b): (&Number, &Number)| {
        let literal = |step: &Step| matches!(step, Step::Literal(_));
        a.value().to_bits() == b.value().to_bits()
            && (a.steps().iter().all(literal) && b.steps().iter().all(literal) || a.steps() == b.steps())
    };
    a.children().len() == b.children().len()
        && a.children().iter().zip(b.children()).all(|(a, b)| a.identity() == b.identity())
        && a.name() == b.name()
        && a.label().is_some_and(|label| label.part) == b.label().is_some_and(|label| label.part)
        && a.label().and_then(|label| label.style.as_ref())
            == b.label().and_then(|label| label.style.as_ref())
        && a.written() == b.written()
        && a.written().numbers().zip(b.written().numbers()).all(same_bits)
        && match (a.written(), b.written()) {
            (Written::Particles(a), Written::Particles(b)) => have_same_bits(a, b),
            _ => true,
        }
}

/// Whether the arrays of equal particles are equal to the bit.
fn have_same_bits(a: &WrittenParticles, b: &WrittenParticles) -> bool {
    let same = |a: &NumberArray, b: &NumberArray| a.iter().map(f64::to_bits).eq(b.iter().map(f64::to_bits));
    same(&a.positions, &b.positions)
        && a.values.iter().zip(b.values.iter()).all(|(a, b)| same(&a.numbers, &b.numbers))
}
