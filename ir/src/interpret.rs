//! Runs a function in any domain, instruction by instruction, on one block of lanes.
//!
//! This is the reference: no registers are reused, nothing is reordered. With
//! [`crate::domain::scalar::Scalar`] it defines what every engine must give; with the counting domain it says
//! what a point costs.
//!
//! ```text
//! run block: for each instruction: look its operands up, call the op's method, remember the result
//!   a fold:  for each active row that the parent's row owns: make it the current row, run the body with the accumulators
//! ```
//!
//! The recursion is over nested folds, at most [`crate::limits::MAX_FOLD_DEPTH`] deep.

use crate::entity::{Block, Entity, Inst};
use crate::function::{Fold, Function, InstKind};
use crate::op::{Any, Domain, apply};
use crate::selection::Selection;
use crate::table::Tables;
use crate::verify::Verified;

/// One run of one function.
struct Interpretation<'a, D: Domain> {
    function: &'a Function,
    tables: &'a Tables,
    /// Which rows run; all that are active, if there is none.
    selection: Option<&'a Selection>,
    domain: &'a mut D,
    inputs: &'a [D::Real],
    values: Vec<Option<Any<D>>>,
    /// The current row of each table, and its position among the active rows of the selection.
    rows: Vec<(usize, usize)>,
}

/// The outputs of `function` for these inputs. `tables` fit the function ([`Tables::check`]); `inputs` has
/// one entry per plane.
pub fn run<D: Domain>(
    function: &Verified,
    tables: &Tables,
    domain: &mut D,
    inputs: &[D::Real],
) -> Vec<D::Real> {
    run_rows(function, tables, None, domain, inputs)
}

/// As [`run`], with the rows of a selection from these tables.
pub fn run_selected<D: Domain>(
    function: &Verified,
    tables: &Tables,
    selection: &Selection,
    domain: &mut D,
    inputs: &[D::Real],
) -> Vec<D::Real> {
    run_rows(function, tables, Some(selection), domain, inputs)
}

fn run_rows<D: Domain>(
    function: &Verified,
    tables: &Tables,
    selection: Option<&Selection>,
    domain: &mut D,
    inputs: &[D::Real],
) -> Vec<D::Real> {
    let function = function.function();
    let values = vec![None; function.values.len()];
    let rows = vec![(0, 0); function.tables.len()];
    let mut run = Interpretation { function, tables, selection, domain, inputs, values, rows };
    run.block(function.body).into_iter().map(Any::real).collect()
}

impl<'a, D: Domain> Interpretation<'a, D> {
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
                let number = self.tables.tables[*table].row(self.rows[table.index()].0)[*column];
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
                let accumulators = self.fold(fold);
                for (&value, accumulator) in data.results.iter().zip(accumulators) {
                    self.values[value.index()] = Some(accumulator);
                }
                return;
            }
        };
        self.values[data.results[0].index()] = Some(result);
    }

    /// The active rows that the parent's current row owns, and the position of the first one.
    fn active(&self, fold: &Fold) -> (&'a [u32], usize) {
        let parent = self.function.tables[fold.table].parent;
        let (row, position) = parent.map_or((0, 0), |parent| self.rows[parent.index()]);
        match self.selection {
            None => (self.tables.tables[fold.table].range(row), 0),
            Some(selection) => {
                let [begin, end] = [0, 1].map(|side| selection.starts(fold.table)[position + side] as usize);
                (&selection.active(fold.table)[begin..end], begin)
            }
        }
    }

    fn fold(&mut self, fold: &Fold) -> Vec<Any<D>> {
        let mut accumulators: Vec<Any<D>> = fold.initial.iter().map(|&value| self.value(value)).collect();
        let (rows, first) = self.active(fold);
        for (position, &row) in rows.iter().enumerate() {
            self.rows[fold.table.index()] = (row as usize, first + position);
            for (&param, &accumulator) in self.function.blocks[fold.body].params.iter().zip(&accumulators) {
                self.values[param.index()] = Some(accumulator);
            }
            accumulators = self.block(fold.body);
        }
        accumulators
    }
}
