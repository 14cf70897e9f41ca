//! What the one side of a difference means to the rows of the other: `min(a, max(0, 2 iso - b))`, a the left
//! side, b what is subtracted.
//!
//! ```text
//! most            a bound of the difference from above, in a box
//! b is a union    a row goes if most < max(0, 2 iso - high): where it is the largest, a decides
//! b intersection  all rows but one go, if that one has most < max(0, 2 iso - high): then a decides everywhere
//! a is a union    all rows but one go, if that one has low > most: then b cuts everywhere
//! a intersection  a row goes if low > most: where it is the smallest, b cuts
//! ```
//!
//! What is left of also needs `most < 2 iso`. Then what cuts is there, with a field above 0, so it gives the
//! attributes too; and what is left of is still above it. A union that begins at 0 needs no row to stand for
//! the `2 iso` of what is not there; one that begins at the lowest field is cut by more than that. Both sides
//! may leave out rows in one box: `most` comes either from a, and then those of b that go never cut, or from
//! b, and then those of b that go are never the largest.

use jbt_ir::{Entity as _, Selection, Table, watch};
use jbt_lower::prune_info::{ContestDifference, DifferenceSide, RowContest};
use jbt_model::combine::Extreme;
use rustc_hash::FxHashMap as HashMap;

use super::lanes::{MetRow, RowInBox, RowRanges};
use super::ranges::ProbeRanges;
use crate::boxes::Box3;
use crate::error::EvalError;

/// The complement of a field, as the program computes it.
pub(super) fn cut(iso2: f32, field: f32) -> f32 {
    (iso2 - field).max(0.0)
}

/// The bounds of a difference, for the rows of a contest that is a side of it.
pub(super) struct DifferenceLimit<'a> {
    difference: ContestDifference,
    extreme: Extreme,
    iso2: f32,
    selection: &'a Selection,
    firsts: &'a [usize],
    /// The table whose rows own those of the contest.
    owners: Option<Table>,
    /// By part and owner.
    most: HashMap<(u8, u32), f32>,
}

impl<'a> DifferenceLimit<'a> {
    pub(super) fn new(
        (contest, difference, iso2): (&RowContest, ContestDifference, f32),
        selection: &'a Selection,
        firsts: &'a [usize],
    ) -> Self {
        let rows = contest.groups.iter().find(|group| group.rows);
        let owners = rows.and_then(|group| selection.parent(group.table));
        let (extreme, most) = (contest.extreme, HashMap::default());
        Self { difference, extreme, iso2, selection, firsts, owners, most }
    }

    /// The position of the row above an owner in the table of the difference.
    fn above(&self, owner: u32) -> Option<u32> {
        let (mut table, mut position) = (self.owners?, owner);
        while table != self.difference.other.table {
            let starts = self.selection.starts(table);
            position = starts.partition_point(|&start| start <= position) as u32 - 1;
            table = self.selection.parent(table)?;
        }
        Some(position)
    }

