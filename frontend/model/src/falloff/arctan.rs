//! The arc tangent of Kacic-Alesic and Wyvill (1991): a step at half the radius, as steep as one likes.
//!
//! ```text
//! 1/2 + atan(p (1 - 2r)) / (2 atan p)        p the stiffness
//! ```
//!
//! It is 1 at the skeleton, where it has a tip of slope `-q` in r, `q = p / ((1 + p^2) atan p)`, and 0 at the
//! rim, where it ends with the same slope if its [`Edge`] is exact: the field is continuous and has a crease
//! there. A smooth edge takes the crease away.
//!
//! # The compiler's form
//!
//! There is no arc tangent among the ops, and polynomials for it are no chains of rising steps. The angle is
//! `A = atan(p - 2pr) + atan(p)` over its largest value, `2 atan p`. With the depth `v = 1 - r` its cotangent
//! is
//!
//! ```text
//! cot A = (1 + p^2) / (2 p v) - p
//! ```
//!
//! and all that follows falls with it: `cot(x/2) = cot x + csc x`, three times, brings the angle down to an
//! eighth; there
//!
//! ```text
//! 1 / x = (7 cot x + 6 csc x + 16 csc(x/2)) / 45        with a relative error of 3.3e-5 x^6
//! ```
//!
//! which is a Richardson extrapolation of polygons around and inside of a circle: the three weights are the
//! only ones for which all terms before that error cancel. It is 1.2e-7 at most, for x below pi / 8.

use jbt_ir::Domain;

use super::{Edge, FalloffMember, Nearness, bisect, emit_depth};
use crate::member::member;
use crate::skeleton::positive_part;

member! {
    /// An arc tangent. Text: `arctan { stiffness 50 edge exact }`, which are the defaults; also `atan`.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct ArcTan = "arctan" {
        /// p, in [0.01, 1000].
        pub stiffness: f64 [Within { least: 0.01, most: 1000.0 }] = Real(50.0),
        /// What happens at the support radius.
        pub edge: Edge [Choice(Edge::WORDS)] = Edge::Exact.to_field(),
    }
}

/// Nearer to the rim than this part of the radius, the field is proportional to the distance from the rim, so
/// that no number gets large.
const THIN: f32 = 1.0 / (1 << 14) as f32;

impl ArcTan {
    /// `(1 + p^2) / (2p)`
    fn spread(&self) -> f64 {
        0.5 * (self.stiffness + 1.0 / self.stiffness)
    }
}

impl FalloffMember for ArcTan {
    const ALIASES: &'static [&'static str] = &["atan"];

    fn value(&self, s: f64) -> f64 {
        let p = self.stiffness;
        (0.5 + 0.5 * (p - 2.0 * p * s.sqrt()).atan() / p.atan()) * self.edge.factor(s)
    }

    fn inverse(&self, level: f64) -> f64 {
        bisect(|s| self.value(s), level)
    }

    fn steepness(&self) -> f64 {
        // The growth of the cotangent, before the angle's derivative cancels it.
        4.0 * self.spread() / f64::from(THIN).powi(2)
    }

    fn is_pointed(&self) -> bool {
        true
    }

    fn variant(&self, _follows: bool) -> u8 {
        self.edge.bit()
    }

    fn column_names(_variant: u8) -> &'static [&'static str] {
        &["stiffness", "falloff_spread", "falloff_scale"]
    }

    fn columns(&self, _variant: u8, row: &mut Vec<f64>) {
        // The angle is 8 * 45 over a sum, divided by its largest value, 2 atan p.
        row.extend([self.stiffness, self.spread(), 180.0 / self.stiffness.atan()]);
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, near: Nearness<D::Real>, row: &[D::Real]) -> D::Real {
        let [stiffness, spread, scale] = row[..] else { unreachable!("there are three columns") };
        let (one, thin, thick) = (d.constant(1.0), d.constant(THIN), d.constant(1.0 / THIN));
        let r = near.distance(d);
        let depth = emit_depth(d, near.u, r);
        let inside = d.max(depth, thin);
        let quotient = d.div(spread, inside);
        let cot = d.sub(quotient, stiffness);
        let sum = emit_inverse_angle(d, cot);
        let value = d.div(scale, sum);

        let part = d.mul(depth, thick);
        // The order of operands chooses `part` and its slope where both are equal.
        let part = d.min(one, part);
        let value = d.mul(value, part);
        match Edge::of_bit(variant) {
            // It is zero at the rim already.
            Edge::Exact => value,
            Edge::Smooth => Edge::Smooth.emit(d, near.u, value),
        }
    }
}

/// `45 / (A / 8)` from the cotangent of an angle A in (0, pi).
fn emit_inverse_angle<D: Domain>(d: &mut D, cot: D::Real) -> D::Real {
    // Where the cotangent is negative, cot + csc would cancel. One of `above` and `below` is 0; at 0 only
    // `above` has a slope.
    let (opposite, zero) = (d.neg(cot), d.constant(0.0));
    let (above, below) = (d.max(zero, cot), positive_part(d, opposite));
    let (above, below) = (emit_halved(d, above), emit_halved(d, below));
    let half = d.div(above, below);
    let quarter = emit_halved(d, half);
    let eighth = emit_halved(d, quarter);
    let cosecant = emit_cosecant(d, eighth);
    let sixteenth = d.add(eighth, cosecant);
    let last = emit_cosecant(d, sixteenth);

    let [seven, six, sixteen] = [7.0, 6.0, 16.0].map(|weight| d.constant(weight));
    let sum = d.mul(seven, eighth);
    let sum = d.fma(six, cosecant, sum);
    d.fma(sixteen, last, sum)
}

/// `csc x` from `cot x`, for x in (0, pi).
fn emit_cosecant<D: Domain>(d: &mut D, cot: D::Real) -> D::Real {
    let (one, square) = (d.constant(1.0), d.mul(cot, cot));
    let sum = d.add(square, one);
    d.sqrt(sum)
}

/// `cot(x / 2)` from `cot x`, for x in (0, pi).
fn emit_halved<D: Domain>(d: &mut D, cot: D::Real) -> D::Real {
    let cosecant = emit_cosecant(d, cot);
    d.add(cot, cosecant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::testing::Published;

    #[test]
    fn published_values() {
        for stiffness in [1.0, 5.0, 50.0, 1000.0] {
            let exact = ArcTan { stiffness, edge: Edge::Exact };
            let steepest = Some((0.5, stiffness / stiffness.atan()));
            Published { half: Some(0.5), steepest }.check(exact.into());
            // s = 1/4 is far inside of the smooth edge, but a small stiffness falls fastest within the edge.
            let steepest = steepest.filter(|_| stiffness > 1.0);
            let smooth = ArcTan { edge: Edge::Smooth, ..exact };
            Published { half: Some(0.5), steepest }.check(smooth.into());
        }
    }

    #[test]
    fn a_soft_one_is_a_cone() {
        let soft = ArcTan { stiffness: 0.01, edge: Edge::Exact };
        for r in [0.0, 0.2, 0.6, 0.9] {
            assert!((soft.value(r * r) - (1.0 - r)).abs() < 1e-5);
        }
    }
}
