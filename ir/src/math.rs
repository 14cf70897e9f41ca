//! The transcendental ops, written once over the other ops of [`Domain`], so that no two engines can differ.
//!
//! | function | largest error, in units in the last place of the result | where |
//! |---|---|---|
//! | [`sin`], [`cos`] | 1.25 | magnitudes up to [`LARGEST_ANGLE`]; beyond it the angle counts as 0 |
//! | [`exp`] | 1 | everywhere, subnormal results included |
//! | [`ln`] | 1 | everywhere, subnormal operands included |
//! | [`pow`] | 1.25 | everywhere |
//!
//! The tests measure these errors against `f64`. All five have the same plan: *reduce* the operand to a small
//! interval without losing bits (`fma` gives the exact remainder), evaluate a *polynomial* there, and put the
//! exponent or quadrant back with integer ops. There is no conversion between reals and integers among the
//! ops: adding 1.5 * 2^23 leaves the nearest integer in the low bits of the sum.
//!
//! The coefficients are minimax fits of the relative error, made with the Remez exchange algorithm in 120-bit
//! arithmetic and then rounded to `f32`; each list says the interval and the error that the exact
//! coefficients have.

use crate::op::Domain;

/// 1.5 * 2^23. For |x| < 2^22 the sum `x + ROUND` is `ROUND` plus the integer nearest to x, and its bits are
/// those of `ROUND` plus it.
const ROUND: f32 = 12_582_912.0;
/// The bits of an infinity are those of 2^128; shifted right by this, bits become a biased exponent.
const EXPONENT_SHIFT: u32 = 23;
/// The magnitude up to which [`sin`] and [`cos`] keep their accuracy, in radians: 2^17, about 20,000 turns.
pub const LARGEST_ANGLE: f32 = 131_072.0;

/// `c[0] + x (c[1] + x (c[2] + ...))`, one rounding a step.
#[inline(always)]
fn polynomial<D: Domain>(d: &mut D, x: D::Real, coefficients: &[f32]) -> D::Real {
    let (&last, rest) = coefficients.split_last().expect("a polynomial has a coefficient");
    let mut sum = d.constant(last);
    for &coefficient in rest.iter().rev() {
        let coefficient = d.constant(coefficient);
        sum = d.fma(sum, x, coefficient);
    }
    sum
}

// ── sine and cosine
// ─────────────────────────────────────────────────────────────────────────────────────────────

/// pi / 2 in three parts, each the nearest `f32` to what the ones before it leave.
const HALF_PI: [f32; 3] = [1.570_796_4, -4.371_139e-8, -1.715_124_5e-15];
/// `(sin r - r) / r^3` in r^2, for |r| <= 1.01 pi/4: error 2^-27.9 of the sine.
const SIN: [f32; 3] = [-0.166_666_54, 0.008_332_113, -0.000_195_087_41];
/// `(cos r - 1 + r^2/2) / r^4` in r^2, for |r| <= 1.01 pi/4: error 2^-32.9 of the cosine.
const COS: [f32; 3] = [0.041_666_646, -0.001_388_725_1, 2.442_568_3e-5];

/// An angle without its quarter turns.
struct Reduced<D: Domain> {
    /// The sine of the rest.
    sin: D::Real,
    /// The cosine of the rest.
    cos: D::Real,
    /// The number of quarter turns, in the low bits.
    quarters: D::Bits,
}

