//! The numbers of a scene: for every row, what the recipe of its table says. They are rounded once, here.

use jbt_ir::{Entity, Rows, Schema, Store, Tables, watch};

use super::emit::Code;
use super::instance::Scene;
use super::names::{FieldId, InstanceId};
use super::recipe::{Member, Owned, RowPlace, RowPlaces, RowStep};
use super::run::PointRun;
use super::shape::Shapes;
use super::workers::{Workers, in_parts};
use jbt_model::diagnostic::Diagnostic;

/// The numbers, and what they belong to.
pub(super) struct Written {
    pub(super) tables: Tables,
    /// What is behind the rows of each table: runs of particles are several rows.
    pub(super) members: Vec<Vec<Member>>,
}

/// Rows that are made at once.
pub(super) const ROWS_AT_ONCE: usize = 1 << 14;

/// Writes the numbers.
pub(super) fn rows(
    scene: &Scene<'_>,
    shapes: &Shapes,
    code: &Code,
    workers: &dyn Workers,
) -> Result<Written, Vec<Diagnostic>> {
    let mut writer = Writer::new(scene, shapes, code);
    for (table, code) in code.tables.iter().enumerate() {
        // Pieces have been written with their leaves.
        if writer.tables[table].count > 0 {
            continue;
        }
        let stride = writer.tables[table].stride;
        let members = std::mem::take(&mut writer.members[table]);
        watch::take(members.len() * stride * size_of::<f32>());
        writer.tables[table].numbers.reserve(members.len() * stride);
        for &member in &members {
            match member.run(scene) {
                Some(run) => writer.run(table, &code.recipe, (member, run), workers),
                None => writer.row(table, &code.recipe, member),
            }
        }
        writer.members[table] = members;
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
    /// By table.
    members: Vec<Vec<Member>>,
    /// By table, how many rows there will be.
    owned: Vec<usize>,
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
        let (members, owned) = (vec![Vec::new(); tables.len()], vec![0; tables.len()]);
        let (places, numbers) = (RowPlaces::of(root), Vec::new());
        let mut writer = Self { scene, shapes, tables, members, owned, errors: Vec::new(), places, numbers };
        writer.own(0, [root]);
        writer
    }

    /// Writes one row, and hands the rows of the tables under it out.
    fn row(&mut self, table: usize, recipe: &[RowStep], member: Member) {
        watch::look();
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
        watch::take_for(members, owned.size_hint().0);
        members.reserve(owned.size_hint().0);
        watch::take_for(&rows.active, owned.size_hint().0);
        rows.active.reserve(owned.size_hint().0);
        for member in owned {
            let first = self.owned[child];
            let end = first + member.rows(self.scene);
            watch::take_for(&rows.active, end - first);
            if member.is_asked(self.scene) {
                // At most limits::MAX_INSTANCES and limits::MAX_PARTICLES.
                rows.active.extend(first as u32..end as u32);
            }
            self.owned[child] = end;
            members.push(member);
        }
        rows.starts.push(rows.active.len() as u32);
    }

    /// Writes the rows of a run of particles. They are leaves that own no rows.
    fn run(
        &mut self,
        table: usize,
        recipe: &[RowStep],
        (member, run): (Member, (InstanceId, &PointRun, u32)),
        workers: &dyn Workers,
    ) {
        let (scene, rows) = (self.scene, &mut self.tables[table]);
        let (count, stride) = (run.1.len(), rows.stride);
        let columns = recipe.iter().filter_map(|step| match step {
            RowStep::Columns(place, numbers) => Some((*place, numbers)),
            RowStep::Slot(_) => None,
            RowStep::Lead(_) | RowStep::Rows(..) => unreachable!("a point owns no rows"),
        });
        let columns: Vec<_> = columns.collect();
        debug_assert!(columns.iter().all(|(place, _)| *place == RowPlace::ROW), "a point has no parts");
        let slots = recipe.iter().filter(|step| matches!(step, RowStep::Slot(_))).count();
        watch::take(slots * count * size_of::<u32>() + stride * count * size_of::<f32>());
        rows.nodes.extend(std::iter::repeat_n(member.node(scene).0, slots * count));
        rows.count += count;
        let before = rows.numbers.len();
        if before == 0 {
            // Zeros from the system are not touched before the workers do.
            rows.numbers = vec![0.0; stride * count];
        } else {
            rows.numbers.resize(before + stride * count, 0.0);
        }
        let made = &mut rows.numbers[before..];
        let bad = in_parts(workers, made, stride * ROWS_AT_ONCE, |first, part| {
            let mut numbers = Vec::with_capacity(stride);
            let mut bad = None;
            for (row, out) in part.chunks_exact_mut(stride).enumerate() {
                watch::look();
                let member = Member::particle(run, first / stride + row);
                numbers.clear();
                columns.iter().for_each(|(_, push)| push(scene, member, &mut numbers));
                let mut is_finite = true;
                for (out, &number) in out.iter_mut().zip(&numbers) {
                    *out = number as f32;
                    is_finite &= out.is_finite();
                }
                if !is_finite && bad.is_none() {
                    bad = Some((member, numbers.clone()));
                }
            }
            bad
        });
        bad.into_iter().flatten().for_each(|(member, numbers)| self.complain(member, &numbers));
    }

    /// Writes the rows of a leaf's pieces.
    fn pieces(&mut self, table: usize, field: FieldId) {
        let (primitive, scale) = (self.scene.primitive(field), self.scene.field(field).scale);
        let mut numbers = Vec::new();
        primitive.skeleton.pieces(scale, primitive.radius, &mut numbers);
        watch::take_for(&self.tables[table].numbers, numbers.len());
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
            let part = match member.one_of(self.scene) {
                Some((_, place)) => format!("particle {place}"),
                None => "this part".to_owned(),
            };
            let message = format!("a number derived from {part} leaves the range of f32: {number:e}");
            let help = "the part is too small, too large or too far away once all transforms are applied";
            self.errors.push(Diagnostic::error(node.span, message).expected(help));
        }
    }
}
