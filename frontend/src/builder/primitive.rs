//! Constructors of primitives, one for each skeleton.

use super::{Number, Vector, real, vector};
use crate::falloff::Falloff;
use crate::recipe::{FieldNumber, Radius, Recipe};
use crate::skeleton::{Skeleton, SkeletonKind};
use crate::tree::{NodeKind, Primitive, Tree};

/// A primitive of strength 1 with the soft object's falloff; `radius` is where its field reaches zero.
#[must_use]
pub fn primitive(skeleton: impl Into<Skeleton>, radius: impl Into<Number>) -> Tree {
    let (skeleton, radius) = (skeleton.into(), radius.into());
    if radius.follows() {
        let fields = skeleton.to_fields().into_iter().map(FieldNumber::from).collect();
        return leaf(skeleton.kind(), fields, radius);
    }
    let leaf = Primitive { skeleton, falloff: Falloff::Soft, radius: radius.value(), strength: 1.0 };
    Tree::new(NodeKind::Primitive(leaf), Vec::new())
}

/// A primitive whose skeleton's parameters may follow those of the model.
fn leaf(skeleton: SkeletonKind, fields: Vec<FieldNumber>, radius: impl Into<Number>) -> Tree {
    let (falloff, radius) = (Falloff::Soft.into(), Radius::Support(radius.into()));
    let recipe = Recipe::Primitive { skeleton, fields, falloff, radius, strength: 1.0.into() };
    Tree::of(recipe, Vec::new())
}

/// A ball around a point.
#[must_use]
pub fn point(at: impl Into<Vector>, radius: impl Into<Number>) -> Tree {
    leaf(SkeletonKind::Point, vec![vector(at)], radius)
}

/// A capsule around the line between two points.
#[must_use]
pub fn segment(from: impl Into<Vector>, to: impl Into<Vector>, radius: impl Into<Number>) -> Tree {
    leaf(SkeletonKind::Segment, vec![vector(from), vector(to)], radius)
}

/// A field around a filled circle of radius `disc_radius` that faces along `normal`.
#[must_use]
pub fn disc(
    center: impl Into<Vector>,
    normal: impl Into<Vector>,
    disc_radius: impl Into<Number>,
    radius: impl Into<Number>,
) -> Tree {
    leaf(SkeletonKind::Disc, vec![vector(center), vector(normal), real(disc_radius)], radius)
}

/// A torus: a field around a circle of radius `ring_radius` about the axis `normal`.
#[must_use]
pub fn ring(
    center: impl Into<Vector>,
    normal: impl Into<Vector>,
    ring_radius: impl Into<Number>,
    radius: impl Into<Number>,
) -> Tree {
    leaf(SkeletonKind::Ring, vec![vector(center), vector(normal), real(ring_radius)], radius)
}

/// A field around a solid cylinder between two end points of its axis.
#[must_use]
pub fn cylinder(
    from: impl Into<Vector>,
    to: impl Into<Vector>,
    cylinder_radius: impl Into<Number>,
    radius: impl Into<Number>,
) -> Tree {
    leaf(SkeletonKind::Cylinder, vec![vector(from), vector(to), real(cylinder_radius)], radius)
}

/// A field around a solid box along the axes; `half` are half its sides.
#[must_use]
pub fn cuboid(center: impl Into<Vector>, half: impl Into<Vector>, radius: impl Into<Number>) -> Tree {
    leaf(SkeletonKind::Box, vec![vector(center), vector(half)], radius)
}

/// A field around a filled triangle.
#[must_use]
pub fn triangle(
    a: impl Into<Vector>,
    b: impl Into<Vector>,
    c: impl Into<Vector>,
    radius: impl Into<Number>,
) -> Tree {
    leaf(SkeletonKind::Triangle, vec![vector(a), vector(b), vector(c)], radius)
}

/// The lines from point to point, at least two. [`Tree::closed`] joins the last to the first; [`Tree::radii`] makes it a tube.
#[must_use]
pub fn polyline(points: impl IntoIterator<Item = impl Into<Vector>>, radius: impl Into<Number>) -> Tree {
    leaf(SkeletonKind::Polyline, vec![vectors(points), reals(), real(0.0)], radius)
}

/// A field around a filled polygon between at least three corners in a plane; it may be concave.
#[must_use]
pub fn polygon(points: impl IntoIterator<Item = impl Into<Vector>>, radius: impl Into<Number>) -> Tree {
    leaf(SkeletonKind::Polygon, vec![vectors(points)], radius)
}

/// A chain of cubic Bezier curves: four points, and three more for each further curve. [`Tree::radii`] makes it a tube.
#[must_use]
pub fn bezier(points: impl IntoIterator<Item = impl Into<Vector>>, radius: impl Into<Number>) -> Tree {
    leaf(SkeletonKind::Bezier, vec![vectors(points), reals()], radius)
}

/// A smooth curve through at least two points. [`Tree::closed`] leads it back to the first; [`Tree::radii`] makes it a tube.
#[must_use]
pub fn catmull_rom(points: impl IntoIterator<Item = impl Into<Vector>>, radius: impl Into<Number>) -> Tree {
    leaf(SkeletonKind::CatmullRom, vec![vectors(points), reals(), real(0.0)], radius)
}

fn vectors(points: impl IntoIterator<Item = impl Into<Vector>>) -> FieldNumber {
    FieldNumber::Vectors(points.into_iter().map(|point| point.into().0).collect())
}

