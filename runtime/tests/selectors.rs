//! Selectors: choosing another child writes numbers and compiles nothing, gives what the child alone gives,
//! and costs what it costs.

mod common;

use common::answers;
use jbt::build::{param, point};
use jbt::statistics::leaf_uses;
use jbt::{CheckedTree, Compiler, Engine, Evaluator, Model, Points, Query, Samples, Tree, Update};
use jbt_model::walk::walk;
use jbt_testkit::scene::{self, assert_reads_back};

/// Children of many kinds: leaves, blends, cuts, maps, warps, attributes of both ways to mix.
const CHILDREN: [&str; 7] = [
    "point { at (0.1 0 0) radius 1 }",
    "material 2 { color (1 0 0) { box { half (0.3 0.2 0.1) radius 0.8 strength -0.5 } } }",
    "blend ricci 2 { color (1 0 0) { use a } material 3 { color (0 0 1) { translate (0.5 0 0) { use a } } } }",
    "difference { color (0 1 0) { point { radius 1.2 } } translate (0.3 0 0) { use a } }",
    "twist axis z rate 1.5 { union { use a color (1 1 0) { box { half (0.4 0.1 0.5) radius 0.6 } } } }",
    "intersection { point { radius 1 } material 4 { use b } }",
    "sum { use b use b point { at (0 0.4 0) radius 0.7 } }",
];

const HEAD: &str = "jbt 1 attribute material 1 default 1 dominant
    let a = color (0.5 0.2 0.1) { segment { from (0 0 -0.4) to (0.2 0 0.4) radius 0.8 } }
    let b = twist axis y rate 0.7 { sum { use a material 5 { point { at (0 0 0.5) radius 0.9 } } } }";

fn tree(text: &str) -> CheckedTree {
    assert_reads_back(&scene::model(text));
    scene::tree(text)
}

fn points() -> Points {
    let mut rng = fastrand::Rng::with_seed(11);
    let mut at = || std::array::from_fn(|_| rng.f32() * 3.0 - 1.5);
    std::iter::once([0.0; 3]).chain((0..60).map(|_| at())).collect()
}

/// Both give the same to within rounding; the field to the bit, if it has to be `exact`.
fn compare(what: &str, exact: bool, found: &Samples, expected: &Samples) {
    let names = found.layout().names();
    for ((name, found), expected) in names.iter().zip(found.planes()).zip(expected.planes()) {
        for (index, (a, b)) in found.iter().zip(expected).enumerate() {
            let same =
                if exact && name == "field" { a.to_bits() == b.to_bits() } else { (a - b).abs() <= 4e-6 };
            assert!(same, "{what}: {name} of point {index} is {a}, not {b}");
        }
    }
}

/// Chooses every child of `selecting`, and compares with `alone`: the text without the selector.
fn try_all(
    what: &str,
    exact: bool,
    selecting: &CheckedTree,
    count: usize,
    alone: impl Fn(usize) -> CheckedTree,
) {
    let points = points();
    for query in Query::EVERY {
        for engine in Engine::ALL {
            let mut evaluator = Compiler::for_engine(engine).evaluator(selecting, query).unwrap();
            for which in (0..count).chain((0..count).rev()) {
                let set = selecting.with_parameters(&[("which", which as f64 + 0.4)]).unwrap();
                assert_eq!(evaluator.update(&set).unwrap(), Update::Numbers, "{what}, child {which}");
                let child = alone(which);
                let expected = Compiler::for_engine(engine).evaluator(&child, query).unwrap();
                let name = format!("{what}, child {which}, {}", query.name());
                compare(&name, exact, &answers(&evaluator, &points), &answers(&expected, &points));
                assert_eq!(evaluator.evaluations_per_point(), expected.evaluations_per_point(), "{name}");
                assert_eq!(leaf_uses(&set), leaf_uses(&child), "{name}");
                assert_eq!(set.support(), child.support(), "{name}");
                for index in 0..points.len() {
                    let p = points.get(index).map(f64::from);
                    assert_eq!(walk(&set, p), walk(&child, p), "{name}");
                }
            }
        }
    }
}

#[test]
fn every_child_is_as_if_it_were_alone() {
    let all = format!("{HEAD} param which = 0 select which {{ {} }}", CHILDREN.join("\n"));
    try_all("a selector", true, &tree(&all), CHILDREN.len(), |which| {
        tree(&format!("{HEAD} {}", CHILDREN[which]))
    });
}

#[test]
fn a_selector_under_other_nodes() {
    for around in [
        "blend ricci 3 { color (0.2 0.9 0.4) { point { at (0 0 0.3) radius 1 } } material 7 { X } use a }",
        "twist axis x rate 0.8 { sum { use b translate (0 0.3 0) { X } point { radius 0.5 } } }",
        "intersection { point { radius 1.1 } difference { X use a } }",
        "union { use a X rotate axis z degrees 40 { X } }",
    ] {
        // Without a selector between them, sums of sums are added in another order.
        let select = format!("select which {{ {} }}", CHILDREN.join("\n"));
        let text = |inner: &str| format!("{HEAD} param which = 0 {}", around.replace('X', inner));
        try_all(around, false, &tree(&text(&select)), CHILDREN.len(), |which| tree(&text(CHILDREN[which])));
    }
}

