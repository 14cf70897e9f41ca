//! Cancelling: from the first moment, also while programs are made, and never long between two looks.

use std::time::{Duration, Instant};

use jbt::contour::{Detail, Plane, Slicer};
use jbt::sample::Sampler;
use jbt::{
    CancelToken, Classified, CompileError, Compiler, Engine, ErrorKind, Evaluator, Fineness, Polygonize,
    Query, Task,
};
use jbt_testkit::scene::tree;

/// More than any gap: alone on a machine 50 ms are kept, beside other work a thread waits for its turn.
const LONGEST: Duration = Duration::from_millis(750);

const HERO: &str = include_str!("../../examples/hero.jbt");

/// A formula of so many sines: a program of 45 values for each.
fn sines(count: usize) -> String {
    let terms: Vec<String> = (1..=count).map(|i| format!("sin({i}*x)")).collect();
    format!("jbt 1\nexpression {{ {} }}\n", terms.join("+"))
}

/// Cancels a token after a moment; how long the work then takes to notice.
fn noticed(work: impl FnOnce(&CancelToken)) -> Duration {
    let token = CancelToken::new();
    std::thread::scope(|scope| {
        let canceller = scope.spawn(|| {
            std::thread::sleep(Duration::from_millis(30));
            token.cancel();
            Instant::now()
        });
        work(&token);
        let end = Instant::now();
        end.saturating_duration_since(canceller.join().expect("it sleeps"))
    })
}

#[test]
fn compiling_stops_and_can_begin_anew() {
    let tree = tree(&sines(12_000));
    let compiled = Compiler::new().compile(&tree);
    let took = noticed(|token| {
        let refused = token.watches(|| compiled.evaluator(Query::ALL));
        assert!(matches!(refused, Err(CompileError::Cancelled)), "{refused:?}");
    });
    assert!(took < LONGEST, "{took:?}");
    // Nothing of the half-made program is kept.
    let compiled = Compiler::new().compile(&self::tree(&sines(50)));
    let cancelled = CancelToken::new();
    cancelled.cancel();
    let refused = cancelled.watches(|| compiled.evaluator(Query::FIELD));
    assert!(refused.is_err_and(|error| error.kind() == ErrorKind::Cancelled));
    assert!(compiled.evaluator(Query::FIELD).is_ok());
}

#[test]
fn a_mesh_stops_while_its_programs_are_made() {
    let tree = tree(&sines(5_000));
    let compiler = Compiler::new();
    let settings = Polygonize {
        region: Some(jbt::Box3::new([0.0; 3], [1.0; 3])),
        fineness: Fineness::Resolution(2),
        ..Polygonize::default()
    };
    let took = noticed(|token| {
        let error = settings.mesh(&compiler, &tree).cancel(token).run().expect_err("it was cancelled");
        assert_eq!(error.kind(), ErrorKind::Cancelled, "{error}");
    });
    assert!(took < LONGEST, "{took:?}");
    let token = CancelToken::new();
    token.cancel();
    let mut told = 0;
    let watched = settings.mesh(&compiler, &tree).on_progress(|_| told += 1).cancel(&token).run();
    assert_eq!(watched.expect_err("it was cancelled").kind(), ErrorKind::Cancelled);
    assert_eq!(told, 1, "the first look comes before the first program");
}

/// The reference is the slowest engine: its points are the longest pieces of work.
/// What hears of progress.
type Hook<'a> = dyn FnMut(f32) + Send + 'a;

#[test]
fn looks_are_never_far_apart() {
    let tree = tree(HERO);
    let compiler = Compiler::for_engine(Engine::Scalar);
    let compiled = compiler.compile(&tree);
    let longest = |work: &dyn Fn(&mut Hook<'_>)| {
        let (mut last, mut longest) = (Instant::now(), Duration::ZERO);
        work(&mut |_| {
            longest = longest.max(last.elapsed());
            last = Instant::now();
        });
        longest
    };
    let settings = Polygonize { fineness: Fineness::Resolution(24), ..Polygonize::default() };
    let mesh = longest(&|told| drop(settings.with(&compiled).on_progress(told).run().expect("a mesh")));
    let sampler = Sampler::of(&compiled, Query::ALL).expect("a sampler");
    let lattice = settings.lattice(&tree).expect("a lattice");
    let samples = longest(&|told| drop(sampler.dense(&lattice).on_progress(told).run().expect("samples")));
    let slicer = Slicer::of(&compiled, &Plane::default(), Query::FIELD).expect("a slicer");
    let rectangle = slicer.rectangle().expect("a rectangle");
    let contour = longest(&|told| {
        drop(slicer.contour(&rectangle, &Detail::default()).on_progress(told).run().expect("a contour"));
    });
    for (what, took) in [("mesh", mesh), ("samples", samples), ("contour", contour)] {
        assert!(took < LONGEST, "{what}: {took:?}");
    }
}

#[test]
fn tasks_that_a_model_is_too_large_for_are_known_in_advance() {
    let of = |count| Compiler::new().compile(&tree(&sines(count)));
    let tasks = [Task::Points(Query::FIELD), Task::Mesh, Task::Samples(Query::FIELD)];
    assert!(of(100).too_large_for(&tasks).expect("it can be lowered").is_empty());
    let compiled = of(12_000);
    let refused = compiled.too_large_for(&tasks).expect("it can be lowered");
    // The place is that of the formula, as others are told of limits.
    let why = refused[0].1.to_string();
    assert!(why.contains(":2:1: limit: after the pass legalize"), "{why}");
    let refused: Vec<Task> = refused.into_iter().map(|(task, _)| task).collect();
    assert_eq!(refused, tasks[1..]);
    // And what was foreseen comes to be.
    assert!(Sampler::of(&compiled, Query::FIELD).is_err_and(|error| error.kind() == ErrorKind::Limit));
    assert!(Evaluator::compile(compiled.tree(), Query::FIELD).is_ok());
}
