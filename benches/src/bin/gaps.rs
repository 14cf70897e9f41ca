//! `gaps`: the longest time between two looks at whether the work is still wanted, of every example, task and
//! engine.
//!
//! ```text
//! cargo run --release -p jbt-benches --bin gaps [-- PART [ENGINE [RESOLUTION]]]
//! ```
//!
//! Work that is cancelled ends at the next look, so a gap is the longest that it may go on. Times are those
//! of the processor, which Linux alone tells (`jbt_testkit::gaps`). Only scenes whose name has PART are
//! looked at; ENGINE is `scalar`, `lanes` or `jit`. Behind a gap of more than 50 ms stands a `!`. All of them
//! take half an hour, most of it the scalar reference. With RESOLUTION it is one large mesh,
//! and writing it: each piece that is written is a look, as whoever takes it may refuse.
#![allow(clippy::print_stdout, reason = "it is a program")]

use std::fs;
use std::io::{self, Write};
use std::path::PathBuf;
use std::time::Duration;

use jbt::contour::{Detail, Plane, Slicer};
use jbt::differing::differing_places;
use jbt::export::{Format, write};
use jbt::sample::Sampler;
use jbt::solid::{Measure, PartSolids};
use jbt::statistics::Statistics;
use jbt::{
    Box3, CheckedTree, Compiler, Engine, Fineness, Model, Polygonize, Query, Render, Renderer, Solid, Task,
};
use jbt_testkit::gaps::WorkGaps;
use jbt_testkit::scene::model;

/// What is promised.
const MOST: Duration = Duration::from_millis(50);

/// Parts that touch, with edges: they are joined while they are meshed, and separated while they are written.
const PARTS: &str = r#"jbt 1
part "box" { difference { box { half (1 1 1) radius 0.2 } point { at (1.2 0 0) radius 1.2 } } }
part "ball" { color (0 0 1) { point { at (1.2 0 0) radius 1.2 } } }
part "cross" { union { box { center (-2 0 0) half (0.5 0.9 0.9) radius 0.2 } box { center (-2.4 0 0) half (0.5 0.5 1.2) radius 0.2 } } }
"#;

/// The gaps of all tasks.
fn gaps(model: &Model, tree: &CheckedTree, engine: Engine) -> Vec<(&'static str, Duration)> {
    let compiler = Compiler::for_engine(engine);
    let compiled = compiler.compile(tree);
    let mut told = Vec::new();
    told.push(("too large", WorkGaps::longest(|_| drop(compiled.too_large_for(&[Task::Mesh])))));
    told.push(("eval", WorkGaps::longest(|_| drop(compiled.evaluator(Query::ALL)))));
    let mut renderer = None;
    let rest = |_| {
        renderer = Renderer::of(&compiled).ok();
        let _ = (Solid::of(&compiled), Sampler::of(&compiled, Query::ALL));
        let _ = Slicer::of(&compiled, &Plane::default(), Query::FIELD);
    };
    told.push(("compile", WorkGaps::longest(rest)));
    let mesh = Polygonize { fineness: Fineness::Resolution(48), ..Polygonize::default() };
    let bounded = tree.support().is_finite();
    let region = (!bounded).then(|| Box3::new([-1.0; 3], [1.0; 3]));
    let mesh = Polygonize { region, ..mesh };
    told.push((
        "mesh",
        WorkGaps::longest(|gaps| drop(mesh.with(&compiled).on_progress(|_| gaps.look()).run())),
    ));
    if let Some(renderer) = &renderer {
        let render = Render { size: [160, 120], region: None, ..Render::default() };
        told.push((
            "render",
            WorkGaps::longest(|gaps| drop(render.with(renderer).on_progress(|_| gaps.look()).run())),
        ));
    }
    if let (Ok(sampler), Ok(lattice)) = (Sampler::of(&compiled, Query::ALL), mesh.lattice(tree)) {
        told.push((
            "sample",
            WorkGaps::longest(|gaps| drop(sampler.dense(&lattice).on_progress(|_| gaps.look()).run())),
        ));
    }
    if let Ok(slicer) = Slicer::of(&compiled, &Plane::default(), Query::FIELD)
        && let Ok(rectangle) = slicer.rectangle()
    {
        let job = slicer.contour(&rectangle, &Detail::default());
        told.push(("contour", WorkGaps::longest(|gaps| drop(job.on_progress(|_| gaps.look()).run()))));
    }
    if let Ok(solid) = Solid::of(&compiled) {
        let settings = Measure { fineness: Fineness::Resolution(32), ..Measure::default() };
        told.push((
            "stats",
            WorkGaps::longest(|gaps| drop(solid.measure(&settings).on_progress(|_| gaps.look()).run())),
        ));
    }
    if let Ok(lattice) = mesh.lattice(tree) {
        let count = |gaps: WorkGaps| {
            let statistics = Statistics::new(tree);
            drop(statistics.supports(&compiler, &lattice).on_progress(|_| gaps.look()).run());
        };
        told.push(("count", WorkGaps::longest(count)));
    }
    let mut moved = model.clone();
    moved.root = moved.root.translate([0.1, 0.0, 0.0]);
    if let Ok(moved) = moved.check() {
        let (models, region) = ([tree, &moved], region.map(|region| region.map(|at| at.map(f64::from))));
        told.push(("diff", WorkGaps::longest(|_| drop(differing_places(&compiler, models, region)))));
    }
    if let Ok(parts) = PartSolids::new(&compiler, tree) {
        told.push(("overlaps", WorkGaps::longest(|_| drop(parts.relations(1e-3)))));
    }
    told
}

