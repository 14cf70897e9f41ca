//! The walkers against the f64 oracle: the example scenes, and every skeleton under every operator and map.

use std::path::Path;

use jbt::build::{Axis, cuboid, cylinder, disc, point, ring, segment, triangle};
use jbt::text::{Options, parse};
use jbt::tree::Combinator;
use jbt::tree::operators::{Difference, Intersection, Ricci, Sum, Union};
use jbt::walk::{walk, walk_gradient};
use jbt::{CheckedTree, Falloff, Model, Points, Tree};

use super::{STEP, Walker, separate};
use crate::model;

/// How far answers may be off, by rounding in f32, times how steep the field is.
const FIELD_BOUND: f64 = 4e-5;
const GRADIENT_BOUND: f64 = 2e-3;
const ATTRIBUTE_BOUND: f64 = 2e-3;

/// All planes of the answers at points.
fn planes(walker: &Walker, count: usize, answer: impl Fn(&Walker, &mut [&mut [f32]])) -> Vec<Vec<f32>> {
    let mut planes = vec![vec![f32::NAN; count]; 4 + walker.channels()];
    let mut outs: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    answer(walker, &mut outs);
    planes
}

fn compare(what: &str, tree: &CheckedTree, points: &Points) {
    let walker = Walker::new(tree);
    let fused = planes(&walker, points.len(), |walker, outs| walker.full(points.planes(), outs));
    let apart = planes(&walker, points.len(), |walker, outs| separate(walker, points.planes(), outs));
    let mut compared = 0;
    for index in 0..points.len() {
        let at = |planes: &[Vec<f32>]| planes.iter().map(|plane| f64::from(plane[index])).collect::<Vec<_>>();
        compared += usize::from(compare_point(what, tree, points.get(index), &at(&fused), &at(&apart)));
    }
    assert!(compared > 5, "{what}: of {} points, {compared} have gradients to compare", points.len());
}

fn near(what: &str, value: f64, expected: f64, bound: f64) {
    assert!((value - expected).abs() <= bound, "{what} is {value}, the oracle has {expected}");
}

/// Whether the gradient and the attributes were compared as well: they are where nothing is decided nearby.
fn compare_point(what: &str, tree: &CheckedTree, point: [f32; 3], fused: &[f64], apart: &[f64]) -> bool {
    let (what, p) = (format!("{what}, at {point:?}:"), point.map(f64::from));
    let oracle = walk(tree, p);
    let (fine, coarse) = (walk_gradient(tree, p, 1e-6), walk_gradient(tree, p, 1e-5));
    let steep = fine.iter().fold(1.0, |size: f64, slope| size.max(slope.abs()));
    near(&format!("{what} the field"), fused[0], oracle.field, FIELD_BOUND * steep);
    near(&format!("{what} the field, apart"), apart[0], oracle.field, FIELD_BOUND * steep);
    for axis in 0..3 {
        let mut ahead = p;
        ahead[axis] += f64::from(STEP);
        let expected = (walk(tree, ahead).field - oracle.field) / f64::from(STEP);
        near(&format!("{what} the difference"), apart[1 + axis], expected, 5.0 * GRADIENT_BOUND * steep);
    }
    let smooth = fine.iter().zip(coarse).all(|(fine, coarse)| (fine - coarse).abs() < 1e-4 * steep);
    if oracle.kink_distance < 1e-4 * steep || oracle.field < 1e-3 || !smooth {
        return false;
    }
    for (slope, expected) in fused[1..4].iter().zip(fine) {
        near(&format!("{what} the gradient"), *slope, expected, GRADIENT_BOUND * steep);
    }
    let expected: Vec<f64> = oracle.attributes.into_iter().flatten().collect();
    for (channel, expected) in expected.into_iter().enumerate() {
        near(&format!("{what} an attribute"), fused[4 + channel], expected, ATTRIBUTE_BOUND * steep);
        near(&format!("{what} an attribute, apart"), apart[4 + channel], expected, ATTRIBUTE_BOUND * steep);
    }
    true
}

/// Those made of what the compared models are made of; the walker knows no formulas and no textures.
const EXAMPLES: [&str; 9] =
    ["attributes", "goblet", "hero", "holes", "mood", "blend", "peanut", "circles", "twist"];

#[test]
fn the_examples() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    for name in EXAMPLES {
        let text = std::fs::read(folder.join(name).with_extension("jbt")).expect("a readable example");
        let tree = parse(&text, &Options::default()).and_then(|model| model.check()).expect("a good example");
        compare(name, &tree, &model::cube(600, 3));
    }
}

