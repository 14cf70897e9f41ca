//! The check: the only door from a model to a program.
//!
//! ```text
//! Model ── the iso-value, the attribute groups ──┐
//!   └── root ── every node once, children first ─┴─► every error, or a CheckedTree
//! ```
//!
//! The facts about a [`CheckedTree`] that all later code relies on:
//!
//! * Every number is finite and at most [`limits::MAX_NUMBER`] in magnitude; radii are at least
//!   [`limits::MIN_LENGTH`], and each parameter is what its [`FieldKind`] says.
//! * Leaves have no children, maps and attributes have one, warps one or two, combinators and selectors at
//!   least one, and a selector chooses an existing child. A Ricci exponent is in [1,
//!   [`limits::MAX_RICCI_EXPONENT`]], or the negative of such a number; the files of other operators define
//!   their numbers.
//! * Every affine map is invertible, and the numbers of its inverse are finite in f32.
//! * The origin has finite coordinates.
//! * The first attribute group is `color` with three reals, unless other groups alone were
//!   [chosen](CheckedTree::of_attributes); names are unique; attribute nodes name a group and fit its width.
//! * There are at most [`limits::MAX_NODES`] nodes and [`limits::MAX_INSTANCES`] paths from the root to
//!   leaves, where a leaf counts once more for each piece of its skeleton. A point of the model is foreseen
//!   to take at most [`limits::MAX_POINT_WORK`] of them and of what formulas take.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use glam::DAffine3;
use jbt_ir::{limits, watch};

use crate::diagnostic::{Diagnostic, Diagnostics};
#[cfg(doc)]
use crate::field::FieldKind;
use crate::kind::NodeKind;
use crate::model::Model;
use crate::number::ParameterValues;
use crate::origin::ModelOrigin;
use crate::parameter::{collect, refresh};
use crate::report::Report;
use crate::tree::Node;

mod arena;
mod chosen;
mod constants;
mod coverage;
mod dependence;
mod edit;
mod fields;
mod find;
mod given;
mod groups;
mod node;
mod numbers;
mod order;
mod owners;
mod parameters;
mod particles;
mod parts;
mod place;
mod tree;
mod work;

pub use arena::{CheckedNode, Children, NodeId};
use arena::{Paths, check_instances};
use constants::check_names_of_constants;
pub use coverage::DEFINED;
use dependence::Dependence;
pub use edit::CheckedModel;
pub use find::FoundNode;
use groups::{check_groups, share_name, widths};
pub use node::MIN_RECIPROCAL_CONDITION;
use node::check_node;
use numbers::{check_numbers, check_words};
pub use owners::OWNER;
use parameters::check_iso;
pub use parts::PartRoot;
use place::{check_name, way_to};
pub use tree::CheckedTree;
use work::check_work;

/// Nodes for which there is room from the start, if the tree may have as many: nodes are large, and are moved
/// where a list grows. A larger list is moved by the system, without a copy.
const ROOM: usize = 1 << 14;
/// What a node keeps besides its place in the list: names, numbers, the places of its children. An estimate.
const NODE_BYTES: usize = 256;

impl Model {
    /// The model as a valid tree, or all its errors.
    ///
    /// Cost: linear in the number of nodes, shared ones counted once.
    ///
    /// # Errors
    ///
    /// All errors, in the order of their places in the text; after [`limits::MAX_ERRORS`] errors, one more
    /// with the number of the remaining errors. Or that there is no memory for the checked tree.
    pub fn check(&self) -> Result<CheckedTree, Diagnostics> {
        let check = || self.check_within(limits::MAX_NODES, limits::MAX_INSTANCES);
        watch::guarded(check)?.map_err(|list| Diagnostics::new(list, self.source.clone()))
    }

