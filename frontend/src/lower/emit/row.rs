//! What stands in a row: its columns, and its leaf.

use jbt_ir::{Domain, Origin, Part, Value};

use super::Emitter;
use crate::attribute::AttributeGroup;
use crate::lower::mixing::GroupAnswer;
use crate::lower::occurrence::{FieldId, LeafField};

impl Emitter<'_> {
    /// The place in the file of the operand that follows, where ties need it.
    pub(super) fn read_order(&mut self) {
        let wanted = self.reduces.last().expect("operands belong to operators").operator.wants_order();
        if wanted {
            let order = self.column("order");
            self.reduces.last_mut().expect("it was there a line ago").order = Some(order);
        }
    }

    pub(super) fn column(&mut self, name: &str) -> Value {
        let table = *self.rows.last().expect("the scene's row is open");
        let column = self.builder.add_column(table, name);
        self.builder.column(table, column)
    }

    pub(super) fn columns(&mut self, names: &[&str]) -> Vec<Value> {
        names.iter().map(|name| self.column(name)).collect()
    }

    /// The field of a leaf.
    pub(super) fn leaf(&mut self, field: FieldId) -> Value {
        let primitive = self.scene.primitive(field);
        let slot = self.slots;
        self.slots += 1;
        self.builder.add_slot(*self.rows.last().expect("the scene's row is open"), slot);
        let LeafField { kind: map, strong, falloff, .. } = *self.scene.field(field);
        let skeleton = primitive.skeleton.kind();
        let (_, outer) = *self.points.last().expect("a space is open");
        self.builder.set_origin(Origin::leaf(slot, Part::Position));
        let row = self.columns(map.columns());
        let point = map.emit(&mut self.builder, outer, &row);
        let row = self.columns(skeleton.columns());
        let square = skeleton.emit(&mut self.builder, point, &row);
        self.builder.mark(square, Origin::leaf(slot, Part::Distance));

        self.builder.set_origin(Origin::leaf(slot, Part::Falloff));
        let slope = self.column("neg_inv_r2");
        let (zero, one) = (self.builder.constant(0.0), self.builder.constant(1.0));
        let left = self.builder.fma(square, slope, one);
        let left = self.builder.max(left, zero);
        let row = self.columns(falloff.columns());
        let mut value = falloff.emit(&mut self.builder, left, &row);
        if strong {
            let strength = self.column("strength");
            let product = self.builder.mul(strength, value);
            // Where the falloff is 0, a negative strength makes -0 of it, and sums must not depend on what adds nothing.
            value = self.builder.add(product, zero);
        }
        self.builder.set_origin(Origin::SHARED);
        value
    }

    /// The attributes of a leaf: numbers of its row.
    pub(super) fn leaf_attributes(&mut self) -> Vec<GroupAnswer> {
        let groups = &self.scene.tree.attributes()[..self.mixing.len()];
        let answer = |group: &AttributeGroup| {
            let names = (0..group.width()).map(|i| group.channel(i));
            names.map(|name| self.column(&name)).collect()
        };
        let channels: Vec<Vec<Value>> = groups.iter().map(answer).collect();
        channels.into_iter().map(|channels| GroupAnswer { channels, share: None, numbers: true }).collect()
    }
}
