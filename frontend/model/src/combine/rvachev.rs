//! R-functions (Rvachev 1963, 1982): set operations of functions whose sign is the inside, here without their
//! background.
//!
//! With `x = a / iso - 1` and `y = b / iso - 1` the union is `R(x, y)`, the intersection `-R(-x, -y)`, the
//! difference `-R(-x, y)`, and
//!
//! | family | R(x, y) | numbers |
//! |---|---|---|
//! | alpha | `x + y + sqrt(x^2 + y^2 - 2 alpha x y)`, a positive factor left out | alpha in [-0.9, 1]: 1 is the maximum, 0 is R_0 |
//! | order | `(x + y + s) s^m` with `s = sqrt(x^2 + y^2)`: R_0^m, with m continuous derivatives in the corner | m from 1 to 4 |
//! | power | `x + y + (\|x\|^p + \|y\|^p)^(1/p)`: R_p | p in [1.1, 64]: 2 is R_0 |
//!
//! As it stands, R_p loses what the smaller argument has where the larger one is negative, and the slope
//! along the larger one where p is large: both are differences of nearly equal numbers. With m the larger and
//! r the ratio of the magnitudes, q = r^p and l = ln(1 + q), this is the same:
//!
//! ```text
//! R_p        max(x, y) + max(0, x + y) + m (e^(l/p) - 1)
//! slopes     along the larger one 1 + G where it is positive, 1 - G where it is negative; along the smaller one 1 +- G q / r;  G = e^(-l (p-1)/p)
//! ```
//!
//! l is a series of the area tangent, `l = 2 artanh(q / (2 + q))`, and `e^w - 1` one of w, so nothing
//! cancels.
//!
//! As they are, R-functions have no support: R_0 of two fields that are 0 is 0.2 for iso 1/2, and not 0. So
//! with B, their value where both fields are 0, the field is
//!
//! ```text
//! F = max(0, iso (1 - R / B))        0 where all fields are 0, iso where R is 0, and so that the surface
//! stays
//! ```
//!
//! R and B come from the same ops, so 0 is exact. A lone field is changed too (0.3 becomes 0.22 by R_0's
//! union for iso 1/2), so no zero may be left out of a fold, and the intersection is not 0 where one field
//! alone is (0.29 where the other one is 1, for iso 1/2): all have the hull of the children as support.
//!
//! Alpha below -0.9, where B goes to 0, and p near 1 leave too few digits in f32. Gradients are continuous
//! but for the corner `x = y = 0` (and the tie of alpha = 1); there the root has the tangent 0. R_0^m is not
//! monotone. Weights are `f dF/df`, those of what is subtracted by its complement, where it is there.

use jbt_ir::{Domain, Rule};

use super::member::{OperatorReach, PairResult, SideGrowth};
use super::ricci::FLOOR;
use super::set::SetOperation;
use super::set_step::SetFormula;
use crate::skeleton::positive_part;

/// What R may be off by, as a part of its arguments' sizes. Powers lose the most: the last digits of a ratio
/// count p times in them.
const ROUNDING: f32 = 1.0 / (1 << 16) as f32;

/// A family of R-functions, with what of it selects code.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Family {
    /// R_alpha.
    Alpha,
    /// R_0^m.
    Order(u32),
    /// R_p.
    Power,
}

/// A set operation by a family.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Rvachev(pub(super) SetOperation, pub(super) Family);

/// R, and its derivatives up to a common factor.
#[derive(Clone, Copy)]
struct RValue<R> {
    value: R,
    slopes: [R; 2],
    /// The root: 0 where gradients are not continuous.
    root: R,
}

