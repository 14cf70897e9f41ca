//! Parts that are thinner than a cell are reported, and nothing else is.

mod fields;
mod planted;

use fastrand::Rng;
use fields::ModelField;
use jbt::mesh::{Lattice, Options, ThinReport, extract};
use jbt::{Box3, Compiler, Engine, Fineness, Polygonize, Polygonized};
use jbt_testkit::scene::{count, examples, tree};
use planted::{Made, Thin, planted};
use rayon::prelude::*;

fn mesh(model: &str, polygonize: Polygonize) -> Polygonized {
    let made = polygonize.mesh(&Compiler::for_engine(Engine::Lanes), &tree(model)).run();
    made.unwrap_or_else(|e| panic!("{e} in {model}"))
}

fn report(model: &str, polygonize: Polygonize) -> ThinReport {
    mesh(model, polygonize).report.thin.expect("it was searched for")
}

fn resolution(cells: usize) -> Polygonize {
    Polygonize { fineness: Fineness::Resolution(cells), ..Polygonize::default() }
}

/// Whether a place of a report is near a point.
fn names(report: &ThinReport, point: [f64; 3], distance: f64) -> bool {
    let apart = |near: &[f64; 3]| (0..3).map(|axis| (near[axis] - point[axis]).powi(2)).sum::<f64>().sqrt();
    report.near.iter().any(|near| apart(near) <= distance)
}

/// The edge of cells about planted parts.
const CELL: f64 = 0.03;
/// Where seeds of planted parts begin.
const SEED: u64 = 1;

/// A ball and, away from it, a planted part.
fn with_part(kind: (Thin, Made), seed: u64) -> (String, planted::Planted) {
    let mut rng = Rng::with_seed(seed);
    let center = [0; 3].map(|_| (if rng.bool() { 1.0 } else { -1.0 }) * (0.55 + 0.2 * rng.f64()));
    let part = planted(&mut rng, kind, center, CELL);
    (format!("union {{ point {{ surface_radius 0.3 }} {} }}", part.text), part)
}

fn about_part() -> Polygonize {
    Polygonize {
        region: Some(Box3::new([-1.11; 3], [1.11; 3])),
        fineness: Fineness::Cell(CELL),
        ..Polygonize::default()
    }
}

fn kinds() -> Vec<(Thin, Made)> {
    Thin::ALL.into_iter().flat_map(|thin| Made::ALL.map(|made| (thin, made))).collect()
}

#[test]
fn planted_parts_are_named() {
    let count = count("JBT_THIN_PARTS", 30);
    let all: Vec<((Thin, Made), u64)> = (0_u64..)
        .zip(kinds())
        .flat_map(|(n, kind)| (0..count).map(move |m| (kind, SEED + 1000 * n + m)))
        .collect();
    let total = all.len();
    let unnamed: Vec<String> = (all.into_par_iter())
        .filter_map(|(kind, seed)| {
            let (text, part) = with_part(kind, seed);
            let report = report(&text, about_part());
            let is_named = names(&report, part.center, part.reach + 4.0 * CELL);
            (!is_named).then(|| format!("{kind:?} of half {:.3}, seed {seed}: {report:?}", part.half))
        })
        .collect();
    assert!(20 * unnamed.len() <= total, "{} of {total} are not named: {unnamed:#?}", unnamed.len());
}

#[test]
fn smooth_bodies_are_silent() {
    let mut rng = Rng::with_seed(3);
    let mut blobs = String::new();
    for _ in 0..40 {
        let [x, y, z]: [f64; 3] = std::array::from_fn(|_| 2.0 * rng.f64() - 1.0);
        blobs += &format!("point {{ at ({x} {y} {z}) radius {} }}\n", 0.4 + 0.4 * rng.f64());
    }
    let models = [
        format!("sum {{ {blobs} }}"),
        format!("blend ricci 4 {{ {blobs} }}"),
        "ring { ring_radius 0.8 surface_radius 0.2 }".to_owned(),
        "twist axis z rate 2 { box { half (0.3 0.2 0.8) surface_radius 0.1 } }".to_owned(),
        "difference { sphere { sphere_radius 0.8 surface_radius 0.1 } point { at (0.7 0 0) surface_radius 0.5 } }"
            .to_owned(),
    ];
    for model in models {
        let found = report(&model, resolution(96));
        assert_eq!((found.places, &found.near, found.cell), (0, &Vec::new(), None), "{model}: {found:?}");
    }
}

#[test]
fn examples_are_silent() {
    examples().into_par_iter().for_each(|(name, text)| {
        let tree = tree(&text);
        // Some have no end of their own.
        let Ok(made) = Polygonize::default().mesh(&Compiler::new(), &tree).run() else { return };
        let found = made.report.thin.expect("it was searched for");
        // Two flagpoles of the castle are thinner than a cell, and said to be.
        let places = if name == "castle.jbt" { 2 } else { 0 };
        assert_eq!(found.places, places, "{name}: {found:?}");
    });
}

#[test]
fn what_a_lattice_cannot_show_is_named() {
    let blobs = "union { point { at (-100 0 0) surface_radius 1 } point { at (100 0 0) surface_radius 1 } }";
    let found = report(blobs, Polygonize::default());
    assert_eq!((found.places, found.missed + found.shredded), (2, 2), "{found:?}");
    assert!(names(&found, [-100.0, 0.0, 0.0], 4.0) && names(&found, [100.0, 0.0, 0.0], 4.0), "{found:?}");
    assert!(found.cell.is_some_and(|cell| (0.2..=1.0).contains(&cell)), "{found:?}");

    let shell = "shell thickness 0.01 { sphere { sphere_radius 0.7 surface_radius 0.2 } }";
    let found = report(shell, resolution(48));
    assert!(found.places > 0 && found.shredded + found.missed > 50, "{found:?}");
    assert!(found.near.len() <= jbt::mesh::MAX_NEAR);
}

