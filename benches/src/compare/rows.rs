//! Numbers become rows: what it takes to get from a model to its kernel, and to change a number.

use jbt::{CheckedTree, Compiler, Points, Query, Update};
use serde_json::json;

use super::contest::{Contest, Contestant};
use super::options::Options;
use super::oracle::{Oracle, Tolerance};
use super::report::ResultRow;
use crate::limit;
use crate::model::{Blob, blobs, cube, tree};
use crate::naive::Walker;
use crate::peers::fidget::{Expression, FidgetModel, FieldTape, Gate, JitFunction, VmFunction};

/// From a model to what answers with its field. fidget's time is that from its expression on: instructions
/// and tape.
pub(super) fn compile(options: Options) -> Vec<ResultRow> {
    [64, 512, 4_096].into_iter().map(|count| compile_of(count, options)).collect()
}

fn compile_of(count: usize, options: Options) -> ResultRow {
    let blobs = blobs(count, 1);
    let (tree, points) = (tree(&blobs), cube(1_000, 2));
    let oracle = Oracle::new(&tree, &points);
    let expressions = Gate::ALL.map(|gate| (gate, Expression::new(&blobs, gate)));
    let mut contest = Contest::new();
    let evaluator = Compiler::new().evaluator(&tree, Query::FIELD).expect("blobs compile");
    let engine = evaluator.engine().name();
    let mut samples = evaluator.samples();
    evaluator.eval(&points, &mut samples).expect("the buffers fit");
    contest.enter(Contestant::Ours, "", oracle.check(&[samples.field()], Tolerance::EXACT), || {
        Compiler::new().evaluator(&tree, Query::FIELD).expect("blobs compile")
    });
    for (gate, expression) in &expressions {
        let check =
            |tape: &mut FieldTape<JitFunction>| field_of(&points, &oracle, |p, field| tape.eval(p, field));
        let checked = check(&mut FieldTape::new(&FidgetModel::compile(expression)));
        contest.enter(Contestant::FidgetJit, gate.name(), checked, || {
            FieldTape::new(&FidgetModel::<JitFunction>::compile(expression))
        });
        contest.enter(Contestant::FidgetVm, gate.name(), Ok(()), || {
            FieldTape::new(&FidgetModel::<VmFunction>::compile(expression))
        });
    }
    let walker = Walker::new(&tree);
    let checked = field_of(&points, &oracle, |p, field| walker.field(p, field));
    contest.enter(Contestant::Walk, "", checked, || Walker::new(&tree));
    ResultRow {
        case: "compile",
        of: "",
        primitives: count,
        points: 0,
        unit: "primitive",
        units: count as f64,
        standings: contest.run(options.effort()),
        extra: vec![("engine", json!(engine))],
    }
}

/// Fills the field's plane, and checks it.
fn field_of(
    points: &Points,
    oracle: &Oracle,
    run: impl FnOnce([&[f32]; 3], &mut [f32]),
) -> Result<(), String> {
    let mut field = vec![f32::NAN; points.len()];
    run(points.planes(), &mut field);
    oracle.check(&[&field], Tolerance::EXACT)
}

/// A model, and the same with one radius changed.
struct EditCase {
    blobs: [Vec<Blob>; 2],
    trees: [CheckedTree; 2],
    points: Points,
    oracle: Oracle,
}

impl EditCase {
    fn new(count: usize, points: usize) -> Self {
        let before = blobs(count, 1);
        let mut after = before.clone();
        after[count / 2].radius *= 1.25;
        let blobs = [before, after];
        let trees = [tree(&blobs[0]), tree(&blobs[1])];
        let points = cube(points, 2);
        let oracle = Oracle::new(&trees[1], &points);
        Self { blobs, trees, points, oracle }
    }

    /// Enters somebody who goes from one of the two models to its field. The runs alternate between the
    /// models.
    fn enter<'a>(
        &'a self,
        contest: &mut Contest<'a>,
        contestant: Contestant,
        form: &'static str,
        mut run: impl FnMut(usize, [&[f32]; 3], &mut [f32]) + 'a,
    ) {
        let mut field = vec![f32::NAN; self.points.len()];
        run(0, self.points.planes(), &mut field);
        run(1, self.points.planes(), &mut field);
        let checked = self.oracle.check(&[&field], Tolerance::EXACT);
        let mut which = 0;
        contest.enter(contestant, form, checked, move || {
            run(which, self.points.planes(), &mut field);
            which = 1 - which;
        });
    }
}

/// Change a number, evaluate again.
pub(super) fn edit(options: Options) -> Vec<ResultRow> {
    let edit = &EditCase::new(512, 4_096);
    let mut contest = Contest::new();
    let mut evaluator = Compiler::new().evaluator(&edit.trees[1], Query::FIELD).expect("blobs compile");
    let engine = evaluator.engine().name();
    edit.enter(&mut contest, Contestant::Ours, "", move |which, points, field| {
        let update = evaluator.update(&edit.trees[which]).expect("blobs compile");
        assert_eq!(update, Update::Numbers, "an edit compiles nothing");
        evaluator.eval_planes(points, &mut [field]).expect("the buffers fit");
    });
    edit.enter(&mut contest, Contestant::Limit, "", |which, points, field| {
        limit::Blobs::new(&edit.blobs[which]).field(points, field);
    });
    for gate in Gate::ALL {
        edit.enter(&mut contest, Contestant::FidgetJit, gate.name(), move |which, points, field| {
            FidgetModel::<JitFunction>::new(&edit.blobs[which], gate).field().eval(points, field);
        });
        edit.enter(&mut contest, Contestant::FidgetVm, gate.name(), move |which, points, field| {
            FidgetModel::<VmFunction>::new(&edit.blobs[which], gate).field().eval(points, field);
        });
    }
    edit.enter(&mut contest, Contestant::Walk, "", |which, points, field| {
        Walker::new(&edit.trees[which]).field(points, field);
    });
    vec![ResultRow {
        case: "edit",
        of: "",
        primitives: edit.blobs[0].len(),
        points: edit.points.len(),
        unit: "run",
        units: 1.0,
        standings: contest.run(options.effort()),
        extra: vec![("engine", json!(engine))],
    }]
}
