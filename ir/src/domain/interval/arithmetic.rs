//! Products, quotients, roots and magnitudes of ranges.
//!
//! The ends of a product of ranges are products of ends. Signs tell which ones; without known signs, four
//! candidates are compared:
//!
//! ```text
//!                    low        high
//! x * x              near^2     far^2         near: the x that is nearest to 0; far: the larger magnitude
//! a >= 0, b >= 0     al bl      ah bh
//! a >= 0, b <= 0     ah bl      al bh
//! a >= 0, any b      (bl < 0 ? ah : al) bl    (bh < 0 ? al : ah) bh
//! x^m * x^n          of the x at the low end, at the high end         where one of m and n is odd; of x^3, say
//! point p, any b     p (p < 0 ? bh : bl)      p (p < 0 ? bl : bh)
//! else               the least and the greatest of al bl, al bh, ah bl, ah bh
//! ```
//!
//! `fma` takes the same ends and adds the low and the high bound of its third operand in the one rounding.

use crate::facts::Fact as _;
use crate::op::{Domain, Op};

use super::facts::{Facts, Sign};
use super::value::{Interval, Range, RangePower, as_power, of_both, of_one, same};

/// Two factors.
type RealPair<D> = (<D as Domain>::Real, <D as Domain>::Real);

/// Where the ends of a product are.
enum Ends<D: Domain> {
    /// The low one and the high one.
    At(RealPair<D>, RealPair<D>),
    /// Each is one of four. The range becomes NaN where the number, times anything, says that a bound is not
    /// finite.
    Among([RealPair<D>; 4], D::Real),
}

/// Whether one side is an odd power of a value of any sign, the other one an even power.
fn is_odd_power<D: Domain>(a: Range<D>, b: Range<D>) -> bool {
    let (a_power, b_power) = (as_power(a), as_power(b));
    a_power.base == b_power.base && (a_power.squarings == 0) != (b_power.squarings == 0)
}

/// What power a product is. Where the sign of the base is known, other forms are as sharp.
fn power<D: Domain>(a: Range<D>, b: Range<D>, product: Range<D>) -> Option<RangePower<D>> {
    let known = as_power(a);
    if is_odd_power(a, b) {
        return Some(RangePower { ends: [product.low, product.high], squarings: 0, ..known });
    }
    let any = a.power.is_some() || (a.facts.sign == Sign::Unknown && !a.facts.point);
    (same(a, b) && any).then_some(RangePower { squarings: known.squarings + 1, ..known })
}

impl<D: Domain> Interval<D> {
    pub(super) fn product(&mut self, a: Range<D>, b: Range<D>) -> Range<D> {
        let facts = of_both(Op::Mul, a, b);
        let product = match self.ends(a, b) {
            Ends::At(low, high) => self.bounds(facts, |d| d.mul(low.0, low.1), |d| d.mul(high.0, high.1)),
            Ends::Among(pairs, guard) => {
                let products = pairs.map(|(x, y)| self.domain.mul(x, y));
                self.between(facts, products, products, guard)
            }
        };
        Range { power: power(a, b, product), ..product }
    }

    /// The ends of the product of an odd and an even power of one value, which is an odd power.
    fn odd_power(&mut self, a: Range<D>, b: Range<D>) -> Option<Ends<D>> {
        if !is_odd_power(a, b) {
            return None;
        }
        let [[a_low, a_high], [b_low, b_high]] = [a, b].map(|side| {
            let RangePower { ends, squarings, .. } = as_power(side);
            (0..squarings).fold(ends, |ends, _| ends.map(|end| self.domain.mul(end, end)))
        });
        Some(Ends::At((a_low, b_low), (a_high, b_high)))
    }

    pub(super) fn fused(&mut self, a: Range<D>, b: Range<D>, c: Range<D>) -> Range<D> {
        let facts = Facts::of(Op::Fma, &[a.facts, b.facts, c.facts], same(a, b));
        match self.ends(a, b) {
            Ends::At(low, high) => {
                self.bounds(facts, |d| d.fma(low.0, low.1, c.low), |d| d.fma(high.0, high.1, c.high))
            }
            Ends::Among(pairs, guard) => {
                let lows = pairs.map(|(x, y)| self.domain.fma(x, y, c.low));
                let highs =
                    if c.facts.point { lows } else { pairs.map(|(x, y)| self.domain.fma(x, y, c.high)) };
                self.between(facts, lows, highs, guard)
            }
        }
    }

