//! One distance for each instance and point, whatever is asked.

mod common;

use common::answers;
use jbt::statistics::leaf_uses;
use jbt::{Compiler, Engine, Query};
use jbt_model::check::CheckedTree;
use jbt_testkit::scene;

/// Every scene of the examples folder, and one that shares what none of them does.
fn examples() -> Vec<(String, CheckedTree)> {
    let coloured = COLOURED.map(|(name, text)| (name.to_owned(), text.to_owned()));
    scene::examples().into_iter().chain(coloured).map(|(name, text)| (name, scene::tree(&text))).collect()
}

/// Parts at one place with several colours: their fields are shared, their attributes are not.
const COLOURED: [(&str, &str); 4] = [
    (
        "a leaf",
        "jbt 1 let a = point { radius 1 } sum { color (1 0 0) { use a } union { color (0 1 0) { use a } box { half (1 1 1) radius 1 } } }",
    ),
    (
        "a warp",
        "jbt 1 let t = twist axis z rate 1 { point { at (0.2 0 0.1) radius 1 } } sum { color (1 0 0) { use t } color (0 1 0) { use t } }",
    ),
    (
        "a warp in operators of all kinds",
        "jbt 1 let t = twist axis x rate 2 { sum { point { radius 0.7 } segment { from (0 0.2 0) to (0 0.4 1) radius 0.5 } } }
         union {
             color (1 0 0) { use t }
             translate (0.3 0 0) { color (0 1 0) { use t } }
             blend ricci 3 { color (0 0 1) { use t } point { at (0.5 0 0) radius 0.6 } }
             blend ricci 3 { color (0 1 1) { use t } point { at (0 0.5 0) radius 0.6 } }
             difference { color (1 1 0) { use t } box { half (0.1 0.1 0.1) radius 0.5 } }
         }",
    ),
    (
        "warps in warps",
        "jbt 1 let a = twist axis x rate 1 { point { at (0 0.3 0.2) radius 0.8 } }
         let b = twist axis z rate 2 { sum { color (1 0 0) { use a } color (0 1 0) { use a } point { at (0.4 0 0) radius 0.5 } } }
         sum { use b color (0 0 1) { use b } rotate axis y degrees 30 { sum { color (1 1 1) { use b } use a } } }",
    ),
];

#[test]
fn coloured_parts_have_the_values_of_the_oracle() {
    let mut rng = fastrand::Rng::with_seed(3);
    for (name, tree) in examples().iter().rev().take(COLOURED.len()) {
        let evaluator =
            Compiler::for_engine(Engine::Scalar).evaluator(tree, Query::ALL).expect("it compiles");
        let points: jbt::Points = (0..300).map(|_| std::array::from_fn(|_| 2.0 * rng.f32() - 1.0)).collect();
        let samples = answers(&evaluator, &points);
        let colors = samples.attribute("color").expect("it has colours");
        let mut compared = 0;
        for index in 0..points.len() {
            let oracle = jbt_model::walk::walk(tree, points.get(index).map(f64::from));
            let field = f64::from(samples.field()[index]);
            assert!((field - oracle.field).abs() < 1e-4, "{name}: {field}, not {}", oracle.field);
            if oracle.kink_distance < 1e-3 || field < 1e-3 {
                continue;
            }
            compared += 1;
            for (plane, expected) in colors.iter().zip(&oracle.attributes[0]) {
                let off = (f64::from(plane[index]) - expected).abs();
                assert!(off < 2e-3, "{name} at {index}: {}, not {expected}", plane[index]);
            }
        }
        assert!(compared > 50, "{name}: {compared} points say something");
    }
}

/// Distances by an independent count: every path from the root to a leaf with the map that it goes through,
/// each pair once.
fn instances(tree: &CheckedTree) -> u64 {
    use jbt_model::kind::NodeKind;
    let mut found = std::collections::HashSet::new();
    let mut stack = vec![(tree.root(), String::new(), glam::DAffine3::IDENTITY)];
    while let Some((id, mut warps, mut map)) = stack.pop() {
        let node = tree.node(id);
        match &node.kind {
            NodeKind::Affine(inner) => map *= *inner,
            NodeKind::Warp(_) => {
                warps = format!("{warps}/{id:?}{:?}", map.to_cols_array());
                map = glam::DAffine3::IDENTITY;
            }
            NodeKind::Primitive(_) => {
                found.insert(format!("{warps}|{id:?}|{:?}", map.to_cols_array().map(|x| x + 0.0)));
            }
            NodeKind::Particles(particles) => {
                let place = map.to_cols_array().map(|x| x + 0.0);
                found.extend((0..particles.len()).map(|it| format!("{warps}|{id:?}.{it}|{place:?}")));
            }
            NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Attribute { .. }
            | NodeKind::Constant { .. } => {}
        }
        stack.extend(node.kind.asked(&node.children).iter().map(|&child| (child, warps.clone(), map)));
    }
    found.len() as u64
}

#[test]
fn each_instance_is_evaluated_once_for_any_query() {
    let scenes = examples();
    assert!(scenes.len() >= 5, "there are examples");
    for (name, tree) in scenes {
        let expected = instances(&tree);
        for query in Query::EVERY {
            let evaluator =
                Compiler::for_engine(Engine::Lanes).evaluator(&tree, query).expect("examples compile");
            let evaluations = evaluator.evaluations_by_node();
            assert_eq!(evaluations.total, expected, "{name}, {}", query.name());
            assert_eq!(evaluations.per_node.values().sum::<u64>(), expected, "{name}, {}", query.name());
        }
        let counters = {
            let evaluator =
                Compiler::for_engine(Engine::Lanes).evaluator(&tree, Query::ALL).expect("examples compile");
            let _ = evaluator.probe([0.1, 0.2, 0.3]).value();
            evaluator.counters()
        };
        assert_eq!(counters.primitive_evaluations, expected);
        assert_eq!(
            counters.primitive_evaluations + counters.evaluations_avoided,
            6 * leaf_uses(&tree),
            "separate walks take six, and meet a shared leaf at each of its uses"
        );
    }
}

/// What the test is worth: a program that computes a leaf twice is seen.
#[test]
fn a_leaf_that_is_computed_twice_is_counted_twice() {
    use jbt::internals::ir::domain::counting::evaluations;
    let (_, tree) = examples().swap_remove(0);
    let lowered = jbt_lower::lower(&tree, Query::FIELD).expect("examples compile");
    let function = jbt::internals::ir::verify(lowered.function).expect("lowering keeps the rules");
    let before = evaluations(&function, &lowered.tables).total;
    // Running a row twice is what a lowering that forgets about sharing does.
    let mut tables = lowered.tables.clone();
    let table = tables
        .tables
        .keys()
        .find(|&t| function.function().tables[t].slots.len() == 1)
        .expect("a table of leaves");
    let rows = &mut tables.tables[table];
    let row = rows.row(0).to_vec();
    rows.count += 1;
    rows.numbers.extend(row);
    rows.nodes.push(rows.nodes[0]);
    rows.active.insert(rows.starts[1] as usize, rows.nodes.len() as u32 - 1);
    for start in &mut rows.starts[1..] {
        *start += 1;
    }
    assert_eq!(tables.check(function.function()), Ok(()));
    assert_eq!(evaluations(&function, &tables).total, before + 1);
}
