//! Comparisons of ranges, and choices between them.
//!
//! `max(a, b)` is b where either is NaN. So where a may be NaN, the result may be b alone, and the low bound
//! is the low bound of b. Where b may be NaN, the result may be NaN, and a bound has to show it. `min` is the
//! mirror image.
//!
//! ```text
//! max(x, k - x) >= k / 2 >= min(x, k - x)         and so of extremes of these and of others
//! ```
//!
//! In f32 too: if x is below k/2, `k - x` is above, and rounding is monotone. If x may be NaN nothing is
//! known.

use crate::facts::Fact as _;
use crate::op::{Domain, Op};

use super::facts::{Facts, Sign};
use super::value::{
    Bounded, Bounding, Certainty, Interval, MOST_BOUNDING, Range, RangeComplement, Side, of_both, same,
};

impl Side {
    fn of<D: Domain>(self, d: &mut D, a: D::Real, b: D::Real) -> D::Real {
        match self {
            Self::Lowest => d.min(a, b),
            Self::Highest => d.max(a, b),
        }
    }

    /// The bound that lies away from this side, and the one towards it.
    const fn inner_and_outer<D: Domain>(self, a: Range<D>) -> (D::Real, D::Real) {
        match self {
            Self::Lowest => (a.high, a.low),
            Self::Highest => (a.low, a.high),
        }
    }

    /// The sign beyond zero on this side.
    const fn beyond(self) -> Sign {
        match self {
            Self::Lowest => Sign::NonPositive,
            Self::Highest => Sign::NonNegative,
        }
    }

    const fn op(self) -> Op {
        match self {
            Self::Lowest => Op::Min,
            Self::Highest => Op::Max,
        }
    }
}

/// What a value counts as where the extreme on a side is taken.
fn bounding<D: Domain>(side: Side, a: Range<D>) -> [Option<Bounding<D>>; MOST_BOUNDING] {
    let mut all = [None; MOST_BOUNDING];
    match a.bounded {
        Bounded::Extreme(other, several) if other == side => return several,
        Bounded::Extreme(..) | Bounded::Alone => {
            all[0] = Some(Bounding { identity: a.identity, complement: None });
        }
        Bounded::Complement(complement) => {
            all[0] = Some(Bounding { identity: a.identity, complement: Some(complement) });
        }
    }
    all
}

impl<D: Domain> Interval<D> {
    /// Half of k, if `k - x` and x are among two lists; NaN where x may be NaN.
    fn half(&mut self, lists: [[Option<Bounding<D>>; MOST_BOUNDING]; 2]) -> Option<D::Real> {
        let all = || lists.into_iter().flatten().flatten();
        let complement =
            all().filter_map(|it| it.complement).find(|it| all().any(|x| x.identity == it.base))?;
        let half = self.domain.constant(0.5);
        let half = self.domain.mul(complement.whole, half);
        let half = self.guarded(half, complement.ends[0]);
        Some(self.guarded(half, complement.ends[1]))
    }

    /// The range of `a - b`, which is a complement if `a` is a point.
    pub(super) fn complement(&mut self, a: Range<D>, b: Range<D>, difference: Range<D>) -> Range<D> {
        if !a.facts.point || b.facts.point {
            return difference;
        }
        let complement = RangeComplement { base: b.identity, ends: [b.low, b.high], whole: a.low };
        Range { bounded: Bounded::Complement(complement), ..difference }
    }

    /// The low end as a point.
    pub(super) fn lowest(&mut self, a: Range<D>) -> Range<D> {
        let low = self.finite_low(a);
        self.range(low, low, Facts::of(Op::LowEnd, &[a.facts], false))
    }

    /// `min` or `max`, with what is known of complements.
    pub(super) fn extreme(&mut self, side: Side, a: Range<D>, b: Range<D>) -> Range<D> {
        let extreme = self.extreme_of(side, a, b);
        if extreme.facts.point {
            return extreme;
        }
        let lists = [bounding(side, a), bounding(side, b)];
        let mut several = [None; MOST_BOUNDING];
        // The last ones: what is met next is likely to be about them.
        let all = lists.into_iter().flatten().flatten().collect::<Vec<_>>();
        let last = &all[all.len().saturating_sub(MOST_BOUNDING)..];
        several.iter_mut().zip(last).for_each(|(place, &it)| *place = Some(it));
        let extreme = Range { bounded: Bounded::Extreme(side, several), ..extreme };
        let Some(half) = self.half(lists) else { return extreme };
        match side {
            Side::Lowest => Range { high: self.domain.min(half, extreme.high), ..extreme },
            Side::Highest => Range { low: self.domain.max(half, extreme.low), ..extreme },
        }
    }

