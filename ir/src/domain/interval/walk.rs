//! Walks through a function in the interval domain. The *ground* of a walk is either rows, which are run
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
use crate::entity::{Block, Entity, Table, Value};
use crate::facts::facts;
use crate::function::{Fold, Function, InstKind};
use crate::op::{Any, Domain, Type, apply};
use crate::origin::Origin;
use crate::table::Tables;
use crate::verify::Verified;

/// The bounds of the outputs of `function` for inputs between these bounds: for each plane low and high, as
/// [the module](super) defines a range. `tables` fit the function ([`Tables::check`]); `inputs` has one entry
/// per plane.
///
/// The pass [`interval`](crate::pass::interval()) makes a function that gives the same bits.
#[must_use]
pub fn enclose(function: &Verified, tables: &Tables, inputs: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let function = function.function();
    let ground = Running { tables, inputs, rows: vec![0; function.tables.len()] };
    let mut walk = Walk::new(function, Scalar, ground);
    walk.outputs()
}

/// What a walk stands on.
pub(crate) trait Ground: Sized {
    /// The domain of the bounds.
    type Bound: Domain;

    /// The instructions that follow have this origin.
    fn begin(&mut self, bounds: &mut Self::Bound, origin: Origin);

    /// The instruction with this origin has given a range with these bounds.
    fn end(&mut self, bounds: &mut Self::Bound, origin: Origin, high: <Self::Bound as Domain>::Real);

    /// The bounds of an input plane.
    fn input(&mut self, bounds: &mut Self::Bound, index: usize) -> [<Self::Bound as Domain>::Real; 2];

    /// A column of the current row.
    fn column(
        &mut self,
        bounds: &mut Self::Bound,
        table: Table,
        column: usize,
    ) -> <Self::Bound as Domain>::Real;

    /// The final accumulators of a fold with these initial ones; [`Walk::body`] is one iteration.
    fn fold(
        walk: &mut Walk<'_, Self>,
        fold: &Fold,
        origin: Origin,
        initial: Vec<Any<Self::Bound>>,
    ) -> Vec<Any<Self::Bound>>;
}

/// A walk through one function.
pub(crate) struct Walk<'a, G: Ground> {
    function: &'a Function,
    /// The facts of values; the walk reads those of accumulators.
    facts: Vec<Facts>,
    pub(crate) interval: Interval<G::Bound>,
    pub(crate) ground: G,
    values: Vec<Option<Any<Interval<G::Bound>>>>,
}

impl<'a, G: Ground> Walk<'a, G> {
    pub(crate) fn new(function: &'a Function, bounds: G::Bound, ground: G) -> Self {
        Self {
            function,
            facts: facts(function),
            interval: Interval::new(bounds),
            ground,
            values: vec![None; function.values.len()],
        }
    }

    /// Goes through the whole function: the bounds of its outputs.
    pub(crate) fn outputs(&mut self) -> Vec<[<G::Bound as Domain>::Real; 2]> {
        let function = self.function;
        self.block(function.body);
        self.ground.begin(&mut self.interval.domain, Origin::SHARED);
        let results = &function.blocks[function.body].results;
        results
            .iter()
            .map(|&value| {
                let range = self.value(value).real();
                self.interval.output(range)
            })
            .collect()
    }

    /// One iteration of a fold: the next accumulators.
    pub(crate) fn body(&mut self, fold: &Fold, accumulators: Vec<Any<G::Bound>>) -> Vec<Any<G::Bound>> {
        let body = &self.function.blocks[fold.body];
        self.bind(&body.params, &body.params, accumulators);
        self.block(fold.body);
        self.flatten(&body.results, &body.params)
    }

    fn value(&self, value: Value) -> Any<Interval<G::Bound>> {
        self.values[value.index()].expect("a verified function defines values before it uses them")
    }

    fn block(&mut self, block: Block) {
        let function = self.function;
        for &inst in &function.blocks[block].insts {
            let data = &function.insts[inst];
            self.ground.begin(&mut self.interval.domain, data.origin);
            let result = match &data.kind {
                InstKind::Input(index) => {
                    let [low, high] = self.ground.input(&mut self.interval.domain, *index);
                    Any::Real(self.interval.input(low, high))
                }
                InstKind::Constant(number) => Any::Real(self.interval.constant(*number)),
                InstKind::BitsConstant(bits) => Any::Bits(self.interval.bits_constant(*bits)),
                InstKind::Column { table, column } => {
                    let value = self.ground.column(&mut self.interval.domain, *table, *column);
                    Any::Real(self.interval.point(value))
                }
                InstKind::Op { op, args } => {
                    // The op table has at most three operands; unused places repeat the first.
                    let mut operands = [self.value(args[0]); 3];
                    for (place, &arg) in operands.iter_mut().zip(args) {
                        *place = self.value(arg);
                    }
                    let result = apply(&mut self.interval, *op, &operands[..args.len()]);
                    if let Any::Real(range) = result {
                        self.ground.end(&mut self.interval.domain, data.origin, range.high);
                    }
                    result
                }
                InstKind::Fold(fold) => {
                    let body = &function.blocks[fold.body];
                    let initial = self.flatten(&fold.initial, &body.params);
                    let finals = G::fold(self, fold, data.origin, initial);
                    self.bind(&data.results, &body.params, finals);
                    continue;
                }
            };
            self.values[data.results[0].index()] = Some(result);
        }
    }

    /// The bounds of these values, in the layout of the accumulators that take them.
    fn flatten(&self, values: &[Value], accumulators: &[Value]) -> Vec<Any<G::Bound>> {
        let mut flat = Vec::new();
        for (&value, accumulator) in values.iter().zip(accumulators) {
            let point = self.facts[accumulator.index()].point;
            match self.value(value) {
                Any::Real(range) if point => flat.push(Any::Real(range.low)),
                Any::Real(range) => flat.extend([Any::Real(range.low), Any::Real(range.high)]),
                Any::Mask(mask) if point => flat.push(Any::Mask(mask.yes)),
                Any::Mask(mask) => flat.extend([Any::Mask(mask.yes), Any::Mask(mask.no)]),
                Any::Bits(bits) => flat.extend(bits.0.filter(|_| point).map(Any::Bits)),
            }
        }
        flat
    }

    /// Binds `values` to what [`flatten`](Self::flatten) made, in the layout of these accumulators.
    fn bind(&mut self, values: &[Value], accumulators: &[Value], flat: Vec<Any<G::Bound>>) {
        let mut flat = flat.into_iter();
        let mut next = || flat.next().expect("the layout is that of flatten");
        for (&value, accumulator) in values.iter().zip(accumulators) {
            let facts = self.facts[accumulator.index()];
            let any = match (self.function.values[value], facts.point) {
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
            };
            self.values[value.index()] = Some(any);
        }
    }
}

/// The ground of [`enclose`]: the rows are run.
struct Running<'a> {
    tables: &'a Tables,
    inputs: &'a [[f32; 2]],
    /// The current row of each table.
    rows: Vec<usize>,
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

    fn fold(
        walk: &mut Walk<'_, Self>,
        fold: &Fold,
        _: Origin,
        initial: Vec<Any<Scalar>>,
    ) -> Vec<Any<Scalar>> {
        let parent = walk.function.tables[fold.table].parent;
        let parent_row = parent.map_or(0, |parent| walk.ground.rows[parent.index()]);
        let tables = walk.ground.tables;
        let mut accumulators = initial;
        for &row in tables.tables[fold.table].range(parent_row) {
            walk.ground.rows[fold.table.index()] = row as usize;
            accumulators = walk.body(fold, accumulators);
        }
        accumulators
    }
}
