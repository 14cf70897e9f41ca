//! Models and points that benches ask about.

use jbt::{Model, Points};
use jbt_frontend::check::CheckedTree;
use jbt_frontend::combine::Combinator;
use jbt_frontend::falloff::Falloff;
use jbt_frontend::skeleton::Point;
use jbt_frontend::tree::{NodeKind, Primitive, Tree};

/// A soft-object point (Wyvill, McPheeters and Wyvill 1986) with a colour. Its numbers are f32, so that every contestant is given the same.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Blob {
    /// Where it is.
    pub center: [f32; 3],
    /// Where its field reaches zero.
    pub radius: f32,
    /// Red, green, blue.
    pub color: [f32; 3],
}

/// Where the surface of a sum of blobs is.
pub const ISO: f32 = 0.5;

/// Blobs in a cube: centres uniform in [-0.9, 0.9]^3, radii `1.6 count^(-1/3) (0.5 + uniform)`, so that about as many
/// overlap at any count.
#[must_use]
pub fn blobs(count: usize, seed: u64) -> Vec<Blob> {
    scaled_blobs(count, 1.0, seed)
}

/// As [`blobs`], with radii times `scale`: `scale^3` times as many overlap.
#[must_use]
pub fn scaled_blobs(count: usize, scale: f64, seed: u64) -> Vec<Blob> {
    let mut random = fastrand::Rng::with_seed(seed);
    let size = scale * 1.6 * (count as f64).powf(-1.0 / 3.0);
    let blob = |_| Blob {
        center: std::array::from_fn(|_| (1.8 * random.f64() - 0.9) as f32),
        radius: (size * (0.5 + random.f64())) as f32,
        color: std::array::from_fn(|_| random.f32()),
    };
    (0..count).map(blob).collect()
}

/// The sum of blobs as a BlobTree.
#[must_use]
pub fn tree(blobs: &[Blob]) -> CheckedTree {
    let leaf = |blob: &Blob| {
        let primitive = Primitive {
            skeleton: Point { at: blob.center.map(f64::from).into() }.into(),
            falloff: Falloff::Soft,
            radius: f64::from(blob.radius),
            strength: 1.0,
        };
        let leaf = Tree::new(NodeKind::Primitive(primitive), Vec::new());
        let values = blob.color.map(f64::from).to_vec();
        Tree::new(NodeKind::Attribute { name: "color".into(), values }, vec![leaf])
    };
    let tree = Tree::new(NodeKind::Combine(Combinator::Sum), blobs.iter().map(leaf).collect());
    Model::new(tree).check().expect("blobs are a good model")
}

/// Points uniform in [-1, 1]^3.
#[must_use]
pub fn cube(count: usize, seed: u64) -> Points {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..count).map(|_| std::array::from_fn(|_| 2.0 * random.f32() - 1.0)).collect()
}
