//! Memory that cannot be had: an answer or an error of the library, however little there is, and the process
//! lives on and does smaller work.
//!
//! Each work runs in processes of its own, which may have so many bytes more than they have once the inputs
//! are there. `JBT_FAULTS=1` tries 50 sizes for each, otherwise there are two.
#![cfg(target_os = "linux")]
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

use std::cell::RefCell;
use std::io::sink;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use fastrand::Rng;
use jbt::boxes::Divisible;
use jbt::build::{particles, point};
use jbt::contour::{Detail, Plane, Rectangle, Slicer};
use jbt::differing::differing_places;
use jbt::divide::{Cell, Decision, Limits, divide};
use jbt::export::{Format, write};
use jbt::import::particles::ParticleOptions;
use jbt::live::LiveSection;
use jbt::mesh::{Lattice, LatticeBlock, MeshBlock, join_blocks};
use jbt::remote::{ModelRows, RowSource};
use jbt::render::Quality;
use jbt::sample::{Sampler, VdbField, VdbVolume, Wanted, write_vdb};
use jbt::solid::{Measure, PartSolids};
use jbt::{
    Box3, CheckedTree, Classified, Compiler, ErrorKind, Fineness, LiveContour, LiveMesh, Model, Points,
    Polygonize, Pruner, Query, Ray, Render, SceneFormat, Solid, Tracer, Tree, text,
};
use jbt_testkit::random::Random;
use jbt_testkit::scene::tree;
use jbt_testkit::skip::short_or_long;
use rustix::process::{Resource, Rlimit, setrlimit};

/// Megabytes that a work has at least: what is small takes less, and asks for some before it begins.
const LEAST: usize = 24;

/// Names a work and the bytes that it may have, to the process that does it.
const WORK: &str = "JBT_LARGE_WORK";

/// What names of works begin with that are random models; a seed follows.
const RANDOM: &str = "model ";

/// What that process says.
const ANSWER: &str = "an answer";
/// See [`ANSWER`]; the error follows.
const NO_MEMORY: &str = "no memory:";

/// Whose error it was; what it said.
type Done<T = ()> = Result<T, (ErrorKind, String)>;

/// The error of a result, classified.
fn classified<T, E: Classified>(result: Result<T, E>) -> Done<T> {
    result.map_err(|error| (error.kind(), error.to_string()))
}

/// The same of work whose result nobody needs.
fn told<T, E: Classified>(result: Result<T, E>) -> Done {
    classified(result).map(drop)
}

/// Something to do at a size, with the inputs made.
type Work = Box<dyn Fn() -> Done>;

/// Makes a work, in a small size or a large one.
type Make = fn(bool) -> Work;

/// Works by name, the megabytes that are enough for the large one, and how they are made.
const WORKS: [(&str, usize, Make); 23] = [
    ("mesh", 180, mesh),
    ("mesh of particles", 100, mesh_of_particles),
    ("rows", 150, rows),
    ("points", 160, points),
    ("samples", 210, samples),
    ("blocks", 210, blocks),
    ("picture", 250, picture),
    ("contour", 70, contour),
    ("measures", 270, measures),
    ("live mesh", 430, live),
    ("edit of a live mesh", 430, edit),
    ("edit of a live contour", 100, edit_of_contour),
    ("rays", 200, rays),
    ("memberships", 200, memberships),
    ("parts", 200, parts),
    ("union", 200, union),
    ("text", 140, nodes),
    ("table", 100, table),
    ("files", 100, files),
    ("division", 45, division),
    ("blocks of a mesh", 80, mesh_blocks),
    ("grids", 110, grids),
    ("distributed rows", 70, distributed),
];

/// How it was done with so many bytes more than its inputs take, by a process of its own: whether there was an
/// answer. `Err`: the process said something else, or nothing.
fn done_by_process(work: &str, room: usize) -> Result<bool, String> {
    let mut process = Command::new(std::env::current_exe().expect("a test is a program"));
    process.args(["work_of_few_bytes", "--exact", "--ignored", "--nocapture", "--test-threads", "1"]);
    process.env(WORK, format!("{work}:{room}")).env("RAYON_NUM_THREADS", "1");
    // What is free goes back to the system, and nothing is reserved.
    process.env("MALLOC_TRIM_THRESHOLD_", "131072").env("MALLOC_MMAP_THRESHOLD_", "131072");
    // A backtrace takes memory, and waits for itself where there is none.
    process.env("RUST_BACKTRACE", "0");
    let done = process.env("MALLOC_ARENA_MAX", "1").output().expect("a process");
    let said = String::from_utf8_lossy(&done.stdout) + String::from_utf8_lossy(&done.stderr);
    match (done.status.success(), said.contains(ANSWER), said.contains(NO_MEMORY)) {
        (true, true, false) => Ok(true),
        (true, false, true) => Ok(false),
        _ => Err(format!("{work} with {room} bytes: {} {said}", done.status)),
    }
}

