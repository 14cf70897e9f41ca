//! Which rows run: for each table a list of active rows, as engines read it.
//!
//! [`Tables`] say which rows a model has; a selection says which of them are run this time. In a part of
//! space most rows add exactly nothing, so a selection for that part leaves them out, and the answers keep
//! their bits.
//!
//! ```text
//!    starts of t1, by the position of its parent's row in the parent's list      active rows of t1
//!    [0, 2, 4]                                                                   [0, 3, 7, 8]
//!     first active row of the parent runs active[0..2]: rows 0 and 3; the second one runs rows 7 and 8
//! ```
//!
//! Starts are kept by *position* and not by row, so that a selection is as long as what it selects, however
//! many rows there are. A table is *present* if it has no parent, or if a row of its parent is active; of the
//! others nothing is kept, and nobody looks at them.
//!
//! Engines follow these lists blindly. So a selection is made in few ways only: from tables
//! ([`Selection::new`]), and from another selection by leaving rows out ([`Selection::narrow`],
//! [`Selection::picked`]), by giving them other indices ([`Selection::shifted`]) or by following tables whose
//! active rows have changed ([`Selection::switched`]). All keep this:
//!
//! * active rows exist in their table, and ascend in the range of one row of the parent;
//! * a table has one start for each active row of its parent (for the one imaginary row, if it has no
//!   parent), from 0, and the end.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, LazyLock};

use smallvec::{SmallVec, smallvec};

use crate::entity::{Entity, Table};
use crate::function::Function;
use crate::table::{TableError, Tables};
use crate::watch;

/// What a selection selects from: the number of rows of each table, and its parent.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Extent {
    counts: Vec<u32>,
    parents: Vec<Option<Table>>,
}

impl Extent {
    /// The extent of tables that fit a function.
    #[must_use]
    pub fn new(function: &Function, tables: &Tables) -> Self {
        let count = |rows: &crate::table::Rows| u32::try_from(rows.len()).expect("rows are named by 32 bits");
        Self {
            counts: tables.tables.values().map(count).collect(),
            parents: function.tables.values().map(|schema| schema.parent).collect(),
        }
    }
}

/// Where the lists of a table are among the words.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct RowSpan {
    /// The first start.
    starts: u32,
    /// The first active row; the starts end here.
    active: u32,
    /// Behind the last active row.
    end: u32,
}

impl RowSpan {
    /// That of a table which is not present: one start, which is the first word, and no rows.
    const ABSENT: Self = Self { starts: 0, active: 1, end: 1 };
}

/// Tables up to which a selection has its lists of tables in itself. There is one for each brick of a mesh,
/// and most models have few tables.
const FEW_TABLES: usize = 4;

/// The active rows of every table. See the module.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Selection {
    extent: Arc<Extent>,
    /// A zero; then for each table that is present its starts, then its active rows.
    words: Vec<u32>,
    /// By table.
    spans: SmallVec<[RowSpan; FEW_TABLES]>,
    /// The tables that are present, ascending.
    present: SmallVec<[Table; FEW_TABLES]>,
}

impl Default for Selection {
    /// No row of no table. It allocates nothing.
    fn default() -> Self {
        static NOTHING: LazyLock<Arc<Extent>> = LazyLock::new(Arc::default);
        let extent = Arc::clone(&NOTHING);
        Self { extent, words: Vec::new(), spans: SmallVec::new(), present: SmallVec::new() }
    }
}

/// Rows of a table whose indices have moved; what stands in their columns stays.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Shift {
    /// The first one.
    pub from: u32,
    /// How far each went. Rows keep their order.
    pub by: i32,
}

/// Selections that [`Selection::narrow`] makes at once: a bit each.
pub const MAX_PARTS: usize = 8;

impl Selection {
    /// All rows that are active in the tables. Panics if the tables do not fit the function
    /// ([`Tables::check`]): machine code trusts selections.
    #[must_use]
    pub fn new(function: &Function, tables: &Tables) -> Self {
        match Self::checked(function, tables) {
            Ok(all) => all,
            Err(error) => panic!("a selection is made from tables that fit: {error}"),
        }
    }

