//! Ranges of sine, cosine, exponential, logarithm and power: the ops themselves at the ends, widened.
//!
//! An approximation g of a monotone function f need not be monotone. With `|g(x) - f(x)| <= e |f(x)| + t` for
//! all x, and for x above the low end a,
//!
//! ```text
//! g(x) >= f(x) - e |f(x)| - t >= f(a) - e |f(a)| - t >= g(a) - 2e/(1-e) (|g(a)| + t) - 2t
//! ```
//!
//! [`crate::math`] states errors up to 1.25 units in the last place, so e = 1.25 * 2^-23 and t = 1.25 *
//! 2^-149. Bounds are widened by [`RELATIVE`] of themselves and [`ABSOLUTE`], which is more than that by
//! enough for the roundings of the widening itself.
//!
//! **Sine and cosine** have a peak or a trough between the ends if a whole number lies between the ends,
//! measured in turns and shifted by the phase of the peak. The error of the turns is below 2^-23 of the angle
//! and 2^-21. The ends are moved apart by more than that, so a peak is never missed, and one just outside may
//! be seen. A bound at a peak is 1 or -1, which the ops never exceed.
//!
//! **Powers** of positive bases are monotone in each operand: the sign of the exponent gives the direction in
//! the base, the sign of the base minus 1 the direction in the exponent. So the extremes are at corners: each
//! at one known corner if the sign of the exponent is known, otherwise at one of four.

use super::arithmetic::{greatest, least};
use super::facts::{Facts, Sign};
use super::value::{Interval, Range, of_both, of_one};
use crate::math::LARGEST_ANGLE;
use crate::op::{Domain, Op};

/// 4 units in the last place, of a bound: 2^-21.
const RELATIVE: f32 = 4.768_371_6e-7;
/// 4 units in the last place of subnormals: 2^-147.
const ABSOLUTE: f32 = f32::from_bits(4);
/// 1.5 * 2^23: adding and subtracting it rounds a number below 2^22 to a whole one.
const ROUND: f32 = 12_582_912.0;
/// 1 / (2 pi).
const TURNS: f32 = 0.159_154_94;

/// A sine or a cosine: the phases of its peak and its trough.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wave {
    op: Op,
    /// What is added to turns to have a whole number at each peak.
    peak: f32,
    /// What is added to turns to have a whole number at each trough.
    trough: f32,
}

pub(super) const SIN: Wave = Wave { op: Op::Sin, peak: -0.25, trough: 0.25 };
pub(super) const COS: Wave = Wave { op: Op::Cos, peak: 0.0, trough: 0.5 };

impl Wave {
    fn of<D: Domain>(self, d: &mut D, a: D::Real) -> D::Real {
        if self.op == Op::Sin { d.sin(a) } else { d.cos(a) }
    }
}

impl<D: Domain> Interval<D> {
    /// A little less than a low bound.
    fn below(&mut self, bound: D::Real) -> D::Real {
        let margin = self.margin(bound);
        self.domain.sub(bound, margin)
    }

    /// A little more than a high bound.
    fn above(&mut self, bound: D::Real) -> D::Real {
        let margin = self.margin(bound);
        self.domain.add(bound, margin)
    }

    fn margin(&mut self, bound: D::Real) -> D::Real {
        let d = &mut self.domain;
        let (relative, absolute) = (d.constant(RELATIVE), d.constant(ABSOLUTE));
        let magnitude = d.abs(bound);
        d.fma(magnitude, relative, absolute)
    }

    /// A little less than a low bound that is never negative, at least 0. A NaN gives 0.
    fn below_but_not_negative(&mut self, bound: D::Real) -> D::Real {
        let low = self.below(bound);
        let zero = self.domain.constant(0.0);
        self.domain.max(low, zero)
    }

    pub(super) fn exponential(&mut self, a: Range<D>) -> Range<D> {
        let facts = of_one(Op::Exp, a);
        let low = self.domain.exp(a.low);
        if facts.point {
            return self.range(low, low, facts);
        }
        let low = self.below_but_not_negative(low);
        let high = self.domain.exp(a.high);
        let high = self.above(high);
        // exp(-inf) is finite, but a bound of -inf means that the value may be NaN.
        let high = self.guarded(high, a.low);
        self.range(low, high, facts)
    }

    pub(super) fn logarithm(&mut self, a: Range<D>) -> Range<D> {
        let facts = of_one(Op::Ln, a);
        let low = self.domain.ln(a.low);
        if facts.point {
            return self.range(low, low, facts);
        }
        // The logarithm of a negative bound is NaN, of 0 it is -inf: neither bounds anything.
        let low = self.below(low);
        let high = self.domain.ln(a.high);
        let high = self.above(high);
        self.range(low, high, facts)
    }