/// Does pieces of work by their numbers, on two threads, and fails with all that they say is wrong.
fn all_are_right(count: usize, look: impl Fn(usize) -> Vec<String> + Sync) {
    let (next, wrong) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let each = || {
        while let Some(index) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|&index| index < count) {
            let told = look(index);
            wrong.lock().expect("one at a time").extend(told);
        }
    };
    thread::scope(|scope| (0..2).for_each(|_| drop(scope.spawn(each))));
    let wrong = wrong.into_inner().expect("all have ended");
    assert!(wrong.is_empty(), "{}: {}", wrong.len(), wrong.join("\n"));
}

#[test]
fn want_of_memory_is_an_answer_or_an_error() {
    let last = short_or_long([1, 49]);
    all_are_right(WORKS.len(), |index| {
        let (work, megabytes, _) = WORKS[index];
        // More of the small sizes: there is more to fail.
        let room = |step: usize| (LEAST << 20) + ((megabytes - LEAST) << 20) * step * step / (last * last);
        let found: Vec<_> = (0..=last).map(|step| done_by_process(work, room(step))).collect();
        let [answers, errors] = [true, false].map(|one| found.iter().filter(|it| **it == Ok(one)).count());
        println!("{work}: {answers} answers, {errors} errors");
        let is_too_easy = found.first() == Some(&Ok(true)) || found.last() == Some(&Ok(false));
        let easy = is_too_easy.then(|| format!("{work}: the least room is enough, or the most is not"));
        easy.into_iter().chain(found.into_iter().filter_map(Result::err)).collect()
    });
}

/// Models of every kind of node, in one to four times the least memory: 3 in short, 100 at length.
#[test]
fn so_it_is_for_random_models() {
    let (answers, errors) = (AtomicUsize::new(0), AtomicUsize::new(0));
    all_are_right(short_or_long([3, 100]), |seed| {
        let times = 4.0_f64.powf(Rng::with_seed(seed as u64).f64());
        let room = (LEAST << 20) as f64 * times;
        let done = done_by_process(&format!("{RANDOM}{seed}"), room as usize);
        if let Ok(is_answer) = done {
            let count = if is_answer { &answers } else { &errors };
            count.fetch_add(1, Ordering::Relaxed);
        }
        done.err().into_iter().collect()
    });
    println!("random models: {answers:?} answers, {errors:?} errors");
}

#[test]
#[ignore = "it is for a process of few bytes, that another test makes"]
fn work_of_few_bytes() {
    let wanted = std::env::var(WORK).expect("another test names the work");
    let (name, room) = wanted.split_once(':').expect("a name and a number");
    let room: u64 = room.parse().expect("a number");
    let [large, small] = match name.strip_prefix(RANDOM) {
        Some(seed) => [random(seed.parse().expect("a number")), mesh(true)],
        None => {
            let (_, _, make) = WORKS.into_iter().find(|(work, _, _)| *work == name).expect("a work");
            [false, true].map(make)
        }
    };
    // What is made once for a process is there.
    small().expect("there is no limit yet");
    let statm = std::fs::read_to_string("/proc/self/statm").expect("Linux says so");
    let pages: u64 = statm.split(' ').next().and_then(|word| word.parse().ok()).expect("a number");
    let most = pages * rustix::param::page_size() as u64 + room;
    setrlimit(Resource::As, Rlimit { current: Some(most), maximum: Some(most) }).expect("a smaller limit");
    match large() {
        Ok(()) => println!("{ANSWER}"),
        Err((kind, told)) => {
            assert_eq!(kind, ErrorKind::Limit, "{told}");
            println!("{NO_MEMORY} {told}");
        }
    }
    small().expect("the process can do what is small");
}