    /// All rows that are active in the tables.
    ///
    /// # Errors
    /// The tables do not fit the function ([`Tables::check`]).
    pub fn checked(function: &Function, tables: &Tables) -> Result<Self, TableError> {
        tables.check(function)?;
        let mut result = Self::default();
        result.clear(&Arc::new(Extent::new(function, tables)));
        // Of each table, the active rows, and a start for each row that may own some.
        let words = tables.tables.values().map(|rows| rows.active.len() + rows.starts.len()).sum();
        watch::take_for(&result.words, words);
        result.words.reserve_exact(words);
        for (table, rows) in tables.tables.iter() {
            let parents = match function.tables[table].parent {
                None => vec![0],
                Some(parent) => result.active(parent).to_vec(),
            };
            let Some(active) = result.begin(table, parents.len()) else { continue };
            let starts = active - parents.len();
            for (position, &parent) in parents.iter().enumerate() {
                result.words.extend_from_slice(rows.range(parent as usize));
                result.words[starts + position] = word(result.words.len() - active);
            }
            result.end(table);
        }
        Ok(result)
    }

    /// Forgets all tables. Memory is kept.
    fn clear(&mut self, extent: &Arc<Extent>) {
        self.extent.clone_from(extent);
        self.words.clear();
        self.words.push(0);
        self.spans.clear();
        self.spans.resize(extent.counts.len(), RowSpan::ABSENT);
        self.present.clear();
    }

    /// Begins the lists of a table under so many active rows: its starts are zeros, and its active rows
    /// follow, from this word on. A table under none is not present.
    fn begin(&mut self, table: Table, parents: usize) -> Option<usize> {
        if parents == 0 {
            return None;
        }
        let starts = self.words.len();
        self.words.resize(starts + parents + 1, 0);
        let active = self.words.len();
        self.spans[table.index()] = RowSpan { starts: word(starts), active: word(active), end: word(active) };
        self.present.push(table);
        Some(active)
    }

    /// Ends the lists of the table that was begun last.
    fn end(&mut self, table: Table) {
        self.spans[table.index()].end = word(self.words.len());
    }

    /// What it selects from.
    #[must_use]
    pub fn extent(&self) -> &Arc<Extent> {
        &self.extent
    }

    /// Whether it selects from rows of this extent.
    #[inline]
    #[must_use]
    pub fn fits(&self, extent: &Arc<Extent>) -> bool {
        Arc::ptr_eq(&self.extent, extent) || self.extent == *extent
    }

    /// Number of tables.
    #[must_use]
    pub fn tables(&self) -> usize {
        self.spans.len()
    }

    /// The tables that have no parent, and those whose parents have active rows, ascending. All others have
    /// no active rows.
    #[inline]
    #[must_use]
    pub fn present(&self) -> &[Table] {
        &self.present
    }

    /// The lists of every table: [`starts`](Self::starts), and [`active`](Self::active) rows.
    pub fn lists(&self) -> impl Iterator<Item = (&[u32], &[u32])> {
        self.spans.iter().map(|span| {
            let [starts, active, end] = [span.starts, span.active, span.end].map(|word| word as usize);
            (&self.words[starts..active], &self.words[active..end])
        })
    }

    /// The active rows of a table, those of all rows of its parent one after the other.
    #[inline]
    #[must_use]
    pub fn active(&self, table: Table) -> &[u32] {
        let span = self.spans[table.index()];
        &self.words[span.active as usize..span.end as usize]
    }

    /// Where the rows of each active row of the parent begin among [`active`](Self::active), and the end.
    #[inline]
    #[must_use]
    pub fn starts(&self, table: Table) -> &[u32] {
        let span = self.spans[table.index()];
        &self.words[span.starts as usize..span.active as usize]
    }

    /// The table whose rows own the rows of a table.
    #[must_use]
    pub fn parent(&self, table: Table) -> Option<Table> {
        self.extent.parents[table.index()]
    }