    /// From the least of the lows to the greatest of the highs; unbounded where `guard` is not finite.
    fn between(&mut self, facts: Facts, lows: [D::Real; 4], highs: [D::Real; 4], guard: D::Real) -> Range<D> {
        let low = least(&mut self.domain, lows);
        let high = greatest(&mut self.domain, highs);
        let low = self.guarded(low, guard);
        let high = self.guarded(high, guard);
        self.range(low, high, facts)
    }

    fn ends(&mut self, a: Range<D>, b: Range<D>) -> Ends<D> {
        if a.facts.point && b.facts.point {
            return Ends::At((a.low, b.low), (a.low, b.low));
        }
        if same(a, b) {
            let (near, far) = self.near_and_far(a);
            return Ends::At((near, near), (far, far));
        }
        if let Some(ends) = self.odd_power(a, b) {
            return ends;
        }
        if b.facts.point {
            return self.scaled(a, b);
        }
        if a.facts.point {
            return self.scaled(b, a);
        }
        match (a.facts.sign, b.facts.sign) {
            (Sign::NonNegative, Sign::NonNegative) => Ends::At((a.low, b.low), (a.high, b.high)),
            (Sign::NonNegative, Sign::NonPositive) => Ends::At((a.high, b.low), (a.low, b.high)),
            (Sign::NonPositive, Sign::NonNegative) => Ends::At((a.low, b.high), (a.high, b.low)),
            (Sign::NonPositive, Sign::NonPositive) => Ends::At((a.high, b.high), (a.low, b.low)),
            (Sign::NonNegative | Sign::NonPositive, Sign::Unknown) => self.signed(a, b),
            (Sign::Unknown, Sign::NonNegative | Sign::NonPositive) => self.signed(b, a),
            (Sign::Unknown, Sign::Unknown) => {
                // A width is not finite where a bound is not finite, and then neither is the product of the
                // widths.
                let width = self.domain.sub(a.high, a.low);
                let other = self.domain.sub(b.high, b.low);
                let guard = self.domain.mul(width, other);
                let pairs = [(a.low, b.low), (a.low, b.high), (a.high, b.low), (a.high, b.high)];
                Ends::Among(pairs, guard)
            }
        }
    }

    /// The ends of `a` times a point.
    fn scaled(&mut self, a: Range<D>, by: Range<D>) -> Ends<D> {
        let (low, high) = match by.facts.sign {
            Sign::NonNegative => (a.low, a.high),
            Sign::NonPositive => (a.high, a.low),
            Sign::Unknown => self.turned(a, by.low),
        };
        Ends::At((low, by.low), (high, by.low))
    }

    /// The bounds of `a`, exchanged where `by` is negative.
    pub(super) fn turned(&mut self, a: Range<D>, by: D::Real) -> (D::Real, D::Real) {
        let d = &mut self.domain;
        let zero = d.constant(0.0);
        let negative = d.lt(by, zero);
        (d.select(negative, a.high, a.low), d.select(negative, a.low, a.high))
    }

    /// The ends of the product of `a`, whose sign is known, and `b`, whose sign is not.
    fn signed(&mut self, a: Range<D>, b: Range<D>) -> Ends<D> {
        let (low, high) = if a.facts.sign == Sign::NonPositive { (b.high, b.low) } else { (b.low, b.high) };
        let d = &mut self.domain;
        let zero = d.constant(0.0);
        let low_negative = d.lt(low, zero);
        let high_negative = d.lt(high, zero);
        let at_low = d.select(low_negative, a.high, a.low);
        let at_high = d.select(high_negative, a.low, a.high);
        Ends::At((at_low, low), (at_high, high))
    }

    /// The number of the range nearest to 0, and one of the largest magnitude. The latter is not finite where
    /// a bound is not finite.
    fn near_and_far(&mut self, a: Range<D>) -> RealPair<D> {
        match a.facts.sign {
            Sign::NonNegative => (a.low, a.high),
            Sign::NonPositive => (a.high, a.low),
            Sign::Unknown => {
                let d = &mut self.domain;
                let zero = d.constant(0.0);
                let near = d.min(a.high, zero);
                let near = d.max(a.low, near);
                let mut below = d.neg(a.low);
                if !a.facts.paired {
                    // The low bound may bound nothing, though the high bound is finite.
                    let infinity = d.constant(f32::INFINITY);
                    below = d.min(below, infinity);
                }
                (near, d.max(below, a.high))
            }
        }
    }

