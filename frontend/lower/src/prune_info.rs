//! What pruning has to know of a model besides its program.
//!
//! A row may be left out of the active rows in a box of space where that changes no bit of any answer. There
//! are two reasons:
//!
//! ```text
//! it is zero there     its support misses the box, and the table's rule lets zero rows go
//! it does not decide   it is the one row of a guard, and the ranges of two fields in the box say that another operand is strictly ahead
//! ```
//!
//! Supports and rules are here. The ranges come out of the *range function*: the model's field followed by
//! probes, over the same tables; run with intervals, it gives the ranges of them all over a box. A *probe* is
//! a number inside the program that pruning has to know: the field of an operand or operator, or a coordinate
//! of the point inside of a warp.
//!
//! A *guard* is a fold over one row around an operand that has tables of its own. Where the row is left out,
//! the operand's field is what the fold starts with: 0, or the lowest or highest number where that never
//! decides.

pub use jbt_ir::Rule;
use std::sync::Arc;

use jbt_ir::{Function, Store, Table, Tables, Value};

use jbt_model::bounds::Bounds;
use jbt_model::check::NodeId;
use jbt_model::combine::Extreme;

/// Supports say nothing about points with a coordinate beyond this, in magnitude: 2^20.
pub const LARGEST_COORDINATE: f32 = 1_048_576.0;

/// What there is to know about the tables of a model. It fits the programs of all queries, which have the
/// same tables.
#[derive(Clone, PartialEq, Debug)]
pub struct PruneInfo {
    /// By table.
    pub tables: Store<Table, TablePruneInfo>,
    /// How many probes the range function has, behind the field.
    pub probes: usize,
    /// What may be left out because it does not decide. Operators come after their operands.
    pub decisions: Vec<Decision>,
    /// Rows of which one wins. Operators come after their operands.
    pub contests: Vec<RowContest>,
    /// Twice the iso-value, as the program has it, for complements (`2 iso - field`): see [`DecisionKind`].
    pub iso2: f32,
}

/// What there is to know about the rows of a table.
#[derive(Clone, PartialEq, Debug)]
pub struct TablePruneInfo {
    /// Which coordinates the supports are in.
    pub space: SupportSpace,
    /// Of each row, where its field may be something else than zero.
    pub supports: Arc<Vec<Support>>,
    /// What may be done with rows that are zero.
    pub rule: Rule,
    /// Of each row, the tree node whose field it computes: a leaf (for each of its pieces too), an operator,
    /// a selector, or a warp.
    pub nodes: Vec<NodeId>,
    /// Whether its row is computed for rows of other tables, and seen by these alone: a field, an answer, or
    /// the point inside of a warp, which several share.
    pub is_hoisted: bool,
}

/// The space in which the fold over a table stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SupportSpace {
    /// The world: supports are compared with the box itself.
    World,
    /// The inside of a warp, whose point has the ranges of this probe and the two after it. They mean nothing
    /// where the probe's value does not count: when a guard around the warp has been left out, and then so
    /// have the rows.
    Probed(usize),
    /// The insides of several warps: rows are not left out by their supports.
    Unknown,
}

/// What may be left out where it does not decide. It is told by the ranges of two probes over a box.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Decision {
    /// The guard, a table of one row; or operands that are rows, which are left out together. One by one, a
    /// [`RowContest`] leaves them out.
    pub table: Table,
    /// The probe of the operand's field: where operands are rows, of the largest or smallest among those that
    /// run.
    pub operand: usize,
    /// The probe of the operator's field.
    pub node: usize,
    /// When the operand does not decide.
    pub kind: DecisionKind,
}

/// Operands of one operator, of which one wins at each point: rows that win nowhere in a box may be left out
/// there, because no bit of an answer comes from them.
#[derive(Clone, PartialEq, Debug)]
pub struct RowContest {
    /// Which of the fields wins; of equal ones in one table, that of the first row.
    pub extreme: Extreme,
    /// Who wins.
    pub kind: ContestKind,
    /// The operands, all of which hang under one table.
    pub groups: Vec<ContestGroup>,
    /// The probe of the operator's field, if there is one.
    pub node: Option<usize>,
    /// If the operator is a side of a difference: the rest of that.
    pub difference: Option<ContestDifference>,
}

