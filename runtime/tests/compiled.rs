//! One compiled model: whatever looks at it, each program is compiled and given its numbers once, and nothing
//! is that nobody asks for.

use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use jbt::boxes::Divisible as _;
use jbt::build::{particles, point};
use jbt::contour::{Detail, Plane, Rectangle, Slicer};
use jbt::sample::Sampler;
use jbt::solid::Measure;
use jbt::{
    Box3, CheckedModel, CheckedTree, CompileCounters, Compiled, Compiler, Engine, Fineness, Model,
    Polygonize, Query, Ray, Render, Renderer, Solid, Tracer, Tree, Update,
};
use rayon::prelude::*;

fn balls(count: usize, radius: f64) -> CheckedTree {
    let ball = |i: usize| point([0.4 * i as f64, 0.0, 0.0], radius).color([1.0, 0.5, 0.0]);
    Model::new((0..count).map(ball).sum::<Tree>()).check().expect("a good model")
}

fn made(compiled: &Compiled) -> [u64; 2] {
    let CompileCounters { kernels, bound, .. } = compiled.compiler().counters();
    [kernels, bound]
}

const COARSE: Polygonize = Polygonize {
    region: None,
    fineness: Fineness::Resolution(16),
    verify: false,
    thin_parts: true,
    sharp: true,
};
const DOWN: Ray = Ray { origin: [0.0, 0.0, 4.0], direction: [0.0, 0.0, -1.0], span: [0.0, 8.0] };

/// A mesh, slices, rays, measures, a picture and samples of a model.
fn look(compiled: &Compiled) {
    let mesh = COARSE.with(compiled).run().expect("it has a mesh").mesh;
    assert!(!mesh.triangles.is_empty());
    let slicer = Slicer::of(compiled, &Plane::default(), Query::FIELD).expect("it compiles");
    let contour = slicer.contour(&slicer.rectangle().unwrap(), &Detail::default()).run().unwrap();
    assert!(!contour.loops.is_empty());
    let tracer = Tracer::of(compiled, Query::ALL).expect("it compiles");
    assert!(tracer.first(&DOWN, 0.01).unwrap().is_some());
    let coarse = Measure { fineness: COARSE.fineness, ..Measure::default() };
    assert!(Solid::of(compiled).expect("it compiles").measure(&coarse).run().unwrap().volume.estimate > 0.0);
    let render = Render { size: [16, 16], ..Render::default() };
    let picture = render.with(&Renderer::of(compiled).expect("it compiles")).run().unwrap();
    assert!(picture.report.pixels_hit > 0);
    Sampler::of(compiled, Query::GRADIENT).expect("it compiles");
}

#[test]
fn whatever_looks_at_a_model_shares_its_programs() {
    let compiled = Compiler::for_engine(Engine::Lanes).compile(&balls(5, 0.7));
    assert_eq!(made(&compiled), [0; 2], "nothing has been asked");
    look(&compiled);
    // Ranges, the field, the gradient, everything.
    assert_eq!(made(&compiled), [4; 2]);
    look(&compiled.clone());
    compiled.evaluator(Query::ALL).expect("it compiles");
    assert_eq!(made(&compiled), [4; 2], "they are there");
    Slicer::of(&compiled, &Plane::default(), Query::ATTRIBUTES).expect("it compiles");
    assert_eq!(made(&compiled), [5; 2], "attributes alone are another program");
}

#[test]
fn nothing_is_compiled_that_nobody_needs() {
    let compiled = || Compiler::for_engine(Engine::Lanes).compile(&balls(5, 0.7));
    let asked = |ask: fn(&Compiled)| {
        let compiled = compiled();
        ask(&compiled);
        made(&compiled)
    };
    assert_eq!(asked(|compiled| drop(compiled.evaluator(Query::ALL).unwrap())), [1; 2]);
    assert_eq!(asked(|compiled| drop(compiled.pruner().unwrap())), [1; 2]);
    assert_eq!(asked(|compiled| drop(Solid::of(compiled).unwrap())), [2; 2]);
    assert_eq!(asked(|compiled| drop(Tracer::of(compiled, Query::FIELD).unwrap())), [2; 2]);
    assert_eq!(asked(|compiled| drop(Tracer::of(compiled, Query::ALL).unwrap())), [3; 2]);
    assert_eq!(asked(|compiled| drop(Renderer::of(compiled).unwrap())), [3; 2]);
    assert_eq!(asked(|compiled| drop(COARSE.with(compiled).run().unwrap())), [4; 2]);
}

