//! Copies of a function: with other ops in place of its ops, or with other numbers for the same instructions.
//!
//! ```text
//! rewrite:   for each block, in order: map the operands, write the instruction again through a builder, remember the new value
//!            (the builder shares equal instructions and hoists what does not depend on the row, so a plain rewrite is a CSE)
//! renumber:  the same walk without a builder: instructions stay where they are, names become dense
//! ```
//!
//! The recursion is over nested folds, at most [`crate::limits::MAX_FOLD_DEPTH`] deep; a block may be as long
//! as it likes.

use crate::builder::FunctionBuilder;
use crate::entity::{Block, Entity, Inst, Store, Value, Values};
use crate::function::{BlockData, Fold, Function, InstData, InstKind};
use crate::op::{Domain, Op};
use crate::origin::Part;

/// Writes `function` again with `op` in place of each op. It gets the builder, the op, and its operands in
/// the new function, and says which new value stands for the result. Inputs, constants, columns, folds,
/// tables, origins and output names stay.
#[must_use]
pub fn rewrite(function: &Function, op: impl FnMut(&mut FunctionBuilder, Op, &[Value]) -> Value) -> Function {
    let mut rewrite = Rewrite {
        function,
        builder: FunctionBuilder::like(function),
        map: vec![None; function.values.len()],
        op,
    };
    rewrite.insts(function.body);
    let results = rewrite.map_all(&function.blocks[function.body].results);
    let outputs: Vec<(String, Value)> = function.outputs.iter().cloned().zip(results).collect();
    rewrite.builder.finish(&outputs)
}

struct Rewrite<'a, F> {
    function: &'a Function,
    builder: FunctionBuilder,
    /// The new value of each old one.
    map: Vec<Option<Value>>,
    op: F,
}

impl<F: FnMut(&mut FunctionBuilder, Op, &[Value]) -> Value> Rewrite<'_, F> {
    fn map_all(&self, values: &[Value]) -> Values {
        values.iter().map(|value| self.map[value.index()].expect("values are defined before use")).collect()
    }

    fn bind(&mut self, old: &[Value], new: &[Value]) {
        for (old, &new) in old.iter().zip(new) {
            self.map[old.index()] = Some(new);
        }
    }

    fn insts(&mut self, block: Block) {
        for &inst in &self.function.blocks[block].insts {
            self.inst(inst);
        }
    }

    fn inst(&mut self, inst: Inst) {
        let function = self.function;
        let data = &function.insts[inst];
        self.builder.set_origin(data.origin);
        let result = match &data.kind {
            InstKind::Input(index) => self.builder.input(*index),
            InstKind::Constant(number) => self.builder.constant(*number),
            InstKind::BitsConstant(bits) => self.builder.bits_constant(*bits),
            InstKind::Column { table, column } => self.builder.column(*table, *column),
            InstKind::Op { op, args } => {
                let args = self.map_all(args);
                let result = (self.op)(&mut self.builder, *op, &args);
                // A distance stays one for the counters, also if its value turns out to be there already for
                // something else.
                let computed = matches!(self.builder.definition(result), Some(InstKind::Op { .. }));
                if computed && data.origin.part == Part::Distance {
                    self.builder.mark(result, data.origin);
                }
                result
            }
            InstKind::Fold(fold) => {
                let initial = self.map_all(&fold.initial);
                let params = self.builder.begin_fold(fold.table, (fold.kind, fold.rule), &initial);
                self.bind(&function.blocks[fold.body].params, &params);
                self.insts(fold.body);
                let next = self.map_all(&function.blocks[fold.body].results);
                self.builder.set_origin(data.origin);
                let results = self.builder.end_fold(&next);
                self.bind(&data.results, &results);
                return;
            }
        };
        self.bind(&data.results, &[result]);
    }
}

/// The same instructions in the same order, with dense names in that order. What no block lists is gone.
#[must_use]
pub fn renumber(function: &Function) -> Function {
    let mut renumber = Renumber {
        old: function,
        new: Function {
            name: function.name.clone(),
            inputs: function.inputs.clone(),
            outputs: function.outputs.clone(),
            tables: function.tables.clone(),
            values: Store::new(),
            insts: Store::new(),
            blocks: Store::new(),
            body: function.body,
        },
        map: vec![None; function.values.len()],
    };
    renumber.new.values.reserve(function.values.len());
    renumber.new.insts.reserve(function.insts.len());
    renumber.new.body = renumber.block(function.body);
    renumber.new
}

struct Renumber<'a> {
    old: &'a Function,
    new: Function,
    /// The new value of each old one.
    map: Vec<Option<Value>>,
}

impl Renumber<'_> {
    fn define(&mut self, values: &[Value]) -> Values {
        values
            .iter()
            .map(|&value| {
                let new = self.new.values.push(self.old.values[value]);
                self.map[value.index()] = Some(new);
                new
            })
            .collect()
    }

    fn map_all(&self, values: &[Value]) -> Values {
        values.iter().map(|value| self.map[value.index()].expect("values are defined before use")).collect()
    }

    fn block(&mut self, block: Block) -> Block {
        let data = &self.old.blocks[block];
        let params = self.define(&data.params);
        let new = self.new.blocks.push(BlockData { params, ..BlockData::default() });
        for &inst in &data.insts {
            let inst = self.inst(inst);
            self.new.blocks[new].insts.push(inst);
        }
        self.new.blocks[new].results = self.map_all(&data.results);
        new
    }

    fn inst(&mut self, inst: Inst) -> Inst {
        let data = &self.old.insts[inst];
        let kind = match &data.kind {
            InstKind::Input(_)
            | InstKind::Constant(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. } => data.kind.clone(),
            InstKind::Op { op, args } => InstKind::Op { op: *op, args: self.map_all(args) },
            InstKind::Fold(fold) => InstKind::Fold(Fold {
                table: fold.table,
                kind: fold.kind,
                rule: fold.rule,
                initial: self.map_all(&fold.initial),
                body: self.block(fold.body),
            }),
        };
        let results = self.define(&data.results);
        self.new.insts.push(InstData { kind, results, origin: data.origin })
    }
}
