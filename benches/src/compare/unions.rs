//! Unions of a thousand spheres, and a deep difference, to meshes: everything from the model on counts, code
//! included. Ours makes normals as well, fidget positions alone.
//!
//! A solid is a program of instructions (`.vm`), which both read as it is; spheres are primitives as well.

use std::fmt::Write as _;

use fastrand::Rng;
use jbt::boxes::Divisible as _;
use jbt::{Box3, CheckedTree, Compiler, Fineness, Polygonize, Polygonized, import};
use serde_json::json;

use super::contest::{Contest, Contestant};
use super::mesh::peer_threads;
use super::options::Options;
use super::report::ResultRow;
use crate::peers::fidget::{FidgetProgram, JitFunction};

/// Cells along an axis of the lattice over [-1, 1]^3: 2^7.
const DEPTH: u8 = 7;
/// Points of the lattice.
pub(super) const POINTS: usize = ((1 << DEPTH) + 1_usize).pow(3);
/// The spheres of a union.
pub(super) const SPHERES: usize = 1024;
/// The side of the boxes whose rows are counted, and how many are asked.
const BOX: f32 = 2.0 / 128.0;
const BOXES: usize = 2_000;
/// How many vertices are checked.
const CHECKED: usize = 500;
/// How far from the surface a vertex may be, on average, by the value of the program.
const VERTICES_OFF: f64 = 2e-3;

/// Instructions, one a line.
struct InstructionList {
    text: String,
    lines: usize,
}

impl InstructionList {
    fn new() -> Self {
        let mut program = Self { text: String::new(), lines: 0 };
        for axis in ["var-x", "var-y", "var-z"] {
            program.line(axis);
        }
        program
    }

    fn line(&mut self, what: &str) -> usize {
        writeln!(self.text, "_{} {what}", self.lines).expect("a text takes more");
        self.lines += 1;
        self.lines - 1
    }

    fn number(&mut self, number: f64) -> usize {
        self.line(&format!("const {number}"))
    }

    fn op(&mut self, op: &str, operands: &[usize]) -> usize {
        let names: String = operands.iter().map(|line| format!(" _{line}")).collect();
        self.line(&format!("{op}{names}"))
    }

    /// A sphere: the distance from its middle less its radius.
    fn sphere(&mut self, centre: [f64; 3], radius: f64) -> usize {
        let squares = [0, 1, 2].map(|axis| {
            let number = self.number(centre[axis]);
            let away = self.op("sub", &[axis, number]);
            self.op("square", &[away])
        });
        let sum = self.op("add", &squares[..2]);
        let sum = self.op("add", &[sum, squares[2]]);
        let (distance, radius) = (self.op("sqrt", &[sum]), self.number(radius));
        self.op("sub", &[distance, radius])
    }
}

/// The spheres: centres and radii.
fn spheres() -> Vec<([f64; 3], f64)> {
    let mut rng = Rng::with_seed(1);
    let sphere = |_| ([(); 3].map(|()| 2.0 * rng.f64() - 1.0), 0.02 + 0.06 * rng.f64());
    (0..SPHERES).map(sphere).collect()
}

/// Their union, one minimum after the other.
fn chain() -> String {
    let mut program = InstructionList::new();
    let all = spheres();
    let distances: Vec<usize> = all.iter().map(|&(centre, radius)| program.sphere(centre, radius)).collect();
    distances.into_iter().reduce(|all, one| program.op("min", &[all, one])).expect("there are spheres");
    program.text
}

/// Menger's sponge in the cube of half the domain's side: three levels of crosses, each cut from the rest.
fn sponge() -> String {
    let mut program = InstructionList::new();
    let half = program.number(0.5);
    let sides = [0, 1, 2].map(|axis| program.op("abs", &[axis]));
    let widest = program.op("max", &sides[..2]);
    let widest = program.op("max", &[widest, sides[2]]);
    let mut solid = program.op("sub", &[widest, half]);
    for level in 0..3 {
        let cell = 3f64.powi(-level);
        let crossed = [0, 1, 2].map(|axis| {
            let (size, middle) = (program.number(cell), program.number(0.5 - 0.5 * cell));
            let moved = program.op("sub", &[axis, middle]);
            let away = program.op("div", &[moved, size]);
            let nearest = program.op("round", &[away]);
            let nearest = program.op("mul", &[nearest, size]);
            let inside = program.op("sub", &[moved, nearest]);
            let inside = program.op("abs", &[inside]);
            let bar = program.number(cell / 6.0);
            program.op("sub", &[inside, bar])
        });
        for pair in [[0, 1], [1, 2], [2, 0]] {
            let bar = program.op("max", &pair.map(|axis| crossed[axis]));
            let outside = program.op("neg", &[bar]);
            solid = program.op("max", &[solid, outside]);
        }
    }
    program.text
}

fn read(bytes: &str) -> CheckedTree {
    let imported = import::vm(bytes.as_bytes()).expect("the program reads");
    imported.model.check().expect("the model is good")
}

/// The same spheres as primitives: soft objects have the iso-value at half their radius.
pub(super) fn primitives() -> CheckedTree {
    let sphere = |(centre, radius): ([f64; 3], f64)| jbt::build::point(centre, 2.0 * radius);
    let union = jbt::Tree::union(spheres().into_iter().map(sphere));
    jbt::Model::new(union).check().expect("the model is good")
}

pub(super) fn ours(tree: &CheckedTree, pool: &rayon::ThreadPool) -> Polygonized {
    let region = Some(Box3::new([-1.0; 3], [1.0; 3]));
    let fineness = Fineness::Resolution(1 << DEPTH);
    let polygonize = Polygonize { region, fineness, verify: false, thin_parts: false, sharp: false };
    pool.install(|| polygonize.mesh(&Compiler::new(), tree).run()).expect("the model has a mesh")
}

