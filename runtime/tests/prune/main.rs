//! Pruning changes no bit, and ranges hold what they say.
//!
//! * Random shapes (those of the differential test: every operator, signed fields, warps, shared subtrees),
//!   random boxes, narrowed several times: at points of the box every query gives the bits that it gives with
//!   all rows, on every engine.
//! * The field is in the range of each box around it.
//!
//! `JBT_PRUNE_SHAPES` sets the number of shapes, `JBT_PRUNE_POINTS` the points in each box. A failure prints
//! the model.
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

#[path = "../common/mod.rs"]
mod common;
mod edges;
mod large;
mod unions;

use std::sync::atomic::{AtomicU64, Ordering};

use common::answers;
use fastrand::Rng;
use jbt::boxes::{ANYTHING, Divisible};
use jbt::divide::Edit;
use jbt::prune::Region;
use jbt::{Box3, Compiler, Engine, Evaluator, Model, Points, Pruner, Query, Update};
use jbt_model::tree::Tree;
use jbt_testkit::bits::same;
use jbt_testkit::boxes;
use jbt_testkit::random::Random;
use jbt_testkit::scene::{count, model, tree};
use jbt_testkit::skip::short_or_long;
use jbt_text::print;
use rayon::prelude::*;

/// Random shapes: of a run in short, and of one at length; so are the others.
const SHAPES: [u64; 2] = [80, 250];
/// Boxes of each shape.
const BOXES: [usize; 2] = [4, 10];
/// Shapes whose parameters are set.
const SET: [u64; 2] = [40, 200];
const POINTS: u64 = 24;

#[derive(Default)]
struct Tally {
    points: AtomicU64,
    /// Evaluations with all rows, and with those of regions.
    all: AtomicU64,
    selected: AtomicU64,
    bounded: AtomicU64,
    /// Rows that there are, and those of regions.
    rows: AtomicU64,
    kept: AtomicU64,
}

#[test]
fn pruned_answers_have_the_bits_of_all_rows() {
    let (shapes, points) =
        (count("JBT_PRUNE_SHAPES", short_or_long(SHAPES)), count("JBT_PRUNE_POINTS", POINTS));
    let tally = Tally::default();
    (0..shapes).into_par_iter().for_each(|shape| try_shape(shape, points as usize, &tally));
    let Tally { points, all, selected, bounded, .. } = tally;
    let [points, all, selected, bounded] = [points, all, selected, bounded].map(AtomicU64::into_inner);
    println!("{points} points, {all} evaluations became {selected}; {bounded} in ranges that end somewhere");
    // Half of them: random models have every operator, and of many all rows matter everywhere.
    assert!(selected * 5 < all * 3, "many rows do not matter");
    assert!(bounded * 2 > points, "most ranges say something");
}

fn random_box(rng: &mut Rng, Box3 { low, high }: &Box3) -> Box3 {
    let [low, high] = boxes::random_box(rng, [*low, *high]);
    Box3::new(low, high)
}

fn points_in(rng: &mut Rng, Box3 { low, high }: &Box3, count: usize) -> Points {
    (0..count).map(|_| boxes::point_in(rng, [*low, *high])).collect()
}

fn try_shape(shape: u64, count: usize, tally: &Tally) {
    let leaves = 1 + (shape % 23) as usize;
    try_model(&Random::new(shape, shape ^ 0x51_0000).model(leaves), shape, count, tally);
}

