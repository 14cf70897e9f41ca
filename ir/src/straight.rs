//! Straight code for tables of few rows: a copy of the body for each row, so that rows share what they have in common.
//!
//! ```text
//! table t0 "scene" (..)                                    table t0 "scene" (.., a, b)      a: number of rows 0 and 1, which
//! table t1 "formula" (number, number)    3 rows                                                is the same; b: of row 0; ..
//!
//! fold t0 only (..) block1(..):                            fold t0 only (..) block1(..):
//!     v3 = fold t1 union (v2) block2(v4):        ──►           v4 = mul v0, a
//!         v5 = column t1.number                                v5 = add v4, b
//!         v6 = mul v0, v5                                      v6 = max v2, v5
//!         ..                                                   ..            row 1 has no `mul` of its own
//! ```
//!
//! A program of formulas, such as one that was written by a machine, becomes many tables of two or three rows. Its rows have most of their
//! numbers in common, and so most of their work; but a loop does the work of each row again. Straight code reads equal numbers from one
//! column, and the builder, which writes no instruction twice, does the rest. The order of all steps stays, so the bits do.
//!
//! There is a price. Straight rows are always there: nothing can leave one out. And the code knows how many rows there are and which of their
//! numbers are equal, so it fits fewer tables than the function that it was made from: see [`Straight::tables`].
//!
//! A pass that makes other steps of a function, as the gradient, comes before: what it makes of straight code has other roundings.
//!
//! Rows of primitives stay rows. They seldom have anything in common, people edit them, and a row is what is counted and left out.

use rustc_hash::FxHashMap as HashMap;

use crate::builder::FunctionBuilder;
use crate::domain::counting::{of_selection, ops_per_row};
use crate::entity::{Block, Entity, Store, Table, Value, Values};
use crate::function::{Fold, Function, InstData, InstKind, Reduction, Schema};
use crate::op::Domain as _;
use crate::origin::{Origin, Part};
use crate::selection::Selection;
use crate::table::{Rows, Tables};

/// Rows of one table that may become straight code, under one row of its parent.
const MAX_ROWS: usize = 64;
/// Ops of a point beyond which the folds stay: code that long no longer fits into the nearest cache for instructions.
const MAX_OPS: u64 = 1 << 16;
/// Straight code is worth it if it takes at most so much of the ops of the folds.
const WORTH: f64 = 0.95;

/// A function with straight code in place of some folds, and how tables of the one become tables of the other.
#[derive(Clone, Debug)]
pub struct Straight {
    function: Function,
    /// The row that stays, and all that became straight code. Parents come before their children.
    places: Vec<Place>,
    /// How many rows have to be where.
    counts: Vec<Count>,
    /// By column of the row that stays: the numbers that it holds, all of them the same.
    columns: Vec<Vec<Source>>,
    /// By table, that of the row that stays left out.
    copies: Vec<Copied>,
}

/// A row that became straight code: the n-th active one of a table under another place. The first place is the row that stays.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Place {
    parent: usize,
    table: Table,
    position: usize,
}

/// A place has so many active rows of a table.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Count {
    place: usize,
    table: Table,
    rows: usize,
}

/// A number: a column of the row at a place.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
struct Source {
    place: usize,
    column: usize,
}

/// A table whose rows are rows of another one: the active ones that hang under a place, under the rows of a new table, or under nothing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Copied {
    table: Table,
    under: Under,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Under {
    /// Under no row.
    Nothing,
    Place(usize),
    Table(Table),
}

impl Straight {
    /// Straight code for these tables, if it is worth it: `None` if folds are as good. The tables fit the function ([`Tables::check`]).
    ///
    /// Time and memory are in proportion to the function and to 2^16 ops.
    #[must_use]
    pub fn new(function: &Function, tables: &Tables) -> Option<Self> {
        Self::if_worth(function, tables, WORTH)
    }

    /// As [`new`](Self::new), if it takes at most so much of the ops of the folds.
    #[must_use]
    pub fn if_worth(function: &Function, tables: &Tables, worth: f64) -> Option<Self> {
        Self::with_apart(function, tables, worth, &HashMap::default())
    }

