//! The check of an edited model: of nodes that have changed, where nothing else has.
//!
//! ```text
//!        sum                    sum'        pairs of nodes from the roots down; what both trees share is the
//!      /  |  \                /  |  \       same node, so its subtree is skipped
//!     a   b   c              a   b'  c      sum', b': other nodes with as many children: evaluated and checked
//! ```
//!
//! An edit of another kind, with nodes more or less, or nodes that several parents share, is checked as a
//! whole.

use std::sync::Arc;

use jbt_ir::watch;
use rustc_hash::{FxHashMap, FxHashSet};

use super::arena::{CheckedNode, Lineage, NodeId};
use super::groups::{share_name, widths};
use super::node::check_node;
use super::numbers::check_words;
use super::parameters::{evaluate, is_in_pieces};
use super::tree::CheckedTree;
use crate::diagnostic::Diagnostics;
use crate::kind::NodeKind;
use crate::model::Model;
use crate::number::ParameterValues;
use crate::origin::ModelOrigin;
use crate::report::Report;
use crate::tree::Tree;

/// A model and its check, for edits: the check of an edited model takes time by what has changed, besides a
/// copy of the nodes and a look at the children of changed nodes.
///
/// Trees are immutable and share what is the same, so an edit is a model whose tree has most of its nodes in
/// common with the one before. What has been rebuilt counts as changed.
///
/// ```
/// use jbt_model::builder::point;
/// use jbt_model::check::CheckedModel;
/// use jbt_model::model::Model;
/// use jbt_model::tree::Tree;
///
/// let mut leaves: Vec<Tree> = (0..1000).map(|i| point([i, 0, 0], 1)).collect();
/// let mut model = CheckedModel::new(&Model::new(Tree::sum(leaves.clone()))).unwrap();
/// leaves[500] = point([500.0, 0.2, 0.0], 1);
/// let edited = Model::new(Tree::sum(leaves));
/// let before = model.tree().clone();
/// assert_eq!(*model.edit(&edited).unwrap(), edited.check().unwrap());
/// assert_eq!(model.tree().changed_since(&before).map(<[_]>::len), Some(2), "the leaf and the sum");
/// ```
#[derive(Debug)]
pub struct CheckedModel {
    model: Model,
    tree: CheckedTree,
    /// The node of each tree by its identity. None, if a node is shared.
    names: Option<FxHashMap<usize, NodeId>>,
}

/// The part of the nodes up to which an edit is checked node by node.
const LARGEST_PART: usize = 4;

impl CheckedModel {
    /// Checks a model as a whole.
    ///
    /// # Errors
    /// Those of [`Model::check`].
    pub fn new(model: &Model) -> Result<Self, Diagnostics> {
        Ok(Self::of(model, model.check()?))
    }

