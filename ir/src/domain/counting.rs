//! Counts instead of computing: how many ops a point takes, and how many evaluations each leaf of the model.
//!
//! In [`Counting`] a value is nothing, and an op adds one to the count of its kind. It runs every row, so it
//! is for tests and for people. [`evaluations`] counts distances without running the function, in time that
//! grows with the active rows but not with their cost.

use std::collections::{BTreeMap, HashMap};

use crate::entity::{Block, Entity, Table};
use crate::function::{Function, InstKind};
use crate::op::{Domain, Op};
use crate::origin::Part;
use crate::selection::Selection;
use crate::table::Tables;
use crate::verify::Verified;

/// The counting domain: run a function in it ([`crate::interpret::run`]) to learn what one point costs.
///
/// Constants, inputs and columns cost nothing. An op that stands in a fold counts once for each time that its
/// body runs.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Counting {
    counts: [u64; Op::ALL.len()],
}

impl Counting {
    /// Nothing has been counted.
    #[must_use]
    pub const fn new() -> Self {
        Self { counts: [0; Op::ALL.len()] }
    }

    /// How often an op was executed.
    #[must_use]
    pub const fn count(&self, op: Op) -> u64 {
        self.counts[op as usize]
    }

    /// All ops that were executed, by name, in the order of the op table.
    pub fn by_name(&self) -> impl Iterator<Item = (&'static str, u64)> {
        Op::ALL.iter().map(|&op| (op.name(), self.count(op))).filter(|&(_, count)| count > 0)
    }

    /// How many ops were executed.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    const fn add_one(&mut self, op: Op) {
        self.counts[op as usize] += 1;
    }
}

impl Default for Counting {
    fn default() -> Self {
        Self::new()
    }
}

/// How often the distances to skeletons are computed for one point.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct Evaluations {
    /// By tree node, as [`Rows::nodes`](crate::table::Rows::nodes) names them. A node that is not evaluated
    /// is not here.
    pub per_node: BTreeMap<u32, u64>,
    /// All of them.
    pub total: u64,
}

/// How often each leaf of a model is evaluated for one point: how often the instructions run whose origin is
/// the [distance](Part::Distance) of a leaf slot. `tables` fit the function ([`Tables::check`]).
///
/// An instruction runs as often as its block. It counts for the leaf in its slot of the current row of the
/// slot's table. An instruction that was hoisted out of the fold over that table, because it depends on no
/// column of the row, runs once for all rows; it counts once, for the leaf of the first active row that it
/// serves. If no row is active, it still runs, and counts in the total only. Constants and columns cost
/// nothing and do not count.
///
/// Counts saturate at 2^64 - 1.
#[must_use]
pub fn evaluations(function: &Verified, tables: &Tables) -> Evaluations {
    let function = function.function();
    let homes = homes_of_slots(function);
    let mut result = Evaluations::default();
    for (chain, slots) in distances(function) {
        let chain = Chain::new(function, tables, chain);
        // Most slots of a block belong to one table, whose rows are gone through once for all of them.
        let mut by_table: BTreeMap<Option<Table>, Vec<(usize, u64)>> = BTreeMap::new();
        for (slot, count) in slots {
            let home = homes.get(&slot);
            by_table
                .entry(home.map(|&(table, _)| table))
                .or_default()
                .push((home.map_or(0, |&(_, at)| at), count));
        }
        for (table, slots) in by_table {
            let counts: u64 = slots.iter().map(|&(_, count)| count).sum();
            result.total = result.total.saturating_add(chain.runs().saturating_mul(counts));
            let Some(table) = table else { continue };
            let width = function.tables[table].slots.len();
            for (row, runs) in chain.runs_by_row(table).into_iter().enumerate().filter(|&(_, runs)| runs > 0)
            {
                for &(at, count) in &slots {
                    let node = tables.tables[table].nodes[row * width + at];
                    let sum = result.per_node.entry(node).or_default();
                    *sum = sum.saturating_add(runs.saturating_mul(count));
                }
            }
        }
    }
    result
}

