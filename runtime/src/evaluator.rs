//! The evaluator: a model and a query become a kernel once; points become samples many times.
//!
//! `par_eval` cuts points into parts of [`PART`], one for a thread at a time. A part goes on as in `eval`.

use std::fmt;
use std::sync::Arc;

use crate::parallel::*;
use jbt_ir::domain::counting::{Evaluations, evaluations, of_selection};
use jbt_ir::{Selection, Tables, Verified, watch};
use jbt_model::check::{CheckedTree, NodeId};
use jbt_model::origin::ModelOrigin;
use jbt_model::query::Query;

use crate::boxes::Box3;
use crate::buffer::{Layout, Samples};
use crate::compiled::{Compiled, PointScope};
use crate::compiler::Compiler;
use crate::counter::{Counters, SharedCounters};
use crate::divide::Edit;
use crate::error::{CompileError, EvalError, compiled_within_memory};
use crate::finite_points;
use crate::kernel::{BoundKernel, Engine};
use crate::points::{AsPoints, Points};
use crate::program::AnswerProgram;
use crate::prune::{Pruner, Region};
use crate::span::span;

impl Compiler {
    /// An evaluator for a model and a query, of which nothing else is asked: see [`Compiled::evaluator`].
    ///
    /// # Errors
    /// Those of [`Compiled::evaluator`].
    pub fn evaluator(&self, tree: &CheckedTree, query: Query) -> Result<Evaluator, CompileError> {
        self.compile(tree).evaluator(query)
    }
}

impl Compiled {
    /// What answers a query. It has done nothing so far.
    ///
    /// # Errors
    /// The model is beyond a limit, or the engine cannot be had.
    pub fn evaluator(&self, query: Query) -> Result<Evaluator, CompileError> {
        Evaluator::of(self, PointScope::Anywhere, query)
    }

    /// What answers a query in regions: by rows, where [`evaluator`](Self::evaluator) may have straight code.
    pub(crate) fn regional(&self, query: Query) -> Result<Evaluator, CompileError> {
        Evaluator::of(self, PointScope::Regions, query)
    }
}

/// Points that are brought into planes at once: a multiple of every kernel's width, small enough for the
/// nearest cache.
const TRANSPOSED: usize = 512;
/// Points that one thread evaluates at once.
const PART: usize = 4096;

/// The beginning of a plane; what is left stays in its place.
fn split<'s>(plane: &mut &'s mut [f32], count: usize) -> &'s mut [f32] {
    let (first, rest) = std::mem::take(plane).split_at_mut(count);
    *plane = rest;
    first
}

/// What an update of an evaluator took.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Update {
    /// Only numbers were written.
    Numbers,
    /// The shape had changed: code was compiled.
    Code,
}

/// Answers one query about a compiled model, at any points, and counts what that takes.
///
/// It is `Send + Sync`: threads may share it and evaluate at once. It keeps the compiled model.
pub struct Evaluator {
    compiled: Compiled,
    scope: PointScope,
    program: Arc<AnswerProgram>,
    counters: SharedCounters,
}

impl fmt::Debug for Evaluator {
    /// What it answers and what runs it, without code and numbers.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Evaluator")
            .field("query", &self.query())
            .field("engine", &self.engine())
            .field("counters", &self.counters())
            .finish_non_exhaustive()
    }
}

impl Evaluator {
    /// An evaluator on the best engine that this machine has. To share code between models, use a
    /// [`Compiler`]; to ask more of one model, [`Compiler::compile`] it.
    ///
    /// # Errors
    /// Those of [`Compiler::evaluator`].
    pub fn compile(tree: &CheckedTree, query: Query) -> Result<Self, CompileError> {
        Compiler::new().evaluator(tree, query)
    }

    fn of(compiled: &Compiled, scope: PointScope, query: Query) -> Result<Self, CompileError> {
        let program = Arc::clone(compiled.answers(scope, query)?);
        Ok(Self { compiled: compiled.clone(), scope, program, counters: SharedCounters::default() })
    }

