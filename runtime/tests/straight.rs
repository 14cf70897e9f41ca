//! Straight code gives the bits of rows, for every query, engine and level; regions, counters and edits do
//! not notice it, but for what an edit compiles.

mod common;

use common::answers;
use jbt::boxes::Divisible;
use jbt::internals::ir::Level;
use jbt::{Box3, Compiler, Engine, Evaluator, Points, Pruner, Query, Update};
use jbt_model::check::CheckedTree;
use jbt_testkit::scene::tree;

/// A wave at a height; waves share everything but this and their `phase`.
fn wave(height: f64, phase: f64) -> String {
    format!("expression {{ sin(3 * x + {phase}) * cos(5 * y) * exp(-(z - {height})^2) * 0.75 }}")
}

/// Waves under what a machine might write, so that derivatives of rows come together in many ways.
fn nested() -> String {
    let falloff = |c: f64| format!("falloff wyvill radius 2 {{ {} }}", wave(c, 0.5));
    format!(
        "jbt 1 blend ricci 3 {{
            sum {{ {a} {b} {c} }}
            taper from -1 to 1 start 0.7 end 0.9 {{ union {{ {a} {b} intersection {{ {b} {c} }} }} }}
            expression {{ 0.3 * sin(2 * x) * y + 0.1 / (x * x + y) }}
            expression {{ 0.3 * sin(2 * x) * z + 0.1 / (x * x + y) }}
        }}",
        a = falloff(0.1),
        b = falloff(0.3),
        c = falloff(0.4),
    )
}

/// Waves under a union, coloured, beside points, a warp and a difference: what is straight code, and what is
/// not.
fn scene(heights: &[f64], phase: f64) -> String {
    let waves: Vec<String> = heights
        .iter()
        .enumerate()
        .map(|(i, &height)| format!("color (0.1 0.{i} 0.5) {{ {} }}", wave(height, phase)))
        .collect();
    format!(
        "jbt 1 union {{
            {}
            difference {{ union {{ {} {} }} sum {{ point {{ at (0.3 0 0) radius 0.6 }} point {{ at (0 0.4 0) radius 0.5 }} }} }}
            color (1 0 0) {{ sum {{ point {{ at (0 0 1) radius 0.7 }} point {{ at (0 0.2 -1) radius 0.8 }} point {{ radius 0.4 }} }} }}
            twist axis z rate 0.5 {{ segment {{ from (0 0 0) to (0 1 0) radius 0.5 }} }}
        }}",
        waves.join("\n"),
        wave(0.25, 0.5),
        wave(0.75, 0.5),
    )
}

fn points() -> Points {
    let mut rng = fastrand::Rng::with_seed(11);
    (0..300).map(|_| std::array::from_fn(|_| 3.0 * rng.f32() - 1.5)).collect()
}

fn bits(evaluator: &Evaluator, points: &Points) -> Vec<u32> {
    let samples = answers(evaluator, points);
    samples.planes().iter().flatten().map(|x| x.to_bits()).collect()
}

/// Whether an evaluator has fewer tables than one that keeps rows.
fn is_straight(compiler: &Compiler, tree: &CheckedTree) -> bool {
    let tables = |compiler: &Compiler| compiler.evaluator(tree, Query::FIELD).unwrap().tables().tables.len();
    tables(compiler) < tables(&compiler.clone().for_edits())
}

#[test]
fn straight_code_has_the_bits_of_rows() {
    for text in [scene(&[0.1, 0.2, 0.3, 0.6], 0.5), nested()] {
        compare(&tree(&text));
    }
}

fn compare(tree: &CheckedTree) {
    let mut points = points();
    // Where derivatives overflow.
    for point in [[0.0f32; 3], [1e30, 1.0, -1e30], [1e-30, 1e-30, 0.0]] {
        points.push(point);
    }
    assert!(is_straight(&Compiler::new(), tree));
    for query in Query::EVERY {
        let known = Compiler::for_engine(Engine::Scalar).for_edits().evaluator(tree, query).unwrap();
        let known = bits(&known, &points);
        let levels = Level::available().into_iter().map(|level| Compiler::new().at_level(level));
        let engines = Engine::ALL.map(Compiler::for_engine);
        for compiler in engines.into_iter().chain(levels) {
            let evaluator = compiler.evaluator(tree, query).unwrap();
            assert_eq!(bits(&evaluator, &points), known, "{query:?} {compiler:?}");
        }
    }
}