/// All that is asked of a random model, the seed says what first. Errors of the model and of arguments are
/// answers.
fn random(seed: u64) -> Work {
    type Step = Box<dyn Fn(&Compiler, &CheckedTree) -> Done>;
    let written = text::print(&Random::new(seed, seed).model(100));
    let region = Some(Box3::new([-3.0; 3], [3.0; 3]));
    let settings = Polygonize { region, ..settings(32) };
    let region = Some(Box3::new([-3.0; 3], [3.0; 3]));
    let measure = Measure { region, fineness: Fineness::Resolution(32) };
    let render = Render { size: [100; 2], quality: Quality::Draft, ..Render::default() };
    let mut rng = Rng::with_seed(seed);
    let mut point = || std::array::from_fn(|_| 6.0 * rng.f32() - 3.0);
    let points: Points = (0..1_000).map(|_| point()).collect();
    let inside = points.clone();
    let mut steps: [Step; 6] = [
        Box::new(move |compiler, tree| told(settings.mesh(compiler, tree).run())),
        Box::new(move |compiler, tree| told(LiveMesh::of(&compiler.compile(tree), settings).run())),
        Box::new(move |compiler, tree| told(render.picture(compiler, tree).run())),
        Box::new(move |compiler, tree| {
            told(classified(Solid::new(compiler, tree))?.memberships(&inside, 1e-3))
        }),
        Box::new(move |compiler, tree| told(classified(Solid::new(compiler, tree))?.measure(&measure).run())),
        Box::new(move |compiler, tree| {
            let evaluator = classified(compiler.evaluator(tree, Query::ALL))?;
            told(evaluator.par_eval(&points, &mut evaluator.samples()))
        }),
    ];
    steps.rotate_left(seed as usize % 6);
    Box::new(move || {
        let unless_refused = |done: Done| match done {
            Err((ErrorKind::Unbounded | ErrorKind::Argument | ErrorKind::Model, _)) => Ok(()),
            done => done,
        };
        let model = text::parse(written.as_bytes(), &text::Options::default());
        let tree = match classified(model.and_then(|model| model.check())) {
            Ok(tree) => tree,
            Err(error) => return unless_refused(Err(error)),
        };
        let compiler = Compiler::new();
        steps.iter().try_for_each(|step| unless_refused(step(&compiler, &tree)))
    })
}

fn ball() -> CheckedTree {
    tree("jbt 1 color (1 0 0) { point { surface_radius 1 } }")
}

fn settings(cells: usize) -> Polygonize {
    Polygonize { fineness: Fineness::Resolution(cells), ..Polygonize::default() }
}

fn mesh(small: bool) -> Work {
    let (tree, settings) = (ball(), settings(if small { 16 } else { 1_000 }));
    Box::new(move || told(settings.mesh(&Compiler::new(), &tree).run()))
}

fn cloud(count: usize) -> CheckedTree {
    let mut rng = Rng::with_seed(1);
    let places: Vec<[f32; 3]> = (0..count).map(|_| std::array::from_fn(|_| rng.f32())).collect();
    let radii = vec![1.5 / (count as f32).cbrt(); count];
    Model::new(particles(places, radii)).check().expect("a good model")
}

fn mesh_of_particles(small: bool) -> Work {
    let (tree, settings) = (cloud(if small { 10 } else { 100_000 }), settings(if small { 16 } else { 120 }));
    Box::new(move || told(settings.mesh(&Compiler::new(), &tree).run()))
}

fn rows(small: bool) -> Work {
    let tree = cloud(if small { 10 } else { 1_000_000 });
    Box::new(move || told(Sampler::new(&Compiler::new(), &tree, Query::ALL)))
}

fn points(small: bool) -> Work {
    // The small ones are enough for several threads: the pool is there before memory is short.
    let count = if small { 100_000 } else { 3_000_000 };
    let points: Points = (0..count).map(|index| [index as f32 / count as f32, 0.0, 0.0]).collect();
    let evaluator = Compiler::new().evaluator(&ball(), Query::ALL).expect("it compiles");
    Box::new(move || told(evaluator.par_eval(&points, &mut evaluator.samples())))
}

fn sampler() -> Sampler {
    Sampler::new(&Compiler::new(), &ball(), Query::ALL).expect("it compiles")
}

fn lattice(points: usize) -> Lattice {
    Lattice::new([-1.0; 3], 2.0 / points as f64, [points; 3]).expect("a lattice")
}