/// The difference of which the operator of a [`RowContest`] is a side. Where the field of the difference is
/// known to come from the other side, operands matter less.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ContestDifference {
    /// Which side.
    pub side: DifferenceSide,
    /// The other side. Its table is above those of the contest.
    pub other: ContestGroup,
    /// The probe of the field of the difference, if there is one.
    pub node: Option<usize>,
}

/// A side of a difference.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DifferenceSide {
    /// What is left of.
    Left,
    /// The union of what is subtracted.
    Right,
}

/// Who wins a [`RowContest`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum ContestKind {
    /// The extreme of all fields and of this number, if there is one: for a union without negative operands
    /// it is 0.
    All(Option<f32>),
    /// Of each operand and the result so far the extreme, if they are apart by this column of the operator's
    /// row. The result is the extreme of all, or beyond it by less than that column. Groups are in the order
    /// of operands.
    Steps(Table, usize, StepFields),
}

/// What of operands the steps of a [`RowContest`] take.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StepFields {
    /// Their fields.
    Plain,
    /// The field of the first, of the others the complement: `max(0, iso2 - field)`.
    Complements,
}

/// Operands of a [`RowContest`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ContestGroup {
    /// The table.
    pub table: Table,
    /// The field of a row, in the body of the fold over the table in the range function.
    pub field: Value,
    /// Whether the rows are operands. If not, the operand is part of the operator's row, whose table this is,
    /// and stays.
    pub rows: bool,
}

/// When an operand does not decide. `iso2` is [`PruneInfo::iso2`].
///
/// If the guard itself, or one around it, has been left out already, the probes mean nothing, and there is
/// nothing to decide.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DecisionKind {
    /// `operand.high < node.low`.
    UnionOperand,
    /// `operand.low > node.high`.
    IntersectionOperand,
    /// `operand.low > node.high && node.high < iso2`. The second part says that what is subtracted is there,
    /// so that it gives the attributes too.
    DifferenceLeft,
    /// `node.high < min(max(iso2 - operand.high, 0), iso2)`, in f32 as the program computes it, where the
    /// operand is what is subtracted.
    DifferenceRight,
}

impl DecisionKind {
    /// That of an operand where one wins.
    pub(super) const fn of(extreme: Extreme) -> Self {
        match extreme {
            Extreme::Largest => Self::UnionOperand,
            Extreme::Smallest => Self::IntersectionOperand,
        }
    }

    /// Whether the operand does not decide, from the low and high ends of the ranges of its field and of the
    /// operator's.
    #[must_use]
    pub fn spares(self, operand: [f32; 2], node: [f32; 2], iso2: f32) -> bool {
        match self {
            Self::UnionOperand => operand[1] < node[0],
            Self::IntersectionOperand => operand[0] > node[1],
            Self::DifferenceLeft => operand[0] > node[1] && node[1] < iso2,
            Self::DifferenceRight => node[1] < (iso2 - operand[1]).max(0.0) && node[1] < iso2,
        }
    }
}

/// Where a row's field may be something else than zero: within a distance of a box.
///
/// At a point outside, the program computes +0 for the field of the row and zeros of some sign for its
/// gradient. This is proven for points with coordinates up to [`LARGEST_COORDINATE`] in the world, of numbers
/// in f32 with their rounding. (A leaf whose strength is so small that fields round to zero inside of its
/// support, and which is an operand of an intersection, may leave a subnormal gradient there.)
///
/// It takes half a cache line, because rows are accessed in any order.
#[repr(align(32))]
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Support {
    /// The smallest corner of the core. Above the largest if nothing is inside.
    pub low: [f32; 3],
    /// The largest corner of the core.
    pub high: [f32; 3],
    /// The square of the distance, a little enlarged: see [`misses`](Self::misses).
    pub radius_squared: f32,
}

impl Support {
    /// All points are inside.
    pub const EVERYWHERE: Self =
        Self { low: [f32::NEG_INFINITY; 3], high: [f32::INFINITY; 3], radius_squared: 0.0 };

    /// The points within a distance of a box, rounded outwards.
    pub(super) fn around(core: Bounds, radius: f64) -> Self {
        // A gap, its square and a sum of three are each off by half a unit at most: five in all, and a root
        // of the square here.
        let radius = (radius * (1.0 + 1.0 / (1 << 20) as f64)).powi(2);
        Self {
            low: core.low().map(round_down),
            high: core.high().map(|side| -round_down(-side)),
            radius_squared: -round_down(-radius),
        }
    }

