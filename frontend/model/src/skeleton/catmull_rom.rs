//! A smooth curve through points (Catmull and Rom 1974), or a tube along it whose radius changes smoothly.

use glam::DVec3;

use super::cubic::Cubic;
use super::points::Path;
use super::tube::Tube;
use crate::diagnostic::Diagnostic;
use crate::member::{Lengths, Member as _, Positions, member};

member! {
    /// The curve that goes through points, at each along the line between its neighbours: `c'_i = (p_(i+1) -
    /// p_(i-1)) / 2`, and at an open end along the line to its only neighbour.
    ///
    /// With radii it is the solid tube of all balls with centres on the curve. Radii go through theirs in the
    /// same way, but change at a point by at most 3 times the radius there, so that they never fall below 0.
    /// Its distance is 0 inside.
    #[derive(Clone, PartialEq, Debug)]
    pub struct CatmullRom = "catmull_rom" {
        /// The points, at least two, or three if it is closed.
        pub points: Positions [Positions],
        /// Radii of at least 0: none if it is thin, one for all points, or one for each.
        pub radii: Lengths [Lengths] = Reals(Vec::new()),
        /// Whether it leads on from the last point to the first.
        pub closed: bool [Flag] = Real(0.0),
    }
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

    /// A third of the derivatives of point and radius at a point, by the parameter.
    fn third(&self, point: usize) -> (DVec3, f64) {
        let [before, behind] = self.neighbours(point);
        // At an open end one neighbour is the point itself.
        let steps = if before == point || behind == point { 1.0 } else { 2.0 };
        let radius = |index| self.path().radius_at(index);
        let change = (radius(behind) - radius(before)) / (3.0 * steps);
        let own = radius(point);
        let way = self.points[behind] - self.points[before];
        (way / (3.0 * steps), change.clamp(-own, own))
    }
}

impl Tube for CatmullRom {
    type Part = Cubic;

    fn path(&self) -> Path<'_> {
        Path { points: &self.points, radii: &self.radii, closed: self.closed }
    }

    fn parts(&self) -> impl Iterator<Item = Cubic> {
        self.path().steps().map(|[first, last]| {
            let ((leave, grow), (arrive, end)) = (self.third(first), self.third(last));
            let [from, to] = [first, last].map(|end| self.points[end]);
            let [small, large] = [first, last].map(|end| self.path().radius_at(end));
            Cubic { centers: [from, from + leave, to - arrive, to], radii: [small, small + grow, large - end, large] }
        })
    }

    fn flaw(&self) -> Option<Diagnostic> {
        self.path().fault(Self::NAME, if self.closed { 3 } else { 2 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn it_goes_through_its_points_along_their_neighbours() {
        let points = [[0.0, 0.0, 0.0], [1.0, 2.0, 0.0], [3.0, 2.0, 1.0], [4.0, 0.0, 0.0]].map(DVec3::from);
        let radii = [0.0, 0.3, 0.1, 0.2].into();
        let curve = CatmullRom { points: points.into(), radii, closed: true };
        for (index, cubic) in curve.parts().enumerate() {
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
            let points = (0..count).map(|_| testing::position(rng)).collect();
            let curve = CatmullRom { points, radii: radii.into(), closed: rng.bool() };
            let ball = |cubic: Cubic, i: u32| cubic.at(f64::from(i) / 2000.0);
            let balls = curve.parts().flat_map(|cubic| (0..=2000).map(move |i| ball(cubic, i))).collect();
            (curve, balls)
        });
    }
}
