//! Where two models of one shape differ: in the supports of the rows that changed.
//!
//! ```text
//! row changed           its support, before and now
//!   in an inner space   that of the row above, in the world
//!   of the scene        everywhere
//! row put in, taken out the rows before and behind are as they were: their numbers shift
//! ```

use std::ops::Range;
use std::sync::Arc;

use jbt_frontend::lower::guide::SpaceGuide;
use jbt_ir::selection::Shift;
use jbt_ir::{Entity, Rows, Table};

use super::{Pruner, Region};
use crate::divide::Edit;

/// What became of the rows of a table.
struct Change {
    /// Rows that are not as they were, or are not there any more.
    before: Range<usize>,
    /// Rows that are not as they were, or were not there.
    now: Range<usize>,
}

impl Change {
    fn new(before: &Rows, now: &Rows) -> Self {
        let alike = |a: usize, b: usize| {
            let bits =
                |row: &[f32], other: &[f32]| row.iter().zip(other).all(|(a, b)| a.to_bits() == b.to_bits());
            bits(before.row(a), now.row(b))
        };
        let shorter = before.len().min(now.len());
        let first = (0..shorter).take_while(|&row| alike(row, row)).count();
        let last = (first..shorter).take_while(|row| {
            let back = row - first + 1;
            alike(before.len() - back, now.len() - back)
        });
        let last = last.count();
        Self { before: first..before.len() - last, now: first..now.len() - last }
    }

    fn is_nothing(&self) -> bool {
        self.before.is_empty() && self.now.is_empty()
    }

    /// The shift of the rows behind.
    fn shift(&self) -> Shift {
        // Row numbers are below 2^31: limits::MAX_OCCURRENCES.
        Shift { from: self.before.end as u32, by: self.now.end as i32 - self.before.end as i32 }
    }
}

impl Pruner {
    /// Where the field of this model may differ from that of an earlier one. Attributes do not count.
    ///
    /// Cost: a comparison of all numbers.
    #[must_use]
    pub fn edit(&self, before: &Self) -> Edit {
        if !Arc::ptr_eq(&self.kernel.kernel, &before.kernel.kernel) {
            return Edit::Everywhere;
        }
        let mut boxes = Vec::new();
        for table in self.tables().tables.keys() {
            let [old, new] = [before, self].map(|pruner| &pruner.tables().tables[table]);
            let change = Change::new(old, new);
            let same_rows = old.active == new.active && old.starts == new.starts;
            if change.is_nothing() && same_rows {
                continue;
            }
            if !same_rows && !self.may_shift(table) {
                return Edit::Everywhere;
            }
            // Where as many rows are as before, those between the first and the last change may be as they were.
            let in_place = change.before == change.now;
            let changed = |row: &usize| !in_place || !same_numbers(old, new, *row);
            for (pruner, rows) in [(before, change.before.clone()), (self, change.now.clone())] {
                for row in rows.filter(changed) {
                    match pruner.reach_of(table, row) {
                        Some(bounds) => boxes.push(bounds),
                        None => return Edit::Everywhere,
                    }
                }
            }
        }
        Edit::Boxes(boxes)
    }

    /// A region of an earlier model as it is now: for a box that [`edit`](Self::edit) does not touch.
    #[must_use]
    pub fn renewed(&self, before: &Self, region: &Region) -> Region {
        if region.selection.fits(self.extent()) {
            return region.clone();
        }
        let shift =
            |table: Table| Change::new(&before.tables().tables[table], &self.tables().tables[table]).shift();
        let shifts: Vec<Shift> = self.tables().tables.keys().map(shift).collect();
        let selection = Arc::new(region.selection.shifted(self.extent(), &shifts));
        Region { bounds: region.bounds, selection }
    }

    /// Whether rows of a table may come and go without anything else being moved: all run, no table hangs under them, and they hang under single rows.
    fn may_shift(&self, table: Table) -> bool {
        let function = self.kernel.kernel.function.function();
        let tables = &self.tables().tables;
        let has_children = function.tables.values().any(|schema| schema.parent == Some(table));
        let mut above = function.tables[table].parent;
        while let Some(parent) = above {
            if tables[parent].len() != 1 {
                return false;
            }
            above = function.tables[parent].parent;
        }
        !has_children && tables[table].active.len() == tables[table].len()
    }

    /// A box of the world outside of which a row adds nothing; `None` if there is none.
    fn reach_of(&self, mut table: Table, mut row: usize) -> Option<crate::region::Box3> {
        let function = self.kernel.kernel.function.function();
        loop {
            let guide = &self.guide.tables[table];
            if let (SpaceGuide::World, Some(supports)) = (&guide.space, &self.supports[table.index()]) {
                return Some(supports.bounds(row));
            }
            let starts = &self.tables().tables[table].starts;
            // The row above that owns this one. Rows are owned in order.
            row = starts.partition_point(|&start| start as usize <= row) - 1;
            table = function.tables[table].parent?;
        }
    }
}

fn same_numbers(before: &Rows, now: &Rows, row: usize) -> bool {
    before.row(row).iter().zip(now.row(row)).all(|(a, b)| a.to_bits() == b.to_bits())
}