    /// Finds the bounds for the rows of the contest: by the probe of the difference, or by a run of the other
    /// side's rows. Returns how many ranges of distances that took.
    pub(super) fn find<'b>(
        &mut self,
        (rows, boxes): (&[RowInBox], &[Box3]),
        probes: Option<ProbeRanges<'_>>,
        ranges: impl FnOnce() -> Option<&'b RowRanges>,
    ) -> Result<u64, EvalError> {
        // Lists and maps of who is asked, at most one for each row; half of a map is empty.
        watch::take(rows.len() * (size_of::<RowInBox>() + 6 * size_of::<((u8, u32), usize)>()));
        let mut asked: Vec<(u8, u32)> = rows.iter().map(|row| (row.part, row.owner)).collect();
        asked.sort_unstable();
        asked.dedup();
        if let Some((probes, node)) = probes.zip(self.difference.node) {
            self.most = asked.into_iter().map(|key| (key, probes.range(node, key.0.into())[1])).collect();
            return Ok(0);
        }
        let Some(ranges) = ranges() else { return Ok(0) };
        let table = self.difference.other.table;
        let (active, first) = (self.selection.active(table), self.firsts[table.index()]);
        let mut wanted: Vec<RowInBox> = Vec::new();
        let mut lanes: HashMap<(u8, u32), usize> = HashMap::default();
        let mut lane_of: Vec<((u8, u32), usize)> = Vec::with_capacity(asked.len());
        for key in asked {
            let Some(position) = self.above(key.1) else { return Ok(0) };
            let lane = *lanes.entry((key.0, position)).or_insert_with(|| {
                let (row, place) = (active[position as usize], first as u32 + position);
                wanted.push(RowInBox { row, place, owner: position, part: key.0, stays: true });
                wanted.len() - 1
            });
            lane_of.push((key, lane));
        }
        let mut found = Vec::with_capacity(wanted.len());
        ranges.find(&wanted, boxes, &mut |_, range| found.push(range))?;
        let iso2 = self.iso2;
        let most = |[low, high]: [f32; 2]| match self.difference.side {
            DifferenceSide::Left => cut(iso2, low),
            DifferenceSide::Right => high,
        };
        self.most = lane_of.into_iter().map(|(key, lane)| (key, most(found[lane]))).collect();
        Ok(ranges.distances() * wanted.len() as u64)
    }

    /// The rows that go, of those of one owner in a box.
    pub(super) fn beyond<'b>(&self, rows: &'b [MetRow]) -> impl Iterator<Item = &'b MetRow> + use<'b> {
        let entry = rows[0].entry;
        let most = self.most.get(&(entry.part, entry.owner)).copied().unwrap_or(f32::INFINITY);
        let (iso2, side, extreme) = (self.iso2, self.difference.side, self.extreme);
        let leader =
            (0..rows.len()).reduce(|best, index| if rows[index].low > rows[best].low { index } else { best });
        let ahead = leader.map_or(f32::NEG_INFINITY, |leader| rows[leader].low);
        let (cuts_all, cuts_nothing) = (most < iso2 && ahead > most, most < cut(iso2, -ahead));
        // Comparisons with NaN are false, so a row with an unknown range stays.
        rows.iter()
            .enumerate()
            .filter(move |&(index, row)| match (side, extreme) {
                (DifferenceSide::Right, Extreme::Largest) => most < cut(iso2, row.high),
                (DifferenceSide::Left, Extreme::Largest) => cuts_all && Some(index) != leader,
                // Ranges are those of negative fields.
                (DifferenceSide::Left, Extreme::Smallest) => most < iso2 && -row.high > most,
                (DifferenceSide::Right, Extreme::Smallest) => cuts_nothing && Some(index) != leader,
            })
            .map(|(_, row)| row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jbt_lower::prune_info::ContestGroup;

    /// The rows that go where the difference is at most 0.5; iso2 is 1.
    fn beyond_of(side: DifferenceSide, extreme: Extreme, ranges: &[[f32; 2]]) -> Vec<u32> {
        let other = ContestGroup { table: Table::new(0), field: jbt_ir::Value::new(0), rows: false };
        let limit = DifferenceLimit {
            difference: ContestDifference { side, other, node: None },
            extreme,
            iso2: 1.0,
            selection: &Selection::default(),
            firsts: &[],
            owners: None,
            most: [((0, 0), 0.5)].into_iter().collect(),
        };
        let met = |(place, &[low, high]): (u32, &[f32; 2])| {
            let entry = RowInBox { row: place, place, owner: 0, part: 0, stays: false };
            MetRow { entry, group: 0, low, high }
        };
        let rows: Vec<MetRow> = (0..).zip(ranges).map(met).collect();
        limit.beyond(&rows).map(|met| met.entry.place).collect()
    }

    #[test]
    fn rows_beyond_the_difference_go() {
        use DifferenceSide::{Left, Right};
        use Extreme::{Largest, Smallest};
        let nobody: [u32; 0] = [];
        // What is cut by less than the difference has left cuts nothing.
        assert_eq!(beyond_of(Right, Largest, &[[0.0, 0.25], [0.0, 0.5], [0.0, 0.75]]), [0]);
        // One that is above the difference everywhere stands for all.
        assert_eq!(beyond_of(Left, Largest, &[[0.25, 2.0], [0.75, 1.0], [0.5, 1.0]]), [0, 2]);
        assert_eq!(beyond_of(Left, Largest, &[[0.25, 2.0], [0.5, 1.0]]), nobody);
        // Ranges are those of negative fields.
        assert_eq!(beyond_of(Left, Smallest, &[[-2.0, -0.75], [-2.0, -0.5], [-2.0, -0.25]]), [0]);
        assert_eq!(beyond_of(Right, Smallest, &[[-0.25, 0.0], [-0.75, -0.5]]), [1]);
        assert_eq!(beyond_of(Right, Smallest, &[[-0.5, 0.0], [-0.75, -0.5]]), nobody);
    }

    #[test]
    fn what_is_cut_is_no_less_than_nothing() {
        assert_eq!([cut(1.0, 0.25), cut(1.0, 1.0), cut(1.0, 3.0), cut(1.0, -1.0)], [0.75, 0.0, 0.0, 2.0]);
    }
}
