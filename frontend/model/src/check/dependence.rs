//! Which nodes of a checked tree follow which parameters.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::arena::NodeId;
use crate::number::{Number, NumberFormula};
use crate::parameter::Parameter;
use crate::written::Written;

/// The parts of a tree that depend on its parameters, for any values of these.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Dependence {
    /// The iso-value, if it depends on a parameter.
    pub(super) iso: Option<Number>,
    /// The nodes with a number that depends on a parameter, ascending.
    pub(super) nodes: Vec<(NodeId, Arc<Written>)>,
    /// The index of each parameter in the list.
    pub(super) names: HashMap<Arc<str>, usize>,
    /// For each parameter, the nodes whose own numbers mention it, ascending.
    mentions: Vec<Vec<NodeId>>,
    /// The nodes that depend on the iso-value, ascending, if the iso-value depends on a parameter.
    surfaces: Vec<NodeId>,
}

impl Dependence {
    /// The dependence of the iso-value, without nodes.
    pub(super) fn new(parameters: &[Parameter], iso: &Number) -> Self {
        let names = parameters.iter().enumerate().map(|(index, p)| (Arc::clone(&p.name), index)).collect();
        Self {
            iso: iso.depends_on_parameters().then(|| iso.clone()),
            names,
            mentions: vec![Vec::new(); parameters.len()],
            ..Self::default()
        }
    }

    /// Adds a node, which comes after all nodes added before.
    pub(super) fn add(&mut self, id: NodeId, written: &Arc<Written>) {
        for formula in written.dependent_numbers().filter_map(Number::formula) {
            for (name, _) in formula.parameters() {
                let mentions = self.names.get(name).map(|&index| &mut self.mentions[index]);
                if let Some(mentions) = mentions
                    && mentions.last() != Some(&id)
                {
                    mentions.push(id);
                }
            }
        }
        if self.iso.is_some() && (written.asks_iso() || written.is_limited_by_iso()) {
            self.surfaces.push(id);
        }
        self.nodes.push((id, Arc::clone(written)));
    }

    #[inline]
    pub(super) fn written(&self, id: NodeId) -> Option<&Arc<Written>> {
        if self.nodes.is_empty() {
            return None;
        }
        let found = self.nodes.binary_search_by_key(&id, |&(node, _)| node).ok()?;
        Some(&self.nodes[found].1)
    }

    /// What depends on parameters among some nodes, which have these names. It tells what nodes were written
    /// as, and not which parameters change them.
    pub(super) fn of(&self, name: impl Fn(&NodeId) -> Option<NodeId>) -> Self {
        let nodes = self.nodes.iter();
        let nodes = nodes.filter_map(|(id, written)| Some((name(id)?, Arc::clone(written)))).collect();
        Self { iso: self.iso.clone(), nodes, ..Self::default() }
    }

    /// The same without some nodes, which depend on nothing any more.
    pub(super) fn without(&self, left_out: &HashSet<NodeId>) -> Self {
        let stays = |id: &NodeId| !left_out.contains(id);
        let kept = |list: &Vec<NodeId>| list.iter().copied().filter(stays).collect();
        Self {
            nodes: self.nodes.iter().filter(|(id, _)| stays(id)).cloned().collect(),
            mentions: self.mentions.iter().map(kept).collect(),
            surfaces: kept(&self.surfaces),
            ..self.clone()
        }
    }

    /// The nodes that can change with these parameters, ascending.
    pub(super) fn affected(&self, parameters: &[Parameter], moved: &mut [bool]) -> Vec<NodeId> {
        let mentions = |number: &Number, moved: &[bool]| {
            let mut names = number.formula().into_iter().flat_map(NumberFormula::parameters);
            names.any(|(name, _)| self.names.get(name).is_some_and(|&index| moved[index]))
        };
        // A default mentions earlier parameters only.
        for (index, parameter) in parameters.iter().enumerate() {
            moved[index] |= mentions(&parameter.default, moved);
        }
        let mut nodes: Vec<NodeId> = Vec::new();
        for (mentions, _) in self.mentions.iter().zip(&*moved).filter(|(_, moved)| **moved) {
            nodes.extend(mentions);
        }
        if self.iso.as_ref().is_some_and(|iso| mentions(iso, moved)) {
            nodes.extend(&self.surfaces);
        }
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
}
