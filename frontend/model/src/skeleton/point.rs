//! The point: the skeleton of a ball.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A point. Its uv is longitude about the z axis, from x, and latitude, from -z to z.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Point = "point" {
        /// Where it is: `at`, and not `center` as of figures that have a size.
        pub at: DVec3 [Position] = Vector([0.0; 3]),
    }
}

impl SkeletonMember for Point {
    const COLUMNS: &'static [&'static str] = &[];
    const SYMMETRY: Symmetry = Symmetry::Ball;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        Bounds::around([map.transform_point3(self.at)])
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        (p - self.at).length_squared()
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_translation(self.at)
    }

    fn columns(&self, _scale: f64, _row: &mut Vec<f64>) {}

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], _row: &[D::Real]) -> D::Real {
        super::length_squared(d, p)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn agrees_with_the_set() {
        testing::judge(1e-9, |rng| {
            let at = testing::position(rng);
            (Point { at }, vec![at])
        });
    }

    #[test]
    fn uv_is_longitude_and_latitude() {
        let point = Point { at: DVec3::new(1.0, 2.0, 3.0) };
        for (off, expected) in [
            ([1.0, 0.0, 0.0], [0.0, 0.5]),
            ([0.0, 5.0, 0.0], [0.25, 0.5]),
            ([-1.0, 0.0, 1.0], [0.5, 0.75]),
            ([0.0, -1.0, 0.0], [0.75, 0.5]),
            ([0.0, 0.0, 1.0], [0.0, 1.0]),
            ([0.0, 0.0, -1.0], [0.0, 0.0]),
            ([0.0, 0.0, 0.0], [0.0, 0.5]),
        ] {
            testing::same_uv(&point, point.at + DVec3::from(off), expected);
        }
        testing::judge_uv(|rng| Point { at: testing::position(rng) });
    }
}
