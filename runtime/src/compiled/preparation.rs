//! Programs that are made a few at a time.

use std::sync::OnceLock;

use jbt_ir::watch;
use jbt_lower::{Lowering, Workers as _};

use super::{Compiled, Need};
use crate::error::CompileError;
use crate::parallel::PoolWorkers;

impl Compiled {
    /// Makes those of some programs that are not there yet, of one lowering of the model, on the rayon pool
    /// in which this is called.
    ///
    /// # Errors
    /// Those of the first program of the list that cannot be had.
    pub(crate) fn prepare(&self, needs: &[Need]) -> Result<(), CompileError> {
        Preparation::new(self).prepare(needs)
    }
}

/// A model whose programs are made a few at a time, of one lowering.
pub(crate) struct Preparation<'t> {
    compiled: &'t Compiled,
    /// Made for the first program that is not there.
    lowering: OnceLock<Lowering<'t>>,
}

impl<'t> Preparation<'t> {
    pub(crate) fn new(compiled: &'t Compiled) -> Self {
        Self { compiled, lowering: OnceLock::new() }
    }

    /// The model.
    pub(crate) fn compiled(&self) -> &'t Compiled {
        self.compiled
    }

    /// See [`Compiled::prepare`].
    pub(crate) fn prepare(&self, needs: &[Need]) -> Result<(), CompileError> {
        let Self { compiled, lowering } = self;
        watch::stoppable(|| {
            let mut missing: Vec<Need> = Vec::with_capacity(needs.len());
            for &need in needs {
                if !compiled.is_made(need) && !missing.contains(&need) {
                    missing.push(need);
                }
            }
            if !missing.is_empty() {
                let lowering = lowering.get_or_init(|| Lowering::with(compiled.tree(), &PoolWorkers));
                // What went wrong is kept, and told below.
                PoolWorkers.each(missing.len(), &|index| {
                    drop(compiled.make(missing[index], Some(lowering)));
                });
            }
            needs.iter().try_for_each(|need| compiled.make(*need, None))
        })?
    }
}
