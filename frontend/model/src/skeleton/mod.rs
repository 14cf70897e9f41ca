//! Skeletons: the sets that primitives measure their distance to. One file per member, one list.
//!
//! A file has the same parts in the same order: what the skeleton is, its parameters, its bounds, the plain
//! formula in f64 (the oracle), its pose, its columns, the same formula over [`Domain`] (the compiler),
//! tests. To add one: write its file, add its line to the list below.
//!
//! The plain formula sees the skeleton in place. The compiler's form sees it in its **pose**: about the
//! origin, along the z axis. A row brings the point there with one matrix, which most rows need anyway, and
//! the formula needs no directions: a cylinder's distance uses only `|z|` and `sqrt(x^2 + y^2)`.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;
use crate::field::{Field, FieldValue};
use crate::member::Member as _;

macro_rules! skeletons {
    ($($module:ident :: $name:ident),+ $(,)?) => {
        $( mod $module; pub use $module::$name; pub(crate) use $module::describe as $module; )+

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

            /// The name of the constructor in [`builder`](crate::builder).
            #[must_use]
            pub const fn constructor(self) -> &'static str { match self { $( Self::$name => stringify!($module), )+ } }

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

            /// See [`SkeletonMember::DIVISORS`].
            #[must_use]
            pub const fn divisors(self) -> i32 { match self { $( Self::$name => $name::DIVISORS, )+ } }

            /// See [`SkeletonMember::CREASES`].
            #[must_use]
            pub const fn creases(self) -> bool { match self { $( Self::$name => $name::CREASES, )+ } }

            /// See [`SkeletonMember::SYMMETRY`].
            #[must_use]
            #[inline]
            pub const fn symmetry(self) -> Symmetry { match self { $( Self::$name => $name::SYMMETRY, )+ } }

            /// The squared distance over the ops, in the pose.
            pub fn emit<D: Domain>(self, d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
                match self { $( Self::$name => $name::emit(d, p, row), )+ }
            }

            /// See [`SkeletonMember::PIECES`].
            #[must_use]
            pub const fn pieces(self) -> Option<Pieces> { match self { $( Self::$name => $name::PIECES, )+ } }

            /// See [`SkeletonMember::begin`].
            pub fn begin<D: Domain>(self, d: &mut D, beyond: D::Real) -> Vec<D::Real> {
                match self { $( Self::$name => $name::begin(d, beyond), )+ }
            }

            /// See [`SkeletonMember::step`].
            pub fn step<D: Domain>(
                self,
                d: &mut D,
                p: [D::Real; 3],
                piece: &[D::Real],
                so_far: &[D::Real],
            ) -> Vec<D::Real> {
                match self { $( Self::$name => $name::step(d, p, piece, so_far), )+ }
            }

            /// The names of the columns for [`emit_uv`](Self::emit_uv).
            #[must_use]
            pub const fn uv_columns(self) -> &'static [&'static str] { match self { $( Self::$name => $name::UV_COLUMNS, )+ } }

            /// See [`SkeletonMember::emit_uv`].
            pub fn emit_uv<D: Domain>(self, d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 2] {
                match self { $( Self::$name => $name::emit_uv(d, p, row), )+ }
            }
        }

        impl Skeleton {
            /// The kind.
            #[must_use]
            #[inline]
            pub const fn kind(&self) -> SkeletonKind { match self { $( Self::$name(_) => SkeletonKind::$name, )+ } }

            /// The parameters, in the order of [`SkeletonKind::fields`].
            #[must_use]
            pub fn to_fields(&self) -> Vec<FieldValue> { match self { $( Self::$name(s) => s.to_fields(), )+ } }

            /// See [`SkeletonMember::metric`].
            #[must_use]
            pub fn metric(&self) -> Metric { match self { $( Self::$name(s) => s.metric(), )+ } }

            /// The smallest box that holds the skeleton itself (not the support of its field).
            #[must_use]
            pub fn bounds(&self) -> Bounds { self.bounds_under(&DAffine3::IDENTITY) }

            /// See [`SkeletonMember::bounds_under`].
            #[must_use]
            pub fn bounds_under(&self, map: &DAffine3) -> Bounds { match self { $( Self::$name(s) => s.bounds_under(map), )+ } }

            /// See [`SkeletonMember::distance_squared`].
            #[must_use]
            pub fn distance_squared(&self, p: DVec3) -> f64 { match self { $( Self::$name(s) => s.distance_squared(p), )+ } }

            /// See [`SkeletonMember::kink_distance`].
            #[must_use]
            pub fn kink_distance(&self, p: DVec3) -> f64 { match self { $( Self::$name(s) => s.kink_distance(p), )+ } }

            /// See [`SkeletonMember::pose`].
            #[must_use]
            #[inline]
            pub fn pose(&self) -> DAffine3 { match self { $( Self::$name(s) => s.pose(), )+ } }

            /// See [`SkeletonMember::columns`].
            pub fn columns(&self, scale: f64, row: &mut Vec<f64>) {
                match self { $( Self::$name(s) => s.columns(scale, row), )+ }
            }

            /// See [`SkeletonMember::pieces`].
            pub fn pieces(&self, scale: f64, reach: f64, rows: &mut Vec<f64>) {
                match self { $( Self::$name(s) => s.pieces(scale, reach, rows), )+ }
            }

            /// See [`SkeletonMember::piece_bounds_under`].
            #[must_use]
            pub fn piece_bounds_under(&self, reach: f64, map: &DAffine3) -> Vec<Bounds> {
                match self { $( Self::$name(s) => s.piece_bounds_under(reach, map), )+ }
            }

            /// See [`SkeletonMember::piece_count`].
            #[must_use]
            pub fn piece_count(&self, reach: f64, most: usize) -> usize {
                match self { $( Self::$name(s) => s.piece_count(reach, most), )+ }
            }

            /// See [`SkeletonMember::fault`].
            #[must_use]
            pub fn fault(&self) -> Option<Diagnostic> { match self { $( Self::$name(s) => s.fault(), )+ } }

            /// See [`SkeletonMember::uv`].
            #[must_use]
            pub fn uv(&self, p: DVec3) -> [f64; 2] { match self { $( Self::$name(s) => s.uv(p), )+ } }

            /// See [`SkeletonMember::uv_kink_distance`].
            #[must_use]
            pub fn uv_kink_distance(&self, p: DVec3) -> f64 { match self { $( Self::$name(s) => s.uv_kink_distance(p), )+ } }

            /// See [`SkeletonMember::uv_frame`].
            #[must_use]
            pub fn uv_frame(&self) -> DAffine3 { match self { $( Self::$name(s) => s.uv_frame(), )+ } }

            /// See [`SkeletonMember::uv_columns`].
            pub fn uv_columns(&self, row: &mut Vec<f64>) { match self { $( Self::$name(s) => s.uv_columns(row), )+ } }
        }

        $crate::member::each! { ($) skeleton $($module)+ }
    };
}

