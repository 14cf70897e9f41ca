//! One row alone: a value of a row as a function of the point and of numbers, so that rows can be lanes.
//!
//! ```text
//! fold t1 rows (..) (acc):                              function (x, y, z, n0, n1)      n0: t1.tx of each row
//!     v1 = sub v0, t1.tx                                    v1 = sub x, n0              n1: t0.scale of the row
//!     v2 = mul v1, t0.scale            ──► v2 of t1             v2 = mul v1, n1              that owns it
//!     yield max acc, v2
//! ```
//!
//! The function has the ops of the value and no folds. Columns of the row, and of the rows that own it, are
//! *numbers*: more inputs, a plane each, with a number for each row of the table. A fold inside of the row
//! becomes straight code. It has as many copies of its body as the longest such fold of any row; a copy that
//! a row does not have is passed over, which one more number says.
//!
//! The pass [`row_interval`](crate::pass::row_interval()) makes ranges of it, in which numbers stay numbers.

use rustc_hash::FxHashMap as HashMap;

use crate::builder::FunctionBuilder;
use crate::entity::{Block, Entity, Inst, Table, Value, Values};
use crate::function::{Fold, Function, InstKind};
use crate::limits::{MAX_ROW_COPIES, MAX_ROW_VALUES};
use crate::op::{Domain, Type};
use crate::origin::Part;
use crate::table::Tables;
use crate::watch;

/// How many inputs are a point; those behind them are numbers of a row.
pub const POINT_PLANES: usize = 3;

/// A value of any row of a table, as a function.
#[derive(Clone, Debug)]
pub struct RowFunction {
    /// Its inputs are those of a point, then the numbers; its output is the value.
    pub function: Function,
    /// The numbers, plane by plane, one for each row of the table. Those of rows that are not active are 0.
    pub numbers: Vec<Vec<f32>>,
    /// The distances to skeletons that it computes.
    pub distances: u64,
}

/// A row, among those that a lane looks at.
#[derive(Clone, Debug)]
struct LaneRows {
    /// Of each lane; `None` where the lane has no such row.
    rows: Vec<Option<u32>>,
}

struct RowWriter<'a> {
    function: &'a Function,
    tables: &'a Tables,
    builder: FunctionBuilder,
    /// What defines each value; accumulators have no definition.
    definitions: Vec<Option<Inst>>,
    /// Whether a value has to be there.
    wanted: Vec<bool>,
    /// What values have become.
    values: HashMap<Value, Value>,
    /// By table, the current row.
    places: Vec<Option<LaneRows>>,
    lanes: usize,
    numbers: Vec<Vec<f32>>,
    distances: u64,
}

impl RowFunction {
    /// The function of a value that is computed in the rows of a table, in the body of the fold over it.
    /// `tables` fit the function ([`Tables::check`]).
    ///
    /// `None` if the value depends on rows beside its own (on an accumulator of a fold around it), or if the
    /// function would be longer than [`MAX_ROW_VALUES`].
    #[must_use]
    pub fn new(function: &Function, tables: &Tables, table: Table, value: Value) -> Option<Self> {
        let path = path(function, table)?;
        let mut definitions = vec![None; function.values.len()];
        for (inst, data) in function.insts.iter() {
            data.results.iter().for_each(|result| definitions[result.index()] = Some(inst));
        }
        let lanes = tables.tables[table].len();
        let mut writer = RowWriter {
            function,
            tables,
            builder: FunctionBuilder::new("row", &[]),
            definitions,
            wanted: vec![false; function.values.len()],
            values: HashMap::default(),
            places: vec![None; function.tables.len()],
            lanes,
            numbers: Vec::new(),
            distances: 0,
        };
        writer.want(value)?;
        writer.place_owners(table);
        writer.block(function.body, &path)?;
        let result = *writer.values.get(&value)?;
        let mut names: Vec<String> = function.inputs.clone();
        names.extend((0..writer.numbers.len()).map(|number| format!("n{number}")));
        writer.builder.set_inputs(names);
        let function = writer.builder.finish(&[("field".to_owned(), result)]);
        Some(Self { function, numbers: writer.numbers, distances: writer.distances })
    }
}

/// The folds around the rows of a table, the outermost first, its own last.
fn path(function: &Function, table: Table) -> Option<Vec<Inst>> {
    let folds = function.folds();
    let mut path = Vec::new();
    let mut next = Some(table);
    while let Some(table) = next {
        path.push(folds[table.index()]?);
        next = function.tables[table].parent;
    }
    path.reverse();
    (function.inputs.len() == POINT_PLANES).then_some(path)
}