    /// Active rows of all tables.
    #[must_use]
    pub fn len(&self) -> usize {
        self.present.iter().map(|&table| self.active(table).len()).sum()
    }

    /// The bytes of its lists.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.words) + size_of_val(&*self.spans) + size_of_val(&*self.present)
    }

    /// Whether no table has an active row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Makes shorter selections, at most [`MAX_PARTS`] at once: `masks` has a byte for each active row, in
    /// the order of the tables and of [`active`](Self::active), whose bit `i` keeps the row in `parts[i]`. A
    /// row that hangs under one that is left out goes with it: its bit is cleared.
    ///
    /// What is in `parts` before is forgotten, its memory used again. Panics if there are too many parts or
    /// too few masks.
    pub fn narrow(&self, masks: &mut [u8], parts: &mut [Self]) {
        assert!(parts.len() <= MAX_PARTS, "a bit for each part");
        let counts = counts(masks);
        let starts = self.words.len() - self.len();
        for (part, &count) in parts.iter_mut().zip(&counts) {
            // A start for each row that stays is the most, and all that there are is the most.
            let words = 1 + count + starts.min(count + self.present.len() + 1);
            part.words.clear();
            watch::take_for(&part.words, words);
            part.words.reserve_exact(words);
            part.clear(&self.extent);
            part.present.reserve_exact(self.present.len());
        }
        // Where the masks of each table that is present begin.
        let mut firsts: SmallVec<[usize; FEW_TABLES]> = smallvec![0; self.spans.len()];
        let mut first = 0;
        for &table in &self.present {
            let (before, rest) = masks.split_at_mut(first);
            let mine = &mut rest[..self.active(table).len()];
            let all = [u8::MAX >> (MAX_PARTS - parts.len())];
            let above = match self.parent(table) {
                None => &all[..],
                Some(parent) => &before[firsts[parent.index()]..][..self.active(parent).len()],
            };
            self.narrow_table(table, above, mine, parts);
            firsts[table.index()] = first;
            first += mine.len();
        }
    }

    /// A shorter selection, in a time that goes by the rows that stay and not by those that there are. `pick`
    /// is called for a table that is present and for what one active row of its parent owns: a range of
    /// positions among [`active`](Self::active). It appends the positions that stay, ascending. Rows that
    /// hang under one that is left out go with it.
    ///
    /// Panics if a position is outside of its range, or positions do not ascend.
    #[must_use]
    pub fn picked(&self, mut pick: impl FnMut(Table, Range<u32>, &mut Vec<u32>)) -> Self {
        let mut result = Self::default();
        result.clear(&self.extent);
        // By table, the positions that stay.
        let mut kept: Vec<Vec<u32>> = vec![Vec::new(); self.spans.len()];
        for &table in &self.present {
            let above = self.parent(table).map_or_else(|| vec![0], |parent| kept[parent.index()].clone());
            let Some(first) = result.begin(table, above.len()) else { continue };
            let (starts, active) = (self.starts(table), self.active(table));
            watch::take((above.len() + 2 * active.len()) * size_of::<u32>());
            let mut stay = Vec::new();
            for (next, &owner) in above.iter().enumerate() {
                let (owned, before) = (starts[owner as usize]..starts[owner as usize + 1], stay.len());
                pick(table, owned.clone(), &mut stay);
                let picked = &stay[before..];
                assert!(picked.is_sorted_by(|a, b| a < b), "positions ascend");
                let inside = picked.first().zip(picked.last());
                let inside = inside.is_none_or(|(a, b)| owned.start <= *a && *b < owned.end);
                assert!(inside, "positions are those of one owner");
                result.words[first - above.len() + next] = word(stay.len());
            }
            watch::take_for(&result.words, stay.len());
            result.words.extend(stay.iter().map(|&position| active[position as usize]));
            result.end(table);
            kept[table.index()] = stay;
        }
        result
    }

    /// The same rows in other tables of the same family, where some rows have other indices: for each table,
    /// where they begin to, and by how much. Panics if a row is not there.
    #[must_use]
    pub fn shifted(&self, extent: &Arc<Extent>, shifts: &[Shift]) -> Self {
        assert_eq!(extent.parents, self.extent.parents, "rows stay under their rows");
        watch::take(size_of_val(&*self.words));
        let mut result = Self { extent: Arc::clone(extent), ..self.clone() };
        for ((span, shift), &count) in self.spans.iter().zip(shifts).zip(&extent.counts) {
            for row in &mut result.words[span.active as usize..span.end as usize] {
                if *row >= shift.from {
                    *row = row.wrapping_add_signed(shift.by);
                }
                assert!(*row < count, "the row is in the table");
            }
        }
        result
    }

    /// The same rows after other rows have become active in the tables: a row that is not active any more
    /// goes, and one that was not active before comes, each with all rows under it. Panics if the tables have
    /// other rows than those that this selects from.
    #[must_use]
    pub fn switched(&self, before: &Tables, now: &Tables) -> Self {
        let mut result = Self::default();
        result.clear(&self.extent);
        for (table, rows) in now.tables.iter() {
            assert_eq!(rows.len(), self.extent.counts[table.index()] as usize, "the rows are the same");
            let parents = self.places(&result, table);
            let Some(active) = result.begin(table, parents.len()) else { continue };
            let starts = active - parents.len();
            for (position, (parent, place)) in parents.into_iter().enumerate() {
                let all = rows.range(parent as usize);
                watch::take_for(&result.words, all.len());
                match place {
                    None => result.words.extend_from_slice(all),
                    Some(place) => {
                        let range = &self.starts(table)[place..place + 2];
                        let kept = &self.active(table)[range[0] as usize..range[1] as usize];
                        let earlier = before.tables[table].range(parent as usize);
                        let stays = |row: &&u32| {
                            kept.binary_search(row).is_ok() || earlier.binary_search(row).is_err()
                        };
                        result.words.extend(all.iter().filter(stays));
                    }
                }
                result.words[starts + position] = word(result.words.len() - active);
            }
            let exist = result.words[active..].iter().all(|&row| (row as usize) < rows.len());
            assert!(exist, "active rows are in their table");
            result.end(table);
        }
        result
    }

    /// The active rows of a table's parent in another selection, each with its position here, if it is active
    /// here.
    fn places(&self, other: &Self, table: Table) -> Vec<(u32, Option<usize>)> {
        let Some(parent) = self.extent.parents[table.index()] else { return vec![(0, Some(0))] };
        // Half of a map is empty.
        let [mine, others] = [self, other].map(|selection| selection.active(parent).len());
        watch::take(mine * 2 * size_of::<(u32, usize)>() + others * size_of::<(u32, Option<usize>)>());
        let here: HashMap<u32, usize> =
            self.active(parent).iter().enumerate().map(|(position, &row)| (row, position)).collect();
        other.active(parent).iter().map(|row| (*row, here.get(row).copied())).collect()
    }

    /// The lists of one table. `above` are the masks of the active rows of its parent.
    fn narrow_table(&self, table: Table, above: &[u8], masks: &mut [u8], parts: &mut [Self]) {
        let (starts, active) = (self.starts(table), self.active(table));
        // For each part, where its next start goes, and where its active rows begin. The first start is 0.
        let mut places = [(0, 0); MAX_PARTS];
        let parents = counts(above);
        for ((part, place), &parents) in parts.iter_mut().zip(&mut places).zip(&parents) {
            if let Some(active) = part.begin(table, parents) {
                *place = (active - parents, active);
            }
        }
        for (&above, range) in above.iter().zip(starts.windows(2)) {
            let range = range[0] as usize..range[1] as usize;
            for (&row, mask) in active[range.clone()].iter().zip(&mut masks[range]) {
                *mask &= above;
                for bit in bits(*mask) {
                    parts[bit].words.push(row);
                }
            }
            for bit in bits(above) {
                let (next, first) = &mut places[bit];
                let words = &mut parts[bit].words;
                words[*next] = word(words.len() - *first);
                *next += 1;
            }
        }
        for (part, _) in parts.iter_mut().zip(parents).filter(|&(_, parents)| parents > 0) {
            part.end(table);
        }
    }
}

