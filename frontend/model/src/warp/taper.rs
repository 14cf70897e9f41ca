//! The taper: slices across an axis shrink or grow with their height (Barr 1984), linearly between two
//! heights.
//!
//! ```text
//!   start 1, end 0.3                r(h) = start + (end - start) t,   t = (h - from) / (to - from), clamped to [0, 1]
//!      to  ___|_|___                inverse: the two coordinates across the axis are divided by r
//!          __/   \__
//!    from  _|     |_                Below and above, the scale stays what it is at the end.
//! ```
//!
//! A scale of zero makes a tip. Scales below [`SMALLEST_SCALE`] are raised to it, so that everything is
//! finite: beyond a tip there is a needle with 1/65,536 of the child's width.

use glam::DVec3;
use jbt_ir::Domain;

use super::{WarpGrowth, ROUNDINGS, UNDERFLOW, WarpFault, WarpMember};
use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::member::member;

/// The smallest scale across the axis: Axis::Z^-16.
pub const SMALLEST_SCALE: f64 = 1.0 / 65_536.0;

member! {
    /// A taper along an axis through the origin.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Taper = "taper" {
        /// The axis.
        pub axis: Axis [Axis] = Vector([0.0, 0.0, 1.0]),
        /// The height at which the scale begins to change.
        pub from: f64 [Real],
        /// The height at which it ends, above or below.
        pub to: f64 [Real],
        /// The scale across the axis at the first height, at least 0.
        pub start: f64 [NonNegative] = Real(1.0),
        /// The scale at the second.
        pub end: f64 [NonNegative],
    }
}

impl Taper {
    fn scale(&self, height: f64) -> f64 {
        let t = ((height - self.from) / (self.to - self.from)).clamp(0.0, 1.0);
        (self.start + (self.end - self.start) * t).max(SMALLEST_SCALE)
    }

    fn largest(&self) -> f64 {
        self.start.max(self.end).max(SMALLEST_SCALE)
    }

    /// A box around the image of a child, with the scales between heights low and high, each off by up to
    /// `slack`.
    fn scaled(&self, child: Bounds, low: f64, high: f64, slack: f64) -> Bounds {
        let [_, u, v] = self.axis.order();
        let (a, b) = (self.scale(low), self.scale(high));
        let (least, most) = ((a.min(b) - slack).max(0.0), a.max(b) + slack);
        let mut scaled = child;
        for axis in [u, v] {
            let (min, max) = (child.min[axis], child.max[axis]);
            scaled.min[axis] = min * if min < 0.0 { most } else { least };
            scaled.max[axis] = max * if max > 0.0 { most } else { least };
        }
        scaled
    }
}