/// Reduces |a| by quarter turns (Cody and Waite, 1980) and evaluates both polynomials.
#[inline(always)]
fn reduce_angle<D: Domain>(d: &mut D, a: D::Real) -> Reduced<D> {
    // A number that is too large becomes 0, an infinity NaN.
    let magnitude = d.abs(a);
    let largest = d.constant(LARGEST_ANGLE);
    let in_range = d.le(magnitude, largest);
    let nothing = d.sub(magnitude, magnitude);
    let x = d.select(in_range, magnitude, nothing);

    let round = d.constant(ROUND);
    let two_over_pi = d.constant(std::f32::consts::FRAC_2_PI);
    let shifted = d.fma(x, two_over_pi, round);
    let n = d.sub(shifted, round);
    let quarters = d.to_bits(shifted);

    // The first step is exact: x and n * HALF_PI[0] are multiples of 2^-24 that differ by less than 1. Near a
    // multiple of a quarter turn the second one cancels almost everything, so it keeps both what its product
    // and what its difference (Knuth, 1969) lose.
    let [first_part, second_part, third_part] = HALF_PI.map(|part| d.constant(-part));
    let first = d.fma(n, first_part, x);
    let second = d.mul(n, second_part);
    let r = d.add(first, second);
    let second_kept = d.sub(r, first);
    let first_kept = d.sub(r, second_kept);
    let first_lost = d.sub(first, first_kept);
    let second_lost = d.sub(second, second_kept);
    let low = d.add(first_lost, second_lost);
    let negated = d.neg(second);
    let product_lost = d.fma(n, second_part, negated);
    let low = d.add(low, product_lost);
    let low = d.fma(n, third_part, low);

    let square = d.mul(r, r);
    let cube = d.mul(square, r);
    let tail = polynomial(d, square, &SIN);
    let tail = d.fma(cube, tail, low);
    let sin = d.add(r, tail);

    let tail = polynomial(d, square, &COS);
    let half = d.constant(-0.5);
    let one = d.constant(1.0);
    let tail = d.fma(square, tail, half);
    let cos = d.fma(square, tail, one);
    Reduced { sin, cos, quarters }
}

/// True where the lowest bit is set.
#[inline(always)]
fn is_odd<D: Domain>(d: &mut D, bits: D::Bits) -> D::Mask {
    let one = d.bits_constant(1);
    let thirty = d.bits_constant(30);
    let lowest = d.bit_and(bits, one);
    // 1 << 30 are the bits of 2.0: a mask can only come from comparing reals.
    let two_or_zero = d.shl(lowest, thirty);
    let real = d.from_bits(two_or_zero);
    let two = d.constant(2.0);
    d.eq(real, two)
}

/// The second lowest of `bits`, moved to the place of the sign.
#[inline(always)]
fn second_bit_as_sign<D: Domain>(d: &mut D, bits: D::Bits) -> D::Bits {
    let second = d.bits_constant(2);
    let thirty = d.bits_constant(30);
    let second = d.bit_and(bits, second);
    d.shl(second, thirty)
}

/// `a` with its sign flipped where `sign` has the sign bit.
#[inline(always)]
fn flip_sign<D: Domain>(d: &mut D, a: D::Real, sign: D::Bits) -> D::Real {
    let bits = d.to_bits(a);
    let flipped = d.bit_xor(bits, sign);
    d.from_bits(flipped)
}

/// The sine of radians, within 1.25 ULP for magnitudes up to [`LARGEST_ANGLE`]. Larger finite angles count as
/// zeros of their sign, so the result always lies in [-1, 1]. `sin(-0) = -0`; infinities and NaN give NaN.
#[inline(always)]
pub fn sin<D: Domain>(d: &mut D, a: D::Real) -> D::Real {
    let reduced = reduce_angle(d, a);
    let odd = is_odd(d, reduced.quarters);
    let value = d.select(odd, reduced.cos, reduced.sin);
    let turned = second_bit_as_sign(d, reduced.quarters);
    let sign = d.bits_constant(0x8000_0000);
    let bits = d.to_bits(a);
    let negative = d.bit_and(bits, sign);
    let sign = d.bit_xor(negative, turned);
    flip_sign(d, value, sign)
}

/// The cosine of radians, within 1.25 ULP for magnitudes up to [`LARGEST_ANGLE`]. Larger finite angles count
/// as zero, so the result always lies in [-1, 1]. Infinities and NaN give NaN.
#[inline(always)]
pub fn cos<D: Domain>(d: &mut D, a: D::Real) -> D::Real {
    let reduced = reduce_angle(d, a);
    let odd = is_odd(d, reduced.quarters);
    let value = d.select(odd, reduced.sin, reduced.cos);
    // The cosine is negative in the second and third quarter: a quarter more makes that the sine's rule.
    let one = d.bits_constant(1);
    let next = d.int_add(reduced.quarters, one);
    let sign = second_bit_as_sign(d, next);
    flip_sign(d, value, sign)
}

// ── exponential
// ─────────────────────────────────────────────────────────────────────────────────────────────────