/// For each table, the distances that one run of its fold's body computes, without the distances of folds
/// inside. Multiplied by the active rows of a [`Selection`] and summed over the tables, they give the
/// evaluations of a point, if each active row runs once. This holds for lowered functions: there the fold
/// over a table stands in the body of the fold over its parent.
#[must_use]
pub fn evaluations_per_row(function: &Function) -> Vec<u64> {
    let mut rows = vec![0; function.tables.len()];
    for (chain, slots) in distances(function) {
        if let Some(table) = chain.last() {
            rows[table.index()] += slots.values().sum::<u64>();
        }
    }
    rows
}

/// For each table, the ops of one run of its fold's body, without the ops of folds inside.
#[must_use]
pub fn ops_per_row(function: &Function) -> Vec<u64> {
    let mut rows = vec![0; function.tables.len()];
    for data in function.insts.values() {
        if let InstKind::Fold(fold) = &data.kind {
            let insts = &function.blocks[fold.body].insts;
            let ops = insts.iter().filter(|&&inst| matches!(function.insts[inst].kind, InstKind::Op { .. }));
            rows[fold.table.index()] += ops.count() as u64;
        }
    }
    rows
}

/// The count for one point with the rows of a selection. `per_row` is the result of [`evaluations_per_row`]
/// or [`ops_per_row`].
#[must_use]
pub fn of_selection(per_row: &[u64], selection: &Selection) -> u64 {
    let of = |&table: &Table| {
        // A selection of another function is refused by whoever runs it.
        let each = per_row.get(table.index()).copied().unwrap_or(0);
        if each == 0 { 0 } else { each.saturating_mul(selection.active(table).len() as u64) }
    };
    selection.present().iter().map(of).fold(0, u64::saturating_add)
}

/// The table of each leaf slot, and the slot's position in a row.
fn homes_of_slots(function: &Function) -> HashMap<u32, (Table, usize)> {
    let of_table = |(table, schema): (Table, &'_ crate::function::Schema)| {
        schema.slots.iter().enumerate().map(|(at, &slot)| (slot, (table, at))).collect::<Vec<_>>()
    };
    function.tables.iter().flat_map(of_table).collect()
}

/// The blocks that compute distances. For each: the tables of the enclosing folds, outermost first, and the
/// number of instructions that compute the distance of each slot.
fn distances(function: &Function) -> Vec<(Vec<Table>, BTreeMap<u32, u64>)> {
    let mut found = Vec::new();
    let mut waiting: Vec<(Block, Vec<Table>)> = vec![(function.body, Vec::new())];
    while let Some((block, chain)) = waiting.pop() {
        let mut slots: BTreeMap<u32, u64> = BTreeMap::new();
        for &inst in &function.blocks[block].insts {
            crate::watch::look();
            let data = &function.insts[inst];
            match &data.kind {
                InstKind::Op { .. } => {
                    if let (Some(slot), Part::Distance) = (data.origin.slot(), data.origin.part) {
                        *slots.entry(slot).or_default() += 1;
                    }
                }
                InstKind::Fold(fold) => {
                    waiting.push((fold.body, chain.iter().copied().chain([fold.table]).collect()));
                }
                InstKind::Input(_)
                | InstKind::Constant(_)
                | InstKind::BitsConstant(_)
                | InstKind::Column { .. } => {}
            }
        }
        if !slots.is_empty() {
            found.push((chain, slots));
        }
    }
    found
}

/// The folds around a block. Which rows a fold runs depends only on the current row of its parent, so the
/// folds form a forest. The number of combinations of rows is then a product over siblings of sums over rows.
struct Chain<'a> {
    function: &'a Function,
    tables: &'a Tables,
    /// The tables of the folds, from the outermost; parents come before their children.
    chain: Vec<Table>,
    /// For each fold, by the row of its table: how often the folds below run, all together.
    below: HashMap<Table, Vec<u64>>,
}

impl<'a> Chain<'a> {
    fn new(function: &'a Function, tables: &'a Tables, chain: Vec<Table>) -> Self {
        let mut result = Self { function, tables, chain, below: HashMap::new() };
        for at in (0..result.chain.len()).rev() {
            let table = result.chain[at];
            let rows = 0..tables.tables[table].len();
            let products = rows.map(|row| result.product(Some(table), None, row)).collect();
            result.below.insert(table, products);
        }
        result
    }

