//! Runs a function in any domain, instruction by instruction, on one block of lanes.
//!
//! This is the reference: no registers are reused, nothing is reordered. With [`crate::domain::scalar::Scalar`] it defines what
//! every engine must give; with the counting domain it says what a point costs.
//!
//! ```text
//! run block: for each instruction: look its operands up, call the op's method, remember the result
//!   a fold:  for each active row that the parent's row owns: make it the current row, run the body with the accumulators
//! ```
//!
//! The recursion is over nested folds, at most [`crate::limits::MAX_FOLD_DEPTH`] deep.

use crate::entity::{Block, Entity, Inst};
use crate::function::{Function, InstKind};
use crate::op::{Any, Domain, apply};
use crate::table::Tables;
use crate::verify::Verified;

/// One run of one function.
struct Run<'a, D: Domain> {
    function: &'a Function,
    tables: &'a Tables,
    domain: &'a mut D,
    inputs: &'a [D::Real],
    values: Vec<Option<Any<D>>>,
    /// The current row of each table.
    rows: Vec<usize>,
}

/// The outputs of `function` for these inputs. `tables` fit the function ([`Tables::check`]); `inputs` has one entry per plane.
pub fn run<D: Domain>(
    function: &Verified,
    tables: &Tables,
    domain: &mut D,
    inputs: &[D::Real],
) -> Vec<D::Real> {
    let function = function.function();
    let mut run = Run {
        function,
        tables,
        domain,
        inputs,
        values: vec![None; function.values.len()],
        rows: vec![0; function.tables.len()],
    };
    run.block(function.body).into_iter().map(Any::real).collect()
}

impl<D: Domain> Run<'_, D> {
    fn block(&mut self, block: Block) -> Vec<Any<D>> {
        let data = &self.function.blocks[block];
        for &inst in &data.insts {
            self.inst(inst);
        }
        data.results.iter().map(|&value| self.value(value)).collect()
    }

    fn value(&self, value: crate::entity::Value) -> Any<D> {
        self.values[value.index()].expect("a verified function defines values before it uses them")
    }

    fn inst(&mut self, inst: Inst) {
        let data = &self.function.insts[inst];
        let result = match &data.kind {
            InstKind::Input(index) => Any::Real(self.inputs[*index]),
            InstKind::Constant(number) => Any::Real(self.domain.constant(*number)),
            InstKind::BitsConstant(bits) => Any::Bits(self.domain.bits_constant(*bits)),
            InstKind::Column { table, column } => {
                let number = self.tables.tables[*table].row(self.rows[table.index()])[*column];
                Any::Real(self.domain.constant(number))
            }
            InstKind::Op { op, args } => {
                // At most three operands, by the table; the places that are left repeat the first.
                let mut operands = [self.value(args[0]); 3];
                for (place, &arg) in operands.iter_mut().zip(args) {
                    *place = self.value(arg);
                }
                apply(self.domain, *op, &operands[..args.len()])
            }
            InstKind::Fold(fold) => {
                let parent = self.function.tables[fold.table].parent;
                let parent_row = parent.map_or(0, |parent| self.rows[parent.index()]);
                let mut accumulators: Vec<Any<D>> =
                    fold.initial.iter().map(|&value| self.value(value)).collect();
                let tables = self.tables;
                for &row in tables.tables[fold.table].range(parent_row) {
                    self.rows[fold.table.index()] = row as usize;
                    for (&param, &accumulator) in
                        self.function.blocks[fold.body].params.iter().zip(&accumulators)
                    {
                        self.values[param.index()] = Some(accumulator);
                    }
                    accumulators = self.block(fold.body);
                }
                for (&value, accumulator) in data.results.iter().zip(accumulators) {
                    self.values[value.index()] = Some(accumulator);
                }
                return;
            }
        };
        self.values[data.results[0].index()] = Some(result);
    }
}