/// ln 2 in two parts.
const LN_2: [f32; 2] = [std::f32::consts::LN_2, -1.904_654_2e-9];
/// `(e^r - 1 - r) / r^2` for |r| <= 1.003 ln(2)/2: error 2^-28.3 of the exponential.
const EXP: [f32; 5] = [0.499_999_94, 0.166_665_2, 0.041_668_408, 0.008_368_921_5, 0.001_381_417];

/// `a * 2^n`, rounded once, where `shifted` has the bits of `ROUND + n` and -200 <= n <= 200.
///
/// 2^n itself may be no `f32`, so it is applied in two halves; the first product is exact for |a| near 1, and
/// the second one rounds to a subnormal or overflows as it should.
#[inline(always)]
fn scale<D: Domain>(d: &mut D, a: D::Real, shifted: D::Real) -> D::Real {
    // n + 256 is positive, so that a logical shift halves it; a half h + 128 has the exponent field h + 127.
    let bits = d.to_bits(shifted);
    let zero = d.bits_constant(ROUND.to_bits() - 256);
    let one = d.bits_constant(1);
    let shift = d.bits_constant(EXPONENT_SHIFT);
    let n = d.int_sub(bits, zero);
    let half = d.shr(n, one);
    let rest = d.int_sub(n, half);
    let mut product = a;
    for part in [half, rest] {
        let field = d.int_sub(part, one);
        let power = d.shl(field, shift);
        let power = d.from_bits(power);
        product = d.mul(product, power);
    }
    product
}

/// e to the power a, within 1 ULP, also where the result is subnormal. Overflows to infinity above 88.72284;
/// `exp(-inf) = 0`, `exp(0) = 1`, `exp(inf) = inf`, NaN gives NaN.
#[inline(always)]
pub fn exp<D: Domain>(d: &mut D, a: D::Real) -> D::Real {
    // Beyond these the result is infinity and zero anyway. A NaN passes: min and max give their second
    // operand for it.
    let highest = d.constant(89.0);
    let lowest = d.constant(-104.0);
    let x = d.min(highest, a);
    let x = d.max(lowest, x);

    let round = d.constant(ROUND);
    let log2_e = d.constant(std::f32::consts::LOG2_E);
    let shifted = d.fma(x, log2_e, round);
    let n = d.sub(shifted, round);
    // The first step is exact; what the second one loses goes to `low`.
    let [first_part, second_part] = LN_2.map(|part| d.constant(-part));
    let first = d.fma(n, first_part, x);
    let r = d.fma(n, second_part, first);
    let lost = d.sub(first, r);
    let low = d.fma(n, second_part, lost);

    let tail = polynomial(d, r, &EXP);
    let square = d.mul(r, r);
    let tail = d.fma(square, tail, low);
    let tail = d.add(r, tail);
    let one = d.constant(1.0);
    let value = d.add(one, tail);
    scale(d, value, shifted)
}

// ── logarithm
// ───────────────────────────────────────────────────────────────────────────────────────────────────

/// The bits of the float below the square root of 1/2: mantissas are taken from there to its double.
const SQRT_HALF: u32 = 0x3f35_04f3;
/// ln 2 in two parts, of which the first has 15 bits: its products with exponents are exact.
const LN_2_SHORT: [f32; 2] = [0.693_145_75, 1.428_606_8e-6];
/// `(ln(1 + f) - f) / f^2` for sqrt(1/2) <= 1 + f <= sqrt(2): error 2^-27.9 of the logarithm.
const LN: [f32; 9] = [
    -0.499_999_88,
    0.333_333_25,
    -0.250_015_97,
    0.200_020_88,
    -0.166_087_96,
    0.141_792_55,
    -0.132_427_16,
    0.129_219_44,
    -0.076_449_96,
];

/// A positive number as mantissa and exponent.
struct Split<D: Domain> {
    /// In [sqrt(1/2), sqrt(2)).
    mantissa: D::Real,
    /// An integer.
    exponent: D::Real,
}

