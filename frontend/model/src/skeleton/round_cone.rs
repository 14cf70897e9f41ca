//! The round cone: a capsule with two radii, also called cone-sphere or tapered capsule; the hull of two
//! balls.
//!
//! It is the union of balls along its axis, and the nearest ball decides. With the axis along z, balls of
//! radius `r + k tau` at the heights `tau`, and y the distance from the axis,
//! `sqrt(y^2 + (z - tau)^2) - k tau` is smallest at
//!
//! ```text
//! tau = clamp(z + lean y, -half, half)        lean = k / sqrt(1 - k^2),   k = (r2 - r1) / length
//! ```
//!
//! If k has magnitude 1 or more, one ball holds the other and is the skeleton. At the minimum the derivative
//! by tau is 0, so the gradient is the gradient of the distance from the ball at a fixed tau
//! (`stop_gradient`). For the same reason an error of tau counts in the second order only: with rounding u,
//! the error of `lean y` is below `3 u y / sqrt(1 - k^2)`, and adds less than `5 u^2 y` to the distance.

use glam::{DAffine3, DVec3};
use jbt_ir::Domain;

use super::ends;
use super::{SkeletonMember, Symmetry};
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// The hull of two balls. Equal radii make it a solid capsule, equal middles the larger ball.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct RoundCone = "round_cone" {
        /// The middle of one ball.
        pub from: DVec3 [Position],
        /// The middle of the other.
        pub to: DVec3 [Position],
        /// The radius of the one at `from`.
        pub from_radius: f64 [NonNegative],
        /// The radius of the one at `to`.
        pub to_radius: f64 [NonNegative],
    }
}

/// A round cone in the terms of the formula.
struct Profile {
    /// The middle of the axis.
    middle: DVec3,
    /// Half the length of the axis.
    half: f64,
    /// How fast the radius grows with the height: below 1 in magnitude.
    slope: f64,
    /// The radius in the middle.
    radius: f64,
}

impl RoundCone {
    fn profile(&self) -> Profile {
        let Self { from, to, from_radius, to_radius } = *self;
        let (length, growth) = (self.from.distance(self.to), to_radius - from_radius);
        if growth.abs() < length {
            let (middle, radius) = (from.midpoint(to), 0.5 * (from_radius + to_radius));
            return Profile { middle, half: 0.5 * length, slope: growth / length, radius };
        }
        let (middle, radius) =
            if growth > 0.0 { (to, to_radius) } else { (from, from_radius) };
        Profile { middle, half: 0.0, slope: 0.0, radius }
    }
}

