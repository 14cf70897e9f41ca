//! The operations of formulas: what each does, plainly in f64 and over the ops, and what is known of its value.
//!
//! A rounding error over the ops is that of the ops it is made of, in units in the last place (ULP) of the result: half a unit for arithmetic and
//! roots, those of [`jbt_ir::math`] for `sin`, `cos`, `exp`, `ln` and powers, at most 4 for `atan`, `atan2`, `asin` and `acos` (see `angle`), 3.5 for
//! `tan`; a whole power is a chain of products, `x^n` in at most `2 log2 n` of them.

use jbt_ir::Domain;

use super::operand::Operand;
use crate::angle::atan2;
use crate::falloff::{Falloff, Nearness};
use crate::number::{Binary, Function, Number, Step};

/// What is done with one to any number of operands.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Operation {
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    /// To a power that is no whole literal.
    Power,
    /// To a whole power, which is code.
    Raise(i32),
    /// Any function but `pow` and `square`.
    Call(Function),
}

/// A range that says nothing.
pub(super) const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
/// The largest whole power that is code.
const LARGEST_EXPONENT: f64 = 1024.0;
/// From here on, numbers of f32 count as whole: 2^22.
const WHOLE: f32 = 4_194_304.0;
/// 1.5 * 2^23: adding and subtracting it rounds a number up to 2^22 to a whole one.
const ROUND: f32 = 12_582_912.0;

/// The exponent, if it is a whole literal that is code.
pub(super) fn whole_exponent(number: &Number) -> Option<i32> {
    let n = number.value();
    let whole = !number.follows() && n.fract() == 0.0 && (1.0..=LARGEST_EXPONENT).contains(&n.abs());
    whole.then_some(n as i32)
}

impl Operation {
    /// The falloff that it is.
    pub(super) const fn falloff(self) -> Option<Falloff> {
        if let Self::Call(Function::Falloff(falloff)) = self { Some(falloff.0) } else { None }
    }

    /// The operation of a step that has operands.
    pub(super) fn of(step: &Step) -> Option<Self> {
        Some(match step {
            Step::Literal(_) | Step::Parameter { .. } | Step::Variable(_) => return None,
            Step::Negate => Self::Negate,
            Step::Binary(Binary::Add) => Self::Add,
            Step::Binary(Binary::Subtract) => Self::Subtract,
            Step::Binary(Binary::Multiply) => Self::Multiply,
            Step::Binary(Binary::Divide) => Self::Divide,
            Step::Binary(Binary::Power) | Step::Call(Function::Pow, _) => Self::Power,
            Step::Call(Function::Square, _) => Self::Raise(2),
            Step::Call(function, _) => Self::Call(*function),
        })
    }

    /// The value, plainly.
    pub(crate) fn value(self, x: &[f64]) -> f64 {
        let quotient = |a: f64, b: f64| if b == 0.0 { 0.0 } else { a / b };
        match self {
            Self::Negate => -x[0],
            Self::Add => x[0] + x[1],
            Self::Subtract => x[0] - x[1],
            Self::Multiply => x[0] * x[1],
            Self::Divide => quotient(x[0], x[1]),
            Self::Power if x[0] <= 0.0 && x[1] < 0.0 => 0.0,
            Self::Power => x[0].max(0.0).powf(x[1]),
            Self::Raise(n) if n > 0 => x[0].powi(n),
            Self::Raise(n) => quotient(1.0, x[0].powi(-n)),
            Self::Call(function) => match function {
                Function::Sqrt => x[0].max(0.0).sqrt(),
                Function::Ln => x[0].max(f64::from(f32::MIN_POSITIVE)).ln(),
                Function::Asin | Function::Acos => function.apply(&[x[0].clamp(-1.0, 1.0)]),
                Function::Mod if x[1] == 0.0 => 0.0,
                Function::Sin
                | Function::Cos
                | Function::Tan
                | Function::Atan
                | Function::Atan2
                | Function::Abs
                | Function::Sign
                | Function::Floor
                | Function::Ceil
                | Function::Round
                | Function::Mod
                | Function::Exp
                | Function::Square
                | Function::Min
                | Function::Max
                | Function::Clamp
                | Function::Mix
                | Function::Step
                | Function::Length
                | Function::Pow
                | Function::Falloff(_) => function.apply(x),
            },
        }
    }

