//! Where two models of one shape may differ: in the supports of the changed rows.
//!
//! ```text
//! row changed           its support, before and now
//!   in an inner space   that of the row above, in the world
//!   of the scene        everywhere
//! row put in, taken out the rows before and behind are as they were: their numbers shift
//! row now active, or no more: a selector has chosen another child, and this is that child, before or now
//! ```

use std::ops::Range;
use std::sync::Arc;

use jbt_ir::selection::Shift;
use jbt_ir::{Rows, Table, Tables, watch};
use jbt_lower::prune_info::{Rule, Support, SupportSpace};

use super::cull::around;
use super::{Pruner, Region};
use crate::boxes::{Box3, Divisible};
use crate::divide::Edit;

/// The changed rows of a table.
struct Change {
    /// Old rows that were changed or removed.
    before: Range<usize>,
    /// New rows that were changed or inserted.
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

    /// The shift of the unchanged rows after the change.
    fn shift(&self) -> Shift {
        // Row numbers are below 2^31: limits::MAX_INSTANCES.
        Shift { from: self.before.end as u32, by: self.now.end as i32 - self.before.end as i32 }
    }
}

impl Pruner {
    /// Where the field of this model may differ from that of an earlier one. Attributes do not count.
    ///
    /// Cost: a comparison of all numbers.
    #[must_use]
    pub fn edit(&self, before: &Self) -> Edit {
        self.edit_of(before, [before.tables(), self.tables()])
    }

    /// As [`edit`](Self::edit), by the numbers of another program of the two models, before and now. Rows are
    /// the same in all of them, so where a row reaches is known; numbers of attributes are in some alone.
    pub(crate) fn edit_of(&self, before: &Self, [old, new]: [&Tables; 2]) -> Edit {
        if !Arc::ptr_eq(&self.program.bound.kernel, &before.program.bound.kernel)
            || self.origin() != before.origin()
        {
            return Edit::Everywhere;
        }
        // Active rows are compared by number, and numbers change where rows are inserted or removed.
        if self.is_switched(before) && !before.program.bound.all().fits(self.extent()) {
            return Edit::Everywhere;
        }
        let mut boxes = Vec::new();
        let both = |table: Table| [&old.tables[table], &new.tables[table]];
        let bounded = |table: Table| self.edit_table(before, both(table), table, &mut boxes).is_some();
        if self.tables().tables.keys().all(bounded) { Edit::Boxes(boxes) } else { Edit::Everywhere }
    }

    /// Adds the boxes in which rows of a table may change the field; `None` if these boxes are unknown.
    fn edit_table(
        &self,
        before: &Self,
        [old, new]: [&Rows; 2],
        table: Table,
        boxes: &mut Vec<Box3>,
    ) -> Option<()> {
        if old.active != new.active || old.starts != new.starts {
            if old.len() == new.len() {
                self.edit_choice(before, table, boxes)?;
            } else if !(before.may_shift(table) && self.may_shift(table)) {
                return None;
            }
        }
        let change = Change::new(old, new);
        // If the number of rows is the same, rows between the first and the last change may be unchanged.
        let in_place = change.before == change.now;
        let changed = |row: &usize| !in_place || !same_numbers(old, new, *row);
        for (pruner, rows) in [(before, change.before.clone()), (self, change.now)] {
            for row in rows.filter(changed).filter(|&row| pruner.runs(table, row)) {
                watch::take_for(boxes, 1);
                boxes.push(pruner.reach_of(table, row)?);
            }
        }
        Some(())
    }

    /// Adds the boxes in which the choice of active rows of a table changes the field. Hoisted instructions
    /// need none: they begin or cease to matter only if some selector has chosen another child as well.
    fn edit_choice(&self, before: &Self, table: Table, boxes: &mut Vec<Box3>) -> Option<()> {
        if !(before.has_single_rows(table) && self.has_single_rows(table)) {
            return None;
        }
        if self.program.info.tables[table].is_hoisted {
            return Some(());
        }
        for row in 0..self.tables().tables[table].len() {
            watch::take_for(boxes, 1);
            match [before, self].map(|pruner| pruner.is_active(table, row)) {
                [true, false] => boxes.push(before.reach_of(table, row)?),
                [false, true] => boxes.push(self.reach_of(table, row)?),
                [true, true] | [false, false] => {}
            }
        }
        Some(())
    }

    /// Whether the active rows of any table differ.
    fn is_switched(&self, before: &Self) -> bool {
        let tables = before.tables().tables.values().zip(self.tables().tables.values());
        let mut same_length = tables.filter(|(old, new)| old.len() == new.len());
        same_length.any(|(old, new)| old.active != new.active)
    }

