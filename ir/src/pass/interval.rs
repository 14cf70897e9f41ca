//! Turns a function of numbers into a function of ranges: inputs `x`, `y` become `x.low`, `x.high`, `y.low`,
//! `y.high`, an output `field` becomes `field.low`, `field.high`.
//!
//! The function is run once in the [interval domain](crate::domain::interval), which says what a range is,
//! over a builder. Tables, columns and origins stay, so the rows of the one function are those of the other.
//!
//! ```text
//! (s) = fold t0 rows neutral (0) (acc): ... yield next
//!     becomes
//! (s.low, s.high) = fold t0 rows neutral (0, 0) (acc.low, acc.high): ... yield next.low, next.high
//! ```
//!
//! A mask accumulator becomes two masks: certainly true, certainly false. An accumulator that does not depend
//! on the inputs stays one value.
//!
//! The transcendentals have to be whole, so the pass runs before `legalize`; after `gradient` it gives the
//! ranges of the gradient.

use crate::alone::POINT_PLANES;
use crate::builder::FunctionBuilder;
use crate::domain::interval::{BoundParts, Enclosure, Ground};
use crate::entity::{Table, Value, Values};
use crate::function::{Fold, Function};
use crate::op::{Any, Type};
use crate::origin::{Origin, Part};

/// What the names of low and of high bounds end with, in their order.
pub const BOUND_SUFFIXES: [&str; 2] = [".low", ".high"];

/// The function of ranges. Its inputs and outputs are those of `function`, two for each: `2 i` is the low
/// bound of plane i and `2 i + 1` the high one.
#[must_use]
pub fn interval(function: &Function) -> Function {
    enclosed(function, function.inputs.len())
}

/// As [`interval()`], for the function of one row ([`crate::alone`]): the point becomes ranges, and the
/// inputs behind it stay numbers, one plane each.
#[must_use]
pub fn row_interval(function: &Function) -> Function {
    enclosed(function, POINT_PLANES)
}

/// The function of ranges. The first inputs become ranges, the others stay numbers.
fn enclosed(function: &Function, ranges: usize) -> Function {
    let mut bounds = FunctionBuilder::like(function);
    let (point, numbers) = function.inputs.split_at(ranges);
    bounds.set_inputs(point.iter().flat_map(|name| both(name)).chain(numbers.iter().cloned()).collect());
    let (outputs, bounds) = Enclosure::new(function, bounds, Emitting { ranges }).outputs();
    let names = function.outputs.iter().flat_map(|name| both(name));
    let outputs: Vec<(String, Value)> = names.zip(outputs.into_iter().flatten()).collect();
    bounds.finish(&outputs)
}

/// The names of the bounds of a plane.
fn both(name: &str) -> [String; 2] {
    BOUND_SUFFIXES.map(|suffix| format!("{name}{suffix}"))
}

/// The ground of the pass: bounds are emitted, and folds are written.
struct Emitting {
    /// How many inputs are ranges; those behind are numbers.
    ranges: usize,
}

impl Ground for Emitting {
    type Bound = FunctionBuilder;

    /// A distance is one value for the counters: the high bound, which [`end`](Self::end) marks. The other
    /// ops of a distance count as position.
    fn begin(&mut self, bounds: &mut FunctionBuilder, origin: Origin) {
        let part = if origin.part == Part::Distance { Part::Position } else { origin.part };
        bounds.set_origin(Origin::new(origin.slot(), part));
    }

    fn end(&mut self, bounds: &mut FunctionBuilder, origin: Origin, high: Value) {
        bounds.keep_distance(high, origin);
    }

    fn input(&mut self, bounds: &mut FunctionBuilder, index: usize) -> [Value; 2] {
        [bounds.input(2 * index), bounds.input(2 * index + 1)]
    }

    fn number(&mut self, bounds: &mut FunctionBuilder, index: usize) -> Option<Value> {
        (index >= self.ranges).then(|| bounds.input(self.ranges + index))
    }

    fn column(&mut self, bounds: &mut FunctionBuilder, table: Table, column: usize) -> Value {
        bounds.column(table, column)
    }

    fn runs(&mut self, _: &Fold) -> usize {
        1
    }

    fn enter(
        &mut self,
        bounds: &mut FunctionBuilder,
        fold: &Fold,
        _: usize,
        initial: BoundParts<Self>,
    ) -> BoundParts<Self> {
        let initial: Values = initial.into_iter().map(value).collect();
        let params = bounds.begin_fold(fold.table, (fold.kind, fold.rule), &initial);
        params.into_iter().map(|param| typed(bounds, param)).collect()
    }

    fn leave(
        &mut self,
        bounds: &mut FunctionBuilder,
        origin: Origin,
        next: BoundParts<Self>,
    ) -> BoundParts<Self> {
        bounds.set_origin(origin);
        let next: Values = next.into_iter().map(value).collect();
        let results = bounds.end_fold(&next);
        results.into_iter().map(|result| typed(bounds, result)).collect()
    }
}

/// A value of the new function, with its type.
fn typed(bounds: &FunctionBuilder, value: Value) -> Any<FunctionBuilder> {
    match bounds.function().values[value] {
        Type::Real => Any::Real(value),
        Type::Mask => Any::Mask(value),
        Type::Bits => Any::Bits(value),
    }
}

/// The value, without its type.
fn value(any: Any<FunctionBuilder>) -> Value {
    match any {
        Any::Real(value) | Any::Mask(value) | Any::Bits(value) => value,
    }
}
