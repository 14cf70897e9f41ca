//! Angles about an axis: the arctangent of two coordinates, over the ops.
//!
//! With the half angle there is no division by what may be small (h is the distance from the axis):
//!
//! ```text
//! x >= 0:   angle = 2 atan(u),             u = y / (h + x)         in [-1, 1]
//! x < 0:    angle = +-pi - 2 atan(u),      u = y / (h + |x|)       the sign is that of y
//! ```
//!
//! `atan(u) / u` is a polynomial in `u^2`, so a quotient `angle / k` of an angle whose y is `k t` costs no division by k either: it is
//! `2 t / (h + |x|) * (atan(u) / u)`.

use jbt_ir::Domain;

/// `(2 atan(u) / u - 2) / u^2` in u^2, for |u| <= 1: Chebyshev's interpolation, error 2^-26 of the angle. Its derivative is off by less
/// than 2^-20.
const COEFFICIENTS: [f32; 10] = [
    -0.666_666_7,
    0.399_999,
    -0.285_680_1,
    0.221_765_24,
    -0.178_636_54,
    0.140_638_29,
    -0.097_921_03,
    0.052_610_002,
    -0.018_289_259,
    0.002_977_383_8,
];

/// An angle and the distance from the axis.
pub(super) struct Polar<R> {
    /// The angle of (x, y), times a factor.
    pub(super) angle: R,
    /// The length of (x, y).
    pub(super) distance: R,
}

/// The angle of (x, y) in (-pi, pi], times a factor f: `scaled` is `f y`, and `half_turn` is `f pi`, for f > 0. The error is below
/// 2^-21 of the angle. Nearer to the axis than `least` (`h + |x|` is below it) the angle fades to 0 (x >= 0), so that it moves by at most
/// `4 f / least` with its operands.
pub(super) fn emit<D: Domain>(
    d: &mut D,
    [x, y]: [D::Real; 2],
    scaled: D::Real,
    half_turn: D::Real,
    least: f32,
) -> Polar<D::Real> {
    let square = d.mul(x, x);
    let square = d.fma(y, y, square);
    let distance = d.sqrt(square);
    let magnitude = d.abs(x);
    let sum = d.add(distance, magnitude);
    let (least, one) = (d.constant(least), d.constant(1.0));
    let sum = d.max(sum, least);
    let inverse = d.div(one, sum);
    let tangent = d.mul(y, inverse);
    let square = d.mul(tangent, tangent);
    let mut ratio = d.constant(COEFFICIENTS[COEFFICIENTS.len() - 1]);
    let rest = COEFFICIENTS[..COEFFICIENTS.len() - 1].iter().rev();
    for &coefficient in rest.chain(&[2.0]) {
        let coefficient = d.constant(coefficient);
        ratio = d.fma(ratio, square, coefficient);
    }
    let scaled_tangent = d.mul(scaled, inverse);
    let ahead = d.mul(scaled_tangent, ratio);
    let zero = d.constant(0.0);
    let (below, behind) = (d.lt(scaled, zero), d.lt(x, zero));
    let other_half = d.neg(half_turn);
    let half = d.select(below, other_half, half_turn);
    let back = d.sub(half, ahead);
    Polar { angle: d.select(behind, back, ahead), distance }
}

/// The same plainly, by the same definition.
pub(super) fn plain([x, y]: [f64; 2], scaled: f64, half_turn: f64, least: f64) -> Polar<f64> {
    let distance = x.hypot(y);
    let sum = (distance + x.abs()).max(least);
    let tangent = y / sum;
    let ratio = if tangent == 0.0 { 1.0 } else { tangent.atan() / tangent };
    let ahead = 2.0 * scaled / sum * ratio;
    let half = if scaled < 0.0 { -half_turn } else { half_turn };
    Polar { angle: if x < 0.0 { half - ahead } else { ahead }, distance }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use jbt_ir::domain::scalar::Scalar;

    use super::*;

    #[test]
    fn is_the_arctangent_of_two_numbers() {
        let mut rng = fastrand::Rng::with_seed(1);
        for _ in 0..100_000 {
            let size = 10f64.powf(8.0 * rng.f64() - 4.0);
            let [x, y] = [(); 2].map(|()| (size * (2.0 * rng.f64() - 1.0)) as f32);
            let y = if rng.u8(..8) == 0 { y * 1e-6 } else { y };
            let point = [f64::from(x), f64::from(y)];
            let expected = point[1].atan2(point[0]);
            let exact = plain(point, point[1], PI, 1e-30);
            assert!((exact.angle - expected).abs() <= 1e-15 * PI, "{x} {y}");
            let found = emit(&mut Scalar, [x, y], y, PI as f32, 1e-30);
            let error = (f64::from(found.angle) - expected).abs() / expected.abs();
            assert!(error <= 2f64.powi(-21), "{x} {y}: {} instead of {expected}", found.angle);
        }
    }

    #[test]
    fn is_finite_at_the_axis() {
        for (x, y) in [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0), (1e-45, -1e-45)] {
            let found = emit(&mut Scalar, [x, y], y, PI as f32, 1e-30);
            assert!(found.angle.abs() < 1e-10 && found.distance < 1e-20, "{x} {y}: {}", found.angle);
        }
    }
}
