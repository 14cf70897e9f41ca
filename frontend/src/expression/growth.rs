//! How large the values of a formula may become, and how fast they change, where coordinates are bounded: what excludes overflow.
//!
//! A bound of derivatives counts every factor of the chain rule as at least 1, so that no product of some of them is larger, in whatever order the
//! program multiplies. Operations that have poles, or slopes without bounds, are bounded by nothing.

use super::form::Form;
use super::operand::Operand;
use super::operation::Operation;
use crate::number::Function;

/// Bounds of a value and of the sum of its derivatives along the coordinates, in magnitude, as the program computes them in f32.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Growth {
    pub(crate) value: f64,
    pub(crate) slope: f64,
}

/// Beyond this nothing is promised: 2^60.
const LARGEST: f64 = (1u64 << 60) as f64;
/// More than an operation takes in rounding, relative to its result.
const ROUNDING: f64 = 1.0 + 1.0 / (1 << 20) as f64;
/// Where powers of e are bounded.
const LARGEST_EXPONENT: f64 = 40.0;

impl Growth {
    const UNKNOWN: Self = Self { value: f64::INFINITY, slope: f64::INFINITY };

    const fn still(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }

    fn times(self, other: Self) -> Self {
        let slope = self.slope * other.value.max(1.0) + other.slope * self.value.max(1.0);
        Self { value: self.value * other.value, slope }
    }

    fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }

    fn within_limits(self) -> Self {
        let grown = Self { value: self.value * ROUNDING, slope: self.slope * ROUNDING };
        // Written so that a NaN is no bound either.
        if grown.value <= LARGEST && grown.slope <= LARGEST { grown } else { Self::UNKNOWN }
    }
}

impl Form {
    /// Bounds of its values, which ask for no children, at coordinates up to `largest` in magnitude.
    pub(crate) fn growth(&self, numbers: &[f64], largest: f64) -> Vec<Growth> {
        let leaf = |operand| match operand {
            Operand::Coordinate(_) => Growth { value: largest, slope: 1.0 },
            Operand::Number(number) => Growth::still(numbers[number as usize].abs()),
            Operand::Child(_) | Operand::Step(_) => Growth::UNKNOWN,
        };
        self.fold_all(leaf, |operation, operands, x| {
            let divisor = match operands {
                [_, Operand::Number(number)] => Some(f64::from(numbers[*number as usize] as f32).abs()),
                _ => None,
            };
            grown(operation, x, divisor.filter(|&divisor| divisor > 0.0)).within_limits()
        })
    }
}

/// Bounds of an operation's result; `divisor` is the magnitude of its second operand, if that is a number other than 0.
fn grown(operation: Operation, x: &[Growth], divisor: Option<f64>) -> Growth {
    match (operation, divisor) {
        (Operation::Negate, _) => x[0],
        (Operation::Add | Operation::Subtract, _) => x[0].plus(x[1]),
        (Operation::Multiply, _) => x[0].times(x[1]),
        (Operation::Divide, Some(divisor)) => {
            Growth { value: x[0].value / divisor, slope: x[0].slope * divisor.recip().max(1.0) }
        }
        (Operation::Raise(n @ 1..), _) => raised(x[0], n),
        (Operation::Call(function), _) => called(function, x, divisor),
        (Operation::Divide, None) | (Operation::Power | Operation::Raise(_), _) => Growth::UNKNOWN,
    }
}

fn raised(x: Growth, n: i32) -> Growth {
    Growth { value: x.value.powi(n), slope: x.slope * f64::from(n) * x.value.max(1.0).powi(n - 1) }
}

fn called(function: Function, x: &[Growth], divisor: Option<f64>) -> Growth {
    let all = || x[1..].iter().fold(x[0], |all, &x| all.plus(x));
    match (function, divisor) {
        (Function::Abs, _) => x[0],
        (Function::Sin | Function::Cos, _) => Growth { value: 1.0, slope: x[0].slope },
        (Function::Sign | Function::Step, _) => Growth::still(1.0),
        (Function::Floor | Function::Ceil | Function::Round, _) => Growth::still(x[0].value + 1.0),
        (Function::Square, _) => raised(x[0], 2),
        (Function::Exp, _) if x[0].value <= LARGEST_EXPONENT => {
            let value = x[0].value.exp();
            Growth { value, slope: x[0].slope * value }
        }
        (Function::Mod, Some(divisor)) => Growth { value: x[0].value + 2.0 * divisor, slope: x[0].slope },
        // Any of them, or a sum of parts.
        (Function::Min | Function::Max | Function::Clamp, _) => all(),
        (Function::Mix, _) => x[0].plus(x[1]).times(x[2]).plus(x[0]),
        (Function::Exp | Function::Mod, _)
        | (Function::Sqrt | Function::Length | Function::Ln | Function::Pow, _)
        | (Function::Tan | Function::Asin | Function::Acos | Function::Atan | Function::Atan2, _)
        | (Function::Falloff(_), _) => Growth::UNKNOWN,
    }
}
