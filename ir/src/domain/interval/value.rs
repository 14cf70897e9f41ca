//! What the values of the interval domain are, and what its ops are made of.

use std::fmt;

use super::facts::Facts;
use crate::facts::Fact as _;
use crate::op::{Domain, Op};

/// A real: two bounds, their facts, and the identity of the value.
#[derive(Debug)]
pub struct Range<D: Domain> {
    /// No number that the value can be is below this.
    pub low: D::Real,
    /// No number that the value can be is above this.
    pub high: D::Real,
    pub(super) facts: Facts,
    pub(super) identity: usize,
    /// If it is a power of another value.
    pub(super) power: Option<RangePower<D>>,
    /// If it is the complement of another value, or an extreme of values.
    pub(super) bounded: Bounded<D>,
}

/// One side of two numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Side {
    /// The smaller one.
    Lowest,
    /// The larger one.
    Highest,
}

/// What other values bound a value.
pub(super) enum Bounded<D: Domain> {
    /// None is known.
    Alone,
    /// It is `k - x`, k being a point.
    Complement(RangeComplement<D>),
    /// It is an extreme of some of these.
    Extreme(Side, [Option<Bounding<D>>; MOST_BOUNDING]),
}

/// How many values an extreme remembers.
pub(super) const MOST_BOUNDING: usize = 4;

/// `k - x`.
#[derive(Debug)]
pub(super) struct RangeComplement<D: Domain> {
    /// The identity of x.
    pub(super) base: usize,
    /// The bounds of x.
    pub(super) ends: [D::Real; 2],
    /// k.
    pub(super) whole: D::Real,
}

/// A value of which an extreme has been taken.
pub(super) struct Bounding<D: Domain> {
    /// Its identity.
    pub(super) identity: usize,
    /// If it is one.
    pub(super) complement: Option<RangeComplement<D>>,
}

/// What a power knows of the value that it is a power of, its *base*. The products of which odd powers are
/// made grow with the base, in f32 too; those of even ones grow with its magnitude.
#[derive(Debug)]
pub struct RangePower<D: Domain> {
    /// The identity of the base.
    pub(super) base: usize,
    /// An odd power, where the base is at its low and at its high bound.
    pub(super) ends: [D::Real; 2],
    /// How often that has been squared.
    pub(super) squarings: u32,
}

impl<D: Domain> fmt::Debug for Bounded<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Alone => f.write_str("Alone"),
            Self::Complement(complement) => write!(f, "Complement({})", complement.base),
            Self::Extreme(side, several) => {
                let identities = several.iter().flatten().map(|it| it.identity);
                write!(f, "{side:?} ")?;
                f.debug_list().entries(identities).finish()
            }
        }
    }
}

/// A mask: at most one of the two fields holds.
#[derive(Debug)]
pub struct Certainty<D: Domain> {
    /// It certainly holds.
    pub yes: D::Mask,
    /// It certainly does not.
    pub no: D::Mask,
    /// One of both holds, always.
    pub(super) decided: bool,
}

/// Bits, if they are known.
#[derive(Debug)]
pub struct Known<D: Domain>(pub(super) Option<D::Bits>);

macro_rules! copies {
    ($($name:ident)+) => { $(
        impl<D: Domain> Clone for $name<D> {
            fn clone(&self) -> Self {
                *self
            }
        }
        impl<D: Domain> Copy for $name<D> {}
    )+ };
}

copies!(Range RangePower Bounded RangeComplement Bounding Certainty Known);

/// The interval domain over `D`.
#[derive(Debug)]
pub struct Interval<D: Domain> {
    /// Where bounds are computed.
    pub domain: D,
    /// The identity of the next result.
    next: usize,
}

/// Ranges at the doors.
impl<D: Domain> Interval<D> {
    /// Computes bounds in this domain.
    #[must_use]
    pub const fn new(domain: D) -> Self {
        Self { domain, next: 0 }
    }

