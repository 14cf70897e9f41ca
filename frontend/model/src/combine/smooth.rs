//! Smooth set operations: union, intersection and difference that round where two fields differ by less than
//! a width k.
//!
//! ```text
//! union         max(a, b) + D          D = (K - |a - b|)^2 / (4 K) where |a - b| < K, else 0
//! intersection  min(a, b) - D          K = k - max(0, 2 k - (a + b))^2 / (4 k), and 0 where a + b <= 0
//! difference    the intersection of a and max(0, 2 iso - b), where k has been limited by b first, in the way that a + b limits it
//! ```
//!
//! D is the quadratic kernel of smooth distances (Quilez 2013). With K = k alone the union of nothing and
//! nothing were k / 4. The limit of K by the fields, which is reached with its slope, makes D vanish exactly
//! where a side is 0: so supports are those of the operations without `smooth`, zeros are left out by the
//! same rules, and gradients are continuous wherever those of the fields are. Where `a + b >= 2 k`, K is k:
//! with k up to 2/3 iso (4/3 iso for the intersection, 1/3 iso for the difference) that is so at every point
//! of the surface.
//!
//! Both operations grow with either field. Where the fields are small against k they are homogeneous: `max +
//! min^2 / (a + b)`, `a b / (a + b)`. Fields that are negative are not rounded. Weights are `f dF/df`; what
//! is subtracted counts by its complement, where it is there.

use jbt_ir::{Domain, Rule};

use super::extreme::Extreme;
use super::member::{OperatorReach, PairResult, SideGrowth, TakesApart};
use super::set::SetOperation;
use super::set_step::SetFormula;
use crate::skeleton::positive_part;

/// Widths below this count as this where they divide: the squares of quotients, which derivatives are made
/// of, have to be finite.
const SMALLEST: f32 = 1.0 / (1u64 << 50) as f32;
/// What a field may be off by, as a part of the sum of all numbers that it is made of: 64 units in the last
/// place.
const ROUNDING: f32 = 1.0 / (1 << 18) as f32;

/// Names of the numbers that a row keeps.
pub(super) const COLUMNS: &[&str] = &["width", "quarter"];

/// The width at a sum of two fields, and its derivative by the sum.
fn limited(width: f64, sum: f64) -> (f64, f64) {
    let sum = sum.max(0.0);
    let missing = (2.0 * width - sum).max(0.0);
    if width == 0.0 {
        return (0.0, 0.0);
    }
    (sum.min(width - missing * missing / (4.0 * width)), missing / (2.0 * width))
}

/// What rounding adds or takes, and the derivatives of that by the smaller and by the larger field.
fn rounding([a, b]: [f64; 2], width: f64) -> (f64, [f64; 2]) {
    let (limit, slope) = limited(width, a + b);
    let apart = (a - b).abs();
    if apart >= limit {
        return (0.0, [0.0; 2]);
    }
    let q = 1.0 - apart / limit;
    let by_sum = 0.25 * q * (2.0 - q) * slope;
    (0.25 * limit * q * q, [by_sum + 0.5 * q, by_sum - 0.5 * q])
}

/// The operation on two fields, and its derivatives.
fn rounded(is_union: bool, [a, b]: [f64; 2], width: f64) -> (f64, [f64; 2]) {
    let (by, [smaller, larger]) = rounding([a, b], width);
    let (field, smaller, larger) = if is_union {
        (a.max(b) + by, smaller, 1.0 + larger)
    } else {
        (a.min(b) - by, 1.0 - smaller, -larger)
    };
    // Of equals the left one counts as that which wins.
    let left_is_smaller = if is_union { a < b } else { a <= b };
    (field, if left_is_smaller { [smaller, larger] } else { [larger, smaller] })
}

/// How far two fields are from where the rounding begins to be limited by zero, or a tie if they are not
/// rounded.
fn corner(is_union: bool, [a, b]: [f64; 2]) -> f64 {
    let reach = if is_union { a.max(b) } else { a.min(b) };
    if reach <= 0.0 { (a - b).abs().min(reach.abs()) } else { reach }
}

/// A set operation that rounds.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Smooth(pub(super) SetOperation);

impl SetFormula for Smooth {
    const CREASES: bool = false;

    fn push_columns(self, width: f64, row: &mut Vec<f64>) {
        row.extend([width, 0.25 / width]);
    }

    fn pair(self, [a, b]: [f64; 2], width: f64, iso: f64) -> PairResult<f64> {
        let is_union = self.0 == SetOperation::Union;
        match self.0 {
            SetOperation::Union | SetOperation::Intersection => {
                let (field, slopes) = rounded(is_union, [a, b], width);
                PairResult { field, weights: [(a * slopes[0]).max(0.0), (b * slopes[1]).max(0.0)] }
            }
            SetOperation::Difference => {
                let (width, complement) = (limited(width, b).0, (2.0 * iso - b).max(0.0));
                let (field, slopes) = rounded(false, [a, complement], width);
                // What is not there may limit the field, but takes nothing from the attributes.
                let slopes = if b > 0.0 { slopes } else { [1.0, 0.0] };
                PairResult { field, weights: [(a * slopes[0]).max(0.0), (complement * slopes[1]).max(0.0)] }
            }
        }
    }

