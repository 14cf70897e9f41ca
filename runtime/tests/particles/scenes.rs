//! Scenes with particles, each of which has a twin of plain points.

use std::sync::Arc;

use fastrand::Rng;
use jbt::build::{Axis, Edge, blinn, checker, param, particles, point, surface_particles, x};
use jbt::{AttributeGroup, Falloff, Mixing, Model, Tree};

/// Coordinates in [-1, 1] that are f32.
pub fn places(rng: &mut Rng, count: usize) -> Vec<[f32; 3]> {
    (0..count).map(|_| std::array::from_fn(|_| 2.0 * rng.f32() - 1.0)).collect()
}

fn numbers(rng: &mut Rng, count: usize, low: f32, high: f32) -> Vec<f32> {
    (0..count).map(|_| low + (high - low) * rng.f32()).collect()
}

/// Coloured particles of different sizes.
pub fn cloud(seed: u64, count: usize) -> Tree {
    let mut rng = Rng::with_seed(seed);
    let (at, radius) = (places(&mut rng, count), numbers(&mut rng, count, 0.2, 0.7));
    particles(at, radius).colors(numbers(&mut rng, 3 * count, 0.0, 1.0))
}

/// Some of them push surfaces away, and some have the strength of a plain point.
fn signed(seed: u64, count: usize) -> Tree {
    let mut rng = Rng::with_seed(seed);
    let strengths: Vec<f64> = (0..count).map(|_| [1.0, 1.0, 0.5, -0.75][rng.usize(0..4)]).collect();
    cloud(seed, count).strengths(strengths)
}

/// A model with two groups more: one of numbers, one of a uv, each mixed in another way.
pub fn model(tree: Tree) -> Model {
    let group = |name: &str, width: usize, mixing| AttributeGroup {
        name: name.into(),
        default: vec![0.25; width],
        mixing,
        ..AttributeGroup::color()
    };
    let mut model = Model::new(tree);
    model.attributes.push(group("heat", 1, Mixing::Dominant));
    model.attributes.push(group("place", 2, Mixing::Blend));
    model
}

/// Scenes by name.
pub fn scenes() -> Vec<(&'static str, Tree)> {
    let double: Vec<[f64; 3]> = vec![[0.1, 0.2, 0.3], [0.4, -0.5, 0.6], [0.0; 3]];
    let heat = |count: usize| (0..count).map(|index| index as f32).collect::<Vec<f32>>();
    let [a, b] = [cloud(3, 20), signed(4, 17)];
    let warped = |tree: &Tree| tree.twist(Axis::Y, 0.7);
    vec![
        ("alone", cloud(1, 30)),
        ("one", cloud(1, 1)),
        ("two", cloud(2, 2)),
        ("in f64, one radius", particles(double.clone(), 0.75)),
        ("shared arrays", particles(Arc::new(vec![0.0_f32, 0.0, 0.0, 0.5, 0.0, 0.0]), vec![0.5_f32, 0.75])),
        ("surface radii", surface_particles(double.clone(), vec![0.2, 0.3, 0.4])),
        ("surface radii and strengths", surface_particles(double, 0.25).strengths([1.0, 2.0, 0.75])),
        ("signed", signed(5, 40)),
        ("signed beside points", Tree::sum([point([0.0; 3], 0.5), signed(6, 9), point([0.3; 3], 0.6)])),
        ("flattened", Tree::sum([point([0.0; 3], 0.5), cloud(7, 9), point([0.3; 3], 0.6), cloud(8, 5)])),
        ("ricci", Tree::blend(3.0, [a.clone(), point([0.5; 3], 0.8), b.clone()])),
        ("a union of one each", cloud(1, 1) | point([0.2, 0.1, 0.0], 0.5) | cloud(2, 1)),
        ("cut", (a.clone() - signed(9, 12)) | (b.clone() & point([0.0; 3], 1.5))),
        (
            "dominant",
            cloud(10, 12).values("heat", 1, heat(12)) + point([0.0; 3], 0.7).attribute("heat", &[9.0]),
        ),
        ("moved", a.rotate([1, 0, 0], 30.0).scale(0.8).translate([0.1, 0.2, 0.3])),
        ("skewed", signed(11, 15).scale_axes([0.5, 1.0, 1.5]).rotate([0, 0, 1], 20.0)),
        ("far away", cloud(12, 15).translate([1e6, -2e6, 3e5])),
        ("warped", warped(&a) + warped(&b).translate([0.5, 0.0, 0.0])),
        ("under a weight", cloud(13, 9).taper(Axis::Z, -1.0, 1.0, 1.0, 0.5) | warped(&b)),
        (
            "falloffs",
            cloud(14, 9).falloff(Falloff::Wyvill) + cloud(15, 9).falloff(blinn(2.0, 2.0, Edge::Exact)),
        ),
        (
            "textured",
            particles(places(&mut Rng::with_seed(16), 12), 0.6).textured(
                "color",
                checker(0.3),
                &[1.0, 0.0, 0.0],
                &[0.0, 0.0, 1.0],
            ),
        ),
        ("uv", cloud(17, 9).uv("place").rotate([0, 1, 0], 40.0)),
        ("uv of one", warped(&cloud(17, 1).uv("place"))),
        (
            "parameters",
            particles(places(&mut Rng::with_seed(18), 9), param("size", 0.5)).strength(param("power", 1.0)),
        ),
        ("shared", {
            let pair = cloud(19, 8);
            (&pair + &pair.translate([0.5, 0.0, 0.0])) | pair.scale(0.5)
        }),
        ("in a formula", Tree::expression(cloud(20, 9).field() * (1.0 + 0.2 * (5 * x()).sin()))),
    ]
}