fn try_model(model: &Model, shape: u64, count: usize, tally: &Tally) {
    let tree = model.check().expect("a random model is a good model");
    let engine = Engine::ALL[shape as usize % Engine::ALL.len()];
    let compiler = Compiler::for_engine(engine);
    let pruner = Pruner::new(&compiler, &tree).expect("the model compiles");
    let evaluators = Query::EVERY.map(|query| compiler.evaluator(&tree, query).expect("the model compiles"));
    let mut rng = Rng::with_seed(shape);
    let whole = Box3::new([-3.0; 3], [3.0; 3]);
    for round in 0..short_or_long(BOXES) {
        let bounds = random_box(&mut rng, &whole);
        let mut region = pruner.region(bounds).expect("the box is proper");
        let mut bounds = bounds;
        // From region to region, up to four levels, among other boxes.
        for _ in 0..rng.usize(0..4) {
            let parts: Vec<Box3> = (0..rng.usize(1..9)).map(|_| random_box(&mut rng, &bounds)).collect();
            check_ranges(&mut rng, model, &pruner, &evaluators[0], &region, &parts, tally);
            let mut regions = Vec::new();
            pruner.narrow(&region, &parts, &mut regions).expect("the boxes are proper");
            let part = rng.usize(0..parts.len());
            (bounds, region) = (parts[part], regions.swap_remove(part));
        }
        let points = points_in(&mut rng, &bounds, count);
        for (evaluator, query) in evaluators.iter().zip(Query::EVERY) {
            compare(
                &format!("shape {shape}, box {round}, {}", query.name()),
                model,
                evaluator,
                &region,
                &points,
            );
        }
        tally.rows.fetch_add(pruner.everywhere().rows() as u64, Ordering::Relaxed);
        tally.kept.fetch_add(region.rows() as u64, Ordering::Relaxed);
        let points = points.len() as u64;
        tally.points.fetch_add(points, Ordering::Relaxed);
        tally.all.fetch_add(points * evaluators[0].evaluations_per_point(), Ordering::Relaxed);
        tally.selected.fetch_add(points * evaluators[0].evaluations_in(&region), Ordering::Relaxed);
    }
}

/// A formula with its surface near a place, of one of a few forms.
fn formula(rng: &mut Rng) -> String {
    let [x, y, z] = [(); 3].map(|()| rng.f32() * 5.0 - 2.5);
    let size = 0.2 + 0.5 * rng.f32();
    let formula = match rng.u8(0..4) {
        0 => format!("{size} - sqrt((x - {x})^2 + (y - {y})^2 + (z - {z})^2)"),
        1 => format!("{size} - max(max(abs(x - {x}), abs(y - {y})), abs(z - {z}))"),
        2 => format!("{size} - abs(sin(x - {x})) - abs(y - {y}) * (1 + z^2)"),
        _ => format!("0.5 + {size} - max(x - {x}, max({x} - {size} - x, y - {y}))"),
    };
    let colour = [(); 3].map(|()| rng.f32());
    format!("color ({} {} {}) {{ expression {{ {formula} }} }} ", colour[0], colour[1], colour[2])
}

/// Operators of many formulas, in each other: formulas have no support, and only what they are in a box says
/// that they do not decide there.
fn formulas(rng: &mut Rng) -> Model {
    let mut text = String::from("jbt 1 let shared = union { ");
    (0..rng.usize(2..5)).for_each(|_| text += &formula(rng));
    text += "} ";
    let (outer, inner) = if rng.bool() { ("union", "intersection") } else { ("intersection", "union") };
    text += outer;
    text += " { ";
    (0..rng.usize(20..60)).for_each(|_| text += &formula(rng));
    for _ in 0..rng.usize(0..30) {
        let operands: String = (0..rng.usize(2..4)).map(|_| formula(rng)).collect();
        text += &format!("{inner} {{ {operands} }} ");
    }
    if rng.bool() {
        // What is shared is computed in front of all, so that nothing is free.
        text += &format!(
            "{inner} {{ use shared {} }} difference {{ use shared {} }} ",
            formula(rng),
            formula(rng)
        );
    }
    if rng.bool() {
        let operands: String = (0..30).map(|_| formula(rng)).collect();
        text += &format!("twist axis z rate 0.5 {{ {outer} {{ {operands} }} }} ");
    }
    text += "}";
    model(&text)
}

#[test]
fn formulas_that_do_not_decide_are_left_out() {
    let tally = Tally::default();
    (0..24_u64).into_par_iter().for_each(|seed| {
        let model = formulas(&mut Rng::with_seed(seed));
        try_model(&model, seed, 24, &tally);
    });
    let [rows, kept] = [tally.rows, tally.kept].map(AtomicU64::into_inner);
    println!("{rows} rows became {kept}");
    assert!(kept * 2 < rows, "most formulas do not decide");
}