    fn kink_distance(self, [a, b]: [f64; 2], _width: f64, iso: f64) -> f64 {
        match self.0 {
            SetOperation::Union => corner(true, [a, b]),
            SetOperation::Intersection => corner(false, [a, b]),
            SetOperation::Difference => {
                let cut = 2.0 * iso - b;
                let appears = if b == 0.0 { (a - cut).abs() } else { b.abs() };
                let sharp = if b <= 0.0 { (a - cut).abs() } else { f64::INFINITY };
                cut.abs().min(corner(false, [a, cut])).min(appears).min(sharp)
            }
        }
    }

    fn reach(self) -> OperatorReach {
        match self.0 {
            SetOperation::Union => OperatorReach::Any,
            SetOperation::Intersection => OperatorReach::Both,
            SetOperation::Difference => OperatorReach::Left,
        }
    }

    fn is_non_negative(self, [left, right]: [bool; 2]) -> bool {
        match self.0 {
            SetOperation::Union => left || right,
            SetOperation::Intersection => left && right,
            SetOperation::Difference => left,
        }
    }

    fn rule(self, non_negative: bool) -> Rule {
        match self.0 {
            SetOperation::Union if non_negative => Rule::Neutral,
            SetOperation::Intersection if non_negative => Rule::OnlyZero,
            // One zero limits the others to 0, or to 2 iso, and then the next changes nothing.
            SetOperation::Union | SetOperation::Intersection | SetOperation::Difference => Rule::KeepOne,
        }
    }

    fn growth(self) -> Option<[SideGrowth; 2]> {
        Some(self.0.growth())
    }

    fn rounding<D: Domain>(self, d: &mut D, [a, b]: [D::Real; 2], row: &[D::Real], iso2: D::Real) -> D::Real {
        // Every step is off by a few units in the last place of one of these. Where the limit is below
        // SMALLEST, the quotient is that of another width.
        let (unit, floor) = (d.constant(ROUNDING), d.constant(SMALLEST));
        let fields = d.add(a, b);
        let numbers = d.add(row[0], iso2);
        let size = d.add(fields, numbers);
        d.fma(size, unit, floor)
    }

    fn takes_apart(self) -> Option<TakesApart> {
        match self.0 {
            SetOperation::Union => Some(TakesApart { extreme: Extreme::Largest, complements: false }),
            SetOperation::Intersection => Some(TakesApart { extreme: Extreme::Smallest, complements: false }),
            // Its width is limited once more, which makes it narrower.
            SetOperation::Difference => Some(TakesApart { extreme: Extreme::Smallest, complements: true }),
        }
    }

