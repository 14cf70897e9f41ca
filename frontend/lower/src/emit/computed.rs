//! Attribute values that are computed: in the row of their leaf, or hoisted to the start of their space.

use jbt_ir::{Domain as _, Value};

use super::Emitter;
use crate::columns;
use crate::computed::{Computed, ComputedKind, kept};
use crate::mixing::GroupAnswer;
use crate::names::ComputedId;
use crate::recipe::RowPlace;
use jbt_model::expression::Operand;

impl Emitter<'_> {
    /// The attributes of a leaf: numbers of its row, and what is computed.
    pub(super) fn leaf_attributes(&mut self, place: RowPlace) -> Vec<GroupAnswer> {
        let leaf = self.at(place);
        let mut answers = Vec::with_capacity(self.groups.len());
        for (index, group) in self.groups.iter().enumerate() {
            let (channels, numbers) = match leaf.computed(self.scene, index) {
                Some(id) => {
                    let kept = self.kept_computed.get(&id).cloned();
                    let channels = kept.unwrap_or_else(|| self.computed(place, id, index));
                    (channels, self.scene.computed(id).kind.is_finite())
                }
                None => (self.columns(place, columns::attribute(group, index)), true),
            };
            answers.push(GroupAnswer { channels, share: None, numbers });
        }
        answers
    }

    /// The value of a group, computed here from the point in its space, which is open.
    pub(super) fn computed(&mut self, place: RowPlace, id: ComputedId, index: usize) -> Vec<Value> {
        let Computed { kind, space, map_kind, .. } = self.scene.computed(id);
        let open = self.points.iter().rfind(|(open, _)| open == space);
        let &(_, outer) = open.expect("a leaf stands inside of the spaces of its attributes");
        let row = self.columns(place, columns::map_of_computed(*map_kind, index));
        let point = map_kind.emit(&mut self.builder, outer, &row);
        match kind {
            ComputedKind::Texture(kind) => {
                let row = self.columns(place, columns::texture(*kind, index));
                let t = kind.emit(&mut self.builder, point, &row);
                let one = self.builder.constant(1.0);
                let rest = self.builder.sub(one, t);
                let group = &self.groups[index];
                let a = self.columns(place, columns::side(group, index, |textured| &textured.a));
                let b = self.columns(place, columns::side(group, index, |textured| &textured.b));
                // Exact where t is 0 or 1.
                let mix = |(&a, &b): (&Value, &Value)| {
                    let part = self.builder.mul(rest, a);
                    self.builder.fma(t, b, part)
                };
                a.iter().zip(&b).map(mix).collect()
            }
            ComputedKind::Uv(skeleton) => {
                let row = self.columns(place, columns::uv(*skeleton, index));
                let [u, v] = skeleton.emit_uv(&mut self.builder, point, &row);
                let row = self.columns(place, columns::uv_map(index));
                let part = |row: &[Value]| {
                    let by_u = self.builder.fma(u, row[0], row[2]);
                    self.builder.fma(v, row[1], by_u)
                };
                row.chunks_exact(3).map(part).collect()
            }
            ComputedKind::Formula(form) => {
                let row = self.columns(place, columns::formula_of_attribute(form, index));
                let values = form.emit(&mut self.builder, |operand| match operand {
                    Operand::Coordinate(axis) => point[axis as usize],
                    Operand::Number(number) => row[number as usize],
                    Operand::Child(_) | Operand::Step(_) => unreachable!("an attribute asks for no fields"),
                });
                values.into_iter().map(|value| kept(&mut self.builder, value)).collect()
            }
        }
    }
}
