//! Skeletons: the sets that primitives measure their distance to. One file per member, one list.
//!
//! A file has the same parts in the same order: what the skeleton is, its parameters, its text fields, its bounds, the plain
//! formula in f64 (the oracle), its pose and the same formula over [`Domain`] (the compiler), tests. To add one: write its file, add its
//! line to the list below.
//!
//! The plain formula sees the skeleton where it is. The compiler's form sees it in its **pose**: about the origin, along the z axis. A row
//! brings the point there, by the one matrix that it often needs anyway, and the formula has no directions left: a cylinder's
//! distance is made of `|z|` and `sqrt(x^2 + y^2)`.

use glam::{DAffine3, DMat3, DVec3};
use jbt_ir::Domain;

use crate::bounds::Bounds;
use crate::field::{Field, FieldValue, Member};

/// What a skeleton states about itself.
///
/// Coordinates are those of the primitive's own space. The squared distance is Euclidean.
pub trait SkeletonMember: Member {
    /// Names of the columns that [`columns`](Self::columns) fills, in order.
    const COLUMNS: &'static [&'static str];

    /// Its symmetry in its pose.
    const SYMMETRY: Symmetry;

    /// The smallest box that holds the image of the skeleton itself (not the support of its field) under a map.
    fn bounds_under(&self, map: &DAffine3) -> Bounds;

    /// The squared distance from `p`, plainly.
    fn distance_squared(&self, p: DVec3) -> f64;

    /// How far `p` is from where the gradient of the squared distance jumps; infinity if it never does.
    fn decision(&self, p: DVec3) -> f64;

    /// The rigid motion from the pose to where the skeleton is.
    fn pose(&self) -> DAffine3;

    /// The numbers of a row, derived from the parameters in f64: one for each of [`COLUMNS`](Self::COLUMNS). They are lengths,
    /// of a skeleton that is `scale` times as large.
    fn columns(&self, scale: f64, row: &mut Vec<f64>);

    /// The squared distance from `p`, over the ops, of the skeleton in its pose; `row` holds the columns.
    ///
    /// In f32, with columns rounded once, its square root is off by at most [`ROUNDING`] of the distance and the largest coordinate of
    /// the skeleton together (and by 2^-73, where squares fall below the smallest numbers): supports rest on it.
    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real;
}

/// The rounding that [`SkeletonMember::emit`] may have: 64 units in the last place.
///
/// A column is off by half a unit of what it holds. A difference of a coordinate and a length adds half a unit of both, a sum of two
/// squares and its root less than two of the result: a cylinder, with two such terms, stays below 8 units, a box below 8. The sides of
/// a triangle take two products and a sum, of numbers that are off themselves, so both its terms are off by up to 12 units of
/// coordinates that are up to 1.5 times as large; and near a corner the test of what is inside may be off by three times as much.
pub const ROUNDING: f64 = 64.0 / (1 << 24) as f64;

/// Which rotations a skeleton in its pose does not feel: they need not be done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Symmetry {
    /// All.
    Ball,
    /// Those about the z axis, and turning it round.
    Axis,
    /// None.
    None,
}

impl Symmetry {
    /// A rotation (or reflection) that does the same to such a skeleton as `turn`; the identity, if that will do.
    #[must_use]
    pub fn simplest(self, turn: DMat3) -> DMat3 {
        let simplest = match self {
            Self::Ball => DMat3::IDENTITY,
            Self::Axis => along(turn.z_axis),
            Self::None => turn,
        };
        if simplest.abs_diff_eq(DMat3::IDENTITY, 1e-12) { DMat3::IDENTITY } else { simplest }
    }
}

