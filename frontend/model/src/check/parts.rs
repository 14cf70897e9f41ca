//! Parts of a checked tree: solids with names, each of which can be asked by itself.

use std::collections::HashSet;

use super::arena::{CheckedNode, Children, NodeId};
use super::tree::CheckedTree;
use crate::combine::{Combinator, Union};
use crate::diagnostic::Diagnostic;
use crate::kind::NodeKind;
use crate::report::{Report, clip};
use crate::tree::Tree;

/// A part of a model.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PartRoot<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its root.
    pub node: NodeId,
}

impl CheckedTree {
    /// The parts of the model, in the order of its text; none if it is one solid.
    #[must_use]
    pub fn parts(&self) -> Vec<PartRoot<'_>> {
        let root = self.node(self.root());
        let is_union = root.kind == NodeKind::Combine(Combinator::from(Union {}));
        let part = |&node: &NodeId| {
            // A group that nobody declared does not hide the part below it.
            let mut written = node;
            while self.is_given(written) {
                written = self.node(written).children[0];
            }
            let label = self.node(written).label.as_ref().filter(|label| label.part)?;
            Some(PartRoot { name: label.name.as_deref()?, node })
        };
        let parts: Option<Vec<PartRoot<'_>>> = root.children.iter().map(part).collect();
        parts.filter(|_| is_union).unwrap_or_default()
    }

    /// Some subtrees under an operator as a tree of its own, with the attributes and the origin of this tree
    /// and no parameters. It counts from the same origin, so that boxes and lattices are the same.
    #[must_use]
    pub fn joined(&self, roots: &[NodeId], operator: impl Into<Combinator>) -> Self {
        let mut nodes = Vec::new();
        let children: Children = roots.iter().map(|&root| self.copy_below(root, &mut nodes)).collect();
        let kind = NodeKind::Combine(operator.into());
        nodes.push(CheckedNode { kind, children, span: None, label: None });
        Self { origin: self.origin, ..self.of_nodes(nodes) }
    }

    /// A part as a tree of its own, in the coordinates of this one: see [`joined`](Self::joined). Panics if
    /// there is no such part.
    #[must_use]
    pub fn part(&self, index: usize) -> Self {
        self.joined(&[self.parts()[index].node], Union {})
    }
}

/// Parts have names of their own.
pub(super) fn check_parts(report: &mut Report, root: &Tree) {
    let mut seen = HashSet::new();
    for part in root.parts() {
        let name = part.node().name().unwrap_or_default();
        if !seen.insert(name) {
            report.add(|| {
                Diagnostic::error(part.node().span(), format!("a second part `{}`", clip(name)))
                    .expected("expected another name")
            });
        }
    }
}
