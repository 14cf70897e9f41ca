//! The disc: the skeleton of a coin with round rims.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry, uv};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A filled circle. With radius 0 it is a point.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Disc = "disc" {
        /// Its middle.
        pub center: DVec3 [Position] = Vector([0.0; 3]),
        /// The direction that it faces, of any length but 0; either of the two.
        pub normal: DVec3 [Direction] = Vector([0.0, 0.0, 1.0]),
        /// How far it reaches from the middle.
        pub radius: f64 [NonNegative],
    }
}

impl SkeletonMember for Disc {
    const COLUMNS: &'static [&'static str] = &["radius"];
    const SYMMETRY: Symmetry = Symmetry::Axis;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let reach = super::circle_reach(map, super::unit(self.normal), self.radius);
        let center = map.transform_point3(self.center);
        Bounds::new(center - reach, center + reach)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let (h, rho) = super::cylindrical(p - self.center, super::unit(self.normal));
        h * h + (rho - self.radius).max(0.0).powi(2)
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(super::along(self.normal), self.center)
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        row.push(scale * self.radius);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let rho = super::emit_off_axis(d, p);
        let beyond = d.sub(rho, row[0]);
        let outside = super::positive_part(d, beyond);
        super::sum_of_squares(d, outside, p[2])
    }

    const UV_COLUMNS: &'static [&'static str] = &["inv_radius"];

    /// u: the angle about the normal. v: the distance from the axis, from 0 in the middle to 1 at the rim; 0
    /// if the radius is.
    fn uv(&self, p: DVec3) -> [f64; 2] {
        let q = uv::within(&self.uv_frame(), p);
        [uv::turn(q.x, q.y), (q.x.hypot(q.y) * uv::inverse(self.radius)).min(1.0)]
    }

    fn uv_kink_distance(&self, p: DVec3) -> f64 {
        let q = uv::within(&self.uv_frame(), p);
        uv::turn_kink_distance(q.x, q.y)
    }

    fn uv_frame(&self) -> DAffine3 {
        uv::frame(super::direction(self.normal), self.center)
    }

    fn uv_columns(&self, row: &mut Vec<f64>) {
        row.push(uv::inverse(self.radius));
    }

    fn emit_uv<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 2] {
        let rho = super::emit_off_axis(d, p);
        [uv::emit_turn(d, p[0], p[1]), uv::emit_ramp(d, rho, row[0], 0.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let disc = Disc { center: DVec3::new(0.0, 0.0, 1.0), normal: DVec3::new(0.0, 0.0, -7.0), radius: 2.0 };
        for (p, expected) in [([1.0, 0.5, 4.0], 9.0), ([5.0, 0.0, 5.0], 25.0), ([0.0, 0.0, 1.0], 0.0), ([0.0, 2.0, 1.0], 0.0)] {
            testing::same_everywhere(&disc, p.into(), expected);
        }
    }

    #[test]
    fn radius_zero_is_a_point() {
        let disc = Disc { center: DVec3::ZERO, normal: DVec3::Y, radius: 0.0 };
        testing::same_everywhere(&disc, DVec3::new(2.0, 3.0, 6.0), 49.0);
        testing::same_everywhere(&disc, DVec3::ZERO, 0.0);
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.2, |rng| {
            let disc =
                Disc { center: testing::position(rng), normal: testing::direction(rng) * 3.0, radius: 4.0 * rng.f64() };
            let (e1, e2) = disc.normal.normalize().any_orthonormal_pair();
            let samples = testing::polar(60, 180)
                .map(|(r, turn)| disc.center + disc.radius * r * (turn.cos() * e1 + turn.sin() * e2))
                .collect();
            (disc, samples)
        });
    }

    #[test]
    fn uv_goes_around_and_outwards() {
        let disc = Disc { center: DVec3::new(1.0, 0.0, 0.0), normal: DVec3::new(0.0, 0.0, 3.0), radius: 2.0 };
        testing::same_uv(&disc, DVec3::new(1.0, 1.0, 5.0), [0.25, 0.5]);
        testing::same_uv(&disc, DVec3::new(-3.0, 0.0, 0.0), [0.5, 1.0]);
        testing::same_uv(&disc, disc.center, [0.0, 0.0]);
        testing::judge_uv(|rng| Disc { center: testing::position(rng), normal: testing::direction(rng), radius: 2.0 });
    }
}
