//! Copies of a function: with other ops in place of its ops, or with other names for the same instructions.

use super::{AccumulatorParts, Translation, translate};
use crate::builder::FunctionBuilder;
use crate::entity::{Table, Value};
use crate::function::{Fold, Function, InstData};
use crate::op::{Domain as _, Op};
use crate::origin::Origin;

/// Writes `function` again with `op` in place of each op. It gets the builder, the op, and its operands in
/// the new function, and says which new value stands for the result. Inputs, constants, columns, folds,
/// tables, origins and output names stay.
///
/// The builder shares equal instructions and hoists what does not depend on the row, so a plain rewrite
/// eliminates common subexpressions.
#[must_use]
pub fn rewrite(function: &Function, op: impl FnMut(&mut FunctionBuilder, Op, &[Value]) -> Value) -> Function {
    Rewrite { builder: FunctionBuilder::like(function), op }.run(function)
}

/// The same instructions in the same order, with dense names in that order. What no block lists is gone.
#[must_use]
pub fn renumber(function: &Function) -> Function {
    Rewrite { builder: FunctionBuilder::verbatim(function), op: FunctionBuilder::op }.run(function)
}

struct Rewrite<F> {
    builder: FunctionBuilder,
    op: F,
}

impl<F: FnMut(&mut FunctionBuilder, Op, &[Value]) -> Value> Rewrite<F> {
    fn run(mut self, function: &Function) -> Function {
        let results = translate(function, &mut self);
        let outputs: Vec<(String, Value)> = function.outputs.iter().cloned().zip(results).collect();
        self.builder.finish(&outputs)
    }
}

impl<F: FnMut(&mut FunctionBuilder, Op, &[Value]) -> Value> Translation for Rewrite<F> {
    type Value = Value;
    type Part = Value;

    fn begin(&mut self, origin: Origin) {
        self.builder.set_origin(origin);
    }

    fn input(&mut self, index: usize) -> Value {
        self.builder.input(index)
    }

    fn constant(&mut self, number: f32) -> Value {
        self.builder.constant(number)
    }

    fn bits_constant(&mut self, bits: u32) -> Value {
        self.builder.bits_constant(bits)
    }

    fn column(&mut self, table: Table, column: usize) -> Value {
        self.builder.column(table, column)
    }

    fn op(&mut self, inst: &InstData, op: Op, args: &[Value]) -> Value {
        if self.builder.is_full() {
            return self.builder.op(op, args);
        }
        let result = (self.op)(&mut self.builder, op, args);
        self.builder.keep_distance(result, inst.origin);
        result
    }

    fn split(&mut self, value: Value, _: Value, parts: &mut AccumulatorParts<Value>) {
        parts.push(value);
    }

    fn whole(&mut self, _: Value, mut next: impl FnMut() -> Value) -> Value {
        next()
    }

    fn enter(&mut self, fold: &Fold, _: usize, initial: AccumulatorParts<Value>) -> AccumulatorParts<Value> {
        self.builder.begin_fold(fold.table, (fold.kind, fold.rule), &initial).into()
    }

    fn leave(&mut self, _: &Fold, origin: Origin, next: AccumulatorParts<Value>) -> AccumulatorParts<Value> {
        self.builder.set_origin(origin);
        self.builder.end_fold(&next).into()
    }
}