    /// An earlier model's region for this model: for a box that [`edit`](Self::edit) does not touch.
    #[must_use]
    pub fn renewed(&self, before: &Self, region: &Region) -> Region {
        if region.selection.fits(self.extent()) {
            return if self.is_switched(before) { self.switched(before, region) } else { region.clone() };
        }
        let shift =
            |table: Table| Change::new(&before.tables().tables[table], &self.tables().tables[table]).shift();
        let shifts: Vec<Shift> = self.tables().tables.keys().map(shift).collect();
        let selection = Arc::new(region.selection.shifted(self.extent(), &shifts));
        Region { bounds: region.bounds, selection }
    }

    /// An earlier model's region with this model's active rows.
    fn switched(&self, before: &Self, region: &Region) -> Region {
        let selection = Arc::new(region.selection.switched(before.tables(), self.tables()));
        let switched = Region { bounds: region.bounds, selection };
        // A newly chosen child brings all its rows; most do not matter here. If the ranges cannot be
        // computed, all of them stay.
        let mut parts = Vec::with_capacity(1);
        match self.narrow(&switched, &[region.bounds], &mut parts) {
            Ok(()) => parts.pop().unwrap_or(switched),
            Err(_) => switched,
        }
    }

    /// Whether rows of a table may be inserted and removed without a change elsewhere: zero rows may be left
    /// out, all rows are active, the table has no child tables, and its parents have single rows.
    fn may_shift(&self, table: Table) -> bool {
        let function = self.program.bound.kernel.function.function();
        let tables = &self.tables().tables;
        let has_children = function.tables.values().any(|schema| schema.parent == Some(table));
        let mut above = function.tables[table].parent;
        while let Some(parent) = above {
            if tables[parent].len() != 1 {
                return false;
            }
            above = function.tables[parent].parent;
        }
        let neutral = self.program.info.tables[table].rule == Rule::Neutral;
        neutral && !has_children && tables[table].active.len() == tables[table].len()
    }

    /// A box of the world outside of which a row adds nothing; `None` if no such box is known.
    fn reach_of(&self, mut table: Table, mut row: usize) -> Option<Box3> {
        loop {
            let above = self.above(table, row)?;
            let info = &self.program.info.tables[table];
            let support = info.supports[row];
            if info.space == SupportSpace::World && support != Support::EVERYWHERE {
                return Some(around(&support));
            }
            (table, row) = above;
        }
    }

    /// The row that owns this row; `None` for the row of the scene.
    fn above(&self, table: Table, row: usize) -> Option<(Table, usize)> {
        let parent = self.program.bound.kernel.function.function().tables[table].parent?;
        if self.has_single_rows(table) {
            return Some((parent, row));
        }
        // In tables with several rows for one owner all rows are active. Owned rows are in the order of their
        // owners.
        let starts = &self.tables().tables[table].starts;
        Some((parent, starts.partition_point(|&start| start as usize <= row) - 1))
    }

    /// Whether each row of the parent table owns one row of this table. This holds for tables of guards and
    /// selectors, and only they have inactive rows.
    fn has_single_rows(&self, table: Table) -> bool {
        let tables = &self.tables().tables;
        let parent = self.program.bound.kernel.function.function().tables[table].parent;
        tables[table].len() == parent.map_or(1, |parent| tables[parent].len())
    }

    fn is_active(&self, table: Table, row: usize) -> bool {
        // Row numbers are below 2^31: limits::MAX_INSTANCES.
        !self.has_single_rows(table)
            || self.tables().tables[table].active.binary_search(&(row as u32)).is_ok()
    }

    /// Whether a row and all rows above it are active.
    fn runs(&self, mut table: Table, mut row: usize) -> bool {
        while self.is_active(table, row) {
            match self.above(table, row) {
                Some(above) => (table, row) = above,
                None => return true,
            }
        }
        false
    }
}

fn same_numbers(before: &Rows, now: &Rows, row: usize) -> bool {
    before.row(row).iter().zip(now.row(row)).all(|(a, b)| a.to_bits() == b.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiler::Compiler;
    use crate::kernel::Engine;
    use jbt_model::builder::{point, polyline};
    use jbt_model::model::Model;
    use jbt_model::tree::Tree;

    #[test]
    fn rows_of_owners_that_come_and_go_are_everywhere() {
        let line = |count: u32| polyline((0..count).map(|x| [f64::from(x), 0.0, 0.0]), 1.0);
        let model = |lines: &[u32]| {
            let lines = lines.iter().map(|&count| line(count)).chain([point([9.0, 0.0, 0.0], 1.0)]);
            Model::new(Tree::sum(lines)).check().expect("a good model")
        };
        let few = Pruner::new(&Compiler::for_engine(Engine::Lanes), &model(&[3])).expect("it compiles");
        let more = few.updated(&model(&[3, 4])).expect("it compiles");
        assert!(Arc::ptr_eq(&few.program.bound.kernel, &more.program.bound.kernel), "one program");
        assert_eq!(more.edit(&few), Edit::Everywhere);
        assert_eq!(few.edit(&more), Edit::Everywhere);
    }
}
