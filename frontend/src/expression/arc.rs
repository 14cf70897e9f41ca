//! The arc tangent over the ops.
//!
//! ```text
//! atan2(y, x):   t = min(|x|, |y|) / max(|x|, |y|)  in [0, 1]                the angle to the nearer axis is atan(t)
//!                t > tan(pi/8):  atan(t) = pi/4 + atan((t - 1) / (t + 1))    so |t| <= tan(pi/8)
//!                atan(t) = t + t^3 P(t^2)                                    P: four coefficients (Moshier, Cephes, 1992)
//! ```
//!
//! Within 4 ULP of the true angle, which the tests measure. At the origin it is 0, and so is its derivative there.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use jbt_ir::Domain;

/// `(atan t - t) / t^3` in t^2, from the highest power down.
const ATAN: [f32; 4] = [8.053_744_5e-2, -0.138_776_86, 0.199_777_11, -0.333_329_5];
/// tan(pi / 8).
const EIGHTH: f32 = 0.414_213_57;

/// The angle of the point (x, y), in [-pi, pi]: that of -x and y = -0 is pi, not -pi.
pub(crate) fn atan2<D: Domain>(d: &mut D, y: D::Real, x: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    let (width, height) = (d.abs(x), d.abs(y));
    let steep = d.lt(width, height);
    let (small, large) = (d.min(height, width), d.max(height, width));

    let eighth = d.constant(EIGHTH);
    let limit = d.mul(large, eighth);
    let middle = d.lt(limit, small);
    let (difference, sum) = (d.sub(small, large), d.add(small, large));
    let over = d.select(middle, difference, small);
    let under = d.select(middle, sum, large);
    let origin = d.eq(under, zero);
    let quotient = d.div(over, under);
    let t = d.select(origin, zero, quotient);

    let square = d.mul(t, t);
    let [first, rest @ ..] = ATAN.map(|coefficient| d.constant(coefficient));
    let tail = rest.iter().fold(first, |sum, &coefficient| d.fma(sum, square, coefficient));
    let cube = d.mul(square, t);
    let angle = d.fma(cube, tail, t);
    let quarter = d.constant(FRAC_PI_4);
    let turned = d.add(quarter, angle);
    let angle = d.select(middle, turned, angle);

    let right = d.constant(FRAC_PI_2);
    let other = d.sub(right, angle);
    let angle = d.select(steep, other, angle);
    let half = d.constant(PI);
    let behind = d.sub(half, angle);
    let left = d.lt(x, zero);
    let angle = d.select(left, behind, angle);
    // Ranges of the steps above know nothing of what they add up to. In this order a tie gives the angle, and its slope.
    let angle = d.min(half, angle);
    let angle = d.max(zero, angle);
    let minus = d.neg(angle);
    let below = d.lt(y, zero);
    d.select(below, minus, angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use jbt_ir::domain::scalar::Scalar;

    /// The distance in units in the last place of the true value.
    fn error(found: f32, truth: f64) -> f64 {
        let nearest = (truth as f32).abs().max(f32::MIN_POSITIVE);
        let unit = f64::from(nearest.next_up()) - f64::from(nearest);
        (f64::from(found) - truth).abs() / unit
    }

    #[test]
    fn the_angle_is_within_four_units() {
        let mut rng = fastrand::Rng::with_seed(7);
        let mut worst = 0f64;
        for _ in 0..200_000 {
            let size = 10f32.powi(rng.i32(-6..6));
            let (x, y) = (2.0 * rng.f32() - 1.0, size * (2.0 * rng.f32() - 1.0));
            worst = worst.max(error(atan2(&mut Scalar, y, x), f64::from(y).atan2(f64::from(x))));
        }
        assert!(worst < 4.0, "{worst}");
    }

    #[test]
    fn axes_and_the_origin() {
        let at = |y: f32, x: f32| atan2(&mut Scalar, y, x);
        assert_eq!([at(0.0, 0.0), at(0.0, 2.0), at(-0.0, 2.0)], [0.0; 3]);
        assert_eq!([at(3.0, 0.0), at(-3.0, 0.0), at(0.0, -1.0)], [FRAC_PI_2, -FRAC_PI_2, PI]);
    }
}