    pub(super) fn magnitude(&mut self, a: Range<D>) -> Range<D> {
        let facts = of_one(Op::Abs, a);
        if facts.point {
            return self.bounds(facts, |d| d.abs(a.low), |d| d.abs(a.high));
        }
        match a.facts.sign {
            Sign::NonNegative => self.range(a.low, a.high, facts),
            Sign::NonPositive => self.bounds(facts, |d| d.neg(a.high), |d| d.neg(a.low)),
            Sign::Unknown => {
                let (near, far) = self.near_and_far(a);
                self.bounds(facts, |d| d.abs(near), |_| far)
            }
        }
    }

    pub(super) fn square_root(&mut self, a: Range<D>) -> Range<D> {
        let facts = of_one(Op::Sqrt, a);
        let root = self.bounds(facts, |d| d.sqrt(a.low), |d| d.sqrt(a.high));
        if facts.point || a.facts.sign == Sign::NonNegative {
            return root;
        }
        // A negative low bound has become NaN: the root of the range may be NaN.
        let high = self.guarded(root.high, root.low);
        Range { high, ..root }
    }

    pub(super) fn quotient(&mut self, a: Range<D>, b: Range<D>) -> Range<D> {
        let facts = of_both(Op::Div, a, b);
        if facts.point {
            return self.bounds(facts, |d| d.div(a.low, b.low), |d| d.div(a.high, b.high));
        }
        if b.facts.point {
            return self.over_point(facts, a, b);
        }
        let (low, high, sound) = match b.facts.sign {
            Sign::NonNegative => self.over_positive(a, b),
            Sign::NonPositive => {
                let (a, b) = (self.neg(a), self.neg(b));
                self.over_positive(a, b)
            }
            Sign::Unknown => self.over_any(a, b),
        };
        let d = &mut self.domain;
        let nan = d.constant(f32::NAN);
        self.bounds(facts, |d| d.select(sound, low, nan), |d| d.select(sound, high, nan))
    }

    fn over_point(&mut self, facts: Facts, a: Range<D>, b: Range<D>) -> Range<D> {
        let (low, high) = match b.facts.constant {
            Some(number) if number > 0.0 => (a.low, a.high),
            Some(number) if number < 0.0 => (a.high, a.low),
            Some(_) | None => {
                // The inverse of a zero has the sign of the zero, too.
                let one = self.domain.constant(1.0);
                let inverse = self.domain.div(one, b.low);
                self.turned(a, inverse)
            }
        };
        self.bounds(facts, |d| d.div(low, b.low), |d| d.div(high, b.low))
    }

    /// The bounds of `a / b` for b > 0, and whether b > 0 and b is finite.
    fn over_positive(&mut self, a: Range<D>, b: Range<D>) -> (D::Real, D::Real, D::Mask) {
        let d = &mut self.domain;
        let (zero, infinity) = (d.constant(0.0), d.constant(f32::INFINITY));
        let (low_divisor, high_divisor) = match a.facts.sign {
            Sign::NonNegative => (b.high, b.low),
            Sign::NonPositive => (b.low, b.high),
            Sign::Unknown => {
                let below = d.lt(a.low, zero);
                let above = d.lt(a.high, zero);
                (d.select(below, b.low, b.high), d.select(above, b.high, b.low))
            }
        };
        let low = d.div(a.low, low_divisor);
        let high = d.div(a.high, high_divisor);
        let positive = d.lt(zero, b.low);
        let finite = d.lt(b.high, infinity);
        (low, high, d.both(positive, finite))
    }

    /// The bounds of `a / b` for b without 0, and whether b is without 0 and all bounds are finite.
    fn over_any(&mut self, a: Range<D>, b: Range<D>) -> (D::Real, D::Real, D::Mask) {
        let pairs = [(a.low, b.low), (a.low, b.high), (a.high, b.low), (a.high, b.high)];
        let quotients = pairs.map(|(x, y)| self.domain.div(x, y));
        let low = least(&mut self.domain, quotients);
        let high = greatest(&mut self.domain, quotients);
        let known = self.finite(a);
        let finite = self.finite(b);
        let d = &mut self.domain;
        let zero = d.constant(0.0);
        let positive = d.lt(zero, b.low);
        let negative = d.lt(b.high, zero);
        let without_zero = d.either(positive, negative);
        let known = d.both(known, finite);
        (low, high, d.both(known, without_zero))
    }
}

pub(super) fn least<D: Domain>(d: &mut D, [a, b, e, f]: [D::Real; 4]) -> D::Real {
    let first = d.min(a, b);
    let second = d.min(e, f);
    d.min(first, second)
}

pub(super) fn greatest<D: Domain>(d: &mut D, [a, b, e, f]: [D::Real; 4]) -> D::Real {
    let first = d.max(a, b);
    let second = d.max(e, f);
    d.max(first, second)
}