impl Rvachev {
    fn rvachev(self, [x, y]: [f64; 2], number: f64) -> RValue<f64> {
        let over = |x: f64, root: f64| if root == 0.0 { 0.0 } else { x / root };
        match self.1 {
            Family::Alpha => {
                let root = ((x - number * y).powi(2) + (1.0 - number * number) * y * y).sqrt();
                let slopes = [1.0 + over(x - number * y, root), 1.0 + over(y - number * x, root)];
                RValue { value: x + y + root, slopes, root }
            }
            Family::Order(order) => {
                let root = x.hypot(y);
                let lean = f64::from(order) * over(x + y + root, root);
                let slope = |x: f64| 1.0 + over(x, root) * (1.0 + lean);
                RValue { value: (x + y + root) * root.powi(order as i32), slopes: [slope(x), slope(y)], root }
            }
            Family::Power => {
                let (larger, smaller) = (x.abs().max(y.abs()), x.abs().min(y.abs()));
                let ratio = over(smaller, larger);
                let log = ratio.powf(number).ln_1p();
                let beyond = larger * (log / number).exp_m1();
                // What the power mean falls behind the larger one's own slope.
                let lost = -(-log * (1.0 - 1.0 / number)).exp_m1();
                let lean = if larger == 0.0 { 0.0 } else { 1.0 - lost };
                let slope = |x: f64, is_larger: bool| match (is_larger, x < 0.0) {
                    (true, true) => lost,
                    (true, false) => 1.0 + lean,
                    (false, _) => 1.0 + (lean * ratio.powf(number - 1.0)).copysign(x),
                };
                let x_larger = x.abs() >= y.abs();
                RValue {
                    value: x.max(y) + (x + y).max(0.0) + beyond,
                    slopes: [slope(x, x_larger), slope(y, !x_larger)],
                    root: larger + beyond,
                }
            }
        }
    }

    /// The arguments of R, from fields in units of the iso-value.
    fn arguments(self, [a, b]: [f64; 2]) -> [f64; 2] {
        match self.0 {
            SetOperation::Union => [a - 1.0, b - 1.0],
            SetOperation::Intersection => [1.0 - a, 1.0 - b],
            SetOperation::Difference => [1.0 - a, b - 1.0],
        }
    }

    /// `1 - R / B`, and R.
    fn relative(self, [a, b]: [f64; 2], number: f64, iso: f64) -> (f64, RValue<f64>) {
        let here = self.rvachev(self.arguments([a / iso, b / iso]), number);
        let background = self.rvachev(self.arguments([0.0, 0.0]), number);
        (1.0 - here.value / background.value, here)
    }
}

impl SetFormula for Rvachev {
    fn push_columns(self, number: f64, row: &mut Vec<f64>) {
        match self.1 {
            Family::Alpha => row.extend([number, 1.0 - number * number]),
            Family::Order(_) => {}
            Family::Power => row.extend([number, 1.0 / number, 1.0 - 1.0 / number]),
        }
    }

    fn pair(self, [a, b]: [f64; 2], number: f64, iso: f64) -> PairResult<f64> {
        let (relative, here) = self.relative([a, b], number, iso);
        let right = match self.0 {
            SetOperation::Union | SetOperation::Intersection => b,
            SetOperation::Difference if b > 0.0 => 2.0 * iso - b,
            SetOperation::Difference => 0.0,
        };
        let weights = [a.max(0.0) * here.slopes[0].max(0.0), right.max(0.0) * here.slopes[1].max(0.0)];
        PairResult { field: iso * relative.max(0.0), weights }
    }

    fn kink_distance(self, [a, b]: [f64; 2], number: f64, iso: f64) -> f64 {
        let (relative, here) = self.relative([a, b], number, iso);
        let appears = match self.0 {
            SetOperation::Difference if b != 0.0 => b.abs(),
            SetOperation::Union | SetOperation::Intersection | SetOperation::Difference => f64::INFINITY,
        };
        iso * here.root.min(relative.abs()).min(appears / iso)
    }

    fn reach(self) -> OperatorReach {
        OperatorReach::Any
    }

    fn is_non_negative(self, _: [bool; 2]) -> bool {
        true
    }

    fn rule(self, _: bool) -> Rule {
        Rule::Never
    }

    fn growth(self) -> Option<[SideGrowth; 2]> {
        match self.1 {
            // Slopes of R are 1 and something within 1.
            Family::Alpha | Family::Power => Some(self.0.growth()),
            Family::Order(_) => None,
        }
    }

