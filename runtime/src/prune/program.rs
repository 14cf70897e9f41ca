//! What a pruner runs: the interval kernel with the numbers of a model, and what is known about its rows.

use std::sync::Arc;

use jbt_ir::{Function, Table, Tables};
use jbt_lower::prune_info::{PruneInfo, RangeFunction, Rule, Support, TablePruneInfo};

use super::contest::Contests;
use super::cull::RowSupports;
use super::root::{BoundedRows, RowTrees};
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
    pub(super) trees: RowTrees,
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
        let trees = RowTrees::new(tables.tables.len());
        Ok(Self { bound: compiler.bind(&kernel, tables), info, supports, contests, trees })
    }
}

impl RangeProgram {
    /// All rows, and what leaves them out.
    pub(super) fn bounded_rows(&self) -> BoundedRows<'_> {
        BoundedRows { all: self.bound.all(), info: &self.info, supports: &self.supports }
    }

    /// What is known about the rows.
    pub(crate) fn info(&self) -> &PruneInfo {
        &self.info
    }

    /// The range function as it was lowered.
    pub(crate) fn lowered(&self) -> &Function {
        &self.bound.kernel.lowered
    }

    /// The numbers.
    pub(crate) fn tables(&self) -> &Tables {
        self.bound.tables()
    }

    /// The program of an edited model with the same rows, which has these numbers, and these supports of some
    /// rows.
    pub(crate) fn patched(
        &self,
        compiler: &Compiler,
        tables: Tables,
        changed: &[(Table, usize, Support)],
    ) -> Self {
        let mut info = self.info.clone();
        for &(table, row, support) in changed {
            Arc::make_mut(&mut info.tables[table].supports)[row] = support;
        }
        let supports: Vec<Option<RowSupports>> = info.tables.values().map(supports).collect();
        let contests = Contests::new(compiler, &info, &tables);
        let bound = compiler.bind(&self.bound.kernel, tables);
        let rows = changed.iter().map(|&(table, row, _)| (table, row));
        let now = BoundedRows { all: bound.all(), info: &info, supports: &supports };
        let trees = self.trees.refitted([self.bounded_rows(), now], rows);
        Self { bound, info, supports, contests, trees }
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
