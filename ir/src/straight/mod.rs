//! Straight code for tables of few rows: a copy of the body for each row, so that rows share what they have
//! in common.
//!
//! ```text
//! table t0 "scene" (..)                                    table t0 "scene" (.., a, b)      a: number of rows 0 and 1, which
//! table t1 "formula" (number, number)    3 rows                                                is the same; b: of row 0; ..
//!
//! fold t0 guard neutral (..) block1(..):                            fold t0 guard neutral (..) block1(..):
//!     v3 = fold t1 rows neutral (v2) block2(v4):        ──►           v4 = mul v0, a
//!         v5 = column t1.number                                v5 = add v4, b
//!         v6 = mul v0, v5                                      v6 = max v2, v5
//!         ..                                                   ..            row 1 has no `mul` of its own
//! ```
//!
//! A machine-written program of formulas becomes many tables of two or three rows. Its rows share most of
//! their numbers, and so most of their work; but a loop repeats the work for each row. Straight code reads
//! equal numbers from one column, and the builder, which writes no instruction twice, shares the work. The
//! order of all steps stays, and so do the bits.
//!
//! Straight code has a price. Straight rows always run: none can be left out. And the code depends on the
//! number of rows and on which of their numbers are equal, so it fits fewer tables than the original
//! function: see [`Straight::tables`].
//!
//! A pass that adds other steps, such as the gradient, runs before: on straight code its steps would round
//! differently.
//!
//! Rows of primitives stay rows. They seldom share numbers, people edit them, and rows are the unit that is
//! counted and left out.

mod choose;
mod plan;
mod write;

use rustc_hash::FxHashMap as HashMap;

use crate::domain::counting::{of_selection, ops_per_row};
use crate::entity::{Entity, Store, Table};
use crate::function::Function;
use crate::selection::Selection;
use crate::table::{Rows, Tables};

use choose::Chosen;
use plan::{ChosenRow, Copied, Count, Source, Under};
use write::{Writer, Written};

/// Ops of a point beyond which the folds stay: code that long no longer fits into the nearest cache for
/// instructions.
const MAX_OPS: u64 = 1 << 16;
/// Straight code is worth it if it takes at most so much of the ops of the folds.
const WORTH: f64 = 0.95;

/// A function with straight code in place of some folds, and the mapping of tables of the original function
/// to its own tables.
#[derive(Clone, Debug)]
pub struct Straight {
    function: Function,
    /// The row that stays, and all that became straight code. Parents come before their children.
    places: Vec<ChosenRow>,
    /// How many rows have to be where.
    counts: Vec<Count>,
    /// By column of the row that stays: the numbers that it holds, all of them the same.
    columns: Vec<Vec<Source>>,
    /// By table, that of the row that stays left out.
    copies: Vec<Copied>,
}

impl Straight {
    /// Straight code for these tables, if it is worth it: `None` if folds are as good. The tables fit the
    /// function ([`Tables::check`]).
    ///
    /// Time and memory are in proportion to the function and to 2^16 ops.
    #[must_use]
    pub fn new(function: &Function, tables: &Tables) -> Option<Self> {
        Self::if_worth(function, tables, WORTH)
    }

    /// As [`new`](Self::new), with `worth` as the largest part of the folds' ops that straight code may take.
    #[must_use]
    pub fn if_worth(function: &Function, tables: &Tables, worth: f64) -> Option<Self> {
        Self::with_apart(function, tables, worth, &HashMap::default())
    }

    /// Straight code for other tables of the same function. Numbers that have been separated stay separate,
    /// so that a number which changes gets a column of its own.
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
        let Written { function: made, places, counts, columns, copies } =
            Writer::new(function, tables, chosen, apart).run();
        let straight = Self { function: made, places, counts, columns, copies };
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

    /// The tables of [`function`](Self::function) for tables of the original function. `None` if a table that
    /// became straight code has another number of rows now, or if numbers that share a column differ.
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

    /// The row at each place; `None` if a place has another number of rows.
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
            // Counts are sorted by place, and a place's count comes before the places under it.
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

/// The active rows under some rows of the parent, as a table of its own whose rows are all active; and the
/// old numbers of these rows.
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
