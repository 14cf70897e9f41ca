//! Cancelling: from the first moment, also while programs are made, and never long between two looks.

use std::io::{self, Write};
use std::time::{Duration, Instant};

use jbt::contour::{Detail, Plane, Slicer};
use jbt::export::{Format, write};
use jbt::render::{Quality, RenderError};
use jbt::sample::Sampler;
use jbt::solid::Measure;
use jbt::{
    CancelToken, Classified, CompileError, Compiler, Engine, ErrorKind, EvalError, Evaluator, Fineness,
    Polygonize, Query, Render, Renderer, Solid, Task,
};
use jbt_testkit::gaps::WorkGaps;
use jbt_testkit::scene::tree;

/// The longest gap, in the processor's time. Alone on a machine 50 ms are kept; beside other work caches are
/// shared, and what optimises nothing takes many times as long.
const MOST: Duration = Duration::from_millis(if cfg!(debug_assertions) { 2_000 } else { 150 });
/// More than any gap by the clock: beside other work a thread waits for its turn.
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

/// The longest gap of work on one thread, in the processor's time.
fn gap(work: impl FnOnce(WorkGaps) + Send) -> Duration {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| WorkGaps::longest(work))
}

#[test]
fn looks_of_jobs_are_never_far_apart() {
    let tree = tree(HERO);
    // The reference is the slowest engine: its points are the longest pieces of work.
    let compiled = Compiler::for_engine(Engine::Scalar).compile(&tree);
    let settings = Polygonize { fineness: Fineness::Resolution(12), ..Polygonize::default() };
    let sampler = Sampler::of(&compiled, Query::ALL).expect("a sampler");
    let lattice = settings.lattice(&tree).expect("a lattice");
    let slicer = Slicer::of(&compiled, &Plane::default(), Query::FIELD).expect("a slicer");
    let rectangle = slicer.rectangle().expect("a rectangle");
    let detail = Detail { fineness: Fineness::Resolution(24), ..Detail::default() };
    let renderer = Renderer::of(&compiled).expect("a renderer");
    let render = Render { size: [32, 24], quality: Quality::Draft, ..Render::default() };
    let solid = Solid::of(&compiled).expect("a solid");
    let measure = Measure { fineness: Fineness::Resolution(8), ..Measure::default() };
    let gaps = [
        (
            "mesh",
            gap(|gaps| drop(settings.with(&compiled).on_progress(|_| gaps.look()).run().expect("a mesh"))),
        ),
        (
            "samples",
            gap(|gaps| drop(sampler.dense(&lattice).on_progress(|_| gaps.look()).run().expect("samples"))),
        ),
        (
            "contour",
            gap(|gaps| {
                drop(
                    slicer
                        .contour(&rectangle, &detail)
                        .on_progress(|_| gaps.look())
                        .run()
                        .expect("a contour"),
                );
            }),
        ),
        (
            "picture",
            gap(|gaps| drop(render.with(&renderer).on_progress(|_| gaps.look()).run().expect("a picture"))),
        ),
        (
            "measures",
            gap(|gaps| drop(solid.measure(&measure).on_progress(|_| gaps.look()).run().expect("measures"))),
        ),
    ];
    for (what, gap) in gaps {
        assert!(gap < MOST, "{what}: {gap:?}");
    }
}

#[test]
fn looks_of_what_is_no_job_are_never_far_apart() {
    let tree = tree(&sines(1_500));
    for engine in Engine::ALL {
        let compiled = Compiler::for_engine(engine).compile(&tree);
        let made = gap(|_| drop(compiled.evaluator(Query::FIELD)));
        assert!(made < MOST, "compiling, {engine}: {made:?}");
    }
    // As long as a look, each point of it: all of them together are a second.
    let evaluator = Compiler::for_engine(Engine::Scalar).evaluator(&tree, Query::FIELD).expect("it fits");
    let points = vec![[0.5_f32; 3]; 1_000];
    let mut samples = evaluator.samples();
    let evaluated = gap(|_| evaluator.par_eval(&points, &mut samples).expect("nobody stops it"));
    assert!(evaluated < MOST, "{evaluated:?}");
}

