//! Owners as an attribute: a tree whose answers say which leaf decides, at any number of points at once.
//!
//! ```text
//! union { ball  color (1 0 0) { rod } }   ►   union { owner 0 { ball }  color (1 0 0) { owner 1 { rod } } }
//! ```
//!
//! The owner of a point is the leaf whose value a `dominant` attribute takes, so a group with one value for
//! each leaf is all it needs: programs compute it beside the field, by the rules of every operator.

use super::arena::NodeId;
use super::tree::CheckedTree;
use crate::attribute::{AttributeGroup, Mixing};
use crate::diagnostic::{Diagnostic, Diagnostics};

/// The name of the group that says which leaf decides.
pub const OWNER: &str = "owner";

impl CheckedTree {
    /// The same tree with one more attribute group, [`OWNER`]: the number of the leaf that decides at a
    /// point, among [`nodes`](Self::nodes) of this tree, and -1 where none does. Where the field is not 0 it
    /// is what [`owner`](crate::owner::owner) answers for one point; of equals the first in the file decides.
    /// What an operator makes of nothing, as the outside of a complement, may decide as well, and then the
    /// number is -1. Numbers are whole in f32, as there are at most [`MAX_NODES`](jbt_ir::limits::MAX_NODES).
    ///
    /// Parameters of the tree that is returned cannot be set: set those of this one.
    ///
    /// ```
    /// use jbt_model::walk::walk;
    /// let text = "jbt 1 union { point { radius 1 } point { at (3 0 0) radius 1 } }";
    /// let tree = jbt_text::model(text)?.check()?;
    /// let owners = tree.with_owners()?;
    /// let of = |x: f64| walk(&owners, [x, 0.0, 0.0]).attributes[1][0];
    /// assert_eq!([of(0.1), of(2.5), of(9.0)], [0.0, 1.0, -1.0]);
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    ///
    /// # Errors
    /// A model that has a group of this name, or as many groups as there may be.
    pub fn with_owners(&self) -> Result<Self, Diagnostics> {
        self.with_values_of_leaves(-1.0, 1, |leaf| vec![f64::from(leaf.0)])
    }

    /// The same with a colour for each leaf in place of its number, for pictures: linear red, green and blue.
    /// Leaves that follow each other have colours far apart.
    ///
    /// # Errors
    /// Those of [`with_owners`](Self::with_owners).
    pub fn with_owner_colors(&self) -> Result<Self, Diagnostics> {
        self.with_values_of_leaves(0.0, 3, |leaf| hue(f64::from(leaf.0)).to_vec())
    }

    fn with_values_of_leaves(
        &self,
        default: f64,
        width: usize,
        value: impl Fn(NodeId) -> Vec<f64>,
    ) -> Result<Self, Diagnostics> {
        if self.has_group(OWNER) {
            let error = format!("the model has an attribute `{OWNER}` of its own");
            return Err(vec![Diagnostic::error(None, error)].into());
        }
        let (default, mixing) = (vec![default; width], Mixing::Dominant);
        let owners = AttributeGroup { default, mixing, ..AttributeGroup::mixed(OWNER) };
        self.with_group(owners, |id, _| self.node(id).children.is_empty().then(|| value(id)))
    }
}

/// A colour for a number: hues a golden ratio of the circle apart, of one lightness.
fn hue(number: f64) -> [f64; 3] {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let turn = (number * GOLDEN).fract();
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|shift| {
        let wave = ((turn + shift) * std::f64::consts::TAU).cos();
        0.08 + 0.72 * ((wave + 1.0) / 2.0).powi(2)
    })
}