/// No numbers.
fn reals() -> FieldNumber {
    FieldNumber::Reals(Vec::new())
}

/// A field around a solid ball of radius `sphere_radius`.
#[must_use]
pub fn sphere(
    center: impl Into<Vector>,
    sphere_radius: impl Into<Number>,
    radius: impl Into<Number>,
) -> Tree {
    leaf(SkeletonKind::Sphere, vec![vector(center), real(sphere_radius)], radius)
}

/// A field around a solid torus: a tube of radius `tube_radius` around a circle of radius `ring_radius` about the axis `normal`.
#[must_use]
pub fn torus(
    center: impl Into<Vector>,
    normal: impl Into<Vector>,
    ring_radius: impl Into<Number>,
    tube_radius: impl Into<Number>,
    radius: impl Into<Number>,
) -> Tree {
    let fields = vec![vector(center), vector(normal), real(ring_radius), real(tube_radius)];
    leaf(SkeletonKind::Torus, fields, radius)
}

/// A field around a solid cone with flat ends, each with its radius; one of 0 is a tip.
#[must_use]
pub fn cone(
    from: impl Into<Vector>,
    to: impl Into<Vector>,
    from_radius: impl Into<Number>,
    to_radius: impl Into<Number>,
    radius: impl Into<Number>,
) -> Tree {
    let fields = vec![vector(from), vector(to), real(from_radius), real(to_radius)];
    leaf(SkeletonKind::Cone, fields, radius)
}

/// A field around the hull of two balls: a capsule with two radii.
#[must_use]
pub fn round_cone(
    from: impl Into<Vector>,
    to: impl Into<Vector>,
    from_radius: impl Into<Number>,
    to_radius: impl Into<Number>,
    radius: impl Into<Number>,
) -> Tree {
    let fields = vec![vector(from), vector(to), real(from_radius), real(to_radius)];
    leaf(SkeletonKind::RoundCone, fields, radius)
}

/// A field around a filled rectangle that faces along `normal`; `half` are half its sides, along `along` and across it.
#[must_use]
pub fn rectangle<T: Into<Number>>(
    center: impl Into<Vector>,
    normal: impl Into<Vector>,
    along: impl Into<Vector>,
    half: [T; 2],
    radius: impl Into<Number>,
) -> Tree {
    let [half_length, half_width] = half.map(real);
    let fields = vec![vector(center), vector(normal), vector(along), half_length, half_width];
    leaf(SkeletonKind::Rectangle, fields, radius)
}

/// A field around a part of a circle of radius `arc_radius` about the axis `normal`: from the direction `start` on, counterclockwise by
/// up to 360 degrees.
#[must_use]
pub fn arc(
    center: impl Into<Vector>,
    normal: impl Into<Vector>,
    start: impl Into<Vector>,
    degrees: impl Into<Number>,
    arc_radius: impl Into<Number>,
    radius: impl Into<Number>,
) -> Tree {
    let fields = vec![vector(center), vector(normal), vector(start), real(degrees), real(arc_radius)];
    leaf(SkeletonKind::Arc, fields, radius)
}

/// A field around a screw line about the axis `normal`, whose middle is `center`: from the direction `start` on it rises by `pitch` in each of its
/// turns, counterclockwise; below 0 it falls. The `size` has `helix_radius`, `pitch` and `turns`.
#[must_use]
pub fn helix<T: Into<Number>>(
    center: impl Into<Vector>,
    normal: impl Into<Vector>,
    start: impl Into<Vector>,
    size: [T; 3],
    radius: impl Into<Number>,
) -> Tree {
    let [helix_radius, pitch, turns] = size.map(real);
    let fields = vec![vector(center), vector(normal), vector(start), helix_radius, pitch, turns];
    leaf(SkeletonKind::Helix, fields, radius)
}

/// A field around all that is behind the plane through `at`; `normal` points out of it. It is unbounded: cut it with something, or give a region.
#[must_use]
pub fn half_space(at: impl Into<Vector>, normal: impl Into<Vector>, radius: impl Into<Number>) -> Tree {
    leaf(SkeletonKind::HalfSpace, vec![vector(at), vector(normal)], radius)
}

/// An ellipsoid: a ball around a point, `stretch` times as large along each axis.
#[must_use]
pub fn ellipsoid(center: impl Into<Vector>, stretch: impl Into<Vector>, radius: impl Into<Number>) -> Tree {
    leaf(SkeletonKind::Ellipsoid, vec![vector(center), vector(stretch)], radius)
}

/// The ball of another norm, whose exponent is from 1 (an octahedron) over 2 (a ball) to 1024 (a cube), `stretch` times as large along each axis.
#[must_use]
pub fn lmetric(
    center: impl Into<Vector>,
    exponent: impl Into<Number>,
    stretch: impl Into<Vector>,
    radius: impl Into<Number>,
) -> Tree {
    leaf(SkeletonKind::LMetric, vec![vector(center), real(exponent), vector(stretch)], radius)
}

/// A superquadric with Barr's exponents, that of the profile along z and that of the slices across it: towards 0 square, 1 round, 2 faceted. It is
/// `stretch` times as large along each axis.
#[must_use]
pub fn superquadric<T: Into<Number>>(
    center: impl Into<Vector>,
    exponents: [T; 2],
    stretch: impl Into<Vector>,
    radius: impl Into<Number>,
) -> Tree {
    let [e1, e2] = exponents.map(real);
    leaf(SkeletonKind::Superquadric, vec![vector(center), e1, e2, vector(stretch)], radius)
}