/// How many of the masks have each bit.
fn counts(masks: &[u8]) -> [usize; MAX_PARTS] {
    let mut counts = [0; MAX_PARTS];
    // A byte for each bit, as long as it cannot overflow.
    for masks in masks.chunks(usize::from(u8::MAX)) {
        let mut bytes = [0_u8; MAX_PARTS];
        for mask in masks {
            for (bit, byte) in bytes.iter_mut().enumerate() {
                *byte += mask >> bit & 1;
            }
        }
        for (count, byte) in counts.iter_mut().zip(bytes) {
            *count += usize::from(byte);
        }
    }
    counts
}

/// The places of the ones in a mask, ascending.
#[inline]
fn bits(mut mask: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (bit < MAX_PARTS).then_some(bit)
    })
}

/// A length as engines read it.
fn word(length: usize) -> u32 {
    u32::try_from(length)
        .expect("a selection has fewer than 2^32 words: limits::MAX_INSTANCES bounds its rows")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entity::Store;
    use crate::function::Schema;
    use crate::table::Rows;

    /// A table of three rows, and one under it: rows 0 and 1, none, rows 2, 3 and 4. Row 3 is not active.
    fn family() -> (Function, Tables) {
        let mut function = Function::new("family", &[]);
        let schema = |parent| Schema { name: "rows".into(), columns: vec![], parent, slots: vec![] };
        let parent = Arc::make_mut(&mut function.tables).push(schema(None));
        Arc::make_mut(&mut function.tables).push(schema(Some(parent)));
        let mut tables = Store::new();
        tables.push(Rows { count: 3, active: vec![0, 1, 2], starts: vec![0, 3], ..Rows::default() });
        tables.push(Rows { count: 5, active: vec![0, 1, 2, 4], starts: vec![0, 2, 2, 4], ..Rows::default() });
        let tables = Tables { tables };
        tables.check(&function).expect("they fit");
        (function, tables)
    }

    #[test]
    fn all_rows_that_are_active() {
        let (function, mut tables) = family();
        let [parent, child] = [0, 1].map(Table::new);
        let all = Selection::new(&function, &tables);
        assert_eq!((all.active(parent), all.starts(parent)), (&[0, 1, 2][..], &[0, 3][..]));
        assert_eq!((all.active(child), all.starts(child)), (&[0, 1, 2, 4][..], &[0, 2, 2, 4][..]));
        assert_eq!(all.len(), 7);
        // The rows under a row that is not active are not there.
        tables.tables[parent].active = vec![1, 2];
        tables.tables[parent].starts = vec![0, 2];
        let some = Selection::new(&function, &tables);
        assert_eq!((some.active(child), some.starts(child)), (&[2, 4][..], &[0, 0, 2][..]));
        assert!(some.fits(all.extent()), "the rows are the same, whichever run");
    }

    #[test]
    fn rows_go_with_the_row_above() {
        let (function, tables) = family();
        let all = Selection::new(&function, &tables);
        let mut parts = vec![Selection::default(), all.clone()];
        // Part 0 keeps the rows 0 and 2 of the parent, part 1 row 1; both would keep all rows below but 4.
        let mut masks = [1, 2, 1, 3, 3, 3, 0];
        all.narrow(&mut masks, &mut parts);
        let [parent, child] = [0, 1].map(Table::new);
        assert_eq!((parts[0].active(parent), parts[0].starts(parent)), (&[0, 2][..], &[0, 2][..]));
        assert_eq!((parts[0].active(child), parts[0].starts(child)), (&[0, 1, 2][..], &[0, 2, 3][..]));
        assert_eq!((parts[1].active(parent), parts[1].starts(parent)), (&[1][..], &[0, 1][..]));
        assert_eq!((parts[1].active(child), parts[1].starts(child)), (&[][..], &[0, 0][..]));
        assert_eq!(masks, [1, 2, 1, 1, 1, 1, 0]);
        // And again from the shorter one.
        let mut again = vec![Selection::default()];
        parts[0].narrow(&mut [0, 1, 1, 1, 1], &mut again);
        assert_eq!((all.present(), again[0].present()), (&[parent, child][..], &[parent, child][..]));
        assert_eq!((again[0].active(child), again[0].starts(child)), (&[2][..], &[0, 1][..]));
        // Under no row there is no table.
        let mut nothing = vec![Selection::default()];
        again[0].narrow(&mut [0, 1], &mut nothing);
        assert_eq!((nothing[0].present(), nothing[0].len()), (&[parent][..], 0));
        assert_eq!((nothing[0].active(child), nothing[0].starts(child)), (&[][..], &[0][..]));
    }

    #[test]
    fn picked_rows_are_those_that_masks_keep() {
        let (function, tables) = family();
        let all = Selection::new(&function, &tables);
        for bits in 0..1_u32 << 7 {
            let mut masks: [u8; 7] = std::array::from_fn(|row| (bits >> row & 1) as u8);
            let picked = all.picked(|table, owned, stay| {
                let first = 3 * table.index() as u32;
                stay.extend(owned.filter(|position| bits >> (first + position) & 1 != 0));
            });
            let mut parts = vec![Selection::default()];
            all.narrow(&mut masks, &mut parts);
            assert_eq!(picked, parts[0], "{bits:b}");
        }
    }

    #[test]
    fn rows_may_have_other_numbers_later() {
        let (function, mut tables) = family();
        let some = Selection::new(&function, &tables);
        let [parent, child] = [0, 1].map(Table::new);
        tables.tables[child].count = 6;
        let extent = Arc::new(Extent::new(&function, &tables));
        let shifts = [Shift::default(), Shift { from: 2, by: 1 }];
        let later = some.shifted(&extent, &shifts);
        assert_eq!((later.active(parent), later.active(child)), (&[0, 1, 2][..], &[0, 1, 3, 5][..]));
        assert_eq!(later.starts(child), some.starts(child));
        assert!(later.fits(&extent) && !some.fits(&extent));
    }

    #[test]
    fn rows_may_become_active_later() {
        let (function, before) = family();
        let [parent, child] = [0, 1].map(Table::new);
        let mut now = before.clone();
        (now.tables[parent].active, now.tables[parent].starts) = (vec![0, 2], vec![0, 2]);
        (now.tables[child].active, now.tables[child].starts) = (vec![0, 1, 3, 4], vec![0, 2, 2, 4]);
        // All rows that were active become all that are.
        let all = Selection::new(&function, &before);
        assert_eq!(all.switched(&before, &now), Selection::new(&function, &now));
        // What had been left out stays so: row 0 of the parent, row 4 of the child.
        let mut part = vec![Selection::default()];
        all.narrow(&mut [0, 1, 1, 1, 1, 1, 0], &mut part);
        let later = part[0].switched(&before, &now);
        assert_eq!((later.active(parent), later.starts(parent)), (&[2][..], &[0, 1][..]));
        assert_eq!((later.active(child), later.starts(child)), (&[3][..], &[0, 1][..]));
        // And back: what comes brings all that is active under it.
        let again = later.switched(&now, &before);
        assert_eq!((again.active(parent), again.starts(parent)), (&[1, 2][..], &[0, 2][..]));
        assert_eq!((again.active(child), again.starts(child)), (&[2][..], &[0, 0, 1][..]));
    }

    #[test]
    fn other_rows_do_not_fit() {
        let (function, mut tables) = family();
        let all = Selection::new(&function, &tables);
        tables.tables[Table::new(1)].count = 6;
        assert!(!all.fits(&Arc::new(Extent::new(&function, &tables))));
    }
}
