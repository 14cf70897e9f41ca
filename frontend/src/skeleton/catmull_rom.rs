//! A smooth curve through points (Catmull and Rom 1974), or a tube along it whose radius changes smoothly.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::cubic::{self, Cubic};
use super::points::{self, CLOSED, POINTS, RADII};
use super::{Pieces, SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;
use crate::field::{Field, FieldValue, Member};

/// The curve that goes through points, at each along the line between its neighbours: `c'_i = (p_(i+1) - p_(i-1)) / 2`, and at an
/// open end along the line to its only neighbour.
///
/// With radii it is the solid tube of all balls with centres on the curve. Radii go through theirs in the same way, but
/// change at a point by at most 3 times the radius there, so that they never fall below 0. Its distance is 0 inside.
#[derive(Clone, PartialEq, Debug)]
pub struct CatmullRom {
    /// The points, at least two.
    pub points: Arc<[DVec3]>,
    /// Radii of at least 0: none if it is thin, one for all points, or one for each.
    pub radii: Arc<[f64]>,
    /// Whether the curve leads on from the last point to the first.
    pub closed: bool,
}

impl CatmullRom {
    /// The points before and behind a point.
    fn neighbours(&self, point: usize) -> [usize; 2] {
        let count = self.points.len();
        if self.closed {
            [(point + count - 1) % count, (point + 1) % count]
        } else {
            [point.saturating_sub(1), (point + 1).min(count - 1)]
        }
    }

    /// A third of how point and radius change at a point, for one step of the parameter.
    fn third(&self, point: usize) -> (DVec3, f64) {
        let [before, behind] = self.neighbours(point);
        // At an open end the neighbours are the point itself and the only one that it has.
        let steps = if before == point || behind == point { 1.0 } else { 2.0 };
        let radius = |index| points::radius_at(&self.radii, index);
        let change = (radius(behind) - radius(before)) / (3.0 * steps);
        let own = radius(point);
        ((self.points[behind] - self.points[before]) / (3.0 * steps), change.clamp(-own, own))
    }

    /// Its curves.
    fn cubics(&self) -> impl Iterator<Item = Cubic> + '_ {
        let count = self.points.len();
        let curves = if self.closed { count } else { count - 1 };
        (0..curves).map(move |first| {
            let last = (first + 1) % count;
            let ((leave, grow), (arrive, end)) = (self.third(first), self.third(last));
            let [from, to] = [first, last].map(|end| self.points[end]);
            let [small, large] = [first, last].map(|end| points::radius_at(&self.radii, end));
            Cubic { centers: [from, from + leave, to - arrive, to], radii: [small, small + grow, large - end, large] }
        })
    }
}

impl Member for CatmullRom {
    const NAME: &'static str = "catmull_rom";
    const FIELDS: &'static [Field] = &[POINTS, RADII, CLOSED];

    fn from_fields(values: &[FieldValue]) -> Self {
        Self {
            points: points::points_of(&values[0]),
            radii: values[1].reals().into(),
            closed: values[2].real() != 0.0,
        }
    }

    fn to_fields(&self) -> Vec<FieldValue> {
        vec![
            points::value_of(&self.points),
            FieldValue::Reals(self.radii.to_vec()),
            FieldValue::Real(f64::from(u8::from(self.closed))),
        ]
    }
}

impl SkeletonMember for CatmullRom {
    const COLUMNS: &'static [&'static str] = &[];
    const SYMMETRY: Symmetry = Symmetry::None;
    const PIECES: Option<Pieces> = Some(Pieces { columns: Cubic::COLUMNS, local: true });

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        cubic::bounds_of(self.cubics(), map)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        points::distance_squared(cubic::places(self.cubics(), p))
    }

    fn decision(&self, p: DVec3) -> f64 {
        points::decision(&cubic::places(self.cubics(), p))
    }

    fn pose(&self) -> DAffine3 {
        points::middle(&self.points)
    }

    fn columns(&self, _scale: f64, _row: &mut Vec<f64>) {}

    fn emit<D: Domain>(d: &mut D, _p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let outside = super::positive_part(d, row[0]);
        d.mul(outside, outside)
    }

    fn pieces(&self, scale: f64, reach: f64, rows: &mut Vec<f64>) {
        let to_pose = self.pose().inverse();
        cubic::pieces(self.cubics(), reach).for_each(|piece| piece.columns(&to_pose, scale, rows));
    }

    fn piece_bounds_under(&self, reach: f64, map: &DAffine3) -> Vec<Bounds> {
        cubic::pieces(self.cubics(), reach).map(|piece| piece.bounds_under(map)).collect()
    }

    fn piece_count(&self, reach: f64, most: usize) -> usize {
        cubic::pieces(self.cubics(), reach).take(most).count()
    }

    fn begin<D: Domain>(_d: &mut D, beyond: D::Real) -> Vec<D::Real> {
        vec![beyond]
    }

    fn step<D: Domain>(d: &mut D, p: [D::Real; 3], piece: &[D::Real], so_far: &[D::Real]) -> Vec<D::Real> {
        let distance = Cubic::emit(d, p, piece);
        vec![d.min(distance, so_far[0])]
    }

    fn fault(&self) -> Option<Diagnostic> {
        points::fault(Self::NAME, &self.points, &self.radii, if self.closed { 3 } else { 2 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn it_goes_through_its_points_along_their_neighbours() {
        let points = [[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [3.0, 2.0, 1.0], [4.0, 0.0, 0.0]].map(DVec3::from);
        let curve = CatmullRom { points: points.into(), radii: [0.0, 0.3, 0.1, 0.2].into(), closed: true };
        for (index, cubic) in curve.cubics().enumerate() {
            assert_eq!(cubic.at(0.0), (points[index], [0.0, 0.3, 0.1, 0.2][index]));
            let step = 1e-6;
            let [before, behind] = [(index + 3) % 4, (index + 1) % 4].map(|i| points[i]);
            let along = (cubic.at(step).0 - cubic.at(0.0).0) / step;
            assert!(along.abs_diff_eq(0.5 * (behind - before), 1e-4), "{along}");
            assert!((0..=100).all(|i| cubic.at(f64::from(i) / 100.0).1 >= 0.0), "no radius is negative");
        }
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge_balls(6e-2, |rng| {
            let count = rng.usize(3..6);
            let radii: Vec<f64> = match rng.u8(..3) {
                0 => vec![],
                1 => vec![rng.f64()],
                _ => (0..count).map(|_| rng.f64()).collect(),
            };
            let curve = CatmullRom {
                points: (0..count).map(|_| testing::position(rng)).collect(),
                radii: radii.into(),
                closed: rng.bool(),
            };
            let ball = |cubic: Cubic, i: u32| cubic.at(f64::from(i) / 2000.0);
            let balls = curve.cubics().flat_map(|cubic| (0..=2000).map(move |i| ball(cubic, i))).collect();
            (curve, balls)
        });
    }
}
