//! The repetition about an axis: copies of the child at equal angles, like spokes.
//!
//! The child stands about the first of the two directions across the axis (x for axis z, y for x, z for y),
//! and is the first copy; the other copies are turned by multiples of a turn over `count`. Each point belongs
//! to the sector of the nearest copy, so copies cost nothing; a child that leaves its sector is cut at the
//! wall. Copies that meet at the axis meet without a jump.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use jbt_ir::Domain;

use super::repeat::ROUND;
use super::{WarpGrowth, UNDERFLOW, WarpFault, WarpMember, turned};
use crate::angle;
use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// Copies about a coordinate axis through the origin.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct RepeatAround = "repeat_around" {
        /// The axis.
        pub axis: Axis [Axis] = Vector([0.0, 0.0, 1.0]),
        /// How many there are: a whole number of at least 1.
        pub count: f64 [Count],
    }
}

impl RepeatAround {
    /// The angle of a point in sectors.
    fn sectors(&self, p: DVec3) -> f64 {
        let [_, u, v] = self.axis.order();
        p[v].atan2(p[u]) * self.count / TAU
    }
}

impl WarpMember for RepeatAround {
    const COLUMNS: &'static [&'static str] = &["sectors", "sector"];
    const CREASES: bool = true;

    fn inverse(&self, p: DVec3) -> DVec3 {
        let [_, u, v] = self.axis.order();
        let (sin, cos) = (self.sectors(p).round() * TAU / self.count).sin_cos();
        let mut q = p;
        q[u] = cos * p[u] + sin * p[v];
        q[v] = cos * p[v] - sin * p[u];
        q
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        if self.count == 1.0 {
            return f64::INFINITY;
        }
        let [_, u, v] = self.axis.order();
        let sectors = self.sectors(p);
        let to_wall = 0.5 - (sectors - sectors.round()).abs();
        p[u].hypot(p[v]) * (to_wall * TAU / self.count).min(0.5 * PI).sin()
    }

    fn fault(&self) -> Option<WarpFault> {
        (self.count == 0.0).then(|| WarpFault {
            message: "there are 0 copies around the axis".to_owned(),
            expected: "expected at least 1",
        })
    }

    fn forward_bounds(&self, child: Bounds) -> Bounds {
        if child.is_empty() || self.count == 1.0 {
            return child;
        }
        turned(self.axis, child, 1.0)
    }

    /// For every copy, the computed sine and cosine belong to one angle, except for rounding: see the twist.
    fn reach(&self, child: Bounds) -> Bounds {
        if child.is_empty() {
            return child;
        }
        turned(self.axis, child.grown(UNDERFLOW), 1.0 + 2f64.powi(-20))
    }

    fn growth(&self, largest: f64) -> WarpGrowth {
        WarpGrowth { coordinates: 1.5 * largest, derivatives: 2.0 }
    }

    fn columns(&self, row: &mut Vec<f64>) {
        row.extend([self.count / TAU, TAU / self.count]);
    }

    fn variant(&self) -> u8 {
        self.axis as u8
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        let [_, u, v] = Axis::ALL[usize::from(variant)].order();
        let half_turn = d.constant(PI as f32);
        // The number of the copy is constant near the point, so the angle has no slope.
        let still = [d.stop_gradient(p[u]), d.stop_gradient(p[v])];
        let polar = angle::emit(d, still, still[1], half_turn, f32::MIN_POSITIVE);
        let sectors = d.mul(polar.angle, row[0]);
        let round = d.constant(ROUND);
        let shifted = d.add(sectors, round);
        let copy = d.sub(shifted, round);
        let turn = d.mul(copy, row[1]);
        let (sin, cos) = (d.sin(turn), d.cos(turn));
        let mut q = p;
        let sv = d.mul(sin, p[v]);
        q[u] = d.fma(cos, p[u], sv);
        let su = d.mul(sin, p[u]);
        let minus = d.neg(su);
        q[v] = d.fma(cos, p[v], minus);
        q
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing;

    #[test]
    fn copies_stand_around() {
        let four = RepeatAround { axis: Axis::Z, count: 4.0 };
        let spoke = DVec3::new(2.0, 0.5, 7.0);
        for p in [[2.0, 0.5], [-0.5, 2.0], [-2.0, -0.5], [0.5, -2.0]] {
            testing::same(&four.into(), DVec3::new(p[0], p[1], 7.0), spoke);
        }
        let three = RepeatAround { axis: Axis::X, count: 3.0 };
        testing::same(&three.into(), DVec3::new(1.0, -0.5, 0.75f64.sqrt()), DVec3::new(1.0, 1.0, 0.0));
        testing::finite(&three.into(), DVec3::X);
        assert!(RepeatAround { axis: Axis::X, count: 0.0 }.fault().is_some());
    }

    #[test]
    fn decides_at_its_walls() {
        let four = RepeatAround { axis: Axis::Z, count: 4.0 };
        assert!(four.kink_distance(DVec3::new(1.0, 1.0, 0.0)).abs() < 1e-15);
        assert!((four.kink_distance(DVec3::new(2.0, 0.0, 0.0)) - 2f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn agrees_with_the_laws_of_warps() {
        testing::judge(|rng| RepeatAround { axis: Axis::ALL[rng.usize(..3)], count: f64::from(rng.u8(1..9)) });
    }
}