    /// How far the operands are from a jump, a kink or a pole.
    pub(super) fn decision(self, x: &[f64]) -> f64 {
        let to_whole = |x: f64| (x - x.round()).abs();
        match self {
            Self::Negate | Self::Add | Self::Subtract | Self::Multiply => f64::INFINITY,
            Self::Divide => x[1].abs(),
            Self::Power => x[0].abs(),
            Self::Raise(n) => {
                if n < 0 {
                    x[0].abs()
                } else {
                    f64::INFINITY
                }
            }
            Self::Call(function) => match function {
                Function::Sin | Function::Cos | Function::Exp | Function::Mix | Function::Square => {
                    f64::INFINITY
                }
                Function::Atan => f64::INFINITY,
                Function::Sqrt => x[0].abs().sqrt(),
                Function::Tan => x[0].cos().abs(),
                Function::Asin | Function::Acos => (1.0 - x[0].abs()).abs(),
                Function::Atan2 if x[1] < 0.0 => x[0].abs(),
                Function::Atan2 => x[0].hypot(x[1]),
                Function::Abs | Function::Sign | Function::Ln | Function::Pow => x[0].abs(),
                Function::Floor | Function::Ceil => to_whole(x[0]),
                Function::Round => to_whole(x[0] + 0.5),
                Function::Mod => {
                    if x[1] == 0.0 {
                        0.0
                    } else {
                        to_whole(x[0] / x[1]) * x[1].abs()
                    }
                }
                Function::Min => lead(x.iter().map(|x| -x)),
                Function::Max => lead(x.iter().copied()),
                Function::Clamp => (x[0] - x[1]).abs().min((x[0] - x[2]).abs()),
                Function::Step => (x[0] - x[1]).abs(),
                Function::Length => function.apply(x),
                Function::Falloff(falloff) => {
                    let tip = if falloff.0.is_pointed() { x[0].abs() } else { f64::INFINITY };
                    (1.0 - x[0]).abs().min(tip)
                }
            },
        }
    }

    /// The sign of the value, rounding included: whether it is never negative, from the signs of the operands.
    pub(crate) fn non_negative(self, operands: &[Operand], x: &[bool]) -> bool {
        let all = x.iter().all(|&sign| sign);
        match self {
            Self::Negate | Self::Subtract => false,
            Self::Multiply => all || operands[0] == operands[1],
            Self::Add | Self::Divide => all,
            Self::Power => true,
            Self::Raise(n) => n % 2 == 0 || all,
            Self::Call(function) => match function {
                Function::Sqrt
                | Function::Abs
                | Function::Exp
                | Function::Acos
                | Function::Length
                | Function::Square
                | Function::Mod
                | Function::Step
                | Function::Pow
                | Function::Falloff(_) => true,
                Function::Sin | Function::Cos | Function::Tan | Function::Ln | Function::Mix => false,
                Function::Asin
                | Function::Atan
                | Function::Sign
                | Function::Floor
                | Function::Ceil
                | Function::Round
                | Function::Min => all,
                Function::Max => x.contains(&true),
                Function::Atan2 => x[0],
                Function::Clamp => (x[0] || x[1]) && x[2],
            },
        }
    }

