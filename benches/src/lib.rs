//! Models for benches, and the checks that their answers have to pass before anything is timed.

use jbt::{Evaluator, Model, Points};
use jbt_frontend::check::CheckedTree;
use jbt_frontend::combine::Combinator;
use jbt_frontend::falloff::Falloff;
use jbt_frontend::skeleton::Point;
use jbt_frontend::tree::{NodeKind, Primitive, Tree};
use jbt_frontend::walk::walk;

/// Soft-object points under one sum: centres uniform in [-0.9, 0.9]^3, radii `1.6 count^(-1/3) (0.5 + uniform)`, so that about as many
/// overlap at any count; each with a colour.
#[must_use]
pub fn blobs(count: usize, seed: u64) -> CheckedTree {
    let mut random = fastrand::Rng::with_seed(seed);
    let size = 1.6 * (count as f64).powf(-1.0 / 3.0);
    let leaf = |random: &mut fastrand::Rng| {
        let at = std::array::from_fn(|_| 1.8 * random.f64() - 0.9);
        let primitive = Primitive {
            skeleton: Point { at: at.into() }.into(),
            falloff: Falloff::Soft,
            radius: size * (0.5 + random.f64()),
            strength: 1.0,
        };
        let values = (0..3).map(|_| random.f64()).collect();
        let leaf = Tree::new(NodeKind::Primitive(primitive), Vec::new());
        Tree::new(NodeKind::Attribute { name: "color".into(), values }, vec![leaf])
    };
    let leaves = (0..count).map(|_| leaf(&mut random)).collect();
    let tree = Tree::new(NodeKind::Combine(Combinator::Sum), leaves);
    Model::new(tree).check().expect("blobs are a good model")
}

/// Points uniform in [-1, 1]^3.
#[must_use]
pub fn cube(count: usize, seed: u64) -> Points {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..count).map(|_| std::array::from_fn(|_| 2.0 * random.f32() - 1.0)).collect()
}

/// Compares the field with the f64 oracle at some of the points. Panics where it is off.
pub fn check(tree: &CheckedTree, evaluator: &Evaluator, points: &Points) {
    let mut samples = evaluator.samples();
    evaluator.eval(points, &mut samples).expect("the buffers fit");
    for index in (0..points.len()).step_by(points.len().div_ceil(200)) {
        let expected = walk(tree, points.get(index).map(f64::from)).field;
        let value = f64::from(samples.field()[index]);
        assert!((value - expected).abs() < 1e-4, "point {index}: {value}, the oracle has {expected}");
    }
}
