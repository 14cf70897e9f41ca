//! Statistics against counts that know nothing of lowering: closed forms, and every path of every example.

use glam::{DAffine3, DVec3};
use jbt::mesh::Lattice;
use jbt::statistics::{PerPoint, Statistics, SupportCounts, SupportsError};
use jbt::{CancelToken, Compiler, Fineness, Polygonize, Query};
use jbt_model::check::{CheckedTree, NodeId};
use jbt_model::kind::NodeKind;
use jbt_model::walk::walk;
use jbt_model::warp::Warp;
use jbt_testkit::scene::{examples, tree};

fn supports(tree: &CheckedTree, lattice: &Lattice) -> SupportCounts {
    Statistics::new(tree).supports(&Compiler::new(), lattice).run().expect("it compiles")
}

/// Points of a lattice, rounded as everybody sees them.
fn points(lattice: &Lattice) -> impl Iterator<Item = DVec3> + '_ {
    let [nx, ny, nz] = lattice.points();
    (0..nx * ny * nz).map(move |index| {
        let [x, y, z] = [index % nx, index / nx % ny, index / (nx * ny)];
        let at = |axis, index| f64::from(lattice.coordinate(axis, index));
        DVec3::new(at(0, x), at(1, y), at(2, z))
    })
}

fn count(lattice: &Lattice, inside: impl Fn(DVec3) -> bool) -> u64 {
    points(lattice).filter(|&p| inside(p)).count() as u64
}

#[test]
fn a_ball_holds_the_points_nearer_than_its_radius() {
    let tree = tree("jbt 1 point { at (0.1 0.2 0.3) radius 0.7310 strength -2 }");
    let ball = |p: DVec3| p.distance(DVec3::new(0.1, 0.2, 0.3)) < 0.7310;
    let whole =
        Polygonize { fineness: Fineness::Cell(0.05), ..Polygonize::default() }.lattice(&tree).unwrap();
    // The second one cuts the ball, the third one is outside of it.
    let cut = Lattice::covering([0.0; 3], [3.0, 1.0, 0.5], 0.03).unwrap();
    let far = Lattice::covering([5.0; 3], [6.0; 3], 0.5).unwrap();
    for lattice in [&whole, &cut, &far] {
        let found = supports(&tree, lattice);
        let pairs = count(lattice, ball);
        assert_eq!((found.points, found.pairs), (lattice.point_count(), pairs));
        assert_eq!(found.by_node.into_iter().collect::<Vec<_>>(), [(0, pairs)]);
    }
    // 4 pi r^3 / 3 in units of cells, to within the cells of its surface.
    let found = supports(&tree, &whole);
    let expected = 4.0 / 3.0 * std::f64::consts::PI * (0.7310_f64 / 0.05).powi(3);
    assert!((found.pairs as f64 / expected - 1.0).abs() < 0.01, "{} {expected}", found.pairs);
    let waste = found.waste(found.points).unwrap();
    assert!((waste - found.points as f64 / found.pairs as f64).abs() < 1e-12);
    assert_eq!(supports(&tree, &far).waste(27), None);
}

#[test]
fn a_twist_is_undone() {
    let tree = tree("jbt 1 twist axis z rate 2 { point { at (0.8 0 0) radius 0.45 } }");
    let lattice =
        Polygonize { fineness: Fineness::Cell(0.04), ..Polygonize::default() }.lattice(&tree).unwrap();
    let inside = |p: DVec3| {
        let (sin, cos) = (2.0 * p.z).sin_cos();
        let back = DVec3::new(cos * p.x + sin * p.y, cos * p.y - sin * p.x, p.z);
        back.distance(DVec3::new(0.8, 0.0, 0.0)) < 0.45
    };
    let expected = count(&lattice, inside);
    assert!(expected > 1000);
    assert_eq!(supports(&tree, &lattice).pairs, expected);
}

#[test]
fn a_box_is_turned_and_stretched() {
    let tree = tree(
        "jbt 1 translate (0.3 0 0) { rotate axis z degrees 30 { scale (2 1 0.5) { box { half (0.31 0.2 0.1) radius 0.237 } } } }",
    );
    let lattice =
        Polygonize { fineness: Fineness::Cell(0.04), ..Polygonize::default() }.lattice(&tree).unwrap();
    let inside = |p: DVec3| {
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let [x, y] = [p.x - 0.3, p.y];
        let q = DVec3::new((cos * x + sin * y) / 2.0, cos * y - sin * x, p.z / 0.5);
        (q.abs() - DVec3::new(0.31, 0.2, 0.1)).max(DVec3::ZERO).length() < 0.237
    };
    let expected = count(&lattice, inside);
    assert!(expected > 1000);
    assert_eq!(supports(&tree, &lattice).pairs, expected);
}