fn samples(small: bool) -> Work {
    let (sampler, lattice) = (sampler(), lattice(if small { 8 } else { 180 }));
    Box::new(move || told(sampler.dense(&lattice).run()))
}

fn blocks(small: bool) -> Work {
    let (sampler, lattice) = (sampler(), lattice(if small { 8 } else { 180 }));
    Box::new(move || told(sampler.blocks(&lattice, Wanted::Everywhere).run()))
}

fn picture(small: bool) -> Work {
    let tree = ball();
    let render =
        Render { size: [if small { 16 } else { 1_500 }; 2], quality: Quality::Draft, ..Render::default() };
    Box::new(move || told(render.picture(&Compiler::new(), &tree).run()))
}

fn contour(small: bool) -> Work {
    let tree = cloud(if small { 10 } else { 30_000 });
    let slicer =
        Slicer::of(&Compiler::new().compile(&tree), &Plane::default(), Query::FIELD).expect("it compiles");
    Box::new(move || {
        let rectangle = slicer.rectangle().expect("it is bounded");
        let fineness = Fineness::Resolution(if small { 16 } else { 16_000 });
        told(slicer.contour(&rectangle, &Detail { fineness, ..Detail::default() }).run())
    })
}

fn measures(small: bool) -> Work {
    let solid = Solid::new(&Compiler::new(), &cloud(if small { 10 } else { 20_000 })).expect("it compiles");
    let fineness = Fineness::Resolution(if small { 8 } else { 128 });
    let settings = Measure { fineness, ..Measure::default() };
    Box::new(move || told(solid.measure(&settings).run()))
}

fn live(small: bool) -> Work {
    let (tree, settings) = (cloud(if small { 10 } else { 30_000 }), settings(if small { 16 } else { 300 }));
    Box::new(move || told(LiveMesh::of(&Compiler::new().compile(&tree), settings).run()))
}

/// An edit that fails leaves everything as it was: the model before changes nothing.
fn edit(small: bool) -> Work {
    let region = Some(Box3::new([-0.5; 3], [1.5; 3]));
    let (before, after) = (cloud(10), cloud(if small { 12 } else { 30_000 }));
    let settings = Polygonize { region, ..settings(if small { 16 } else { 300 }) };
    let live = LiveMesh::of(&Compiler::new().for_edits().compile(&before), settings).run();
    let live = RefCell::new(live.expect("a small mesh"));
    let kept = live.borrow().buffers().clone();
    Box::new(move || {
        let live = &mut *live.borrow_mut();
        let done = told(live.replace(&after).run());
        if done.is_err() {
            assert!(*live.buffers() == kept, "the mesh is another one");
            assert_eq!(live.tree().support(), before.support(), "the model is another one");
            let again = classified(live.replace(&before).run());
            assert!(again.is_ok_and(|change| change.is_empty()), "something was left");
        }
        done
    })
}

/// The same of a contour.
fn edit_of_contour(small: bool) -> Work {
    let rectangle = Some(Rectangle::new([-0.5; 2], [1.5; 2]).expect("a rectangle"));
    let (before, after) = (cloud(10), cloud(if small { 12 } else { 30_000 }));
    let detail =
        Detail { fineness: Fineness::Resolution(if small { 16 } else { 16_000 }), ..Detail::default() };
    let section = LiveSection { rectangle, detail, ..LiveSection::default() };
    let live = LiveContour::new(&Compiler::new(), &before, &section).run();
    let live = RefCell::new(live.expect("a small contour"));
    let kept = live.borrow().contour().positions.clone();
    Box::new(move || {
        let live = &mut *live.borrow_mut();
        let done = told(live.replace(&after).run());
        if done.is_err() {
            assert!(live.contour().positions == kept, "the contour is another one");
            assert_eq!(live.tree().support(), before.support(), "the model is another one");
            let again = classified(live.replace(&before).run());
            assert!(again.is_ok_and(|change| change.is_empty()), "something was left");
        }
        done
    })
}

fn rays(small: bool) -> Work {
    let tracer = Tracer::new(&Compiler::new(), &ball(), Query::ALL).expect("it compiles");
    let count = if small { 10 } else { 500_000 };
    let origin = |index: usize| [index as f64 / count as f64, 0.0, -2.0];
    let rays: Vec<Ray> = (0..count)
        .map(|index| Ray { origin: origin(index), direction: [0.0, 0.0, 1.0], span: [0.0, 4.0] })
        .collect();
    Box::new(move || told(tracer.all_of(&rays, 1e-2)))
}

