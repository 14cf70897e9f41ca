//! The strongest test there is: random shapes, each with many sets of numbers, at friendly and at hostile
//! points.
//!
//! * scalar = lanes = machine code, **bit for bit**, for every query and every length of the last block (a
//!   NaN equals any NaN), at the best level of the instruction set that this CPU has, and at the others in
//!   turn;
//! * the field has the same bits whatever else is asked;
//! * a new set of numbers compiles nothing;
//! * wherever coordinates are finite, so are gradients, and fields and attributes unless operators multiply
//!   fields that are at the bounds of formulas: engines agree on a NaN, so this is asked for by itself;
//! * field, attributes and gradient agree with the f64 oracle `walk`, which shares no code with the compiler.
//!
//! `JBT_DIFFERENTIAL_SHAPES` sets the number of shapes, `JBT_DIFFERENTIAL_SEED` the first seed. A failure
//! prints the model.
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

mod common;

use std::sync::atomic::{AtomicU64, Ordering};

use common::answers;
use jbt::{Combinator, Compiler, Engine, Evaluator, Level, Model, Points, Query, Samples, Update};
use jbt_model::attribute::AttributeGroup;
use jbt_model::check::CheckedTree;
use jbt_model::kind::NodeKind;
use jbt_model::walk::{walk, walk_gradient};
use jbt_model::warp::Warp;
use jbt_testkit::bits::same;
use jbt_testkit::points::{HOSTILE, spicy};
use jbt_testkit::random::Random;
use jbt_testkit::scene::count;
use jbt_testkit::skip::short_or_long;
use jbt_text::print;
use rayon::prelude::*;

/// Random shapes: of a run in short, and of one at length.
const SHAPES: [u64; 2] = [60, 400];
const SETS: u64 = 10;

/// What the oracle allows: f32 rounding of coordinates, rows and sums, times how steep the field may be.
const FIELD_BOUND: f64 = 4e-5;
const GRADIENT_BOUND: f64 = 2e-3;
const ATTRIBUTE_BOUND: f64 = 2e-3;

#[derive(Default)]
struct Tally {
    compared: AtomicU64,
    gradients: AtomicU64,
    directions: AtomicU64,
}

#[test]
fn engines_agree_to_the_bit_and_with_the_oracle() {
    let shapes = count("JBT_DIFFERENTIAL_SHAPES", short_or_long(SHAPES));
    let seed = count("JBT_DIFFERENTIAL_SEED", 0);
    let tally = Tally::default();
    (seed..seed + shapes).into_par_iter().for_each(|shape| try_shape(shape, &tally));
    let compared = tally.compared.load(Ordering::Relaxed);
    let gradients = tally.gradients.load(Ordering::Relaxed);
    let directions = tally.directions.load(Ordering::Relaxed);
    println!(
        "{shapes} shapes, {compared} points against the oracle, {gradients} gradients, {directions} directions"
    );
    assert!(directions * 40 > compared, "some models have directions");
    assert!(gradients * 4 > compared, "most gradients are compared");
}

/// The models of the other test are worth a look: asked of the oracle alone, so of all that there are at length.
#[test]
fn most_models_have_a_surface_where_they_are_tried() {
    let shapes = SHAPES[1];
    let has_surface = |&(shape, set): &(u64, u64)| {
        let model = model_of(shape, set);
        let tree = model.check().expect("a random model is a good model");
        let points = points_of(shape, set).1;
        let ordinary = (0..points.len()).map(|index| points.get(index)).filter(is_ordinary);
        let mut sides = ordinary.map(|point| walk(&tree, point.map(f64::from)).field >= tree.iso());
        let first = sides.next();
        sides.any(|side| Some(side) != first)
    };
    let all: Vec<(u64, u64)> = (0..shapes).flat_map(|shape| (0..SETS).map(move |set| (shape, set))).collect();
    let with = all.par_iter().filter(|of| has_surface(of)).count();
    println!("{with} of {} sets of numbers have a surface", all.len());
    assert!(with * 2 > all.len());
}

/// A model of a shape, with one of its sets of numbers.
fn model_of(shape: u64, set: u64) -> Model {
    Random::new(shape, shape ^ (set + 1) << 32).model(1 + (shape % 13) as usize)
}

/// The points that it is tried at, and what makes more of them. Every length of a last block comes up, with and
/// without whole blocks before it.
fn points_of(shape: u64, set: u64) -> (fastrand::Rng, Points) {
    let mut rng = fastrand::Rng::with_seed(shape * SETS + set);
    let points = spicy(&mut rng, 1 + (shape + 7 * set) as usize % 45, 1.6).collect();
    (rng, points)
}

