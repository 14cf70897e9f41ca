//! Pruning changes no bit, and ranges hold what they say.
//!
//! * Random shapes (those of the differential test: every operator, signed fields, warps, shared subtrees), random boxes, narrowed several times: at points of
//!   the box every query gives the bits that it gives with all rows, on every engine.
//! * The field is in the range of each box around it.
//!
//! `JBT_PRUNE_SHAPES` sets the number of shapes, `JBT_PRUNE_POINTS` the points in each box. A failure prints the model.
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

mod common;

use std::sync::atomic::{AtomicU64, Ordering};

use common::Random;
use fastrand::Rng;
use jbt::divide::Edit;
use jbt::prune::Region;
use jbt::region::{ANYTHING, Divisible};
use jbt::{Box3, Compiler, Engine, Evaluator, Model, Points, Pruner, Query};
use jbt_frontend::combine::Combinator;
use jbt_frontend::text::print;
use jbt_frontend::tree::{NodeKind, Tree};
use rayon::prelude::*;

const SHAPES: u64 = 600;
const POINTS: u64 = 24;
/// Boxes of each shape.
const BOXES: usize = 10;

fn setting(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|value| value.parse().ok()).unwrap_or(default)
}

#[derive(Default)]
struct Tally {
    points: AtomicU64,
    /// Evaluations with all rows, and with those of regions.
    all: AtomicU64,
    selected: AtomicU64,
    bounded: AtomicU64,
}

#[test]
fn pruned_answers_have_the_bits_of_all_rows() {
    let (shapes, points) = (setting("JBT_PRUNE_SHAPES", SHAPES), setting("JBT_PRUNE_POINTS", POINTS));
    let tally = Tally::default();
    (0..shapes).into_par_iter().for_each(|shape| try_shape(shape, points as usize, &tally));
    let Tally { points, all, selected, bounded } = tally;
    let [points, all, selected, bounded] = [points, all, selected, bounded].map(AtomicU64::into_inner);
    println!("{points} points, {all} evaluations became {selected}; {bounded} in ranges that end somewhere");
    assert!(selected * 2 < all, "most rows do not matter");
    assert!(bounded * 2 > points, "most ranges say something");
}

/// A closed box: ordinary, tiny, flat or a point, near the model.
fn random_box(rng: &mut Rng, around: &Box3) -> Box3 {
    let size = [1.0, 0.5, 0.1, 1e-3][rng.usize(0..4)];
    let mut bounds = Box3::default();
    for axis in 0..3 {
        let (low, high) = (around.low[axis], around.high[axis]);
        let length = (high - low) * size * rng.f32();
        let length = if rng.u8(0..20) == 0 { 0.0 } else { length };
        let at = low + (high - low - length) * rng.f32();
        bounds.low[axis] = at.clamp(low, high);
        bounds.high[axis] = (at + length).clamp(bounds.low[axis], high);
    }
    bounds
}

/// Points of a box, corners among them.
fn points_in(rng: &mut Rng, bounds: &Box3, count: usize) -> Points {
    let coordinate = |rng: &mut Rng, axis: usize| {
        let (low, high) = (bounds.low[axis], bounds.high[axis]);
        match rng.u8(0..8) {
            0 => low,
            1 => high,
            _ => (low + (high - low) * rng.f32()).clamp(low, high),
        }
    };
    (0..count).map(|_| std::array::from_fn(|axis| coordinate(rng, axis))).collect()
}

fn try_shape(shape: u64, count: usize, tally: &Tally) {
    let leaves = 1 + (shape % 23) as usize;
    let model = Random::new(shape, shape ^ 0x51_0000).model(leaves);
    let tree = model.check().expect("a random model is a good model");
    let engine = Engine::ALL[(shape % 3) as usize];
    let compiler = Compiler::for_engine(engine);
    let pruner = Pruner::new(&compiler, &tree).expect("the model compiles");
    let evaluators = Query::EVERY.map(|query| compiler.evaluator(&tree, query).expect("the model compiles"));
    let mut rng = Rng::with_seed(shape);
    let whole = Box3::new([-3.0; 3], [3.0; 3]);
    for round in 0..BOXES {
        let bounds = random_box(&mut rng, &whole);
        let mut region = pruner.region(bounds).expect("the box is proper");
        let mut bounds = bounds;
        // From region to region, up to four levels, among other boxes.
        for _ in 0..rng.usize(0..4) {
            let parts: Vec<Box3> = (0..rng.usize(1..9)).map(|_| random_box(&mut rng, &bounds)).collect();
            check_ranges(&mut rng, &model, &pruner, &evaluators[0], &region, &parts, tally);
            let mut regions = Vec::new();
            pruner.narrow(&region, &parts, &mut regions).expect("the boxes are proper");
            let part = rng.usize(0..parts.len());
            (bounds, region) = (parts[part], regions.swap_remove(part));
        }
        let points = points_in(&mut rng, &bounds, count);
        for (evaluator, query) in evaluators.iter().zip(Query::EVERY) {
            compare(
                &format!("shape {shape}, box {round}, {}", query.name()),
                &model,
                evaluator,
                &region,
                &points,
            );
        }
        let points = points.len() as u64;
        tally.points.fetch_add(points, Ordering::Relaxed);
        tally.all.fetch_add(points * evaluators[0].evaluations_per_point(), Ordering::Relaxed);
        tally.selected.fetch_add(points * evaluators[0].evaluations_in(&region), Ordering::Relaxed);
    }
}

