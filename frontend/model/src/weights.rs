//! Weights: how much each leaf, or what has a name, has to say at a point.
//!
//! ```text
//! sum { ball  rod }   ►   sum { weights 1 0 { ball }  weights 0 1 { rod } }
//! ```
//!
//! They are the coefficients by which attributes mix: the colour of a point is that of each leaf times its
//! weight, and the default times the weight of nobody. So they are groups like others, with 1 for the leaves
//! in question and 0 for the rest: programs compute them beside the field, by the rules of every operator.

use std::collections::HashMap;
use std::sync::Arc;

use jbt_ir::limits;

use crate::attribute::AttributeGroup;
use crate::check::{CheckedNode, CheckedTree, NodeId};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::kind::NodeKind;
use crate::owner::LeafWays;
use crate::report::clip;

/// The name of the group with the weight of each leaf.
pub const WEIGHTS: &str = "weights";
/// The name of the group with the weight of nobody.
pub const DEFAULT_WEIGHT: &str = "weights.default";
/// What stands behind a path, in the name of the group with the weight of what is there: `body/arm.weight`.
pub const WEIGHT: &str = ".weight";
/// Bytes of the longest way to a leaf in the name of a column.
const LONGEST_WAY: usize = 1000;

/// Whose weight is asked for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum WeightOf<'a> {
    /// Each leaf that may answer, one real for each, in the order of [`CheckedTree::answering_leaves`]. A
    /// leaf with several uses has the weight of all of them, and so have particles.
    Leaves,
    /// All leaves below the places that a path of names leads to: see [`path`](crate::path).
    Named(&'a str),
    /// Nobody: what the default of an attribute has to say. It is 1 where no leaf decides.
    Default,
}

impl CheckedTree {
    /// The same tree with one more attribute group: [`WEIGHTS`], the path and [`WEIGHT`], or
    /// [`DEFAULT_WEIGHT`]. Weights are in \[0, 1\], but for roundings of f32; those of all leaves and that of
    /// nobody add up to 1. They are the coefficients of every group that
    /// [blends](crate::attribute::Mixing::Blend).
    ///
    /// Parameters of the tree that is returned cannot be set: set those of this one.
    ///
    /// ```
    /// use jbt_model::weights::WeightOf;
    /// use jbt_model::walk::walk;
    /// let text = "jbt 1 sum { left: point { radius 2 } right: point { at (1 0 0) radius 2 } }";
    /// let tree = jbt_text::model(text)?.check()?;
    /// let tree = tree.with_weights(WeightOf::Leaves)?.with_weights(WeightOf::Default)?;
    /// let of = |x: f64| walk(&tree, [x, 0.0, 0.0]).attributes[1..].concat();
    /// assert_eq!(of(0.5), [0.5, 0.5, 0.0], "halfway between two equal points");
    /// assert_eq!(of(9.0), [0.0, 0.0, 1.0], "nobody is heard there");
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    ///
    /// # Errors
    /// A group of this name, and as many groups as there may be. Of leaves, more than
    /// [`MAX_WEIGHT_NUMBERS`](limits::MAX_WEIGHT_NUMBERS) numbers: each use of a leaf and each particle keeps
    /// one for each column. Of a path, those of [`find`](Self::find), and one that leads to some of the
    /// places of a shared node and not to others.
    pub fn with_weights(&self, of: WeightOf<'_>) -> Result<Self, Diagnostics> {
        let name: Arc<str> = match of {
            WeightOf::Leaves => WEIGHTS.into(),
            WeightOf::Named(path) => format!("{path}{WEIGHT}").into(),
            WeightOf::Default => DEFAULT_WEIGHT.into(),
        };
        if self.has_group(&name) {
            let error = format!("the model has an attribute `{}` of its own", clip(&name));
            return Err(vec![Diagnostic::error(None, error)].into());
        }
        let group = AttributeGroup { default: vec![0.0], ..AttributeGroup::mixed(&name) };
        match of {
            WeightOf::Leaves => self.with_weights_of_leaves(group),
            WeightOf::Named(path) => {
                let marked = self.marked(path)?;
                self.with_group(group, |id, _| marked.contains_key(&id).then(|| vec![1.0]))
            }
            WeightOf::Default => {
                let group = AttributeGroup { default: vec![1.0], ..group };
                self.with_group(group, |id, _| self.node(id).children.is_empty().then(|| vec![0.0]))
            }
        }
    }

    /// The leaves that answer for themselves somewhere, ascending: primitives, particles and formulas that a
    /// way leads to, through the chosen children of selectors and to no weights of warps.
    #[must_use]
    pub fn answering_leaves(&self) -> Vec<NodeId> {
        LeafWays::new(self).leaves()
    }

    fn with_weights_of_leaves(&self, group: AttributeGroup) -> Result<Self, Diagnostics> {
        let ways = LeafWays::new(self);
        let leaves = ways.leaves();
        let numbers = self.leaf_rows().saturating_mul(leaves.len() as u64);
        if numbers > limits::MAX_WEIGHT_NUMBERS {
            let most = limits::MAX_WEIGHT_NUMBERS;
            let message =
                format!("weights of {} leaves take {numbers} numbers; they may take {most}", leaves.len());
            let error =
                Diagnostic::limit(None, message).expected("ask for those of names, as body/arm.weight");
            return Err(vec![error].into());
        }
        if leaves.is_empty() {
            return Err(
                vec![Diagnostic::error(None, "the model has no leaf that could have a weight")].into()
            );
        }
        let title =
            |leaf: &NodeId| format!("{WEIGHTS}.{}", ways.path(*leaf, LONGEST_WAY).unwrap_or_default());
        let titles = leaves.iter().map(title).collect();
        let columns: HashMap<NodeId, usize> = leaves.iter().copied().zip(0..).collect();
        let group = AttributeGroup { default: vec![0.0; leaves.len()], titles, ..group };
        let width = leaves.len();
        self.with_group(group, |id, _| {
            let &column = columns.get(&id)?;
            let mut numbers = vec![0.0; width];
            numbers[column] = 1.0;
            Some(numbers)
        })
    }

    /// Leaves by all paths from the root, and particles.
    fn leaf_rows(&self) -> u64 {
        let rows = |(node, &uses): (&CheckedNode, &u64)| {
            if let NodeKind::Particles(particles) = &node.kind {
                return uses.saturating_mul(particles.len() as u64);
            }
            if node.children.is_empty() { uses } else { 0 }
        };
        self.nodes().iter().zip(self.uses()).map(rows).fold(0, u64::saturating_add)
    }

    /// The nodes that a path leads to, with the number of places of each: all that it has.
    fn marked(&self, path: &str) -> Result<HashMap<NodeId, u64>, Diagnostics> {
        let mut places: HashMap<NodeId, u64> = HashMap::new();
        for found in self.find(path)? {
            *places.entry(found.node).or_default() += 1;
        }
        let shared = places.iter().find(|(node, count)| self.uses()[node.0 as usize] != **count);
        if let Some((node, count)) = shared {
            let (uses, span) = (self.uses()[node.0 as usize], self.node(*node).span);
            let message =
                format!("`{}` leads to {count} of the {uses} places of one shared node", clip(path));
            let error = Diagnostic::error(span, message);
            let error = error.expected("give this use a name of its own, as left: use arm, and ask for that");
            return Err(self.diagnostics(vec![error]));
        }
        Ok(places)
    }
}
