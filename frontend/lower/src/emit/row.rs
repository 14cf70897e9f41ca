//! What stands in a row: its columns, and its leaf.

use jbt_ir::{Domain, FoldKind, Origin, Part, Rule, Value};

use super::Emitter;
use crate::occurrence::{FieldId, LeafCode};
use jbt_model::falloff::Nearness;
use jbt_model::skeleton::{Pieces, SkeletonKind};

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
        let slot = self.slots;
        self.slots += 1;
        self.builder.add_slot(*self.rows.last().expect("the scene's row is open"), slot);
        let LeafCode { map, skeleton, falloff, strong } = self.scene.field(field).code;
        let (_, outer) = *self.points.last().expect("a space is open");
        self.builder.set_origin(Origin::leaf(slot, Part::Position));
        let row = self.columns(map.columns());
        let point = map.emit(&mut self.builder, outer, &row);
        let mut row = self.columns(skeleton.columns());
        if let Some(pieces) = skeleton.pieces() {
            row.extend(self.fold_pieces(skeleton, pieces, point));
        }
        let square = skeleton.emit(&mut self.builder, point, &row);
        self.builder.mark(square, Origin::leaf(slot, Part::Distance));

        self.builder.set_origin(Origin::leaf(slot, Part::Falloff));
        let slope = self.column("neg_inv_r2");
        let near = Nearness::emit(&mut self.builder, square, slope);
        let row = self.columns(falloff.columns());
        let mut value = falloff.emit(&mut self.builder, near, &row);
        if strong {
            let strength = self.column("strength");
            let product = self.builder.mul(strength, value);
            // Where the falloff is 0, a negative strength makes -0 of it, and sums must not depend on what
            // adds nothing.
            let zero = self.builder.constant(0.0);
            value = self.builder.add(product, zero);
        }
        self.builder.set_origin(Origin::SHARED);
        value
    }

    /// What the accumulators of a leaf come to: a fold over the rows of its pieces, which hang under the row
    /// of the leaf.
    fn fold_pieces(&mut self, skeleton: SkeletonKind, pieces: Pieces, point: [Value; 3]) -> Vec<Value> {
        let beyond = self.column("beyond");
        let initial = skeleton.begin(&mut self.builder, beyond);
        let (space, _) = *self.points.last().expect("a space is open");
        // A piece that is out of reach is no farther than where distances begin: the field is zero either
        // way.
        let rule = if pieces.local { Rule::Neutral } else { Rule::Never };
        let so_far = self.open_fold("pieces", space, (FoldKind::Pieces, rule), &initial);
        let piece = self.columns(pieces.columns);
        let next = skeleton.step(&mut self.builder, point, &piece, &so_far);
        self.rows.pop();
        self.builder.end_fold(&next)
    }
}
