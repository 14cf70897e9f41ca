//! Warps that are given by formulas, in models: gradients, boxes, parameters, weights, text.

use glam::DVec3;
use jbt_ir::{Tables, Verified};
use jbt_lower::{Lowered, lower};
use jbt_model::builder::{point, segment};
use jbt_model::check::CheckedTree;
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_model::tree::Tree;
use jbt_model::walk::{walk, walk_gradient};
use jbt_testkit::random::Random;
use jbt_testkit::scene::{self, assert_reads_back, model as read};
use jbt_text::{Options, parse};

/// The program of the field and its gradient.
fn compiled(tree: &CheckedTree) -> (Verified, Tables) {
    scene::compiled(tree, Query::GRADIENT)
}

fn run(program: &(Verified, Tables), p: DVec3) -> (f64, DVec3) {
    let answers = scene::run(program, p.into());
    (answers[0], DVec3::from_slice(&answers[1..]))
}

/// Compares the program with differences of the oracle at some points; how many.
fn compare(tree: &CheckedTree, random: &mut Random) -> usize {
    let program = compiled(tree);
    let mut compared = 0;
    for _ in 0..40 {
        let p = DVec3::from(random.vector(1.4)).as_vec3().as_dvec3();
        let sample = walk(tree, p.into());
        let expected = DVec3::from(walk_gradient(tree, p.into(), 1e-6));
        let coarse = DVec3::from(walk_gradient(tree, p.into(), 4e-6));
        let size = 1.0 + expected.length();
        if sample.kink_distance < 2e-3 || size > 100.0 || expected.distance(coarse) > 1e-5 * size {
            continue;
        }
        let (field, found) = run(&program, p);
        assert!((field - sample.field).abs() < 2e-5 * size, "{field} at {p}, not {}", sample.field);
        assert!(found.distance(expected) < 1e-3 * size, "{found} at {p}, differences {expected}");
        compared += usize::from(sample.field != 0.0);
    }
    compared
}

#[test]
fn gradients_are_differences_of_the_oracle() {
    let mut random = Random::new(1, 1);
    let mut compared = 0;
    for index in 0..300 {
        let [a, b, c, d] = [(); 4].map(|()| random.vector(0.8));
        let blob = point(a, 1.2) + segment(b, c, 0.9);
        let mut children = vec![blob];
        if index % 3 == 0 {
            children.push(point(d, 1.5));
        }
        let warped = Tree::new(random.formula_warp(), children).rotate(random.vector(1.0), 50.0);
        let warped = if index % 4 == 0 { warped.within([-0.9; 3], [0.8; 3]) } else { warped };
        compared += compare(&Model::new(warped).check().expect("a good model"), &mut random);
    }
    assert!(compared > 3000, "{compared} points");
}

const TWISTED: &str = "jbt 1 param rate = 0.5
    warp (t = rate * z, x * cos(t) + y * sin(t), y * cos(t) - x * sin(t), z) within (-2 -2 -2) to (2 2 2) {
        segment { from (-1 0 1) to (1 0 1) radius 0.5 }
    }";

#[test]
fn numbers_follow_parameters() {
    let (warped, member) = (
        read(TWISTED).check().unwrap(),
        read("jbt 1 param rate = 0.5 twist rate rate { segment { from (-1 0 1) to (1 0 1) radius 0.5 } }"),
    );
    let member = member.check().unwrap();
    let program = compiled(&warped);
    for rate in [0.5, -1.5, 0.0] {
        let values = [("rate", rate)];
        let (warped, member) =
            (warped.with_parameters(&values).unwrap(), member.with_parameters(&values).unwrap());
        let Lowered { function: _, tables } = lower(&warped, Query::GRADIENT).unwrap();
        let program = (program.0.clone(), tables);
        for index in 0..40 {
            let p = DVec3::new(0.04 * f64::from(index), 0.3, 0.9).as_vec3().as_dvec3();
            let expected = walk(&member, p.into()).field;
            assert!((walk(&warped, p.into()).field - expected).abs() < 1e-12);
            assert!((run(&program, p).0 - expected).abs() < 1e-5, "{rate} at {p}");
        }
    }
}

#[test]
fn a_box_bounds_what_formulas_do_not() {
    let tree = read(TWISTED).check().unwrap();
    assert_eq!((tree.support().low(), tree.support().high()), ([-2.0; 3], [2.0; 3]));
    let free = read("jbt 1 warp (x, y, sin(z)) { point { radius 1 } }").check().unwrap();
    assert!(!free.support().is_finite());
    let program = compiled(
        &read("jbt 1 warp (x, y, sin(z)) within (-2 -2 -2) to (2 2 2) { point { radius 1 } }")
            .check()
            .unwrap(),
    );
    assert!(run(&program, DVec3::new(0.0, 0.0, 2.0)).0 > 0.0);
    let (field, gradient) = run(&program, DVec3::new(0.0, 0.0, 2.001));
    assert_eq!((field.to_bits(), gradient), (0, DVec3::ZERO));
}

#[test]
fn text_and_what_is_wrong_with_it() {
    for text in [
        TWISTED,
        "jbt 1 warp (a = x + 1, b = a * a, b, b - a, 2) weighted { point { radius 1 } point { radius 2 } }",
        "jbt 1 let b = point { radius 1 } union { warp (z, x, y) { use b } warp (y, z, x) within (0 0 0) to (1 1 1) { use b } }",
    ] {
        let model = read(text);
        assert_reads_back(&model);
        model.check().unwrap();
    }
    for (text, message) in [
        ("warp (x / 0, y, z) { point { radius 1 } }", "division by zero"),
        ("warp (1e300 * x, y, z) { point { radius 1 } }", "a number of the warp is"),
        ("warp (x, y, z) weighted { point { radius 1 } }", "a weighted warp has 1 nodes in its block"),
        (
            "warp (x, y, z) within (1 0 0) to (0 1 1) { point { radius 1 } }",
            "the box of the expression goes from",
        ),
    ] {
        let text = format!("jbt 1 {text}");
        let errors = match parse(text.as_bytes(), &Options::default()) {
            Ok(model) => model.check().unwrap_err(),
            Err(errors) => errors,
        };
        assert!(errors[0].message.starts_with(message), "{:?}", errors[0]);
        assert!(errors[0].span.is_some());
    }
    let field = point([0.0; 3], 1.0).field();
    let errors =
        Model::new(point([0.0; 3], 1.0).warp([field.clone(), field.clone(), field])).check().unwrap_err();
    assert_eq!(errors[0].message, "the warp asks for fields");
}
