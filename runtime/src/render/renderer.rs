//! A model that is compiled for pictures.

use jbt_frontend::check::CheckedTree;
use jbt_frontend::query::Query;

use crate::compiler::Compiler;
use crate::debug::brief_debug;
use crate::error::CompileError;
use crate::evaluator::Evaluator;
use crate::solid::Solid;
use crate::trace::Tracer;

/// A model, compiled for pictures from any side, in any mode.
///
/// It is `Send + Sync`: threads may share it.
pub struct Renderer {
    pub(super) tracer: Tracer,
    pub(super) solid: Solid,
    /// Evaluates where a region cuts the solid and there is no surface to hit.
    pub(super) evaluator: Evaluator,
}

brief_debug!(Renderer, "Renderer", this: evaluator = this.evaluator);

impl Renderer {
    /// Compiles a model.
    ///
    /// # Errors
    /// The model is beyond a limit, or no engine is available.
    pub fn new(compiler: &Compiler, tree: &CheckedTree) -> Result<Self, CompileError> {
        Ok(Self {
            tracer: Tracer::new(compiler, tree, Query::ALL)?,
            solid: Solid::new(compiler, tree)?,
            evaluator: compiler.clone().for_edits().evaluator(tree, Query::ALL)?,
        })
    }

    /// A renderer for another model, usually an edited one. If it has the shape of this one, nothing is
    /// compiled.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn updated(&self, tree: &CheckedTree) -> Result<Self, CompileError> {
        Ok(Self {
            tracer: self.tracer.updated(tree)?,
            solid: self.solid.updated(tree)?,
            evaluator: self.evaluator.updated(tree)?,
        })
    }

    /// The model.
    #[must_use]
    pub fn tree(&self) -> &CheckedTree {
        self.tracer.tree()
    }

    /// The tracer of the surface.
    #[must_use]
    pub fn tracer(&self) -> &Tracer {
        &self.tracer
    }

    /// The evaluator at points.
    #[must_use]
    pub fn evaluator(&self) -> &Evaluator {
        &self.evaluator
    }
}