    fn of(model: &Model, tree: CheckedTree) -> Self {
        let names = tree.paths.uses.iter().all(|&uses| uses == 1).then(|| names(&model.root));
        Self { model: model.clone(), tree, names }
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Its check.
    #[must_use]
    pub fn tree(&self) -> &CheckedTree {
        &self.tree
    }

    /// Takes an edited model. The tree equals that of [`Model::check`], to the bit.
    ///
    /// # Errors
    /// Those of [`Model::check`]; the model stays as it was.
    pub fn edit(&mut self, edited: &Model) -> Result<&CheckedTree, Diagnostics> {
        // A model that is half edited would be none.
        let checked = watch::guarded(|| {
            let Some(changes) = self.changes(edited) else { return Ok(None) };
            watch::take(size_of_val(self.tree.nodes()));
            Ok::<_, Diagnostics>(Some((self.checked(edited, &changes)?, changes)))
        })??;
        match checked {
            None => *self = Self::new(edited)?,
            Some((tree, changes)) => {
                if let Some(names) = &mut self.names {
                    for (id, old, new) in &changes {
                        names.remove(&old.identity());
                        names.insert(new.identity(), *id);
                    }
                }
                (self.tree, self.model) = (tree, edited.clone());
            }
        }
        Ok(&self.tree)
    }

    /// The nodes that have changed, ascending, if it is these alone and they are few.
    fn changes(&self, edited: &Model) -> Option<Vec<(NodeId, Tree, Tree)>> {
        let (names, before) = (self.names.as_ref()?, &self.model);
        let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
        let origin = |model: &Model| model.origin.map(|point| bits(&point));
        let same_groups = before.attributes == edited.attributes
            && before
                .attributes
                .iter()
                .zip(&edited.attributes)
                .all(|(a, b)| bits(&a.default) == bits(&b.default));
        let same = same_groups
            && before.iso == edited.iso
            && origin(before) == origin(edited)
            && before.orientation == edited.orientation;
        if !same || before.parameters != edited.parameters {
            return None;
        }
        let (mut changes, mut seen) = (Vec::new(), FxHashSet::default());
        let mut pairs = vec![(&before.root, &edited.root)];
        while let Some((old, new)) = pairs.pop() {
            if old.identity() == new.identity() {
                continue;
            }
            let [was, is] = [old, new].map(Tree::node);
            // A node that stands elsewhere, too, or did so before, is shared.
            let is_new = !names.contains_key(&new.identity()) && seen.insert(new.identity());
            let many = changes.len() * LARGEST_PART > self.tree.nodes().len();
            if !is_new || many || was.children().len() != is.children().len() {
                return None;
            }
            for node in [was, is] {
                let written = node.written();
                let iso = &before.iso;
                if written.depends_on_parameters(iso)
                    || iso.depends_on_parameters() && written.is_limited_by_iso()
                {
                    return None;
                }
            }
            changes.push((names[&old.identity()], old.clone(), new.clone()));
            pairs.extend(was.children().iter().zip(is.children()));
        }
        changes.sort_unstable_by_key(|&(id, ..)| id);
        Some(changes)
    }

    /// The tree with changed nodes, which are checked.
    fn checked(&self, edited: &Model, changes: &[(NodeId, Tree, Tree)]) -> Result<CheckedTree, Diagnostics> {
        let (mut report, groups) = (Report::default(), widths(&edited.attributes));
        let mut nodes = self.tree.nodes.to_vec();
        let mut is_whole = true;
        for (id, _, new) in changes {
            let (node, written) = (new.node(), new.node().written());
            if let Some(formula) = written.formula() {
                check_words(&mut report, formula, node.span());
            }
            match evaluate(written, &ParameterValues::new(), self.tree.iso, node.span()) {
                Ok(mut kind) => {
                    check_node(
                        &mut report,
                        &kind,
                        node.children().len(),
                        node.span(),
                        &groups,
                        self.tree.iso,
                    );
                    share_name(&mut kind, &edited.attributes);
                    let old = &mut nodes[id.0 as usize];
                    is_whole &= !(counts_elsewhere(&old.kind) || counts_elsewhere(&kind));
                    is_whole &= particles_in(&old.kind) == particles_in(&kind);
                    (old.kind, old.span) = (kind, node.span());
                    old.label = node.label().cloned();
                }
                Err(error) => report.add(|| error),
            }
        }
        if !report.is_empty() || !is_whole {
            // Numbers of paths may be others, or errors: everything is looked at.
            return edited.check();
        }
        let lineage = Lineage {
            from: Arc::clone(&self.tree.nodes),
            changed: changes.iter().map(|&(id, ..)| id).collect(),
        };
        let tree = CheckedTree {
            nodes: Arc::new(nodes),
            source: edited.source.clone(),
            lineage: Some(lineage),
            ..self.tree.clone()
        };
        let found = || ModelOrigin::of(tree.support());
        Ok(if edited.origin.is_some() { tree } else { CheckedTree { origin: found(), ..tree } })
    }
}

/// Whether a node decides how many paths or pieces there are.
fn counts_elsewhere(kind: &NodeKind) -> bool {
    matches!(kind, NodeKind::Select(_)) || is_in_pieces(kind)
}

/// How many particles a node has.
fn particles_in(kind: &NodeKind) -> usize {
    if let NodeKind::Particles(particles) = kind { particles.len() } else { 0 }
}

/// The nodes of a tree without sharing, in the order of the check.
fn names(root: &Tree) -> FxHashMap<usize, NodeId> {
    let trees = root.postfix(crate::traverse::Visit::Nodes);
    trees.enumerate().map(|(index, tree)| (tree.identity(), NodeId(index as u32))).collect()
}

impl CheckedTree {
    /// The nodes that differ from those of an earlier tree, ascending, if this one was made of that one by
    /// [parameters](Self::with_parameters) or an [edit](CheckedModel::edit), and nothing else differs but
    /// parameters and the origin. Nodes are the same in number, and have the same children.
    #[must_use]
    pub fn changed_since(&self, before: &Self) -> Option<&[NodeId]> {
        let alike = self.iso.to_bits() == before.iso.to_bits()
            && Arc::ptr_eq(&self.dependence, &before.dependence)
            && self.attributes == before.attributes;
        if !alike {
            return None;
        }
        if Arc::ptr_eq(&self.nodes, &before.nodes) {
            return Some(&[]);
        }
        let lineage = self.lineage.as_ref().filter(|lineage| Arc::ptr_eq(&lineage.from, &before.nodes))?;
        Some(&lineage.changed)
    }

    /// The same tree, of whose nodes one has fewer children: those with these places, ascending. Returns the
    /// nodes of this tree that are left, in the order of the new ones. No node is shared.
    #[must_use]
    pub fn with_fewer_children(&self, parent: NodeId, kept: &[usize]) -> (Self, Vec<NodeId>) {
        let children = &self.node(parent).children;
        // Without shared nodes a subtree is a run of nodes that ends at its root.
        let first_after = |child: NodeId| child.0 as usize + 1;
        let mut left: Vec<NodeId> = Vec::new();
        for &place in kept {
            let first = match place {
                0 => self.first_below(children[0]),
                _ => first_after(children[place - 1]),
            };
            left.extend((first..first_after(children[place])).map(|index| NodeId(index as u32)));
        }
        left.extend((parent.0 as usize..self.nodes.len()).map(|index| NodeId(index as u32)));
        let place = |id: &NodeId| left.binary_search(id).ok().map(|place| NodeId(place as u32));
        let node = |id: &NodeId| {
            let node = self.node(*id);
            CheckedNode {
                kind: node.kind.clone(),
                children: node.children.iter().filter_map(place).collect(),
                span: node.span,
                label: node.label.clone(),
            }
        };
        let nodes: Vec<CheckedNode> = left.iter().map(node).collect();
        let dependence = Arc::new(self.dependence.of(place));
        let tree = Self {
            parameters: self.parameters.clone(),
            dependence,
            origin: self.origin,
            ..self.of_nodes(nodes)
        };
        (tree, left)
    }

    /// The first node of a subtree without shared nodes.
    fn first_below(&self, root: NodeId) -> usize {
        let mut first = root;
        while let Some(&child) = self.node(first).children.first() {
            first = child;
        }
        first.0 as usize
    }
}