    /// `min` or `max`. The inner bound is limited by both operands, the outer one reaches as far as either.
    fn extreme_of(&mut self, side: Side, a: Range<D>, b: Range<D>) -> Range<D> {
        let facts = of_both(side.op(), a, b);
        let (a_inner, a_outer) = side.inner_and_outer(a);
        let (b_inner, b_outer) = side.inner_and_outer(b);
        if facts.point {
            let value = side.of(&mut self.domain, a.low, b.low);
            return self.range(value, value, facts);
        }
        // NaN where a may be NaN: then only b counts.
        let limit = if a.facts.point { a_inner } else { self.guarded(a_inner, a_outer) };
        let mut inner = side.of(&mut self.domain, limit, b_inner);
        let outer = if b.facts.point {
            side.of(&mut self.domain, b_outer, a_outer)
        } else {
            // The op gives its second operand where either operand is NaN, so both bounds of b are guarded.
            let reach = self.guarded(b_outer, b_inner);
            if a.facts.point {
                side.of(&mut self.domain, a_outer, reach)
            } else {
                let both = side.of(&mut self.domain, reach, a_outer);
                self.guarded(both, reach)
            }
        };
        if facts.sign == side.beyond().opposite() {
            // By the sign's fact, a NaN of the outer bound, which is nearer to 0, has to show in the other
            // bound.
            inner = self.guarded(inner, outer);
        }
        match side {
            Side::Lowest => self.range(outer, inner, facts),
            Side::Highest => self.range(inner, outer, facts),
        }
    }

    /// The bound of `a` that a comparison is certain of: NaN where the value may be NaN.
    fn sure_low(&mut self, a: Range<D>) -> D::Real {
        if a.facts.point { a.low } else { self.guarded(a.low, a.high) }
    }

    fn sure_high(&mut self, a: Range<D>) -> D::Real {
        if a.facts.point { a.high } else { self.guarded(a.high, a.low) }
    }

    /// As [`sure_low`](Self::sure_low), and NaN where the bound is infinite: infinities must not compare as
    /// equal where one value may be NaN.
    fn finite_low(&mut self, a: Range<D>) -> D::Real {
        let low = self.sure_low(a);
        if a.facts.point { low } else { self.guarded(low, low) }
    }

    fn finite_high(&mut self, a: Range<D>) -> D::Real {
        let high = self.sure_high(a);
        if a.facts.point { high } else { self.guarded(high, high) }
    }

    pub(super) fn less(&mut self, a: Range<D>, b: Range<D>) -> Certainty<D> {
        if a.facts.point && b.facts.point {
            let holds = self.domain.lt(a.low, b.low);
            return self.decided(holds);
        }
        let (high, low) = (self.sure_high(a), self.sure_low(b));
        let yes = self.domain.lt(high, low);
        // A comparison with a NaN does not hold, so this is certain even where a value is NaN.
        let no = self.domain.le(b.high, a.low);
        Certainty { yes, no, decided: false }
    }

    pub(super) fn less_or_equal(&mut self, a: Range<D>, b: Range<D>) -> Certainty<D> {
        if a.facts.point && b.facts.point {
            let holds = self.domain.le(a.low, b.low);
            return self.decided(holds);
        }
        let (high, low) = (self.finite_high(a), self.finite_low(b));
        let yes = self.domain.le(high, low);
        let no = self.domain.lt(b.high, a.low);
        Certainty { yes, no, decided: false }
    }

    pub(super) fn equal(&mut self, a: Range<D>, b: Range<D>) -> Certainty<D> {
        if a.facts.point && b.facts.point {
            let holds = self.domain.eq(a.low, b.low);
            return self.decided(holds);
        }
        let (a_high, b_high) = (self.finite_high(a), self.finite_high(b));
        let d = &mut self.domain;
        let not_above = d.le(a_high, b.low);
        let not_below = d.le(b_high, a.low);
        let yes = d.both(not_above, not_below);
        let below = d.lt(a.high, b.low);
        let above = d.lt(b.high, a.low);
        Certainty { yes, no: d.either(below, above), decided: false }
    }

    /// One of two ranges, or a range that encloses both.
    pub(super) fn choice(&mut self, condition: Certainty<D>, a: Range<D>, b: Range<D>) -> Range<D> {
        if same(a, b) {
            return a;
        }
        let mask = Facts { point: condition.decided, ..Facts::default() };
        let facts = Facts::of(Op::Select, &[mask, a.facts, b.facts], false);
        if condition.decided {
            let yes = condition.yes;
            return self.bounds(facts, |d| d.select(yes, a.low, b.low), |d| d.select(yes, a.high, b.high));
        }
        let low = self.either_bound(Side::Lowest, condition, a.low, b.low);
        let high = self.either_bound(Side::Highest, condition, a.high, b.high);
        self.range(low, high, facts)
    }

    /// The bound of a choice: of a, of b, or of the one that is further out.
    fn either_bound(&mut self, side: Side, condition: Certainty<D>, a: D::Real, b: D::Real) -> D::Real {
        let first = self.domain.select(condition.no, b, a);
        let second = self.domain.select(condition.yes, a, b);
        let bound = side.of(&mut self.domain, first, second);
        // A NaN in `second` reaches the bound by itself.
        self.guarded(bound, first)
    }
}
