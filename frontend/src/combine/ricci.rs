//! Ricci's blend (Ricci 1973): `F = (sum max(f_i, 0)^n)^(1/n)`; with n = 1 the plain sum, negative fields
//! included.
//!
//! Scaled by the largest operand, no exponent overflows: `F = m (sum (f_i / m)^n)^(1/n)`. The weight of a
//! child is `f_i^n`. With a negative exponent it is an intersection that blends, 0 where any operand is, and
//! m is the smallest operand.
//!
//! The compiler meets the operands one at a time and does not know the largest beforehand, so it keeps the
//! largest so far, `m`, and the sum relative to it, `S = sum (f_i / m)^n`. A larger operand f rescales: `S (m
//! / f)^n + 1`. Either way it takes one power:
//!
//! ```text
//! p = (min(f, m) / max(f, m))^n
//! S = f > m ? S p + 1 : S + p        m = max(f, m)        in the end F = m S^(1/n)
//! ```
//!
//! m begins at a number so small that an operand below it counts for nothing; so it is never 0, and no
//! quotient needs a guard. F does not depend on m, so m is held: its tangent would cancel. The 1 is `(f /
//! f)^n` and has the tangent `n f' / f`.
//!
//! A negative exponent exchanges larger and smaller: with p = -n, m is the smallest so far, which begins at a
//! number above all fields, a *smaller* operand rescales, and `F = m / S^(1/p)`. Quotients are those of the
//! smaller by the larger again; where that is 0, so is F.

use jbt_ir::Domain;

use crate::power::{Exponent, power};

pub(super) fn field(fields: &[f64], n: f64) -> f64 {
    if n == 1.0 {
        return super::sum::field(fields);
    }
    if n < 0.0 {
        let smallest = fields.iter().fold(f64::INFINITY, |m, &f| m.min(f)).max(0.0);
        return if smallest == 0.0 {
            0.0
        } else {
            smallest * weights(fields, n).iter().sum::<f64>().powf(1.0 / n)
        };
    }
    let largest = fields.iter().fold(0.0f64, |m, &f| m.max(f));
    if largest == 0.0 {
        return 0.0;
    }
    largest * weights(fields, n).iter().sum::<f64>().powf(1.0 / n)
}

pub(super) fn weights(fields: &[f64], n: f64) -> Vec<f64> {
    if n < 0.0 {
        let smallest = fields.iter().fold(f64::INFINITY, |m, &f| m.min(f));
        let weight = |f: &f64| if smallest > 0.0 { (smallest / f).powf(-n) } else { 0.0 };
        return fields.iter().map(weight).collect();
    }
    let largest = fields.iter().fold(0.0f64, |m, &f| m.max(f));
    if n == 1.0 || largest == 0.0 {
        return super::sum::weights(fields);
    }
    fields.iter().map(|f| (f.max(0.0) / largest).powf(n)).collect()
}

/// How far the operands of a negative exponent are from where one becomes 0.
pub(super) fn kink_distance(fields: &[f64]) -> f64 {
    fields.iter().fold(f64::INFINITY, |nearest, f| nearest.min(f.abs()))
}

/// What the largest operand is before there is one: about 8e-31. Its reciprocal is finite.
pub(crate) const FLOOR: f32 = 1.0 / (1u128 << 100) as f32;

/// What the smallest operand is before there is one, for a negative exponent: about 1e30.
pub(crate) const CEILING: f32 = (1u128 << 100) as f32;

/// Roots of a power of two up to this exponent are taken by square roots: more of them take longer than a
/// power.
const MOST_SQUARE_ROOTS: u32 = 16;

/// What [`Step`] has to know of a blend.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blend<R> {
    /// The magnitude of the exponent.
    pub(crate) exponent: Exponent<R>,
    /// Whether the exponent is negative.
    pub(crate) negative: bool,
    /// No operand can be below 0.
    pub(crate) non_negative: bool,
    /// The result will be differentiated.
    pub(crate) moving: bool,
}

