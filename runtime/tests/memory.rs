//! Memory that cannot be had: an answer or an error of the library, however little there is, and the process
//! lives on and does smaller work.
//!
//! Each work runs in processes of its own, which may have so many bytes more than they have once the inputs
//! are there. `JBT_FAULTS=1` tries 50 sizes for each, otherwise there are two.
#![cfg(target_os = "linux")]
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

use std::io::sink;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use fastrand::Rng;
use jbt::build::particles;
use jbt::contour::{Detail, Plane, Slicer};
use jbt::export::{Format, write};
use jbt::import::particles::ParticleOptions;
use jbt::mesh::Lattice;
use jbt::render::Quality;
use jbt::sample::{Sampler, Wanted};
use jbt::solid::Measure;
use jbt::{
    CheckedTree, Classified, Compiler, ErrorKind, Fineness, LiveMesh, Model, Points, Polygonize, Query,
    Render, SceneFormat, Solid, text,
};
use jbt_testkit::scene::tree;
use jbt_testkit::skip::short_or_long;
use rustix::process::{Resource, Rlimit, setrlimit};

/// Megabytes that a work has at least: what is small takes less, and asks for some before it begins.
const LEAST: usize = 24;

/// Names a work and the bytes that it may have, to the process that does it.
const WORK: &str = "JBT_LARGE_WORK";

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
const WORKS: [(&str, usize, Make); 13] = [
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
    ("text", 140, nodes),
    ("table", 100, table),
    ("files", 100, files),
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

#[test]
fn want_of_memory_is_an_answer_or_an_error() {
    let last = short_or_long([1, 49]);
    let (next, wrong) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let look = || {
        while let Some(&(work, megabytes, _)) = WORKS.get(next.fetch_add(1, Ordering::Relaxed)) {
            // More of the small sizes: there is more to fail.
            let room =
                |step: usize| (LEAST << 20) + ((megabytes - LEAST) << 20) * step * step / (last * last);
            let found: Vec<_> = (0..=last).map(|step| done_by_process(work, room(step))).collect();
            let [answers, errors] =
                [true, false].map(|one| found.iter().filter(|it| **it == Ok(one)).count());
            println!("{work}: {answers} answers, {errors} errors");
            let mut wrong = wrong.lock().expect("one at a time");
            if found.first() == Some(&Ok(true)) || found.last() == Some(&Ok(false)) {
                wrong.push(format!("{work}: the least room is enough, or the most is not"));
            }
            wrong.extend(found.into_iter().filter_map(Result::err));
        }
    };
    thread::scope(|scope| (0..2).for_each(|_| drop(scope.spawn(look))));
    let wrong = wrong.into_inner().expect("all have ended");
    assert!(wrong.is_empty(), "{}: {}", wrong.len(), wrong.join("\n"));
}

#[test]
#[ignore = "it is for a process of few bytes, that another test makes"]
fn work_of_few_bytes() {
    let wanted = std::env::var(WORK).expect("another test names the work");
    let (name, room) = wanted.split_once(':').expect("a name and a number");
    let (_, _, make) = WORKS.into_iter().find(|(work, _, _)| *work == name).expect("a work");
    let room: u64 = room.parse().expect("a number");
    let [large, small] = [false, true].map(make);
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