    /// Takes another model, usually an edited one. If it has the shape of the present one, only numbers are
    /// written. The [origin](Self::origin) stays, wherever the other model is.
    ///
    /// # Errors
    /// Those of [`Compiler::evaluator`]; the evaluator stays as it was.
    pub fn update(&mut self, tree: &CheckedTree) -> Result<Update, CompileError> {
        let next = self.updated(tree)?;
        let same = Arc::ptr_eq(&next.program.bound.kernel, &self.program.bound.kernel);
        *self = Self { counters: std::mem::take(&mut self.counters), ..next };
        Ok(if same { Update::Numbers } else { Update::Code })
    }

    /// As [`update`](Self::update), but another evaluator, which has done nothing so far.
    ///
    /// # Errors
    /// Those of [`Compiler::evaluator`].
    pub fn updated(&self, tree: &CheckedTree) -> Result<Self, CompileError> {
        compiled_within_memory(|| Self::of(&self.compiled.updated(tree), self.scope, self.query()))
    }

    /// What runs points of regions.
    fn regional(&self) -> &BoundKernel {
        if self.program.is_straight() {
            &self.compiled.regional_twin(&self.program).bound
        } else {
            &self.program.bound
        }
    }

    /// The numbers of what runs points of regions.
    fn regional_tables(&self) -> &Tables {
        self.regional().tables()
    }

