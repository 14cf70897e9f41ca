//! What stands in a row: its columns, and its leaf.

use jbt_ir::{Domain, Entity as _, FoldKind, Origin, Part, Rule, Value};

use super::{Emitter, OpenRow};
use crate::columns::{self, Columns, Names};
use crate::instance::LeafCode;
use crate::recipe::{Lead, Member, Owned, RowPlace, RowStep};
use jbt_model::falloff::Nearness;
use jbt_model::skeleton::{Pieces, SkeletonKind};

impl Emitter<'_> {
    /// The innermost open row.
    pub(super) fn row(&self) -> &OpenRow {
        self.rows.last().expect("the scene's row is open")
    }

    /// What stands at a place of the innermost open row.
    pub(super) fn at(&self, place: RowPlace) -> Member {
        self.row().places.at(place)
    }

    /// A step that all rows of the table have to take.
    pub(super) fn record(&mut self, step: RowStep) {
        let table = self.row().table;
        self.tables[table.index()].recipe.push(step);
    }

    /// More places of the row.
    pub(super) fn lead(&mut self, way: Lead) -> impl DoubleEndedIterator<Item = RowPlace> + use<> {
        self.record(RowStep::Lead(way));
        let row = self.rows.last_mut().expect("the scene's row is open");
        row.places.lead(way, self.scene, self.shapes)
    }

    /// The operands of what stands at a place.
    pub(super) fn operands(&mut self, place: RowPlace) -> impl DoubleEndedIterator<Item = RowPlace> + use<> {
        self.lead(Lead::Operands(place))
    }

    /// Declares columns for what stands at a place, and reads them.
    pub(super) fn columns(&mut self, place: RowPlace, columns: Columns<impl Names>) -> Vec<Value> {
        let values = self.declare(columns.names);
        if !values.is_empty() {
            self.record(RowStep::Columns(place, columns.numbers));
        }
        values
    }

    fn declare(&mut self, names: impl Names) -> Vec<Value> {
        let table = self.row().table;
        let mut declare = |name: &str| {
            let column = self.builder.add_column(table, name);
            self.builder.column(table, column)
        };
        names.into_iter().map(|name| declare(name.as_ref())).collect()
    }

    /// The place in the file of the operand that follows, where ties need it.
    pub(super) fn read_order(&mut self, place: RowPlace) {
        let wanted = self.reduces.last().expect("operands belong to operators").operator.wants_order();
        if wanted {
            let order = self.columns(place, columns::order())[0];
            self.reduces.last_mut().expect("it was there a line ago").order = Some(order);
        }
    }

    /// The field of a leaf.
    pub(super) fn leaf(&mut self, place: RowPlace) -> Value {
        let slot = self.slots;
        self.slots += 1;
        self.builder.add_slot(self.row().table, slot);
        self.record(RowStep::Slot(place));
        let field = self.at(place).field(self.scene);
        let LeafCode { map, skeleton, falloff, strong } = self.scene.field(field).code;
        let (_, outer) = *self.points.last().expect("a space is open");
        self.builder.set_origin(Origin::leaf(slot, Part::Position));
        let row = self.columns(place, columns::map(map));
        let point = map.emit(&mut self.builder, outer, &row);
        if skeleton.creases() {
            self.builder.set_origin(Origin::leaf(slot, Part::Crease));
        }
        let mut row = self.columns(place, columns::skeleton(skeleton));
        if let Some(pieces) = skeleton.pieces() {
            row.extend(self.fold_pieces(place, skeleton, pieces, point));
        }
        let square = skeleton.emit(&mut self.builder, point, &row);
        self.builder.mark(square, Origin::leaf(slot, Part::Distance));

        self.builder.set_origin(Origin::leaf(slot, Part::Falloff));
        let slope = self.columns(place, columns::neg_inv_r2())[0];
        let near = Nearness::emit(&mut self.builder, square, slope);
        let row = self.columns(place, columns::falloff(falloff));
        let mut value = falloff.emit(&mut self.builder, near, &row);
        if strong {
            let strength = self.columns(place, columns::strength())[0];
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
    fn fold_pieces(
        &mut self,
        place: RowPlace,
        skeleton: SkeletonKind,
        pieces: Pieces,
        point: [Value; 3],
    ) -> Vec<Value> {
        let beyond = self.columns(place, columns::beyond())[0];
        let initial = skeleton.begin(&mut self.builder, beyond);
        // A piece that is out of reach is no farther than where distances begin: the field is zero either
        // way.
        let rule = if pieces.local { Rule::Neutral } else { Rule::Never };
        let so_far = self.open_fold(Owned::Pieces(place), (FoldKind::Pieces, rule), &initial);
        // The numbers of all pieces come at once, with their leaf.
        let piece = self.declare(pieces.columns);
        let next = skeleton.step(&mut self.builder, point, &piece, &so_far);
        self.rows.pop();
        self.builder.end_fold(&next)
    }
}