fn compare(what: &str, model: &Model, evaluator: &Evaluator, region: &Region, points: &Points) {
    let mut all = evaluator.samples();
    evaluator.eval(points, &mut all).expect("the buffers fit");
    let mut planes = vec![vec![f32::NAN; points.len()]; evaluator.layout().names().len()];
    let mut selected: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    evaluator.eval_region(region, points.planes(), &mut selected).expect("the buffers fit");
    for ((name, all), selected) in evaluator.layout().names().iter().zip(all.planes()).zip(&planes) {
        for (index, (all, selected)) in all.iter().zip(selected).enumerate() {
            assert!(
                all.to_bits() == selected.to_bits() || (all.is_nan() && selected.is_nan()),
                "{what}: {name} is {all:e}, and {selected:e} with {} of {} rows, at {:?} in {:?}\n{}",
                region.rows(),
                evaluator.tables().tables.values().map(jbt::ir::Rows::len).sum::<usize>(),
                points.get(index),
                region.bounds(),
                print(model)
            );
        }
    }
}

fn check_ranges(
    rng: &mut Rng,
    model: &Model,
    pruner: &Pruner,
    field: &Evaluator,
    region: &Region,
    boxes: &[Box3],
    tally: &Tally,
) {
    let mut ranges = vec![[f32::NAN; 2]; boxes.len()];
    pruner.ranges(region, boxes, &mut ranges).expect("the boxes are proper");
    for (bounds, range) in boxes.iter().zip(ranges) {
        let points = points_in(rng, bounds, 8);
        let mut samples = field.samples();
        field.eval(&points, &mut samples).expect("the buffers fit");
        for (index, &value) in samples.field().iter().enumerate() {
            let inside = range == ANYTHING || (range[0] <= value && value <= range[1]);
            let point = points.get(index);
            assert!(inside, "{value:e} is not in {range:?}, at {point:?} in {bounds:?}\n{}", print(model));
        }
        if range[0].is_finite() || range[1].is_finite() {
            tally.bounded.fetch_add(points.len() as u64, Ordering::Relaxed);
        }
    }
}

/// Many points, each of whose rows can be left out.
fn blobs(count: usize, seed: u64) -> Model {
    let mut rng = Rng::with_seed(seed);
    let leaf = |_| {
        let at = [0; 3].map(|_: i32| 2.0 * rng.f64() - 1.0);
        jbt::build::point(at, 0.15)
    };
    Model::new(Tree::new(NodeKind::Combine(Combinator::Sum), (0..count).map(leaf).collect()))
}

#[test]
fn an_edit_is_where_the_rows_have_changed() {
    let compiler = Compiler::for_engine(Engine::Lanes);
    let compile = |model: &Model| Pruner::new(&compiler, &model.check().unwrap()).unwrap();
    let (few, same) = (compile(&blobs(200, 1)), compile(&blobs(200, 1)));
    assert_eq!(same.edit(&few), Edit::Boxes(vec![]));
    // One more point at the end: its support, and no other.
    let more = few.updated(&blobs(201, 1).check().unwrap()).unwrap();
    let Edit::Boxes(boxes) = more.edit(&few) else { panic!("the shape is the same") };
    assert_eq!(boxes.len(), 1);
    let side = boxes[0].longest_side();
    assert!((0.3..0.31).contains(&side), "{side}");
    // The other way round, and through a region of a far box.
    assert_eq!(few.edit(&more), Edit::Boxes(boxes.clone()));
    let far = Box3::new(boxes[0].high.map(|side| side + 0.1), boxes[0].high.map(|side| side + 0.4));
    let region = few.region(far).unwrap();
    let renewed = more.renewed(&few, &region);
    assert_eq!(renewed.selection(), more.region(far).unwrap().selection());
}
