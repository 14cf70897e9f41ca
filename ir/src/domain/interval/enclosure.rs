//! The translation of a function into the interval domain. Its *ground* is either rows, which are run
//! ([`enclose`]), or a builder, into which folds are written (the pass).
//!
//! Both grounds get the same values with the same facts and identities, hence the same bounds:
//!
//! ```text
//! accumulators    have the facts that hold in every iteration, and a new identity in each
//! columns         are points of which nothing is known, whatever number the row has
//! ```
//!
//! A fold keeps for each accumulator only what is not known: two bounds of a real, two masks for a mask, one
//! value for a point, nothing for unknown bits.

use super::facts::Facts;
use super::value::{Certainty, Interval, Known};
use crate::domain::scalar::Scalar;
use crate::entity::{Entity, Table, Value};
use crate::facts::facts;
use crate::function::{Fold, Function, InstData};
use crate::op::{Any, Domain, Op, Type, apply};
use crate::origin::Origin;
use crate::table::Tables;
use crate::translate::{AccumulatorParts, Translation, translate};
use crate::verify::Verified;

/// The bounds of the outputs of `function` for inputs between these bounds: for each plane low and high, as
/// [the module](super) defines a range. `tables` fit the function ([`Tables::check`]); `inputs` has one entry
/// per plane.
///
/// The pass [`interval`](crate::pass::interval()) makes a function that gives the same bits.
#[must_use]
pub fn enclose(function: &Verified, tables: &Tables, inputs: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let function = function.function();
    let ground = Running { function, tables, inputs, rows: vec![0; function.tables.len()] };
    Enclosure::new(function, Scalar, ground).outputs().0
}

/// The parts of accumulators in the domain of the bounds.
pub(crate) type BoundParts<G> = AccumulatorParts<Any<<G as Ground>::Bound>>;

/// The low and the high bound of a real.
type BoundPair<G> = [<<G as Ground>::Bound as Domain>::Real; 2];

/// What an enclosure stands on.
pub(crate) trait Ground: Sized {
    /// The domain of the bounds.
    type Bound: Domain;

    /// The instructions that follow have this origin.
    fn begin(&mut self, bounds: &mut Self::Bound, origin: Origin);

    /// The op with this origin has given a range with this high bound.
    fn end(&mut self, bounds: &mut Self::Bound, origin: Origin, high: <Self::Bound as Domain>::Real);

    /// The bounds of an input plane.
    fn input(&mut self, bounds: &mut Self::Bound, index: usize) -> BoundPair<Self>;

    /// An input plane that is a number and no range, if it is one.
    fn number(&mut self, _: &mut Self::Bound, _index: usize) -> Option<<Self::Bound as Domain>::Real> {
        None
    }

    /// A column of the current row.
    fn column(
        &mut self,
        bounds: &mut Self::Bound,
        table: Table,
        column: usize,
    ) -> <Self::Bound as Domain>::Real;

    /// As [`Translation::runs`].
    fn runs(&mut self, fold: &Fold) -> usize;

    /// As [`Translation::enter`].
    fn enter(
        &mut self,
        bounds: &mut Self::Bound,
        fold: &Fold,
        run: usize,
        parts: BoundParts<Self>,
    ) -> BoundParts<Self>;

    /// As [`Translation::leave`].
    fn leave(&mut self, bounds: &mut Self::Bound, origin: Origin, next: BoundParts<Self>)
    -> BoundParts<Self>;
}

/// The translation of one function into ranges.
pub(crate) struct Enclosure<'a, G: Ground> {
    function: &'a Function,
    /// The facts of values; those of accumulators are read.
    facts: Vec<Facts>,
    interval: Interval<G::Bound>,
    ground: G,
}

impl<'a, G: Ground> Enclosure<'a, G> {
    pub(crate) fn new(function: &'a Function, bounds: G::Bound, ground: G) -> Self {
        Self { function, facts: facts(function), interval: Interval::new(bounds), ground }
    }

    /// The bounds of the function's outputs, and the domain that they are in.
    pub(crate) fn outputs(mut self) -> (Vec<BoundPair<G>>, G::Bound) {
        let ranges = translate(self.function, &mut self);
        self.begin(Origin::SHARED);
        let outputs = ranges.into_iter().map(|range| self.interval.output(range.real())).collect();
        (outputs, self.interval.domain)
    }
}

