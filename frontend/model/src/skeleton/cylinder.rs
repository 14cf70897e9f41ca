//! The cylinder: a solid one, with flat ends.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::{SkeletonMember, Symmetry, uv};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A solid cylinder: the points within `radius` of its axis and between the planes of its ends.
    ///
    /// With radius 0 it is a segment. Equal ends make it a disc, whose axis is z since they say nothing else.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Cylinder = "cylinder" {
        /// One end of the axis.
        pub from: DVec3 [Position],
        /// The other end of the axis.
        pub to: DVec3 [Position],
        /// How far it reaches from the axis.
        pub radius: f64 [NonNegative],
    }
}

impl Cylinder {
    /// The direction of the axis.
    fn direction(&self) -> DVec3 {
        let direction = super::unit(self.to - self.from);
        if direction == DVec3::ZERO { DVec3::Z } else { direction }
    }
}

impl SkeletonMember for Cylinder {
    // Measured from the middle, both ends are one comparison.
    const COLUMNS: &'static [&'static str] = &["half", "radius"];
    const SYMMETRY: Symmetry = Symmetry::Axis;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let reach = super::circle_reach(map, self.direction(), self.radius);
        let ends = Bounds::around([self.from, self.to].map(|end| map.transform_point3(end)));
        Bounds::new(ends.min - reach, ends.max + reach)
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let (h, rho) = super::cylindrical(p - self.from, self.direction());
        let a = h - h.clamp(0.0, self.from.distance(self.to));
        a * a + (rho - self.radius).max(0.0).powi(2)
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    // Measured from the middle, both ends are one comparison.
    fn pose(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(super::along(self.direction()), self.from.midpoint(self.to))
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        row.extend([0.5 * scale * self.from.distance(self.to), scale * self.radius]);
    }

    fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let rho = super::emit_off_axis(d, p);
        let past_ends = super::beyond(d, p[2], row[0]);
        let off = d.sub(rho, row[1]);
        let past_side = super::positive_part(d, off);
        super::sum_of_squares(d, past_side, past_ends)
    }

    const UV_COLUMNS: &'static [&'static str] = &["inv_length"];

    /// u: the angle about the axis. v: how far along it is, from 0 at `from` to 1 at `to`; 1/2 where the ends
    /// are equal.
    fn uv(&self, p: DVec3) -> [f64; 2] {
        let q = uv::within(&self.uv_frame(), p);
        let along = q.z * uv::inverse(self.from.distance(self.to)) + 0.5;
        [uv::turn(q.x, q.y), along.clamp(0.0, 1.0)]
    }

    fn uv_kink_distance(&self, p: DVec3) -> f64 {
        let q = uv::within(&self.uv_frame(), p);
        uv::turn_kink_distance(q.x, q.y)
    }

    fn uv_frame(&self) -> DAffine3 {
        uv::frame(self.direction(), self.from.midpoint(self.to))
    }

    fn uv_columns(&self, row: &mut Vec<f64>) {
        row.push(uv::inverse(self.from.distance(self.to)));
    }

    fn emit_uv<D: Domain>(d: &mut D, [x, y, z]: [D::Real; 3], row: &[D::Real]) -> [D::Real; 2] {
        [uv::emit_turn(d, x, y), uv::emit_ramp(d, z, row[0], 0.5)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::testing;

    #[test]
    fn known_distances() {
        let cylinder = Cylinder { from: DVec3::ZERO, to: DVec3::new(0.0, 4.0, 0.0), radius: 1.0 };
        for (p, expected) in [
            ([0.5, 2.0, 0.5], 0.0),
            ([3.0, 2.0, 0.0], 4.0),
            ([0.5, 7.0, 0.0], 9.0),
            ([0.0, -2.0, 0.5], 4.0),
            ([4.0, 8.0, 0.0], 25.0),
            ([0.0, -4.0, -4.0], 25.0),
        ] {
            testing::same_everywhere(&cylinder, p.into(), expected);
        }
    }

    #[test]
    fn the_degenerate_ones() {
        let axis = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(0.0, 0.0, 3.0)];
        let thin = Cylinder { from: axis[0], to: axis[1], radius: 0.0 };
        testing::same_everywhere(&thin, DVec3::new(3.0, 0.0, 7.0), 25.0);
        let disc = Cylinder { from: axis[0], to: axis[0], radius: 2.0 };
        testing::same_everywhere(&disc, DVec3::new(0.0, 5.0, 5.0), 25.0);
        assert_eq!(disc.bounds_under(&DAffine3::IDENTITY), Bounds::new(DVec3::new(-2.0, -2.0, 1.0), DVec3::new(2.0, 2.0, 1.0)));
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.5, |rng| {
            let (from, to) = (testing::position(rng), testing::position(rng));
            let cylinder = Cylinder { from, to, radius: 2.0 * rng.f64() };
            let (e1, e2) = (to - from).normalize().any_orthonormal_pair();
            let samples = testing::polar(8, 48)
                .flat_map(|(r, turn)| {
                    let off = cylinder.radius * r * (turn.cos() * e1 + turn.sin() * e2);
                    (0..=40).map(move |i| from.lerp(to, f64::from(i) / 40.0) + off)
                })
                .collect();
            (cylinder, samples)
        });
    }

    #[test]
    fn uv_goes_around_and_along() {
        let cylinder = Cylinder { from: DVec3::ZERO, to: DVec3::new(0.0, 4.0, 0.0), radius: 1.0 };
        // Right-handed about y: from x to -z.
        testing::same_uv(&cylinder, DVec3::new(0.0, 1.0, -2.0), [0.25, 0.25]);
        testing::same_uv(&cylinder, DVec3::new(0.0, 9.0, 2.0), [0.75, 1.0]);
        testing::judge_uv(|rng| Cylinder { from: testing::position(rng), to: testing::position(rng), radius: 1.0 });
    }
}
