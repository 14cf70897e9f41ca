//! A model that is compiled for pictures.

use jbt_model::check::CheckedTree;
use jbt_model::query::Query;

use crate::compiled::Compiled;
use crate::compiler::Compiler;
use crate::debug::brief_debug;
use crate::error::{CompileError, compiled_within_memory};
use crate::evaluator::Evaluator;
use crate::prune::Pruner;
use crate::solid::Solid;
use crate::trace::Tracer;

/// A model, compiled for pictures from any side, in any mode.
///
/// It is `Send + Sync`: threads may share it.
pub struct Renderer {
    pub(super) tracer: Tracer,
    pub(super) solid: Solid,
    /// Everything that is seen of a surface: where a region cuts the solid, and where a mesh leads the eye.
    pub(super) evaluator: Evaluator,
    /// The field, for meshes.
    pub(super) field: Evaluator,
    pub(super) pruner: Pruner,
}

brief_debug!(Renderer, "Renderer", this: evaluator = this.evaluator);

impl Renderer {
    /// A renderer of a model of which nothing else is asked: see [`of`](Self::of).
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn new(compiler: &Compiler, tree: &CheckedTree) -> Result<Self, CompileError> {
        Self::of(&compiler.compile(tree))
    }

    /// A renderer of a compiled model.
    ///
    /// # Errors
    /// The model is beyond a limit, or no engine is available.
    pub fn of(compiled: &Compiled) -> Result<Self, CompileError> {
        Ok(Self {
            tracer: Tracer::of(compiled, Query::SURFACE)?,
            solid: Solid::of(compiled)?,
            evaluator: compiled.regional(Query::SURFACE)?,
            field: compiled.regional(Query::FIELD)?,
            pruner: compiled.pruner()?,
        })
    }

    /// A renderer of another model, usually an edited one: see [`Compiled::updated`].
    ///
    /// # Errors
    /// Those of [`of`](Self::of).
    pub fn updated(&self, tree: &CheckedTree) -> Result<Self, CompileError> {
        compiled_within_memory(|| Self::of(&self.tracer.compiled().updated(tree)))
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
