//! The sphere: a solid ball, whose field has a core of full strength.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A solid ball. With radius 0 it is a point.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Sphere = "sphere" {
        /// Its middle.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// How far it reaches from the middle.
        pub radius: f64 [NonNegative],
    }
}

impl SkeletonMember for Sphere {
    const COLUMNS: &'static [&'static str] = &["radius"];
    const SYMMETRY: Symmetry = Symmetry::Ball;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let reach = super::ball_reach(map, self.radius);
        let center = map.transform_point3(self.center);
        Bounds::new(center - reach, center + reach)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        (p.distance(self.center) - self.radius).max(0.0).powi(2)
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_translation(self.center)
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        row.push(scale * self.radius);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let square = super::length_squared(d, p);
        super::outside_squared(d, square, row[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let sphere = Sphere { center: DVec3::new(1.0, 0.0, 0.0), radius: 2.0 };
        for (p, expected) in [([1.0, 3.0, 4.0], 9.0), ([1.0, 0.0, 0.0], 0.0), ([2.0, 1.0, 1.0], 0.0), ([-1.0, 0.0, 0.0], 0.0)] {
            testing::same_everywhere(&sphere, p.into(), expected);
        }
    }

    #[test]
    fn radius_zero_is_a_point() {
        let point = Sphere { center: DVec3::ONE, radius: 0.0 };
        testing::same_everywhere(&point, DVec3::new(3.0, 4.0, 7.0), 49.0);
        testing::same_everywhere(&point, DVec3::ONE, 0.0);
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.5, |rng| {
            let sphere = Sphere { center: testing::position(rng), radius: 2.0 * rng.f64() };
            let samples = testing::ball(10).map(|v| sphere.center + sphere.radius * v).collect();
            (sphere, samples)
        });
    }
}
