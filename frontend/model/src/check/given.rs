//! Groups that nobody declares: a tree with one more group of attributes, whose values some nodes give.

use std::sync::Arc;

use jbt_ir::limits;

use super::arena::{CheckedNode, Children, NodeId};
use super::tree::CheckedTree;
use crate::attribute::{AttributeGroup, AttributeValue, Precedence};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::kind::NodeKind;

impl CheckedTree {
    /// Whether the model has a group of this name.
    pub(crate) fn has_group(&self, name: &str) -> bool {
        self.attributes.iter().any(|group| &*group.name == name)
    }

    /// The same tree with one more group. `given` says what a node gives to the leaves below it, or to
    /// itself, if it gives something. Of several above a leaf the nearest one counts.
    ///
    /// Parameters of the tree that is returned cannot be set. Its nodes have other numbers.
    ///
    /// # Errors
    /// A model that has as many groups as there may be. That the name is new is the caller's matter.
    pub(crate) fn with_group(
        &self,
        mut group: AttributeGroup,
        given: impl Fn(NodeId, &NodeKind) -> Option<Vec<f64>>,
    ) -> Result<Self, Diagnostics> {
        if self.attributes.len() >= limits::MAX_ATTRIBUTES {
            let error = Diagnostic::limit(None, "the model has as many attributes as it may have");
            return Err(vec![error].into());
        }
        if group.titles.is_empty() {
            group.titles = (0..group.width()).map(|index| group.channel(index)).collect();
        }
        let mut nodes: Vec<CheckedNode> = Vec::with_capacity(self.nodes.len());
        // Of each node its copy, and what stands for it above.
        let mut copies: Vec<[NodeId; 2]> = Vec::with_capacity(self.nodes.len());
        for (index, node) in self.nodes.iter().enumerate() {
            let children: Children = node.children.iter().map(|child| copies[child.0 as usize][1]).collect();
            let copy = NodeId(nodes.len() as u32);
            nodes.push(CheckedNode { children, ..node.clone() });
            if let Some(numbers) = given(NodeId(index as u32), &node.kind) {
                let (name, value) = (Arc::clone(&group.name), AttributeValue::Numbers(numbers));
                let kind = NodeKind::Attribute { name, value, precedence: Precedence::Nearest };
                let children = Children::from_slice(&[copy]);
                nodes.push(CheckedNode { kind, children, span: node.span, label: None });
            }
            copies.push([copy, NodeId(nodes.len() as u32 - 1)]);
        }
        // What depends on parameters is the node, and not what it gives.
        let dependence = Arc::new(self.dependence.of(|id| Some(copies[id.0 as usize][0])));
        let mut tree = Self { dependence, origin: self.origin, ..self.of_nodes(nodes) };
        tree.attributes.push(group);
        Ok(tree)
    }

    /// Whether a node is there for a group that nobody declared: ways to leaves do not tell of it.
    pub(crate) fn is_given(&self, id: NodeId) -> bool {
        let NodeKind::Attribute { name, .. } = &self.node(id).kind else { return false };
        self.attributes.iter().any(|group| group.name == *name && !group.titles.is_empty())
    }
}
