//! Ranges of boxes enclose the values in them, and the rows that matter in a box give the bits that all rows
//! give.

use fastrand::Rng;
use jbt::boxes::{ANYTHING, Divisible};
use jbt::prune::Region;
use jbt::{Box3, CheckedTree, Compiler, Engine, Evaluator, Model, Points, Pruner, Query, Samples};
use jbt_testkit::skip::short_or_long;

use super::Verdict;
use super::engines::same_bits;
use crate::common::answers;
use crate::points;
use crate::subject::Subject;

/// Boxes of a check in short and of one at length, each of so many parts, with so many points in each part.
const BOXES: [usize; 2] = [40, 125];
const PARTS: usize = 8;
const POINTS: usize = 16;

pub fn check(subject: &Subject) -> Verdict {
    let bounded = regions(&subject.tree, &subject.bounds, &subject.all)?;
    // A range may know nothing; ranges that never do are of no use.
    if bounded == 0 {
        return Err("no range says anything".to_owned());
    }
    beside_itself(subject).map_err(|wrong| format!("beside itself: {wrong}"))
}

/// The model twice, in a sum: so each of its parts is far from something and can be left out there, a lone
/// leaf too.
fn beside_itself(subject: &Subject) -> Verdict {
    let (model, mut bounds) = (&subject.model, subject.bounds);
    let apart = 0.75 * bounds.longest_side();
    bounds.high[0] += apart;
    let root = &model.root + model.root.translate([f64::from(apart), 0.0, 0.0]);
    let tree = Model { root, ..model.clone() }.check().map_err(|errors| format!("{errors:?}"))?;
    let evaluator = Compiler::for_engine(Engine::Lanes).evaluator(&tree, Query::ALL);
    regions(&tree, &bounds, &[evaluator.map_err(|error| error.to_string())?])?;
    Ok(())
}

/// Checks boxes and their parts; counts the ranges that say something.
fn regions(tree: &CheckedTree, bounds: &Box3, evaluators: &[Evaluator]) -> Result<usize, String> {
    let pruner =
        Pruner::new(&Compiler::for_engine(Engine::Lanes), tree).map_err(|error| error.to_string())?;
    let rng = &mut Rng::with_seed(3);
    let mut bounded = 0;
    for _ in 0..short_or_long(BOXES) {
        let whole = points::part(rng, bounds);
        let region = pruner.region(whole).map_err(|error| error.to_string())?;
        let boxes: Vec<Box3> = (0..PARTS).map(|_| points::part(rng, &whole)).collect();
        let mut ranges = [ANYTHING; PARTS];
        pruner.ranges(&region, &boxes, &mut ranges).map_err(|error| error.to_string())?;
        let mut parts = Vec::new();
        pruner.narrow(&region, &boxes, &mut parts).map_err(|error| error.to_string())?;
        for (part, range) in parts.iter().zip(ranges) {
            bounded += usize::from(range != ANYTHING);
            let points = points::with_sides(rng, &part.bounds(), POINTS);
            check_part(&evaluators[rng.usize(0..evaluators.len())], part, range, &points)?;
        }
    }
    Ok(bounded)
}

fn check_part(evaluator: &Evaluator, part: &Region, range: [f32; 2], points: &Points) -> Verdict {
    let all: Samples = answers(evaluator, points);
    let mut planes = vec![vec![f32::NAN; points.len()]; all.planes().len()];
    let mut selected: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    evaluator.eval_region(part, points.planes(), &mut selected).expect("there is a plane for each answer");
    for ((name, expected), got) in all.layout().names().iter().zip(all.planes()).zip(&planes) {
        let what = format!("{name} by {} with the rows of {:?}", evaluator.engine().name(), part.bounds());
        same_bits(&what, points, expected, got)?;
    }
    let [low, high] = range;
    let outside = |field: &f32| range != ANYTHING && !(low..=high).contains(field);
    match all.field().iter().position(outside) {
        None => Ok(()),
        Some(index) => {
            let (point, field) = (points.get(index), all.field()[index]);
            Err(format!(
                "the field at {point:?}: expected [{low}, {high}] in {:?}, got {field}",
                part.bounds()
            ))
        }
    }
}
