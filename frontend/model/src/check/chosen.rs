//! A checked tree that answers for some of its attribute groups alone.

use std::borrow::Cow;
use std::collections::HashSet;
use std::sync::Arc;

use glam::DAffine3;

use super::arena::NodeId;
use super::tree::CheckedTree;
use crate::attribute::AttributeGroup;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::kind::NodeKind;
use crate::report::{clip, nearest};
use crate::word::normalized;

impl CheckedTree {
    /// The same tree, of whose attribute groups there are these alone, in the order of the model. Its
    /// programs know nothing of the others, so that these cost nothing; not even `color` is there unless it
    /// is named. Nodes keep their numbers.
    ///
    /// ```
    /// use jbt_model::walk::walk;
    /// let text = "jbt 1 attribute rough 1 attribute wet 1
    ///     rough 0.5 { wet 0.25 { color (1 0 0) { point { radius 1 } } } }";
    /// let tree = jbt_text::model(text)?.check()?.of_attributes(&["wet"])?;
    /// assert_eq!(walk(&tree, [0.0; 3]).attributes, [[0.25]]);
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    ///
    /// Cost: a copy of the nodes.
    ///
    /// # Errors
    /// A name that no group of the model has.
    pub fn of_attributes(&self, names: &[impl AsRef<str>]) -> Result<Self, Diagnostics> {
        let known = || self.attributes.iter().map(|group| &*group.name);
        let names: Vec<Cow<'_, str>> = names.iter().map(|name| normalized(name.as_ref())).collect();
        for name in names.iter().map(AsRef::as_ref) {
            if !known().any(|other| other == name) {
                let error = Diagnostic::error(None, format!("no attribute is named `{}`", clip(name)));
                let near = nearest(name, known()).map(|near| format!("perhaps `{near}`"));
                let all = || format!("there are {}", known().collect::<Vec<_>>().join(", "));
                return Err(vec![error.expected(near.unwrap_or_else(all))].into());
            }
        }
        let is_wanted = |group: &str| names.iter().any(|name| name == group);
        let attributes: Vec<AttributeGroup> =
            self.attributes.iter().filter(|group| is_wanted(&group.name)).cloned().collect();
        let mut nodes = self.nodes.to_vec();
        let mut left_out: HashSet<NodeId> = HashSet::new();
        for (index, node) in nodes.iter_mut().enumerate() {
            if let NodeKind::Attribute { name, .. } = &node.kind
                && !is_wanted(name)
            {
                // A map that changes nothing is no code.
                node.kind = NodeKind::Affine(DAffine3::IDENTITY);
                left_out.insert(NodeId(index as u32));
            }
        }
        let dependence = Arc::new(self.dependence.without(&left_out));
        Ok(Self { attributes, nodes: Arc::new(nodes), dependence, lineage: None, ..self.clone() })
    }
}
