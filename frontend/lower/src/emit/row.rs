//! What stands in a row: its columns, and its leaf.

use jbt_ir::{Domain, FoldKind, Origin, Part, Rule, Value};

use super::Emitter;
use crate::columns::{self, Scribe};
use crate::instance::{FieldId, LeafCode, LeafField};
use jbt_model::falloff::Nearness;
use jbt_model::skeleton::Pieces;

/// Columns are declared in the open row.
impl Scribe for Emitter<'_> {
    type Row = Vec<Value>;

    fn columns<N: AsRef<str>>(
        &mut self,
        names: impl IntoIterator<Item = N>,
        _: impl FnOnce(&mut Vec<f64>),
    ) -> Vec<Value> {
        let table = *self.rows.last().expect("the scene's row is open");
        let declare = |name: N| {
            let column = self.builder.add_column(table, name.as_ref());
            self.builder.column(table, column)
        };
        names.into_iter().map(declare).collect()
    }
}

impl Emitter<'_> {
    /// The place in the file of the operand that follows, where ties need it.
    pub(super) fn read_order(&mut self) {
        let wanted = self.reduces.last().expect("operands belong to operators").operator.wants_order();
        if wanted {
            // The place itself is the business of rows.
            let order = columns::order(self, 0)[0];
            self.reduces.last_mut().expect("it was there a line ago").order = Some(order);
        }
    }

    /// The field of a leaf.
    pub(super) fn leaf(&mut self, field: FieldId) -> Value {
        let slot = self.slots;
        self.slots += 1;
        self.builder.add_slot(*self.rows.last().expect("the scene's row is open"), slot);
        let LeafField { map, code, .. } = self.scene.field(field);
        let LeafCode { map: kind, skeleton, falloff, strong } = *code;
        let (_, outer) = *self.points.last().expect("a space is open");
        self.builder.set_origin(Origin::leaf(slot, Part::Position));
        let row = columns::map(self, kind, map);
        let point = kind.emit(&mut self.builder, outer, &row);
        let mut row = columns::skeleton(self, self.scene, field);
        if let Some(pieces) = skeleton.pieces() {
            row.extend(self.fold_pieces(field, pieces, point));
        }
        let square = skeleton.emit(&mut self.builder, point, &row);
        self.builder.mark(square, Origin::leaf(slot, Part::Distance));

        self.builder.set_origin(Origin::leaf(slot, Part::Falloff));
        let slope = columns::slope(self, self.scene, field)[0];
        let near = Nearness::emit(&mut self.builder, square, slope);
        let row = columns::falloff(self, self.scene, field);
        let mut value = falloff.emit(&mut self.builder, near, &row);
        if strong {
            let strength = columns::strength(self, self.scene, field)[0];
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
    fn fold_pieces(&mut self, field: FieldId, pieces: Pieces, point: [Value; 3]) -> Vec<Value> {
        let skeleton = self.scene.field(field).code.skeleton;
        let beyond = columns::beyond(self, self.scene, field)[0];
        let initial = skeleton.begin(&mut self.builder, beyond);
        let (space, _) = *self.points.last().expect("a space is open");
        // A piece that is out of reach is no farther than where distances begin: the field is zero either
        // way.
        let rule = if pieces.local { Rule::Neutral } else { Rule::Never };
        let so_far = self.open_fold("pieces", space, (FoldKind::Pieces, rule), &initial);
        // Rows of pieces are written at once, with their leaf.
        let piece = self.columns(pieces.columns, |_| {});
        let next = skeleton.step(&mut self.builder, point, &piece, &so_far);
        self.rows.pop();
        self.builder.end_fold(&next)
    }
}
