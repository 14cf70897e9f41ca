//! The torus: a solid one, a tube around a circle.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// All points within `tube_radius` of a circle. A tube of radius 0 is the ring itself; a circle of radius
    /// 0 makes a ball.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Torus = "torus" {
        /// Its middle.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// The direction of its axis, of any length but 0; either of the two.
        pub normal: DVec3 [Direction] = Vector([0.0, 0.0, 1.0]),
        /// The radius of the circle in the middle of the tube.
        pub ring_radius: f64 [NonNegative],
        /// The radius of the tube.
        pub tube_radius: f64 [NonNegative],
    }
}

impl SkeletonMember for Torus {
    const COLUMNS: &'static [&'static str] = &["ring_radius", "tube_radius"];
    const SYMMETRY: Symmetry = Symmetry::Axis;
    /// The distance from the axis, and that from the circle.
    const DIVISORS: i32 = 2;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let ring = super::circle_reach(map, super::unit(self.normal), self.ring_radius);
        let reach = ring + super::ball_reach(map, self.tube_radius);
        let center = map.transform_point3(self.center);
        Bounds::new(center - reach, center + reach)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let (h, rho) = super::cylindrical(p - self.center, super::unit(self.normal));
        (h.hypot(rho - self.ring_radius) - self.tube_radius).max(0.0).powi(2)
    }

    /// All points of the ring are equally near to a point of its axis: there the gradient jumps, unless it is
    /// zero.
    fn kink_distance(&self, p: DVec3) -> f64 {
        if self.ring_radius == 0.0 {
            return f64::INFINITY;
        }
        super::cylindrical(p - self.center, super::unit(self.normal)).1
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(super::along(self.normal), self.center)
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        row.extend([scale * self.ring_radius, scale * self.tube_radius]);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let rho = super::emit_off_axis(d, p);
        let off = d.sub(rho, row[0]);
        let square = super::sum_of_squares(d, off, p[2]);
        super::outside_squared(d, square, row[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let torus = Torus { center: DVec3::ZERO, normal: DVec3::X, ring_radius: 3.0, tube_radius: 1.0 };
        // The last is on the axis: sqrt(radius^2 + height^2) - 1.
        for (p, expected) in
            [([0.0, 3.0, 0.0], 0.0), ([0.5, 0.0, 3.5], 0.0), ([0.0, 1.0, 0.0], 1.0), ([4.0, 0.0, 6.0], 16.0), ([4.0, 0.0, 0.0], 16.0)]
        {
            testing::same_everywhere(&torus, p.into(), expected);
        }
        assert_eq!(torus.kink_distance(DVec3::new(9.0, 0.0, 0.0)), 0.0);
        assert_eq!(torus.kink_distance(DVec3::new(9.0, 3.0, 4.0)), 5.0);
    }

    #[test]
    fn without_a_tube_it_is_a_ring_and_without_a_ring_a_sphere() {
        let (center, normal) = (DVec3::new(1.0, -1.0, 0.5), DVec3::new(1.0, 2.0, 2.0));
        let thin = Torus { center, normal, ring_radius: 2.0, tube_radius: 0.0 };
        let ring = crate::skeleton::Ring { center, normal, radius: 2.0 };
        let fat = Torus { center, normal, ring_radius: 0.0, tube_radius: 2.0 };
        let sphere = crate::skeleton::Sphere { center, radius: 2.0 };
        let mut rng = fastrand::Rng::with_seed(1);
        for _ in 0..100 {
            let p = testing::position(&mut rng);
            assert!((thin.distance_squared(p) - ring.distance_squared(p)).abs() < 1e-12);
            assert!((fat.distance_squared(p) - sphere.distance_squared(p)).abs() < 1e-12);
        }
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.5, |rng| {
            let torus = Torus {
                center: testing::position(rng),
                normal: testing::direction(rng),
                ring_radius: 2.0 * rng.f64(),
                tube_radius: rng.f64(),
            };
            let (e1, e2) = torus.normal.any_orthonormal_pair();
            let samples = (0..60)
                .map(|i| f64::from(i) / 60.0 * std::f64::consts::TAU)
                .flat_map(|turn| {
                    let out = turn.cos() * e1 + turn.sin() * e2;
                    testing::polar(4, 24).map(move |(r, around)| {
                        let tube = torus.tube_radius * r;
                        torus.center + (torus.ring_radius + tube * around.cos()) * out + tube * around.sin() * torus.normal
                    })
                })
                .collect();
            (torus, samples)
        });
    }
}