    /// Whether another evaluator runs the same code at points of regions, and lays its answers out alike.
    fn is_alike(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.regional().kernel, &other.regional().kernel) && self.layout() == other.layout()
    }

    /// Where the field, or what is answered in regions, may differ from that of an earlier model. Each has a
    /// pruner.
    pub(crate) fn edit(&self, pruner: &Pruner, (before, pruner_before): (&Self, &Pruner)) -> Edit {
        if !self.is_alike(before) {
            return Edit::Everywhere;
        }
        let tables = [before, self].map(Self::regional_tables);
        pruner.edit(pruner_before).and(pruner.edit_of(pruner_before, tables))
    }

    /// The query that it answers.
    #[must_use]
    pub fn query(&self) -> Query {
        self.program.query
    }

    /// Where its coordinates count from: that of the model for which it was made. Points, planes, boxes and
    /// probes in f32 are about it; for most models it is the origin of the world.
    #[must_use]
    pub fn origin(&self) -> ModelOrigin {
        self.compiled.origin()
    }

    /// No points: those to come count from its origin.
    #[must_use]
    pub fn points(&self) -> Points {
        Points::about(self.origin())
    }

    /// What runs it.
    #[must_use]
    pub fn engine(&self) -> Engine {
        self.program.bound.kernel.engine()
    }

    /// Points that run together.
    pub(crate) fn block(&self) -> usize {
        self.program.bound.kernel.block()
    }

    /// Which plane of the samples holds what.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.program.layout
    }

    /// An empty buffer for its answers.
    #[must_use]
    pub fn samples(&self) -> Samples {
        Samples::new(self.layout().clone())
    }

    /// The answers at all points: [`Points`](crate::Points), or a slice, an array or a vector of points as
    /// they are. `samples` is resized; keep it for the next call
    /// to save the allocation.
    ///
    /// Points of f32 as they are count from the origin of the world; [`Points`] know where theirs count from.
    /// What counts from another [origin](Self::origin) than this evaluator is moved, in f64, and rounded
    /// once.
    ///
    /// It is serial: everything is done on the thread that calls. [`par_eval`](Self::par_eval) uses others
    /// too.
    ///
    /// ```
    /// use jbt::{Evaluator, Model, Query, build::point};
    /// let tree = Model::new(point([0, 0, 0], 1)).check()?;
    /// let evaluator = Evaluator::compile(&tree, Query::FIELD)?;
    /// let mut samples = evaluator.samples();
    /// evaluator.eval(&[[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [2.0, 0.0, 0.0]], &mut samples)?;
    /// assert_eq!(samples.field(), [1.0, 0.5, 0.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// A coordinate that is infinite counts as the largest finite number of its sign. At a point with a
    /// coordinate that is NaN, field and gradient
    /// are NaN and attributes have their defaults, on all engines; such a point is outside, as `field >= iso`
    /// says.
    ///
    /// # Errors
    /// If `samples` was made for another query or model.
    pub fn eval<P: AsPoints + ?Sized>(&self, points: &P, samples: &mut Samples) -> Result<(), EvalError> {
        let answers = self.room(points.count(), samples)?;
        self.eval_part(points, 0, points.count(), answers)
    }

    /// As [`eval`](Self::eval), on the threads of the rayon pool in which this is called. The answers have
    /// the same bits, for any number of threads.
    ///
    /// # Errors
    /// Those of [`eval`](Self::eval).
    pub fn par_eval<P: AsPoints + ?Sized>(&self, points: &P, samples: &mut Samples) -> Result<(), EvalError> {
        let count = points.count();
        let mut rest = self.room(count, samples)?;
        let parts: Vec<(usize, usize, Vec<&mut [f32]>)> = (0..count)
            .step_by(PART)
            .map(|start| {
                let points = PART.min(count - start);
                (start, points, rest.iter_mut().map(|plane| split(plane, points)).collect())
            })
            .collect();
        scatter(|watches| {
            parts.into_par_iter().try_for_each(|(start, count, answers)| {
                watches.hold(|| self.eval_part(points, start, count, answers))
            })
        })
    }

    /// Room for the answers at so many points.
    fn room<'s>(&self, points: usize, samples: &'s mut Samples) -> Result<Vec<&'s mut [f32]>, EvalError> {
        if samples.layout() != self.layout() {
            return Err(EvalError::Layout);
        }
        samples.try_resize(points)?;
        Ok(samples.planes_mut())
    }

    /// The answers at some of the points. Those that are no planes are transposed block by block.
    fn eval_part<P: AsPoints + ?Sized>(
        &self,
        points: &P,
        mut start: usize,
        mut count: usize,
        mut answers: Vec<&mut [f32]>,
    ) -> Result<(), EvalError> {
        span!("points");
        let moves = points.origin() != self.origin();
        if let Some(planes) = points.planes().filter(|_| !moves) {
            return self.eval_planes(planes.map(|plane| &plane[start..][..count]), &mut answers);
        }
        let mut scratch = [[0.0; TRANSPOSED]; 3];
        let mut block = Vec::with_capacity(answers.len());
        while count > 0 {
            let some = count.min(TRANSPOSED);
            points.copy_to(start, scratch.each_mut().map(|plane| &mut plane[..some]));
            if moves {
                self.bring(points.origin(), scratch.each_mut().map(|plane| &mut plane[..some]));
            }
            block.extend(answers.iter_mut().map(|plane| split(plane, some)));
            self.eval_planes(scratch.each_ref().map(|plane| &plane[..some]), &mut block)?;
            block.clear();
            (start, count) = (start + some, count - some);
        }
        Ok(())
    }

    /// Moves coordinates that count from another origin here.
    fn bring(&self, from: ModelOrigin, planes: [&mut [f32]; 3]) {
        let (from, to) = (from.point(), self.origin().point());
        for (axis, plane) in planes.into_iter().enumerate() {
            let moved = |x: f32| (f64::from(x) + from[axis] - to[axis]) as f32;
            plane.iter_mut().for_each(|x| *x = moved(*x));
        }
    }

    /// The answers at all points, into planes of the caller: one for each name of the
    /// [`layout`](Self::layout), as long as those of x, y and z, which count from the [origin](Self::origin).
    ///
    /// Any length will do; a multiple of 16 is fastest.
    ///
    /// # Errors
    /// If there are too many or too few planes, or their lengths differ.
    pub fn eval_planes(&self, points: [&[f32]; 3], answers: &mut [&mut [f32]]) -> Result<(), EvalError> {
        let lanes = if finite_points::are_finite(&points) {
            self.program.bound.run_with_finite_gradient(self.program.bound.all(), &points, answers)?
        } else {
            self.run_made_finite(&self.program.bound, self.program.bound.all(), points, answers)?
        };
        self.counters.add(points[0].len(), lanes, 0);
        Ok(())
    }

    /// As [`eval_planes`](Self::eval_planes), with the rows that matter in a region. The answers have the
    /// same bits, at points of the region's box; elsewhere they mean nothing. The region is one of a
    /// [`Pruner`](crate::Pruner) of the same model: one of another model with as many rows is not noticed,
    /// and gives wrong answers.
    ///
    /// # Errors
    /// Those of [`eval_planes`](Self::eval_planes), and a region of a model with other numbers of rows.
    pub fn eval_region(
        &self,
        region: &Region,
        points: [&[f32]; 3],
        answers: &mut [&mut [f32]],
    ) -> Result<(), EvalError> {
        // In a box with finite ends all points are finite. The box of all space takes any point, so points
        // are looked at.
        let ends = |x: &f32| x.abs() < f32::MAX;
        let Box3 { low, high } = region.bounds();
        let lanes = if low.iter().chain(&high).all(ends) || finite_points::are_finite(&points) {
            self.regional().run_with_finite_gradient(region.selection(), &points, answers)?
        } else {
            self.run_made_finite(self.regional(), region.selection(), points, answers)?
        };
        let left_out = self.evaluations_per_point().saturating_sub(self.evaluations_in(region));
        self.counters.add(points[0].len(), lanes, left_out);
        Ok(())
    }

    /// Runs points of which some are no places; returns how many lanes were computed.
    fn run_made_finite(
        &self,
        bound: &BoundKernel,
        selection: &Selection,
        points: [&[f32]; 3],
        answers: &mut [&mut [f32]],
    ) -> Result<usize, EvalError> {
        let placed = finite_points::made_finite(&points)?;
        let lanes =
            bound.run_with_finite_gradient(selection, &placed.each_ref().map(Vec::as_slice), answers)?;
        finite_points::blank(self.layout(), &points, answers);
        Ok(lanes)
    }

    /// What it has done so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.counters.snapshot(self.evaluations_per_point(), self.program.separate)
    }

    /// How many distances to skeletons one point takes.
    #[must_use]
    pub fn evaluations_per_point(&self) -> u64 {
        self.program.evaluations
    }

    /// How many distances to skeletons one point of a region takes.
    #[must_use]
    pub fn evaluations_in(&self, region: &Region) -> u64 {
        of_selection(&self.regional().kernel.per_row, region.selection())
    }

    /// The leaves behind the rows of a region, ascending.
    pub(crate) fn leaves_in(&self, region: &Region) -> Vec<NodeId> {
        let mut leaves = Vec::new();
        let bound = self.regional();
        let schemas = &bound.kernel.function.function().tables;
        for (table, rows) in bound.tables().tables.iter() {
            let slots = schemas[table].slots.len();
            let active = region.selection().active(table);
            watch::take_for(&leaves, active.len() * slots);
            for &row in active {
                leaves.extend(&rows.nodes[row as usize * slots..][..slots]);
            }
        }
        leaves.sort_unstable();
        leaves.dedup();
        leaves.into_iter().map(NodeId).collect()
    }

    /// How many ops one point of a region takes: a measure of the time.
    #[must_use]
    pub fn ops_in(&self, region: &Region) -> u64 {
        of_selection(&self.regional().kernel.ops_per_row, region.selection())
    }

    /// How many distances one point takes, by tree node.
    #[must_use]
    pub fn evaluations_by_node(&self) -> Evaluations {
        evaluations(&self.program.bound.kernel.function, self.program.bound.tables())
    }

    /// The verified function behind the code that runs points anywhere.
    #[must_use]
    pub fn program(&self) -> &Verified {
        &self.program.bound.kernel.function
    }

    /// The numbers that it runs on.
    #[must_use]
    pub fn tables(&self) -> &Tables {
        self.program.bound.tables()
    }
}