    /// A range from outside, which may be none.
    pub fn input(&mut self, low: D::Real, high: D::Real) -> Range<D> {
        let d = &mut self.domain;
        let ascending = d.le(low, high);
        let (lowest, highest) = (d.constant(f32::NEG_INFINITY), d.constant(f32::INFINITY));
        let low = d.select(ascending, low, lowest);
        let high = d.select(ascending, high, highest);
        self.range(low, high, Facts { paired: true, ..Facts::default() })
    }

    /// A number that is the same whatever the inputs are.
    pub fn point(&mut self, value: D::Real) -> Range<D> {
        self.range(value, value, Facts::POINT)
    }

    /// The bounds for the outside: both finite, or (-inf, inf).
    pub fn output(&mut self, range: Range<D>) -> [D::Real; 2] {
        let finite = self.finite(range);
        let d = &mut self.domain;
        let (lowest, highest) = (d.constant(f32::NEG_INFINITY), d.constant(f32::INFINITY));
        [d.select(finite, range.low, lowest), d.select(finite, range.high, highest)]
    }
}

/// What the ops are made of.
impl<D: Domain> Interval<D> {
    /// A new value.
    pub(super) fn range(&mut self, low: D::Real, high: D::Real, facts: Facts) -> Range<D> {
        let identity = self.next;
        self.next += 1;
        Range { low, high, facts, identity, power: None, bounded: Bounded::Alone }
    }

    /// A new value with these bounds; of a point only the low one is computed.
    pub(super) fn bounds(
        &mut self,
        facts: Facts,
        low: impl FnOnce(&mut D) -> D::Real,
        high: impl FnOnce(&mut D) -> D::Real,
    ) -> Range<D> {
        let low = low(&mut self.domain);
        let high = if facts.point { low } else { high(&mut self.domain) };
        self.range(low, high, facts)
    }

    /// What may be anything.
    pub(super) fn anything(&mut self) -> Range<D> {
        let nan = self.domain.constant(f32::NAN);
        self.range(nan, nan, Facts { paired: true, ..Facts::default() })
    }

    /// `value`, or NaN where `by` is not finite.
    pub(super) fn guarded(&mut self, value: D::Real, by: D::Real) -> D::Real {
        let zero = self.domain.constant(0.0);
        self.domain.fma(by, zero, value)
    }

    /// Whether both bounds are finite.
    pub(super) fn finite(&mut self, a: Range<D>) -> D::Mask {
        let d = &mut self.domain;
        let (lowest, highest) = (d.constant(f32::NEG_INFINITY), d.constant(f32::INFINITY));
        let above = d.lt(lowest, a.low);
        let below = d.lt(a.high, highest);
        d.both(above, below)
    }

    /// A mask that `holds` decides.
    pub(super) fn decided(&mut self, holds: D::Mask) -> Certainty<D> {
        Certainty { yes: holds, no: self.domain.not(holds), decided: true }
    }

    /// Bits made of two, if both are known.
    pub(super) fn bits(
        &mut self,
        a: Known<D>,
        b: Known<D>,
        op: impl FnOnce(&mut D, D::Bits, D::Bits) -> D::Bits,
    ) -> Known<D> {
        Known(a.0.zip(b.0).map(|(a, b)| op(&mut self.domain, a, b)))
    }
}

/// A value as a power; one that is none is the first power of itself.
pub(super) fn as_power<D: Domain>(a: Range<D>) -> RangePower<D> {
    a.power.unwrap_or(RangePower { base: a.identity, ends: [a.low, a.high], squarings: 0 })
}

pub(super) fn same<D: Domain>(a: Range<D>, b: Range<D>) -> bool {
    a.identity == b.identity
}

/// The facts of the result of a binary op.
pub(super) fn of_both<D: Domain>(op: Op, a: Range<D>, b: Range<D>) -> Facts {
    Facts::of(op, &[a.facts, b.facts], same(a, b))
}

/// The facts of the result of a unary op.
pub(super) fn of_one<D: Domain>(op: Op, a: Range<D>) -> Facts {
    Facts::of(op, &[a.facts], false)
}