    /// Straight code for other tables of the same function. Numbers that have been told apart before stay apart, so that a number which
    /// moves ends up in a column of its own.
    #[must_use]
    pub fn again(&self, function: &Function, tables: &Tables) -> Option<Self> {
        let mut apart = HashMap::default();
        if self.rows(tables).is_some() {
            for (column, sources) in self.columns.iter().enumerate() {
                apart.extend(sources.iter().map(|&source| (source, column)));
            }
        }
        Self::with_apart(function, tables, WORTH, &apart)
    }

    fn with_apart(
        function: &Function,
        tables: &Tables,
        worth: f64,
        apart: &HashMap<Source, usize>,
    ) -> Option<Self> {
        let chosen = Chosen::new(function, tables)?;
        let all = Selection::new(function, tables);
        let folded = of_selection(&ops_per_row(function), &all);
        if folded > MAX_OPS {
            return None;
        }
        let straight = Writer::new(function, tables, chosen, apart).run();
        let tables = straight.tables(tables).expect("it was made for these tables");
        let all = Selection::new(&straight.function, &tables);
        let ops = of_selection(&ops_per_row(&straight.function), &all);
        (ops as f64 <= worth * folded as f64).then_some(straight)
    }

    /// The function.
    #[must_use]
    pub fn function(&self) -> &Function {
        &self.function
    }

    /// The tables of [`function`](Self::function) for tables of the function that it was made from; `None` if they have other numbers of rows
    /// where there is straight code now, or if numbers that share a column differ.
    #[must_use]
    pub fn tables(&self, tables: &Tables) -> Option<Tables> {
        let rows = self.rows(tables)?;
        let number = |source: Source| {
            let place = self.places[source.place];
            tables.tables[place.table].row(rows[source.place])[source.column]
        };
        let mut numbers = Vec::with_capacity(self.columns.len());
        for sources in &self.columns {
            let first = number(sources[0]);
            if sources[1..].iter().any(|&source| number(source).to_bits() != first.to_bits()) {
                return None;
            }
            numbers.push(first);
        }
        let root = self.places[0].table;
        let slots = self.function.tables[Table::new(0)].slots.len();
        let nodes = tables.tables[root].nodes[rows[0] * slots..][..slots].to_vec();
        let mut made: Store<Table, Rows> = Store::new();
        made.push(Rows {
            count: 1,
            stride: numbers.len(),
            numbers,
            active: vec![0],
            starts: vec![0, 1],
            nodes,
        });
        // The rows that each new table was made from.
        let mut from: Vec<Vec<u32>> = vec![Vec::new()];
        for copied in &self.copies {
            let parents = match copied.under {
                Under::Nothing => &[0][..],
                Under::Place(place) => &[rows[place] as u32][..],
                Under::Table(parent) => &from[parent.index()],
            };
            let slots = self.function.tables[made.next_key()].slots.len();
            let (rows, list) = copy(&tables.tables[copied.table], parents, slots);
            made.push(rows);
            from.push(list);
        }
        Some(Tables { tables: made })
    }

    /// The row at each place, if there are as many as there have to be.
    fn rows(&self, tables: &Tables) -> Option<Vec<usize>> {
        let root = self.places[0].table;
        let [first] = tables.tables[root].active[..] else { return None };
        let mut rows = vec![first as usize];
        let mut counts = self.counts.iter();
        let mut next = counts.next();
        for (index, place) in self.places.iter().enumerate() {
            if index > 0 {
                rows.push(tables.tables[place.table].range(rows[place.parent])[place.position] as usize);
            }
            // The counts of a place stand in the order of places, before the places that they speak of are met.
            while let Some(count) = next.filter(|count| count.place == index) {
                if tables.tables[count.table].range(rows[index]).len() != count.rows {
                    return None;
                }
                next = counts.next();
            }
        }
        Some(rows)
    }
}

