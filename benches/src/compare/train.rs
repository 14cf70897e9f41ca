//! A real scene: the locomotive of ParsIP (95 leaves, 31 operators) at every point of the lattice that it was
//! published with.

use std::cell::RefCell;

use jbt::import;
use jbt::{CheckedTree, Compiler, Points, Query};
use jbt_testkit::samples;
use serde_json::json;

use super::contest::{Contest, Contestant, Standings};
use super::options::Options;
use super::oracle::{Oracle, Tolerance};
use super::report::ResultRow;
use crate::naive::Walker;

/// The edge of a cell.
const CELL: f64 = 0.13;
/// The file, in the folder of samples.
const SCENE: &str = "parsip/train_corrected.scene";
/// What ParsIP's authors report: field evaluations per second and core, with AVX (Shirazian, Wyvill and
/// Duprat 2012).
const PUBLISHED: f64 = 2.6e6;

/// The scene, if it is here.
fn scene() -> Result<CheckedTree, String> {
    let bytes = samples::file(SCENE)?;
    let imported = import::parsip(&bytes).map_err(|_| "the scene has errors".to_owned())?;
    imported.model.check().map_err(|_| "the model has errors".to_owned())
}

/// All points of the lattice.
fn lattice(tree: &CheckedTree) -> Points {
    let polygonize = jbt::Polygonize {
        region: None,
        fineness: jbt::Fineness::Cell(CELL),
        verify: false,
        ..jbt::Polygonize::default()
    };
    let lattice = polygonize.lattice(tree).expect("the train is bounded");
    let [nx, ny, nz] = lattice.points();
    let at = |axis, index| lattice.coordinate(axis, index);
    (0..nx * ny * nz).map(|i| [at(0, i % nx), at(1, i / nx % ny), at(2, i / nx / ny)]).collect()
}

/// The field on the lattice, unpruned, on one core.
pub(super) fn train(options: Options) -> Vec<ResultRow> {
    let row = |primitives, points: usize, standings, extra| ResultRow {
        case: "train",
        of: "",
        primitives,
        points,
        unit: "evaluation",
        units: points as f64,
        standings,
        extra,
    };
    let tree = match scene() {
        Ok(tree) => tree,
        Err(reason) => {
            let standings = Standings { standings: Vec::new(), disagreements: vec![reason] };
            return vec![row(0, 0, standings, Vec::new())];
        }
    };
    let points = lattice(&tree);
    let oracle = Oracle::new(&tree, &points);
    let evaluator = Compiler::new().evaluator(&tree, Query::FIELD).expect("the train compiles");
    let (primitives, engine) = (evaluator.evaluations_per_point(), evaluator.engine().name());
    let walker = Walker::new(&tree);
    let samples = RefCell::new(evaluator.samples());
    let field = RefCell::new(vec![f32::NAN; points.len()]);

    let mut contest = Contest::new();
    let ours = || evaluator.eval(&points, &mut samples.borrow_mut()).expect("the buffers fit");
    let check = |(): &()| oracle.check(&[samples.borrow().field()], Tolerance::EXACT);
    contest.enter_checked(Contestant::Ours, "", ours, check);
    let walk = || walker.field(points.planes(), &mut field.borrow_mut());
    let check = |(): &()| oracle.check(&[&field.borrow()], Tolerance::EXACT);
    contest.enter_checked(Contestant::Walk, "", walk, check);
    let standings = contest.run(options.effort());
    let mut row = row(primitives as usize, points.len(), standings, vec![("engine", json!(engine))]);
    if let Some(nanoseconds) = row.nanoseconds(Contestant::Ours) {
        row.extra.push(("evaluations_per_second", json!((1e9 / nanoseconds).round())));
        row.extra.push(("published_evaluations_per_second", json!(PUBLISHED)));
    }
    vec![row]
}