    fn check_within(&self, max_nodes: usize, max_instances: usize) -> Result<CheckedTree, Vec<Diagnostic>> {
        let mut report = Report::default();
        let (mut parameters, errors) = collect(&self.parameters, &self.iso, &self.root);
        report.extend(errors);
        let values = refresh(&mut parameters).unwrap_or_else(|errors| {
            report.extend(errors);
            ParameterValues::new()
        });
        parameters::check_names(&mut report, &parameters);
        if !report.is_empty() {
            return Err(report.finish());
        }
        let iso = check_iso(&mut report, &self.iso, &values);
        check_groups(&mut report, &self.attributes);
        parts::check_parts(&mut report, &self.root);
        if let Some(point) = self.origin {
            check_numbers(&mut report, None, "the origin", &point, f64::NEG_INFINITY);
        }
        let mut dependence = Dependence::new(&parameters, &self.iso);
        let nodes = self.arena(max_nodes, &mut report, (iso, &values), &mut dependence);
        if report.is_empty() {
            check_instances(&mut report, &nodes, max_instances);
        }
        check_names_of_constants(&mut report, &nodes);
        if report.is_empty() {
            check_work(&mut report, &nodes, iso);
        }
        if !report.is_empty() {
            report.sort();
            return Err(report.finish());
        }
        let (attributes, dependence) = (self.attributes.clone(), Arc::new(dependence));
        let (paths, nodes, source) = (Paths::new(&nodes), Arc::new(nodes), self.source.clone());
        let origin = self.origin.map_or(ModelOrigin::WORLD, ModelOrigin::new);
        let tree = CheckedTree {
            iso,
            attributes,
            nodes,
            paths,
            parameters,
            dependence,
            origin,
            orientation: self.orientation,
            source,
            lineage: None,
        };
        let found = || ModelOrigin::of(tree.support());
        Ok(if self.origin.is_some() { tree } else { CheckedTree { origin: found(), ..tree } })
    }

    /// All nodes, children before parents, each checked by itself.
    fn arena(
        &self,
        max_nodes: usize,
        report: &mut Report,
        (iso, values): (f64, &ParameterValues),
        dependence: &mut Dependence,
    ) -> Vec<CheckedNode> {
        let groups = widths(&self.attributes);
        let room = self.root.node().unfolded().min(ROOM);
        watch::take(room * size_of::<CheckedNode>());
        let mut nodes: Vec<CheckedNode> = Vec::with_capacity(room);
        // Of nodes that several parents may have.
        let mut ids: HashMap<usize, NodeId> = HashMap::new();
        // Each entry is a node, and whether its children have been visited.
        let mut stack = vec![(&self.root, false)];
        // Nodes that are done and wait for their parents.
        let mut waiting: Vec<NodeId> = Vec::new();
        while let Some((tree, done)) = stack.pop() {
            if !done
                && tree.is_shared()
                && let Some(&id) = ids.get(&tree.identity())
            {
                waiting.push(id);
                continue;
            }
            let node = tree.node();
            if !done {
                stack.push((tree, true));
                stack.extend(node.children().iter().rev().map(|child| (child, false)));
                continue;
            }
            if nodes.len() == max_nodes {
                let message = format!("the tree has more than {max_nodes} nodes");
                report.add_last(Diagnostic::limit(node.span(), message));
                break;
            }
            let id = NodeId(nodes.len() as u32);
            watch::take(NODE_BYTES);
            watch::take_for(&nodes, 1);
            let written = node.written();
            if written.depends_on_parameters(&self.iso)
                || (self.iso.depends_on_parameters() && written.is_limited_by_iso())
            {
                // An operator's limit depends on the iso-value, so it is checked again when that changes.
                dependence.add(id, &Arc::new(written.clone()));
            }
            let errors = report.count();
            if let Some(formula) = written.formula() {
                check_words(report, formula, node.span());
            }
            let mut kind = evaluated(report, node, (iso, values), &groups);
            check_name(report, node);
            report.expanded_in(errors, node.label());
            if node.span().is_none() {
                report.stands_at(errors, || way_to(&self.root, tree));
            }
            share_name(&mut kind, &self.attributes);
            let first = waiting.len() - node.children().len();
            let children = Children::from_slice(&waiting[first..]);
            waiting.truncate(first);
            waiting.push(id);
            if tree.is_shared() {
                ids.insert(tree.identity(), id);
            }
            nodes.push(CheckedNode { kind, children, span: node.span(), label: node.label().cloned() });
        }
        nodes
    }
}

/// What a node means, checked by itself; a placeholder after an error.
fn evaluated(
    report: &mut Report,
    node: &Node,
    (iso, values): (f64, &ParameterValues),
    groups: &BTreeMap<&str, usize>,
) -> NodeKind {
    match parameters::evaluate(node.written(), values, iso, node.span()) {
        Ok(kind) => {
            check_node(report, &kind, node.children().len(), node.span(), groups, iso);
            kind
        }
        Err(error) => {
            report.add(|| error);
            NodeKind::Affine(DAffine3::IDENTITY)
        }
    }
}

#[cfg(test)]
mod tests;