/// The active rows under some rows, as a table of its own whose rows are all active; and which rows these are.
fn copy(rows: &Rows, parents: &[u32], slots: usize) -> (Rows, Vec<u32>) {
    let mut starts = vec![0];
    let mut list: Vec<u32> = Vec::new();
    for &parent in parents {
        list.extend(rows.range(parent as usize));
        starts.push(list.len() as u32);
    }
    let numbers = list.iter().flat_map(|&row| rows.row(row as usize)).copied().collect();
    let nodes = list.iter().flat_map(|&row| &rows.nodes[row as usize * slots..][..slots]).copied().collect();
    let active = (0..list.len() as u32).collect();
    (Rows { count: list.len(), stride: rows.stride, numbers, active, starts, nodes }, list)
}

/// Which tables become straight code.
struct Chosen {
    root: Table,
    /// By table.
    straight: Vec<bool>,
}

impl Chosen {
    /// `None` if no table does.
    fn new(function: &Function, tables: &Tables) -> Option<Self> {
        let root = Table::new(0);
        let count = function.tables.len();
        if count == 0 || tables.tables[root].active.len() != 1 {
            return None;
        }
        let mut leaves = vec![false; count];
        // Parents come before their children.
        for (table, schema) in function.tables.iter().collect::<Vec<_>>().into_iter().rev() {
            leaves[table.index()] |= !schema.slots.is_empty();
            if let Some(parent) = schema.parent {
                leaves[parent.index()] |= leaves[table.index()];
            }
        }
        let is_whole = |rows: &Rows| rows.active.len() == rows.len();
        // Rows of selectors come and go.
        let chooses = !tables.tables.values().all(is_whole);
        let mut reductions = vec![Reduction::Only; count];
        for data in function.insts.values() {
            if let InstKind::Fold(fold) = &data.kind {
                reductions[fold.table.index()] = fold.reduction;
            }
        }
        let mut straight = vec![false; count];
        for (table, schema) in function.tables.iter() {
            let Some(parent) = schema.parent else { continue };
            let rows = &tables.tables[table];
            let few = rows.starts.windows(2).all(|pair| (pair[1] - pair[0]) as usize <= MAX_ROWS);
            let stays = chooses && reductions[table.index()] == Reduction::Only;
            straight[table.index()] = (parent == root || straight[parent.index()])
                && !leaves[table.index()]
                && is_whole(rows)
                && few
                && !stays
                && reductions[table.index()] != Reduction::Pieces;
        }
        straight.iter().any(|&it| it).then_some(Self { root, straight })
    }
}

/// Writes a function again, with straight code in place of the folds over the chosen tables.
///
/// The recursion is over nested folds, at most [`crate::limits::MAX_FOLD_DEPTH`] deep.
struct Writer<'a> {
    function: &'a Function,
    tables: &'a Tables,
    chosen: Chosen,
    /// The columns that numbers had to themselves before.
    apart: &'a HashMap<Source, usize>,
    /// Whether numbers of the row that stays may share a column: it holds no primitive.
    shares_root: bool,
    builder: FunctionBuilder,
    /// The new value of each old one.
    map: Vec<Option<Value>>,
    places: Vec<Place>,
    rows: Vec<usize>,
    counts: Vec<Count>,
    columns: Vec<Vec<Source>>,
    copies: Vec<Copied>,
    /// By old table, while its body is written: the place, or the new table.
    here: Vec<Option<Under>>,
    column_of: HashMap<Source, usize>,
    /// The column that holds a number, by its bits; and by the column that it had before.
    column_with: HashMap<(Option<usize>, u32), usize>,
    /// The new slot of each old one, in the body that is written.
    slots: HashMap<u32, u32>,
    next_slot: u32,
}

impl<'a> Writer<'a> {
    fn new(
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

    fn run(mut self) -> Straight {
        let function = self.function;
        self.insts(function.body);
        let results = self.map_all(&function.blocks[function.body].results);
        let outputs: Vec<(String, Value)> = function.outputs.iter().cloned().zip(results).collect();
        // The rows of a place are looked up when the place is: in the order of places.
        self.counts.sort_by_key(|count| count.place);
        Straight {
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
        let params = self.builder.begin_fold(table, fold.reduction, initial);
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
