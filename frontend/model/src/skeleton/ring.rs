//! The ring: the skeleton of a torus.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry, uv};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A circle, not filled. With radius 0 it is a point.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Ring = "ring" {
        /// Its middle.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// The direction of its axis, of any length but 0; either of the two.
        pub normal: DVec3 [Direction] = Vector([0.0, 0.0, 1.0]),
        /// Its distance from the middle.
        pub radius: f64 [NonNegative],
    }
}

impl SkeletonMember for Ring {
    const COLUMNS: &'static [&'static str] = &["radius"];
    const SYMMETRY: Symmetry = Symmetry::Axis;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let reach = super::circle_reach(map, super::unit(self.normal), self.radius);
        let center = map.transform_point3(self.center);
        Bounds::new(center - reach, center + reach)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let (h, rho) = super::cylindrical(p - self.center, super::unit(self.normal));
        h * h + (rho - self.radius).powi(2)
    }

    /// All points of the ring are equally near to a point of its axis: there the gradient jumps.
    fn kink_distance(&self, p: DVec3) -> f64 {
        if self.radius == 0.0 { f64::INFINITY } else { super::cylindrical(p - self.center, super::unit(self.normal)).1 }
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(super::along(self.normal), self.center)
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        row.push(scale * self.radius);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let rho = super::emit_off_axis(d, p);
        let off = d.sub(rho, row[0]);
        super::sum_of_squares(d, off, p[2])
    }

    const UV_COLUMNS: &'static [&'static str] = &["uv_radius"];

    /// u: the angle about the normal. v: the angle about the circle, from 0 outside of it over 1/4 above it
    /// (where the normal goes) and 1/2 inside of it.
    fn uv(&self, p: DVec3) -> [f64; 2] {
        let q = uv::within(&self.uv_frame(), p);
        [uv::turn(q.x, q.y), uv::turn(q.x.hypot(q.y) - self.radius, q.z)]
    }

    fn uv_kink_distance(&self, p: DVec3) -> f64 {
        let q = uv::within(&self.uv_frame(), p);
        uv::turn_kink_distance(q.x, q.y).min(uv::turn_kink_distance(q.x.hypot(q.y) - self.radius, q.z))
    }

    fn uv_frame(&self) -> DAffine3 {
        uv::frame(super::direction(self.normal), self.center)
    }

    fn uv_columns(&self, row: &mut Vec<f64>) {
        row.push(self.radius);
    }

    fn emit_uv<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 2] {
        let rho = super::emit_off_axis(d, p);
        let off = d.sub(rho, row[0]);
        [uv::emit_turn(d, p[0], p[1]), uv::emit_turn(d, off, p[2])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let ring = Ring { center: DVec3::ZERO, normal: DVec3::X, radius: 3.0 };
        // The last is on the axis: radius^2 + height^2.
        for (p, expected) in [([0.0, 3.0, 0.0], 0.0), ([0.0, 1.0, 0.0], 4.0), ([4.0, 0.0, 6.0], 25.0), ([4.0, 0.0, 0.0], 25.0)] {
            testing::same_everywhere(&ring, p.into(), expected);
        }
        assert_eq!(ring.kink_distance(DVec3::new(9.0, 0.0, 0.0)), 0.0);
        assert_eq!(ring.kink_distance(DVec3::new(9.0, 3.0, 4.0)), 5.0);
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(2e-2, |rng| {
            let ring = Ring { center: testing::position(rng), normal: testing::direction(rng), radius: 4.0 * rng.f64() };
            let (e1, e2) = ring.normal.any_orthonormal_pair();
            let samples = (0..2000)
                .map(|i| f64::from(i) / 2000.0 * std::f64::consts::TAU)
                .map(|turn| ring.center + ring.radius * (turn.cos() * e1 + turn.sin() * e2))
                .collect();
            (ring, samples)
        });
    }

    #[test]
    fn uv_goes_around_both_ways() {
        let ring = Ring { center: DVec3::ZERO, normal: DVec3::Z, radius: 2.0 };
        for (p, expected) in [
            ([0.0, 3.0, 0.0], [0.25, 0.0]),
            ([0.0, 2.0, 1.0], [0.25, 0.25]),
            ([0.0, 1.0, 0.0], [0.25, 0.5]),
            ([-2.0, 0.0, -1.0], [0.5, 0.75]),
            ([0.0, 0.0, 0.0], [0.0, 0.5]),
        ] {
            testing::same_uv(&ring, p.into(), expected);
        }
        testing::judge_uv(|rng| Ring { center: testing::position(rng), normal: testing::direction(rng), radius: 2.0 });
    }
}