    /// A range of the value from ranges of the operands: exact where these are points, and rough elsewhere.
    pub(super) fn range(self, x: &[[f64; 2]]) -> [f64; 2] {
        let zero = |range: [f64; 2]| range == [0.0; 2];
        if x.iter().all(|[low, high]| low == high) {
            let points: Vec<f64> = x.iter().map(|[low, _]| *low).collect();
            let value = self.value(&points);
            // Zeros of both signs are one number; a NaN is anything.
            return if value.is_nan() { ANY } else { [value + 0.0; 2] };
        }
        let least = |side: usize| x.iter().map(|range| range[side]).fold(f64::INFINITY, f64::min);
        let greatest = |side: usize| x.iter().map(|range| range[side]).fold(f64::NEG_INFINITY, f64::max);
        match self {
            Self::Multiply if x.iter().any(|&range| zero(range)) => [0.0; 2],
            Self::Divide | Self::Call(Function::Mod) if zero(x[0]) => [0.0; 2],
            Self::Raise(n) if n % 2 == 0 => [0.0, f64::INFINITY],
            Self::Call(Function::Sqrt | Function::Abs | Function::Exp | Function::Length) => {
                [0.0, f64::INFINITY]
            }
            Self::Call(Function::Falloff(_)) => [0.0, 1.0],
            Self::Call(Function::Min) => [least(0), least(1)],
            Self::Call(Function::Max) => [greatest(0), greatest(1)],
            Self::Call(Function::Clamp) => [0, 1].map(|side| x[0][side].max(x[1][side]).min(x[2][side])),
            Self::Negate | Self::Add | Self::Subtract | Self::Multiply | Self::Divide => ANY,
            Self::Power | Self::Raise(_) | Self::Call(_) => ANY,
        }
    }

    /// The value over the ops. `positive` says of each operand whether it is known not to be negative, `number` whether it is a number of the row.
    pub(crate) fn emit<D: Domain>(
        self,
        d: &mut D,
        x: &[D::Real],
        positive: &[bool],
        number: &[bool],
    ) -> D::Real {
        match self {
            Self::Negate => d.neg(x[0]),
            Self::Add => d.add(x[0], x[1]),
            Self::Subtract => d.sub(x[0], x[1]),
            Self::Multiply => d.mul(x[0], x[1]),
            // The check has seen to it that no number that divides is zero.
            Self::Divide if number[1] => d.div(x[0], x[1]),
            Self::Divide => quotient(d, x[0], x[1]),
            Self::Power => power(d, x[0], x[1], positive[0]),
            Self::Raise(n) => {
                let power = whole_power(d, x[0], n.unsigned_abs());
                if n > 0 {
                    return power;
                }
                let one = d.constant(1.0);
                quotient(d, one, power)
            }
            Self::Call(function) => call(d, function, x, positive[0]),
        }
    }
}

/// The difference between the largest and the second largest; infinity if there is no second.
fn lead(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(|a, b| b.total_cmp(a));
    if let [first, second, ..] = all[..] { first - second } else { f64::INFINITY }
}

fn call<D: Domain>(d: &mut D, function: Function, x: &[D::Real], positive: bool) -> D::Real {
    let (zero, one) = (d.constant(0.0), d.constant(1.0));
    match function {
        Function::Sqrt => {
            let x = if positive { x[0] } else { d.max(x[0], zero) };
            d.sqrt(x)
        }
        Function::Sin => d.sin(x[0]),
        Function::Cos => d.cos(x[0]),
        Function::Tan => {
            let (sin, cos) = (d.sin(x[0]), d.cos(x[0]));
            quotient(d, sin, cos)
        }
        Function::Asin => {
            let (sin, cos) = arc_sides(d, x[0]);
            atan2(d, sin, cos)
        }
        Function::Acos => {
            let (cos, sin) = arc_sides(d, x[0]);
            atan2(d, sin, cos)
        }
        Function::Atan => atan2(d, x[0], one),
        Function::Atan2 => atan2(d, x[0], x[1]),
        Function::Abs => d.abs(x[0]),
        Function::Sign => {
            let (above, below) = (d.lt(zero, x[0]), d.lt(x[0], zero));
            let minus = d.constant(-1.0);
            let not_above = d.select(below, minus, zero);
            d.select(above, one, not_above)
        }
        Function::Floor => floor(d, x[0]),
        Function::Ceil => {
            let minus = d.neg(x[0]);
            let floor = floor(d, minus);
            d.neg(floor)
        }
        Function::Round => nearest(d, x[0]),
        Function::Mod => remainder(d, x[0], x[1]),
        Function::Exp => d.exp(x[0]),
        Function::Ln => {
            let least = d.constant(f32::MIN_POSITIVE);
            let x = d.max(x[0], least);
            d.ln(x)
        }
        Function::Min => x[1..].iter().fold(x[0], |least, &x| d.min(least, x)),
        Function::Max => x[1..].iter().fold(x[0], |most, &x| d.max(most, x)),
        Function::Clamp => {
            let above = d.max(x[0], x[1]);
            d.min(above, x[2])
        }
        Function::Mix => {
            let way = d.sub(x[1], x[0]);
            d.fma(way, x[2], x[0])
        }
        Function::Step => {
            let reached = d.le(x[0], x[1]);
            d.select(reached, one, zero)
        }
        Function::Length => {
            let first = d.mul(x[0], x[0]);
            let square = x[1..].iter().fold(first, |sum, &x| d.fma(x, x, sum));
            d.sqrt(square)
        }
        Function::Square => d.mul(x[0], x[0]),
        Function::Pow => power(d, x[0], x[1], positive),
        Function::Falloff(falloff) => {
            let distance = d.max(x[0], zero);
            let minus = d.neg(distance);
            let near = Nearness::emit(d, minus, distance);
            let (kind, mut numbers) = (falloff.0.kind(), Vec::new());
            falloff.0.columns(kind, &mut numbers);
            let row: Vec<D::Real> = numbers.into_iter().map(|number| d.constant(number as f32)).collect();
            kind.emit(d, near, &row)
        }
    }
}

