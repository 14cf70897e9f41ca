//! Every primitive at every point: nobody may leave anything out, so this compares code with code.

use fidget::eval::MathFunction;
use fidget::render::RenderHints;
use jbt::{CheckedTree, Compiler, Engine, Points, Query};
use serde_json::json;

use super::contest::{Contest, Contestant};
use super::options::Options;
use super::oracle::{Oracle, Tolerance};
use super::report::ResultRow;
use crate::limit;
use crate::model::{Blob, blobs, cube, tree};
use crate::naive::{Walker, differences, separate};
use crate::peers::fidget::{Expression, FidgetModel, FieldTape, Gate, GradientTape, JitFunction, VmFunction};

const PRIMITIVES: usize = 200;
const POINTS: usize = 16_384;

/// A model and points, for everybody.
struct DenseTask {
    blobs: Vec<Blob>,
    tree: CheckedTree,
    points: Points,
    oracle: Oracle,
}

impl DenseTask {
    fn new(primitives: usize, points: usize) -> Self {
        let blobs = blobs(primitives, 1);
        let (tree, points) = (tree(&blobs), cube(points, 2));
        let oracle = Oracle::new(&tree, &points);
        Self { blobs, tree, points, oracle }
    }

    /// Planes for so many answers.
    fn planes<const N: usize>(&self) -> [Vec<f32>; N] {
        std::array::from_fn(|_| vec![f32::NAN; self.points.len()])
    }

    fn check(&self, planes: &[Vec<f32>], tolerance: Tolerance) -> Result<(), String> {
        let planes: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
        self.oracle.check(&planes, tolerance)
    }

    /// Ours, for a query, on an engine or the best one. Returns the engine's name.
    fn ours<'a>(&'a self, contest: &mut Contest<'a>, query: Query, engine: Option<Engine>) -> &'static str {
        let compiler = engine.map_or_else(Compiler::new, Compiler::for_engine);
        let evaluator = compiler.evaluator(&self.tree, query).expect("blobs compile");
        let mut samples = evaluator.samples();
        evaluator.eval(&self.points, &mut samples).expect("the buffers fit");
        let checked = self.check(samples.planes(), Tolerance::EXACT);
        let name = evaluator.engine().name();
        contest.enter(Contestant::Ours, "", checked, move || {
            evaluator.eval(&self.points, &mut samples).expect("the buffers fit");
        });
        name
    }

    /// Enters somebody who fills planes.
    fn enter<'a, const N: usize>(
        &'a self,
        contest: &mut Contest<'a>,
        contestant: Contestant,
        form: &'static str,
        tolerance: Tolerance,
        mut run: impl FnMut([&[f32]; 3], [&mut [f32]; N]) + 'a,
    ) {
        let mut planes = self.planes::<N>();
        run(self.points.planes(), planes.each_mut().map(Vec::as_mut_slice));
        let checked = self.check(&planes, tolerance);
        contest.enter(contestant, form, checked, move || {
            run(self.points.planes(), planes.each_mut().map(Vec::as_mut_slice));
        });
    }

    fn limit_field<'a>(&'a self, contest: &mut Contest<'a>) {
        let limit = limit::Blobs::new(&self.blobs);
        self.enter(contest, Contestant::Limit, "", Tolerance::EXACT, move |points, [field]| {
            limit.field(points, field);
        });
    }

    fn walk_field<'a>(&'a self, contest: &mut Contest<'a>) {
        let walker = Walker::new(&self.tree);
        self.enter(contest, Contestant::Walk, "", Tolerance::EXACT, move |points, [field]| {
            walker.field(points, field);
        });
    }

    /// fidget on one of its engines, with each gate.
    fn fidget_field<'a, F: MathFunction + RenderHints + 'a>(
        &'a self,
        contest: &mut Contest<'a>,
        contestant: Contestant,
    ) {
        for gate in Gate::ALL {
            let mut tape = FieldTape::new(&FidgetModel::<F>::compile(&self.expression(gate)));
            let run = move |points: [&[f32]; 3], [field]: [&mut [f32]; 1]| tape.eval(points, field);
            self.enter(contest, contestant, gate.name(), Tolerance::EXACT, run);
        }
    }

    fn expression(&self, gate: Gate) -> Expression {
        Expression::new(&self.blobs, gate)
    }

    /// The row of a contest whose unit is a primitive at a point.
    fn row(&self, case: &'static str, engine: &str, contest: Contest<'_>, options: Options) -> ResultRow {
        ResultRow {
            case,
            of: "",
            primitives: self.blobs.len(),
            points: self.points.len(),
            unit: "primitive and point",
            units: (self.blobs.len() * self.points.len()) as f64,
            standings: contest.run(options.effort()),
            extra: vec![("engine", json!(engine)), ("limit_level", json!(limit::level()))],
        }
    }
}

