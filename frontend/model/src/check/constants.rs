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
        self.constants_below(&[self.root()]).remove(0)
    }

    /// The constants of each piece of a mesh of this model: of each part, or of the whole model if it has no
    /// parts.
    ///
    /// Cost: the nodes, for each name, and for each part again those at which different values meet.
    #[must_use]
    pub fn constants_of_pieces(&self) -> Vec<Vec<ConstantValues>> {
        let parts: Vec<NodeId> = self.parts().into_iter().map(|part| part.node).collect();
        if parts.is_empty() { vec![self.constants()] } else { self.constants_below(&parts) }
    }

    /// The constants of the leaves below each of these nodes.
    fn constants_below(&self, roots: &[NodeId]) -> Vec<Vec<ConstantValues>> {
        let mut all = vec![Vec::new(); roots.len()];
        let names: BTreeSet<&str> =
            self.nodes().iter().filter_map(|node| Some(node.kind.constant()?.0)).collect();
        for name in names {
            let mut search = ConstantSearch::new(self, name);
            for (root, found) in roots.iter().zip(&mut all) {
                let values = search.below(*root);
                if !values.is_empty() {
                    found.push(ConstantValues { name: name.to_owned(), values });
                }
            }
        }
        all
    }
}

/// The search for the values of one name.
struct ConstantSearch<'a> {
    tree: &'a CheckedTree,
    name: &'a str,
    /// Of each node, whether it has a leaf that has no constant of this name below the node.
    bare: Vec<bool>,
    /// Of each node, the values that count for leaves below it.
    values: Vec<ValuesBelow<'a>>,
    /// Of each node, the last round in which it was met.
    met: Vec<u32>,
    round: u32,
}

/// The values of one name that count for some leaf below a node.
#[derive(Clone, Copy, PartialEq)]
enum ValuesBelow<'a> {
    Nothing,
    One(&'a LeafConstant),
    /// Those of this node, at which different ones meet.
    Several(NodeId),
}

impl<'a> ConstantSearch<'a> {
    /// Looks at each node once, however many parts share it.
    fn new(tree: &'a CheckedTree, name: &'a str) -> Self {
        let count = tree.nodes().len();
        let (bare, values) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut search = Self { tree, name, bare, values, met: vec![0; count], round: 0 };
        for (index, CheckedNode { kind, children, .. }) in tree.nodes().iter().enumerate() {
            let id = NodeId(index as u32);
            let values = {
                let mut found = search.own_and_below(id).filter(|values| *values != ValuesBelow::Nothing);
                let first = found.next().unwrap_or(ValuesBelow::Nothing);
                if found.all(|other| other == first) { first } else { ValuesBelow::Several(id) }
            };
            let mut heard = heard(kind, children).iter();
            let below = children.is_empty() || heard.any(|child| search.bare[child.0 as usize]);
            let bare = below && kind.constant().is_none_or(|(found, _)| found != name);
            search.values.push(values);
            search.bare.push(bare);
        }
        search
    }

    /// The value of a node, if it counts for a leaf, and the values below its children.
    fn own_and_below(&self, id: NodeId) -> impl DoubleEndedIterator<Item = ValuesBelow<'a>> {
        let CheckedNode { kind, children, .. } = self.tree.node(id);
        let own = kind.constant().filter(|(found, _)| *found == self.name);
        let overrides = own.is_some() && kind.overrides();
        let own = own.filter(|_| overrides || self.bare[children[0].0 as usize]);
        let own = own.map(|(_, value)| ValuesBelow::One(value));
        let children = if overrides { &[] } else { heard(kind, children) };
        own.into_iter().chain(children.iter().map(|child| self.values[child.0 as usize]))
    }

    /// The values that count for some leaf below a node: those with a bare leaf below them.
    fn below(&mut self, root: NodeId) -> Vec<LeafConstant> {
        self.round += 1;
        let mut values = Vec::new();
        let mut known: HashSet<&LeafConstant> = HashSet::new();
        let mut stack = vec![self.values[root.0 as usize]];
        while let Some(below) = stack.pop() {
            match below {
                ValuesBelow::Nothing => {}
                ValuesBelow::One(value) => {
                    if known.insert(value) {
                        values.push(value.clone());
                    }
                }
                ValuesBelow::Several(id) => {
                    if std::mem::replace(&mut self.met[id.0 as usize], self.round) != self.round {
                        stack.extend(self.own_and_below(id).rev());
                    }
                }
            }
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
        | NodeKind::Attribute { .. }
        | NodeKind::Constant { .. } => kind.asked(children),
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