/// `a / b`, and 0 where b is 0.
fn quotient<D: Domain>(d: &mut D, a: D::Real, b: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    let pole = d.eq(b, zero);
    let quotient = d.div(a, b);
    d.select(pole, zero, quotient)
}

/// `max(a, 0)^b`, and 0 where that would be a pole.
fn power<D: Domain>(d: &mut D, a: D::Real, b: D::Real, positive: bool) -> D::Real {
    let zero = d.constant(0.0);
    let base = if positive { a } else { d.max(a, zero) };
    let power = d.pow(base, b);
    let (at_zero, falls) = (d.le(base, zero), d.lt(b, zero));
    let pole = d.both(at_zero, falls);
    d.select(pole, zero, power)
}

/// `x^n` for n of at least 1, by squaring.
fn whole_power<D: Domain>(d: &mut D, x: D::Real, n: u32) -> D::Real {
    // From the second highest bit down.
    (0..n.ilog2()).rev().fold(x, |so_far, bit| {
        let square = d.mul(so_far, so_far);
        if n >> bit & 1 == 1 { d.mul(square, x) } else { square }
    })
}

/// The nearest whole number, which stands still.
fn nearest<D: Domain>(d: &mut D, x: D::Real) -> D::Real {
    let (round, whole) = (d.constant(ROUND), d.constant(WHOLE));
    let shifted = d.add(x, round);
    let rounded = d.sub(shifted, round);
    let magnitude = d.abs(x);
    let small = d.lt(magnitude, whole);
    let nearest = d.select(small, rounded, x);
    d.hold(nearest)
}

fn floor<D: Domain>(d: &mut D, x: D::Real) -> D::Real {
    let nearest = nearest(d, x);
    let one = d.constant(1.0);
    let above = d.lt(x, nearest);
    let before = d.sub(nearest, one);
    let floor = d.select(above, before, nearest);
    d.hold(floor)
}

/// What is left of `x` after whole multiples of `by`.
fn remainder<D: Domain>(d: &mut D, x: D::Real, by: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    let by = d.abs(by);
    let quotient = quotient(d, x, by);
    let whole = floor(d, quotient);
    let minus = d.neg(whole);
    let rest = d.fma(minus, by, x);
    // Rounding of the quotient may have gone one too far.
    let rest = d.max(rest, zero);
    let pole = d.eq(by, zero);
    d.select(pole, zero, rest)
}

/// `x` within [-1, 1], and `sqrt(1 - x^2)`.
fn arc_sides<D: Domain>(d: &mut D, x: D::Real) -> (D::Real, D::Real) {
    let (one, minus) = (d.constant(1.0), d.constant(-1.0));
    let x = d.max(x, minus);
    let x = d.min(x, one);
    let (below, above) = (d.sub(one, x), d.add(one, x));
    let square = d.mul(below, above);
    (x, d.sqrt(square))
}
