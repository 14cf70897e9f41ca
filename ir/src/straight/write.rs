//! Writes a function again, with straight code in place of folds.

use rustc_hash::FxHashMap as HashMap;

use crate::builder::FunctionBuilder;
use crate::entity::{Block, Entity, Table, Value, Values};
use crate::function::{Fold, Function, InstData, InstKind, Schema};
use crate::op::Domain as _;
use crate::origin::{Origin, Part};
use crate::table::Tables;

use super::choose::Chosen;
use super::plan::{Copied, Count, Place, Source, Under};

/// The new function and how its tables follow from old ones: the fields of [`Straight`](super::Straight).
pub(super) struct Written {
    pub(super) function: Function,
    pub(super) places: Vec<Place>,
    pub(super) counts: Vec<Count>,
    pub(super) columns: Vec<Vec<Source>>,
    pub(super) copies: Vec<Copied>,
}

/// Writes a function again, with straight code in place of the folds over the chosen tables.
///
/// The recursion is over nested folds, at most [`crate::limits::MAX_FOLD_DEPTH`] deep.
pub(super) struct Writer<'a> {
    function: &'a Function,
    tables: &'a Tables,
    chosen: Chosen,
    /// The columns of numbers that were separated before.
    apart: &'a HashMap<Source, usize>,
    /// Whether numbers of the row that stays may share a column: only if the row holds no primitive.
    shares_root: bool,
    builder: FunctionBuilder,
    /// The new value of each old one.
    map: Vec<Option<Value>>,
    places: Vec<Place>,
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
            map: vec![None; function.values.len()],
            places: vec![Place { parent: 0, table: root, position: 0 }],
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
        let function = self.function;
        self.insts(function.body);
        let results = self.map_all(&function.blocks[function.body].results);
        let outputs: Vec<(String, Value)> = function.outputs.iter().cloned().zip(results).collect();
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

    fn map_all(&self, values: &[Value]) -> Values {
        values.iter().map(|value| self.map[value.index()].expect("values are defined before use")).collect()
    }

    fn bind(&mut self, old: &[Value], new: &[Value]) {
        for (old, &new) in old.iter().zip(new) {
            self.map[old.index()] = Some(new);
        }
    }

    fn insts(&mut self, block: Block) {
        let function = self.function;
        for &inst in &function.blocks[block].insts {
            self.inst(&function.insts[inst]);
        }
    }

    fn inst(&mut self, data: &'a InstData) {
        let slot = data.origin.slot.map(|slot| self.slots.get(&slot).copied().unwrap_or(slot));
        let origin = Origin { slot, ..data.origin };
        self.builder.set_origin(origin);
        let result = match &data.kind {
            InstKind::Input(index) => self.builder.input(*index),
            InstKind::Constant(number) => self.builder.constant(*number),
            InstKind::BitsConstant(bits) => self.builder.bits_constant(*bits),
            InstKind::Column { table, column } => self.column(*table, *column),
            InstKind::Op { op, args } => {
                let args = self.map_all(args);
                let result = self.builder.op(*op, &args);
                if origin.part == Part::Distance {
                    self.builder.mark(result, origin);
                }
                result
            }
            InstKind::Fold(fold) => {
                let initial = self.map_all(&fold.initial);
                let results = match self.parent(fold.table) {
                    Under::Place(place) if self.chosen.straight[fold.table.index()] => {
                        self.straight(fold, place, initial)
                    }
                    parent => self.fold(fold, parent, &initial, origin),
                };
                self.bind(&data.results, &results);
                return;
            }
        };
        self.bind(&data.results, &[result]);
    }

    /// Where the parent of a table is now.
    fn parent(&self, table: Table) -> Under {
        self.function.tables[table].parent.map_or(Under::Nothing, |parent| {
            self.here[parent.index()].expect("a fold stands in the body of the fold over its parent")
        })
    }

    /// The body once for each row.
    fn straight(&mut self, fold: &'a Fold, parent: usize, initial: Values) -> Values {
        let (function, table) = (self.function, fold.table);
        let rows = self.tables.tables[table].range(self.rows[parent]);
        self.counts.push(Count { place: parent, table, rows: rows.len() });
        let mut so_far = initial;
        for (position, &row) in rows.iter().enumerate() {
            self.here[table.index()] = Some(Under::Place(self.places.len()));
            self.places.push(Place { parent, table, position });
            self.rows.push(row as usize);
            self.bind(&function.blocks[fold.body].params, &so_far);
            self.insts(fold.body);
            so_far = self.map_all(&function.blocks[fold.body].results);
        }
        so_far
    }

    /// A fold as before: over the table of the row that stays, or over a new one.
    fn fold(&mut self, fold: &'a Fold, parent: Under, initial: &[Value], origin: Origin) -> Values {
        let function = self.function;
        let table = if fold.table == self.chosen.root {
            self.here[fold.table.index()] = Some(Under::Place(0));
            Table::new(0)
        } else {
            let table = self.copied(fold.table, parent);
            self.here[fold.table.index()] = Some(Under::Table(table));
            table
        };
        let params = self.builder.begin_fold(table, (fold.kind, fold.rule), initial);
        self.bind(&function.blocks[fold.body].params, &params);
        self.insts(fold.body);
        let next = self.map_all(&function.blocks[fold.body].results);
        self.builder.set_origin(origin);
        self.builder.end_fold(&next).into()
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
