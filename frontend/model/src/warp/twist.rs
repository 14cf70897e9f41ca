//! The twist: slices across an axis turn in proportion to their height (Barr 1984).
//!
//! At height h along the axis the child appears turned by `rate * h` radians, right-handed about the axis.
//! Volumes stay.

use glam::DVec3;
use jbt_ir::Domain;

use super::{WarpGrowth, WarpFault, WarpMember, turned};
use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::member::member;

member! {
    /// A twist about an axis through the origin.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Twist = "twist" {
        /// The axis.
        pub axis: Axis [Axis] = Vector([0.0, 0.0, 1.0]),
        /// Radians for each unit of length along the axis.
        pub rate: f64 [Real],
    }
}

impl WarpMember for Twist {
    const COLUMNS: &'static [&'static str] = &["rate"];

    fn inverse(&self, p: DVec3) -> DVec3 {
        let [h, u, v] = self.axis.order();
        let (sin, cos) = (self.rate * p[h]).sin_cos();
        let mut q = p;
        q[u] = cos * p[u] + sin * p[v];
        q[v] = cos * p[v] - sin * p[u];
        q
    }

    fn kink_distance(&self, _: DVec3) -> f64 {
        f64::INFINITY
    }

    fn fault(&self) -> Option<WarpFault> {
        None
    }

    fn forward_bounds(&self, child: Bounds) -> Bounds {
        if child.is_empty() || self.rate == 0.0 {
            return child;
        }
        // Whatever the angle, a point keeps its height and its distance to the axis.
        turned(self.axis, child, 1.0)
    }

    /// Whatever the angle and its rounding, the computed sine and cosine belong to one angle, each off by
    /// less than 2 units of 2^-24; a product, and a fused step over it, add a unit each. So the distance to
    /// the axis is off by less than 2^-20 of itself (and the underflow of a product, below 2^-140). The
    /// height is exact. A twist whose rate is zero in f32 changes nothing.
    fn reach(&self, child: Bounds) -> Bounds {
        if child.is_empty() || self.rate == 0.0 {
            return child;
        }
        turned(self.axis, child, 1.0 + 2f64.powi(-20))
    }

    fn growth(&self, largest: f64) -> WarpGrowth {
        // A coordinate is at most sqrt(2) times as large; it depends on the two coordinates that turn, and on
        // the height.
        let coordinates = 1.5 * largest;
        WarpGrowth { coordinates, derivatives: 2.0 + 2.0 * self.rate.abs() * coordinates }
    }

    fn columns(&self, row: &mut Vec<f64>) {
        row.push(self.rate);
    }

    fn variant(&self) -> u8 {
        self.axis as u8
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        let [h, u, v] = Axis::ALL[usize::from(variant)].order();
        let angle = d.mul(row[0], p[h]);
        // An infinite angle has no sine; an angle of f32::MAX counts as 0.
        let (largest, smallest) = (d.constant(f32::MAX), d.constant(f32::MIN));
        let angle = d.min(angle, largest);
        let angle = d.max(angle, smallest);
        let (sin, cos) = (d.sin(angle), d.cos(angle));
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
    fn a_quarter_turn_after_one_unit() {
        let twist = Twist { axis: Axis::Z, rate: std::f64::consts::FRAC_PI_2 };
        // What appears at +y at height 1 is what the child has at +x.
        assert!(twist.inverse(DVec3::new(0.0, 1.0, 1.0)).abs_diff_eq(DVec3::new(1.0, 0.0, 1.0), 1e-15));
    }

    #[test]
    fn agrees_with_the_laws_of_warps() {
        testing::judge(|rng| Twist { axis: Axis::ALL[rng.usize(..3)], rate: testing::real(rng) });
    }

    /// The gradient of a twisted field, of a formula that was worked by hand: `J^T g` with
    /// `J = d inverse / dp`. A published system turns the child's gradient back but omits the derivative of
    /// the angle by the height.
    #[test]
    fn the_gradient_knows_that_the_angle_moves_with_the_height() {
        let twist = Twist { axis: Axis::Z, rate: 0.7 };
        let p = DVec3::new(0.3, -0.4, 0.5);
        let jacobian = testing::jacobian(&twist.into(), p);
        let (q, (sin, cos)) = (twist.inverse(p), (0.7 * p.z).sin_cos());
        for (g, expected) in [
            (DVec3::X, DVec3::new(cos, sin, 0.7 * q.y)),
            (DVec3::Y, DVec3::new(-sin, cos, -0.7 * q.x)),
            (DVec3::Z, DVec3::Z),
        ] {
            assert!((jacobian.transpose() * g).abs_diff_eq(expected, 1e-6), "{jacobian}");
        }
    }

    /// A published system reuses the box of the child: a bar across the axis, turned by 90 degrees, leaves
    /// that box and is clipped.
    #[test]
    fn the_box_of_the_child_would_clip() {
        let bar = Bounds::new(DVec3::new(-3.0, -0.1, 0.9), DVec3::new(3.0, 0.1, 1.1));
        let twist = Twist { axis: Axis::Z, rate: std::f64::consts::FRAC_PI_2 };
        let there = DVec3::new(0.0, 2.9, 1.0);
        assert!(testing::holds(bar, twist.inverse(there)) && !testing::holds(bar, there));
        assert!(testing::holds(twist.forward_bounds(bar), there) && testing::holds(twist.reach(bar), there));
    }
}