    /// How often the block runs.
    fn runs(&self) -> u64 {
        self.product(None, None, 0)
    }

    /// For each row of `table`, how often the block runs with it as the current row. If there is no fold over
    /// `table` around the block, the runs count for the first active row that they serve.
    fn runs_by_row(&self, table: Table) -> Vec<u64> {
        // The tables from the outermost ancestor to this one.
        let mut path = vec![table];
        while let Some(parent) = self.function.tables[path[path.len() - 1]].parent {
            path.push(parent);
        }
        path.reverse();
        let inside = path.iter().take_while(|of| self.chain.contains(of)).count();

        // From the outermost: how often the folds that are no descendants of the current table run, by the
        // row of the current table.
        let mut runs = vec![1_u64];
        for (at, &of) in path[..inside].iter().enumerate() {
            let parent = at.checked_sub(1).map(|at| path[at]);
            let outside: Vec<u64> = (runs.iter().enumerate())
                .map(|(row, &runs)| runs.saturating_mul(self.product(parent, Some(of), row)))
                .collect();
            runs = self.hand_down(of, &outside);
        }
        let last = inside.checked_sub(1).map(|at| path[at]);
        for (row, runs) in runs.iter_mut().enumerate() {
            *runs = runs.saturating_mul(self.product(last, None, row));
        }
        self.first_rows(&path[inside..], runs)
    }

    /// How often the children of `parent`, without `except`, run together while `row` is the current row of
    /// `parent`.
    fn product(&self, parent: Option<Table>, except: Option<Table>, row: usize) -> u64 {
        let children =
            self.chain.iter().filter(|&&of| self.function.tables[of].parent == parent && Some(of) != except);
        children.fold(1, |product: u64, child| {
            let rows = self.tables.tables[*child].range(row).iter();
            product.saturating_mul(
                rows.fold(0, |sum: u64, &row| sum.saturating_add(self.below[child][row as usize])),
            )
        })
    }

    /// Gives each active row the runs of the parent's rows that own it.
    fn hand_down(&self, table: Table, runs: &[u64]) -> Vec<u64> {
        let rows = &self.tables.tables[table];
        let mut result = vec![0_u64; rows.len()];
        for (parent, &runs) in runs.iter().enumerate() {
            for &row in rows.range(parent) {
                result[row as usize] = result[row as usize].saturating_add(runs);
            }
        }
        result
    }

    /// Adds the runs of each row to the first active row that it leads to in the last table of the path.
    fn first_rows(&self, path: &[Table], runs: Vec<u64>) -> Vec<u64> {
        let Some(&last) = path.last() else { return runs };
        let mut first: Vec<Option<u32>> = (0..self.tables.tables[last].len())
            .map(|row| Some(u32::try_from(row).expect("active rows are named by 32 bits")))
            .collect();
        let mut result = vec![0_u64; first.len()];
        for (at, &table) in path.iter().enumerate().rev() {
            let parents = at.checked_sub(1).map_or(runs.len(), |at| self.tables.tables[path[at]].len());
            let rows = &self.tables.tables[table];
            first = (0..parents)
                .map(|parent| rows.range(parent).iter().find_map(|&row| first[row as usize]))
                .collect();
        }
        for (row, runs) in first.into_iter().zip(runs) {
            if let Some(row) = row {
                result[row as usize] = result[row as usize].saturating_add(runs);
            }
        }
        result
    }
}

/// The operand of an op that only counts.
macro_rules! nothing {
    ($arg:ident) => {
        ()
    };
}

macro_rules! counting {
    ($(
        $(#[doc = $doc:literal])*
        $variant:ident $name:ident ( $($arg:ident : $type:ident),+ ) -> $result:ident $(, $flag:ident)*;
    )+) => {
        impl Domain for Counting {
            type Real = ();
            type Mask = ();
            type Bits = ();

            fn constant(&mut self, _value: f32) {}

            fn bits_constant(&mut self, _value: u32) {}

            $(
                fn $name(&mut self, $((): nothing!($arg)),+) {
                    self.add_one(Op::$variant);
                }
            )+
        }
    };
}

crate::for_each_op!(counting);