#[test]
fn an_edit_of_numbers_compiles_nothing() {
    let compiled = Compiler::for_engine(Engine::Lanes).compile(&balls(5, 0.7));
    look(&compiled);
    let edited = compiled.updated(&balls(5, 0.9));
    assert_eq!(made(&edited), [4; 2], "an edit is not asked yet");
    look(&edited);
    assert_eq!(made(&edited), [4, 8]);
    // Without having been asked, it hands on what it has from the model before.
    let later = edited.updated(&balls(6, 0.5)).updated(&balls(7, 0.5));
    Solid::of(&later).expect("it compiles");
    assert_eq!(made(&later), [4, 10]);
    // Another shape is compiled.
    let carved = Model::new(point([0, 0, 0], 1) - point([1, 0, 0], 1)).check().expect("a good model");
    Solid::of(&later.updated(&carved)).expect("it compiles");
    assert_eq!(made(&later), [6, 12]);
}

#[test]
fn users_count_their_own_work() {
    let compiled = Compiler::for_engine(Engine::Lanes).compile(&balls(5, 0.7));
    let [one, two] = [(); 2].map(|()| Tracer::of(&compiled, Query::ALL).expect("it compiles"));
    one.first(&DOWN, 0.01).unwrap();
    assert_eq!((one.counters().rays, two.counters().rays), (1, 0));
    assert!(one.counters().points > 0);
    assert_eq!((two.counters().points, two.counters().boxes), (0, 0));
    let mesh = || COARSE.with(&compiled).run().expect("it has a mesh");
    assert_eq!(mesh().counters, mesh().counters);
    assert_eq!(mesh().counters, COARSE.mesh(compiled.compiler(), compiled.tree()).run().unwrap().counters);
}

/// Threads that ask at once get one program.
#[test]
fn threads_wait_for_one_program() {
    let compiled = Compiler::for_engine(Engine::Lanes).compile(&balls(200, 0.7));
    thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| Tracer::of(&compiled, Query::ALL).expect("it compiles"));
        }
    });
    assert_eq!(made(&compiled), [3; 2]);
}

/// Straight code and rows are two programs of one query: points anywhere run the one, regions the other.
#[test]
fn straight_code_and_rows_are_made_when_they_are_asked_for() {
    let wave = |z: f64| format!("expression {{ sin(3 * x + 0.5) * cos(5 * y) * exp(-(z - {z})^2) * 0.75 }}");
    let text = format!("jbt 1 union {{ {} }}", [0.1, 0.2, 0.3, 0.6].map(wave).concat());
    let tree = jbt::text::model(&text).expect("a good text").check().expect("a good model");
    let compiled = Compiler::for_engine(Engine::Lanes).compile(&tree);
    let evaluator = compiled.evaluator(Query::FIELD).expect("it compiles");
    let pruner = compiled.pruner().expect("it compiles");
    assert_eq!(made(&compiled), [2; 2]);
    let point = [[0.3_f32], [0.1], [0.2]];
    let planes = point.each_ref().map(|plane| &plane[..]);
    let (mut here, mut there) = ([0.0], [0.0]);
    evaluator.eval_planes(planes, &mut [&mut here]).unwrap();
    assert_eq!(made(&compiled), [2; 2]);
    evaluator.eval_region(&pruner.everywhere(), planes, &mut [&mut there]).unwrap();
    assert_eq!(here, there);
    assert_eq!(made(&compiled), [3; 2]);
    Tracer::of(&compiled, Query::FIELD).expect("it compiles");
    assert_eq!(made(&compiled), [3; 2], "rays run rows, which are there");
    assert_eq!(compiled.evaluator(Query::FIELD).unwrap().update(&tree).unwrap(), Update::Numbers);
}

/// Points with numbers of their own, the leaves of one sum.
fn blobs(count: usize, seed: u64) -> Vec<Tree> {
    let mut rng = fastrand::Rng::with_seed(seed);
    let mut coordinate = move || 2.0 * rng.f64() - 1.0;
    let mut blob = |n: usize| {
        let at = [coordinate(), coordinate(), coordinate()];
        let leaf = if n.is_multiple_of(3) {
            jbt::build::segment(at, at.map(|c| c + 0.1), 0.3)
        } else {
            point(at, 0.4).strength(if n.is_multiple_of(7) { -0.5 } else { 1.0 })
        };
        let leaf = if n.is_multiple_of(5) { leaf.translate([0.1, 0.0, 0.0]) } else { leaf };
        if n.is_multiple_of(4) { leaf } else { leaf.color([coordinate().abs(), 0.5, 0.2]) }
    };
    (0..count).map(&mut blob).collect()
}

