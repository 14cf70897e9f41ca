//! Who owns a point: paths through the tree.

use jbt_model::model::Model;
use jbt_model::owner::{LeafWays, owner};
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
    assert_eq!(path(text, [0.0, 1.0, 0.0]).as_deref(), Some("0.union/2.color/0.affine/0.segment"));
    assert_eq!(path(text, [5.0, 0.0, 0.0]).as_deref(), Some("0.union/0.point"));
    assert_eq!(path(text, [0.0, 9.0, 0.0]), None);
    assert_eq!(path("jbt 1 point { radius 1 }", [0.0; 3]).as_deref(), Some("0.point"));
}

#[test]
fn a_selector_asks_the_chosen_child() {
    let text = "jbt 1 select 1 { point { radius 1 } sum { point { radius 1 } point { radius 2 } } }";
    assert_eq!(path(text, [0.1, 0.0, 0.0]).as_deref(), Some("0.select/1.sum/1.point"));
}

#[test]
fn ties_go_to_the_first_in_the_file() {
    for operator in ["union", "intersection", "sum", "blend ricci 2"] {
        let text = format!("jbt 1 {operator} {{ point {{ radius 1 }} point {{ radius 1 }} }}");
        let found = path(&text, [0.1, 0.0, 0.0]).unwrap();
        assert!(found.ends_with("/0.point"), "{found}");
    }
}

#[test]
fn a_difference_is_owned_by_who_decides() {
    let text = "jbt 1 difference { point { radius 2 } point { at (1 0 0) radius 1 } }";
    assert_eq!(path(text, [-0.5, 0.0, 0.0]).as_deref(), Some("0.difference/0.point"));
    // The cut: field 2 iso - b, less than that of the ball.
    assert_eq!(path(text, [0.4, 0.0, 0.0]).as_deref(), Some("0.difference/1.point"));
    assert_eq!(path(text, [1.0, 0.0, 0.0]), None, "cut away to a field of 0");
}

#[test]
fn a_blend_is_owned_by_the_largest_leaf_and_not_by_the_largest_branch() {
    let text = "jbt 1 sum {
        sum { point { at (0.6 0 0) radius 1 } point { at (-0.6 0 0) radius 1 } }
        point { at (0 0.5 0) radius 1 }
    }";
    assert_eq!(path(text, [0.0; 3]).as_deref(), Some("0.sum/1.point"));
    let tree = tree(text);
    let found = owner(&tree, [0.0; 3]).unwrap();
    assert!(found.share > 0.33 && found.share < 0.5, "{}", found.share);
}

#[test]
fn what_has_no_weight_owns_nothing() {
    let text = "jbt 1 sum { point { radius 1 strength -1 } point { at (0.5 0 0) radius 1 strength -1 } }";
    assert_eq!(path(text, [0.0; 3]), None);
    let text = "jbt 1 sum { point { radius 1 strength -0.25 } point { at (0.5 0 0) radius 1 } }";
    assert_eq!(path(text, [0.0; 3]).as_deref(), Some("0.sum/1.point"));
}

/// A path that is told of an owner selects the place of the leaf, and nothing else.
#[test]
fn paths_of_owners_select_their_places() {
    let scenes = [
        "let hand = union { point { radius 1 } finger: translate (1 0 0) { point { radius 0.5 } } }
         robot: sum {
             body: union {
                 point { radius 2 }
                 arm: translate (3 0 0) { use hand }
                 arm: color (1 0 0) { translate (-3 0 0) { use hand } }
                 union { leg: segment { from (0 0 -2) to (0 0 -5) radius 1 } leg: point { at (0 2 0) radius 1 } }
             }
             left: use hand
         }",
        "let a = union { point { radius 1 } point { at (1 0 0) radius 1 } }
         union { use a translate (3 0 0) { use a } rough 1 { point { at (0 3 0) radius 1 } } }",
        // The same names in each other, and beside that.
        "let b = point { radius 1 }
         union {
             a: union { b: use b a: translate (2 0 0) { union { use b b: point { at (0 1 0) radius 1 } } } }
             translate (0 3 0) { a: union { use b use b } }
             translate (0 -3 0) { select 1 { a: use b a: use b } }
         }",
        "part \"hub\" { point { radius 2 } particles { at ((2 0 0) (0 2 0) (0 0 2)) radius 1 } }
         part \"rim\" { translate (3 0 0) { spoke: point { radius 1 } point { at (0 1 0) radius 1 } } }",
        "sum { point { radius 2 } rough 0.5 { point { at (2 0 0) radius 1 } } }",
        "point { radius 3 }",
        "only: color (1 0 0) { point { radius 3 } }",
    ];
    for scene in scenes {
        let scene = scene.replace("translate (3 0 0) { spoke", "union { spoke");
        let model = jbt_text::model(&format!("jbt 1 attribute rough 1 {scene}")).unwrap();
        let plain = model.check().unwrap();
        let trees = [
            plain.clone(),
            plain.with_owners().unwrap().with_coverage("color").unwrap().with_coverage("rough").unwrap(),
        ];
        let mut told = std::collections::HashSet::new();
        for tree in &trees {
            let ways = LeafWays::new(tree);
            for step in 0..1000 {
                let t = f64::from(step);
                let p = [(t * 0.37).sin() * 5.0, (t * 0.71).cos() * 4.0, (t * 1.13).sin() * 3.0 - 1.0];
                let Some(found) = owner(tree, p) else { continue };
                let path = found.path(tree);
                let places = tree.find(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
                assert_eq!(places.len(), 1, "{scene}: {path}");
                assert_eq!((places[0].node, &places[0].above), (found.node, &found.above), "{scene}: {path}");
                let way = ways.path(found.node, 1000).unwrap();
                let first = tree.find(&way).unwrap();
                assert_eq!((first.len(), first[0].node), (1, found.node), "{scene}: {way}");
                if let Some(part) = found.part(tree) {
                    let places = tree.find(&part).unwrap();
                    assert_eq!(places.len(), 1, "{scene}: {part}");
                    assert!(path.starts_with(&part) && found.above.starts_with(&places[0].above), "{part}");
                }
                // What is selected has the leaf there, and the rest has another.
                if told.insert(path.clone()) {
                    let alone = owner(&model.only(&path).unwrap().check().unwrap(), p);
                    assert!(alone.is_some_and(|alone| alone.share == 1.0), "{scene}: {path}");
                }
            }
        }
        assert!(!told.is_empty());
    }
    let model = |text: &str| -> Model { jbt_text::model(text).unwrap() };
    let pair =
        model("jbt 1 union { body: union { point { radius 1 } point { radius 2 } } point { radius 3 } }");
    let tree = pair.check().unwrap();
    for (path, count) in [("body/1", 3), ("0", 5), ("0.union/1", 2), ("body/0.ring", 3), ("/body", 4)] {
        let alone = pair.only(path).unwrap_or_else(|error| panic!("{path}: {error}"));
        assert_eq!((alone.root.count(), tree.find(path).unwrap().len()), (count, 1), "{path}");
    }
    assert_eq!(pair.without("body/1").unwrap().root.count(), 4);
    for path in ["body/2", "0/2", "0/0/0/0", "body/0/0"] {
        for error in [pair.only(path).unwrap_err(), tree.find(path).unwrap_err()] {
            assert!(error.to_string().contains(&format!("nothing is at `{path}`")), "{path}: {error}");
        }
    }
    for path in ["1", "1/0", "/0", "0/body", "body/0/x", "0.", "0.-", "body/0.1"] {
        assert!(tree.find(path).unwrap_err().to_string().contains("is no path"), "{path}");
    }
}