impl RowWriter<'_> {
    /// Marks what a value is made of. `None` if that is an accumulator of a fold around it.
    fn want(&mut self, value: Value) -> Option<()> {
        let mut stack = vec![value];
        // Accumulators that a fold inside binds.
        let mut bound: Vec<Value> = Vec::new();
        let mut free: Vec<Value> = Vec::new();
        while let Some(value) = stack.pop() {
            if std::mem::replace(&mut self.wanted[value.index()], true) {
                continue;
            }
            let Some(inst) = self.definitions[value.index()] else {
                free.push(value);
                continue;
            };
            stack.extend(self.function.operands(inst));
            if let InstKind::Fold(fold) = &self.function.insts[inst].kind {
                let body = &self.function.blocks[fold.body];
                bound.extend(&body.params);
                stack.extend(&body.results);
            }
        }
        free.iter().all(|value| bound.contains(value)).then_some(())
    }

    /// The row itself, and those that own it.
    fn place_owners(&mut self, table: Table) {
        watch::take(3 * self.lanes * size_of::<Option<u32>>());
        let mut rows: Vec<Option<u32>> = (0..self.lanes as u32).map(Some).collect();
        let mut table = table;
        loop {
            self.places[table.index()] = Some(LaneRows { rows: rows.clone() });
            let Some(parent) = self.function.tables[table].parent else { return };
            let mut owners = vec![None; self.tables.tables[table].len()];
            for owner in 0..self.tables.tables[parent].len() {
                for &row in self.tables.tables[table].range(owner) {
                    owners[row as usize] = Some(owner as u32);
                }
            }
            for row in &mut rows {
                *row = row.and_then(|row| owners[row as usize]);
            }
            table = parent;
        }
    }

    /// Writes what is wanted of a block. `path` are the folds to go into.
    fn block(&mut self, block: Block, path: &[Inst]) -> Option<()> {
        let function = self.function;
        for &inst in &function.blocks[block].insts {
            if path.first() == Some(&inst) {
                let InstKind::Fold(fold) = &function.insts[inst].kind else { return None };
                return self.block(fold.body, &path[1..]);
            }
            self.inst(inst)?;
        }
        Some(())
    }

    fn inst(&mut self, inst: Inst) -> Option<()> {
        let data = &self.function.insts[inst];
        if !data.results.iter().any(|result| self.wanted[result.index()]) {
            return Some(());
        }
        if self.builder.function().values.len() > MAX_ROW_VALUES {
            return None;
        }
        let value = match &data.kind {
            InstKind::Input(index) => self.builder.input(*index),
            InstKind::Constant(number) => self.builder.constant(*number),
            InstKind::BitsConstant(bits) => self.builder.bits_constant(*bits),
            InstKind::Column { table, column } => self.column(*table, *column)?,
            InstKind::Op { op, args } => {
                let args: Option<Values> = args.iter().map(|arg| self.values.get(arg).copied()).collect();
                self.distances += u64::from(data.origin.part == Part::Distance);
                self.builder.op(*op, &args?)
            }
            InstKind::Fold(fold) => return self.fold(fold, &data.results),
        };
        self.values.insert(data.results[0], value);
        Some(())
    }

    /// A number for each lane.
    fn number(&mut self, numbers: Vec<f32>) -> Value {
        self.numbers.push(numbers);
        self.builder.input(POINT_PLANES + self.numbers.len() - 1)
    }

    /// A column of the current row of a table.
    fn column(&mut self, table: Table, column: usize) -> Option<Value> {
        let rows = &self.tables.tables[table];
        let place = self.places[table.index()].as_ref()?;
        watch::take(self.lanes * size_of::<f32>());
        let number = |row: &Option<u32>| row.map_or(0.0, |row| rows.row(row as usize)[column]);
        let numbers = place.rows.iter().map(number).collect();
        Some(self.number(numbers))
    }

    /// A fold inside of the row, as straight code.
    fn fold(&mut self, fold: &Fold, results: &[Value]) -> Option<()> {
        let function = self.function;
        let rows = &self.tables.tables[fold.table];
        let owners = self.places[function.tables[fold.table].parent?.index()].clone()?;
        let owned = |owner: &Option<u32>| owner.map_or(&[][..], |owner| rows.range(owner as usize));
        let copies = owners.rows.iter().map(|owner| owned(owner).len()).max().unwrap_or(0);
        if copies.saturating_mul(self.lanes) > MAX_ROW_COPIES {
            return None;
        }
        let body = &function.blocks[fold.body];
        let mut so_far: Option<Values> =
            fold.initial.iter().map(|value| self.values.get(value).copied()).collect();
        for copy in 0..copies {
            watch::take(self.lanes * (size_of::<Option<u32>>() + size_of::<f32>()));
            let rows: Vec<Option<u32>> =
                owners.rows.iter().map(|owner| owned(owner).get(copy).copied()).collect();
            let is_there = rows.iter().all(Option::is_some);
            let there = rows.iter().map(|row| if row.is_some() { 1.0 } else { 0.0 }).collect();
            self.places[fold.table.index()] = Some(LaneRows { rows });
            let before = so_far.take()?;
            for (&param, &value) in body.params.iter().zip(&before) {
                self.values.insert(param, value);
            }
            for &inst in &body.insts {
                self.inst(inst)?;
            }
            let next: Option<Values> =
                body.results.iter().map(|value| self.values.get(value).copied()).collect();
            let next = next?;
            so_far = if is_there { Some(next) } else { self.chosen(there, &next, &before) };
        }
        self.places[fold.table.index()] = None;
        for (&result, value) in results.iter().zip(so_far?) {
            self.values.insert(result, value);
        }
        Some(())
    }

    /// The next accumulators where a row is there, those before elsewhere. `None` for bits.
    fn chosen(&mut self, there: Vec<f32>, next: &[Value], before: &[Value]) -> Option<Values> {
        let there = self.number(there);
        let d = &mut self.builder;
        let zero = d.constant(0.0);
        let there = d.lt(zero, there);
        let choose = |(&next, &before): (&Value, &Value)| match d.function().values[next] {
            Type::Real => Some(d.select(there, next, before)),
            Type::Mask => {
                let (new, gone) = (d.both(there, next), d.not(there));
                let old = d.both(gone, before);
                Some(d.either(new, old))
            }
            Type::Bits => None,
        };
        next.iter().zip(before).map(choose).collect()
    }
}
