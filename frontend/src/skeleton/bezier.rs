//! A chain of cubic Bezier curves, or a tube along it whose radius changes smoothly.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::cubic::{self, Cubic};
use super::points::{self, POINTS, RADII};
use super::{Pieces, SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;
use crate::field::{Field, FieldValue, Member};

/// A chain of cubic Bezier curves, each of four points, the last of one being the first of the next: 3 n + 1 points for n curves. The chain is
/// smooth at a point where two curves meet if that is on the line between its neighbours.
///
/// With radii it is the solid tube of all balls with centres on the curve: radii are the Bezier coefficients of the radius, as points are
/// those of the centre. Its distance is 0 inside.
#[derive(Clone, PartialEq, Debug)]
pub struct Bezier {
    /// The points.
    pub points: Arc<[DVec3]>,
    /// Radii of at least 0: none if it is thin, one for all points, or one for each.
    pub radii: Arc<[f64]>,
}

impl Bezier {
    /// Its curves.
    fn cubics(&self) -> impl Iterator<Item = Cubic> + '_ {
        (0..self.points.len() / 3).map(|curve| {
            let places = [0, 1, 2, 3].map(|i| 3 * curve + i);
            Cubic {
                centers: places.map(|i| self.points[i]),
                radii: places.map(|i| points::radius_at(&self.radii, i)),
            }
        })
    }
}

impl Member for Bezier {
    const NAME: &'static str = "bezier";
    const FIELDS: &'static [Field] = &[POINTS, RADII];

    fn from_fields(values: &[FieldValue]) -> Self {
        Self { points: points::points_of(&values[0]), radii: values[1].reals().into() }
    }

    fn to_fields(&self) -> Vec<FieldValue> {
        vec![points::value_of(&self.points), FieldValue::Reals(self.radii.to_vec())]
    }
}

impl SkeletonMember for Bezier {
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
        let count = self.points.len();
        let fault = points::fault(Self::NAME, &self.points, &self.radii, 4);
        fault.or_else(|| {
            let error = || Diagnostic::error(None, format!("the bezier has {count} points"));
            (count % 3 != 1).then(|| error().expected("expected 4, 7, 10, ..: three more for each curve"))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn a_straight_one_is_a_segment() {
        let points = [0.0, 1.0, 2.0, 3.0].map(|x| DVec3::new(x, 0.0, 0.0));
        let line = Bezier { points: points.into(), radii: [].into() };
        testing::same_everywhere(&line, DVec3::new(1.3, 3.0, 4.0), 25.0);
        testing::same_everywhere(&line, DVec3::new(-3.0, 4.0, 0.0), 25.0);
        let cone = Bezier { radii: [2.0, 3.0, 4.0, 5.0].into(), ..line };
        // It grows by as much as it is long: the last ball holds all.
        testing::same_everywhere(&cone, DVec3::new(-4.0, 0.0, 0.0), 4.0);
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge_balls(6e-2, |rng| {
            let curve = Bezier {
                points: (0..1 + 3 * rng.usize(1..3)).map(|_| testing::position(rng)).collect(),
                radii: if rng.bool() { [].into() } else { [rng.f64()].into() },
            };
            let ball = |cubic: Cubic, i: u32| cubic.at(f64::from(i) / 2000.0);
            let balls = curve.cubics().flat_map(|cubic| (0..=2000).map(move |i| ball(cubic, i))).collect();
            (curve, balls)
        });
    }
}
