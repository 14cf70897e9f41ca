//! The operations of formulas: their value in f64 and over the ops, and facts about the value.
//!
//! The rounding error over the ops, in units in the last place (ULP) of the result, is half a unit for
//! arithmetic and roots, the error of [`jbt_ir::math`] for `sin`, `cos`, `exp`, `ln` and powers, at most 4
//! for `atan`, `atan2`, `asin` and `acos` (see `angle`), 3.5 for `tan`. A whole power `x^n` is a chain of at
//! most `2 log2 n` products.

use jbt_ir::Domain;

use super::operand::Operand;
use crate::falloff::Falloff;
use crate::function::{ANY, Function, power, quotient};
use crate::number::{Binary, Number, Step};

/// An operation on one to any number of operands.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Operation {
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    /// A power whose exponent is no whole literal.
    Power,
    /// A power with a whole literal as exponent: the exponent is code.
    Raise(i32),
    /// Any function but `pow` and `square`.
    Call(Function),
}

/// The largest whole power that is code.
const LARGEST_EXPONENT: f64 = 1024.0;

/// The exponent, if it is a whole literal that is code.
pub(super) fn whole_exponent(number: &Number) -> Option<i32> {
    let n = number.value();
    let whole =
        !number.depends_on_parameters() && n.fract() == 0.0 && (1.0..=LARGEST_EXPONENT).contains(&n.abs());
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

    /// The value, in f64.
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
            Self::Call(function) => function.total(x),
        }
    }

    /// The distance of the operands from the nearest jump, kink or pole.
    pub(super) fn kink_distance(self, x: &[f64]) -> f64 {
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
            Self::Call(function) => function.kink_distance(x),
        }
    }

    /// Whether the value, with rounding, is never negative, derived from the same facts about the operands.
    pub(crate) fn non_negative(self, operands: &[Operand], x: &[bool]) -> bool {
        let all = x.iter().all(|&sign| sign);
        match self {
            Self::Negate | Self::Subtract => false,
            Self::Multiply => all || operands[0] == operands[1],
            Self::Add | Self::Divide => all,
            Self::Power => true,
            Self::Raise(n) => n % 2 == 0 || all,
            Self::Call(function) => function.non_negative(x),
        }
    }

    /// A range of the value from ranges of the operands: exact where these are points, and rough elsewhere.
    pub(super) fn range(self, x: &[[f64; 2]]) -> [f64; 2] {
        let zero = |range: [f64; 2]| range == [0.0; 2];
        if x.iter().all(|[low, high]| low == high) {
            let points: Vec<f64> = x.iter().map(|[low, _]| *low).collect();
            let value = self.value(&points);
            // Zeros of both signs are one number; NaN gives the range of all numbers.
            return if value.is_nan() { ANY } else { [value + 0.0; 2] };
        }
        match self {
            Self::Multiply if x.iter().any(|&range| zero(range)) => [0.0; 2],
            Self::Divide if zero(x[0]) => [0.0; 2],
            Self::Raise(n) if n % 2 == 0 => [0.0, f64::INFINITY],
            Self::Call(function) => function.range(x),
            Self::Negate | Self::Add | Self::Subtract | Self::Multiply | Self::Divide => ANY,
            Self::Power | Self::Raise(_) => ANY,
        }
    }

    /// The value over the ops. For each operand, `positive` says whether it is known not to be negative,
    /// `number` whether it is a number of the row.
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
            // The check has excluded a zero among numbers that divide.
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
            Self::Call(function) => function.emit(d, x, positive[0]),
        }
    }
}

/// `x^n` for n of at least 1, by squaring.
fn whole_power<D: Domain>(d: &mut D, x: D::Real, n: u32) -> D::Real {
    // From the second highest bit down.
    (0..n.ilog2()).rev().fold(x, |so_far, bit| {
        let square = d.mul(so_far, so_far);
        if n >> bit & 1 == 1 { d.mul(square, x) } else { square }
    })
}
