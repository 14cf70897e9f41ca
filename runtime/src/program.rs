//! What a slot of a compiled model holds: a bound kernel, and what is said about its answers.

use std::sync::{Arc, OnceLock};

use jbt_ir::domain::counting::of_selection;
use jbt_model::check::CheckedTree;
use jbt_model::query::Query;

use crate::buffer::Layout;
use crate::counter::walks;
use crate::kernel::{BoundKernel, Kernel};

/// A program that was made for a model.
pub(crate) trait ModelProgram {
    /// What runs it: another model of the same shape takes it too.
    fn kernel(&self) -> &Arc<Kernel>;
}

/// A program that answers a query at points.
pub(crate) struct AnswerProgram {
    pub(crate) query: Query,
    pub(crate) bound: BoundKernel,
    pub(crate) layout: Layout,
    /// Distances that separate walks compute at a point.
    pub(crate) separate: u64,
    /// Distances that it computes at a point with all of its rows.
    pub(crate) evaluations: u64,
    /// The same program row by row, if this one is straight code: made for the first region.
    pub(crate) for_regions: OnceLock<Arc<AnswerProgram>>,
}

impl AnswerProgram {
    /// The program of a model that answers a query.
    pub(crate) fn new(tree: &CheckedTree, query: Query, bound: BoundKernel) -> Self {
        Self::with_uses(tree, query, bound, tree.leaf_uses())
    }

    /// The same of a model with so many paths from its root to leaves. Of the tree, attributes alone count.
    pub(crate) fn with_uses(tree: &CheckedTree, query: Query, bound: BoundKernel, uses: u64) -> Self {
        let layout = Layout::new(query, tree.attributes());
        debug_assert_eq!(
            layout.names(),
            bound.kernel.function.function().outputs,
            "planes are named alike everywhere"
        );
        let separate = walks(query).saturating_mul(uses);
        let evaluations = of_selection(&bound.kernel.per_row, bound.all());
        Self { query, bound, layout, separate, evaluations, for_regions: OnceLock::new() }
    }

    /// Whether it is straight code, which knows no rows of regions.
    pub(crate) fn is_straight(&self) -> bool {
        self.bound.kernel.straight.is_some()
    }
}

impl ModelProgram for AnswerProgram {
    fn kernel(&self) -> &Arc<Kernel> {
        &self.bound.kernel
    }
}