/// Work that has jobs in it stops by the token around it, also where a job compiles and evaluates nothing any
/// more: at its last word.
#[test]
fn jobs_stop_by_a_token_around_them() {
    let (compiler, tree) = (Compiler::new(), tree(HERO));
    let token = CancelToken::new();
    let settings = Polygonize { fineness: Fineness::Resolution(16), ..Polygonize::default() };
    let made = token.watches(|| {
        let stop = |part| {
            if part == 1.0 {
                token.cancel();
            }
        };
        settings.mesh(&compiler, &tree).on_progress(stop).run().map(drop)
    });
    let error = made.expect_err("it was cancelled");
    assert_eq!(error.kind(), ErrorKind::Cancelled, "{error}");
}

#[test]
fn evaluating_stops_on_all_threads() {
    let tree = tree(&sines(1_500));
    let evaluator = Compiler::for_engine(Engine::Scalar).evaluator(&tree, Query::FIELD).expect("it fits");
    let points = vec![[0.5_f32; 3]; 100_000];
    let mut samples = evaluator.samples();
    let took = noticed(|token| {
        let refused = token.watches(|| evaluator.par_eval(&points, &mut samples));
        assert_eq!(refused, Err(EvalError::Cancelled));
    });
    assert!(took < LONGEST, "{took:?}");
    let cancelled = CancelToken::new();
    cancelled.cancel();
    let probed = cancelled.watches(|| evaluator.probe([0.0; 3]).value());
    assert_eq!(probed, 0.0, "a single point is answered");
    assert!(evaluator.eval(&points[..2], &mut samples).is_ok(), "the watch is gone");
}

/// Cancels a token when the first bytes come, and takes its time.
struct CancellingWriter<'a> {
    token: &'a CancelToken,
    written: usize,
}

impl Write for CancellingWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.token.cancel();
        std::thread::sleep(Duration::from_millis(20));
        self.written += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn writing_a_mesh_stops_in_every_format() {
    let settings = Polygonize { fineness: Fineness::Resolution(150), ..Polygonize::default() };
    let mesh = settings.mesh(&Compiler::new(), &tree(HERO)).run().expect("it has a surface").mesh;
    for format in Format::ALL {
        let mut whole = Vec::new();
        write(&mesh, format, &mut whole).expect("nobody stops it");
        let token = CancelToken::new();
        let mut out = CancellingWriter { token: &token, written: 0 };
        let refused = token.watches(|| write(&mesh, format, &mut out)).expect_err("it is stopped");
        assert_eq!(refused.kind(), ErrorKind::Cancelled, "{format}: {refused}");
        assert!((1..whole.len()).contains(&out.written), "{format}: {} of {}", out.written, whole.len());
    }
}

#[test]
fn a_picture_stops_while_its_rays_are_followed() {
    let tree = tree(HERO);
    let renderer = Renderer::new(&Compiler::for_engine(Engine::Scalar), &tree).expect("a renderer");
    let render = Render { size: [640, 480], quality: Quality::Best, ..Render::default() };
    let took = noticed(|token| {
        let stopped = render.with(&renderer).cancel(token).run();
        assert!(matches!(stopped, Err(RenderError::Cancelled)), "{stopped:?}");
    });
    assert!(took < LONGEST, "{took:?}");
    // A token around a job stops it as well.
    let cancelled = CancelToken::new();
    cancelled.cancel();
    let stopped = cancelled.watches(|| render.with(&renderer).run());
    assert!(matches!(stopped, Err(RenderError::Cancelled)), "{stopped:?}");
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

#[test]
fn programs_that_are_too_large_are_told_apart() {
    let queries = Query::EVERY.map(Task::Points);
    let mut told = Vec::new();
    // Programs that have half of their length to spare, and those of which the field alone fits.
    for count in [4_000, 20_000] {
        let compiled = Compiler::for_engine(Engine::Scalar).compile(&tree(&sines(count)));
        let refused = compiled.too_large_for(&queries).expect("it can be lowered");
        for query in [Query::FIELD, Query::ALL] {
            let foreseen = refused.iter().any(|(task, _)| *task == Task::Points(query));
            assert_eq!(compiled.evaluator(query).is_err(), foreseen, "{count} sines, {query:?}");
        }
        told.push(refused.len());
    }
    assert!(told[0] == 0 && (1..queries.len()).contains(&told[1]), "{told:?}");
}
