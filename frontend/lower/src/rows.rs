//! The numbers of a scene: for every row, what the recipe of its table says. They are rounded once, here.

use jbt_ir::{Entity, Rows, Schema, Store, Tables};

use super::emit::Code;
use super::instance::Scene;
use super::names::FieldId;
use super::recipe::{Member, Owned, RowPlaces, RowStep};
use super::shape::Shapes;
use jbt_model::diagnostic::Diagnostic;

/// The numbers, and what they belong to.
pub(super) struct Written {
    pub(super) tables: Tables,
    /// What is behind each row of each table.
    pub(super) members: Vec<Vec<Member>>,
}

/// Writes the numbers.
pub(super) fn rows(scene: &Scene<'_>, shapes: &Shapes, code: &Code) -> Result<Written, Vec<Diagnostic>> {
    let mut writer = Writer::new(scene, shapes, code);
    for (table, code) in code.tables.iter().enumerate() {
        // Pieces have been written with their leaves.
        let rows = writer.tables[table].count..writer.members[table].len();
        let stride = writer.tables[table].stride;
        writer.tables[table].numbers.reserve(rows.len() * stride);
        for row in rows {
            writer.row(table, &code.recipe, writer.members[table][row]);
        }
    }
    if !writer.errors.is_empty() {
        return Err(writer.errors);
    }
    let mut tables = Store::new();
    for rows in writer.tables {
        tables.push(rows);
    }
    Ok(Written { tables: Tables { tables }, members: writer.members })
}

struct Writer<'a> {
    scene: &'a Scene<'a>,
    shapes: &'a Shapes,
    tables: Vec<Rows>,
    /// By table and row.
    members: Vec<Vec<Member>>,
    errors: Vec<Diagnostic>,
    /// Of the row in progress.
    places: RowPlaces,
    numbers: Vec<f64>,
}

impl<'a> Writer<'a> {
    fn new(scene: &'a Scene<'a>, shapes: &'a Shapes, code: &Code) -> Self {
        let of = |schema: &Schema| Rows { stride: schema.columns.len(), starts: vec![0], ..Rows::default() };
        let tables: Vec<Rows> = code.function.tables.values().map(of).collect();
        let root = Member::root(scene);
        let members = vec![Vec::new(); tables.len()];
        let (places, numbers) = (RowPlaces::of(root), Vec::new());
        let mut writer = Self { scene, shapes, tables, members, errors: Vec::new(), places, numbers };
        writer.own(0, [root]);
        writer
    }

    /// Writes one row, and hands the rows of the tables under it out.
    fn row(&mut self, table: usize, recipe: &[RowStep], member: Member) {
        self.places.begin(member);
        for step in recipe {
            match step {
                RowStep::Lead(way) => drop(self.places.lead(*way, self.scene, self.shapes)),
                RowStep::Columns(place, numbers) => {
                    numbers(self.scene, self.places.at(*place), &mut self.numbers);
                }
                RowStep::Slot(place) => {
                    let node = self.places.at(*place).node(self.scene);
                    self.tables[table].nodes.push(node.0);
                }
                RowStep::Rows(child, owned) => self.hand_out(child.index(), *owned),
            }
        }
        let mut numbers = std::mem::take(&mut self.numbers);
        self.append(table, member, &numbers);
        numbers.clear();
        self.numbers = numbers;
    }

    /// Makes rows of another table, which the row in progress owns.
    fn hand_out(&mut self, child: usize, owned: Owned) {
        match owned {
            Owned::Alone(place) => self.own(child, [self.places.at(place)]),
            Owned::Members(place, group) => {
                self.own(child, self.places.at(place).members(self.shapes, group));
            }
            Owned::Pieces(place) => self.pieces(child, self.places.at(place).field(self.scene)),
        }
    }

    fn own(&mut self, child: usize, owned: impl IntoIterator<Item = Member>) {
        let (rows, members) = (&mut self.tables[child], &mut self.members[child]);
        let owned = owned.into_iter();
        members.reserve(owned.size_hint().0);
        rows.active.reserve(owned.size_hint().0);
        for member in owned {
            if member.is_asked(self.scene) {
                // At most limits::MAX_INSTANCES.
                rows.active.push(members.len() as u32);
            }
            members.push(member);
        }
        rows.starts.push(rows.active.len() as u32);
    }

    /// Writes the rows of a leaf's pieces.
    fn pieces(&mut self, table: usize, field: FieldId) {
        let (primitive, scale) = (self.scene.primitive(field), self.scene.field(field).scale);
        let mut numbers = Vec::new();
        primitive.skeleton.pieces(scale, primitive.radius, &mut numbers);
        let pieces = numbers.chunks_exact(self.tables[table].stride);
        self.own(table, (0..pieces.len() as u32).map(|piece| Member::Piece(field, piece)));
        for (piece, numbers) in pieces.enumerate() {
            self.append(table, Member::Piece(field, piece as u32), numbers);
        }
    }

    /// Rounds numbers and appends them as a row.
    fn append(&mut self, table: usize, member: Member, row: &[f64]) {
        let rows = &mut self.tables[table];
        rows.count += 1;
        let mut is_finite = true;
        rows.numbers.extend(row.iter().map(|&number| {
            let number = number as f32;
            is_finite &= number.is_finite();
            number
        }));
        if !is_finite {
            self.complain(member, row);
        }
    }

    /// Some numbers of a row are none in f32.
    #[cold]
    fn complain(&mut self, member: Member, row: &[f64]) {
        let room = jbt_ir::limits::MAX_ERRORS - self.errors.len();
        for number in row.iter().filter(|number| !(**number as f32).is_finite()).take(room) {
            let node = self.scene.tree.node(member.node(self.scene));
            let message = format!("a number derived from this part leaves the range of f32: {number:e}");
            let help = "the part is too small, too large or too far away once all transforms are applied";
            self.errors.push(Diagnostic::error(node.span, message).expected(help));
        }
    }
}
