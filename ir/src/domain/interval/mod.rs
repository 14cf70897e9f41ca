//! Ranges as a meaning of the ops: every real is a range that encloses what it can be while the inputs stay
//! in theirs.
//!
//! [`Interval<D>`] stands on another domain `D`, in which the bounds are computed. On `Scalar` it is interval
//! arithmetic; on `FunctionBuilder` it *emits* another function, whose inputs and outputs are bounds: the
//! pass [`interval`](crate::pass::interval()). Both are this one implementation, take the same forms and give
//! the same bounds.
//!
//! # What a range is
//!
//! At the doors (the inputs and outputs of [`enclose`] and of the pass) a range is two numbers, low <= high.
//! **(-inf, inf) admits anything, NaN too. Every other range promises: the value is not NaN, and low <= value
//! <= high.** There is no empty range; two inputs that are none, because low > high or a bound is NaN, count
//! as (-inf, inf). -0 and +0 are the same bound.
//!
//! Between the doors less is promised, so that no op has to tidy up behind itself:
//!
//! > *Whenever the value is a number, it is not below `low` and not above `high`. If both bounds are finite,
//! > it is a number.*
//!
//! So a bound that is NaN bounds nothing on its side, and a bound that is not finite says that the value may
//! be NaN. With that, the plain ops on the bounds do most of the work: NaN comes from NaN, `inf - inf`, `0 *
//! inf` and the like, hence only from ranges with a bound that is not finite, and sums, differences and
//! products of such a bound are not finite either. Where a form would lose it (`max(x, 0)`, a square), the
//! bound is *guarded*: `fma(other, 0, bound)` is the bound, or NaN where the other one is not finite. The
//! outputs are tidy again: two finite bounds, or (-inf, inf).
//!
//! A mask is what is certain of it: that it holds, that it does not, or neither. Bits are known exactly or
//! not at all.
//!
//! # What is promised
//!
//! Enclosure of every `f32` that *the function's own ops* compute at points whose inputs are in the ranges.
//! Rounding to nearest is monotone, so the ops at the ends enclose, and nothing is rounded outwards. The
//! transcendentals are the exception: their approximations need not be monotone, so their bounds are widened
//! by 4 units in the last place, more than twice the error that [`crate::math`] states. A *point*, a value
//! that depends on no input, is computed as it is, in one op.
//!
//! # What makes it sharp
//!
//! * Every result has an identity, so `x * x` and `fma(x, x, c)` are known to be squares. Two ranges with
//!   equal bounds are not one value; one value that is used twice is.
//! * Facts that are known before there are numbers, signs above all, choose short forms.
//! * The larger of `x` and `k - x` is not below `k / 2`, the smaller one not above (see `order`).
//! * A formula that is known to grow is bounded by its values at ends, by `low_end`. The range of that op is
//!   no enclosure: it is the end.

mod arithmetic;
mod enclosure;
mod facts;
mod order;
mod transcendental;
mod value;

#[cfg(test)]
mod tests;

pub use enclosure::enclose;
pub(crate) use enclosure::{BoundParts, Enclosure, Ground};
pub use value::{Certainty, Interval, Known, Range};

use facts::Facts;
use value::{Side, of_both, of_one};

use crate::op::{Domain, Op};

impl<D: Domain> Domain for Interval<D> {
    type Real = Range<D>;
    type Mask = Certainty<D>;
    type Bits = Known<D>;

    fn constant(&mut self, value: f32) -> Range<D> {
        let number = self.domain.constant(value);
        self.range(number, number, Facts::constant(value))
    }

    fn bits_constant(&mut self, value: u32) -> Known<D> {
        Known(Some(self.domain.bits_constant(value)))
    }

    fn add(&mut self, a: Range<D>, b: Range<D>) -> Range<D> {
        self.bounds(of_both(Op::Add, a, b), |d| d.add(a.low, b.low), |d| d.add(a.high, b.high))
    }

    fn sub(&mut self, a: Range<D>, b: Range<D>) -> Range<D> {
        let difference =
            self.bounds(of_both(Op::Sub, a, b), |d| d.sub(a.low, b.high), |d| d.sub(a.high, b.low));
        self.complement(a, b, difference)
    }

    fn mul(&mut self, a: Range<D>, b: Range<D>) -> Range<D> {
        self.product(a, b)
    }

    fn div(&mut self, a: Range<D>, b: Range<D>) -> Range<D> {
        self.quotient(a, b)
    }

    fn fma(&mut self, a: Range<D>, b: Range<D>, c: Range<D>) -> Range<D> {
        self.fused(a, b, c)
    }