    fn rounding<D: Domain>(self, d: &mut D, [a, b]: [D::Real; 2], row: &[D::Real], iso2: D::Real) -> D::Real {
        let (zero, one, two, unit) =
            (d.constant(0.0), d.constant(1.0), d.constant(2.0), d.constant(ROUNDING));
        // Sizes of the arguments in units of the iso-value, and what a quotient by the background makes of
        // an error.
        let inverse = d.div(two, iso2);
        let sizes = d.add(a, b);
        let sizes = d.fma(sizes, inverse, two);
        let nothing = self.emit_arguments(d, [zero, zero]);
        let background = self.emit_rvachev(d, nothing, row);
        let background = d.abs(background.value);
        let by = d.div(one, background);
        let steep = d.fma(by, by, by);
        let off = d.mul(unit, iso2);
        let off = d.mul(off, sizes);
        d.mul(off, steep)
    }

    fn emit<D: Domain>(
        self,
        d: &mut D,
        [a, b]: [D::Real; 2],
        row: &[D::Real],
        iso2: D::Real,
    ) -> PairResult<D::Real> {
        let (zero, one, half, two) = (d.constant(0.0), d.constant(1.0), d.constant(0.5), d.constant(2.0));
        let (iso, inverse) = (d.mul(iso2, half), d.div(two, iso2));
        let in_units = [d.mul(a, inverse), d.mul(b, inverse)];
        let arguments = self.emit_arguments(d, in_units);
        let nothing = self.emit_arguments(d, [zero, zero]);
        let here = self.emit_rvachev(d, arguments, row);
        let background = self.emit_rvachev(d, nothing, row);
        let ratio = d.div(here.value, background.value);
        let relative = d.sub(one, ratio);
        let relative = positive_part(d, relative);
        let field = d.mul(iso, relative);
        // The sides meet in an edge. Which of them is there is noted by a selection that changes nothing.
        let left_is_larger = d.lt(b, a);
        let field = d.select(left_is_larger, field, field);
        let right = match self.0 {
            SetOperation::Union | SetOperation::Intersection => b,
            SetOperation::Difference => {
                let (there, complement) = (d.lt(zero, b), d.sub(iso2, b));
                d.select(there, complement, zero)
            }
        };
        let mut weight = |field: D::Real, slope: D::Real| {
            let (field, slope) = (positive_part(d, field), positive_part(d, slope));
            d.mul(field, slope)
        };
        PairResult { field, weights: [weight(a, here.slopes[0]), weight(right, here.slopes[1])] }
    }
}

/// Over the ops.
impl Rvachev {
    fn emit_arguments<D: Domain>(self, d: &mut D, [a, b]: [D::Real; 2]) -> [D::Real; 2] {
        let one = d.constant(1.0);
        match self.0 {
            SetOperation::Union => [d.sub(a, one), d.sub(b, one)],
            SetOperation::Intersection => [d.sub(one, a), d.sub(one, b)],
            SetOperation::Difference => [d.sub(one, a), d.sub(b, one)],
        }
    }

    fn emit_rvachev<D: Domain>(self, d: &mut D, [x, y]: [D::Real; 2], row: &[D::Real]) -> RValue<D::Real> {
        let sum = d.add(x, y);
        match self.1 {
            Family::Alpha => {
                let minus = d.neg(row[0]);
                let (along_x, along_y) = (d.fma(minus, y, x), d.fma(minus, x, y));
                // Of two terms that are not negative, so that their sum is not.
                let (square, y_square) = (d.mul(along_x, along_x), d.mul(y, y));
                let square = d.fma(row[1], y_square, square);
                let root = d.sqrt(square);
                let slopes = [along_x, along_y].map(|along| slope(d, along, root));
                RValue { value: d.add(sum, root), slopes, root }
            }
            Family::Order(order) => {
                let square = d.mul(x, x);
                let square = d.fma(y, y, square);
                let root = d.sqrt(square);
                let mut value = d.add(sum, root);
                let (one, m) = (d.constant(1.0), d.constant(order as f32));
                let lean = over(d, value, root);
                let lean = d.fma(m, lean, one);
                let slopes = [x, y].map(|x| {
                    let lean_x = over(d, x, root);
                    d.fma(lean_x, lean, one)
                });
                for _ in 0..order {
                    value = d.mul(value, root);
                }
                RValue { value, slopes, root }
            }
            Family::Power => emit_power(d, [x, y], row),
        }
    }
}

