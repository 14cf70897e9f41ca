//! Writes a function again, with straight code in place of folds.

use rustc_hash::FxHashMap as HashMap;

use crate::builder::FunctionBuilder;
use crate::entity::{Entity, Table, Value};
use crate::function::{Fold, Function, InstData, Schema};
use crate::op::{Domain as _, Op};
use crate::origin::Origin;
use crate::table::Tables;
use crate::translate::{AccumulatorParts, Translation, translate};

use super::choose::Chosen;
use super::plan::{ChosenRow, Copied, Count, Source, Under};

/// The new function and how its tables follow from old ones: the fields of [`Straight`](super::Straight).
pub(super) struct Written {
    pub(super) function: Function,
    pub(super) places: Vec<ChosenRow>,
    pub(super) counts: Vec<Count>,
    pub(super) columns: Vec<Vec<Source>>,
    pub(super) copies: Vec<Copied>,
}

/// Writes a function again, with straight code in place of the folds over the chosen tables.
pub(super) struct Writer<'a> {
    function: &'a Function,
    tables: &'a Tables,
    chosen: Chosen,
    /// The columns of numbers that were separated before.
    apart: &'a HashMap<Source, usize>,
    /// Whether numbers of the row that stays may share a column: only if the row holds no primitive.
    shares_root: bool,
    builder: FunctionBuilder,
    places: Vec<ChosenRow>,
    rows: Vec<usize>,
    counts: Vec<Count>,
    columns: Vec<Vec<Source>>,
    copies: Vec<Copied>,
    /// By old table, while its fold's body is written: the place, or the new table.
    here: Vec<Option<Under>>,
    column_of: HashMap<Source, usize>,
    /// The column that holds a number, by the number's separate column, if it had one, and by its bits.
    column_with: HashMap<(Option<usize>, u32), usize>,
    /// The new slot of each old one, in the body that is written.
    slots: HashMap<u32, u32>,
    next_slot: u32,
}

impl<'a> Writer<'a> {
    pub(super) fn new(
        function: &'a Function,
        tables: &'a Tables,
        chosen: Chosen,
        apart: &'a HashMap<Source, usize>,
    ) -> Self {
        let root = chosen.root;
        let inputs: Vec<&str> = function.inputs.iter().map(String::as_str).collect();
        let mut builder = FunctionBuilder::new(&function.name, &inputs);
        let schema = &function.tables[root];
        // Its columns are learnt while the code is written.
        builder.table(Schema { columns: Vec::new(), ..schema.clone() });
        Self {
            function,
            tables,
            apart,
            shares_root: function.tables[root].slots.is_empty(),
            builder,
            places: vec![ChosenRow { parent: 0, table: root, position: 0 }],
            rows: vec![tables.tables[root].active[0] as usize],
            counts: Vec::new(),
            columns: Vec::new(),
            copies: Vec::new(),
            here: vec![None; function.tables.len()],
            column_of: HashMap::default(),
            column_with: HashMap::default(),
            slots: HashMap::default(),
            next_slot: schema.slots.iter().map(|slot| slot + 1).max().unwrap_or(0),
            chosen,
        }
    }

    pub(super) fn run(mut self) -> Written {
        let results = translate(self.function, &mut self);
        let outputs: Vec<(String, Value)> = self.function.outputs.iter().cloned().zip(results).collect();
        // The rows of a place are looked up when the place is: in the order of places.
        self.counts.sort_by_key(|count| count.place);
        Written {
            function: self.builder.finish(&outputs),
            places: self.places,
            counts: self.counts,
            columns: self.columns,
            copies: self.copies,
        }
    }

    /// The origin of the new instructions: slots have other numbers.
    fn origin(&self, old: Origin) -> Origin {
        let slot = old.slot().map(|slot| self.slots.get(&slot).copied().unwrap_or(slot));
        Origin::new(slot, old.part)
    }

    /// Where the parent of a table is now.
    fn parent(&self, table: Table) -> Under {
        self.function.tables[table].parent.map_or(Under::Nothing, |parent| {
            self.here[parent.index()].expect("a fold stands in the body of the fold over its parent")
        })
    }

    /// The place under which the rows of a fold become straight code, if they do.
    fn straight_under(&self, fold: &Fold) -> Option<usize> {
        match self.parent(fold.table) {
            Under::Place(place) => self.chosen.straight[fold.table.index()].then_some(place),
            Under::Nothing | Under::Table(_) => None,
        }
    }