macro_rules! skeletons {
    ($($module:ident :: $name:ident),+ $(,)?) => {
        $( mod $module; pub use $module::$name; )+

        /// A skeleton of any kind.
        #[derive(Clone, PartialEq, Debug)]
        pub enum Skeleton { $( #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")] $name($name), )+ }

        /// The kind of a skeleton: what selects code.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, PartialOrd, Ord)]
        pub enum SkeletonKind { $( #[doc = concat!("See [`", stringify!($name), "`](struct@", stringify!($name), ").")] $name, )+ }

        $( impl From<$name> for Skeleton { fn from(skeleton: $name) -> Self { Self::$name(skeleton) } } )+

        impl SkeletonKind {
            /// Every kind, in the order of the list.
            pub const ALL: &'static [Self] = &[ $( Self::$name, )+ ];

            /// The word of the text format.
            #[must_use]
            pub const fn name(self) -> &'static str { match self { $( Self::$name => $name::NAME, )+ } }

            /// The parameters.
            #[must_use]
            pub const fn fields(self) -> &'static [Field] { match self { $( Self::$name => $name::FIELDS, )+ } }

            /// The names of the columns of a row.
            #[must_use]
            pub const fn columns(self) -> &'static [&'static str] { match self { $( Self::$name => $name::COLUMNS, )+ } }

            /// The skeleton of this kind with these parameters.
            #[must_use]
            pub fn from_fields(self, values: &[FieldValue]) -> Skeleton {
                match self { $( Self::$name => Skeleton::$name($name::from_fields(values)), )+ }
            }

            /// See [`SkeletonMember::SYMMETRY`].
            #[must_use]
            pub const fn symmetry(self) -> Symmetry { match self { $( Self::$name => $name::SYMMETRY, )+ } }

            /// The squared distance over the ops, in the pose.
            pub fn emit<D: Domain>(self, d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
                match self { $( Self::$name => $name::emit(d, p, row), )+ }
            }
        }

        impl Skeleton {
            /// The kind.
            #[must_use]
            pub const fn kind(&self) -> SkeletonKind { match self { $( Self::$name(_) => SkeletonKind::$name, )+ } }

            /// The parameters, in the order of [`SkeletonKind::fields`].
            #[must_use]
            pub fn to_fields(&self) -> Vec<FieldValue> { match self { $( Self::$name(s) => s.to_fields(), )+ } }

            /// The smallest box that holds the skeleton itself (not the support of its field).
            #[must_use]
            pub fn bounds(&self) -> Bounds { self.bounds_under(&DAffine3::IDENTITY) }

            /// See [`SkeletonMember::bounds_under`].
            #[must_use]
            pub fn bounds_under(&self, map: &DAffine3) -> Bounds { match self { $( Self::$name(s) => s.bounds_under(map), )+ } }

            /// See [`SkeletonMember::distance_squared`].
            #[must_use]
            pub fn distance_squared(&self, p: DVec3) -> f64 { match self { $( Self::$name(s) => s.distance_squared(p), )+ } }

            /// See [`SkeletonMember::decision`].
            #[must_use]
            pub fn decision(&self, p: DVec3) -> f64 { match self { $( Self::$name(s) => s.decision(p), )+ } }

            /// See [`SkeletonMember::pose`].
            #[must_use]
            pub fn pose(&self) -> DAffine3 { match self { $( Self::$name(s) => s.pose(), )+ } }

            /// See [`SkeletonMember::columns`].
            pub fn columns(&self, scale: f64, row: &mut Vec<f64>) {
                match self { $( Self::$name(s) => s.columns(scale, row), )+ }
            }
        }
    };
}

skeletons! {
    point::Point,
    segment::Segment,
    disc::Disc,
    ring::Ring,
    cylinder::Cylinder,
    r#box::Box,
    triangle::Triangle,
}

#[cfg(test)]
mod testing;

/// `v` with length 1, whatever its length was; zero stays zero.
fn unit(v: DVec3) -> DVec3 {
    let size = v.abs().max_element();
    if size == 0.0 { DVec3::ZERO } else { (v / size).normalize() }
}

/// Height along the unit vector `n`, and distance from its line.
fn cylindrical(v: DVec3, n: DVec3) -> (f64, f64) {
    let h = v.dot(n);
    (h, (v - h * n).length())
}

/// How far the image of a circle about the unit vector `n` reaches along each axis.
fn circle_reach(map: &DAffine3, n: DVec3, radius: f64) -> DVec3 {
    // Along a row of the matrix the circle reaches as far as that row is long in the circle's plane.
    radius * DVec3::from_array([0, 1, 2].map(|axis| map.matrix3.row(axis).cross(n).length()))
}

/// The rotation that takes the z axis to the direction of `v`, or against it: the identity if it need not move, or if `v` is zero.
fn along(v: DVec3) -> DMat3 {
    let z = unit(v);
    if z == DVec3::ZERO || z.z.abs() == 1.0 {
        return DMat3::IDENTITY;
    }
    let (x, y) = z.any_orthonormal_pair();
    DMat3::from_cols(x, y, z)
}

/// The distance from the z axis.
fn emit_off_axis<D: Domain>(d: &mut D, p: [D::Real; 3]) -> D::Real {
    let square = sum_of_squares(d, p[0], p[1]);
    d.sqrt(square)
}

/// How far `x` is outside of `[-half, half]`: `max(|x| - half, 0)`.
fn beyond<D: Domain>(d: &mut D, x: D::Real, half: D::Real) -> D::Real {
    let size = d.abs(x);
    let past = d.sub(size, half);
    positive_part(d, past)
}

/// `a^2 + b^2`, with one fused step.
fn sum_of_squares<D: Domain>(d: &mut D, a: D::Real, b: D::Real) -> D::Real {
    let square = d.mul(a, a);
    d.fma(b, b, square)
}

/// `|v|^2`, with two fused steps.
pub(crate) fn length_squared<D: Domain>(d: &mut D, [x, y, z]: [D::Real; 3]) -> D::Real {
    let square = sum_of_squares(d, x, y);
    d.fma(z, z, square)
}

/// `max(x, 0)`: zero for NaN, and never -0.
pub(crate) fn positive_part<D: Domain>(d: &mut D, x: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    d.max(x, zero)
}