#[test]
fn a_shared_subtree_is_walked_at_each_use_and_computed_once() {
    let tree = tree(
        "jbt 1 let pair = sum { point { radius 1 } point { at (0.5 0 0) radius 1 } }
         difference { union { use pair use pair translate (4 0 0) { use pair } } sum { use pair } }",
    );
    let statistics = Statistics::new(&tree);
    assert_eq!((statistics.uses(), statistics.instances()), (8, 4));
    let per_point =
        |query| statistics.per_point(&Compiler::new().evaluator(&tree, query).expect("it compiles"));
    assert_eq!(per_point(Query::FIELD), PerPoint { separate: 8, cached: 4, fused: 4 });
    assert_eq!(per_point(Query::GRADIENT), PerPoint { separate: 40, cached: 16, fused: 4 });
    assert_eq!(per_point(Query::ATTRIBUTES), PerPoint { separate: 16, cached: 4, fused: 4 });
    assert_eq!(per_point(Query::ALL), PerPoint { separate: 48, cached: 16, fused: 4 });
    // Two balls at each of two places, however often they are used; the lattice holds both places in the same
    // way.
    let lattice = Lattice::covering([-1.0625, -1.0625, -1.0625], [5.5625, 1.0625, 1.0625], 0.125).unwrap();
    let balls = [0.0, 0.5, 4.0, 4.5];
    let expected = balls.map(|x| count(&lattice, |p| p.distance(DVec3::new(x, 0.0, 0.0)) < 1.0));
    assert_eq!(supports(&tree, &lattice).pairs, expected.iter().sum::<u64>());
    let once = Compiler::new().evaluator(&tree, Query::ALL).expect("it compiles");
    let _ = once.probe([0.0; 3]).value();
    assert_eq!(once.counters().evaluations_avoided, 48 - 4);
}

/// The leaves of every path with the maps above them, the outermost first; each different one once.
fn paths(tree: &CheckedTree) -> Vec<(u32, Vec<Map>)> {
    let mut found: Vec<(u32, Vec<Map>)> = Vec::new();
    let mut stack = vec![(tree.root(), vec![Map::Affine(DAffine3::IDENTITY)])];
    while let Some((id, maps)) = stack.pop() {
        let node = tree.node(id);
        let mut below = maps.clone();
        if let (NodeKind::Warp(warp), [child, weight]) = (&node.kind, &*node.children) {
            // The weight stands where the warp stands.
            below.push(Map::Weighted(warp.clone(), *weight));
            stack.extend([(*child, below), (*weight, maps)]);
            continue;
        }
        match (&node.kind, below.last_mut()) {
            (NodeKind::Affine(map), Some(Map::Affine(last))) => *last *= *map,
            (NodeKind::Affine(map), _) => below.push(Map::Affine(*map)),
            (NodeKind::Warp(warp), _) => below.push(Map::Warp(warp.clone())),
            (NodeKind::Primitive(_), _) if !found.contains(&(id.0, maps.clone())) => found.push((id.0, maps)),
            (
                NodeKind::Primitive(_)
                | NodeKind::Particles(_)
                | NodeKind::Combine(_)
                | NodeKind::Expression(_)
                | NodeKind::Select(_)
                | NodeKind::Attribute { .. }
                | NodeKind::Constant { .. },
                _,
            ) => {}
        }
        stack.extend(node.kind.asked(&node.children).iter().map(|&child| (child, below.clone())));
    }
    found
}

#[derive(Clone, PartialEq)]
enum Map {
    Affine(DAffine3),
    Warp(Warp),
    /// By the field of a subtree.
    Weighted(Warp, NodeId),
}

#[test]
fn the_supports_of_all_examples_are_those_of_plain_formulas() {
    for (name, text) in examples() {
        let tree = tree(&text);
        let settings = Polygonize { fineness: Fineness::Resolution(20), ..Polygonize::default() };
        let lattice = settings.lattice(&tree).expect("examples have a surface");
        // Of each node, the points that are inside for certain, and those that are not certainly outside.
        let mut bounds = std::collections::BTreeMap::<u32, [u64; 2]>::new();
        let paths = paths(&tree);
        for (node, maps) in &paths {
            let NodeKind::Primitive(leaf) = &tree.nodes()[*node as usize].kind else { unreachable!() };
            let undo = |p: DVec3, map: &Map| match map {
                Map::Affine(map) => map.inverse().transform_point3(p),
                Map::Warp(warp) => warp.inverse(p),
                Map::Weighted(warp, weight) => {
                    warp.weighted(p, walk(&tree.subtree(*weight), p.to_array()).field)
                }
            };
            let counts = bounds.entry(*node).or_default();
            for p in points(&lattice) {
                let q = maps.iter().fold(p, undo);
                let s = leaf.skeleton.distance_squared(q) / leaf.radius.powi(2);
                counts[0] += u64::from(s < 1.0 - 1e-5);
                counts[1] += u64::from(s < 1.0 + 1e-5);
            }
        }
        let found = supports(&tree, &lattice);
        assert_eq!(found.by_node.len(), bounds.len(), "{name}");
        assert_eq!(found.by_node.values().sum::<u64>(), found.pairs);
        for (node, [least, most]) in bounds {
            let pairs = found.by_node[&node];
            assert!((least..=most).contains(&pairs), "{name} node {node}: {pairs}");
        }
        assert_eq!(Statistics::new(&tree).instances(), paths.len() as u64, "{name}");
    }
}

#[test]
fn counting_can_be_cancelled() {
    let tree = tree("jbt 1 point { radius 1 }");
    let lattice = Polygonize::default().lattice(&tree).unwrap();
    let token = CancelToken::new();
    token.cancel();
    let stopped = Statistics::new(&tree).supports(&Compiler::new(), &lattice).cancel(&token).run();
    assert!(matches!(stopped, Err(SupportsError::Cancelled)));
}