    pub(super) fn wave(&mut self, a: Range<D>, wave: Wave) -> Range<D> {
        let facts = of_one(wave.op, a);
        let first = wave.of(&mut self.domain, a.low);
        if facts.point {
            return self.range(first, first, facts);
        }
        let last = wave.of(&mut self.domain, a.high);
        let low = self.domain.min(first, last);
        let low = self.below(low);
        let high = self.domain.max(first, last);
        let high = self.above(high);

        let known = self.known_angles(a);
        let has_trough = self.has_whole_turn(a, wave.trough);
        let has_peak = self.has_whole_turn(a, wave.peak);
        let d = &mut self.domain;
        let (bottom, top) = (d.constant(-1.0), d.constant(1.0));
        let low = d.max(low, bottom);
        let low = d.select(has_trough, bottom, low);
        let low = d.select(known, low, bottom);
        let high = d.min(high, top);
        let high = d.select(has_peak, top, high);
        let high = d.select(known, high, top);
        let low = self.guarded(low, a.low);
        let high = self.guarded(high, a.high);
        self.range(low, high, facts)
    }

    /// Whether all angles are within what the ops reduce.
    fn known_angles(&mut self, a: Range<D>) -> D::Mask {
        let d = &mut self.domain;
        let (lowest, highest) = (d.constant(-LARGEST_ANGLE), d.constant(LARGEST_ANGLE));
        let above = d.le(lowest, a.low);
        let below = d.le(a.high, highest);
        d.both(above, below)
    }

    /// Whether a whole number may lie among the angles in turns plus `phase`. Meaningless where the angles
    /// are not known.
    fn has_whole_turn(&mut self, a: Range<D>, phase: f32) -> D::Mask {
        let d = &mut self.domain;
        let (turns, phase) = (d.constant(TURNS), d.constant(phase));
        let first = d.fma(a.low, turns, phase);
        let last = d.fma(a.high, turns, phase);

        let below = d.neg(a.low);
        let largest = d.max(below, a.high);
        let (relative, absolute) = (d.constant(2.0 * f32::EPSILON), d.constant(8.0 * f32::EPSILON));
        let error = d.fma(largest, relative, absolute);
        let first = d.sub(first, error);
        let last = d.add(last, error);

        // The greatest whole number that is not above the last: half a turn before it, rounded to the
        // nearest.
        let (half, round) = (d.constant(0.5), d.constant(ROUND));
        let before = d.sub(last, half);
        let shifted = d.add(before, round);
        let whole = d.sub(shifted, round);
        d.le(first, whole)
    }

    pub(super) fn power(&mut self, a: Range<D>, b: Range<D>) -> Range<D> {
        let facts = of_both(Op::Pow, a, b);
        if facts.point {
            return self.bounds(facts, |d| d.pow(a.low, b.low), |d| d.pow(a.high, b.high));
        }
        let (low, high) = if b.facts.point || b.facts.sign != Sign::Unknown {
            self.power_of_known_sign(a, b)
        } else {
            let corners = [(a.low, b.low), (a.low, b.high), (a.high, b.low), (a.high, b.high)];
            let powers = corners.map(|(base, exponent)| self.domain.pow(base, exponent));
            (least(&mut self.domain, powers), greatest(&mut self.domain, powers))
        };
        let low = self.below_but_not_negative(low);
        let high = self.above(high);
        self.where_powers_are_numbers(facts, a, b, low, high)
    }

    /// The least and the greatest power where all exponents have one sign.
    fn power_of_known_sign(&mut self, a: Range<D>, b: Range<D>) -> (D::Real, D::Real) {
        let (base_low, base_high) = match b.facts.sign {
            Sign::NonNegative => (a.low, a.high),
            Sign::NonPositive => (a.high, a.low),
            Sign::Unknown => self.turned(a, b.low),
        };
        let d = &mut self.domain;
        if b.facts.point {
            return (d.pow(base_low, b.low), d.pow(base_high, b.low));
        }
        // Powers of a base below 1 fall with the exponent.
        let one = d.constant(1.0);
        let falls_low = d.lt(base_low, one);
        let falls_high = d.lt(base_high, one);
        let exponent_low = d.select(falls_low, b.high, b.low);
        let exponent_high = d.select(falls_high, b.low, b.high);
        (d.pow(base_low, exponent_low), d.pow(base_high, exponent_high))
    }

    /// The bounds where no base is negative and all bounds are finite; elsewhere unbounded, for a power may
    /// be 1 whatever the base is.
    fn where_powers_are_numbers(
        &mut self,
        facts: Facts,
        a: Range<D>,
        b: Range<D>,
        low: D::Real,
        high: D::Real,
    ) -> Range<D> {
        let d = &mut self.domain;
        let (zero, infinity, nan) = (d.constant(0.0), d.constant(f32::INFINITY), d.constant(f32::NAN));
        let not_negative = d.le(zero, a.low);
        let below = d.lt(a.high, infinity);
        let mut sound = d.both(not_negative, below);
        if !b.facts.constant.is_some_and(f32::is_finite) {
            let finite = self.finite(b);
            sound = self.domain.both(sound, finite);
        }
        let d = &mut self.domain;
        let low = d.select(sound, low, nan);
        let high = d.select(sound, high, nan);
        self.range(low, high, facts)
    }
}