    /// Whether a closed box is outside: no point of it is inside. Computed in f32, in any order of the sum.
    #[must_use]
    pub fn misses(&self, low: [f32; 3], high: [f32; 3]) -> bool {
        let gap = |axis: usize| {
            let (before, behind) = (self.low[axis] - high[axis], low[axis] - self.high[axis]);
            let gap = if before > behind { before } else { behind };
            if gap > 0.0 { gap } else { 0.0 }
        };
        let [x, y, z] = [gap(0), gap(1), gap(2)];
        x * x + y * y + z * z > self.radius_squared
    }
}

/// The largest f32 that is not above a number.
fn round_down(number: f64) -> f32 {
    let nearest = number as f32;
    if f64::from(nearest) > number { nearest.next_down() } else { nearest }
}

/// A model's range function with its numbers, and what pruning has to know.
#[derive(Clone, Debug)]
pub struct RangeFunction {
    /// Outputs: `field`, then `probe0`, `probe1`, and so on. A probe whose guard is left out is 0.
    pub function: Function,
    /// Its numbers: the rows of the program of any query, without orders and attributes.
    pub tables: Tables,
    /// What there is to know about the tables.
    pub info: PruneInfo,
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn an_operand_that_cannot_decide_is_spared() {
        use DecisionKind::{DifferenceLeft, DifferenceRight, IntersectionOperand, UnionOperand};
        // What ranges of the operand and of the operator say; equal ends may be equal numbers.
        let (below, touching, above) = ([0.0, 0.25], [0.0, 0.5], [1.5, 2.0]);
        let node = [0.5, 1.0];
        assert!(UnionOperand.spares(below, node, 1.0) && !UnionOperand.spares(touching, node, 1.0));
        assert!(IntersectionOperand.spares(above, node, 1.0));
        assert!(!IntersectionOperand.spares([1.0, 2.0], node, 1.0));
        // The left side decides where it is less than what the right side leaves, which is at most iso2.
        assert!(DifferenceLeft.spares(above, node, 1.25));
        assert!(!DifferenceLeft.spares([1.0, 2.0], node, 1.25), "it may be the result");
        assert!(!DifferenceLeft.spares(above, node, 1.0), "a right side of 0 leaves iso2");
        // The right side decides where iso2 without it is no more than the result.
        assert!(DifferenceRight.spares([0.0, 0.25], node, 1.5));
        assert!(!DifferenceRight.spares([0.0, 0.5], node, 1.5), "1.5 - 0.5 may be the result");
        assert!(!DifferenceRight.spares([0.0, 0.75], node, 1.5));
        assert!(!DifferenceRight.spares([-1.0, -0.5], node, 1.0), "iso2 may be the result");
    }

    #[test]
    fn a_box_misses_what_is_farther_than_the_radius() {
        let support = Support { low: [-1.0, -2.0, -3.0], high: [1.0, 2.0, 3.0], radius_squared: 4.0 };
        let misses = |low: [f32; 3]| support.misses(low, low.map(|side| side + 0.5));
        for axis in 0..3 {
            let end = [1.0, 2.0, 3.0][axis];
            let at = |side: f32| std::array::from_fn(|other| if other == axis { side } else { 0.0 });
            assert!(!misses(at(end + 2.0)) && misses(at(end + 2.25)), "above on axis {axis}");
            assert!(!misses(at(-end - 2.5)) && misses(at(-end - 2.75)), "below on axis {axis}");
        }
        assert!(!misses([0.0; 3]));
        assert!(!misses([2.0, 3.0, 4.0]), "the root of 3 is less than 2");
        assert!(misses([2.25, 3.25, 4.25]), "1.25 on each axis is more than 2");
        assert!(!Support::EVERYWHERE.misses([1e30; 3], [1e30; 3]));
    }

    #[test]
    fn rounding_of_a_support_is_outwards_and_little() {
        let core = Bounds::new(DVec3::splat(-0.1), DVec3::splat(0.3));
        let support = Support::around(core, 0.7);
        assert!(support.low.iter().all(|&side| f64::from(side) <= -0.1 && side >= -0.100_000_02));
        assert!(support.high.iter().all(|&side| f64::from(side) >= 0.3 && side <= 0.300_000_04));
        let radius = f64::from(support.radius_squared).sqrt();
        assert!(radius > 0.7 && radius < 0.7 * (1.0 + 2e-6), "{radius}");
    }
}