/// R_p: see the module.
fn emit_power<D: Domain>(d: &mut D, [x, y]: [D::Real; 2], row: &[D::Real]) -> RValue<D::Real> {
    let [power, inverse, rest] = row[..] else { unreachable!("a power has three columns") };
    let (zero, one) = (d.constant(0.0), d.constant(1.0));
    let sum = d.add(x, y);
    let (highest, ahead) = (d.max(x, y), positive_part(d, sum));
    // The larger one by magnitude is the higher one where the sum is positive. At ties the same one has to
    // count as higher and as larger in all places, or else the gradient is that of no side.
    let (x_is_higher, is_ahead) = (d.lt(y, x), d.lt(zero, sum));
    let (both, either) = (d.both(x_is_higher, is_ahead), d.either(x_is_higher, is_ahead));
    let neither = d.not(either);
    let x_is_larger = d.either(both, neither);
    let (x_size, y_size) = (d.abs(x), d.abs(y));
    let (larger, smaller) = (d.select(x_is_larger, x_size, y_size), d.select(x_is_larger, y_size, x_size));
    // Ranges do not know that the smaller one is not above the larger one.
    let ratio = over(d, smaller, larger);
    let ratio = d.min(one, ratio);

    let part = d.pow(ratio, power);
    let log = emit_log_of_one_and(d, part);
    let exponent = d.mul(log, inverse);
    let beyond = series(d, exponent, &EXPONENTIAL);
    let beyond = d.mul(exponent, beyond);
    let start = d.add(highest, ahead);
    let value = d.fma(larger, beyond, start);
    let root = d.fma(larger, beyond, larger);

    let fall = d.mul(log, rest);
    let lost = series(d, fall, &FALL);
    let lost = d.mul(fall, lost);
    let (lean, there) = (d.sub(one, lost), d.lt(zero, larger));
    let lean = d.select(there, lean, zero);
    let of_smaller = over(d, part, ratio);
    let of_smaller = d.mul(of_smaller, lean);
    let (up, y_is_larger) = (d.add(one, lean), d.not(x_is_larger));
    let mut slope = |x: D::Real, is_larger: D::Mask| {
        let (negative, minus) = (d.lt(x, zero), d.neg(of_smaller));
        let lean = d.select(negative, minus, of_smaller);
        let (large, small) = (d.select(negative, lost, up), d.add(one, lean));
        d.select(is_larger, large, small)
    };
    let slopes = [slope(x, x_is_larger), slope(y, y_is_larger)];
    RValue { value, slopes, root }
}

/// `artanh(t) / t` in t^2, for t up to 1/3: what is left out is below 2^-29.
const AREA_TANGENT: [f32; 8] =
    [1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0];
/// `(e^w - 1) / w` in w, for w up to ln 2: what is left out is below 2^-30.
const EXPONENTIAL: [f32; 10] = [
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
];
/// `(1 - e^-w) / w` in w, likewise.
const FALL: [f32; 10] = {
    let mut fall = EXPONENTIAL;
    let mut place = 1;
    while place < fall.len() {
        fall[place] = -fall[place];
        place += 2;
    }
    fall
};

/// `ln(1 + q)` for q in [0, 1], to the last digits also where q is small.
fn emit_log_of_one_and<D: Domain>(d: &mut D, q: D::Real) -> D::Real {
    let two = d.constant(2.0);
    let below = d.add(two, q);
    let tangent = d.div(q, below);
    let square = d.mul(tangent, tangent);
    let ratio = series(d, square, &AREA_TANGENT);
    let twice = d.add(tangent, tangent);
    d.mul(twice, ratio)
}

/// `c[0] + x (c[1] + x (c[2] + ..))`.
fn series<D: Domain>(d: &mut D, x: D::Real, coefficients: &[f32]) -> D::Real {
    let (&last, rest) = coefficients.split_last().expect("a series has a first term");
    let last = d.constant(last);
    rest.iter().rev().fold(last, |sum, &coefficient| {
        let coefficient = d.constant(coefficient);
        d.fma(sum, x, coefficient)
    })
}