/// Whether the oracle is asked at a point.
fn is_ordinary(point: &[f32; 3]) -> bool {
    point.iter().all(|x| x.is_finite() && x.abs() <= 1e6)
}

/// All evaluators of one shape: for each query, for each engine at the best level of this CPU and at another
/// one, which changes with the shape.
fn evaluators(tree: &CheckedTree, shape: u64) -> Vec<Vec<Evaluator>> {
    let all = Level::available();
    let mut levels = vec![all[all.len() - 1], all[shape as usize % all.len()]];
    levels.dedup();
    let of = |query| {
        let compile = |compiler: Compiler| compiler.evaluator(tree, query).expect("the model compiles");
        // The reference knows no levels.
        let engines = levels.iter().flat_map(|&level| {
            [Engine::Lanes, Engine::Jit].map(|engine| Compiler::for_engine(engine).at_level(level))
        });
        std::iter::once(Compiler::for_engine(Engine::Scalar)).chain(engines).map(compile).collect()
    };
    Query::EVERY.map(of).into_iter().collect()
}

fn try_shape(shape: u64, tally: &Tally) {
    let mut all: Option<Vec<Vec<Evaluator>>> = None;
    for set in 0..SETS {
        let model = model_of(shape, set);
        let Ok(tree) = model.check() else {
            panic!(
                "shape {shape}, set {set}: a random model is a good model\n{}\n{:?}",
                print(&model),
                model.check()
            )
        };
        match &mut all {
            None => all = Some(evaluators(&tree, shape)),
            Some(all) => {
                for evaluator in all.iter_mut().flatten() {
                    let update = evaluator.update(&tree).expect("the model compiles");
                    assert_eq!(update, Update::Numbers, "shape {shape}, set {set}\n{}", print(&model));
                }
            }
        }
        let (mut rng, points) = points_of(shape, set);
        let what = format!("shape {shape}, set {set}");
        let answers = compare_engines(&what, &model, all.as_ref().expect("made above"), &points);
        check_finite(&what, &model, &tree, &points, &answers);
        let hostile = hostile(&mut rng, &points);
        let far = compare_engines(&what, &model, all.as_ref().expect("made above"), &hostile);
        check_finite(&what, &model, &tree, &hostile, &far);
        compare_oracle(&what, &model, &tree, &points, &answers, tally);
    }
}

/// The points, each with coordinates that overflow or underflow.
fn hostile(rng: &mut fastrand::Rng, points: &Points) -> Points {
    let one = |index| {
        let mut point = points.get(index);
        for _ in 0..rng.usize(1..4) {
            point[rng.usize(0..3)] = HOSTILE[rng.usize(0..HOSTILE.len())];
        }
        point
    };
    (0..points.len()).map(one).collect()
}

/// Whether operators multiply fields, or square them: of formulas that are at their bound of 2^100 that is
/// beyond f32.
fn multiplies(tree: &CheckedTree) -> bool {
    let multiplies = |kind: &NodeKind| {
        matches!(
            kind,
            NodeKind::Combine(
                Combinator::Product(_)
                    | Combinator::Offset(_)
                    | Combinator::RFunction(_)
                    | Combinator::RFunctionPower(_)
                    | Combinator::RFunctionOrder(_)
            )
        )
    };
    tree.nodes().iter().any(|node| multiplies(&node.kind))
}

/// Gradients at points with finite coordinates are finite; so are fields and attributes, if operators do not
/// multiply fields.
fn check_finite(what: &str, model: &Model, tree: &CheckedTree, points: &Points, answers: &Samples) {
    let gradients = answers.layout().names().iter().zip(answers.planes()).skip(1).take(3);
    let all = answers.layout().names().iter().zip(answers.planes());
    let planes: Vec<_> = if multiplies(tree) { gradients.collect() } else { all.collect() };
    for index in 0..points.len() {
        let point = points.get(index);
        if !point.iter().all(|x| x.is_finite()) {
            continue;
        }
        for (name, plane) in &planes {
            let answer = plane[index];
            assert!(answer.is_finite(), "{what}: {name} is {answer} at {point:?} of\n{}", print(model));
        }
    }
}

