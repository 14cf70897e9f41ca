//! What every skeleton implements.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::uv;
use super::{Metric, Pieces, Symmetry};
use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;
use crate::member::Member;

/// What a skeleton states about itself.
///
/// *Over the ops* means for any [`Domain`]: the formula is written once, and lowering runs it on a
/// `FunctionBuilder`, which makes an instruction of each op.
///
/// Coordinates are those of the primitive's own space. The distance is Euclidean unless
/// [`metric`](Self::metric) says otherwise. Scaling the skeleton and the point by a factor scales the
/// distance by the same factor.
pub trait SkeletonMember: Member {
    /// Names of the columns that [`columns`](Self::columns) fills, in order.
    const COLUMNS: &'static [&'static str];

    /// Its symmetry in its pose.
    const SYMMETRY: Symmetry;

    /// How many distances that may be zero, such as the distance from an axis, divide the derivative one
    /// after the other. All but the first are at least the distance from the skeleton.
    const DIVISORS: i32 = 1;

    /// Whether decisions in its distance may bend its surfaces sharply: edges of a norm's ball, corners that
    /// point inwards.
    const CREASES: bool = false;

    /// How its distance is measured.
    fn metric(&self) -> Metric {
        Metric::EUCLIDEAN
    }

    /// The smallest box that holds the image of the skeleton itself (not the support of its field) under a
    /// map. Its sides may be infinite.
    fn bounds_under(&self, map: &DAffine3) -> Bounds;

    /// The squared distance from `p`, in f64.
    fn distance_squared(&self, p: DVec3) -> f64;

    /// The distance of `p` from the nearest jump of the gradient of the squared distance; infinity if it
    /// never jumps.
    fn kink_distance(&self, p: DVec3) -> f64;

    /// The rigid motion from the pose to where the skeleton is.
    fn pose(&self) -> DAffine3;

    /// The numbers of a row, derived from the parameters in f64: one for each of [`COLUMNS`](Self::COLUMNS).
    /// They describe the skeleton scaled by `scale`.
    fn columns(&self, scale: f64, row: &mut Vec<f64>);

    /// The squared distance from `p`, over the ops, for the skeleton in its pose; `row` holds the columns.
    ///
    /// In f32, with columns rounded once, its square root is off by at most [`ROUNDING`] of the distance plus
    /// the largest coordinate of the skeleton (and by 2^-73, where squares underflow). Supports rest on this
    /// bound.
    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real;

    /// The fold over its pieces, if it is made of any number of them. Then the row for [`emit`](Self::emit)
    /// holds the columns followed by the final accumulators.
    const PIECES: Option<Pieces> = None;

    /// The numbers of its pieces, one piece after the other, in the pose and scaled by `scale`; `reach` is
    /// the support radius of the unscaled skeleton. There is at least one piece.
    fn pieces(&self, _scale: f64, _reach: f64, _rows: &mut Vec<f64>) {}

    /// The smallest boxes that hold the images of its pieces under a map, in their order.
    fn piece_bounds_under(&self, _reach: f64, _map: &DAffine3) -> Vec<Bounds> {
        Vec::new()
    }

    /// How many pieces there are; counting may end at `most`. Costs as much as counting.
    fn piece_count(&self, _reach: f64, _most: usize) -> usize {
        0
    }

    /// The accumulators before the first piece. `beyond` is a distance of [`BEYOND`](super::BEYOND) support
    /// radii.
    fn begin<D: Domain>(_d: &mut D, _beyond: D::Real) -> Vec<D::Real> {
        Vec::new()
    }

    /// The accumulators after a piece, from the accumulators before it; `p` is a point in the pose, `piece`
    /// holds the numbers of the piece.
    fn step<D: Domain>(
        _d: &mut D,
        _p: [D::Real; 3],
        _piece: &[D::Real],
        _so_far: &[D::Real],
    ) -> Vec<D::Real> {
        Vec::new()
    }

    /// The fault of parameters that are valid one by one but do not go together; without a place in the text.
    fn fault(&self) -> Option<Diagnostic> {
        None
    }

    /// Names of the columns that [`uv_columns`](Self::uv_columns) fills, in order.
    const UV_COLUMNS: &'static [&'static str] = &[];

    /// The place of `p` on the skeleton, in f64: two numbers from 0 to 1, finite everywhere. Each skeleton
    /// says what they mean; by default they are longitude and latitude about the middle of the pose.
    fn uv(&self, p: DVec3) -> [f64; 2] {
        uv::sphere(p - self.pose().translation)
    }

    /// The distance of `p` from the nearest jump of [`uv`](Self::uv); infinity if it never jumps.
    fn uv_kink_distance(&self, p: DVec3) -> f64 {
        uv::sphere_kink_distance(p - self.pose().translation)
    }

    /// The rigid motion from the frame of [`emit_uv`](Self::emit_uv) to the skeleton's place. Unlike the pose
    /// it is unique, not up to symmetry.
    fn uv_frame(&self) -> DAffine3 {
        DAffine3::from_translation(self.pose().translation)
    }

    /// The numbers of a row that [`emit_uv`](Self::emit_uv) needs: one for each of
    /// [`UV_COLUMNS`](Self::UV_COLUMNS).
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
/// A column is off by half a unit of its value. A difference of a coordinate and a length adds half a unit of
/// each, a sum of two squares and its root less than two units of the result: a cylinder, with two such
/// terms, stays below 8 units, and so does a box. The sides of a triangle take two products and a sum of
/// rounded numbers: both terms are off by up to 12 units of coordinates that are up to 1.5 times as large,
/// and near a corner the inside test may be off by three times as much. A cone's profile is a figure of such
/// sides.
///
/// For solids around a smaller set (a sphere, a torus, a round cone), the distance from that set is at most
/// the distance from the solid plus a coordinate of the solid: it is off by less than 8 units, and a radius
/// adds one. A round cone finds the nearest point of its axis with an error that matters in the second order
/// only; see there. An arc adds to a ring the choice between its ends and the circle, which are equally far
/// away where rounding may confuse them. A helix answers with the distance of a place that is off by less
/// than 8 units, and farther away than the nearest place by at most 32.
///
/// Norms have no coordinates, and their errors are relative: an ellipsoid, with a product in each square, is
/// off by less than 6 units, norms with powers by less than 13 for each nested norm; see
/// [`LMetric`](struct@super::LMetric).
pub const ROUNDING: f64 = 64.0 / (1 << 24) as f64;
