//! Who owns a point: paths through the tree.

use jbt_model::owner::owner;
use jbt_testkit::scene::tree;

fn path(text: &str, p: [f64; 3]) -> Option<String> {
    let tree = tree(text);
    owner(&tree, p).map(|owner| owner.path(&tree))
}

#[test]
fn paths_name_kinds_and_children() {
    let text = "jbt 1 union {
        point { at (5 0 0) radius 1 }
        point { at (-5 0 0) radius 1 }
        color (1 0 0) { translate (0 1 0) { segment { from (0 0 0) to (1 0 0) radius 1 } } }
    }";
    assert_eq!(path(text, [0.0, 1.0, 0.0]).as_deref(), Some("union.2/color.0/affine.0/segment"));
    assert_eq!(path(text, [5.0, 0.0, 0.0]).as_deref(), Some("union.0/point"));
    assert_eq!(path(text, [0.0, 9.0, 0.0]), None);
    assert_eq!(path("jbt 1 point { radius 1 }", [0.0; 3]).as_deref(), Some("point"));
}

#[test]
fn a_selector_asks_the_chosen_child() {
    let text = "jbt 1 select 1 { point { radius 1 } sum { point { radius 1 } point { radius 2 } } }";
    assert_eq!(path(text, [0.1, 0.0, 0.0]).as_deref(), Some("select.1/sum.1/point"));
}

#[test]
fn ties_go_to_the_first_in_the_file() {
    for operator in ["union", "intersection", "sum", "blend ricci 2"] {
        let text = format!("jbt 1 {operator} {{ point {{ radius 1 }} point {{ radius 1 }} }}");
        let found = path(&text, [0.1, 0.0, 0.0]).unwrap();
        assert!(found.ends_with(".0/point"), "{found}");
    }
}

#[test]
fn a_difference_is_owned_by_who_decides() {
    let text = "jbt 1 difference { point { radius 2 } point { at (1 0 0) radius 1 } }";
    assert_eq!(path(text, [-0.5, 0.0, 0.0]).as_deref(), Some("difference.0/point"));
    // The cut: field 2 iso - b, less than that of the ball.
    assert_eq!(path(text, [0.4, 0.0, 0.0]).as_deref(), Some("difference.1/point"));
    assert_eq!(path(text, [1.0, 0.0, 0.0]), None, "cut away to a field of 0");
}

#[test]
fn a_blend_is_owned_by_the_largest_leaf_and_not_by_the_largest_branch() {
    let text = "jbt 1 sum {
        sum { point { at (0.6 0 0) radius 1 } point { at (-0.6 0 0) radius 1 } }
        point { at (0 0.5 0) radius 1 }
    }";
    assert_eq!(path(text, [0.0; 3]).as_deref(), Some("sum.1/point"));
    let tree = tree(text);
    let found = owner(&tree, [0.0; 3]).unwrap();
    assert!(found.share > 0.33 && found.share < 0.5, "{}", found.share);
}

#[test]
fn what_has_no_weight_owns_nothing() {
    let text = "jbt 1 sum { point { radius 1 strength -1 } point { at (0.5 0 0) radius 1 strength -1 } }";
    assert_eq!(path(text, [0.0; 3]), None);
    let text = "jbt 1 sum { point { radius 1 strength -0.25 } point { at (0.5 0 0) radius 1 } }";
    assert_eq!(path(text, [0.0; 3]).as_deref(), Some("sum.1/point"));
}
