//! Coverage: programs answer what the oracle says, and a point without a value is told from one with the
//! default.

use jbt_model::check::CheckedTree;
use jbt_model::query::Query;
use jbt_model::walk::walk;
use jbt_testkit::scene::{compiled, run, tree};

/// The coverage of the last group at a point, by the program and by the oracle.
fn covered(tree: &CheckedTree, p: [f64; 3]) -> f64 {
    let told = run(&compiled(tree, Query::ATTRIBUTES), p);
    let found = *told.last().unwrap();
    let expected = walk(tree, p).attributes.last().unwrap()[0];
    assert!((found - expected).abs() < 1e-5, "{found} at {p:?}, expected {expected}");
    found
}

#[test]
fn what_nobody_gives_is_not_defined() {
    let text = "attribute rough 1 default 0.5
        union {
            rough 0.5 { sum { point { radius 1 } translate (3 0 0) { point { radius 1 } } } }
            sum { rough 0.9 { point { at (0 5 0) radius 2 } } point { at (1 5 0) radius 2 } }
            point { at (0 -5 0) radius 1 }
            particles { at ((0 0 5)) radius 1 rough 0.25 }
            particles { at ((0 0 -5)) radius 1 color (1 0 0) }
            constant rough 1 { point { at (9 0 0) radius 1 } }
        }";
    let of = tree(text).with_coverage("rough").unwrap();
    for (p, expected) in [
        ([0.1, 0.0, 0.0], 1.0),
        ([3.1, 0.0, 0.0], 1.0),
        ([0.0, -5.1, 0.0], 0.0),
        ([0.0, 0.0, 5.1], 1.0),
        ([0.0, 0.0, -5.1], 0.0),
        ([9.1, 0.0, 0.0], 0.0),
        ([50.0, 0.0, 0.0], 0.0),
        // In the middle of two leaves, one of which has a value.
        ([0.5, 5.0, 0.0], 0.5),
    ] {
        assert!((covered(&of, p) - expected).abs() < 1e-6, "{p:?}");
    }
    // The other answers keep their bits.
    let plain = tree(text);
    for x in 0..40 {
        let p = [f64::from(x) * 0.1, 0.2, 0.1];
        let [mut with, without] = [&of, &plain].map(|tree| run(&compiled(tree, Query::ALL), p));
        with.pop();
        assert_eq!(with, without, "{p:?}");
    }
}

#[test]
fn it_goes_with_owners_and_parameters() {
    let both = tree(
        "param r = 1 color (r 0 0) { union { point { radius r } color (1 1 r) { point { at (3 0 0) radius r } } } }",
    );
    let both = both
        .with_owners()
        .unwrap()
        .with_coverage("color")
        .unwrap()
        .of_attributes(&["color.defined"])
        .unwrap();
    assert_eq!(covered(&both, [3.1, 0.0, 0.0]), 1.0);
    let message = |tree: &CheckedTree, name: &str| tree.with_coverage(name).unwrap_err().to_string();
    assert!(message(&tree("point { radius 1 }"), "rough").contains("no attribute is named `rough`"));
    let once = tree("point { radius 1 }").with_coverage("color").unwrap();
    assert!(message(&once, "color").contains("`color.defined` is an answer already"));
}