impl<G: Ground> Translation for Enclosure<'_, G> {
    type Value = Any<Interval<G::Bound>>;
    type Part = Any<G::Bound>;

    fn begin(&mut self, origin: Origin) {
        self.ground.begin(&mut self.interval.domain, origin);
    }

    fn input(&mut self, index: usize) -> Self::Value {
        if let Some(number) = self.ground.number(&mut self.interval.domain, index) {
            return Any::Real(self.interval.point(number));
        }
        let [low, high] = self.ground.input(&mut self.interval.domain, index);
        Any::Real(self.interval.input(low, high))
    }

    fn constant(&mut self, number: f32) -> Self::Value {
        Any::Real(self.interval.constant(number))
    }

    fn bits_constant(&mut self, bits: u32) -> Self::Value {
        Any::Bits(self.interval.bits_constant(bits))
    }

    fn column(&mut self, table: Table, column: usize) -> Self::Value {
        let value = self.ground.column(&mut self.interval.domain, table, column);
        Any::Real(self.interval.point(value))
    }

    fn op(&mut self, inst: &InstData, op: Op, args: &[Self::Value]) -> Self::Value {
        let result = apply(&mut self.interval, op, args);
        if let Any::Real(range) = result {
            self.ground.end(&mut self.interval.domain, inst.origin, range.high);
        }
        result
    }

    fn split(&mut self, value: Self::Value, accumulator: Value, parts: &mut AccumulatorParts<Self::Part>) {
        let point = self.facts[accumulator.index()].point;
        match value {
            Any::Real(range) if point => parts.push(Any::Real(range.low)),
            Any::Real(range) => parts.extend([Any::Real(range.low), Any::Real(range.high)]),
            Any::Mask(mask) if point => parts.push(Any::Mask(mask.yes)),
            Any::Mask(mask) => parts.extend([Any::Mask(mask.yes), Any::Mask(mask.no)]),
            Any::Bits(bits) => parts.extend(bits.0.filter(|_| point).map(Any::Bits)),
        }
    }

    fn whole(&mut self, accumulator: Value, mut next: impl FnMut() -> Self::Part) -> Self::Value {
        let facts = self.facts[accumulator.index()];
        match (self.function.values[accumulator], facts.point) {
            (Type::Real, true) => {
                let point = next().real();
                Any::Real(self.interval.range(point, point, facts))
            }
            (Type::Real, false) => {
                let (low, high) = (next().real(), next().real());
                Any::Real(self.interval.range(low, high, facts))
            }
            (Type::Mask, true) => Any::Mask(self.interval.decided(next().mask())),
            (Type::Mask, false) => {
                let (yes, no) = (next().mask(), next().mask());
                Any::Mask(Certainty { yes, no, decided: false })
            }
            (Type::Bits, true) => Any::Bits(Known(Some(next().bits()))),
            (Type::Bits, false) => Any::Bits(Known(None)),
        }
    }

    fn runs(&mut self, fold: &Fold) -> usize {
        self.ground.runs(fold)
    }

    fn enter(
        &mut self,
        fold: &Fold,
        run: usize,
        parts: AccumulatorParts<Self::Part>,
    ) -> AccumulatorParts<Self::Part> {
        self.ground.enter(&mut self.interval.domain, fold, run, parts)
    }

    fn leave(
        &mut self,
        _: &Fold,
        origin: Origin,
        next: AccumulatorParts<Self::Part>,
    ) -> AccumulatorParts<Self::Part> {
        self.ground.leave(&mut self.interval.domain, origin, next)
    }
}

/// The ground of [`enclose`]: the rows are run.
struct Running<'a> {
    function: &'a Function,
    tables: &'a Tables,
    inputs: &'a [[f32; 2]],
    /// The current row of each table.
    rows: Vec<usize>,
}

impl<'a> Running<'a> {
    /// The active rows of a fold that the parent's current row owns.
    fn active(&self, fold: &Fold) -> &'a [u32] {
        let parent = self.function.tables[fold.table].parent;
        self.tables.tables[fold.table].range(parent.map_or(0, |parent| self.rows[parent.index()]))
    }
}

impl Ground for Running<'_> {
    type Bound = Scalar;

    fn begin(&mut self, _: &mut Scalar, _: Origin) {}

    fn end(&mut self, _: &mut Scalar, _: Origin, _: f32) {}

    fn input(&mut self, _: &mut Scalar, index: usize) -> [f32; 2] {
        self.inputs[index]
    }

    fn column(&mut self, _: &mut Scalar, table: Table, column: usize) -> f32 {
        self.tables.tables[table].row(self.rows[table.index()])[column]
    }

    fn runs(&mut self, fold: &Fold) -> usize {
        self.active(fold).len()
    }

    fn enter(
        &mut self,
        _: &mut Scalar,
        fold: &Fold,
        run: usize,
        parts: BoundParts<Self>,
    ) -> BoundParts<Self> {
        self.rows[fold.table.index()] = self.active(fold)[run] as usize;
        parts
    }

    fn leave(&mut self, _: &mut Scalar, _: Origin, next: BoundParts<Self>) -> BoundParts<Self> {
        next
    }
}
