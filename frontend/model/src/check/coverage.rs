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

use jbt_ir::limits;

use super::arena::{CheckedNode, Children, NodeId};
use super::tree::CheckedTree;
use crate::attribute::{AttributeGroup, AttributeValue, Mixing, Precedence};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::kind::NodeKind;
use crate::particles::{NumberArray, ParticleValues};
use crate::report::clip;

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
        let name: Arc<str> = format!("{group}{DEFINED}").into();
        let has = |name: &str| self.attributes.iter().any(|other| &*other.name == name);
        let refused = |message: String| Err(vec![Diagnostic::error(None, message)].into());
        if !has(group) {
            return refused(format!("no attribute is named `{}`", clip(group)));
        }
        if has(&name) {
            return refused(format!("`{}` is an answer already", clip(&name)));
        }
        if self.attributes.len() == limits::MAX_ATTRIBUTES {
            let error = Diagnostic::limit(None, "the model has as many attributes as it may have");
            return Err(vec![error].into());
        }
        let mut nodes: Vec<CheckedNode> = Vec::with_capacity(self.nodes.len());
        // Of each node its copy, and what stands for it above.
        let mut copies: Vec<[NodeId; 2]> = Vec::with_capacity(self.nodes.len());
        for node in self.nodes.iter() {
            let children: Children = node.children.iter().map(|child| copies[child.0 as usize][1]).collect();
            let kind = marked(&node.kind, group, &name);
            let copy = NodeId(nodes.len() as u32);
            nodes.push(CheckedNode { kind, children, ..node.clone() });
            let mut above = copy;
            if gives(&node.kind, group) {
                let value = AttributeValue::Numbers(vec![1.0]);
                let kind =
                    NodeKind::Attribute { name: Arc::clone(&name), value, precedence: Precedence::Nearest };
                above = NodeId(nodes.len() as u32);
                nodes.push(CheckedNode {
                    kind,
                    children: Children::from_slice(&[copy]),
                    span: node.span,
                    label: None,
                });
            }
            copies.push([copy, above]);
        }
        let dependence = Arc::new(self.dependence.of(|id| Some(copies[id.0 as usize][0])));
        let mut tree = Self { dependence, origin: self.origin, ..self.of_nodes(nodes) };
        tree.attributes.push(AttributeGroup {
            name,
            default: vec![0.0],
            mixing: Mixing::Blend,
            ..AttributeGroup::color()
        });
        Ok(tree)
    }
}

/// Whether it is an attribute node of the group.
fn gives(kind: &NodeKind, group: &str) -> bool {
    matches!(kind, NodeKind::Attribute { name, .. } if &**name == group)
}

/// The same kind; particles with values of the group have values of its coverage as well.
fn marked(kind: &NodeKind, group: &str, name: &Arc<str>) -> NodeKind {
    match kind {
        NodeKind::Particles(particles) if particles.values_of(group).is_some() => {
            let numbers = NumberArray::from([1.0]);
            NodeKind::Particles(particles.with_values(ParticleValues {
                name: Arc::clone(name),
                width: 1,
                numbers,
            }))
        }
        kind => kind.clone(),
    }
}