/// The gaps of a mesh of this resolution, and of writing it in each format.
fn large_gaps(tree: &CheckedTree, engine: Engine, resolution: usize) -> Vec<(String, Duration)> {
    let compiled = Compiler::for_engine(engine).compile(tree);
    let mesh = Polygonize { fineness: Fineness::Resolution(resolution), ..Polygonize::default() };
    let mut made = None;
    let gap = WorkGaps::longest(|gaps| made = mesh.with(&compiled).on_progress(|_| gaps.look()).run().ok());
    let Some(made) = made else { return vec![("no mesh".to_owned(), gap)] };
    let millions = made.mesh.triangles.len() as f64 / 1e6;
    let mut told = vec![(format!("mesh of {millions:.1} million"), gap)];
    for format in Format::ALL {
        let write = |gaps| drop(write(&made.mesh, format, &mut LookingWriter(gaps)));
        told.push((format.to_string(), WorkGaps::longest(write)));
    }
    told
}

/// Takes what is written, and looks.
struct LookingWriter(WorkGaps);

impl Write for LookingWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.look();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The scenes: the examples, one of parts, and some that are long programs.
fn scenes() -> Vec<(String, String)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let files = fs::read_dir(folder).expect("the examples are there").filter_map(Result::ok);
    let scenes = files.map(|file| file.path()).filter(|path| path.extension().is_some_and(|it| it == "jbt"));
    let read = |path: PathBuf| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        (name, fs::read_to_string(path).expect("an example is text"))
    };
    let mut scenes: Vec<(String, String)> = scenes.map(read).collect();
    scenes.sort();
    let sines = |count: usize| {
        let terms: Vec<String> = (1..=count).map(|i| format!("sin({i}*x)")).collect();
        format!("expression within (-1 -1 -1) to (1 1 1) {{ {} }}", terms.join("+"))
    };
    scenes.push(("parts".to_owned(), PARTS.to_owned()));
    scenes.push(("300 sines".to_owned(), sines(300)));
    scenes.push(("1,300 sines".to_owned(), sines(1300)));
    scenes.push(("12,000 sines".to_owned(), sines(12_000)));
    scenes
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let part = arguments.next().unwrap_or_default();
    let engine = arguments.next();
    let resolution = arguments.next().map(|number| number.parse().expect("RESOLUTION is a number"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    println!("{:14} {:7} longest gaps in ms", "scene", "engine");
    let mut most = Duration::ZERO;
    for (name, text) in scenes().into_iter().filter(|(name, _)| name.contains(&part)) {
        let model = model(&text);
        let tree = model.check().expect("the scene is right");
        for one in Engine::ALL.into_iter().filter(|one| engine.as_ref().is_none_or(|name| name == one.name()))
        {
            let told: Vec<(String, Duration)> = pool.install(|| match resolution {
                Some(resolution) => large_gaps(&tree, one, resolution),
                None => {
                    gaps(&model, &tree, one).into_iter().map(|(task, gap)| (task.to_owned(), gap)).collect()
                }
            });
            let words = told.iter().map(|(task, gap)| {
                let mark = if *gap > MOST { "!" } else { "" };
                format!("{task} {:.1}{mark}", gap.as_secs_f64() * 1e3)
            });
            println!("{name:14} {one:7} {}", words.collect::<Vec<_>>().join(", "));
            most = told.iter().map(|(_, gap)| *gap).chain([most]).max().unwrap_or(most);
        }
    }
    println!("the longest: {:.1} ms", most.as_secs_f64() * 1e3);
}