/// The field.
pub(super) fn field(options: Options) -> Vec<ResultRow> {
    let task = DenseTask::new(PRIMITIVES, POINTS);
    let mut contest = Contest::new();
    let engine = task.ours(&mut contest, Query::FIELD, None);
    task.limit_field(&mut contest);
    task.fidget_field::<JitFunction>(&mut contest, Contestant::FidgetJit);
    task.walk_field(&mut contest);
    vec![task.row("dense-field", engine, contest, options)]
}

/// Field and gradient.
pub(super) fn gradient(options: Options) -> Vec<ResultRow> {
    let task = DenseTask::new(PRIMITIVES, POINTS);
    let (limit, walker) = (limit::Blobs::new(&task.blobs), Walker::new(&task.tree));
    let mut contest = Contest::new();
    let engine = task.ours(&mut contest, Query::GRADIENT, None);
    task.enter(&mut contest, Contestant::Limit, "", Tolerance::EXACT, |points, out| {
        limit.gradient(points, out);
    });
    task.enter(&mut contest, Contestant::Separate, "", Tolerance::DIFFERENCES, |points, out| {
        differences(&walker, points, out);
    });
    for gate in Gate::ALL {
        let mut tape = GradientTape::new(&FidgetModel::<JitFunction>::compile(&task.expression(gate)));
        let run = move |points: [&[f32]; 3], out: [&mut [f32]; 4]| tape.eval(points, out);
        task.enter(&mut contest, Contestant::FidgetJit, gate.name(), Tolerance::EXACT, run);
    }
    vec![task.row("dense-gradient", engine, contest, options)]
}

/// Field, gradient and colour.
pub(super) fn full(options: Options) -> Vec<ResultRow> {
    let task = DenseTask::new(PRIMITIVES, POINTS);
    let (limit, walker) = (limit::Blobs::new(&task.blobs), Walker::new(&task.tree));
    let mut contest = Contest::new();
    let engine = task.ours(&mut contest, Query::ALL, None);
    task.enter(&mut contest, Contestant::Limit, "", Tolerance::EXACT, |points, out| limit.full(points, out));
    task.enter(&mut contest, Contestant::Walk, "", Tolerance::EXACT, |points, mut out: [&mut [f32]; 7]| {
        walker.full(points, &mut out);
    });
    let tolerance = Tolerance::DIFFERENCES;
    task.enter(&mut contest, Contestant::Separate, "", tolerance, |points, mut out: [&mut [f32]; 7]| {
        separate(&walker, points, &mut out);
    });
    vec![task.row("dense-full", engine, contest, options)]
}

/// The field without machine code.
pub(super) fn interpreter(options: Options) -> Vec<ResultRow> {
    let task = DenseTask::new(PRIMITIVES, POINTS);
    let mut contest = Contest::new();
    let engine = task.ours(&mut contest, Query::FIELD, Some(Engine::Lanes));
    task.limit_field(&mut contest);
    task.fidget_field::<VmFunction>(&mut contest, Contestant::FidgetVm);
    task.walk_field(&mut contest);
    vec![task.row("interpreter", engine, contest, options)]
}

/// The field, by number of primitives.
pub(super) fn scaling(options: Options) -> Vec<ResultRow> {
    let counts: &[usize] = if options.quick { &[20, 200, 2_000] } else { &[20, 200, 2_000, 20_000] };
    let row = |&count: &usize| {
        let task = DenseTask::new(count, 4_096);
        let mut contest = Contest::new();
        let engine = task.ours(&mut contest, Query::FIELD, None);
        task.limit_field(&mut contest);
        if count <= 2_000 {
            // Beyond, fidget compiles for seconds.
            task.fidget_field::<JitFunction>(&mut contest, Contestant::FidgetJit);
        }
        task.walk_field(&mut contest);
        let row = task.row("scaling", engine, contest, options);
        ResultRow { unit: "run", units: 1.0, ..row }
    };
    counts.iter().map(row).collect()
}
