//! Owners as an attribute: what programs answer is what the walk of one point says.

use jbt_model::check::{CheckedTree, NodeId, OWNER};
use jbt_model::owner::owner;
use jbt_model::query::Query;
use jbt_model::walk::walk;
use jbt_testkit::random::Random;
use jbt_testkit::scene::{OPERATORS, compiled, examples, run, tree};

/// The owner of a point by its walk: the number of the leaf, or -1.
fn walked(tree: &CheckedTree, p: [f64; 3]) -> f64 {
    owner(tree, p).map_or(-1.0, |owner| f64::from(owner.node.0))
}

#[test]
fn every_operator_has_owners() {
    let leaves = "point { radius 2 } color (1 0 0) { translate (1 0 0) { segment { from (0 0 0) to (1 0 0) radius 1.5 } } } box { center (0 1 0) half (1 0.2 0.3) radius 1 }";
    for operator in OPERATORS.into_iter().chain(["select 1"]) {
        let tree = tree(&format!("jbt 1 {operator} {{ {leaves} }}"));
        let owners = tree.with_owners().unwrap();
        let program = compiled(&owners, Query::ATTRIBUTES);
        let mut seen = std::collections::BTreeSet::new();
        for step in 0..500 {
            let t = f64::from(step);
            let p = [(t * 0.37).sin() * 2.5, (t * 0.71).cos() * 2.0, (t * 1.13).sin()]
                .map(|x| f64::from(x as f32));
            let expected = walked(&tree, p);
            let sample = walk(&owners, p);
            if sample.field == 0.0 {
                continue;
            }
            assert_eq!(sample.attributes[1][0], expected, "{operator} at {p:?}");
            seen.insert(expected as i64);
            // In f32 ties are decided otherwise only where they are near.
            let found = run(&program, p);
            if found[4] != expected {
                let leaf = |number: f64| (number >= 0.0).then(|| owners.node(NodeId(number as u32)));
                panic!("{operator} at {p:?}: {} for {expected}, {:?}", found[4], leaf(found[4]));
            }
        }
        // Factors have equal shares, so the first one has the product; of a selector one child is asked.
        let one = operator == "product" || operator.starts_with("select");
        assert!(!seen.is_empty() && (one || seen.len() > 1), "{operator}: {seen:?}");
    }
}

#[test]
fn owners_of_random_models() {
    let (mut asked, mut agreed, mut nobody) = (0, 0, 0);
    for seed in 0..1_200 {
        let model = Random::new(seed, seed).model(12);
        let Ok(tree) = model.check() else { continue };
        let Ok(owners) = tree.with_owners() else { continue };
        let index = owners.attributes().iter().position(|group| &*group.name == OWNER).unwrap();
        for step in 0..20 {
            let t = f64::from(step) + seed as f64;
            let p = [(t * 0.37).sin() * 1.5, (t * 0.71).cos() * 1.5, (t * 1.13).sin() * 1.5];
            let sample = walk(&owners, p);
            let (found, expected) = (sample.attributes[index][0], walked(&tree, p));
            // Where the field is 0 no leaf decides, and a group has the value of the one that is asked.
            if sample.field == 0.0 {
                continue;
            }
            // What an operator makes of nothing, as the outside of a complement, has a weight and no leaf.
            if found >= 0.0 {
                assert_eq!(found, expected, "seed {seed} at {p:?}");
                agreed += 1;
            } else {
                nobody += u32::from(found != expected);
            }
            asked += 1;
        }
    }
    assert!(asked > 6_000 && agreed > asked / 2 && nobody < asked / 15, "{asked} {agreed} {nobody}");
}

#[test]
fn fields_stay_and_names_are_free() {
    for (name, text) in examples().into_iter().take(6) {
        let tree = tree(&text);
        let owners = tree.with_owners().unwrap();
        let colors = tree.with_owner_colors().unwrap();
        for p in [[0.1, 0.2, 0.3], [0.5, -0.5, 0.1], [-0.3, 0.4, -0.2]] {
            assert_eq!(walk(&tree, p).field.to_bits(), walk(&owners, p).field.to_bits(), "{name}");
            let color = walk(&colors, p).attributes.pop().unwrap();
            assert_eq!(walked(&tree, p) < 0.0, color == [0.0; 3], "{name} at {p:?}");
        }
        assert_eq!(owners.of_attributes(&[OWNER]).unwrap().attributes().len(), 1);
    }
    let own = tree("jbt 1 attribute owner 1 point { radius 1 }");
    assert!(own.with_owners().unwrap_err()[0].message.contains("an attribute `owner` of its own"));
}
