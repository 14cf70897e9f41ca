//! A chain of cubic Bezier curves, or a tube along it whose radius changes smoothly.

use super::cubic::Cubic;
use super::points::Path;
use super::tube::Tube;
use crate::diagnostic::Diagnostic;
use crate::member::{Lengths, Member as _, Positions, member};

member! {
    /// A chain of cubic Bezier curves, each of four points, the last of one being the first of the next: 3
    /// n + 1 points for n curves. The chain is smooth at a point where two curves meet if that is on the line
    /// between its neighbours.
    ///
    /// With radii it is the solid tube of all balls with centres on the curve: radii are the Bezier
    /// coefficients of the radius, as points are those of the centre. Its distance is 0 inside.
    #[derive(Clone, PartialEq, Debug)]
    pub struct Bezier = "bezier" {
        /// The points: four, and three more for each further curve.
        pub points: Positions [Positions],
        /// Radii of at least 0: none if it is thin, one for all points, or one for each.
        pub radii: Lengths [Lengths] = Reals(Vec::new()),
    }
}

impl Tube for Bezier {
    type Part = Cubic;

    fn path(&self) -> Path<'_> {
        Path { points: &self.points, radii: &self.radii, closed: false }
    }

    fn parts(&self) -> impl Iterator<Item = Cubic> {
        (0..self.points.len() / 3).map(|curve| {
            let places = [0, 1, 2, 3].map(|i| 3 * curve + i);
            Cubic {
                centers: places.map(|i| self.points[i]),
                radii: places.map(|i| self.path().radius_at(i)),
            }
        })
    }

    fn flaw(&self) -> Option<Diagnostic> {
        let count = self.points.len();
        self.path().fault(Self::NAME, 4).or_else(|| {
            let error = || Diagnostic::error(None, format!("the bezier has {count} points"));
            (count % 3 != 1).then(|| error().expected("expected 4, 7, 10, ..: three more for each curve"))
        })
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

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
            let points = (0..1 + 3 * rng.usize(1..3)).map(|_| testing::position(rng)).collect();
            let radii = if rng.bool() { [].into() } else { [rng.f64()].into() };
            let curve = Bezier { points, radii };
            let ball = |cubic: Cubic, i: u32| cubic.at(f64::from(i) / 2000.0);
            let balls = curve.parts().flat_map(|cubic| (0..=2000).map(move |i| ball(cubic, i))).collect();
            (curve, balls)
        });
    }
}
