//! What leaves are bound to: names of sets of bindings, and functions of the point in coordinates.

use super::find::Finder;
use super::{BindingsId, Bound, PositionId};
use crate::computed::{Computed, ComputedKind, attribute};
use crate::names::ComputedId;
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
        let is_computed = |bound: &Option<Bound>| {
            bound
                .is_some_and(|bound| !matches!(attribute(scene.tree, bound.node), AttributeValue::Numbers(_)))
        };
        if !scene.bindings(bindings).iter().any(is_computed) {
            return Box::default();
        }
        let bindings = scene.bindings(bindings).to_vec();
        bindings
            .iter()
            .map(|bound| bound.and_then(|bound| self.name_computed(bound, leaf, position)))
            .collect()
    }

    /// The computed value that a leaf is bound to, if it is no number.
    fn name_computed(
        &mut self,
        bound: Bound,
        (leaf, rows): (NodeId, u32),
        position: PositionId,
    ) -> Option<ComputedId> {
        let tree = self.scene.tree;
        let node = bound.node;
        let (key, kind, position, map, map_kind) = match attribute(self.scene.tree, node) {
            AttributeValue::Numbers(_) => return None,
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
