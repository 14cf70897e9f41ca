//! Attribute values that are computed: in the row of their leaf, or hoisted to the start of their space.

use jbt_ir::{Domain as _, FunctionBuilder, Value};

use super::Emitter;
use crate::columns;
use crate::computed::{Computed, ComputedKind, kept};
use crate::mixing::GroupAnswer;
use crate::names::{ComputedId, SpaceId};
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
        let given = match kind {
            ComputedKind::Numbers => self.columns(place, columns::attribute(&self.groups[index], index)),
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
                let values = values.into_iter().map(|value| kept(&mut self.builder, value)).collect();
                self.by_map(place, index, values)
            }
        };
        if self.groups[index].turns() && *space != SpaceId(0) { self.turned(outer, &given) } else { given }
    }

    /// Values of a formula as the space has them in which it is asked: those of a direction are turned by its
    /// map.
    fn by_map(&mut self, place: RowPlace, index: usize, values: Vec<Value>) -> Vec<Value> {
        if !self.groups[index].turns() {
            return values;
        }
        let row = self.columns(place, columns::turn_of_computed(index));
        row.chunks_exact(3).map(|row| self.dot([row[0], row[1], row[2]], &values)).collect()
    }

    /// A direction at a point of the space of a warp as the world has it: `J^-1` of it, where the rows of J
    /// are the slopes of the point's coordinates. With columns of cofactors,
    ///
    /// ```text
    /// J^-1 v = (v0 (r1 x r2) + v1 (r2 x r0) + v2 (r0 x r1)) / (r0 . (r1 x r2))
    /// ```
    fn turned(&mut self, point: [Value; 3], direction: &[Value]) -> Vec<Value> {
        let d = &mut self.builder;
        let rows = point.map(|x| [d.slope_x(x), d.slope_y(x), d.slope_z(x)]);
        let cofactors = [(1, 2), (2, 0), (0, 1)].map(|(a, b)| cross(d, rows[a], rows[b]));
        let determinant = self.dot(rows[0], &cofactors[0]);
        let along = |axis: usize| {
            let sum = self.dot(cofactors.map(|column| column[axis]), direction);
            let part = self.builder.div(sum, determinant);
            kept(&mut self.builder, part)
        };
        [0, 1, 2].map(along).to_vec()
    }

    fn dot(&mut self, a: [Value; 3], b: &[Value]) -> Value {
        let first = self.builder.mul(a[0], b[0]);
        let second = self.builder.fma(a[1], b[1], first);
        self.builder.fma(a[2], b[2], second)
    }
}

fn cross(d: &mut FunctionBuilder, a: [Value; 3], b: [Value; 3]) -> [Value; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
        let right = d.mul(a[j], b[i]);
        let right = d.neg(right);
        d.fma(a[i], b[j], right)
    })
}