impl WarpMember for Taper {
    const COLUMNS: &'static [&'static str] = &["from", "inverse_height", "start", "change"];

    fn inverse(&self, p: DVec3) -> DVec3 {
        let [h, u, v] = self.axis.order();
        let scale = self.scale(p[h]);
        let mut q = p;
        q[u] /= scale;
        q[v] /= scale;
        q
    }

    fn kink_distance(&self, p: DVec3) -> f64 {
        if self.start == self.end {
            return f64::INFINITY;
        }
        let height = p[self.axis.order()[0]];
        let t = (height - self.from) / (self.to - self.from);
        let scale = self.start + (self.end - self.start) * t;
        let ends = (height - self.from).abs().min((height - self.to).abs());
        // The crease where the scale reaches the smallest one is next to the tip.
        if self.start.min(self.end) < SMALLEST_SCALE { ends.min((scale - SMALLEST_SCALE).abs()) } else { ends }
    }

    fn fault(&self) -> Option<WarpFault> {
        let height = (self.to - self.from).abs();
        (height < jbt_ir::limits::MIN_LENGTH).then(|| WarpFault {
            message: format!("the taper goes from {} to {}", self.from, self.to),
            expected: "expected two different heights",
        })
    }

    fn forward_bounds(&self, child: Bounds) -> Bounds {
        if child.is_empty() {
            return child;
        }
        let [h, ..] = self.axis.order();
        self.scaled(child, child.min[h], child.max[h], 0.0)
    }

    /// The height is exact, and `q r` is p with an error of 3 units of 2^-24. The scale is computed at a
    /// height whose error is 3 units of itself, of `from` and of the distance between the two, and is off by
    /// 4 units of the largest scale.
    fn reach(&self, child: Bounds) -> Bounds {
        if child.is_empty() {
            return child;
        }
        let [h, ..] = self.axis.order();
        let lost = |height: f64| ROUNDINGS * (height.abs() + self.from.abs() + self.to.abs());
        let (low, high) = (child.min[h], child.max[h]);
        let mut reach = self.scaled(child, low - lost(low), high + lost(high), ROUNDINGS * self.largest());
        for axis in self.axis.order().into_iter().skip(1) {
            reach.min[axis] -= UNDERFLOW + ROUNDINGS * reach.min[axis].abs();
            reach.max[axis] += UNDERFLOW + ROUNDINGS * reach.max[axis].abs();
        }
        reach
    }

    fn growth(&self, largest: f64) -> WarpGrowth {
        let inverse = 1.01 / self.start.min(self.end).max(SMALLEST_SCALE);
        let steepness = (self.end - self.start).abs() / (self.to - self.from).abs();
        let coordinates = largest * inverse.max(1.0);
        WarpGrowth { coordinates, derivatives: 1.0 + inverse + 2.0 * coordinates * inverse * steepness }
    }

    fn columns(&self, row: &mut Vec<f64>) {
        row.extend([self.from, 1.0 / (self.to - self.from), self.start, self.end - self.start]);
    }

    fn variant(&self) -> u8 {
        self.axis as u8
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, p: [D::Real; 3], row: &[D::Real]) -> [D::Real; 3] {
        let [from, inverse_height, start, change] = row[..] else { unreachable!("a taper has four columns") };
        let [h, u, v] = Axis::ALL[usize::from(variant)].order();
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        let above = d.sub(p[h], from);
        let t = d.mul(above, inverse_height);
        // At the ends the operand order chooses t, with its slope.
        let t = d.max(zero, t);
        let t = d.min(one, t);
        let scale = d.fma(change, t, start);
        let smallest = d.constant(SMALLEST_SCALE as f32);
        let scale = d.max(scale, smallest);
        let inverse = d.div(one, scale);
        let mut q = p;
        q[u] = d.mul(p[u], inverse);
        q[v] = d.mul(p[v], inverse);
        q
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing;

    #[test]
    fn a_slice_shrinks_as_its_height_says() {
        let taper = Taper { axis: Axis::Z, from: 0.0, to: 2.0, start: 1.0, end: 0.5 };
        for (height, scale) in [(-5.0, 1.0), (0.0, 1.0), (1.0, 0.75), (2.0, 0.5), (7.0, 0.5)] {
            let q = DVec3::new(3.0, -4.0, height);
            testing::same(&taper.into(), DVec3::new(3.0 * scale, -4.0 * scale, height), q);
        }
        let back = Taper { from: 2.0, to: 0.0, start: 0.5, end: 1.0, ..taper };
        assert_eq!(back.inverse(DVec3::new(1.0, 2.0, 0.3)), taper.inverse(DVec3::new(1.0, 2.0, 0.3)));
    }

    #[test]
    fn agrees_with_the_laws_of_warps() {
        testing::judge(|rng| {
            let [from, to] = [(); 2].map(|()| testing::real(rng));
            let [start, end] = [(); 2].map(|()| if rng.u8(..4) == 0 { 0.0 } else { 2.0 * rng.f64() });
            Taper { axis: Axis::ALL[rng.usize(..3)], from, to, start, end }
        });
    }

    #[test]
    fn taper_at_radius_zero_is_finite() {
        let taper = Taper { axis: Axis::Z, from: 0.0, to: 1.0, start: 1.0, end: 0.0 };
        for p in [[0.0, 0.0, 1.0], [0.5, 0.0, 1.0], [0.0, 0.0, 9.0], [1e6, -1e6, 1.0], [0.0, 0.0, 0.999_999]] {
            testing::finite(&taper.into(), p.into());
        }
        assert_eq!(taper.inverse(DVec3::new(1.0, 0.0, 1.0)).x, 65_536.0);
        let nothing = Taper { start: 0.0, ..taper };
        testing::finite(&nothing.into(), DVec3::ONE);
    }

    #[test]
    fn equal_heights_are_a_fault() {
        let taper = Taper { axis: Axis::X, from: 1.0, to: 1.0, start: 1.0, end: 0.5 };
        assert_eq!(taper.fault().unwrap().message, "the taper goes from 1 to 1");
        assert_eq!(Taper { to: 1.5, ..taper }.fault(), None);
    }
}
