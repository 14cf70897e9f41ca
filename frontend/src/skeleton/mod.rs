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
use crate::diagnostic::Diagnostic;
use crate::field::{Field, FieldValue, Member};

/// What a skeleton states about itself.
///
/// Coordinates are those of the primitive's own space. The distance is Euclidean unless [`metric`](Self::metric) says otherwise; of a scaled
/// skeleton and point it is as many times as large.
pub trait SkeletonMember: Member {
    /// Names of the columns that [`columns`](Self::columns) fills, in order.
    const COLUMNS: &'static [&'static str];

    /// Its symmetry in its pose.
    const SYMMETRY: Symmetry;

    /// How many distances that may be zero, as that from an axis, divide its derivative one after the other. All but the first of them
    /// are at least the distance from the skeleton.
    const DIVISORS: i32 = 1;

    /// What its distance is.
    fn metric(&self) -> Metric {
        Metric::EUCLIDEAN
    }

    /// The smallest box that holds the image of the skeleton itself (not the support of its field) under a map. Its sides may be infinite.
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

    /// What is folded over its pieces, if it is made of any number of them. Then the row that [`emit`](Self::emit) is given goes on behind the
    /// columns with what the accumulators have come to.
    const PIECES: Option<Pieces> = None;

    /// The numbers of its pieces, those of one behind those of the other, in the pose and `scale` times as large; `reach` is the support
    /// radius, of the skeleton as it was written. There is at least one piece.
    fn pieces(&self, _scale: f64, _reach: f64, _rows: &mut Vec<f64>) {}

    /// The smallest boxes that hold the images of its pieces under a map, in their order.
    fn piece_bounds_under(&self, _reach: f64, _map: &DAffine3) -> Vec<Bounds> {
        Vec::new()
    }

    /// How many pieces there are; counting may end at `most`. Cost: that of the count.
    fn piece_count(&self, _reach: f64, _most: usize) -> usize {
        0
    }

    /// The accumulators before the first piece. `beyond` is a distance of [`BEYOND`] support radii.
    fn begin<D: Domain>(_d: &mut D, _beyond: D::Real) -> Vec<D::Real> {
        Vec::new()
    }

    /// The accumulators behind a piece, from those before it; `p` is a point in the pose, `piece` has the numbers of the piece.
    fn step<D: Domain>(
        _d: &mut D,
        _p: [D::Real; 3],
        _piece: &[D::Real],
        _so_far: &[D::Real],
    ) -> Vec<D::Real> {
        Vec::new()
    }

    /// What is wrong with parameters that do not go together, each of which by itself is what its kind says; without a place.
    fn fault(&self) -> Option<Diagnostic> {
        None
    }

    /// Names of the columns that [`uv_columns`](Self::uv_columns) fills, in order.
    const UV_COLUMNS: &'static [&'static str] = &[];

    /// Where `p` is on the skeleton, plainly: two numbers from 0 to 1, finite everywhere. What they mean stands at each skeleton; without
    /// more, they are longitude
    /// and latitude about the middle of the pose.
    fn uv(&self, p: DVec3) -> [f64; 2] {
        uv::sphere(p - self.pose().translation)
    }

    /// How far `p` is from where [`uv`](Self::uv) jumps; infinity if it never does.
    fn uv_decision(&self, p: DVec3) -> f64 {
        uv::sphere_decision(p - self.pose().translation)
    }

    /// The rigid motion from the frame in which [`emit_uv`](Self::emit_uv) sees the skeleton to where it is. Unlike the pose it is not up to
    /// symmetry.
    fn uv_frame(&self) -> DAffine3 {
        DAffine3::from_translation(self.pose().translation)
    }

    /// The numbers of a row that [`emit_uv`](Self::emit_uv) needs: one for each of [`UV_COLUMNS`](Self::UV_COLUMNS).
    fn uv_columns(&self, row: &mut Vec<f64>) {
        let _ = row;
    }

    /// [`uv`](Self::uv) over the ops, in the frame; `row` holds the columns.
    fn emit_uv<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 2] {
        let _ = row;
        uv::emit_sphere(d, p)
    }
}

/// The rounding that [`SkeletonMember::emit`] may have: 64 units in the last place.
///
/// A column is off by half a unit of what it holds. A difference of a coordinate and a length adds half a unit of both, a sum of two
/// squares and its root less than two of the result: a cylinder, with two such terms, stays below 8 units, a box below 8. The sides of
/// a triangle take two products and a sum, of numbers that are off themselves, so both its terms are off by up to 12 units of
/// coordinates that are up to 1.5 times as large; and near a corner the test of what is inside may be off by three times as much. A cone's
/// profile is a figure of such sides.
///
/// Of solids around something (a sphere, a torus, a round cone), the distance from that is at most the distance from the solid and a
/// coordinate of it: it is off by less than 8 units, and a radius takes one more. A round cone finds the nearest point of its axis with an error
/// of its own, which matters in the second order alone; see there. An arc adds to a ring the choice between its ends and the circle, which
/// are equally far away where rounding may take the one for the other. A helix answers for a place of its own that is off by less than 8 units, and for
/// one that is farther away than the nearest by at most 32.
///
/// Norms have no coordinates and are off by parts of themselves: an ellipsoid, with a product in each square, by less than 6 units, and those with
/// powers by less than 13 for each norm in the other; see [`LMetric`].
pub const ROUNDING: f64 = 64.0 / (1 << 24) as f64;

/// Which rotations a skeleton in its pose does not feel: they need not be done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Symmetry {
    /// All.
    Ball,
    /// Those about the z axis, and turning it round.
    Axis,
    /// Those about the z axis.
    Arrow,
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
            Self::Arrow if turn.z_axis.abs_diff_eq(DVec3::NEG_Z, 1e-12) => -DMat3::IDENTITY,
            Self::Arrow => towards(turn.z_axis),
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

            /// See [`SkeletonMember::DIVISORS`].
            #[must_use]
            pub const fn divisors(self) -> i32 { match self { $( Self::$name => $name::DIVISORS, )+ } }

            /// See [`SkeletonMember::SYMMETRY`].
            #[must_use]
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

            /// See [`SkeletonMember::uv_decision`].
            #[must_use]
            pub fn uv_decision(&self, p: DVec3) -> f64 { match self { $( Self::$name(s) => s.uv_decision(p), )+ } }

            /// See [`SkeletonMember::uv_frame`].
            #[must_use]
            pub fn uv_frame(&self) -> DAffine3 { match self { $( Self::$name(s) => s.uv_frame(), )+ } }

            /// See [`SkeletonMember::uv_columns`].
            pub fn uv_columns(&self, row: &mut Vec<f64>) { match self { $( Self::$name(s) => s.uv_columns(row), )+ } }
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
mod piece;
mod points;
mod tapered;
mod tube;

pub use ends::Ends;
use formulas::{beyond, dot, emit_off_axis, length, minus_multiple, outside_squared, sum_of_squares};
pub(crate) use formulas::{length_squared, positive_part};
pub(crate) use geometry::unit;
use geometry::{along, along_normal, ball_reach, circle_reach, cylindrical, direction, frame, towards};
pub use piece::{BEYOND, Pieces};
pub use points::Path;

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
