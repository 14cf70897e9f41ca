//! A model whose evaluator runs straight code: what its regions run instead, and what its edits need.

use std::sync::{Arc, OnceLock};

use jbt_ir::{Function, Straight, Tables};

use crate::kernel::{Bound, Kernel};

/// The program that straight code was made from: its rows may be left out.
pub(crate) struct ByRows {
    pub(crate) straight: Arc<Straight>,
    pub(crate) lowered: Function,
    tables: Arc<Tables>,
    bound: OnceLock<Box<Bound>>,
}

impl ByRows {
    pub(crate) fn new(straight: Arc<Straight>, lowered: Function, tables: Tables) -> Self {
        Self { straight, lowered, tables: Arc::new(tables), bound: OnceLock::new() }
    }

    /// What runs it, by a kernel that is made for the first region.
    pub(crate) fn bound(&self, make: impl FnOnce(&Function) -> Arc<Kernel>) -> &Bound {
        self.bound.get_or_init(|| Box::new(make(&self.lowered).bind(Arc::clone(&self.tables))))
    }
}
