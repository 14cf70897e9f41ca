//! The polyline: straight lines from point to point, or a tube along them whose radius changes evenly between
//! points.

use super::points::Path;
use super::tapered::Cone;
use super::tube::Tube;
use crate::diagnostic::Diagnostic;
use crate::member::{Lengths, Member as _, Positions, member};

member! {
    /// Lines through points in order, at least two. With radii it is the solid tube of all balls with centres
    /// on these lines: its distance is 0 inside.
    #[derive(Clone, PartialEq, Debug)]
    pub struct Polyline = "polyline" {
        /// The points, at least two.
        pub points: Positions [Positions],
        /// Radii of at least 0: none if it is thin, one for all points, or one for each.
        pub radii: Lengths [Lengths] = Reals(Vec::new()),
        /// Whether it leads on from the last point to the first.
        pub closed: bool [Flag] = Real(0.0),
    }
}

impl Tube for Polyline {
    type Part = Cone;

    fn path(&self) -> Path<'_> {
        Path { points: &self.points, radii: &self.radii, closed: self.closed }
    }

    fn parts(&self) -> impl Iterator<Item = Cone> {
        self.path().steps().map(|ends| Cone {
            centers: ends.map(|end| self.points[end]),
            radii: ends.map(|end| self.path().radius_at(end)),
        })
    }

    fn flaw(&self) -> Option<Diagnostic> {
        self.path().fault(Self::NAME, 2)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::skeleton::testing;

    fn polyline(points: &[[f64; 3]], radii: &[f64], closed: bool) -> Polyline {
        let points = points.iter().map(|&point| point.into()).collect();
        Polyline { points, radii: radii.into(), closed }
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
        // Radii 2 and 5 over a length of 5: the side leans by k = 3/5, so cos = 4/5. Above (x, y) the
        // distance is 4/5 y - 3/5 x - 2.
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
            let ball = |cone: Cone, i: u32| cone.at(f64::from(i) / 1000.0);
            let balls = line.parts().flat_map(|cone| (0..=1000).map(move |i| ball(cone, i))).collect();
            (line, balls)
        });
    }
}