#[test]
fn selectors_in_selectors_and_in_shared_subtrees() {
    // Four choices by two numbers of one parameter; the inner selector is shared, the outer one too.
    let inner = "let inner = select which - 2 * max(0, min(1, which - 1)) { use a use b }";
    let outer = "let outer = sum { use inner select which { use a use inner use b point { radius 1 } } }";
    let text = format!(
        "{HEAD} param which = 0 {inner} {outer} union {{ use outer translate (0.3 0 0) {{ use outer }} use inner }}"
    );
    let inner = ["use a", "use b", "use a", "use b"];
    let outer = ["use a", "use inner", "use b", "point { radius 1 }"];
    let alone = |which: usize| {
        let lets = format!("let inner = {} let outer = sum {{ use inner {} }}", inner[which], outer[which]);
        // A name for what is under a name already.
        let lets = lets
            .replace("let inner = use a", "let inner = sum { use a }")
            .replace("let inner = use b", "let inner = sum { use b }");
        tree(&format!("{HEAD} {lets} union {{ use outer translate (0.3 0 0) {{ use outer }} use inner }}"))
    };
    let selecting = tree(&text);
    let points = points();
    for engine in Engine::ALL {
        let mut evaluator = Compiler::for_engine(engine).evaluator(&selecting, Query::ALL).unwrap();
        for which in [0, 3, 1, 2] {
            let set = selecting.with_parameters(&[("which", which as f64)]).unwrap();
            assert_eq!(evaluator.update(&set).unwrap(), Update::Numbers);
            let found = answers(&evaluator, &points);
            let child = alone(which);
            let expected = Compiler::for_engine(engine).evaluator(&child, Query::ALL).unwrap();
            assert_eq!(evaluator.evaluations_per_point(), expected.evaluations_per_point(), "{which}");
            for index in 0..points.len() {
                let p = points.get(index).map(f64::from);
                let (field, oracle) = (f64::from(found.field()[index]), walk(&set, p).field);
                assert!((field - oracle).abs() < 1e-5, "{which}: {field}, not {oracle}");
                assert!((oracle - walk(&child, p).field).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn what_only_other_children_share_costs_nothing() {
    // The chain is shared by two children, the leaf by a child and the rest.
    let text = "jbt 1 param which = 0
        let shared = twist axis z rate 1 { sum { point { radius 1 } point { at (1 0 0) radius 1 } } }
        let leaf = segment { from (0 0 0) to (1 0 0) radius 1 }
        union {
            select which {
                union { use shared color (1 0 0) { use shared } }
                intersection { use shared use leaf }
                point { radius 1 }
            }
            color (0 1 0) { use leaf }
        }";
    let selecting = tree(text);
    let mut evaluator = Evaluator::compile(&selecting, Query::ALL).unwrap();
    for (which, evaluations) in [(0.0, 3), (1.0, 3), (2.0, 2)] {
        let set = selecting.with_parameters(&[("which", which)]).unwrap();
        assert_eq!(evaluator.update(&set).unwrap(), Update::Numbers);
        assert_eq!(evaluator.evaluations_per_point(), evaluations, "{which}");
        let by_node = evaluator.evaluations_by_node().per_node;
        assert!(by_node.values().all(|&count| count == 1), "{by_node:?}");
    }
}

#[test]
fn many_selectors_of_one_shape_are_rows_of_one_table() {
    let selector = |shift: f64, which: f64| {
        let ball = |size: f64| point([shift, 0.0, 0.0], size);
        let cut = ball(0.9) - ball(0.4).translate([0.2, 0.0, 0.0]);
        Tree::select(which + param("step", 0.0), [ball(0.5), cut])
    };
    let root = Tree::union((0..6).map(|i| selector(f64::from(i) * 0.3, f64::from(i % 2) * 0.4)));
    let start = Model::new(root).check().unwrap();
    let mut evaluator = Evaluator::compile(&start, Query::ALL).unwrap();
    assert_eq!(evaluator.evaluations_per_point(), 6);
    // Near a half, every other one changes over.
    let set = start.with_parameters(&[("step", 0.3)]).unwrap();
    assert_eq!(evaluator.update(&set).unwrap(), Update::Numbers);
    assert_eq!(evaluator.evaluations_per_point(), 9);
    let found = answers(&evaluator, &points());
    for (index, &field) in found.field().iter().enumerate() {
        let expected = walk(&set, points().get(index).map(f64::from)).field;
        assert!((f64::from(field) - expected).abs() < 1e-5);
    }
}

#[test]
fn a_choice_of_no_child_is_an_error_where_it_stands() {
    let text = "jbt 1 param which = 1 sum { select which { point { radius 1 } point { radius 2 } } }";
    let tree = tree(text);
    for bad in [-0.5, -3.0, 1.5, 2.0, 1e15] {
        let errors = tree.with_parameters(&[("which", bad)]).unwrap_err();
        assert_eq!(errors[0].message, format!("the selector chooses child {bad} of 2"));
        let span = errors[0].span.unwrap();
        assert_eq!(&text[span.start as usize..span.end as usize], "select which");
    }
    for (good, radius) in [(-0.49, 1.0), (0.49, 1.0), (0.5, 2.0), (1.49, 2.0)] {
        assert_eq!(tree.with_parameters(&[("which", good)]).unwrap().support().high(), [radius; 3]);
    }
    let literal = scene::model("select 3 { point { radius 1 } }");
    assert_eq!(literal.check().unwrap_err()[0].message, "the selector chooses child 3 of 1");
    let empty = scene::model("select 0 { }");
    assert_eq!(empty.check().unwrap_err()[0].message, "a node `select` has 0 children");
}
