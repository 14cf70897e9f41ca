//! The polyline: straight lines from point to point, or a tube along them whose radius changes evenly between points.

use std::sync::Arc;

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::tapered::{Cone, bounds_of};
use super::points::{self, CLOSED, POINTS, Place, RADII};
use super::{Pieces, SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::diagnostic::Diagnostic;
use crate::field::{Field, FieldValue, Member};

/// Lines through points in order, at least two. With radii it is the solid tube of all balls with centres on these lines: its distance is 0
/// inside.
#[derive(Clone, PartialEq, Debug)]
pub struct Polyline {
    /// The points.
    pub points: Arc<[DVec3]>,
    /// Radii of at least 0: none if it is thin, one for all points, or one for each.
    pub radii: Arc<[f64]>,
    /// Whether a line leads from the last point to the first.
    pub closed: bool,
}

impl Polyline {
    /// Its lines.
    fn cones(&self) -> Vec<Cone> {
        let count = self.points.len();
        let lines = if self.closed { count } else { count - 1 };
        let cone = |first: usize| {
            let ends = [first, (first + 1) % count];
            Cone {
                centers: ends.map(|end| self.points[end]),
                radii: ends.map(|end| points::radius_at(&self.radii, end)),
            }
        };
        (0..lines).map(cone).collect()
    }

    fn places(&self, p: DVec3) -> Vec<Place> {
        let place = |cone: &Cone| {
            let (foot, radius) = cone.at(cone.nearest(p));
            Place { distance: p.distance(foot) - radius, foot, firmness: 1.0 }
        };
        self.cones().iter().map(place).collect()
    }
}

impl Member for Polyline {
    const NAME: &'static str = "polyline";
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

impl SkeletonMember for Polyline {
    const COLUMNS: &'static [&'static str] = &[];
    const SYMMETRY: Symmetry = Symmetry::None;
    const PIECES: Option<Pieces> = Some(Pieces { columns: Cone::COLUMNS, local: true });

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        bounds_of(&self.cones(), map)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        points::distance_squared(self.places(p))
    }

    fn decision(&self, p: DVec3) -> f64 {
        points::decision(&self.places(p))
    }

    fn pose(&self) -> DAffine3 {
        points::middle(&self.points)
    }

    fn columns(&self, _scale: f64, _row: &mut Vec<f64>) {}

    fn emit<D: Domain>(d: &mut D, _p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let outside = super::positive_part(d, row[0]);
        d.mul(outside, outside)
    }

    fn pieces(&self, scale: f64, _reach: f64, rows: &mut Vec<f64>) {
        let to_pose = self.pose().inverse();
        self.cones().iter().for_each(|cone| cone.columns(&to_pose, scale, rows));
    }

    fn piece_bounds_under(&self, _reach: f64, map: &DAffine3) -> Vec<Bounds> {
        self.cones().iter().map(|cone| cone.bounds_under(map)).collect()
    }

    fn piece_count(&self, _reach: f64, _most: usize) -> usize {
        self.points.len()
    }

    fn begin<D: Domain>(_d: &mut D, beyond: D::Real) -> Vec<D::Real> {
        vec![beyond]
    }

    fn step<D: Domain>(d: &mut D, p: [D::Real; 3], piece: &[D::Real], so_far: &[D::Real]) -> Vec<D::Real> {
        let distance = Cone::emit(d, p, piece);
        vec![d.min(distance, so_far[0])]
    }

    fn fault(&self) -> Option<Diagnostic> {
        points::fault(Self::NAME, &self.points, &self.radii, 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    fn polyline(points: &[[f64; 3]], radii: &[f64], closed: bool) -> Polyline {
        Polyline { points: points.iter().map(|&point| point.into()).collect(), radii: radii.into(), closed }
    }

    #[test]
    fn known_distances() {
        let corner = [[0.0; 3], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0]];
        let open = polyline(&corner, &[], false);
        for (p, expected) in
            [([2.0, 1.0, 0.0], 1.0), ([-3.0, 0.0, 4.0], 25.0), ([5.0, 2.0, 2.0], 5.0), ([0.0, 4.0, 0.0], 16.0)]
        {
            testing::same_everywhere(&open, p.into(), expected);
        }
        // On the diagonal that closes it.
        testing::same_everywhere(&polyline(&corner, &[], true), DVec3::new(2.0, 2.0, 3.0), 9.0);
        // A tube of radius 1: 2 away from the middle of the line, and inside.
        let tube = polyline(&corner, &[1.0], false);
        testing::same_everywhere(&tube, DVec3::new(2.0, 0.0, 3.0), 4.0);
        testing::same_everywhere(&tube, DVec3::new(2.0, 0.5, 0.5), 0.0);
    }

    #[test]
    fn known_tapered_distances() {
        // Radii 2 and 5 over a length of 5: the side leans by k = 3/5, so cos = 4/5. Above (x, y) the distance is 4/5 y - 3/5 x - 2.
        let cone = polyline(&[[0.0; 3], [5.0, 0.0, 0.0]], &[2.0, 5.0], false);
        let (x, y) = (-3.0_f64, 10.0_f64);
        testing::same_everywhere(&cone, DVec3::new(x, y, 0.0), (0.8 * y - 0.6 * x - 2.0).powi(2));
        // The nearest ball is beyond the end: behind the larger one, in front of the smaller.
        testing::same_everywhere(&cone, DVec3::new(5.0, 10.0, 0.0), 25.0);
        testing::same_everywhere(&cone, DVec3::new(-6.0, 0.0, 0.0), 16.0);
        // One ball holds the other.
        let ball = polyline(&[[0.0; 3], [1.0, 0.0, 0.0]], &[3.0, 1.0], false);
        testing::same_everywhere(&ball, DVec3::new(5.0, 0.0, 0.0), 4.0);
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge_balls(3e-2, |rng| {
            let count = rng.usize(2..7);
            let points: Vec<DVec3> = (0..count).map(|_| testing::position(rng)).collect();
            let radii: Vec<f64> = match rng.u8(..3) {
                0 => vec![],
                1 => vec![rng.f64()],
                _ => (0..count).map(|_| 2.0 * rng.f64()).collect(),
            };
            let line = Polyline { points: points.into(), radii: radii.into(), closed: rng.bool() };
            let ball = |cone: &Cone, i: u32| cone.at(f64::from(i) / 1000.0);
            let balls = line.cones().iter().flat_map(|cone| (0..=1000).map(move |i| ball(cone, i))).collect();
            (line, balls)
        });
    }
}
