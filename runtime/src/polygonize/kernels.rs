//! The kernels of a mesh as a field, and the pruner that says what matters where.

use std::sync::OnceLock;

use jbt_model::query::Query;
use smallvec::SmallVec;

use crate::compiled::{Compiled, Decisions, Preparation, mesh_needs};
use crate::counter::Counters;
use crate::divide::Edit;
use crate::error::{CompileError, EvalError};
use crate::evaluator::Evaluator;
use crate::kernel::Engine;
use crate::mesh::{Field, FieldWork};
use crate::prune::{PruneCounters, Pruned, Pruner, Region};

/// What a mesh asks: a pruner, and three evaluators for regions.
pub(crate) struct Kernels {
    pruner: Pruner,
    field: Evaluator,
    /// Made by whoever is idle while the cells are found.
    of_vertices: OnceLock<VertexKernels>,
}

/// What is asked at vertices.
struct VertexKernels {
    gradient: Evaluator,
    all: Evaluator,
    /// What tells which operands decide, if edges are wanted and there are any.
    decisions: Option<Decisions>,
}

impl Kernels {
    /// All of a compiled model.
    pub(crate) fn new(compiled: &Compiled, sharp: bool) -> Result<Self, CompileError> {
        let preparation = Preparation::new(compiled);
        // Nobody waits for some of them: all at once.
        preparation.prepare(&mesh_needs(sharp).concat())?;
        let kernels = Self::of_cells(&preparation)?;
        kernels.prepare_vertices(&preparation, sharp)?;
        Ok(kernels)
    }

    /// Those that find the cells that the surface crosses. Nothing else may be asked before
    /// [`prepare_vertices`](Self::prepare_vertices).
    pub(super) fn of_cells(preparation: &Preparation<'_>) -> Result<Self, CompileError> {
        let [of_cells, _] = mesh_needs(false);
        preparation.prepare(&of_cells)?;
        let compiled = preparation.compiled();
        let (pruner, field) = (compiled.pruner()?, compiled.regional(Query::FIELD)?);
        Ok(Self { pruner, field, of_vertices: OnceLock::new() })
    }

    /// Makes the others.
    pub(super) fn prepare_vertices(
        &self,
        preparation: &Preparation<'_>,
        sharp: bool,
    ) -> Result<(), CompileError> {
        let [_, of_vertices] = mesh_needs(sharp);
        preparation.prepare(&of_vertices)?;
        let compiled = preparation.compiled();
        let [gradient, all] = [Query::GRADIENT, Query::SURFACE].map(|query| compiled.regional(query));
        let decisions = if sharp { compiled.decisions()? } else { None };
        let made = VertexKernels { gradient: gradient?, all: all?, decisions };
        self.of_vertices.get_or_init(|| made);
        Ok(())
    }

    fn of_vertices(&self) -> &VertexKernels {
        self.of_vertices.get().expect("made before there are vertices")
    }

    /// Whether the mesh may have edges.
    pub(crate) fn is_sharp(&self) -> bool {
        self.of_vertices().decisions.is_some()
    }

    /// What runs the field; the others may have fallen back to the interpreter.
    pub(super) fn engine(&self) -> Engine {
        self.field.engine()
    }

    /// What the field kernel, the gradient kernel and the full one have done.
    pub(super) fn counters(&self) -> [Counters; 3] {
        let VertexKernels { gradient, all, .. } = self.of_vertices();
        [&self.field, gradient, all].map(Evaluator::counters)
    }

    /// What the pruner has done.
    pub(super) fn pruned(&self) -> PruneCounters {
        self.pruner.counters()
    }

    /// Where the field or an attribute of this model may differ from those of an earlier one.
    pub(crate) fn edit(&self, before: &Self) -> Edit {
        let [now, then] = [self, before].map(|kernels| &kernels.of_vertices().all);
        now.edit(&self.pruner, (then, &before.pruner))
    }

    /// Distances that the field takes at a point, with all rows.
    pub(super) fn evaluations_per_point(&self) -> u64 {
        self.field.evaluations_per_point()
    }
}

impl Pruned for Kernels {
    fn pruner(&self) -> &Pruner {
        &self.pruner
    }
}

impl Field for Kernels {
    fn attributes(&self) -> Vec<(String, usize)> {
        let layout = self.of_vertices().all.layout();
        layout.attributes().map(|(name, _, width)| (name.to_owned(), width)).collect()
    }

    fn work(&self, region: &Region) -> FieldWork {
        FieldWork { evaluations: self.field.evaluations_in(region), ops: self.field.ops_in(region) }
    }

    fn is_sharp(&self) -> bool {
        self.is_sharp()
    }

    fn decided(
        &self,
        region: &Region,
        [x, y, z]: [&[f32]; 3],
        field: &mut [f32],
        [gx, gy, gz]: [&mut [f32]; 3],
        signature: &mut [f32],
    ) -> Result<(), EvalError> {
        let VertexKernels { gradient, decisions, .. } = self.of_vertices();
        match decisions {
            Some(decisions) => {
                let answers = &mut [field, gx, gy, gz, signature];
                decisions.eval_region(region.selection(), [x, y, z], answers)
            }
            None => {
                signature.fill(0.0);
                gradient.eval_region(region, [x, y, z], &mut [field, gx, gy, gz])
            }
        }
    }

    fn field(
        &self,
        region: &Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
    ) -> Result<(), EvalError> {
        self.field.eval_region(region, [x, y, z], &mut [field])
    }

    fn gradient(
        &self,
        region: &Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        [gx, gy, gz]: [&mut [f32]; 3],
    ) -> Result<(), EvalError> {
        self.of_vertices().gradient.eval_region(region, [x, y, z], &mut [field, gx, gy, gz])
    }

    fn all(
        &self,
        region: &Region,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        field: &mut [f32],
        [gx, gy, gz]: [&mut [f32]; 3],
        attributes: &mut [&mut [f32]],
    ) -> Result<(), EvalError> {
        // Small bricks have few points: a list in memory would be a part of their time.
        let mut planes: SmallVec<[&mut [f32]; 8]> = SmallVec::new();
        planes.extend([field, gx, gy, gz]);
        planes.extend(attributes.iter_mut().map(|plane| &mut **plane));
        self.of_vertices().all.eval_region(region, [x, y, z], &mut planes)
    }
}