    /// The active rows of a table under a place.
    fn rows_under(&self, table: Table, place: usize) -> &'a [u32] {
        self.tables.tables[table].range(self.rows[place])
    }

    /// A new table for rows of an old one.
    fn copied(&mut self, table: Table, under: Under) -> Table {
        let schema = &self.function.tables[table];
        let parent = match under {
            Under::Nothing => None,
            Under::Place(_) => Some(Table::new(0)),
            Under::Table(table) => Some(table),
        };
        let mut slots = Vec::with_capacity(schema.slots.len());
        for &slot in &schema.slots {
            self.slots.insert(slot, self.next_slot);
            slots.push(self.next_slot);
            self.next_slot += 1;
        }
        self.copies.push(Copied { table, under });
        let (name, columns) = (schema.name.clone(), schema.columns.clone());
        self.builder.table(Schema { name, columns, parent, slots })
    }

    /// The column of the row that stays which holds this number.
    fn shared(&mut self, source: Source) -> usize {
        if let Some(&column) = self.column_of.get(&source) {
            return column;
        }
        let table = self.places[source.place].table;
        let number = self.tables.tables[table].row(self.rows[source.place])[source.column];
        let key = (self.apart.get(&source).copied(), number.to_bits());
        let shares = source.place > 0 || self.shares_root;
        let found = self.column_with.get(&key).copied().filter(|_| shares);
        let column = found.unwrap_or_else(|| {
            self.columns.push(Vec::new());
            let name = &self.function.tables[table].columns[source.column];
            let column = self.builder.add_column(Table::new(0), name);
            if shares {
                self.column_with.insert(key, column);
            }
            column
        });
        self.columns[column].push(source);
        self.column_of.insert(source, column);
        column
    }
}

impl Translation for Writer<'_> {
    type Value = Value;
    type Part = Value;

    fn begin(&mut self, origin: Origin) {
        self.builder.set_origin(self.origin(origin));
    }

    fn input(&mut self, index: usize) -> Value {
        self.builder.input(index)
    }

    fn constant(&mut self, number: f32) -> Value {
        self.builder.constant(number)
    }

    fn bits_constant(&mut self, bits: u32) -> Value {
        self.builder.bits_constant(bits)
    }

    fn column(&mut self, table: Table, column: usize) -> Value {
        match self.here[table.index()].expect("a column is read inside the fold over its table") {
            Under::Nothing => unreachable!("no body stands there"),
            Under::Table(table) => self.builder.column(table, column),
            Under::Place(place) => {
                let column = self.shared(Source { place, column });
                self.builder.column(Table::new(0), column)
            }
        }
    }

    fn op(&mut self, _: &InstData, op: Op, args: &[Value]) -> Value {
        let result = self.builder.op(op, args);
        let origin = self.builder.origin();
        self.builder.keep_distance(result, origin);
        result
    }

    fn split(&mut self, value: Value, _: Value, parts: &mut AccumulatorParts<Value>) {
        parts.push(value);
    }

    fn whole(&mut self, _: Value, mut next: impl FnMut() -> Value) -> Value {
        next()
    }

    /// Straight code has the body once for each row.
    fn runs(&mut self, fold: &Fold) -> usize {
        let Some(place) = self.straight_under(fold) else { return 1 };
        let rows = self.rows_under(fold.table, place).len();
        self.counts.push(Count { place, table: fold.table, rows });
        rows
    }

    /// A fold that stays is over the table of the row that stays, or over a new one.
    fn enter(&mut self, fold: &Fold, run: usize, parts: AccumulatorParts<Value>) -> AccumulatorParts<Value> {
        let table = fold.table;
        if let Some(parent) = self.straight_under(fold) {
            self.here[table.index()] = Some(Under::Place(self.places.len()));
            self.places.push(ChosenRow { parent, table, position: run });
            self.rows.push(self.rows_under(table, parent)[run] as usize);
            return parts;
        }
        let (here, table) = if table == self.chosen.root {
            (Under::Place(0), Table::new(0))
        } else {
            let table = self.copied(table, self.parent(table));
            (Under::Table(table), table)
        };
        self.here[fold.table.index()] = Some(here);
        self.builder.begin_fold(table, (fold.kind, fold.rule), &parts).into()
    }

    fn leave(
        &mut self,
        fold: &Fold,
        origin: Origin,
        next: AccumulatorParts<Value>,
    ) -> AccumulatorParts<Value> {
        if self.straight_under(fold).is_some() {
            return next;
        }
        self.builder.set_origin(self.origin(origin));
        self.builder.end_fold(&next).into()
    }
}
