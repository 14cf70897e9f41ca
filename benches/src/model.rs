//! Models and points that benches ask about.

use jbt::internals::model::skeleton::{Cuboid, Cylinder, Disc, Point, Ring, Segment, Skeleton, Triangle};
use jbt::tree::Precedence;
use jbt::tree::{NodeKind, Primitive};
use jbt::{CheckedTree, Falloff, Model, Points, Tree, build, text};

/// A soft-object point (Wyvill, McPheeters and Wyvill 1986) with a colour. Its numbers are f32, so that every
/// contestant is given the same.
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

/// Blobs in a cube: centres uniform in [-0.9, 0.9]^3, radii `1.6 count^(-1/3) (0.5 + uniform)`, so that about
/// as many overlap at any count.
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

/// About `count` particles of one size in a ball about the origin, on a jittered grid: what a fluid
/// simulation hands over. Every one's field reaches two grid steps, and all fields end within [-1, 1]^3.
#[must_use]
pub fn particles(count: usize, seed: u64) -> Vec<Blob> {
    let mut random = fastrand::Rng::with_seed(seed);
    // A ball of radius r has 4/3 pi (r / step)^3 places; the outermost fields end two and a half steps
    // further out.
    let steps = (count as f64 * 0.75 / std::f64::consts::PI).cbrt();
    let step = 1.0 / (steps + 2.5);
    let reach = steps.ceil() as i32;
    let mut particles = Vec::with_capacity(count);
    for (i, j, k) in (-reach..=reach)
        .flat_map(|k| (-reach..=reach).flat_map(move |j| (-reach..=reach).map(move |i| (i, j, k))))
    {
        let place = [i, j, k].map(f64::from);
        if place.iter().map(|x| x * x).sum::<f64>() <= steps * steps {
            particles.push(Blob {
                center: place.map(|x| (step * (x + 0.4 * (random.f64() - 0.5))) as f32),
                radius: (2.0 * step) as f32,
                color: std::array::from_fn(|_| random.f32()),
            });
        }
    }
    particles
}

/// A blob as a tree.
#[must_use]
pub fn leaf(blob: &Blob) -> Tree {
    let primitive = Primitive {
        skeleton: Point { at: blob.center.map(f64::from).into() }.into(),
        falloff: Falloff::Soft,
        radius: f64::from(blob.radius),
        strength: 1.0,
    };
    let leaf = Tree::new(NodeKind::Primitive(primitive), Vec::new());
    let values = blob.color.map(f64::from).to_vec();
    Tree::new(
        NodeKind::Attribute { name: "color".into(), value: values.into(), precedence: Precedence::Nearest },
        vec![leaf],
    )
}

/// The sum of blobs as a BlobTree.
#[must_use]
pub fn tree(blobs: &[Blob]) -> CheckedTree {
    let tree = Tree::sum(blobs.iter().map(leaf));
    Model::new(tree).check().expect("blobs are a good model")
}

/// The same sum as one node of particles: what somebody says who has arrays.
#[must_use]
pub fn cloud(blobs: &[Blob]) -> CheckedTree {
    let positions: Vec<[f32; 3]> = blobs.iter().map(|blob| blob.center).collect();
    let radii: Vec<f32> = blobs.iter().map(|blob| blob.radius).collect();
    let colors: Vec<[f32; 3]> = blobs.iter().map(|blob| blob.color).collect();
    let cloud = build::particles(positions, radii).colors(colors);
    Model::new(cloud).check().expect("blobs are a good model")
}

/// Points uniform in [-1, 1]^3.
#[must_use]
pub fn cube(count: usize, seed: u64) -> Points {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..count).map(|_| std::array::from_fn(|_| 2.0 * random.f32() - 1.0)).collect()
}

/// The bundled octopus: one twisted tentacle in eight places, 80 primitives.
pub const HERO: &str = include_str!("../../examples/hero.jbt");
/// The bundled goblet: every skeleton once.
pub const GOBLET: &str = include_str!("../../examples/goblet.jbt");

/// A bundled scene.
#[must_use]
pub fn example(scene: &str) -> CheckedTree {
    let model = text::parse(scene.as_bytes(), &text::Options::default()).expect("bundled scenes read");
    model.check().expect("bundled scenes are good models")
}

/// The most shapes of [`varied`].
pub const MAX_SHAPES: usize = 28;

/// A sum of `count` coloured primitives of `shapes` different shapes, from 1 to [`MAX_SHAPES`]: of seven
/// skeletons with two falloffs, plain and with a strength. They are about as large, and overlap about as
/// much, as [`blobs`].
#[must_use]
pub fn varied(count: usize, shapes: usize, seed: u64) -> CheckedTree {
    assert!((1..=MAX_SHAPES).contains(&shapes), "there are {MAX_SHAPES} shapes");
    let leaf = |(index, blob): (usize, &Blob)| {
        let shape = index % shapes;
        let primitive = Primitive {
            skeleton: skeleton(shape % 7, blob),
            falloff: [Falloff::Soft, Falloff::Wyvill][shape / 7 % 2],
            radius: f64::from(blob.radius),
            strength: if shape < 14 { 1.0 } else { 0.75 },
        };
        let leaf = Tree::new(NodeKind::Primitive(primitive), Vec::new());
        leaf.color(blob.color.map(f64::from))
    };
    let blobs = blobs(count, seed);
    let sum = Tree::sum(blobs.iter().enumerate().map(leaf));
    Model::new(sum).check().expect("primitives are a good model")
}

/// A skeleton of each kind, smaller than the support of a blob at its centre.
fn skeleton(kind: usize, blob: &Blob) -> Skeleton {
    let size = 0.3 * f64::from(blob.radius);
    let at = blob.center.map(f64::from);
    let beside = |axis: usize| {
        let mut p = at;
        p[axis] += size;
        p.into()
    };
    let (center, normal) = (at.into(), [0.6, 0.0, 0.8].into());
    match kind {
        0 => Point { at: center }.into(),
        1 => Segment { from: center, to: beside(0) }.into(),
        2 => Disc { center, normal, radius: size }.into(),
        3 => Ring { center, normal, radius: size }.into(),
        4 => Cylinder { from: center, to: beside(1), radius: 0.5 * size }.into(),
        5 => Cuboid { center, half: [size, 0.5 * size, 0.25 * size].into() }.into(),
        _ => Triangle { a: center, b: beside(0), c: beside(2) }.into(),
    }
}

/// Points uniform in the box of a model's support.
#[must_use]
pub fn inside(tree: &CheckedTree, count: usize, seed: u64) -> Points {
    let mut random = fastrand::Rng::with_seed(seed);
    let (low, high) = (tree.support().low(), tree.support().high());
    let along = |random: &mut fastrand::Rng, axis: usize| low[axis] + (high[axis] - low[axis]) * random.f64();
    (0..count).map(|_| std::array::from_fn(|axis| along(&mut random, axis) as f32)).collect()
}
