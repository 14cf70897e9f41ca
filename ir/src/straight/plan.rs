//! Sources of the numbers of straight code.

use crate::entity::Table;

/// A row that became straight code: the n-th active row of a table under another place. The first place is
/// the row that stays.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct ChosenRow {
    pub(super) parent: usize,
    pub(super) table: Table,
    pub(super) position: usize,
}

/// A place has so many active rows of a table.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Count {
    pub(super) place: usize,
    pub(super) table: Table,
    pub(super) rows: usize,
}

/// A number: a column of the row at a place.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) struct Source {
    pub(super) place: usize,
    pub(super) column: usize,
}

/// A table made of rows of an old one: its active rows under a place, under the rows of a new table, or under
/// no row.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Copied {
    pub(super) table: Table,
    pub(super) under: Under,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Under {
    /// Under no row.
    Nothing,
    Place(usize),
    Table(Table),
}
