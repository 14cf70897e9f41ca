//! What a pruner runs: the interval kernel with the numbers of a model, and what is known about its rows.

use std::sync::Arc;

use jbt_lower::prune_info::{PruneInfo, RangeFunction, Rule, TablePruneInfo};

use super::cull::Supports;
use crate::compiler::Compiler;
use crate::error::CompileError;
use crate::kernel::{Bound, Kernel, Purpose};
use crate::program::Program;

/// A program of ranges, and what there is to know about who leaves rows out.
pub(crate) struct RangeProgram {
    pub(super) bound: Bound,
    pub(super) info: PruneInfo,
    /// By table; `None` where rows are not left out by their supports.
    pub(super) supports: Vec<Option<Supports>>,
}

impl RangeProgram {
    /// The program of a model. `present` is a kernel that may have its shape.
    pub(crate) fn new(
        compiler: &Compiler,
        RangeFunction { function, tables, info }: RangeFunction,
        present: Option<&Arc<Kernel>>,
    ) -> Result<Self, CompileError> {
        let kernel = compiler.kernel(function, Purpose::Ranges, present)?;
        let supports = info.tables.values().map(supports).collect();
        Ok(Self { bound: compiler.bind(&kernel, tables), info, supports })
    }
}

impl Program for RangeProgram {
    fn kernel(&self) -> &Arc<Kernel> {
        &self.bound.kernel
    }
}

/// The supports of a table, if rows are left out by them.
fn supports(info: &TablePruneInfo) -> Option<Supports> {
    match info.rule {
        Rule::Never => None,
        Rule::Neutral | Rule::KeepOne | Rule::OnlyZero => Some(Supports::new(&info.supports)),
    }
}
