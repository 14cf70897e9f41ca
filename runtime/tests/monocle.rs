//! The monocle of BABEL: its text and its Rust are one tree, which has as many nodes as the C++ had, and is
//! what it says.

#[path = "../examples/monocle/solid.rs"]
mod solid;

use jbt::{Evaluator, Model, Query};
use jbt_model::traverse::Visit;
use jbt_model::walk::walk;
use jbt_testkit::scene::{self, assert_reads_back};

use solid::{Material, model, monocle};

fn written() -> Model {
    scene::model(include_str!("../../examples/monocle.jbt"))
}

#[test]
fn text_and_rust_are_one_tree() {
    let (text, rust) = (written(), model(monocle()));
    assert_eq!(text.root, rust.root);
    assert_eq!(text, rust);
}

#[test]
fn nodes_and_paths_are_those_of_the_listing() {
    for model in [written(), model(monocle())] {
        for (visit, count) in [(Visit::Nodes, 9), (Visit::Paths, 10)] {
            assert_eq!(model.root.prefix(visit).count(), count);
            assert_eq!(model.root.postfix(visit).count(), count);
        }
        let tree = model.check().expect("a good model");
        assert_eq!((tree.nodes().len(), tree.uses().iter().sum::<u64>()), (9, 10));
    }
}

#[test]
fn what_is_printed_reads_back() {
    let model = model(monocle());
    let again = assert_reads_back(&model);
    // The ball is written once.
    assert_eq!(again.root.prefix(Visit::Nodes).count(), 9);
}

#[test]
fn it_is_a_lens_in_a_rim() {
    let tree = model(monocle()).check().expect("a good model");
    let evaluator = Evaluator::compile(&tree, Query::ATTRIBUTES).expect("it compiles");
    // The balls meet in a circle of radius 0.6, since 0.6^2 + 0.8^2 = 1; the lens is 0.4 thick.
    let places = [
        ([0.0, 0.0, 0.0], Some(Material::Glass)),
        ([0.0, 0.0, 0.1875], Some(Material::Glass)),
        ([0.0, 0.0, 0.21875], None),
        ([0.5, 0.0, 0.0], Some(Material::Glass)),
        ([0.0, 0.625, 0.0], Some(Material::Steel)),
        ([0.6, 0.0, 0.05], Some(Material::Steel)),
        ([0.6, 0.0, 0.0625], None),
        ([0.6875, 0.0, 0.0], None),
    ];
    for (place, expected) in places {
        let plain = walk(&tree, place);
        assert_eq!(plain.field >= 0.5, expected.is_some(), "{place:?}: the oracle has {}", plain.field);
        let probe = evaluator.probe(place.map(|x| x as f32));
        assert_eq!(probe.value() >= 0.5, expected.is_some(), "{place:?}: {}", probe.value());
        if expected.is_some() {
            assert_eq!(probe.attribute("material").and_then(Material::of), expected, "{place:?}");
            assert_eq!(Material::of(&[plain.attributes[1][0] as f32]), expected, "{place:?}");
        }
    }
}