#[test]
fn advice_is_good() {
    for seed in 0..5 {
        let (text, part) = with_part((Thin::Sheet, Made::Formula), 50 + seed);
        let cell = report(&text, about_part()).cell.expect("it is found");
        assert!(cell < CELL);
        let corner = |side: f64| part.center.map(|c| c + side * (part.reach + 4.0 * cell));
        let region = Some(Box3::new(corner(-1.0), corner(1.0)));
        let fineness = Fineness::Cell(cell.max(part.reach / 200.0));
        let made = mesh(&text, Polygonize { region, fineness, ..Polygonize::default() });
        assert!(made.mesh.triangles.len() > 1000, "half {}: {:?}", part.half, made.report.thin);
    }
}

#[test]
fn nobody_searches_who_does_not_want_to() {
    let (text, _) = with_part((Thin::Rod, Made::Soft), 1);
    let with = mesh(&text, about_part());
    let without = mesh(&text, Polygonize { thin_parts: false, ..about_part() });
    assert!(with.report.thin.is_some() && without.report.thin.is_none());
    assert_eq!(with.mesh, without.mesh);
}

#[test]
fn a_search_is_bounded() {
    // Nothing is inside, and no range says so.
    let model = "expression within (-1 -1 -1) to (1 1 1) { 0.4999 * (sin(40 * x)^2 + cos(40 * x)^2) }";
    let made = mesh(model, resolution(64));
    let found = made.report.thin.expect("it was searched for");
    let blocks: u64 = made.lattice.cells().iter().map(|&cells| cells.div_ceil(4) as u64).product();
    assert!(found.unproven > blocks / 4, "{found:?}");
    assert!(found.boxes <= blocks * 8 * 32, "{found:?} in {blocks} blocks");
    assert_eq!((found.missed, found.places), (0, 0), "{found:?}");
}

/// The report of a model over the region of planted parts.
fn report_of(field: &ModelField, brick: Option<usize>) -> ThinReport {
    let lattice = Lattice::covering([-1.11; 3], [1.11; 3], CELL).expect("it is a lattice");
    let options = Options { brick, thin_parts: true, ..Options::default() };
    extract(field, &lattice, &options).run().expect("it has a mesh").1.thin.expect("it was searched for")
}

fn models() -> Vec<String> {
    let mut models: Vec<String> = (0_u64..).zip(kinds()).map(|(n, kind)| with_part(kind, 20 + n).0).collect();
    let all: Vec<String> = (0_u64..).zip(kinds()).map(|(n, kind)| with_part(kind, 40 + n).0).collect();
    models.push(format!("union {{ {} }}", all.join(" ")));
    models.push("twist axis z rate 4 { box { half (0.5 0.004 0.8) surface_radius 0.008 } }".to_owned());
    models
        .push("translate (0.3 0.2 0.1) { shell thickness 0.01 { point { surface_radius 0.6 } } }".to_owned());
    models
}

#[test]
fn bricks_threads_and_engines_change_nothing() {
    for model in models() {
        let tree = tree(&model);
        let field = ModelField::new(&tree, Engine::Lanes, true);
        let expected = report_of(&field, None);
        for brick in [2, 4, 8, 16, 32] {
            assert_eq!(report_of(&field, Some(brick)), expected, "bricks of {brick} in {model}");
        }
        for threads in [1, 2] {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be made");
            assert_eq!(pool.install(|| report_of(&field, None)), expected, "{threads} threads in {model}");
        }
        assert_eq!(report_of(&ModelField::new(&tree, Engine::Jit, true), None), expected, "{model}");
    }
    let model = &models()[1];
    let of = |engine| report_of(&ModelField::new(&tree(model), engine, true), Some(8));
    assert_eq!(of(Engine::Scalar), of(Engine::Lanes));
    assert!(of(Engine::Lanes).places > 0);
}

#[test]
fn pruning_changes_nothing() {
    for model in models() {
        let tree = tree(&model);
        // Ranges of all rows may be wider, so it may take more of them.
        let found = |is_pruned| {
            let mut report = report_of(&ModelField::new(&tree, Engine::Lanes, is_pruned), None);
            report.boxes = 0;
            report
        };
        assert_eq!(found(false), found(true), "{model}");
    }
}

#[test]
fn edits_change_nothing() {
    let blobs = |x: f64, radius: f64| {
        format!(
            "union {{ point {{ surface_radius 0.3 }} segment {{ from ({x} -0.5 0.6) to (0.4 0.5 0.7) surface_radius {radius} }} }}"
        )
    };
    let (before, after) = (tree(&blobs(-0.5, 0.2)), tree(&blobs(0.55, 0.004)));
    let fresh = report_of(&ModelField::new(&after, Engine::Lanes, true), None);
    let edited = ModelField::new(&before, Engine::Lanes, true);
    assert_eq!(report_of(&edited, None).places, 0);
    assert_eq!(report_of(&edited.updated(&after), None), fresh);
    assert!(fresh.places > 0);
}
