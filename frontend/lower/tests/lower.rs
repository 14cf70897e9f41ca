//! What lowering makes of small scenes: golden files with the scene, the program and the numbers.
//!
//! `golden/lower/NAME.jbt` lowers, for all answers, to `golden/lower/NAME.ir`. `BLESS=1` writes what is
//! found.

use std::fmt::Write as _;

use jbt_ir::{InstKind, Op};
use jbt_lower::{Lowered, lower};
use jbt_model::query::Query;
use jbt_testkit::golden::{compare, files};
use jbt_testkit::scene::tree;

fn shown(scene: &str, query: Query) -> String {
    let tree = tree(scene);
    let Lowered { function, tables } = lower(&tree, query).unwrap();
    tables.check(&function).unwrap();
    jbt_ir::verify(function.clone()).unwrap();
    let mut out = function.to_string();
    for (table, rows) in tables.tables.iter() {
        let _ = writeln!(out, "\n{table}: {} rows, starts {:?}", rows.len(), rows.starts);
        for row in 0..rows.len() {
            let _ = writeln!(out, "  {:?}", rows.row(row));
        }
    }
    out
}

#[test]
fn programs_are_as_expected() {
    let scenes = files("lower", "jbt");
    assert!(scenes.len() >= 5);
    for (path, scene) in scenes {
        compare(&path.with_extension("ir"), &shown(&scene, Query::ATTRIBUTES));
    }
}

/// How often an op stands in the program of all answers.
fn count_of(op: Op, scene: &str, query: Query) -> usize {
    let tree = tree(scene);
    let function = lower(&tree, query).unwrap().function;
    function
        .insts
        .values()
        .filter(|inst| matches!(inst.kind, InstKind::Op { op: found, .. } if found == op))
        .count()
}

#[test]
fn a_texture_is_evaluated_once_for_all_leaves_that_see_the_same() {
    let noise = |below: &str| format!("jbt 1 rough noise {{ a 0 b 1 octaves 2 }} {{ {below} }}");
    let scene = |below: &str| noise(below).replace("jbt 1", "jbt 1 attribute rough 1");
    let ball = "point { radius 1 }";
    let segment = "segment { from (0 0 0) to (1 0 0) radius 1 }";
    let count = |below: &str, query| count_of(Op::BitXor, &scene(below), query);
    let once = count(ball, Query::ATTRIBUTES);
    assert!(once > 0);
    let both = format!("sum {{ {ball} union {{ {segment} twist axis z rate 1 {{ {ball} }} }} }}");
    assert_eq!(count(&both, Query::ALL), once, "leaves of three shapes, one of them behind a warp");
    assert_eq!(count(&both, Query::GRADIENT), 0, "nobody asks for attributes");
    // Under other coordinates it is another one: a row of the same table.
    let moved = "jbt 1 attribute rough 1 let a = rough noise { a 0 b 1 octaves 2 } { point { radius 1 } }
        sum { use a translate (1 0 0) { use a } translate (0 1 0) { use a } rough noise { a 1 b 3 octaves 2 size 2 } { point { radius 2 } } }";
    assert_eq!(count_of(Op::BitXor, moved, Query::ATTRIBUTES), 2 * once, "the identity, and translations");
}

/// The same with formulas, whose values share what they have in common.
#[test]
fn a_formula_is_evaluated_once_for_all_leaves_that_see_the_same() {
    let scene =
        |below: &str| format!("jbt 1 color expression {{ t = sqrt(x), (t, 2 * t, y) }} {{ {below} }}");
    let (ball, solid) = ("point { radius 1 }", "box { half (1 1 1) radius 1 }");
    let count = |below: &str, query| count_of(Op::Sqrt, &scene(below), query);
    assert_eq!(count(ball, Query::ATTRIBUTES), 1);
    let both = format!("sum {{ {ball} union {{ {solid} twist axis z rate 1 {{ {ball} }} }} }}");
    assert_eq!(count(&both, Query::ALL), 1, "leaves of three shapes, one of them behind a warp");
    assert_eq!(count(&both, Query::GRADIENT), 0, "nobody asks for attributes");
    // Formulas that differ in numbers alone are rows of one table.
    let rows = "jbt 1 sum { color expression { (sqrt(x), 1, 2) } { point { radius 1 } } color expression { (sqrt(x), 3, 4) } { point { radius 2 } } }";
    assert_eq!(count_of(Op::Sqrt, rows, Query::ATTRIBUTES), 1);
}

