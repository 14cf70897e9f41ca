//! Attribute values that are computed: in the row of their leaf, or hoisted to the start of their space.

use glam::DVec3;
use jbt_ir::{Domain as _, Value};

use super::Emitter;
use crate::columns;
use crate::computed::{ComputedValue, kept};
use crate::instance::{InstanceId, InstanceKind};
use crate::mixing::GroupAnswer;
use crate::names::ComputedId;
use jbt_model::attribute::Textured;
use jbt_model::expression::Operand;

impl Emitter<'_> {
    /// The attributes of a leaf: numbers of its row, and what is computed.
    pub(super) fn leaf_attributes(&mut self, id: InstanceId) -> Vec<GroupAnswer> {
        let (InstanceKind::Leaf { computed, .. } | InstanceKind::Expression { computed, .. }) =
            &self.scene.instance(id).kind
        else {
            unreachable!("only leaves have attributes of their own")
        };
        let groups = &self.scene.tree.attributes()[..self.mixing.len()];
        let mut answers = Vec::with_capacity(groups.len());
        for (index, group) in groups.iter().enumerate() {
            let (channels, numbers) = match computed.get(index).copied().flatten() {
                Some(id) => (self.computed_of_leaf(id, index), self.scene.computed(id).kind.is_finite()),
                // Which numbers they are is the business of rows.
                None => (columns::channels(self, group, &group.default), true),
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
        let open = self.points.iter().rfind(|(open, _)| *open == computed.space);
        let &(_, outer) = open.expect("a leaf stands inside of the spaces of its attributes");
        let row = columns::map(self, computed.map_kind, &computed.map);
        let point = computed.map_kind.emit(&mut self.builder, outer, &row);
        let group = &self.scene.tree.attributes()[group];
        match computed.value(self.scene.tree) {
            ComputedValue::Texture(kind, Textured { texture, a, b }) => {
                let row = columns::texture(self, kind, texture);
                let t = kind.emit(&mut self.builder, point, &row);
                let one = self.builder.constant(1.0);
                let rest = self.builder.sub(one, t);
                let (a, b) = (columns::channels(self, group, a), columns::channels(self, group, b));
                // Exact where t is 0 or 1.
                let mix = |(&a, &b): (&Value, &Value)| {
                    let part = self.builder.mul(rest, a);
                    self.builder.fma(t, b, part)
                };
                a.iter().zip(&b).map(mix).collect()
            }
            ComputedValue::Uv(skeleton, map) => {
                let row = columns::uv(self, skeleton);
                let [u, v] = skeleton.kind().emit_uv(&mut self.builder, point, &row);
                let row = columns::uv_map(self, map);
                let part = |row: &[Value]| {
                    let by_u = self.builder.fma(u, row[0], row[2]);
                    self.builder.fma(v, row[1], by_u)
                };
                row.chunks_exact(3).map(part).collect()
            }
            ComputedValue::Formula(expression) => {
                let row = columns::formula(self, expression, DVec3::ZERO);
                let values = expression.form().emit(&mut self.builder, |operand| match operand {
                    Operand::Coordinate(axis) => point[axis as usize],
                    Operand::Number(number) => row[number as usize],
                    Operand::Child(_) | Operand::Step(_) => unreachable!("an attribute asks for no fields"),
                });
                values.into_iter().map(|value| kept(&mut self.builder, value)).collect()
            }
        }
    }

    /// Computes what several leaves share, if anybody asks for attributes.
    pub(super) fn hoist_computed(&mut self, id: ComputedId) {
        if self.mixing.is_empty() {
            return;
        }
        let channels = self.computed(id, self.scene.group_of(id));
        self.kept_computed.insert(id, channels);
    }
}
