//! What is done with a model, and the programs that it takes: the one list of both.

use jbt_ir::domain::counting::{evaluations_per_row, of_selection};
use jbt_ir::limits::MAX_VALUES;
use jbt_ir::pass::{PIPELINE, run_pipeline};
use jbt_ir::{Selection, watch};
use jbt_lower::{Lowered, Lowering};
use jbt_model::check::CheckedNode;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::kind::NodeKind;
use jbt_model::query::Query;

use super::{Compiled, Need, PointScope};
use crate::error::CompileError;
use crate::kernel::{Purpose, grown};
use crate::parallel::PoolWorkers;

/// Something that is done with a compiled model.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Task {
    /// Answers at points, by an [`Evaluator`](crate::Evaluator).
    Points(Query),
    /// Meshes, by [`Polygonize`](crate::Polygonize).
    Mesh,
    /// Hits of rays, by a [`Tracer`](crate::Tracer); pictures ask for [`Query::SURFACE`].
    Rays(Query),
    /// Slices, by a [`Slicer`](crate::contour::Slicer).
    Slices(Query),
    /// Samples of a lattice, by a [`Sampler`](crate::sample::Sampler).
    Samples(Query),
    /// Measures, by a [`Solid`](crate::Solid).
    Solid,
}

impl Task {
    /// The programs that it takes.
    pub(crate) fn needs(self) -> Vec<Need> {
        let regional = |query| Need::Answers(PointScope::Regions, query);
        let field = regional(Query::FIELD);
        match self {
            Self::Points(query) => vec![Need::Answers(PointScope::Anywhere, query)],
            Self::Mesh => mesh_needs(false).concat(),
            Self::Rays(query) => vec![Need::Ranges, field, regional(query)],
            Self::Slices(query) if query == Query::FIELD => vec![Need::Ranges, field],
            Self::Slices(query) => vec![regional(query), Need::Ranges, field],
            Self::Samples(query) => vec![regional(query), Need::Ranges],
            Self::Solid => vec![Need::Ranges, field],
        }
    }
}

/// The programs of a mesh: those that find the cells that the surface crosses, and those of vertices; with
/// what decides, if it is to have sharp edges.
pub(crate) fn mesh_needs(sharp: bool) -> [[Need; 2]; 2] {
    let regional = |query| Need::Answers(PointScope::Regions, query);
    let gradient = if sharp { Need::Decisions } else { regional(Query::GRADIENT) };
    [[Need::Ranges, regional(Query::FIELD)], [regional(Query::SURFACE), gradient]]
}

/// By how many times passes may make a program longer: a logarithm has some 30 ops, its range and that of its
/// gradient several times as many.
const LARGEST_GROWTH: usize = 256;
/// By how many times a program of ranges may be longer than that for the field, when it is lowered.
const RANGES_GROWTH: usize = 4;

impl Compiled {
    /// Those of some tasks that the model is too large for: one of their programs would be beyond a limit,
    /// with what the task would say. No code is made. Programs of ordinary size are not looked at: they fit.
    ///
    /// # Errors
    /// What lowering says: numbers that leave the range of f32, or a program that is beyond a limit before
    /// any pass. No task can be done then.
    pub fn too_large_for(&self, tasks: &[Task]) -> Result<Vec<(Task, CompileError)>, CompileError> {
        watch::stoppable(|| {
            let lowering = Lowering::with(self.tree(), &PoolWorkers);
            // The program for all answers is the longest that lowering makes, but for that of ranges, which
            // is a few times that for the field.
            let longest = self.lowered(Some(&lowering), |lowering| lowering.answers(Query::ALL))?;
            if longest.function.values.len() <= MAX_VALUES / LARGEST_GROWTH / RANGES_GROWTH {
                return Ok(Vec::new());
            }
            let mut looked: Vec<(Purpose, Option<CompileError>)> = Vec::new();
            let mut refused = Vec::new();
            // A program for some answers is about as long as a part of that for all.
            let all = grown(longest.function, Purpose::Answers(Query::ALL));
            if all.as_ref().is_ok_and(|function| function.values.len() <= MAX_VALUES / 2) {
                looked.extend(Query::EVERY.map(|query| (Purpose::Answers(query), None)));
            } else {
                looked.push((Purpose::Answers(Query::ALL), all.err().map(|error| self.placed(error))));
                // Whatever is done with a model takes its field, so none of the others fits if that does not.
                let field = Need::Answers(PointScope::Anywhere, Query::FIELD);
                if let Some(error) = self.beyond(&lowering, field, Purpose::Answers(Query::FIELD))? {
                    return Ok(tasks.iter().map(|&task| (task, error.clone())).collect());
                }
            }
            for &task in tasks {
                for need in task.needs() {
                    let purpose = need.query().map_or(Purpose::Ranges, Purpose::Answers);
                    if looked.iter().all(|(known, _)| *known != purpose) {
                        looked.push((purpose, self.beyond(&lowering, need, purpose)?));
                    }
                    let of = looked.iter().find(|(known, _)| *known == purpose);
                    if let Some((_, Some(error))) = of {
                        refused.push((task, error.clone()));
                        break;
                    }
                }
            }
            Ok(refused)
        })?
    }

    /// How many distances to skeletons one point takes that is asked a query, with all rows. No code is made:
    /// what passes save is saved, and what they make longer stays as short as it is.
    ///
    /// # Errors
    /// What lowering says.
    pub fn evaluations_per_point(&self, query: Query) -> Result<u64, CompileError> {
        watch::stoppable(|| {
            let Lowered { function, tables } = self.lowered(None, |lowering| lowering.answers(query))?;
            let shorter = PIPELINE.iter().filter(|pass| !["legalize", "schedule"].contains(&pass.name));
            let function = run_pipeline(function, shorter, &mut |_, _| {});
            let all = Selection::new(&function, &tables);
            Ok(of_selection(&evaluations_per_row(&function), &all))
        })?
    }

    /// Why a program cannot be had, if passes make it too long.
    fn beyond<'t>(
        &'t self,
        lowering: &Lowering<'t>,
        need: Need,
        purpose: Purpose,
    ) -> Result<Option<CompileError>, CompileError> {
        let function = self.lowered(Some(lowering), |lowering| match need.query() {
            Some(query) => lowering.answers(query).map(|lowered| lowered.function),
            None => lowering.ranges().map(|ranges| ranges.function),
        })?;
        if function.values.len() <= MAX_VALUES / LARGEST_GROWTH {
            return Ok(None);
        }
        Ok(grown(function, purpose).err().map(|error| self.placed(error)))
    }

    /// An error about the length of a program, with a place: that of the longest formula of the model, which
    /// is most of a program that is too long, or of the whole model if there is none.
    pub(super) fn placed(&self, error: CompileError) -> CompileError {
        let CompileError::Model(told) = &error else { return error };
        let tree = self.tree();
        let steps = |node: &&CheckedNode| match &node.kind {
            NodeKind::Expression(expression) => expression.form().steps(),
            NodeKind::Primitive(_)
            | NodeKind::Particles(_)
            | NodeKind::Combine(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Warp(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => 0,
        };
        // The root is the last of those that have none.
        let place = tree.nodes().iter().max_by_key(steps).and_then(|node| node.span);
        let placed = told.iter().map(|one| Diagnostic { span: one.span.or(place), ..one.clone() });
        tree.diagnostics(placed.collect()).into()
    }
}
