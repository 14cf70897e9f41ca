//! Angles about an axis: the arctangent of two coordinates, over the ops. Warps, skeletons and formulas share
//! it.
//!
//! With the half angle there is no division by what may be small (h is the distance from the axis):
//!
//! ```text
//! x >= 0:   angle = 2 atan(u),             u = y / (h + x)         in [-1, 1]
//! x < 0:    angle = +-pi - 2 atan(u),      u = y / (h + |x|)       the sign is that of y
//! ```
//!
//! `atan(u) / u` is a polynomial in `u^2`, so a quotient `angle / k` of an angle whose y is `k t` costs no
//! division by k either: it is `2 t / (h + |x|) * (atan(u) / u)`.
//!
//! The squares in h are for coordinates from about 1e-19 to 1e19. [`atan2`] takes any: it divides both by the
//! larger one first, which turns nothing, and so need not be differentiated. Where |y| > |x| it takes the
//! angle from the y axis, `+-pi/2 - angle(|y|, x)`. There the slope of u along y is the difference of two
//! nearly equal numbers, and `atan(x)` would lose digits of its slope in proportion to x.

use std::f32::consts::{FRAC_PI_2, PI};

use jbt_ir::Domain;

/// `(2 atan(u) / u - 2) / u^2` in u^2, for |u| <= 1: Chebyshev's interpolation, error 2^-26 of the angle. Its
/// derivative is off by less than 2^-20. The first one is rounded such that an angle on an axis is exact.
const COEFFICIENTS: [f32; 10] = [
    -0.666_666_6,
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

/// The larger part of a point being 1, `h + |x|` is at least that: this is nowhere in the way, and keeps
/// ranges small.
const LEAST_OF_PARTS: f32 = 0.99;

/// An angle and the distance from the axis.
pub(crate) struct Polar<R> {
    /// The angle of (x, y), times a factor.
    pub(crate) angle: R,
    /// The length of (x, y).
    pub(crate) distance: R,
}

/// The angle of (x, y) in (-pi, pi], times a factor f: `scaled` is `f y`, and `half_turn` is `f pi`, for
/// f > 0. The error is below 2^-21 of the angle. Nearer to the axis than `least` (`h + |x|` is below it) the
/// angle fades to 0 (x >= 0), so that it moves by at most `4 f / least` with its operands.
pub(crate) fn emit<D: Domain>(
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
    let least = d.constant(least);
    let sum = d.max(sum, least);
    let tangent = d.div(y, sum);
    let square = d.mul(tangent, tangent);
    let mut ratio = d.constant(COEFFICIENTS[COEFFICIENTS.len() - 1]);
    let rest = COEFFICIENTS[..COEFFICIENTS.len() - 1].iter().rev();
    for &coefficient in rest.chain(&[2.0]) {
        let coefficient = d.constant(coefficient);
        ratio = d.fma(ratio, square, coefficient);
    }
    let scaled_tangent = d.div(scaled, sum);
    let ahead = d.mul(scaled_tangent, ratio);
    let zero = d.constant(0.0);
    let (below, behind) = (d.lt(scaled, zero), d.lt(x, zero));
    let other_half = d.neg(half_turn);
    let half = d.select(below, other_half, half_turn);
    let back = d.sub(half, ahead);
    Polar { angle: d.select(behind, back, ahead), distance }
}

/// The angle of the point (x, y), in [-pi, pi], within 4 ULP: that of -x and y = -0 is pi, not -pi.
///
/// Coordinates that are both below [`f32::MIN_POSITIVE`] are the origin: the angle is 0 there, and so is its
/// derivative. Where the one or the other is infinite, it counts as the largest number.
pub(crate) fn atan2<D: Domain>(d: &mut D, y: D::Real, x: D::Real) -> D::Real {
    let (zero, one, minus) = (d.constant(0.0), d.constant(1.0), d.constant(-1.0));
    let (least, most) = (d.constant(f32::MIN_POSITIVE), d.constant(f32::MAX));
    let (width, height) = (d.abs(x), d.abs(y));
    let size = d.max(width, height);
    let origin = d.lt(size, least);
    // So no quotient is NaN, not even where a range has the origin in it.
    let size = d.max(size, least);
    let size = d.min(size, most);
    let size = d.stop_gradient(size);
    let mut part = |side| {
        // Ranges do not know that no side is longer than the longer one. In this order a tie gives the side,
        // and its slope.
        let part = d.div(side, size);
        let part = d.max(minus, part);
        let part = d.min(one, part);
        d.select(origin, zero, part)
    };
    let (x, y) = (part(x), part(y));
    // About the axis that is nearer the quotient's slopes cancel nothing: they are products alone.
    let (width, height) = (d.abs(x), d.abs(y));
    let steep = d.lt(width, height);
    let along = d.select(steep, height, x);
    let across = d.select(steep, x, y);
    let half_turn = d.constant(PI);
    let angle = emit(d, [along, across], across, half_turn, LEAST_OF_PARTS).angle;
    let quarter = d.constant(FRAC_PI_2);
    let up = d.sub(quarter, angle);
    let down = d.neg(up);
    let below = d.lt(y, zero);
    let from_quarter = d.select(below, down, up);
    let angle = d.select(steep, from_quarter, angle);
    let minus = d.neg(half_turn);
    let angle = d.max(minus, angle);
    d.min(half_turn, angle)
}

/// The same as [`emit`] plainly, by the same definition.
pub(crate) fn plain([x, y]: [f64; 2], scaled: f64, half_turn: f64, least: f64) -> Polar<f64> {
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
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};
    use std::f64::consts::PI;

    use jbt_ir::domain::interval::Interval;
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

    /// The distance in units in the last place of the true value.
    fn units(found: f32, truth: f64) -> f64 {
        let nearest = (truth as f32).abs().max(f32::MIN_POSITIVE);
        let unit = f64::from(nearest.next_up()) - f64::from(nearest);
        (f64::from(found) - truth).abs() / unit
    }

    fn at(y: f32, x: f32) -> f32 {
        atan2(&mut Scalar, y, x)
    }

    #[test]
    fn the_angle_of_any_two_numbers_is_within_four_units() {
        let mut rng = fastrand::Rng::with_seed(7);
        let mut worst = 0f64;
        for _ in 0..200_000 {
            let size = 10f32.powi(rng.i32(-6..6));
            let (x, y) = (2.0 * rng.f32() - 1.0, size * (2.0 * rng.f32() - 1.0));
            // Multiplied with powers of two, which change no digit.
            let far = 2f32.powi(rng.i32(-70..100));
            worst = worst.max(units(at(far * y, far * x), f64::from(y).atan2(f64::from(x))));
        }
        assert!(worst < 4.0, "{worst}");
    }

    #[test]
    fn axes_diagonals_and_the_origin_are_exact() {
        assert_eq!([at(0.0, 0.0), at(-0.0, 0.0), at(1e-45, -1e-39), at(0.0, 2.0), at(-0.0, 2.0)], [0.0; 5]);
        let pi = PI as f32;
        assert_eq!([at(3.0, 0.0), at(-3.0, 0.0), at(0.0, -1.0)], [FRAC_PI_2, -FRAC_PI_2, pi]);
        let infinity = f32::INFINITY;
        assert_eq!([at(infinity, 1.0), at(1.0, -infinity)], [FRAC_PI_2, pi]);
        assert!((-1e-38..=0.0).contains(&at(-1.0, infinity)));
        assert!((at(infinity, infinity) - FRAC_PI_4).abs() < 1e-7);
    }

    #[test]
    fn ranges_hold_all_angles_of_a_box_and_no_more_than_a_turn() {
        let mut rng = fastrand::Rng::with_seed(9);
        for step in 0..2000 {
            let size = 2f32.powi(-(step % 12));
            let low = [(); 2].map(|()| 4.0 * rng.f32() - 2.0);
            let high = low.map(|low| low + size * rng.f32());
            let mut domain = Interval::new(Scalar);
            let [x, y] = [0, 1].map(|axis| domain.input(low[axis], high[axis]));
            let range = atan2(&mut domain, y, x);
            let [bottom, top] = domain.output(range);
            assert!(-PI as f32 <= bottom && top <= PI as f32, "{bottom} {top}");
            for _ in 0..50 {
                let [x, y] =
                    [0, 1].map(|axis| (low[axis] + rng.f32() * (high[axis] - low[axis])).min(high[axis]));
                let angle = at(y, x);
                assert!(
                    bottom <= angle && angle <= top,
                    "{angle} at ({x}, {y}) is outside of [{bottom}, {top}]"
                );
            }
        }
    }
}
