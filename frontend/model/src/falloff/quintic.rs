//! The quintic falloff `1 - 10 r^3 + 15 r^4 - 6 r^5`: curvature is continuous at both ends (C2). Perlin's
//! fade function of 2002, reversed.
//!
//! The factors of `(1 - r)^3 (1 + 3r + 6r^2)` move in opposite directions. With
//! `1 - r^3 = (1 - r)(1 + r + r^2)` the falloff becomes
//!
//! ```text
//! (1 - r^3)^3 / k,   k = (1 + r + r^2)^3 / (1 + 3r + 6r^2) = 1 + r^3 (7 + 6r + 3r^2 + r^3) / (1 + 3r + 6r^2)
//! ```
//!
//! and each step of k rises with r, if the last fraction is written
//! `r (7 + 6r + 3r^2 + r^3) / (t^2 + 3t + 6)` with `t = 1 / r`.

use jbt_ir::Domain;

use super::{Nearness, PlainFalloff, emit_square};

/// The quintic. Text: `quintic`, also `smootherstep`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Quintic;

/// The smallest r that is a divisor: 2^-12, the root of the least difference between 1 and another u.
const LEAST: f32 = 1.0 / (1 << 12) as f32;

impl PlainFalloff for Quintic {
    const NAME: &'static str = "quintic";
    const ALIASES: &'static [&'static str] = &["smootherstep"];
    const STEEPNESS: f64 = 32.0;

    fn value(s: f64) -> f64 {
        let r = s.sqrt();
        if s >= 1.0 { 0.0 } else { (1.0 - r).powi(3) * (1.0 + 3.0 * r + 6.0 * s) }
    }

    fn inverse(level: f64) -> f64 {
        super::bisect(Self::value, level)
    }

    fn emit<D: Domain>(d: &mut D, Nearness { u, .. }: Nearness<D::Real>) -> D::Real {
        let [one, three, six, seven, least] = [1.0, 3.0, 6.0, 7.0, LEAST].map(|number| d.constant(number));
        let s = emit_square(d, u);
        let r = d.sqrt(s);
        let cube = d.mul(s, r);
        let left = d.sub(one, cube);
        let square = d.mul(left, left);
        let numerator = d.mul(square, left);

        let sum = d.add(three, r);
        let sum = d.fma(r, sum, six);
        let sum = d.fma(r, sum, seven);
        let rising = d.mul(r, sum);
        let divisor = d.max(r, least);
        let t = d.div(one, divisor);
        let sum = d.add(t, three);
        let falling = d.fma(t, sum, six);
        let fraction = d.div(rising, falling);
        let k = d.add(one, fraction);
        d.div(numerator, k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::Falloff;
    use crate::falloff::testing::Published;

    #[test]
    fn published_values() {
        Published { half: Some(0.5), steepest: Some((0.5, 1.875)) }.check(Falloff::Quintic);
        // 1 - 10/64 + 15/256 - 6/1024
        assert!((Quintic::value(1.0 / 16.0) - 918.0 / 1024.0).abs() < 1e-15);
    }

    #[test]
    fn curvature_is_continuous_at_the_rim() {
        let g = |r: f64| Quintic::value(r * r);
        let curvature = |r: f64, h: f64| (g(r + h) - 2.0 * g(r) + g(r - h)) / (h * h);
        assert!(curvature(1.0, 1e-4).abs() < 0.02);
        assert!(curvature(1e-4, 1e-4).abs() < 0.02);
    }
}
