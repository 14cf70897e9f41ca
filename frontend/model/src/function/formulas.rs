//! Small formulas that several functions share.

use jbt_ir::Domain;

/// From here on, numbers of f32 count as whole: 2^22.
const WHOLE: f32 = 4_194_304.0;

/// 1.5 * 2^23: adding and subtracting it rounds a number up to 2^22 to a whole one.
const ROUND: f32 = 12_582_912.0;

/// The difference between the largest and the second largest; infinity if there is no second.
pub(super) fn lead(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(|a, b| b.total_cmp(a));
    if let [first, second, ..] = all[..] { first - second } else { f64::INFINITY }
}

/// `a / b`, and 0 where b is 0.
pub(crate) fn quotient<D: Domain>(d: &mut D, a: D::Real, b: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    let pole = d.eq(b, zero);
    let quotient = d.div(a, b);
    d.select(pole, zero, quotient)
}

/// `max(a, 0)^b`, and 0 at poles.
pub(crate) fn power<D: Domain>(d: &mut D, a: D::Real, b: D::Real, positive: bool) -> D::Real {
    let zero = d.constant(0.0);
    let base = if positive { a } else { d.max(a, zero) };
    let power = d.pow(base, b);
    let (at_zero, falls) = (d.le(base, zero), d.lt(b, zero));
    let pole = d.both(at_zero, falls);
    d.select(pole, zero, power)
}

/// The nearest whole number, with zero derivative.
pub(super) fn nearest<D: Domain>(d: &mut D, x: D::Real) -> D::Real {
    let (round, whole) = (d.constant(ROUND), d.constant(WHOLE));
    let shifted = d.add(x, round);
    let rounded = d.sub(shifted, round);
    let magnitude = d.abs(x);
    let small = d.lt(magnitude, whole);
    let nearest = d.select(small, rounded, x);
    d.stop_gradient(nearest)
}

pub(super) fn floor<D: Domain>(d: &mut D, x: D::Real) -> D::Real {
    let nearest = nearest(d, x);
    let one = d.constant(1.0);
    let above = d.lt(x, nearest);
    let before = d.sub(nearest, one);
    let floor = d.select(above, before, nearest);
    d.stop_gradient(floor)
}

/// The remainder of `x` by `by`.
pub(super) fn remainder<D: Domain>(d: &mut D, x: D::Real, by: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    let by = d.abs(by);
    let quotient = quotient(d, x, by);
    let whole = floor(d, quotient);
    let minus = d.neg(whole);
    let rest = d.fma(minus, by, x);
    // Rounding of the quotient may have subtracted one multiple too many.
    let rest = d.max(rest, zero);
    let pole = d.eq(by, zero);
    d.select(pole, zero, rest)
}

/// `x` within [-1, 1], and `sqrt(1 - x^2)`.
pub(super) fn arc_sides<D: Domain>(d: &mut D, x: D::Real) -> (D::Real, D::Real) {
    let (one, minus) = (d.constant(1.0), d.constant(-1.0));
    let x = d.max(x, minus);
    let x = d.min(x, one);
    let (below, above) = (d.sub(one, x), d.add(one, x));
    let square = d.mul(below, above);
    (x, d.sqrt(square))
}

/// The distance of a number from the nearest whole number.
pub(super) fn to_whole(x: f64) -> f64 {
    (x - x.round()).abs()
}
