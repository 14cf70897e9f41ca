//! Pictures: a slice of a long program, blobs seen from a side, an octopus in light.

use std::cell::{Cell, RefCell};
use std::time::Instant;

use jbt::contour::{ImageDetail, Plane, Rectangle, Slicer};
use jbt::import;
use jbt::render::{Quality, Render, RenderMode, Renderer, View};
use jbt::walk::walk;
use jbt::{Box3, CheckedTree, Compiler, Fineness, Query};
use jbt_testkit::samples;
use serde_json::json;

use super::contest::{Contest, Contestant, Standings};
use super::mesh::peer_threads;
use super::options::Options;
use super::report::{ResultRow, rounded};
use crate::model;
use crate::peers::fidget::{FidgetModel, FidgetProgram, Gate, JitFunction, VmFunction};

/// The program, in the folder of samples: "Text of a monologue from The Tempest" (Keeter).
const PROGRAM: &str = "vm/prospero.vm";
/// Pixels along a side of its picture.
const SIDE: u32 = 1024;
/// Pixels of it that are compared with the oracle.
const LOOKS: usize = 500;
/// Where the field is nearer to the surface than this, f32 may see the other side.
const NEAR: f64 = 1e-4;
/// The part of the pixels by which contestants may differ: their pixels are half a pixel off each other.
const PIXELS_OFF: f64 = 0.02;

/// Pixels of the octopus's small picture.
const SMALL: [u32; 2] = [200; 2];

/// Blobs that are seen, and pixels along a side.
const BLOBS: usize = 512;
const PICTURE: u32 = 512;

pub(super) fn pool(options: Options) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(options.threads).build().expect("threads can be made")
}

/// Which pixels of a slice are inside.
pub(super) fn prospero(options: Options) -> Vec<ResultRow> {
    let pixels = (SIDE * SIDE) as usize;
    let row = |primitives, standings, extra| ResultRow {
        case: "prospero",
        of: "",
        primitives,
        points: pixels,
        unit: "run",
        units: 1.0,
        standings,
        extra,
    };
    let (bytes, tree) = match program() {
        Ok(program) => program,
        Err(reason) => {
            let standings = Standings { standings: Vec::new(), disagreements: vec![reason] };
            return vec![row(0, standings, Vec::new())];
        }
    };
    let plane: Plane = "z=0".parse().expect("a plane");
    let start = Instant::now();
    let slicer = Slicer::new(&Compiler::new(), &tree, &plane, Query::FIELD).expect("the program compiles");
    let compile = start.elapsed();
    let square = Rectangle::new([-1.0; 2], [1.0; 2]).expect("the corners are in order");
    let detail = ImageDetail { fineness: Fineness::Resolution(SIDE as usize), samples: 1 };
    let pool = pool(options);
    let image = RefCell::new(Vec::new());
    let ours = || {
        let made = pool.install(|| slicer.inside(&square, &detail).run());
        *image.borrow_mut() = made.expect("the slice has a picture").values;
    };
    ours();
    let inside = image.borrow().iter().filter(|&&part| part > 0).count();
    let jit = FidgetProgram::<JitFunction>::new(&bytes).expect("fidget reads the program");
    let vm = FidgetProgram::<VmFunction>::new(&bytes).expect("fidget reads the program");
    let mut contest = Contest::new();
    contest.enter_checked(Contestant::Ours, "", ours, |(): &()| check(&tree, &image.borrow()));
    let near = |count: &usize| {
        let off = (*count as f64 / inside as f64 - 1.0).abs();
        if off < PIXELS_OFF { Ok(()) } else { Err(format!("{count} pixels are inside, and not {inside}")) }
    };
    let threads = peer_threads(options);
    contest.enter_checked(Contestant::FidgetJit, "", || jit.inside(SIDE, threads), near);
    contest.enter_checked(Contestant::FidgetVm, "", || vm.inside(SIDE, threads), near);
    let extra = vec![("threads", json!(options.threads)), ("compile_ms", json!(compile.as_secs_f64() * 1e3))];
    vec![row(bytes.iter().filter(|&&byte| byte == b'\n').count() - 1, contest.run(options.effort()), extra)]
}

/// The program's text, and its model.
fn program() -> Result<(Vec<u8>, CheckedTree), String> {
    let bytes = samples::file(PROGRAM)?;
    let imported = import::vm(&bytes).map_err(|_| "the program has errors".to_owned())?;
    let tree = imported.model.check().map_err(|_| "the model has errors".to_owned())?;
    Ok((bytes, tree))
}

