//! Recipes: how the rows of a table are filled.
//!
//! The code of a table is emitted once, from its first row. Whatever that code asks of the row is written
//! down as a step on the way: columns and where their numbers come from, and which rows of other tables the
//! row owns. [`rows`](super::rows) takes these steps for every row. So the order and the set of columns are
//! known to the code alone.
//!
//! ```text
//! row of t1: difference { point {..} sum { .. } }      steps of t1
//!
//! place 0   the difference                             Lead      to the operands of 0: they are places 1 and 2
//! place 1   the point                                  Slot      the leaf at 1
//! place 2   the sum                                    Columns   at 1: tx ty tz
//!                                                      Columns   at 1: neg_inv_r2
//!                                                      Rows      of t2: what is at 2, alone
//! ```
//!
//! A step names the parts of a row by their places. The rows of a table have one shape, so the same steps
//! lead to the same places in each.

mod member;

use jbt_ir::Table;

pub(super) use self::member::Member;
use super::instance::{InstanceKind, Scene, children};
use super::names::Hoist;
use super::shape::Shapes;

/// Pushes the numbers of columns, for what stands at their place. Numbers are derived in f64.
pub(super) type ColumnNumbers = Box<dyn Fn(&Scene<'_>, Member, &mut Vec<f64>) + Send + Sync>;

/// What to do for a row.
pub(super) enum RowStep {
    /// More places.
    Lead(Lead),
    /// The next numbers of the row.
    Columns(RowPlace, ColumnNumbers),
    /// The next leaf slot of the row is this leaf.
    Slot(RowPlace),
    /// The row owns rows of a table.
    Rows(Table, Owned),
}

/// What leads to more places of a row.
#[derive(Clone, Copy)]
pub(super) enum Lead {
    /// To what is asked for by what stands there, which is no operator.
    Operands(RowPlace),
    /// To the members of a group of an operator.
    Members(RowPlace, usize),
    /// To what is hoisted to the start of a space: such a row is the only one of its table.
    Hoisted(Hoist),
}

/// Which rows of another table a row owns.
#[derive(Clone, Copy)]
pub(super) enum Owned {
    /// The members of a group of an operator.
    Members(RowPlace, usize),
    /// What stands there, alone.
    Alone(RowPlace),
    /// The pieces of a leaf.
    Pieces(RowPlace),
}

/// A part of a row: 0 is the row itself, the others are numbered as ways lead to them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct RowPlace(usize);

impl RowPlace {
    /// That of the row itself.
    pub(super) const ROW: Self = Self(0);
}

/// What stands at the places of one row.
pub(super) struct RowPlaces(Vec<Member>);

impl RowPlaces {
    /// Of a row.
    pub(super) fn of(member: Member) -> Self {
        Self(vec![member])
    }

    /// Those of another row.
    pub(super) fn begin(&mut self, member: Member) {
        self.0.clear();
        self.0.push(member);
    }

    pub(super) fn at(&self, place: RowPlace) -> Member {
        self.0[place.0]
    }

    /// Finds more places, and says which.
    pub(super) fn lead(
        &mut self,
        way: Lead,
        scene: &Scene<'_>,
        shapes: &Shapes,
    ) -> impl DoubleEndedIterator<Item = RowPlace> + use<> {
        let before = self.0.len();
        match way {
            Lead::Hoisted(hoist) => self.0.push(Member::Hoisted(hoist)),
            Lead::Operands(place) => {
                let kind = &scene.instance(self.at(place).instance()).kind;
                let chosen =
                    if let InstanceKind::Select { chosen, .. } = kind { Some(*chosen) } else { None };
                let asked = |index| chosen.is_none_or(|chosen| chosen == index);
                let operand = |(index, id)| Member::Operand { id, order: 0, asked: asked(index) };
                self.0.extend(children(kind).enumerate().map(operand));
            }
            Lead::Members(place, group) => self.0.extend(self.at(place).members(shapes, group)),
        }
        (before..self.0.len()).map(RowPlace)
    }
}
