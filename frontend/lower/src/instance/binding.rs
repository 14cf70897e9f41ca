//! What leaves are bound to: names of sets of bindings, and functions of the point in coordinates.

use super::find::Finder;
use super::{BindingsId, Bound, PositionId};
use crate::computed::{Computed, ComputedKind, attribute};
use crate::names::{ComputedId, SpaceId};
use crate::position::{MapKind, Position};
use jbt_model::attribute::AttributeValue;
use jbt_model::check::NodeId;
use jbt_model::kind::NodeKind;

impl Finder<'_> {
    /// What is computed for a leaf that is so many rows, of each attribute group.
    pub(super) fn computed(
        &mut self,
        bindings: BindingsId,
        leaf: (NodeId, u32),
        position: PositionId,
    ) -> Box<[Option<ComputedId>]> {
        let scene = &self.scene;
        let is_computed = |(group, bound): (usize, &Option<Bound>)| match bound {
            Some(bound) => {
                let is_number = matches!(attribute(scene.tree, bound.node), AttributeValue::Numbers(_));
                !is_number || self.turns_inside(group, bound.at)
            }
            None => self.particles_turn_inside(group, leaf.0, position),
        };
        if !scene.bindings(bindings).iter().enumerate().any(is_computed) {
            return Box::default();
        }
        let bindings = scene.bindings(bindings).to_vec();
        let named = |(group, bound): (usize, &Option<Bound>)| match bound {
            Some(bound) => self.name_computed((group, *bound), leaf, position),
            None if self.particles_turn_inside(group, leaf.0, position) => {
                Some(self.name_numbers((leaf.0, position), Some(leaf.0), leaf.1))
            }
            None => None,
        };
        bindings.iter().enumerate().map(named).collect()
    }

    /// Whether values of a group that are given at a place turn by what warps do.
    fn turns_inside(&self, group: usize, at: Option<PositionId>) -> bool {
        let turns = self.scene.tree.attributes()[group].turns();
        turns && at.is_some_and(|at| self.scene.position(at).space != SpaceId(0))
    }

    /// Whether particles have values of their own of the group, which turn by what warps do.
    fn particles_turn_inside(&self, group: usize, leaf: NodeId, position: PositionId) -> bool {
        let name = &self.scene.tree.attributes()[group].name;
        let has_own = if let NodeKind::Particles(particles) = &self.scene.tree.node(leaf).kind {
            particles.values_of(name).is_some()
        } else {
            false
        };
        has_own && self.turns_inside(group, Some(position))
    }

    /// Numbers that turn by what warps do, of a node at a place.
    fn name_numbers(
        &mut self,
        (node, at): (NodeId, PositionId),
        leaf: Option<NodeId>,
        rows: u32,
    ) -> ComputedId {
        let Position { space, map, .. } = *self.scene.position(at);
        let next = ComputedId(self.scene.computed.len() as u32);
        let id = *self.computed_names.entry((node, at, leaf)).or_insert(next);
        if id == next {
            let (kind, map_kind) = (ComputedKind::Numbers, MapKind::Identity);
            let computed = Computed { kind, node, leaf, space, map, map_kind, uses: 0, shared: false };
            self.scene.computed.push(computed);
        }
        let computed = &mut self.scene.computed[id.0 as usize];
        computed.uses = if leaf.is_some() { 1 } else { computed.uses.saturating_add(rows) };
        id
    }

    /// The computed value that a leaf is bound to, if it is no number.
    fn name_computed(
        &mut self,
        (group, bound): (usize, Bound),
        (leaf, rows): (NodeId, u32),
        position: PositionId,
    ) -> Option<ComputedId> {
        let tree = self.scene.tree;
        let node = bound.node;
        let (key, kind, position, map, map_kind) = match attribute(self.scene.tree, node) {
            AttributeValue::Numbers(_) => {
                let at = bound.at.filter(|_| self.turns_inside(group, bound.at))?;
                return Some(self.name_numbers((node, at), None, rows));
            }
            AttributeValue::Textured(textured) => {
                let at = bound.at.expect("textures are bound with their places");
                let kind = ComputedKind::Texture(textured.texture.code(tree.dependent(node).is_some()));
                let position = self.scene.position(at);
                ((node, at, None), kind, position, position.map, position.kind())
            }
            AttributeValue::Expressed(expression) => {
                let at = bound.at.expect("formulas are bound with their places");
                let position = self.scene.position(at);
                let kind = ComputedKind::Formula(expression.shared_form());
                ((node, at, None), kind, position, position.map, position.kind())
            }
            AttributeValue::Uv(_) => {
                let skeleton = tree.node(leaf).kind.uv_skeleton();
                let kind = ComputedKind::Uv(skeleton.kind());
                let place = self.scene.position(position);
                let (map, map_kind) = place.of_uv(skeleton, tree.dependent(leaf).is_some());
                ((node, position, Some(leaf)), kind, place, map, map_kind)
            }
        };
        let space = position.space;
        let next = ComputedId(self.scene.computed.len() as u32);
        let id = *self.computed_names.entry(key).or_insert(next);
        if id == next {
            let (_, _, leaf) = key;
            let computed = Computed { kind, node, leaf, space, map, map_kind, uses: 0, shared: false };
            self.scene.computed.push(computed);
        }
        let computed = &mut self.scene.computed[id.0 as usize];
        // The uv of particles is each one's own.
        let is_each_ones = computed.leaf.is_some() && matches!(tree.node(leaf).kind, NodeKind::Particles(_));
        computed.uses = if is_each_ones { 1 } else { computed.uses.saturating_add(rows) };
        Some(id)
    }

    /// The name of the bindings of the path in progress.
    pub(super) fn name_bindings(&mut self) -> BindingsId {
        if let Some(&known) = self.bindings_names.get(&*self.bound) {
            return known;
        }
        let next = self.push_bindings();
        self.bindings_names.insert(self.bound.as_slice().into(), next);
        next
    }

    /// The same, for what is met once: nobody asks for their name again.
    pub(super) fn push_bindings(&mut self) -> BindingsId {
        self.scene.bindings.extend_from_slice(&self.bound);
        self.bindings_count += 1;
        BindingsId(self.bindings_count - 1)
    }
}
