//! Attribute values that are computed: in the row of their leaf, or hoisted to the start of their space.

use jbt_ir::Value;

use super::Emitter;
use crate::computed;
use crate::mixing::GroupAnswer;
use crate::names::ComputedId;
use crate::occurrence::{OccurrenceId, OccurrenceKind};

impl Emitter<'_> {
    /// The attributes of a leaf: numbers of its row, and what is computed.
    pub(super) fn leaf_attributes(&mut self, id: OccurrenceId) -> Vec<GroupAnswer> {
        let (OccurrenceKind::Leaf { computed, .. } | OccurrenceKind::Expression { computed, .. }) =
            &self.scene.occurrence(id).kind
        else {
            unreachable!("only leaves have attributes of their own")
        };
        let groups = &self.scene.tree.attributes()[..self.mixing.len()];
        let mut answers = Vec::with_capacity(groups.len());
        for (index, group) in groups.iter().enumerate() {
            let (channels, numbers) = match computed.get(index).copied().flatten() {
                Some(id) => (self.computed_of_leaf(id, index), self.scene.computed(id).kind.is_finite()),
                None => ((0..group.width()).map(|i| self.column(&group.channel(i))).collect(), true),
            };
            answers.push(GroupAnswer { channels, share: None, numbers });
        }
        answers
    }

    fn computed_of_leaf(&mut self, id: ComputedId, group: usize) -> Vec<Value> {
        match self.kept_computed.get(&id) {
            Some(channels) => channels.clone(),
            None => self.computed(id, group),
        }
    }

    /// The value of a group, computed here from the point in its space, which is open.
    fn computed(&mut self, id: ComputedId, group: usize) -> Vec<Value> {
        let computed = self.scene.computed(id);
        let (kind, map, space) = (&computed.kind, computed.map_kind, computed.space);
        let open = self.points.iter().rfind(|(open, _)| *open == space);
        let &(_, outer) = open.expect("a leaf stands inside of the spaces of its attributes");
        let row = self.columns(map.columns());
        let point = map.emit(&mut self.builder, outer, &row);
        let group = &self.scene.tree.attributes()[group];
        let channels: Vec<String> = (0..group.width()).map(|i| group.channel(i)).collect();
        let table = *self.rows.last().expect("the scene's row is open");
        computed::emit(&mut self.builder, kind, point, &channels, |builder, names| {
            let column = |name: &&str| {
                let column = builder.add_column(table, name);
                builder.column(table, column)
            };
            names.iter().map(column).collect()
        })
    }

    /// Computes what several leaves share, if anybody asks for attributes.
    pub(super) fn hoist_computed(&mut self, id: ComputedId) {
        if self.mixing.is_empty() {
            return;
        }
        let name = self.scene.attribute_name(self.scene.computed(id).node);
        let group = self.scene.tree.attributes().iter().position(|group| &*group.name == name);
        let channels = self.computed(id, group.expect("the check knows all groups"));
        self.kept_computed.insert(id, channels);
    }
}
