//! Constants of a checked tree: their check, and which values the leaves below a node have.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use jbt_ir::limits;

use super::arena::{CheckedNode, NodeId};
use super::tree::CheckedTree;
use crate::constant::{ConstantValues, LeafConstant};
use crate::diagnostic::{Diagnostic, Span};
use crate::kind::NodeKind;
use crate::report::{Report, clip};
use crate::word::{CONSTANT, is_identifier};

impl CheckedTree {
    /// The constants of the leaves below the root, by name. Of several of one name above a leaf the nearest
    /// one counts.
    ///
    /// ```
    /// let text = r#"jbt 1 constant material "steel" { union {
    ///     point { radius 1 }
    ///     constant material "oak" { constant part 17 { point { at (3 0 0) radius 1 } } }
    /// } }"#;
    /// let tree = jbt_text::model(text)?.check()?;
    /// let told: Vec<String> =
    ///     tree.constants().iter().map(|one| format!("{}: {:?}", one.name, one.values)).collect();
    /// assert_eq!(told, [r#"material: [Text("steel"), Text("oak")]"#, "part: [Whole(17)]"]);
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    ///
    /// Cost: the nodes, for each name.
    #[must_use]
    pub fn constants(&self) -> Vec<ConstantValues> {
        self.constants_below(self.root())
    }

    /// The constants of each piece of a mesh of this model: of each part, or of the whole model if it has no
    /// parts.
    #[must_use]
    pub fn constants_of_pieces(&self) -> Vec<Vec<ConstantValues>> {
        let parts = self.parts();
        if parts.is_empty() {
            return vec![self.constants()];
        }
        parts.into_iter().map(|part| self.constants_below(part.node)).collect()
    }

    fn constants_below(&self, root: NodeId) -> Vec<ConstantValues> {
        let names: BTreeSet<&str> =
            self.nodes().iter().filter_map(|node| Some(node.kind.constant()?.0)).collect();
        let values =
            |name: &str| ConstantValues { name: name.to_owned(), values: self.values_below(root, name) };
        names.into_iter().map(values).filter(|found| !found.values.is_empty()).collect()
    }

    /// The values of a name that some leaf has none of below, so that they count for it.
    fn values_below(&self, root: NodeId, name: &str) -> Vec<LeafConstant> {
        let of_name = |kind| NodeKind::constant(kind).filter(|(found, _)| *found == name);
        // Whether a node has a leaf that has no constant of this name below the node.
        let mut bare: Vec<bool> = Vec::with_capacity(self.nodes().len());
        for CheckedNode { kind, children, .. } in self.nodes() {
            let below =
                children.is_empty() || heard(kind, children).iter().any(|child| bare[child.0 as usize]);
            bare.push(below && of_name(kind).is_none());
        }
        let mut values = Vec::new();
        let mut known: HashSet<&LeafConstant> = HashSet::new();
        let mut seen = vec![false; self.nodes().len()];
        let mut stack = vec![root];
        while let Some(id) = stack.pop() {
            if std::mem::replace(&mut seen[id.0 as usize], true) {
                continue;
            }
            let CheckedNode { kind, children, .. } = self.node(id);
            if let Some((_, value)) = of_name(kind)
                && bare[children[0].0 as usize]
                && known.insert(value)
            {
                values.push(value.clone());
            }
            stack.extend(heard(kind, children).iter().rev());
        }
        values
    }
}

/// The children of a node whose leaves may own a point: what weighs a warp owns none, and of a selector the
/// chosen child answers.
fn heard<'a>(kind: &NodeKind, children: &'a [NodeId]) -> &'a [NodeId] {
    match kind {
        NodeKind::Warp(_) => &children[..1],
        NodeKind::Primitive(_)
        | NodeKind::Particles(_)
        | NodeKind::Combine(_)
        | NodeKind::Expression(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Attribute { .. } => kind.asked(children),
    }
}

/// A node with a constant: its name is an identifier, and its value one that files can hold.
pub(super) fn check_constant(
    report: &mut Report,
    span: Option<Span>,
    (name, value): (&str, &LeafConstant),
    groups: &BTreeMap<&str, usize>,
) {
    if !is_identifier(name) {
        report.add(|| {
            Diagnostic::error(span, format!("a constant is called `{}`", clip(name)))
                .expected("expected letters, digits and underscores, beginning with a letter")
        });
    }
    if groups.contains_key(CONSTANT) {
        report.add(|| {
            Diagnostic::error(span, format!("a constant beside an attribute that is called `{CONSTANT}`"))
                .expected("expected another name of the attribute")
        });
    }
    if let Some((fault, expected)) = value.fault() {
        report.add(|| {
            Diagnostic::error(span, format!("the constant `{}` {fault}", clip(name))).expected(expected)
        });
    }
}

/// There are at most [`limits::MAX_CONSTANTS`] names.
pub(super) fn check_names_of_constants(report: &mut Report, nodes: &[CheckedNode]) {
    let mut names: HashSet<&str> = HashSet::new();
    for node in nodes {
        let Some((name, _)) = node.kind.constant() else { continue };
        if names.insert(name) && names.len() > limits::MAX_CONSTANTS {
            let message = format!("more than {} names of constants", limits::MAX_CONSTANTS);
            report.add(|| Diagnostic::limit(node.span, message));
            return;
        }
    }
}
