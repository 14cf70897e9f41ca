//! What leaves are made with: skeletons that grow to be a solid, formulas in frames, and checks of numbers.

use glam::{DAffine3, DMat3, DVec3};
use jbt_model::affine::map_bounds;
use jbt_model::bounds::Bounds;
use jbt_model::falloff::Falloff;
use jbt_model::skeleton::Skeleton;
use jbt_model::term::Term;
use jbt_model::tree::Tree;
use jbt_model::written::{Radius, Written, as_written};

/// Lengths and places between which models stay within the limits of numbers.
const SMALLEST: f64 = 1e-12;
pub(super) const LARGEST: f64 = 1e12;

/// How leaves are written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in super::super) enum LeafStyle {
    /// Each as short as it can be.
    Plain,
    /// With one formula for as many kinds as possible: see [`parts`].
    Alike,
}

/// A solid as a tree.
#[derive(Clone)]
pub(in super::super) struct SolidLeaf {
    pub(in super::super) tree: Tree,
    /// A box around the solid, without the space around it where its field goes on.
    pub(in super::super) bounds: Bounds,
    /// How many nodes the tree has.
    pub(in super::super) nodes: usize,
    /// Whether it has a radius that belongs to no vector, so that BRL-CAD scales it by other rules.
    pub(in super::super) has_radius: bool,
}

/// Why numbers are no solid, in words.
pub(in super::super) type Flaw = String;

/// A skeleton that grows by a radius to be the solid.
pub(super) fn grown(skeleton: impl Into<Skeleton>, radius: f64) -> Tree {
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
pub(super) fn formula(inside: Term, within: Bounds, frame: &DAffine3) -> Tree {
    let tree = Tree::expression_within(inside.max(0.0), within.low(), within.high());
    Tree::new(*frame, vec![tree])
}

/// A leaf that is a formula in a frame; `bounds` is about the solid in its frame.
pub(super) fn framed(inside: Term, within: Bounds, frame: &DAffine3, bounds: Bounds) -> SolidLeaf {
    let bounds = map_bounds(frame, bounds);
    SolidLeaf { tree: formula(inside, within, frame), bounds, nodes: 2, has_radius: true }
}

/// The smallest of several.
pub(super) fn least<const N: usize>(terms: [Term; N]) -> Term {
    let mut terms = terms.into_iter();
    let first = terms.next().unwrap_or_else(|| Term::from(0.0));
    terms.fold(first, |least, term| least.min(term))
}

/// The root of the sum of two squares.
pub(super) fn length(a: &Term, b: &Term) -> Term {
    (a.square() + b.square()).sqrt()
}

/// A box that reaches as far to both sides.
pub(super) fn centered(half: [f64; 3]) -> Bounds {
    let half = DVec3::from_array(half);
    Bounds::new(-half, half)
}

/// A length, which is above 0.
pub(super) fn positive(name: &str, length: f64) -> Result<f64, Flaw> {
    if length > SMALLEST { Ok(length) } else { Err(format!("`{name}` is {length}")) }
}

/// A direction and its length.
pub(super) fn direction(name: &str, vector: DVec3) -> Result<(DVec3, f64), Flaw> {
    let length = vector.length();
    if length > SMALLEST {
        Ok((vector / length, length))
    } else {
        Err(format!("the vector `{name}` has length {length}"))
    }
}

/// A right-handed frame of unit vectors whose last axis is given.
pub(super) fn upright(z: DVec3) -> [DVec3; 3] {
    let (x, y) = z.any_orthonormal_pair();
    [x, y, z]
}

/// The map from a frame of three columns.
pub(super) fn frame(origin: DVec3, columns: [DVec3; 3]) -> Result<DAffine3, Flaw> {
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