fn compare(what: &str, model: &Model, evaluator: &Evaluator, region: &Region, points: &Points) {
    let all = answers(evaluator, points);
    let mut planes = vec![vec![f32::NAN; points.len()]; evaluator.layout().names().len()];
    let mut selected: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    evaluator.eval_region(region, points.planes(), &mut selected).expect("the buffers fit");
    for ((name, all), selected) in evaluator.layout().names().iter().zip(all.planes()).zip(&planes) {
        for (index, (all, selected)) in all.iter().zip(selected).enumerate() {
            assert!(
                same(*all, *selected),
                "{what}: {name} is {all:e}, and {selected:e} with {} of {} rows, at {:?} in {:?}\n{}",
                region.rows(),
                evaluator.tables().tables.values().map(jbt::internals::ir::Rows::len).sum::<usize>(),
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
        let samples = answers(field, &points);
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
    Model::new(Tree::sum((0..count).map(leaf)))
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

/// A row of tanks, or one alone. The last has a choice of turrets, some of which share parts.
const TANKS: &str = "jbt 1 param turret = 0 param scene = 0
    let ball = point { at (3 0 0.4) radius 0.4 }
    let twisted = translate (3 0 0) { twist axis z rate 1 {
        union { point { at (0 0 0.6) radius 0.2 } point { at (0 0.2 0.5) radius 0.2 } }
    } }
    select scene {
        union {
            color (1 0 0) { point { at (0 0 0) radius 0.5 } }
            point { at (1 0 0) radius 0.5 }
            point { at (2 0 0) radius 0.5 }
            sum {
                point { at (3 0 0) radius 0.5 }
                select turret {
                    use ball
                    color (0 1 0) { sum { use ball use twisted } }
                    color (0 0 1) { intersection { use twisted point { at (3 0 0.8) radius 0.6 } } }
                    segment { from (3 0 0) to (3 0.3 0.2) radius 0.3 }
                }
            }
        }
        color (0 0 1) { point { at (0 0.2 0) radius 0.5 } }
    }";

#[test]
fn a_choice_is_an_edit_where_the_children_are() {
    let (model, start) = (model(TANKS), tree(TANKS));
    let whole = Box3::new([-1.0; 3], [4.0, 1.0, 1.5]);
    let points = points_in(&mut Rng::with_seed(4), &whole, 2000);
    for engine in Engine::ALL {
        let compiler = Compiler::for_engine(engine);
        let mut old = Pruner::new(&compiler, &start).unwrap();
        let mut evaluators = Query::EVERY.map(|query| compiler.evaluator(&start, query).unwrap());
        let mut before = fields(&evaluators[0], &points);
        let mut scene_before = 0;
        for (turret, scene) in [(3, 0), (0, 0), (1, 0), (2, 0), (0, 0), (0, 1), (2, 1), (3, 0), (1, 0)] {
            let values = [("turret", f64::from(turret)), ("scene", f64::from(scene))];
            let set = start.with_parameters(&values).unwrap();
            let new = old.updated(&set).unwrap();
            for evaluator in &mut evaluators {
                assert_eq!(evaluator.update(&set).unwrap(), Update::Numbers);
            }
            let edit = new.edit(&old);
            assert_ne!(edit, Edit::Everywhere);
            let after = fields(&evaluators[0], &points);
            for index in (0..points.len()).filter(|&index| before[index].to_bits() != after[index].to_bits())
            {
                let at = points.get(index);
                assert!(edit.touches(&Box3::new(at, at)), "{at:?} is not in {edit:?}");
            }
            // A turret is far from the other tanks.
            let others = Box3::new([-1.0; 3], [2.2, 1.0, 1.5]);
            assert_eq!(edit.touches(&others), scene != scene_before, "{edit:?}");
            check_renewed(&whole, [&old, &new], &edit, &model, &evaluators);
            (old, before, scene_before) = (new, after, scene);
        }
    }
}

fn fields(evaluator: &Evaluator, points: &Points) -> Vec<f32> {
    let samples = answers(evaluator, points);
    samples.field().to_vec()
}

/// Regions of boxes that an edit does not touch give the answers of the new model.
fn check_renewed(
    whole: &Box3,
    [old, new]: [&Pruner; 2],
    edit: &Edit,
    model: &Model,
    evaluators: &[Evaluator],
) {
    let mut rng = Rng::with_seed(5);
    for round in 0..60 {
        let bounds = random_box(&mut rng, whole);
        if edit.touches(&bounds) {
            continue;
        }
        let renewed = new.renewed(old, &old.region(bounds).expect("the box is proper"));
        let points = points_in(&mut rng, &bounds, 8);
        for evaluator in evaluators {
            compare(&format!("renewed, box {round}"), model, evaluator, &renewed, &points);
        }
    }
}

#[test]
fn setting_a_parameter_is_an_edit_where_something_has_changed() {
    let compiler = Compiler::for_engine(Engine::Lanes);
    let whole = Box3::new([-3.0; 3], [3.0; 3]);
    let (mut edits, mut bounded) = (0, 0);
    for shape in 0..count("JBT_PRUNE_SHAPES", short_or_long(SET)).min(SET[1]) {
        let mut rng = Rng::with_seed(shape);
        let points = points_in(&mut rng, &whole, 200);
        let model = Random::new(shape, shape).model(1 + (shape % 23) as usize);
        let tree = model.check().expect("a random model is a good model");
        let old = Pruner::new(&compiler, &tree).expect("it compiles");
        let was = fields(&compiler.evaluator(&tree, Query::FIELD).expect("it compiles"), &points);
        for parameter in &model.parameters {
            let value = if parameter.name().starts_with("choice") { 0.0 } else { 0.01 + rng.f64() };
            let set = tree.with_parameters(&[(parameter.name(), value)]).expect("a good value");
            let new = old.updated(&set).expect("it compiles");
            let edit = new.edit(&old);
            edits += 1;
            bounded += u32::from(edit != Edit::Everywhere);
            let evaluators = Query::EVERY.map(|query| compiler.evaluator(&set, query).expect("it compiles"));
            let is = fields(&evaluators[0], &points);
            for index in (0..points.len()).filter(|&index| was[index].to_bits() != is[index].to_bits()) {
                let at = Box3::new(points.get(index), points.get(index));
                assert!(
                    edit.touches(&at),
                    "{}, {value}: {at:?}, {edit:?}\n{}",
                    parameter.name(),
                    print(&model)
                );
            }
            check_renewed(&whole, [&old, &new], &edit, &model, &evaluators);
        }
    }
    println!("{edits} edits, {bounded} in boxes");
    assert!(bounded * 4 > edits, "{bounded} of {edits}");
}

#[test]
fn rows_that_come_to_an_intersection_matter_everywhere() {
    let compiler = Compiler::for_engine(Engine::Lanes);
    let ball = "point { at (0 0 0) radius 1 }";
    let two = Pruner::new(&compiler, &tree(&format!("jbt 1 intersection {{ {ball} {ball} }}"))).unwrap();
    let three = format!("jbt 1 intersection {{ {ball} {ball} point {{ at (0.9 0 0) radius 0.2 }} }}");
    assert_eq!(two.updated(&tree(&three)).unwrap().edit(&two), Edit::Everywhere);
}

#[test]
fn a_survey_is_ranges_and_regions_in_one() {
    let bits = |range: [f32; 2]| range.map(f32::to_bits);
    for shape in 0..count("JBT_PRUNE_SHAPES", short_or_long(SHAPES)).min(60) {
        let tree = Random::new(shape, shape).model(12).check().expect("a good model");
        let pruner = Pruner::new(&Compiler::for_engine(Engine::Lanes), &tree).expect("it compiles");
        let around = Box3::new([-2.0; 3], [2.0; 3]);
        let region = pruner.region(around).expect("a region");
        let mut rng = Rng::with_seed(shape);
        // More than one lane group of the interpreter, and not a whole number of anything.
        let boxes: Vec<Box3> = (0..43)
            .map(|_| {
                let low = std::array::from_fn(|_| 3.5 * rng.f32() - 2.0);
                Box3::new(low, low.map(|side: f32| (side + 0.5 * rng.f32()).min(2.0)))
            })
            .collect();
        let iso = tree.iso() as f32;
        let wanted = |[low, high]: [f32; 2]| low < iso && high >= iso;
        let surveyed = pruner.survey(&region, &boxes, &wanted).expect("a survey");
        assert_eq!(surveyed.len(), boxes.len());
        for (bounds, (range, found)) in boxes.iter().zip(surveyed) {
            let mut expected = [ANYTHING];
            pruner.ranges(&region, &[*bounds], &mut expected).expect("a range");
            assert_eq!(bits(range), bits(expected[0]), "shape {shape}");
            assert_eq!(found.is_some(), wanted(range), "shape {shape}");
            let mut narrowed = Vec::new();
            pruner.narrow(&region, &[*bounds], &mut narrowed).expect("a region");
            if let Some(found) = found {
                assert_eq!(found.bounds(), *bounds);
                assert_eq!(found.selection(), narrowed[0].selection(), "shape {shape}");
            }
        }
    }
}

#[test]
fn operands_that_do_not_decide_are_the_same_for_any_number_of_boxes() {
    // 64 formulas, far from each other: in a box near one of them, it alone decides.
    let at = |index: i32| f64::from(index) / 8.0 - 4.0;
    let formulas: String =
        (0..64).map(|index| format!("expression {{ 1 - abs(x - {}) - abs(y) }}\n", at(index))).collect();
    let tree = tree(&format!("jbt 1 union {{ {formulas} }}"));
    for engine in [Engine::Lanes, Engine::Jit] {
        let pruner = Pruner::new(&Compiler::for_engine(engine), &tree).expect("it compiles");
        let region = pruner.region(Box3::new([-5.0; 3], [5.0; 3])).expect("a region");
        let near = |index: i32| Box3::new([at(index) as f32, 0.0, 0.0], [at(index) as f32 + 0.05, 0.1, 1.0]);
        let boxes: Vec<Box3> = (0..43).map(near).collect();
        let surveyed = pruner.survey(&region, &boxes, &|_| true).expect("a survey");
        for (bounds, (_, found)) in boxes.iter().zip(surveyed) {
            let mut narrowed = Vec::new();
            pruner.narrow(&region, &[*bounds], &mut narrowed).expect("a region");
            let found = found.expect("it is wanted");
            assert_eq!(found.selection(), narrowed[0].selection(), "{engine:?} {bounds:?}");
            assert!(found.rows() < region.rows() / 2, "{} of {} rows are left", found.rows(), region.rows());
        }
    }
}

/// Near the edge of what a weak operand reaches, its field is too small for a number while its slope is not.
/// Another one that is 0 there decides an intersection, whichever of them comes first.
#[test]
fn an_intersection_that_is_zero_has_no_slope() {
    let weak = "point { radius 1 falloff wyvill strength 1e-37 }";
    let near = "point { at (0 5 0) radius 1 }";
    let compiler = Compiler::for_engine(Engine::Lanes);
    let gradients = |text: &str| {
        let model = model(&format!("jbt 1 sum {{ {text} }}"));
        let tree = model.check().expect("it is a good model");
        let evaluator = compiler.evaluator(&tree, Query::GRADIENT).expect("it compiles");
        let pruner = Pruner::new(&compiler, &tree).expect("it compiles");
        let mut points = evaluator.points();
        points.extend((0..2000).map(|step| [0.99 + 1e-5 * step as f32, 0.0, 0.0]));
        let region = pruner.region(Box3::new([0.99, 0.0, 0.0], [1.01, 0.0, 0.0])).expect("the box is proper");
        compare(text, &model, &evaluator, &region, &points);
        let answers = answers(&evaluator, &points);
        (answers.field().to_vec(), answers.planes()[1].clone())
    };
    let (fields, slopes) = gradients(weak);
    let steep = fields.iter().zip(&slopes).filter(|(field, slope)| **field == 0.0 && **slope != 0.0).count();
    assert!(steep > 0, "no field is too small for a number");
    for operator in ["intersection", "smooth_intersection 0.4", "product", "blend ricci -4"] {
        for operands in [[weak, near], [near, weak], [weak, weak]] {
            let text = format!("{operator} {{ {} }}", operands.join(" "));
            let (fields, slopes) = gradients(&text);
            for (field, slope) in fields.iter().zip(&slopes) {
                assert!(*field != 0.0 || *slope == 0.0, "{text}: {slope:e}");
            }
        }
    }
}