/// Compares some pixels with the oracle. The first row is at the top.
fn check(tree: &CheckedTree, image: &[u8]) -> Result<(), String> {
    let side = SIDE as usize;
    let at = |index: usize| (index as f64 + 0.5) / f64::from(SIDE) * 2.0 - 1.0;
    for index in (0..image.len()).step_by(image.len() / LOOKS + 1) {
        let (x, y) = (at(index % side), -at(index / side));
        let above = walk(tree, [x, y, 0.0]).field - tree.iso();
        if above.abs() > NEAR && (above > 0.0) != (image[index] > 0) {
            return Err(format!(
                "the pixel at ({x}, {y}) is on the wrong side: the field is {above} above iso"
            ));
        }
    }
    Ok(())
}

/// The octopus.
pub(super) fn octopus() -> CheckedTree {
    let text = include_bytes!("../../../examples/hero.jbt");
    let model = jbt::text::parse(text, &jbt::text::Options::default()).expect("the scene is right");
    model.check().expect("the scene is right")
}

/// Pictures of the octopus in light, as the command line makes them without options but `--quality` and
/// `--size`: draft, good, and a small one, of which framing is a larger part; on one thread and on two. A
/// renderer is kept, so nothing is compiled and no file is written.
pub(super) fn hero(options: Options) -> Vec<ResultRow> {
    let tree = octopus();
    let renderer = Renderer::new(&Compiler::new(), &tree).expect("the scene compiles");
    let mut rows = Vec::new();
    let large = Render::default().size;
    let pictures = [
        (Quality::Draft, "draft", large, ["draft, one thread", "draft, two"]),
        (Quality::Good, "good", large, ["good, one thread", "good, two"]),
        (Quality::Good, "good", SMALL, ["small, one thread", "small, two"]),
    ];
    for (quality, word, size, of) in pictures {
        for (threads, of) in (1..).zip(of) {
            let render = Render { quality, size, ..Render::default() };
            let pool = pool(Options { threads, ..options });
            let frames = RefCell::new(Vec::new());
            let ours = || {
                let made = pool.install(|| render.with(&renderer).run());
                let report = made.expect("the scene has a picture").report;
                frames.borrow_mut().push(report.frame_time);
                report.pixels_hit as usize
            };
            let seen = ours();
            let mut contest = Contest::new();
            contest.enter(Contestant::Ours, word, Ok(()), ours);
            let standings = contest.run(options.effort());
            let mut frames = frames.into_inner();
            frames.sort_unstable();
            let frame = frames[frames.len() / 2].as_secs_f64() * 1e3;
            rows.push(ResultRow {
                case: "hero-picture",
                of,
                primitives: renderer.evaluator().evaluations_per_point() as usize,
                points: render.size.iter().map(|&side| side as usize).product(),
                unit: "run",
                units: 1.0,
                standings,
                extra: vec![
                    ("quality", json!(word)),
                    ("threads", json!(threads)),
                    ("pixels_hit", json!(seen)),
                    ("frame_ms", json!(rounded(frame))),
                ],
            });
        }
    }
    rows
}

/// A picture with normals of blobs, one of which has just been edited.
pub(super) fn blobs(options: Options) -> Vec<ResultRow> {
    let blobs = model::blobs(BLOBS, 1);
    let mut edited = blobs.clone();
    edited[0].radius *= 1.1;
    let trees = [&blobs, &edited].map(|blobs| model::tree(blobs));
    let renderer = RefCell::new(Renderer::new(&Compiler::new(), &trees[0]).expect("blobs compile"));
    let view = View { orthographic: true, ..View::named("top").expect("it is a view") };
    let render = Render {
        size: [PICTURE; 2],
        view,
        mode: RenderMode::Normal,
        quality: Quality::Draft,
        antialias: 1,
        region: Some(Box3::new([-1.0; 3], [1.0; 3])),
        ..Render::default()
    };
    let pool = pool(options);
    let turn = Cell::new(0);
    let ours = || {
        turn.set(1 - turn.get());
        let updated = renderer.borrow().updated(&trees[turn.get()]).expect("an edit compiles nothing");
        *renderer.borrow_mut() = updated;
        let current = renderer.borrow();
        let renderer = &*current;
        let made = pool.install(|| render.with(renderer).run());
        made.expect("blobs have a picture").report.pixels_hit as usize
    };
    let mut contest = Contest::new();
    let seen = ours();
    contest.enter(Contestant::Ours, "", Ok(()), ours);
    let threads = peer_threads(options);
    for gate in Gate::ALL {
        let run = move |blobs: &[model::Blob]| {
            FidgetModel::<JitFunction>::new(blobs, gate).picture(PICTURE, threads)
        };
        let edited = &edited;
        contest.enter(Contestant::FidgetJit, gate.name(), Ok(()), move || run(edited));
    }
    let extra = vec![("threads", json!(options.threads)), ("pixels_hit", json!(seen))];
    let standings = contest.run(options.effort());
    vec![ResultRow {
        case: "picture",
        of: "",
        primitives: BLOBS,
        points: (PICTURE * PICTURE) as usize,
        unit: "run",
        units: 1.0,
        standings,
        extra,
    }]
}