/// A model, edited leaf by leaf: what was patched has the tables, the supports and the answers of what is
/// made anew.
#[test]
fn patched_programs_are_those_of_the_model() {
    let others = blobs(60, 2);
    for operator in 0..4 {
        let mut leaves = blobs(60, 1);
        let model = |leaves: &[Tree]| {
            let leaves = leaves.iter().cloned();
            Model::new(match operator {
                0 => Tree::sum(leaves),
                1 => Tree::blend(3.0, leaves).translate([0.3, 0.0, 0.0]),
                2 => Tree::union(leaves).color([0.5, 0.5, 0.5]),
                _ => Tree::sum(leaves).twist(jbt::build::Axis::Z, 0.5),
            })
        };
        let compiler = Compiler::for_engine(Engine::Lanes);
        let mut checked = CheckedModel::new(&model(&leaves)).expect("a good model");
        let mut slicer = Slicer::of(&compiler.compile(checked.tree()), &Plane::default(), Query::ALL);
        let mut evaluator = compiler.compile(checked.tree()).evaluator(Query::ALL).expect("it compiles");
        let mut compiled = compiler.compile(checked.tree());
        let _ = Polygonize::default().with(&compiled).run().expect("it has a mesh");
        for (n, other) in others.iter().enumerate() {
            leaves[n] = other.clone();
            let edited = model(&leaves);
            let tree = checked.edit(&edited).expect("a good model").clone();
            assert_eq!(tree, edited.check().expect("a good model"));
            compiled = compiled.updated(&tree);
            let fresh = Compiler::for_engine(Engine::Lanes).compile(&tree.with_origin(compiled.origin()));
            for query in [Query::FIELD, Query::GRADIENT, Query::ALL] {
                let [now, new] =
                    [&compiled, &fresh].map(|compiled| compiled.evaluator(query).expect("it compiles"));
                // Some constants are NaN, and their texts are equal.
                assert_eq!(format!("{:?}", now.program()), format!("{:?}", new.program()));
                for (now, new) in now.tables().tables.values().zip(new.tables().tables.values()) {
                    assert_eq!((now, &now.nodes), (new, &new.nodes), "operator {operator}, edit {n}");
                }
            }
            let [now, new] = [&compiled, &fresh].map(|compiled| compiled.pruner().expect("it compiles"));
            let mut rng = fastrand::Rng::with_seed(n as u64);
            for _ in 0..20 {
                let low: [f32; 3] = std::array::from_fn(|_| 2.4 * rng.f32() - 1.2);
                let bounds = Box3::new(low, low.map(|c| c + 0.5 * rng.f32()));
                let [now, new] = [&now, &new].map(|pruner| pruner.region(bounds).expect("a box"));
                assert_eq!(now.selection(), new.selection(), "operator {operator}, edit {n}, {bounds:?}");
            }
            evaluator.update(&tree).expect("it compiles");
            let next = slicer.expect("it compiles").updated(&tree);
            let square = Rectangle::new([-1.0; 2], [1.0; 2]).expect("a square");
            let anew = Slicer::new(&compiler, &tree, &Plane::default(), Query::ALL).expect("it compiles");
            let contours = [next.as_ref().expect("it compiles"), &anew]
                .map(|slicer| slicer.contour(&square, &Detail::default()).run().expect("a contour"));
            assert_eq!(contours[0].positions, contours[1].positions);
            slicer = next;
        }
        let patched = compiler.counters().patched;
        assert!(patched >= 20, "operator {operator}: {patched} edits were patched");
    }
}

/// Lowering gives the rows of particles to the threads of the pool. A thread that waits for them takes other
/// work of the pool, which may ask for the same program.
#[test]
fn tasks_of_one_pool_share_a_program_that_the_pool_lowers() {
    let positions: Vec<[f64; 3]> =
        (0..320_000).map(|i| [f64::from(i % 40), f64::from(i / 40 % 40), f64::from(i / 1600)]).collect();
    let tree = Model::new(particles(positions, 0.7)).check().expect("a good model");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(6).build().expect("threads");
    let (done, is_done) = mpsc::channel();
    // Tasks that wait for each other never end: they are left to a thread that nobody waits for.
    thread::spawn(move || {
        for query in [Query::FIELD, Query::ALL].repeat(3) {
            let compiled = Compiler::for_engine(Engine::Lanes).compile(&tree);
            pool.install(|| {
                (0..6).into_par_iter().with_max_len(1).for_each(|_| {
                    compiled.evaluator(query).expect("it compiles");
                    Tracer::of(&compiled, query).expect("it compiles");
                });
            });
        }
        done.send(()).expect("the test waits");
    });
    is_done.recv_timeout(Duration::from_mins(5)).expect("no task waits for itself");
}