/// `x / root`, and 0 where both are: a root is 0, or far above the floor.
fn over<D: Domain>(d: &mut D, x: D::Real, root: D::Real) -> D::Real {
    let floor = d.constant(FLOOR);
    let divisor = d.max(root, floor);
    d.div(x, divisor)
}

fn slope<D: Domain>(d: &mut D, along: D::Real, root: D::Real) -> D::Real {
    let (one, part) = (d.constant(1.0), over(d, along, root));
    d.add(one, part)
}

#[cfg(test)]
mod tests {
    use jbt_ir::domain::scalar::Scalar;

    use super::*;

    const POWERS: [f64; 6] = [1.1, 1.5, 2.0, 3.5, 16.0, 64.0];

    fn power(set: SetOperation) -> Rvachev {
        Rvachev(set, Family::Power)
    }

    fn row(number: f64) -> Vec<f32> {
        let mut row = Vec::new();
        power(SetOperation::Union).push_columns(number, &mut row);
        row.into_iter().map(|x| x as f32).collect()
    }

    /// The numbers that the columns stand for, rounded once.
    fn rounded(number: f64) -> f64 {
        f64::from(number as f32)
    }

    #[test]
    fn a_power_keeps_its_digits_however_unequal_its_arguments_are() {
        let mut rng = fastrand::Rng::with_seed(3);
        let (mut worst, mut worst_slope) = (0.0f64, 0.0f64);
        for _ in 0..100_000 {
            let number = POWERS[rng.usize(..POWERS.len())];
            let mut argument = || {
                let size = 10f32.powf(12.0 * rng.f32() - 6.0);
                if rng.bool() { size } else { -size }
            };
            let (x, y) = (argument(), argument());
            let y = if rng.u8(..3) == 0 { x * (1.0 - 0.3 * rng.f32()) } else { y };
            let plain = power(SetOperation::Union).rvachev([x.into(), y.into()], rounded(number));
            let found = emit_power(&mut Scalar, [x, y], &row(number));
            let error = |found: f32, plain: f64| (f64::from(found) - plain).abs() / plain.abs().max(1e-30);
            worst = worst.max(error(found.value, plain.value));
            for axis in 0..2 {
                // Slopes that are far below all shares of attributes.
                let off = (f64::from(found.slopes[axis]) - plain.slopes[axis]).abs();
                worst_slope = worst_slope.max(off / plain.slopes[axis].abs().max(1e-12));
            }
        }
        // The last digits of a ratio count p times in its power.
        assert!(worst < 4e-6 && worst_slope < 4e-5, "{worst:e} {worst_slope:e}");
    }

    /// As it is written in the literature, the slope along the larger one is 1 - 1 here.
    #[test]
    fn a_power_of_64_loses_no_share() {
        for (x, y) in [(-1.0f32, -0.6), (-1.0, -0.75), (-1.0, -0.9)] {
            let found = emit_power(&mut Scalar, [x, y], &row(64.0));
            let ratio = f64::from(y / x);
            let log = ratio.powf(64.0).ln_1p();
            let exact = -(-log * 63.0 / 64.0).exp_m1();
            let error = (f64::from(found.slopes[0]) - exact).abs() / exact;
            assert!(error < 1e-5, "{x} {y}: {:e} instead of {exact:e}", found.slopes[0]);
        }
    }

    #[test]
    fn a_large_field_leaves_the_other_its_digits() {
        for number in POWERS {
            let of = |a, b| {
                let step = power(SetOperation::Intersection);
                step.emit(&mut Scalar, [a, b], &row(number), 1.0).field
            };
            for b in [0.25f32, 0.5, 0.75] {
                let plain =
                    power(SetOperation::Intersection).pair([1e6, f64::from(b)], rounded(number), 0.5).field;
                assert!(
                    (f64::from(of(1e6, b)) - plain).abs() < 1e-6,
                    "power {number}: {} instead of {plain}",
                    of(1e6, b)
                );
            }
        }
    }
}