    fn emit<D: Domain>(
        self,
        d: &mut D,
        [a, b]: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> PairResult<D::Real> {
        let width = Width { width: row[0], quarter: row[1] };
        match self.0 {
            SetOperation::Union => {
                let (field, [left, right]) = emit_rounded(d, true, [a, b], width);
                PairResult { field, weights: [weight(d, a, left), weight(d, b, right)] }
            }
            SetOperation::Intersection => {
                let (field, [left, right]) = emit_rounded(d, false, [a, b], width);
                PairResult { field, weights: [weight(d, a, left), weight(d, b, right)] }
            }
            SetOperation::Difference => {
                let (here, _) = emit_limited(d, width, b);
                let (quarter, floor) = (d.constant(0.25), d.constant(SMALLEST));
                let divisor = d.max(here, floor);
                let width = Width { width: here, quarter: d.div(quarter, divisor) };
                let cut = d.sub(iso2, b);
                let cut = positive_part(d, cut);
                let (field, [left, right]) = emit_rounded(d, false, [a, cut], width);
                let zero = d.constant(0.0);
                let one = d.constant(1.0);
                // What is not there may limit the field, but takes nothing from the attributes.
                let there = d.lt(zero, b);
                let (left, right) = (d.select(there, left, one), d.select(there, right, zero));
                PairResult { field, weights: [weight(d, a, left), weight(d, cut, right)] }
            }
        }
    }
}

/// A width, and a quarter of its inverse.
#[derive(Clone, Copy)]
struct Width<R> {
    width: R,
    quarter: R,
}

fn weight<D: Domain>(d: &mut D, field: D::Real, slope: D::Real) -> D::Real {
    let weight = d.mul(field, slope);
    positive_part(d, weight)
}

/// The width at a sum of two fields, and its derivative by the sum. It is not above the sum, to the bit.
fn emit_limited<D: Domain>(
    d: &mut D,
    Width { width, quarter }: Width<D::Real>,
    sum: D::Real,
) -> (D::Real, D::Real) {
    let sum = positive_part(d, sum);
    let double = d.add(width, width);
    let missing = d.sub(double, sum);
    let missing = positive_part(d, missing);
    let scaled = d.mul(missing, quarter);
    let minus = d.neg(scaled);
    let smooth = d.fma(minus, missing, width);
    let limit = d.min(smooth, sum);
    (positive_part(d, limit), d.add(scaled, scaled))
}

/// As [`rounded`].
fn emit_rounded<D: Domain>(
    d: &mut D,
    is_union: bool,
    [a, b]: [D::Real; 2],
    width: Width<D::Real>,
) -> (D::Real, [D::Real; 2]) {
    let sum = d.add(a, b);
    let (limit, slope) = emit_limited(d, width, sum);
    let (zero, one, half, quarter) = (d.constant(0.0), d.constant(1.0), d.constant(0.5), d.constant(0.25));
    let difference = d.sub(a, b);
    let apart = d.abs(difference);
    let floor = d.constant(SMALLEST);
    let divisor = d.max(limit, floor);
    let part = d.div(apart, divisor);
    let left = d.sub(one, part);
    let q = positive_part(d, left);
    // Where a side is 0, the limit is not above the difference: then nothing is rounded, whatever the
    // quotient.
    let near = d.lt(apart, limit);
    let q = d.select(near, q, zero);
    let square = d.mul(q, q);
    let height = d.mul(quarter, limit);
    let by = d.mul(height, square);
    let extreme = if is_union { d.max(b, a) } else { d.min(b, a) };
    let field = if is_union { d.add(extreme, by) } else { d.sub(extreme, by) };

    let (two, half_q) = (d.constant(2.0), d.mul(half, q));
    let rest = d.sub(two, q);
    let (by_q, by_slope) = (d.mul(half_q, rest), d.mul(half, slope));
    let by_sum = d.mul(by_q, by_slope);
    let (up, down) = (d.add(by_sum, half_q), d.sub(by_sum, half_q));
    let (smaller, larger) = if is_union { (up, d.add(one, down)) } else { (d.sub(one, up), d.neg(down)) };
    let left_is_smaller = if is_union { d.lt(a, b) } else { d.le(a, b) };
    let slopes = [d.select(left_is_smaller, smaller, larger), d.select(left_is_smaller, larger, smaller)];
    (field, slopes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sides on the surface, by bisection of the left one.
    fn on_surface(set: SetOperation, b: f64, width: f64, iso: f64) -> Option<[f64; 2]> {
        let field = |a: f64| Smooth(set).pair([a, b], width, iso).field - iso;
        let (mut low, mut high) = (0.0, 4.0 * iso);
        if field(low) > 0.0 || field(high) < 0.0 {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if field(middle) < 0.0 { low = middle } else { high = middle }
        }
        Some([low, b])
    }

    /// How much the surface is rounded, and how much it were with all of the width.
    fn roundings(set: SetOperation, [a, b]: [f64; 2], width: f64, iso: f64) -> [f64; 2] {
        let field = Smooth(set).pair([a, b], width, iso).field;
        let [b, sharp] = match set {
            SetOperation::Union => [b, a.max(b)],
            SetOperation::Intersection => [b, a.min(b)],
            SetOperation::Difference => [2.0 * iso - b, a.min(2.0 * iso - b)],
        };
        [(field - sharp).abs(), (width - (a - b).abs()).max(0.0).powi(2) / (4.0 * width)]
    }

    /// The most that all of the surface may have, as a part of the iso-value.
    #[test]
    fn narrow_widths_are_not_limited_on_the_surface() {
        let iso = 0.5;
        for (set, most) in [
            (SetOperation::Union, 2.0 / 3.0),
            (SetOperation::Intersection, 4.0 / 3.0),
            (SetOperation::Difference, 1.0 / 3.0),
        ] {
            let is_full = |width: f64| {
                (0..=2000).filter_map(|step| on_surface(set, f64::from(step) * 1e-3, width, iso)).all(
                    |sides| {
                        let [found, full] = roundings(set, sides, width, iso);
                        (found - full).abs() < 1e-9
                    },
                )
            };
            assert!(is_full(0.99 * most * iso), "{set:?}");
            assert!(!is_full(1.2 * most * iso), "{set:?}");
        }
    }

    /// The formulas of the page, at fields where both limits are at work.
    #[test]
    fn a_difference_is_limited_by_what_is_subtracted_and_by_the_sum() {
        let limited =
            |k: f64, s: f64| if s > 0.0 { k - (2.0 * k - s).max(0.0).powi(2) / (4.0 * k) } else { 0.0 };
        let (iso, width) = (0.5, 0.4);
        for (a, b) in [(0.3, 0.5), (0.2, 0.75), (0.1, 0.95), (0.4, 0.6), (0.9, 0.1), (0.5, 0.0)] {
            let other = 2.0 * iso - b;
            let k = limited(limited(width, b), a + other);
            let apart = f64::abs(a - other);
            let by = if apart < k { (k - apart).powi(2) / (4.0 * k) } else { 0.0 };
            let found = Smooth(SetOperation::Difference).pair([a, b], width, iso).field;
            assert!((found - (a.min(other) - by)).abs() < 1e-12, "{a} {b}: {found}");
        }
    }
}