/// Whatever is computed, the tables have the same rows for every query.
#[test]
fn computed_attributes_make_no_rows() {
    let scene = "jbt 1 attribute uv 2 attribute rough 1
        rough marble { a 0 b 1 } { uv scale 2 { select 0 {
            sum { point { radius 1 } twist axis z rate 1 { color checker { a (1 1 1) b (0 0 0) } { sum { ring { ring_radius 1 radius 1 } point { radius 1 } } } } }
            box { half (1 1 1) radius 1 } } } }";
    let tree = tree(scene);
    let rows = |query| {
        let Lowered { function, tables } = lower(&tree, query).unwrap();
        tables.check(&function).unwrap();
        jbt_ir::verify(function).unwrap();
        tables.tables.values().map(|rows| (rows.len(), rows.active.clone())).collect::<Vec<_>>()
    };
    for query in Query::EVERY {
        assert_eq!(rows(query), rows(Query::FIELD), "{}", query.name());
    }
}

/// A leaf that is used twice is computed once: without a guard, because a guard costs as much as a leaf,
/// unless its formulas take longer.
#[test]
fn a_shared_leaf_with_long_formulas_has_a_guard() {
    let tables = |steps: usize| {
        let terms = vec!["x"; steps + 1].join(" * ");
        let scene = format!(
            "jbt 1 let a = color expression {{ ({terms}, 0, 0) }} {{ point {{ radius 1 }} }}
            union {{ sum {{ use a segment {{ from (0 0 0) to (1 0 0) radius 2 }} }}
            sum {{ use a ring {{ ring_radius 1 radius 2 }} }} }}"
        );
        lower(&tree(&scene), Query::ATTRIBUTES).expect("it lowers").function.tables.len()
    };
    let plain = tables(0);
    for steps in [1, 3, 15] {
        assert_eq!(tables(steps), plain, "{steps} steps");
    }
    for steps in [16, 17, 31, 32, 40] {
        assert_eq!(tables(steps), plain + 1, "{steps} steps");
    }
}

/// Guards do not make a program deeper than it may be.
#[test]
fn a_long_chain_of_operators_has_some_guards() {
    let text = "union { point { radius 1 } sum { point { radius 2 }\n".repeat(500);
    let text = format!("jbt 1 {text} point {{ radius 3 }} {}", "} }".repeat(500));
    let tree = tree(&text);
    for query in Query::EVERY {
        let Lowered { function, tables } = lower(&tree, query).unwrap();
        assert_eq!(function.tables.len(), 1 + 1000 + 23, "the scene, points, guards");
        tables.check(&function).unwrap();
        jbt_ir::verify(function).unwrap();
    }
}

/// Shapes, and not counts or numbers, make code: what the golden files cannot say.
#[test]
fn alike_models_have_one_program() {
    let function = |scene: &str| {
        let tree = tree(scene);
        lower(&tree, Query::ALL).unwrap().function
    };
    let five =
        function("jbt 1 union { sum { point { radius 1 } point { radius 2 } } sum { point { radius 3 } } }");
    let other = function(
        "jbt 1 union { sum { point { radius 1 } } color (1 0 0) { sum { point { at (1 2 3) radius 2 } point { radius 1 } } }
         sum { translate (1 0 0) { point { radius 9 } } rotate axis x degrees 10 { scale 2 { point { radius 1 } } } } }",
    );
    assert_eq!(five, other, "sums of different numbers of points, moved by similarities");
    let strong = function(
        "jbt 1 union { sum { point { radius 1 strength 2 } } sum { point { radius 1 strength 3 } } }",
    );
    assert_ne!(five, strong, "a strength is work");
    let ricci =
        |n: &str| function(&format!("jbt 1 blend ricci {n} {{ point {{ radius 1 }} point {{ radius 2 }} }}"));
    assert_eq!(ricci("2.5"), ricci("3.7"), "an exponent is a number of the row");
    assert_ne!(ricci("2"), ricci("3"), "an integer exponent is code");
    assert_eq!(
        ricci("1"),
        function("jbt 1 sum { point { radius 1 } point { radius 2 } }"),
        "exponent 1 is the sum"
    );
}
