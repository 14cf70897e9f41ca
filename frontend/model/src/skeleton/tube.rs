//! Tubes along paths: the shared code of lines and curves through points. Each skeleton lists its
//! [`TubePart`]s.
//!
//! A tube is the solid of all balls with middles on the path, whose radii may differ: its distance is the
//! smallest distance of its parts, and 0 inside. A thin tube has radii of 0. The parts, or divisions of them,
//! are pieces, so that a path of any length is the same code.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::points::{self, NearestPlace, Path};
use super::{Pieces, SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;
use crate::member::Member;

/// The balls along a line or a curve.
pub(super) trait TubePart: Sized {
    /// Names of the columns that [`columns`](Self::columns) fills, in order.
    const COLUMNS: &'static [&'static str];

    /// The box around the part's image under a map.
    fn bounds_under(&self, map: &DAffine3) -> Bounds;

    /// The nearest places of all parts, in f64: for each part, every local minimum of the distance.
    fn places(parts: impl Iterator<Item = Self>, p: DVec3) -> Vec<NearestPlace>;

    /// The pieces of all parts that the program sees, for this support radius.
    fn divided(parts: impl Iterator<Item = Self>, reach: f64) -> impl Iterator<Item = Self>;

    /// The numbers of a row, in the pose and scaled.
    fn columns(&self, to_pose: &DAffine3, scale: f64, row: &mut Vec<f64>);

    /// The distance from `p` over the ops, below zero inside.
    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real;
}

/// A skeleton along a path.
pub(super) trait Tube: Member {
    /// What it consists of.
    type Part: TubePart;

    /// Its points and radii.
    fn path(&self) -> Path<'_>;

    /// Its parts, in order.
    fn parts(&self) -> impl Iterator<Item = Self::Part>;

    /// What is wrong with its path.
    fn flaw(&self) -> Option<Diagnostic>;
}

impl<T: Tube> SkeletonMember for T {
    const COLUMNS: &'static [&'static str] = &[];
    const SYMMETRY: Symmetry = Symmetry::None;
    const PIECES: Option<Pieces> = Some(Pieces { columns: T::Part::COLUMNS, local: true });

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        self.parts().fold(Bounds::EMPTY, |all, part| all.hull(part.bounds_under(map)))
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        points::distance_squared(T::Part::places(self.parts(), p))
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        points::kink_distance(&T::Part::places(self.parts(), p))
    }

    fn pose(&self) -> DAffine3 {
        points::middle(self.path().points)
    }

    fn columns(&self, _scale: f64, _row: &mut Vec<f64>) {}

    fn emit<D: Domain>(d: &mut D, _p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let outside = super::positive_part(d, row[0]);
        d.mul(outside, outside)
    }

    fn pieces(&self, scale: f64, reach: f64, rows: &mut Vec<f64>) {
        let to_pose = self.pose().inverse();
        T::Part::divided(self.parts(), reach).for_each(|piece| piece.columns(&to_pose, scale, rows));
    }

    fn piece_bounds_under(&self, reach: f64, map: &DAffine3) -> Vec<Bounds> {
        T::Part::divided(self.parts(), reach).map(|piece| piece.bounds_under(map)).collect()
    }

    fn piece_count(&self, reach: f64, most: usize) -> usize {
        T::Part::divided(self.parts(), reach).take(most).count()
    }

    fn begin<D: Domain>(_d: &mut D, beyond: D::Real) -> Vec<D::Real> {
        vec![beyond]
    }

    fn step<D: Domain>(d: &mut D, p: [D::Real; 3], piece: &[D::Real], so_far: &[D::Real]) -> Vec<D::Real> {
        let distance = T::Part::emit(d, p, piece);
        vec![d.min(distance, so_far[0])]
    }

    fn fault(&self) -> Option<Diagnostic> {
        self.flaw()
    }
}