/// Splits a positive finite number, subnormal or not, exactly. Other numbers give something.
#[inline(always)]
fn split<D: Domain>(d: &mut D, a: D::Real) -> Split<D> {
    // A subnormal is scaled up by 2^24 first; the bias of the exponent takes it back.
    let smallest_normal = d.constant(f32::MIN_POSITIVE);
    let subnormal = d.lt(a, smallest_normal);
    let up = d.constant(16_777_216.0);
    let scaled = d.mul(a, up);
    let a = d.select(subnormal, scaled, a);
    let bias = d.constant(ROUND + 127.0);
    let bias_up = d.constant(ROUND + 127.0 + 24.0);
    let bias = d.select(subnormal, bias_up, bias);

    let bits = d.to_bits(a);
    let to_one = d.bits_constant(0x3f80_0000 - SQRT_HALF);
    let shift = d.bits_constant(EXPONENT_SHIFT);
    let moved = d.int_add(bits, to_one);
    let field = d.shr(moved, shift);
    let round_bits = d.bits_constant(ROUND.to_bits());
    let field = d.int_add(field, round_bits);
    let field = d.from_bits(field);
    let exponent = d.sub(field, bias);

    let low = d.bits_constant(0x007f_ffff);
    let from_sqrt = d.bits_constant(SQRT_HALF);
    let low = d.bit_and(moved, low);
    let mantissa = d.int_add(low, from_sqrt);
    let mantissa = d.from_bits(mantissa);
    Split { mantissa, exponent }
}

/// `value` for positive finite `a`; else what every logarithm gives: -inf at zeros, NaN below, the rest of
/// `a` itself.
#[inline(always)]
fn logarithm_or_special<D: Domain>(d: &mut D, a: D::Real, value: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    let infinity = d.constant(f32::INFINITY);
    let nan = d.constant(f32::NAN);
    let below_infinity = d.constant(f32::NEG_INFINITY);
    let positive = d.lt(zero, a);
    let finite = d.lt(a, infinity);
    let normal = d.both(positive, finite);
    let negative = d.lt(a, zero);
    let is_zero = d.eq(a, zero);
    let special = d.select(negative, nan, a);
    let special = d.select(is_zero, below_infinity, special);
    d.select(normal, value, special)
}

/// The natural logarithm, within 1 ULP, subnormal operands included. `ln(1) = +0`, `ln(0) = -inf` for zeros
/// of either sign, `ln(inf) = inf`; below zero and for NaN it gives NaN.
#[inline(always)]
pub fn ln<D: Domain>(d: &mut D, a: D::Real) -> D::Real {
    let Split { mantissa, exponent } = split(d, a);
    let one = d.constant(1.0);
    let f = d.sub(mantissa, one);
    let parts = LN_2_SHORT.map(|part| d.constant(part));
    let whole = d.mul(exponent, parts[0]);

    // whole + f = sum + lost, exactly (Dekker, 1971): |whole| > |f| unless it is 0.
    let sum = d.add(whole, f);
    let added = d.sub(sum, whole);
    let lost = d.sub(f, added);

    let tail = polynomial(d, f, &LN);
    let square = d.mul(f, f);
    let low = d.fma(exponent, parts[1], lost);
    let low = d.fma(square, tail, low);
    let value = d.add(sum, low);
    logarithm_or_special(d, a, value)
}

// ── power
// ───────────────────────────────────────────────────────────────────────────────────────────────────────

/// 2 / ln 2 in two parts.
const LOG2_FIRST: [f32; 2] = [2.885_39, 3.851_926e-8];
/// 2 / (3 ln 2) in two parts.
const LOG2_SECOND: [f32; 2] = [0.961_796_7, -7.028_462e-9];
/// What follows in `log2((1 + s) / (1 - s)) / s` after these two, divided by z^2, in z = s^2, for s up to
/// where the quotient is sqrt(2): error 2^-36.8 of the logarithm.
const LOG2: [f32; 3] = [0.577_080_2, 0.411_847_35, 0.337_876_56];
/// `(2^r - 1) / r` for |r| <= 0.5003: error 2^-28.5 of the power.
const EXP2: [f32; 6] =
    [0.693_147_24, 0.240_226_52, 0.055_503_104, 0.009_617_692, 0.001_340_673_5, 0.000_155_949_14];

/// An unevaluated sum of two reals, the second one far smaller: about 46 bits.
struct DoubleReal<D: Domain> {
    high: D::Real,
    low: D::Real,
}

impl<D: Domain> DoubleReal<D> {
    /// `a + (b + low)` for |a| >= |b| or a = 0 (Dekker, 1971).
    #[inline(always)]
    fn sum(d: &mut D, a: D::Real, b: D::Real, low: D::Real) -> Self {
        let high = d.add(a, b);
        let added = d.sub(high, a);
        let lost = d.sub(b, added);
        let low = d.add(lost, low);
        Self { high, low }
    }

