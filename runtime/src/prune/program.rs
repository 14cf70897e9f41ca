//! What a pruner runs: the interval kernel with the numbers of a model, and what is known about its rows.

use std::sync::Arc;

use jbt_lower::prune_info::{PruneInfo, RangeFunction, Rule, TablePruneInfo};

use super::contest::Contests;
use super::cull::RowSupports;
use crate::compiler::Compiler;
use crate::error::CompileError;
use crate::kernel::{BoundKernel, Kernel, Purpose};
use crate::program::ModelProgram;

/// The range program of a model, and what one has to know to leave its rows out.
pub(crate) struct RangeProgram {
    pub(super) bound: BoundKernel,
    pub(super) info: PruneInfo,
    /// By table; `None` where rows are not left out by their supports.
    pub(super) supports: Vec<Option<RowSupports>>,
    pub(super) contests: Contests,
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
        let contests = Contests::new(compiler, &info, &tables);
        Ok(Self { bound: compiler.bind(&kernel, tables), info, supports, contests })
    }
}

impl ModelProgram for RangeProgram {
    fn kernel(&self) -> &Arc<Kernel> {
        &self.bound.kernel
    }
}

/// The supports of a table, if rows are left out by them.
fn supports(info: &TablePruneInfo) -> Option<RowSupports> {
    match info.rule {
        Rule::Never => None,
        Rule::Neutral | Rule::KeepOne | Rule::OnlyZero => Some(RowSupports::new(&info.supports)),
    }
}