#[test]
fn regions_and_counters_are_those_of_rows() {
    let (tree, points) = (tree(&scene(&[0.1, 0.2, 0.3, 0.6], 0.5)), points());
    let compiler = Compiler::new();
    let pruner = Pruner::new(&compiler, &tree).unwrap();
    let region = pruner.region(Box3::new([0.8, 0.8, 0.9], [1.4; 3])).unwrap();
    let [straight, rows] =
        [compiler.clone(), compiler.clone().for_edits()].map(|c| c.evaluator(&tree, Query::ALL).unwrap());
    assert_eq!(straight.evaluations_per_point(), rows.evaluations_per_point());
    assert_eq!(straight.evaluations_in(&region), rows.evaluations_in(&region));
    assert_eq!(straight.ops_in(&region), rows.ops_in(&region));
    assert_eq!(straight.evaluations_by_node(), rows.evaluations_by_node());
    let inside: Points = points.iter().map(|p| p.map(|x| 1.1 + 0.1 * x)).collect();
    let answers = |evaluator: &Evaluator| {
        let mut planes = vec![vec![0.0; inside.len()]; evaluator.layout().names().len()];
        let mut views: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
        evaluator.eval_region(&region, inside.planes(), &mut views).unwrap();
        planes
    };
    assert_eq!(answers(&straight), answers(&rows));
    bits(&straight, &points);
    bits(&rows, &points);
    assert_eq!(straight.counters(), rows.counters());
}

#[test]
fn edits_compile_what_straight_code_does_not_fit_and_rows_compile_nothing() {
    let points = points();
    let edits = [
        (scene(&[0.1, 0.2, 0.3, 0.6], 0.75), "a number that some share moved", Update::Code),
        (scene(&[0.1, 0.2, 0.3, 0.6], 0.8), "it has a column of its own now", Update::Numbers),
        (scene(&[0.1, 0.2, 0.3, 0.7], 0.8), "a number of one wave", Update::Numbers),
        (scene(&[0.1, 0.2, 0.3, 0.7, 0.9], 0.8), "a wave more", Update::Code),
    ];
    let first = tree(&scene(&[0.1, 0.2, 0.3, 0.6], 0.5));
    let mut straight = Evaluator::compile(&first, Query::ALL).unwrap();
    let mut rows = Compiler::new().for_edits().evaluator(&first, Query::ALL).unwrap();
    for (text, what, expected) in edits {
        let edited = tree(&text);
        assert_eq!(straight.update(&edited).unwrap(), expected, "{what}");
        assert_eq!(rows.update(&edited).unwrap(), Update::Numbers, "{what}");
        assert_eq!(bits(&straight, &points), bits(&rows, &points), "{what}");
    }
}

#[test]
fn models_of_primitives_models_with_parameters_and_choices_keep_their_rows() {
    let compiler = Compiler::new();
    let primitives = "jbt 1 sum { point { at (0 0 1) radius 1 } point { at (0 0 2) radius 1 } }";
    assert!(!is_straight(&compiler, &tree(primitives)));
    let waves = scene(&[0.1, 0.2, 0.3, 0.6], 0.5);
    let parameter = waves.replacen("jbt 1", "jbt 1 param p = 0.5", 1).replacen("radius 0.7", "radius p", 1);
    assert!(!is_straight(&compiler, &tree(&parameter)));
    // The waves become straight code; the children of the selector stay rows.
    let chosen = |which: u32| {
        let choice =
            format!("select {which} {{ {} {} point {{ radius 1 }} }}", wave(0.1, 0.2), wave(0.3, 0.4));
        tree(&waves.replacen("union {", &format!("union {{ {choice}"), 1))
    };
    let mut evaluator = compiler.evaluator(&chosen(0), Query::ALL).unwrap();
    assert!(is_straight(&compiler, &chosen(0)));
    for which in 0..3 {
        assert_eq!(evaluator.update(&chosen(which)).unwrap(), Update::Numbers);
        let known = compiler.clone().for_edits().evaluator(&chosen(which), Query::ALL).unwrap();
        assert_eq!(bits(&evaluator, &points()), bits(&known, &points()));
    }
}