/// The largest operand so far, and the sum of powers relative to it. For a negative exponent, the smallest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scaled<R> {
    /// The largest operand so far; held.
    pub(crate) largest: R,
    /// Sum of `(f / largest)^n`.
    pub(crate) sum: R,
}

/// What a step does to sums that are kept relative to the largest operand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step<R> {
    /// The accumulators after it.
    pub(crate) next: Scaled<R>,
    /// What sums so far have to be multiplied with.
    pub(crate) rescale: R,
    /// The weight of the operand: `(f / largest)^n`.
    pub(crate) weight: R,
}

/// One operand more, over the ops.
pub(crate) fn step<D: Domain>(
    d: &mut D,
    so_far: Scaled<D::Real>,
    field: D::Real,
    blend: Blend<D::Real>,
) -> Step<D::Real> {
    let Blend { exponent, negative, non_negative, moving } = blend;
    let (zero, one) = (d.constant(0.0), d.constant(1.0));
    let field = if non_negative { field } else { d.max(field, zero) };
    let (takes, scale, ratio) = if negative {
        let takes = d.lt(field, so_far.largest);
        let scale = d.min(field, so_far.largest);
        let scale = d.stop_gradient(scale);
        // In this order: of equals the operand, whose tangent counts. Two zeros have the quotient 0.
        let (larger, floor) = (d.max(so_far.largest, field), d.constant(FLOOR));
        let larger = d.max(larger, floor);
        (takes, scale, d.div(scale, larger))
    } else {
        let takes = d.lt(so_far.largest, field);
        let scale = d.max(field, so_far.largest);
        let scale = d.stop_gradient(scale);
        // In this order: of equals the operand, whose tangent counts.
        let smaller = d.min(so_far.largest, field);
        (takes, scale, d.div(smaller, scale))
    };
    let power = power(d, ratio, exponent);
    let first = if moving { unit(d, field, scale, (exponent, negative)) } else { one };
    let rescaled = d.fma(so_far.sum, power, first);
    let added = d.add(so_far.sum, power);
    let sum = d.select(takes, rescaled, added);
    Step {
        next: Scaled { largest: scale, sum },
        rescale: d.select(takes, power, one),
        weight: d.select(takes, one, power),
    }
}

/// `F = largest * sum^(1/n)`, over the ops.
pub(crate) fn finish<D: Domain>(d: &mut D, scaled: Scaled<D::Real>, blend: Blend<D::Real>) -> D::Real {
    let root = match blend.exponent {
        Exponent::Integer(n) if n.is_power_of_two() && n <= MOST_SQUARE_ROOTS => {
            (0..n.ilog2()).fold(scaled.sum, |root, _| d.sqrt(root))
        }
        Exponent::Integer(n) => {
            let inverse = d.constant(1.0 / n as f32);
            d.pow(scaled.sum, inverse)
        }
        Exponent::General(_, inverse) => d.pow(scaled.sum, inverse),
    };
    if blend.negative { d.div(scaled.largest, root) } else { d.mul(scaled.largest, root) }
}

/// 1, with the tangent of `(field / largest)^n` where the two are equal.
fn unit<D: Domain>(
    d: &mut D,
    field: D::Real,
    scale: D::Real,
    (exponent, negative): (Exponent<D::Real>, bool),
) -> D::Real {
    let one = d.constant(1.0);
    let divisor = if negative {
        let floor = d.constant(FLOOR);
        d.max(scale, floor)
    } else {
        scale
    };
    let inverse = d.div(one, divisor);
    let quotient = d.mul(field, inverse);
    let held = d.stop_gradient(quotient);
    let still = if negative { d.sub(held, quotient) } else { d.sub(quotient, held) };
    let n = match exponent {
        Exponent::Integer(n) => d.constant(n as f32),
        Exponent::General(n, _) => n,
    };
    d.fma(n, still, one)
}