fn memberships(small: bool) -> Work {
    let solid = Solid::new(&Compiler::new(), &ball()).expect("it compiles");
    let count = if small { 10 } else { 3_000_000 };
    let points: Points = (0..count).map(|index| [2.0 * index as f32 / count as f32, 0.0, 0.0]).collect();
    Box::new(move || told(solid.memberships(&points, 0.0)))
}

/// Parts of many leaves, two of them apart and two that overlap: which points are in them, what they have to
/// do with each other, how far apart they are, and where one ends.
fn parts(small: bool) -> Work {
    let (count, tolerance) = if small { (10, 0.1) } else { (2_000, 1e-3) };
    let part = |x: f64| {
        let points = (0..count).map(|index| format!("point {{ at ({x} {} 0) radius 1 }}\n", index % 100));
        format!("part \"p{x}\" {{ sum {{\n{}}} }}\n", points.collect::<String>())
    };
    let tree = tree(&format!("jbt 1\n{}{}{}", part(0.0), part(1.0), part(9.0)));
    let points: Points = (0..if small { 10 } else { 1_000_000 }).map(|_| [0.0; 3]).collect();
    Box::new(move || {
        let parts = classified(PartSolids::new(&Compiler::new(), &tree))?;
        told(parts.members(&points))?;
        told(parts.relations(tolerance))?;
        told(parts.distance(0, 2, tolerance))?;
        told(parts.solid(0).tight_bounds(None, tolerance as f32))?;
        told(parts.solid(0).owners_in(Box3::new([-1.0; 3], [200.0; 3])))
    })
}

/// A union of very many leaves: which rows may win in a box, as often as a tree of rows is worth it, and where
/// the fields of two models differ, one of which has a leaf less.
fn union(small: bool) -> Work {
    let balls = |count: usize| {
        let mut rng = Rng::with_seed(3);
        let ball = |rng: &mut Rng| point(std::array::from_fn(|_| rng.f64()), 0.5 / (count as f64).cbrt());
        let model = Model::new(Tree::union((0..count).map(|_| ball(&mut rng))));
        model.check().expect("a good model")
    };
    let count = if small { 10 } else { 200_000 };
    let few: usize = count / 4 + 2;
    let trees = [balls(few), balls(few - 1)];
    let solid = Solid::new(&Compiler::new(), &balls(count)).expect("it compiles");
    Box::new(move || {
        for index in 0..100 {
            let at = index as f32 / 100.0;
            told(solid.membership([at; 3], 1e-3))?;
            told(solid.owners_in(Box3::new([at; 3], [at + 0.5; 3])))?;
        }
        told(differing_places(&Compiler::new(), [&trees[0], &trees[1]], None))
    })
}

fn files(small: bool) -> Work {
    let settings = settings(if small { 8 } else { 200 });
    let mesh = settings
        .mesh(&Compiler::new(), &tree("jbt 1 color (1 0 0) { box { half (1 1 1) radius 0.1 } }"))
        .run();
    let mesh = mesh.expect("a mesh").mesh;
    Box::new(move || Format::ALL.into_iter().try_for_each(|format| told(write(&mesh, format, &mut sink()))))
}

fn nodes(small: bool) -> Work {
    let count = if small { 3 } else { 100_000 };
    let points: String = (0..count).map(|index| format!("point {{ at ({index} 0 0) radius 1 }}\n")).collect();
    let text = format!("jbt 1\nsum {{\n{points}}}");
    Box::new(move || {
        let model = text::parse(text.as_bytes(), &text::Options::default());
        let tree = classified(model.and_then(|model| model.check()))?;
        told(Sampler::new(&Compiler::new(), &tree, Query::ALL))
    })
}

fn table(small: bool) -> Work {
    let count = if small { 3 } else { 1_000_000 };
    let rows: String = (0..count).map(|index| format!("{index},0.5,0.25\n")).collect();
    let file = format!("x,y,z\n{rows}");
    let particles = ParticleOptions { radius: Some(0.5), ..ParticleOptions::default() };
    let options = text::Options { particles, ..text::Options::default() };
    Box::new(move || {
        let read = classified(SceneFormat::Csv.read("table.csv", file.as_bytes(), &options))?;
        told(read.model.check())
    })
}

