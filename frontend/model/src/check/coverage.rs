//! Coverage: whether a point has a value of an attribute, or its default because nobody gave one.
//!
//! ```text
//! union { color (1 0 0) { rod }  ball }   ►   union { color.defined 1 { color (1 0 0) { rod } }  ball }
//! ```
//!
//! The answer is one more group, which is 1 where a leaf has the attribute and 0 elsewhere, mixed as values
//! are. So programs compute it beside the field, by the rules of every operator and with the same bits on all
//! engines, and it costs nothing where nobody asks.

use std::sync::Arc;

use super::tree::CheckedTree;
use crate::attribute::AttributeGroup;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::kind::NodeKind;
use crate::particles::{NumberArray, ParticleValues};
use crate::report::clip;
use crate::word::normalized;

/// What stands behind the name of a group, in the name of the group of its coverage: `color.defined`.
pub const DEFINED: &str = ".defined";

impl CheckedTree {
    /// The same tree with one more attribute group of one real, `NAME.defined`: the part of the weight at a
    /// point that comes from leaves which have the attribute `NAME`, from 0 to 1. Where it is 0, the
    /// attribute is its default because nobody who has a value is heard there: outside of all supports, for
    /// one.
    ///
    /// Parameters of the tree that is returned cannot be set: set those of this one.
    ///
    /// ```
    /// use jbt_model::walk::walk;
    /// let text = "jbt 1 union { color (1 1 1) { point { radius 1 } } point { at (3 0 0) radius 1 } }";
    /// let tree = jbt_text::model(text)?.check()?.with_coverage("color")?;
    /// let of = |x: f64| walk(&tree, [x, 0.0, 0.0]).attributes.concat();
    /// assert_eq!(of(0.1), [1.0, 1.0, 1.0, 1.0]);
    /// assert_eq!(of(3.1), [1.0, 1.0, 1.0, 0.0], "white as well, but nobody said so");
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    ///
    /// # Errors
    /// A name that no group of the model has, a coverage that is there already, and a model that has as many
    /// groups as there may be.
    pub fn with_coverage(&self, group: &str) -> Result<Self, Diagnostics> {
        let group = &*normalized(group);
        let name: Arc<str> = format!("{group}{DEFINED}").into();
        let refused = |message: String| Err(vec![Diagnostic::error(None, message)].into());
        if !self.has_group(group) {
            return refused(format!("no attribute is named `{}`", clip(group)));
        }
        if self.has_group(&name) {
            return refused(format!("`{}` is an answer already", clip(&name)));
        }
        let coverage = AttributeGroup { default: vec![0.0], ..AttributeGroup::mixed(&name) };
        let mut tree = self.with_group(coverage, |_, kind| gives(kind, group).then(|| vec![1.0]))?;
        for node in Arc::make_mut(&mut tree.nodes) {
            mark(&mut node.kind, group, &name);
        }
        Ok(tree)
    }
}

/// Whether it is an attribute node of the group.
fn gives(kind: &NodeKind, group: &str) -> bool {
    matches!(kind, NodeKind::Attribute { name, .. } if &**name == group)
}

/// Gives particles with values of the group values of its coverage as well.
fn mark(kind: &mut NodeKind, group: &str, name: &Arc<str>) {
    if let NodeKind::Particles(particles) = kind
        && particles.values_of(group).is_some()
    {
        let numbers = NumberArray::from([1.0]);
        *particles = particles.with_values(ParticleValues { name: Arc::clone(name), width: 1, numbers });
    }
}
