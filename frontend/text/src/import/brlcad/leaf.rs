//! Solids as leaves of a tree, each exactly the set of points that its numbers mean.
//!
//! ```text
//! field = max(0, 1/2 - d / 2s)       d <= 0 inside; s is about half the thickness of the solid
//! ```
//!
//! So the field of a solid is 1/2 on its surface, about 1 in its middle, and 0 at the distance s from it.
//! Where a skeleton with the falloff `linear` is the solid, it is that skeleton; else the solid is a formula
//! in a frame of its own, in which its parameters are 1, under the affine map of the frame. Solids of one kind
//! have one formula, so they are rows of one table.

mod block;
mod cone;
mod metaball;
mod parts;
mod pipe;
mod quadric;
mod round;

use glam::{DAffine3, DMat3, DVec3};
use jbt_model::affine::map_bounds;
use jbt_model::bounds::Bounds;
use jbt_model::falloff::Falloff;
use jbt_model::skeleton::Skeleton;
use jbt_model::term::Term;
use jbt_model::tree::Tree;
use jbt_model::written::{Radius, Written, as_written};

use super::solid::{Solid, SolidKind};

/// Lengths and places between which models stay within the limits of numbers.
const SMALLEST: f64 = 1e-12;
const LARGEST: f64 = 1e12;

/// How leaves are written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum LeafStyle {
    /// Each as short as it can be.
    Plain,
    /// With one formula for as many kinds as possible: see [`parts`].
    Alike,
}

/// A solid as a tree.
#[derive(Clone)]
pub(super) struct Leaf {
    pub(super) tree: Tree,
    /// A box around the solid, without the space around it where its field goes on.
    pub(super) bounds: Bounds,
    /// How many nodes the tree has.
    pub(super) nodes: usize,
    /// Whether it has a radius that belongs to no vector, so that BRL-CAD scales it by other rules.
    pub(super) has_radius: bool,
}

/// Why numbers are no solid, in words.
pub(super) type Flaw = String;

/// The leaf of a solid; `reach` is about the size of the model, which gives half spaces a thickness.
pub(super) fn leaf(solid: &Solid, reach: f64, style: LeafStyle) -> Result<Leaf, Flaw> {
    let n = &solid.numbers[..];
    if let Some(large) = n.iter().find(|number| number.abs() > LARGEST) {
        return Err(format!("one of its numbers is {large}"));
    }
    let v = |at: usize| DVec3::new(n[3 * at], n[3 * at + 1], n[3 * at + 2]);
    match solid.kind {
        SolidKind::Ellipsoid => round::ellipsoid(v(0), [v(1), v(2), v(3)], style),
        SolidKind::Superellipsoid => round::superellipsoid(v(0), [v(1), v(2), v(3)], [n[12], n[13]]),
        SolidKind::Torus => round::torus(v(0), v(1), [n[6], n[7]], style),
        SolidKind::EllipticalTorus => round::elliptical_torus(v(0), v(1), v(2), [n[9], n[10]], style),
        SolidKind::Particle => round::particle(v(0), v(1), n[6], n[7]),
        SolidKind::Cone => cone::cone(v(0), v(1), [[v(2), v(3)], [v(4), v(5)]], style),
        SolidKind::Block => block::block(&[0, 1, 2, 3, 4, 5, 6, 7].map(v), style),
        SolidKind::Half => block::half(v(0), n[3], reach),
        SolidKind::Planes => block::planes(n.as_chunks().0, reach),
        SolidKind::ParabolicCylinder => quadric::parabolic_cylinder(v(0), v(1), v(2), n[9]),
        SolidKind::HyperbolicCylinder => quadric::hyperbolic_cylinder(v(0), v(1), v(2), n[9], n[10]),
        SolidKind::Paraboloid => quadric::paraboloid(v(0), v(1), v(2), [n[9], n[10]]),
        SolidKind::Hyperboloid => quadric::hyperboloid(v(0), v(1), v(2), [n[9], n[10], n[11]], style),
        SolidKind::Waist => quadric::waist(v(0), v(1), v(2), n[9], n[10]),
        SolidKind::Pipe => pipe::pipe(n.as_chunks().0, style),
        SolidKind::Metaball => metaball::metaball(n[0], n[1], n[2..].as_chunks().0),
    }
}

/// A skeleton that grows by a radius to be the solid.
fn grown(skeleton: impl Into<Skeleton>, radius: f64) -> Tree {
    let skeleton = skeleton.into();
    let written = Written::Primitive {
        skeleton: skeleton.kind(),
        fields: as_written(skeleton.to_fields()),
        falloff: Falloff::Linear.into(),
        radius: Radius::Surface(radius.into()),
        strength: 1.0.into(),
    };
    Tree::new(written, Vec::new())
}

/// The formula of a solid: `inside` is above 1/2 in it. The field ends at a box in its frame.
fn formula(inside: Term, within: Bounds, frame: &DAffine3) -> Tree {
    let tree = Tree::expression_within(inside.max(0.0), within.low(), within.high());
    Tree::new(*frame, vec![tree])
}

/// A leaf that is a formula in a frame; `bounds` is about the solid in its frame.
fn framed(inside: Term, within: Bounds, frame: &DAffine3, bounds: Bounds) -> Leaf {
    let bounds = map_bounds(frame, bounds);
    Leaf { tree: formula(inside, within, frame), bounds, nodes: 2, has_radius: true }
}

/// The smallest of several.
fn least<const N: usize>(terms: [Term; N]) -> Term {
    let mut terms = terms.into_iter();
    let first = terms.next().unwrap_or_else(|| Term::from(0.0));
    terms.fold(first, |least, term| least.min(term))
}

/// The root of the sum of two squares.
fn length(a: &Term, b: &Term) -> Term {
    (a.square() + b.square()).sqrt()
}

/// A box that reaches as far to both sides.
fn centered(half: [f64; 3]) -> Bounds {
    let half = DVec3::from_array(half);
    Bounds::new(-half, half)
}

/// A length, which is above 0.
fn positive(name: &str, length: f64) -> Result<f64, Flaw> {
    if length > SMALLEST { Ok(length) } else { Err(format!("`{name}` is {length}")) }
}

/// A direction and its length.
fn direction(name: &str, vector: DVec3) -> Result<(DVec3, f64), Flaw> {
    let length = vector.length();
    if length > SMALLEST {
        Ok((vector / length, length))
    } else {
        Err(format!("the vector `{name}` has length {length}"))
    }
}

/// A right-handed frame of unit vectors whose last axis is given.
fn upright(z: DVec3) -> [DVec3; 3] {
    let (x, y) = z.any_orthonormal_pair();
    [x, y, z]
}

/// The map from a frame of three columns.
fn frame(origin: DVec3, columns: [DVec3; 3]) -> Result<DAffine3, Flaw> {
    let [x, y, z] = columns;
    let matrix = DMat3::from_cols(x, y, z);
    let volume = x.length() * y.length() * z.length();
    // Vectors so nearly in one plane are none that somebody meant.
    if matrix.determinant().abs() > 1e-9 * volume {
        Ok(DAffine3 { matrix3: matrix, translation: origin })
    } else {
        Err("its vectors are in one plane".to_owned())
    }
}