impl SkeletonMember for RoundCone {
    const COLUMNS: &'static [&'static str] = &["half", "lean", "slope", "radius"];
    const SYMMETRY: Symmetry = Symmetry::Arrow;

    fn bounds_under(&self, map: &DAffine3) -> Bounds {
        let ends = [(self.from, self.from_radius), (self.to, self.to_radius)];
        ends::bounds_under(map, ends, |radius| super::ball_reach(map, radius))
    }

    fn distance_squared(&self, p: DVec3) -> f64 {
        let Self { from, to, from_radius, to_radius } = *self;
        let length = self.from.distance(self.to);
        let balls = [(from, from_radius), (to, to_radius)].map(|(at, radius)| p.distance(at) - radius);
        let mut nearest = balls[0].min(balls[1]);
        let k = (to_radius - from_radius) / length;
        // NaN where the ends are equal.
        if k.abs() < 1.0 {
            let (x, y) = super::cylindrical(p - from, super::unit(to - from));
            let tau = (x + y * k / (1.0 - k * k).sqrt()).clamp(0.0, length);
            nearest = nearest.min((x - tau).hypot(y) - (from_radius + k * tau));
        }
        nearest.max(0.0).powi(2)
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn pose(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(super::towards(self.to - self.from), self.profile().middle)
    }

    fn columns(&self, scale: f64, row: &mut Vec<f64>) {
        let Profile { half, slope, radius, .. } = self.profile();
        // 1 - k^2 is at least 2^-53, so that the lean is below 2^27.
        let lean = slope / ((1.0 - slope) * (1.0 + slope)).sqrt();
        row.extend([scale * half, lean, slope, scale * radius]);
    }

    fn emit<D: Domain>(d: &mut D, [x, y, z]: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let (half, lean, slope, radius) = (row[0], row[1], row[2], row[3]);
        let rho = super::emit_off_axis(d, [x, y, z]);
        let tau = d.fma(rho, lean, z);
        let tau = d.min(tau, half);
        let lowest = d.neg(half);
        let tau = d.max(tau, lowest);
        let tau = d.stop_gradient(tau);
        let along = d.sub(z, tau);
        let square = super::length_squared(d, [x, y, along]);
        let radius = d.fma(slope, tau, radius);
        super::outside_squared(d, square, radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::{Sphere, testing};

    fn cone(length: f64, from_radius: f64, to_radius: f64) -> RoundCone {
        RoundCone { from: DVec3::ZERO, to: DVec3::new(length, 0.0, 0.0), from_radius, to_radius }
    }

    #[test]
    fn known_distances() {
        // k = -3/5: the flank is tangent to both balls, with the normal (3/5, 4/5).
        let round = cone(5.0, 4.0, 1.0);
        for (p, expected) in [
            ([2.0, 1.0, 0.0], 0.0),
            ([-7.0, 0.0, 0.0], 9.0),
            ([9.0, 0.0, 0.0], 9.0),
            // 5 off the flank where it meets the ball of radius 2.5 in the middle.
            ([2.5 + 7.5 * 0.6, 7.5 * 0.8, 0.0], 25.0),
            ([2.5 + 2.5 * 0.6, 0.0, 2.5 * 0.8], 0.0),
        ] {
            testing::same_everywhere(&round, p.into(), expected);
        }
        let point = cone(0.0, 0.0, 0.0);
        testing::same_everywhere(&point, DVec3::new(2.0, 3.0, 6.0), 49.0);
    }

    /// The foot of the perpendicular, moved by the slope of the radius, `tau = x - y (r1 - r2) / L`, is near
    /// the nearest ball but not on it.
    #[test]
    fn the_nearest_ball_and_not_one_near_it() {
        let round = cone(5.0, 0.5, 2.0);
        let (k, p): (f64, DVec3) = (0.3, DVec3::new(1.0, 4.0, 0.0));
        let from_ball = |tau: f64| (p.x - tau).hypot(p.y) - (0.5 + k * tau);
        let best = (0..=1_000_000).map(|i| from_ball(5e-6 * f64::from(i))).fold(f64::INFINITY, f64::min);
        let ours = round.distance_squared(p).sqrt();
        assert!((ours - best).abs() < 1e-9, "{ours}, not {best}");
        assert!((f64::from(testing::emitted(&round, p)).sqrt() - best).abs() < 1e-6);
        let other = p.x - p.y * (0.5 - 2.0) / 5.0;
        let worse = from_ball(other) - best;
        assert!(worse > 3e-4, "the distance differs a thousand times more than by rounding: {worse}");
        let direction = |tau: f64| (p - DVec3::new(tau, 0.0, 0.0)).normalize();
        let nearest = p.x + p.y * k / (1.0 - k * k).sqrt();
        let turned = direction(other).angle_between(direction(nearest));
        assert!(turned.to_degrees() > 0.7, "the gradient turns by {turned}");
        let step = 1e-6;
        let slope = DVec3::from_array(DVec3::AXES.map(|axis| {
            let at = |t: f64| round.distance_squared(p + t * axis).sqrt();
            (at(step) - at(-step)) / (2.0 * step)
        }));
        assert!((slope - direction(nearest)).length() < 1e-8, "{slope}");
        assert!((slope - direction(other)).length() > 1e-2, "{slope}");
    }

    #[test]
    fn a_ball_that_holds_the_other_is_alone() {
        let mut rng = fastrand::Rng::with_seed(5);
        for (length, from_radius, to_radius) in
            [(1.0, 3.0, 1.0), (1.0, 1.0, 3.0), (2.0, 3.0, 1.0), (0.0, 1.0, 2.0), (0.0, 2.0, 2.0), (1.0, 0.5, 1.5)]
        {
            let round = cone(length, from_radius, to_radius);
            let larger = if from_radius > to_radius { (round.from, from_radius) } else { (round.to, to_radius) };
            let ball = Sphere { center: larger.0, radius: larger.1 };
            for _ in 0..50 {
                let p = testing::position(&mut rng).as_vec3().as_dvec3();
                testing::same_everywhere(&round, p, ball.distance_squared(p));
            }
        }
    }

    #[test]
    fn slopes_near_one_are_as_good_as_others() {
        let mut rng = fastrand::Rng::with_seed(6);
        for exponent in 1..16 {
            let round = cone(1.0, 0.25, 1.25 - 10f64.powi(-exponent));
            for _ in 0..200 {
                let p = testing::position(&mut rng).as_vec3().as_dvec3();
                let (got, expected) =
                    (f64::from(testing::emitted(&round, p)).sqrt(), round.distance_squared(p).sqrt());
                assert!((got - expected).abs() < 3e-6, "{round:?} at {p}: {got}, not {expected}");
            }
        }
    }

    #[test]
    fn agrees_with_samples_of_the_set() {
        testing::judge(0.8, |rng| {
            let (from, to) = (testing::position(rng), testing::position(rng) * 0.5);
            let [from_radius, to_radius] = [2.0 * rng.f64(), if rng.bool() { 0.0 } else { 2.0 * rng.f64() }];
            let balls = (0..=40).flat_map(|i| {
                let t = f64::from(i) / 40.0;
                let (at, radius) = (from.lerp(to, t), from_radius + t * (to_radius - from_radius));
                testing::ball(5).map(move |v| at + radius * v)
            });
            (RoundCone { from, to, from_radius, to_radius }, balls.collect())
        });
    }
}