/// The scalar answers to the full query, once all engines and queries agree on them.
fn compare_engines(what: &str, model: &Model, all: &[Vec<Evaluator>], points: &Points) -> Samples {
    let mut full = None;
    let mut field: Option<Vec<f32>> = None;
    for (query, engines) in Query::EVERY.iter().zip(all) {
        let mut reference: Option<Samples> = None;
        for evaluator in engines {
            let samples = answers(evaluator, points);
            let Some(reference) = &reference else {
                reference = Some(samples);
                continue;
            };
            for ((name, old), new) in
                samples.layout().names().iter().zip(reference.planes()).zip(samples.planes())
            {
                same_bits(
                    &format!("{what}, {} of {}", name, query.name()),
                    evaluator.engine().name(),
                    model,
                    points,
                    old,
                    new,
                );
            }
        }
        let reference = reference.expect("there are engines");
        if let Some(field) = &field {
            same_bits(
                &format!("{what}, field of {}", query.name()),
                "query",
                model,
                points,
                field,
                reference.field(),
            );
        }
        field = Some(reference.field().to_vec());
        full = Some(reference);
    }
    full.expect("there are queries")
}

fn same_bits(what: &str, engine: &str, model: &Model, points: &Points, old: &[f32], new: &[f32]) {
    for (index, (old, new)) in old.iter().zip(new).enumerate() {
        let point = points.get(index);
        assert!(
            same(*old, *new),
            "{what}: {old:e} became {new:e} by {engine}, point {index} {point:?} of {}\n{}",
            points.len(),
            print(model)
        );
    }
}

/// Whether there are warps across whose walls fields jump.
fn has_walls(tree: &CheckedTree) -> bool {
    let is_wall = |kind: &NodeKind| {
        matches!(kind, NodeKind::Warp(Warp::Repeat(_) | Warp::RepeatAround(_) | Warp::Bend(_)))
    };
    tree.nodes().iter().any(|node| is_wall(&node.kind))
}

fn compare_oracle(
    what: &str,
    model: &Model,
    tree: &CheckedTree,
    points: &Points,
    answers: &Samples,
    tally: &Tally,
) {
    let jumps = has_walls(tree);
    for index in 0..points.len() {
        let point = points.get(index);
        if !is_ordinary(&point) {
            continue;
        }
        let point = point.map(f64::from);
        let oracle = walk(tree, point);
        let field = f64::from(answers.field()[index]);
        let close = |value: f64, expected: f64, bound: f64, name: &str| {
            assert!(
                (value - expected).abs() <= bound,
                "{what}: {name} is {value}, the oracle has {expected} (decision {:e}) at {point:?}\n{}",
                oracle.kink_distance,
                print(model)
            );
        };
        let gradient = answers.gradient().expect("asked for").map(|plane| f64::from(plane[index]));
        if jumps && oracle.kink_distance < 1e-5 {
            // On which side of a wall a point on it is, engines may see otherwise than the oracle.
            continue;
        }
        // Products of fields may be far above 1; rounding is relative to them.
        let size = oracle.field.abs().max(1.0);
        let steep = gradient.iter().fold(size, |steep: f64, g| steep.max(g.abs()));
        close(field, oracle.field, FIELD_BOUND * steep, "the field");
        tally.compared.fetch_add(1, Ordering::Relaxed);
        if oracle.kink_distance < 1e-4 * steep || field < 1e-3 {
            continue;
        }
        let differences = walk_gradient(tree, point, 1e-6);
        let coarse = walk_gradient(tree, point, 1e-5);
        let size = differences.iter().fold(1.0, |size: f64, g| size.max(g.abs()));
        if differences.iter().zip(coarse).all(|(fine, coarse)| (fine - coarse).abs() < 1e-4 * size) {
            tally.gradients.fetch_add(1, Ordering::Relaxed);
            for axis in 0..3 {
                close(gradient[axis], differences[axis], GRADIENT_BOUND * size, "the gradient");
            }
        }
        let groups = tree.attributes().iter().map(AttributeGroup::turns);
        for (((name, first, width), expected), turns) in
            answers.layout().attributes().zip(&oracle.attributes).zip(groups)
        {
            // The inverse of a derivative that nearly has none magnifies roundings by its square.
            let size = expected.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
            let bound = ATTRIBUTE_BOUND * steep * if turns { size * size } else { 1.0 };
            for (plane, &expected) in answers.planes()[first..first + width].iter().zip(expected) {
                close(f64::from(plane[index]), expected, bound, name);
            }
            tally.directions.fetch_add(u64::from(turns), Ordering::Relaxed);
        }
    }
}
