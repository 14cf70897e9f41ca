//! Rows that are left out in a box change no bit there, and ranges hold the field.

use fastrand::Rng;
use jbt::boxes::{ANYTHING, Divisible as _};
use jbt::{Box3, Classified as _, Compiler, Engine, ErrorKind, Evaluator, Points, Pruner, Query, Region};
use jbt_testkit::bits::same;
use jbt_testkit::boxes::{point_in, random_box};

use crate::engines::{answers, evaluator, text};
use crate::model::{quick_engine, rng, small_tree};

/// Boxes that are tried for one model.
const BOXES: usize = 3;
/// Points in each.
const POINTS: usize = 20;

/// Asks the model that bytes mean in boxes within each other.
pub(crate) fn run(bytes: &[u8]) {
    let Some(tree) = small_tree(bytes) else { return };
    let mut rng = rng(bytes);
    let compiler = Compiler::for_engine(quick_engine(&mut rng, &tree, &Engine::ALL));
    let query = Query::EVERY[rng.usize(0..Query::EVERY.len())];
    let pruner = match Pruner::new(&compiler, &tree) {
        Ok(pruner) => pruner,
        Err(error) if matches!(error.kind(), ErrorKind::Limit | ErrorKind::System) => return,
        Err(error) => panic!("a checked model compiles: {error}"),
    };
    let (Some(asked), Some(field)) =
        (evaluator(&compiler, &tree, query), evaluator(&compiler, &tree, Query::FIELD))
    else {
        return;
    };
    for _ in 0..BOXES {
        let mut bounds = part(&mut rng, &Box3::new([-3.0; 3], [3.0; 3]));
        let mut region = pruner.region(bounds).expect("the box is proper");
        for _ in 0..rng.usize(0..3) {
            let parts: Vec<Box3> = (0..rng.usize(1..9)).map(|_| part(&mut rng, &bounds)).collect();
            check_ranges(&mut rng, &pruner, &field, (&region, &parts), bytes);
            let mut regions = Vec::new();
            pruner.narrow(&region, &parts, &mut regions).expect("the boxes are proper");
            let chosen = rng.usize(0..parts.len());
            (bounds, region) = (parts[chosen], regions.swap_remove(chosen));
        }
        check_region(&asked, &region, &points_in(&mut rng, &asked, &bounds), bytes);
    }
}

fn part(rng: &mut Rng, Box3 { low, high }: &Box3) -> Box3 {
    let [low, high] = random_box(rng, [*low, *high]);
    Box3::new(low, high)
}

/// Points of a box, both from the origin of the evaluator's model.
fn points_in(rng: &mut Rng, evaluator: &Evaluator, Box3 { low, high }: &Box3) -> Points {
    let mut points = evaluator.points();
    points.extend((0..POINTS).map(|_| point_in(rng, [*low, *high])));
    points
}

fn check_region(evaluator: &Evaluator, region: &Region, points: &Points, bytes: &[u8]) {
    let all = answers(evaluator, points);
    let mut planes = vec![vec![f32::NAN; points.len()]; evaluator.layout().names().len()];
    let mut selected: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    evaluator.eval_region(region, points.planes(), &mut selected).expect("the buffers fit");
    for ((name, all), selected) in evaluator.layout().names().iter().zip(all.planes()).zip(&planes) {
        for (index, (old, new)) in all.iter().zip(selected).enumerate() {
            let (point, bounds) = (points.get(index), region.bounds());
            let engine = evaluator.engine().name();
            assert!(
                same(*old, *new),
                "{name} is {old:e}, and {new:e} pruned, at {point:?} in {bounds:?} by {engine}\n{}",
                text(bytes)
            );
        }
    }
}

fn check_ranges(
    rng: &mut Rng,
    pruner: &Pruner,
    field: &Evaluator,
    (region, boxes): (&Region, &[Box3]),
    bytes: &[u8],
) {
    let mut ranges = vec![[f32::NAN; 2]; boxes.len()];
    pruner.ranges(region, boxes, &mut ranges).expect("the boxes are proper");
    for (bounds, range) in boxes.iter().zip(ranges) {
        let points = points_in(rng, field, bounds);
        for (index, &value) in answers(field, &points).field().iter().enumerate() {
            let inside = range == ANYTHING || (range[0] <= value && value <= range[1]);
            let point = points.get(index);
            assert!(inside, "{value:e} is not in {range:?}, at {point:?} in {bounds:?}\n{}", text(bytes));
        }
    }
}
