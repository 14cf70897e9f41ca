//! The numbers of a program: rows of tables, which of them are active, and which tree nodes they stand for.
//!
//! A function is the *shape* of a model, [`Tables`] are its *numbers*. Nobody writes into bound tables: an
//! edited model is lowered again, and if its function is equal, the present code gets the new tables.
//!
//! ```text
//!    starts of t1 (one per row of its parent, and the end)     active rows of t1      numbers of t1
//!    [0, 2, 2, 5]                                              [0, 3, 4, 7, 8]        row-major, `stride` numbers a row
//!     parent row 0 runs active[0..2]: rows 0 and 3; parent row 1 runs none; parent row 2 runs rows 4, 7 and 8
//! ```

use crate::entity::{Store, Table};
use crate::function::{Function, Schema};

/// The rows of one table.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Rows {
    /// Number of rows, active or not.
    pub count: usize,
    /// Numbers per row; a row that only owns rows of other tables has none.
    pub stride: usize,
    /// All rows, one after the other.
    pub numbers: Vec<f32>,
    /// The active rows, ascending within the range of one parent row.
    pub active: Vec<u32>,
    /// Where the active rows of each parent row begin in `active`, and after the last one the end. A table
    /// without parent has one imaginary parent row.
    pub starts: Vec<u32>,
    /// The tree node behind each leaf slot of each row: row-major, [`Schema::slots`] per row.
    pub nodes: Vec<u32>,
}

impl Rows {
    /// Number of rows, active or not.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers of a row.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, row: usize) -> &[f32] {
        &self.numbers[row * self.stride..][..self.stride]
    }

    /// The active rows that a row of the parent owns.
    #[inline(always)]
    #[must_use]
    pub fn range(&self, parent_row: usize) -> &[u32] {
        &self.active[self.starts[parent_row] as usize..self.starts[parent_row + 1] as usize]
    }
}

/// Why tables do not fit a function.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{table}: {problem}")]
pub struct TableError {
    /// The table at fault.
    pub table: Table,
    /// What is wrong with it.
    pub problem: &'static str,
}

/// The rows of all tables of a function.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Tables {
    /// Rows by table.
    pub tables: Store<Table, Rows>,
}

impl Tables {
    /// Checks that these rows fit the function's schemas: every index that an engine will follow is in range.
    ///
    /// # Errors
    /// The first table that does not fit.
    pub fn check(&self, function: &Function) -> Result<(), TableError> {
        let fail = |table, problem| Err(TableError { table, problem });
        if self.tables.len() != function.tables.len() {
            return fail(self.tables.next_key(), "the function has another number of tables");
        }
        for (table, rows) in self.tables.iter() {
            let schema: &Schema = &function.tables[table];
            let parents = schema.parent.map_or(1, |parent| self.tables[parent].len());
            if rows.stride != schema.columns.len() {
                return fail(table, "its rows have another number of columns than the schema");
            }
            if rows.count.checked_mul(rows.stride) != Some(rows.numbers.len()) {
                return fail(table, "it needs as many numbers as its rows have columns");
            }
            if rows.count.checked_mul(schema.slots.len()) != Some(rows.nodes.len()) {
                return fail(table, "each row needs one tree node for each leaf slot");
            }
            if rows.starts.len() != parents + 1 || rows.starts[0] != 0 {
                return fail(table, "it needs one start for each row of its parent, from 0, and the end");
            }
            if !rows.starts.is_sorted()
                || rows.starts.last().copied() != u32::try_from(rows.active.len()).ok()
            {
                return fail(table, "its starts must ascend to the number of active rows");
            }
            if rows.active.iter().any(|&row| row as usize >= rows.len()) {
                return fail(table, "an active row does not exist");
            }
            if (0..parents).any(|parent| !rows.range(parent).is_sorted_by(|a, b| a < b)) {
                return fail(table, "active rows must ascend within a parent row");
            }
        }
        Ok(())
    }
}
