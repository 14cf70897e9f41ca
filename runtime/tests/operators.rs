//! What is often wrong with operators in systems of this kind, on every engine: lanes that share what the
//! first of them decides, and models that end nowhere.

mod common;

use common::answers;
use jbt::build::point;
use jbt::{Compiler, Engine, Model, Points, Polygonize, PolygonizeError, Query, SetOperation, Tree};
use jbt_testkit::scene::tree;

/// Eight balls in a row, each red and blue in parts of its own.
fn balls(operator: impl Fn([Tree; 2]) -> Tree) -> Tree {
    let pair = |i: i32| {
        let at = [3.0 * f64::from(i), 0.0, 0.0];
        let (red, blue) = (point(at, 1.0).color([1.0, 0.0, 0.0]), point(at, 1.0).color([0.0, 0.0, 1.0]));
        let (near, far) = (red.strength(1.2), blue.strength(0.9));
        // Who wins alternates.
        operator(if i % 2 == 0 { [near, far] } else { [far.strength(1.2), near.strength(0.9)] })
    };
    Tree::union((0..8).map(pair))
}

#[test]
fn lanes_do_not_share_the_colour_of_the_first() {
    let operators: [fn([Tree; 2]) -> Tree; 5] = [
        |[a, b]| a | b,
        |[a, b]| a & b,
        |[a, b]| a ^ b,
        |[a, b]| a.smooth_union(0.1, &b),
        |[a, b]| Tree::smooth(SetOperation::Intersection, 0.1, [a, b]),
    ];
    for (index, operator) in operators.into_iter().enumerate() {
        let tree = Model::new(balls(operator)).check().unwrap();
        let points: Points = (0..8).map(|i| [3.0 * i as f32, 0.1, 0.0]).collect();
        for engine in Engine::ALL {
            let evaluator = Compiler::for_engine(engine).evaluator(&tree, Query::ALL).unwrap();
            let samples = answers(&evaluator, &points);
            let red = &samples.attribute("color").unwrap()[0];
            for (i, red) in red.iter().enumerate() {
                let expected = jbt::walk::walk(&tree, points.get(i).map(f64::from)).attributes[0][0];
                assert!(
                    (f64::from(*red) - expected).abs() < 1e-4,
                    "{index} {} lane {i}: {red}",
                    engine.name()
                );
            }
            assert!(red.windows(2).all(|pair| pair[0] != pair[1]), "neighbours differ: {red:?}");
        }
    }
}

#[test]
fn an_unbounded_model_asks_for_a_region() {
    let hole = Model::new(!point([0.0; 3], 1.0)).check().unwrap();
    assert!(matches!(Polygonize::default().region(&hole), Err(PolygonizeError::Unbounded)));
    let cut = Model::new(point([0.5, 0.0, 0.0], 1.0) & !point([0.0; 3], 1.0)).check().unwrap();
    assert!(Polygonize::default().region(&cut).is_ok());
}

/// Both children of the formula are one leaf, of two colours: the field is theirs together, the slopes are
/// not.
#[test]
fn children_of_a_formula_that_share_a_field_have_weights_of_their_own() {
    let ball = point([0.0; 3], 1.0);
    let (red, blue) = (ball.color([1.0, 0.0, 0.0]), ball.color([0.0, 0.0, 1.0]));
    let tree = Model::new(Tree::expression(2.0 * red.field() - 0.5 * blue.field())).check().unwrap();
    for engine in Engine::ALL {
        let evaluator = Compiler::for_engine(engine).evaluator(&tree, Query::ALL).unwrap();
        let samples = answers(&evaluator, &[[0.3, 0.2, 0.1]]);
        let color = samples.attribute("color").unwrap();
        assert_eq!([color[0][0], color[1][0], color[2][0]], [1.0, 0.0, 0.0], "{}", engine.name());
    }
}

/// Formulas that leave every bound, are no numbers, or are -0, as operands: where the field alone is asked,
/// they are kept within bounds after one is chosen, else before.
#[test]
fn operands_that_leave_all_bounds_give_the_same_field_to_every_query() {
    let formulas =
        ["1 / x", "sqrt(y)", "0 - 0 * y", "exp(x * 100)", "-exp(y * 100)", "x * y - 1", "sqrt(y)^2"];
    let operands = |some: &[&str]| {
        let formula = |formula: &&str| format!("color (1 0 0) {{ expression {{ {formula} }} }}\n");
        some.iter().map(formula).collect::<String>()
    };
    let ball = "point { radius 2 strength -3 }";
    for operator in ["union", "intersection"] {
        let other = if operator == "union" { "intersection" } else { "union" };
        let all = operands(&formulas);
        let scenes = [
            format!("{operator} {{ {all} }}"),
            format!("{operator} {{ {} }}", operands(&formulas[1..2])),
            format!("{operator} {{ {} }}", operands(&formulas[6..])),
            format!("{operator} {{ {all} {other} {{ {} }} }}", operands(&formulas[2..5])),
            format!("{operator} {{ {all} {ball} }}"),
        ];
        for scene in scenes {
            let tree = tree(&scene);
            let special = [0.0, -0.0, 1.0, -1.0, 0.3, -7.0, 1e30, -1e30, f32::INFINITY, f32::NAN];
            let points: Points =
                special.iter().flat_map(|&x| special.iter().map(move |&y| [x, y, 0.5])).collect();
            let field = |engine, query| {
                let evaluator = Compiler::for_engine(engine).evaluator(&tree, query).unwrap();
                let samples = answers(&evaluator, &points);
                samples.field().iter().map(|field| field.to_bits()).collect::<Vec<u32>>()
            };
            let expected = field(Engine::Scalar, Query::ALL);
            for engine in Engine::ALL {
                for query in [Query::FIELD, Query::GRADIENT, Query::ATTRIBUTES, Query::ALL] {
                    assert_eq!(field(engine, query), expected, "{query:?} by {}: {scene}", engine.name());
                }
            }
        }
    }
}
