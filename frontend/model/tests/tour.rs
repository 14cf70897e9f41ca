//! Tours: what comes when, which maps and attributes hold, and that they fit what the oracle says.

use jbt_model::builder::point;
use jbt_model::check::CheckedTree;
use jbt_model::kind::NodeKind;
use jbt_model::model::Model;
use jbt_model::tour::{TourEvent, TourStep};
use jbt_model::walk::walk;
use jbt_testkit::scene::{examples, tree};

fn read(text: &str) -> CheckedTree {
    jbt_text::model(&format!("jbt 1 {text}"))
        .and_then(|model| model.check())
        .unwrap_or_else(|e| panic!("{e}"))
}

fn word(tree: &CheckedTree, step: &TourStep) -> &'static str {
    match &tree.node(step.node).kind {
        NodeKind::Primitive(leaf) => leaf.skeleton.kind().name(),
        NodeKind::Particles(_) => "particles",
        NodeKind::Combine(combinator) => combinator.name(),
        NodeKind::Expression(_) => "expression",
        NodeKind::Select(_) => "select",
        NodeKind::Affine(_) => "affine",
        NodeKind::Warp(warp) => warp.name(),
        NodeKind::Attribute { .. } => "attribute",
        NodeKind::Constant { .. } => "constant",
    }
}

#[test]
fn nodes_are_entered_and_left() {
    let tree = read(
        "let a = point { radius 1 } union { color (1 0 0) { use a } select 1 { use a ring { ring_radius 1 radius 1 } } use a }",
    );
    let told: Vec<String> = tree
        .tour()
        .map(|event| match event {
            TourEvent::Enter(step) => format!("+{} {}.{}", word(&tree, &step), step.depth, step.child),
            TourEvent::Leave(step) => format!("-{}", word(&tree, &step)),
        })
        .collect();
    let expected = "+union 0.0, +attribute 1.0, +point 2.0, -point, -attribute, +select 1.1, +ring 2.1, -ring, \
                    -select, +point 1.2, -point, -union";
    assert_eq!(told.join(", "), expected);
    // What is below may be left out.
    let mut tour = tree.tour();
    let mut words = Vec::new();
    while let Some(event) = tour.next() {
        if let TourEvent::Enter(step) = &event {
            words.push(word(&tree, step));
            if word(&tree, step) == "attribute" {
                tour.skip_below();
            }
        }
    }
    assert_eq!(words, ["union", "attribute", "select", "ring", "point"]);
}

#[test]
fn maps_are_composed_up_to_a_warp() {
    let tree = read(
        "translate (1 2 3) { rotate axis z degrees 90 { union { point { radius 1 }
             translate (5 0 0) { twist axis z rate 1 weighted { scale 2 { point { radius 1 } } ring { ring_radius 1 radius 1 } } } } } }",
    );
    let mut told = Vec::new();
    for event in tree.tour() {
        let TourEvent::Enter(step) = event else { continue };
        if tree.node(step.node).children.is_empty() {
            let rows = step.rows().map(|row| row.map(|x| (x * 1e6).round() / 1e6 + 0.0));
            told.push((step.warp().is_some(), rows[0], rows[1][3]));
        }
    }
    let turned = [0.0, -1.0, 0.0, 1.0];
    assert_eq!(told, [(false, turned, 2.0), (true, [2.0, 0.0, 0.0, 0.0], 0.0), (false, turned, 7.0)]);
}

#[test]
fn the_nearest_of_each_name_is_bound() {
    let tree = read(
        "attribute rough 1 color (1 0 0) { rough 0.5 { constant color \"red\" { union { point { radius 1 }
             translate (5 0 0) { color (0 1 0) { constant color \"green\" { point { radius 1 } } } } } } } }",
    );
    let mut seen = 0;
    for event in tree.tour() {
        let TourEvent::Enter(step) = event else { continue };
        if !tree.node(step.node).children.is_empty() {
            continue;
        }
        let told: Vec<String> =
            step.bound().iter().map(|&node| format!("{:?}", tree.node(node).kind)).collect();
        assert_eq!(told.len(), 3);
        let sample = walk(&tree, [step.rows()[0][3], 0.0, 0.0]);
        assert!(told[0].contains(&format!("{:?}", sample.attributes[0])), "{told:?}");
        assert!(told[1].contains("rough") && told[2].contains(["red", "green"][seen]), "{told:?}");
        seen += 1;
    }
    assert_eq!(seen, 2);
}

#[test]
fn every_path_has_both_events() {
    for (name, text) in examples() {
        let tree = tree(&text);
        let mut open: Vec<TourStep> = Vec::new();
        let mut count = 0_u64;
        for event in tree.tour() {
            match event {
                TourEvent::Enter(step) => {
                    assert_eq!(step.depth, open.len(), "{name}");
                    open.push(step);
                    count += 1;
                }
                TourEvent::Leave(step) => assert_eq!(open.pop(), Some(step), "{name}"),
            }
        }
        assert!(open.is_empty(), "{name}");
        let asked: u64 = tree.asked().iter().sum();
        assert_eq!(count, asked, "{name}");
    }
    // A long chain.
    let deep = (0..100_000).fold(point([0; 3], 1), |tree, _| tree.color([0.5; 3]));
    let tree = Model::new(deep).check().unwrap();
    assert_eq!(tree.tour().count(), 200_002);
}