fn skeletons() -> [Tree; 7] {
    [
        point([0.3, -0.1, 0.2], 1.0),
        segment([-0.5, 0.0, 0.1], [0.6, 0.3, -0.2], 0.9),
        disc([0.1, 0.2, -0.1], [0.3, 0.4, 1.0], 0.5, 0.8),
        ring([-0.1, 0.0, 0.1], [1.0, 0.2, 0.0], 0.5, 0.8),
        cylinder([-0.3, -0.4, 0.0], [0.2, 0.5, 0.1], 0.3, 0.7),
        cuboid([0.2, 0.1, 0.0], [0.3, 0.2, 0.4], 0.8),
        triangle([-0.6, -0.5, 0.0], [0.7, -0.2, 0.1], [0.0, 0.6, -0.3], 0.7),
    ]
}

/// All skeletons with their own colours, under maps that stay with the point, and that go into the leaf.
fn leaves() -> Vec<Tree> {
    let mut leaves = Vec::new();
    for (i, tree) in skeletons().into_iter().enumerate() {
        let tree = if i % 2 == 0 { tree } else { tree.falloff(Falloff::Wyvill) };
        let part = i as f64 / 7.0;
        let tree = tree.strength(1.0 - 0.4 * part).color([part, 1.0 - part, 0.5]);
        leaves.push(match i % 3 {
            0 => tree.rotate([1.0, 1.0, 0.3], 50.0).scale_axes([1.2, 0.7, 0.9]),
            1 => tree.rotate([0.0, 1.0, 0.3], 20.0).scale(1.1).translate([0.1, 0.0, -0.2]),
            _ => tree,
        });
    }
    leaves
}

#[test]
fn every_skeleton_alone() {
    for (i, tree) in skeletons().into_iter().enumerate() {
        for (j, tree) in [
            tree.clone(),
            tree.scale_axes([0.8, 1.3, 1.0]),
            tree.translate([0.0, 0.2, 0.0]).twist(Axis::Y, 0.7),
        ]
        .into_iter()
        .enumerate()
        {
            let tree = Model::new(tree).check().expect("a good model");
            compare(&format!("skeleton {i}, map {j}"), &tree, &model::cube(300, 4));
        }
    }
}

#[test]
fn every_operator() {
    for combinator in [
        Combinator::from(Sum {}),
        Ricci { exponent: 1.0 }.into(),
        Ricci { exponent: 2.0 }.into(),
        Ricci { exponent: 3.0 }.into(),
        Ricci { exponent: 2.6 }.into(),
        Ricci { exponent: 200.0 }.into(),
        Union {}.into(),
        Intersection {}.into(),
        Difference {}.into(),
    ] {
        let inner = Tree::combine(combinator, leaves().into_iter().take(3));
        let nested =
            Tree::combine(combinator, [inner.clone(), inner.translate([0.2, 0.0, 0.1]).twist(Axis::X, 1.1)]);
        let turned = nested.rotate([0.0, 0.0, 1.0], 30.0).scale_axes([1.0, 1.1, 0.8]);
        for (what, tree) in
            [("all", Tree::combine(combinator, leaves())), ("nested", nested), ("turned", turned)]
        {
            let tree = Model::new(tree).check().expect("a good model");
            let points: Points = (0..500).map(|i| model::cube(500, 5).get(i).map(|x| 0.7 * x)).collect();
            compare(&format!("{combinator:?}, {what}"), &tree, &points);
        }
    }
}

#[test]
fn negative_fields_and_missing_attributes() {
    let pushed = point([0.2, 0.0, 0.0], 0.9).strength(-0.6).color([1.0, 0.0, 0.0]);
    for combinator in
        [Combinator::from(Sum {}), Ricci { exponent: 2.0 }.into(), Union {}.into(), Difference {}.into()]
    {
        let tree = Tree::combine(combinator, [point([-0.2, 0.0, 0.0], 1.0), pushed.clone()]);
        compare(
            &format!("{combinator:?}"),
            &Model::new(tree).check().expect("a good model"),
            &model::cube(400, 6),
        );
    }
}

#[test]
fn the_field_alone_is_the_field() {
    let tree = model::tree(&model::blobs(50, 1));
    let (walker, points) = (Walker::new(&tree), model::cube(500, 2));
    let mut field = vec![0.0; points.len()];
    walker.field(points.planes(), &mut field);
    let full = planes(&walker, points.len(), |walker, outs| walker.full(points.planes(), outs));
    assert_eq!((walker.leaves(), walker.channels()), (50, 3));
    assert!(field.iter().zip(&full[0]).all(|(a, b)| (a - b).abs() < 1e-5));
    compare("blobs", &tree, &points);
}