    fn neg(&mut self, a: Range<D>) -> Range<D> {
        self.bounds(of_one(Op::Neg, a), |d| d.neg(a.high), |d| d.neg(a.low))
    }

    fn abs(&mut self, a: Range<D>) -> Range<D> {
        self.magnitude(a)
    }

    fn sqrt(&mut self, a: Range<D>) -> Range<D> {
        self.square_root(a)
    }

    fn min(&mut self, a: Range<D>, b: Range<D>) -> Range<D> {
        self.extreme(Side::Lowest, a, b)
    }

    fn max(&mut self, a: Range<D>, b: Range<D>) -> Range<D> {
        self.extreme(Side::Highest, a, b)
    }

    fn lt(&mut self, a: Range<D>, b: Range<D>) -> Certainty<D> {
        self.less(a, b)
    }

    fn le(&mut self, a: Range<D>, b: Range<D>) -> Certainty<D> {
        self.less_or_equal(a, b)
    }

    fn eq(&mut self, a: Range<D>, b: Range<D>) -> Certainty<D> {
        self.equal(a, b)
    }

    fn both(&mut self, a: Certainty<D>, b: Certainty<D>) -> Certainty<D> {
        let yes = self.domain.both(a.yes, b.yes);
        if a.decided && b.decided {
            return self.decided(yes);
        }
        Certainty { yes, no: self.domain.either(a.no, b.no), decided: false }
    }

    fn either(&mut self, a: Certainty<D>, b: Certainty<D>) -> Certainty<D> {
        let yes = self.domain.either(a.yes, b.yes);
        if a.decided && b.decided {
            return self.decided(yes);
        }
        Certainty { yes, no: self.domain.both(a.no, b.no), decided: false }
    }

    fn not(&mut self, a: Certainty<D>) -> Certainty<D> {
        Certainty { yes: a.no, no: a.yes, decided: a.decided }
    }

    fn select(&mut self, condition: Certainty<D>, a: Range<D>, b: Range<D>) -> Range<D> {
        self.choice(condition, a, b)
    }

    fn to_bits(&mut self, a: Range<D>) -> Known<D> {
        Known(a.facts.point.then(|| self.domain.to_bits(a.low)))
    }

    fn from_bits(&mut self, a: Known<D>) -> Range<D> {
        match a.0 {
            Some(bits) => {
                let value = self.domain.from_bits(bits);
                self.point(value)
            }
            None => self.anything(),
        }
    }

    fn bit_and(&mut self, a: Known<D>, b: Known<D>) -> Known<D> {
        self.bits(a, b, D::bit_and)
    }

    fn bit_or(&mut self, a: Known<D>, b: Known<D>) -> Known<D> {
        self.bits(a, b, D::bit_or)
    }

    fn bit_xor(&mut self, a: Known<D>, b: Known<D>) -> Known<D> {
        self.bits(a, b, D::bit_xor)
    }

    fn int_add(&mut self, a: Known<D>, b: Known<D>) -> Known<D> {
        self.bits(a, b, D::int_add)
    }

    fn int_sub(&mut self, a: Known<D>, b: Known<D>) -> Known<D> {
        self.bits(a, b, D::int_sub)
    }

    fn shl(&mut self, a: Known<D>, by: Known<D>) -> Known<D> {
        self.bits(a, by, D::shl)
    }

    fn shr(&mut self, a: Known<D>, by: Known<D>) -> Known<D> {
        self.bits(a, by, D::shr)
    }

    fn sin(&mut self, a: Range<D>) -> Range<D> {
        self.wave(a, transcendental::SIN)
    }

    fn cos(&mut self, a: Range<D>) -> Range<D> {
        self.wave(a, transcendental::COS)
    }

    fn exp(&mut self, a: Range<D>) -> Range<D> {
        self.exponential(a)
    }

    fn ln(&mut self, a: Range<D>) -> Range<D> {
        self.logarithm(a)
    }

    fn pow(&mut self, a: Range<D>, b: Range<D>) -> Range<D> {
        self.power(a, b)
    }

    /// The same value, so it keeps its identity.
    fn stop_gradient(&mut self, a: Range<D>) -> Range<D> {
        a
    }

    fn slope_x(&mut self, _: Range<D>) -> Range<D> {
        self.constant(0.0)
    }

    fn slope_y(&mut self, _: Range<D>) -> Range<D> {
        self.constant(0.0)
    }

    fn slope_z(&mut self, _: Range<D>) -> Range<D> {
        self.constant(0.0)
    }

    fn low_end(&mut self, a: Range<D>) -> Range<D> {
        self.lowest(a)
    }
}