/// What a caller does with a pruner himself: he divides space in halves, as finely as he likes, divides it
/// again after an edit, and keeps regions.
fn division(small: bool) -> Work {
    let count = if small { 10 } else { 4_000 };
    let balls = |count: usize| {
        let mut rng = Rng::with_seed(1);
        let places: Vec<[f32; 3]> = (0..count).map(|_| std::array::from_fn(|_| rng.f32())).collect();
        Model::new(particles(places, vec![0.05; count])).check().expect("a good model")
    };
    // One ball more: most of the division is copied, with other numbers of rows.
    let (before, after) = (balls(count), balls(count + 1));
    let compiler = Compiler::new();
    let [before, after] = [before, after].map(|tree| Pruner::new(&compiler, &tree).expect("it compiles"));
    let edit = after.edit(&before);
    let least = if small { 0.5 } else { 1.0 / 24.0 };
    let halve = move |cell: &Cell<'_, Pruner>, (): &()| {
        let bounds = cell.bounds();
        if bounds.longest_side() <= least {
            return Ok(Decision::Leaf);
        }
        let side = |axis: &usize| bounds.high[*axis] - bounds.low[*axis];
        let axis = (0..3).max_by(|a, b| side(a).total_cmp(&side(b))).expect("three axes");
        Ok(Decision::Split { axis, at: bounds.middle(axis), data: [(), ()] })
    };
    Box::new(move || {
        let limits = Limits::default();
        let divided = classified(divide(&before, Box3::new([0.0; 3], [1.0; 3]), (), &limits, &halve))?;
        let renew = |region: &_| after.renewed(&before, region);
        let again = classified(divided.redivide(&after, &edit, &renew, &limits, &halve))?;
        let regions: Result<Vec<_>, _> = again.leaves().map(|(node, _)| after.region(node.bounds)).collect();
        told(regions)
    })
}

/// Blocks of a mesh, as bytes, become the mesh.
fn mesh_blocks(small: bool) -> Work {
    let (tree, settings) = (ball(), settings(if small { 16 } else { 600 }));
    let lattice = settings.lattice(&tree).expect("a lattice");
    let compiled = Compiler::new().compile(&tree);
    let edge = if small { 32 } else { 64 };
    let [x, y, z] = lattice.cells().map(|cells| cells.div_ceil(edge) as u32);
    let places = (0..x * y * z).map(|index| [index % x, index / x % y, index / (x * y)]);
    let block = |place| {
        let block = LatticeBlock::new(&lattice, edge, place).expect("the block is there");
        settings.block(&compiled, &lattice, block).run().expect("it is meshed").to_bytes()
    };
    let blocks: Vec<Vec<u8>> = places.map(block).collect();
    Box::new(move || {
        let read: Result<Vec<_>, _> = blocks.iter().map(|bytes| MeshBlock::from_bytes(bytes)).collect();
        told(join_blocks(&classified(read)?))
    })
}

/// Rows of a whole model for another process, and what that one reads.
fn distributed(small: bool) -> Work {
    let tree = cloud(if small { 10 } else { 200_000 });
    let queries = [Query::FIELD, Query::GRADIENT];
    let source = move |tree: &CheckedTree| RowSource::new(&Compiler::new().compile(tree), &queries);
    let all = Box3::new([-1.0; 3], [2.0; 3]);
    let sent = source(&tree).and_then(|source| source.rows(all)).expect("a good model").to_bytes();
    Box::new(move || {
        let source = classified(source(&tree))?;
        told(source.rows(all))?;
        told(ModelRows::from_bytes(&sent))
    })
}

/// Samples as files of OpenVDB.
fn grids(small: bool) -> Work {
    let (sampler, lattice) = (sampler(), lattice(if small { 8 } else { 150 }));
    let blocks = sampler.blocks(&lattice, Wanted::Everywhere).run().expect("samples");
    let names = sampler.evaluator().layout().names().to_vec();
    Box::new(move || {
        [VdbField::Fog, VdbField::LevelSet { iso: 0.5 }].into_iter().try_for_each(|field| {
            let volume = VdbVolume { lattice: &lattice, origin: [0.0; 3], names: &names, field };
            write_vdb(volume, &blocks, &mut sink()).map_err(|error| match error.kind() {
                std::io::ErrorKind::OutOfMemory => (ErrorKind::Limit, error.to_string()),
                _ => (ErrorKind::System, error.to_string()),
            })
        })
    })
}