    /// The product, without that of the low parts.
    #[inline(always)]
    fn product(d: &mut D, a: &Self, b: &Self) -> Self {
        let high = d.mul(a.high, b.high);
        let negated = d.neg(high);
        let lost = d.fma(a.high, b.high, negated);
        let cross = d.fma(a.high, b.low, lost);
        let low = d.fma(a.low, b.high, cross);
        Self { high, low }
    }
}

/// The binary logarithm of a positive finite number, to about 2^-34 of itself.
#[inline(always)]
fn log2_pair<D: Domain>(d: &mut D, a: D::Real) -> DoubleReal<D> {
    let Split { mantissa, exponent } = split(d, a);

    // s = (m - 1) / (m + 1): the numerator is exact, the denominator a pair, and `fma` gives the remainder of
    // the quotient.
    let one = d.constant(1.0);
    let numerator = d.sub(mantissa, one);
    let denominator = d.add(mantissa, one);
    let added = d.sub(denominator, one);
    let lost = d.sub(mantissa, added);
    let inverse = d.div(one, denominator);
    let high = d.mul(numerator, inverse);
    let negated = d.neg(high);
    let remainder = d.fma(negated, denominator, numerator);
    let remainder = d.fma(negated, lost, remainder);
    let low = d.mul(remainder, inverse);
    let s = DoubleReal { high, low };

    // log2 m = s (c0 + z (c1 + z tail)) with z = s^2; only the tail may be a single real.
    let z = DoubleReal::product(d, &s, &s);
    let tail = polynomial(d, z.high, &LOG2);
    let tail = d.mul(z.high, tail);
    let [c0, c0_low] = LOG2_FIRST.map(|part| d.constant(part));
    let [c1, c1_low] = LOG2_SECOND.map(|part| d.constant(part));
    let second = DoubleReal::sum(d, c1, tail, c1_low);
    let second = DoubleReal::product(d, &z, &second);
    let low = d.add(second.low, c0_low);
    let first = DoubleReal::sum(d, c0, second.high, low);
    let log = DoubleReal::product(d, &s, &first);
    DoubleReal::sum(d, exponent, log.high, log.low)
}

/// `a` to the power `b`, within 1.25 ULP, also where the result is subnormal.
///
/// Exactly: `pow(1, b) = 1` and `pow(a, 0) = 1` for **every** other operand, NaN too. Else a NaN gives NaN,
/// and so does a negative `a`. Both zeros are alike: `pow(0, b)` is 0 for b > 0 and inf for b < 0. `pow(inf,
/// b)` is inf for b > 0 and 0 for b < 0; `pow(a, inf)` is 0 for a < 1 and inf for a > 1, `pow(a, -inf)` the
/// other way round.
#[inline(always)]
pub fn pow<D: Domain>(d: &mut D, a: D::Real, b: D::Real) -> D::Real {
    let log = log2_pair(d, a);
    let log_high = logarithm_or_special(d, a, log.high);

    // y = b log2(a) as a pair. Where it is out of every range or not finite, the low part would only make a
    // NaN of it.
    let high = d.mul(b, log_high);
    let negated = d.neg(high);
    let lost = d.fma(b, log_high, negated);
    let low = d.fma(b, log.low, lost);
    let zero = d.constant(0.0);
    let limit = d.constant(160.0);
    let lower_limit = d.constant(-160.0);
    let magnitude = d.abs(high);
    let in_range = d.lt(magnitude, limit);
    let low = d.select(in_range, low, zero);
    let high = d.min(limit, high);
    let high = d.max(lower_limit, high);

    let round = d.constant(ROUND);
    let shifted = d.add(high, round);
    let n = d.sub(shifted, round);
    let r = d.sub(high, n);
    let r = d.add(r, low);
    let tail = polynomial(d, r, &EXP2);
    let one = d.constant(1.0);
    let value = d.fma(r, tail, one);
    let value = scale(d, value, shifted);

    let base_one = d.eq(a, one);
    let exponent_zero = d.eq(b, zero);
    let exact = d.either(base_one, exponent_zero);
    d.select(exact, one, value)
}