skeletons! {
    point::Point,
    segment::Segment,
    disc::Disc,
    ring::Ring,
    cylinder::Cylinder,
    cuboid::Cuboid,
    triangle::Triangle,
    polyline::Polyline,
    polygon::Polygon,
    bezier::Bezier,
    catmull_rom::CatmullRom,
    sphere::Sphere,
    torus::Torus,
    cone::Cone,
    round_cone::RoundCone,
    rectangle::Rectangle,
    arc::Arc,
    helix::Helix,
    half_space::HalfSpace,
    ellipsoid::Ellipsoid,
    lmetric::LMetric,
    superquadric::Superquadric,
}

mod cubic;
mod ends;
mod formulas;
mod geometry;
mod member;
mod piece;
mod points;
mod symmetry;
mod tapered;
mod tube;

use formulas::{beyond, dot, emit_off_axis, length, minus_multiple, outside_squared, sum_of_squares};
pub(crate) use formulas::{emit_unit, length_squared, positive_part};
pub(crate) use geometry::unit;
use geometry::{along, along_normal, ball_reach, circle_reach, cylindrical, direction, frame, towards};
pub use member::{ROUNDING, SkeletonMember};
pub use piece::{BEYOND, Pieces};
pub use symmetry::Symmetry;

impl Skeleton {
    /// A box around all points at up to this distance.
    #[must_use]
    pub fn bounds_within(&self, distance: f64) -> Bounds {
        let (bounds, metric) = (self.bounds(), self.metric());
        if metric == Metric::EUCLIDEAN {
            return bounds.grown(distance);
        }
        let reach = distance * metric.reach(self.pose().matrix3);
        Bounds::new(bounds.min - reach, bounds.max + reach)
    }
}

mod metric;
pub use metric::Metric;

#[cfg(test)]
mod testing;
mod uv;