/// Whether the field at vertices is the iso-value.
pub(super) fn check(tree: &CheckedTree, made: &Polygonized) -> Result<(), String> {
    let positions = &made.mesh.positions;
    let step = positions.len().div_ceil(CHECKED).max(1);
    let offs: Vec<f64> = (positions.iter().step_by(step))
        .map(|position| (jbt::walk::walk(tree, position.map(f64::from)).field - tree.iso()).abs())
        .collect();
    let mean = offs.iter().sum::<f64>() / offs.len() as f64;
    if mean <= VERTICES_OFF { Ok(()) } else { Err(format!("vertices are off the surface by {mean:.1e}")) }
}

/// The union of as many small sums: two points side by side.
fn sums() -> CheckedTree {
    let pair = |(centre, radius): ([f64; 3], f64)| {
        let beside = [centre[0] + 0.5 * radius, centre[1], centre[2]];
        jbt::Tree::sum([centre, beside].map(|at| jbt::build::point(at, 2.0 * radius)))
    };
    let union = jbt::Tree::union(spheres().into_iter().map(pair));
    jbt::Model::new(union).check().expect("the model is good")
}

/// The rows of a model, and how many run in a box of 1/128 of the domain's side: on average, and at most.
fn rows(tree: &CheckedTree) -> (usize, f64, usize) {
    let pruner = Compiler::new().compile(tree).pruner().expect("the model compiles");
    let mut rng = Rng::with_seed(3);
    let (mut sum, mut most) = (0, 0);
    for _ in 0..BOXES {
        let low = [(); 3].map(|()| (2.0 - BOX) * rng.f32() - 1.0);
        let rows = pruner.region(Box3::new(low, low.map(|low| low + BOX))).expect("a proper box").rows();
        (sum, most) = (sum + rows, most.max(rows));
    }
    (pruner.everywhere().rows(), sum as f64 / BOXES as f64, most)
}

/// `program` is what fidget is given, if there is one.
fn row(of: &'static str, tree: &CheckedTree, program: Option<&str>, options: Options) -> ResultRow {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build().expect("threads");
    let (mut contest, mut triangles) = (Contest::new(), 0);
    contest.enter_checked(
        Contestant::Ours,
        "",
        || ours(tree, &pool),
        |made| {
            triangles = made.mesh.triangles.len();
            check(tree, made)
        },
    );
    if let Some(program) = program {
        let mesh = || {
            let program = FidgetProgram::<JitFunction>::new(program.as_bytes()).expect("fidget reads it");
            program.mesh(DEPTH, peer_threads(options))
        };
        contest.enter_checked(Contestant::FidgetJit, "", mesh, |made| match made.triangles {
            0 => Err("no triangles".to_owned()),
            _ => Ok(()),
        });
    }
    let (all, left, most) = rows(tree);
    ResultRow {
        case: "unions",
        of,
        primitives: all,
        points: POINTS,
        unit: "run",
        units: 1.0,
        standings: contest.run(options.effort()),
        extra: vec![
            ("rows", json!(all)),
            ("rows_in_a_box", json!(left)),
            ("most_rows_in_a_box", json!(most)),
            ("threads", json!(options.threads)),
            ("triangles", json!(triangles)),
        ],
    }
}

/// Each solid.
pub(super) fn unions(options: Options) -> Vec<ResultRow> {
    let (chain, sponge) = (chain(), sponge());
    vec![
        row("primitives", &primitives(), Some(&chain), options),
        row("small sums", &sums(), None, options),
        row("menger", &read(&sponge), Some(&sponge), options),
        row("spheres", &read(&chain), Some(&chain), options),
    ]
}

/// Questions before the measurement: after some a pruner makes trees, whose cost many questions share.
const FIRST_QUESTIONS: usize = 100;

/// One small box of a union of that many spheres, each of which reaches all boxes.
fn small_box(count: usize, options: Options) -> ResultRow {
    let mut rng = Rng::with_seed(1);
    let sphere = |_| jbt::build::point([(); 3].map(|()| 2.0 * rng.f64() - 1.0), 4.0);
    let union = jbt::Tree::union((0..count).map(sphere));
    let tree = jbt::Model::new(union).check().expect("the model is good");
    let pruner = Compiler::new().compile(&tree).pruner().expect("the model compiles");
    // As large as the mean distance of spheres is.
    let side = (8.0 / count as f64).cbrt() as f32;
    let mut rng = Rng::with_seed(2);
    let mut rows = move || {
        let low = [(); 3].map(|()| (2.0 - side) * rng.f32() - 1.0);
        pruner.region(Box3::new(low, low.map(|low| low + side))).expect("a proper box").rows()
    };
    let sum: usize = (0..FIRST_QUESTIONS).map(|_| rows()).sum();
    let mut contest = Contest::new();
    contest.enter(Contestant::Ours, "", Ok(()), rows);
    ResultRow {
        case: "small-box",
        of: "",
        primitives: count,
        points: 0,
        unit: "box",
        units: 1.0,
        standings: contest.run(options.effort()),
        extra: vec![("rows_in_a_box", json!(sum as f64 / FIRST_QUESTIONS as f64))],
    }
}

/// By number of spheres.
pub(super) fn small_boxes(options: Options) -> Vec<ResultRow> {
    [1_000, 10_000, 100_000, 1_000_000].into_iter().map(|count| small_box(count, options)).collect()
}
