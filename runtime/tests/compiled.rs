//! One compiled model: whatever looks at it, each program is compiled and given its numbers once, and nothing
//! is that nobody asks for.

use jbt::build::point;
use jbt::contour::{Detail, Plane, Slicer};
use jbt::sample::Sampler;
use jbt::solid::Measure;
use jbt::{
    CheckedTree, CompileCounters, Compiled, Compiler, Engine, Fineness, Model, Polygonize, Query, Ray,
    Render, Renderer, Solid, Tracer, Tree, Update,
};

fn balls(count: usize, radius: f64) -> CheckedTree {
    let ball = |i: usize| point([0.4 * i as f64, 0.0, 0.0], radius).color([1.0, 0.5, 0.0]);
    Model::new((0..count).map(ball).sum::<Tree>()).check().expect("a good model")
}

fn made(compiled: &Compiled) -> [u64; 2] {
    let CompileCounters { kernels, bound, .. } = compiled.compiler().counters();
    [kernels, bound]
}

const COARSE: Polygonize =
    Polygonize { region: None, fineness: Fineness::Resolution(16), verify: false, thin_parts: true };
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
    std::thread::scope(|scope| {
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
