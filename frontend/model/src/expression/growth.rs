//! Bounds of the values and slopes of a formula where coordinates are bounded: they exclude overflow.
//!
//! See [`Growth`].

use super::form::Form;
use super::operand::Operand;
use super::operation::Operation;
use crate::function::Growth;

/// Beyond this nothing is promised: 2^60.
const LARGEST: f64 = (1u64 << 60) as f64;
/// A bound of the rounding of an operation, as a factor of its result.
const ROUNDING: f64 = 1.0 + 1.0 / (1 << 20) as f64;

/// The growth with rounding, if it is within the limits.
fn within_limits(growth: Growth) -> Growth {
    let grown = Growth { value: growth.value * ROUNDING, slope: growth.slope * ROUNDING };
    // Written so that a NaN is no bound either.
    if grown.value <= LARGEST && grown.slope <= LARGEST { grown } else { Growth::UNKNOWN }
}

impl Form {
    /// Bounds of the values of a form without children, at coordinates up to `largest` in magnitude.
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
            within_limits(grown(operation, x, divisor.filter(|&divisor| divisor > 0.0)))
        })
    }
}

/// Bounds of an operation's result; `divisor` is the magnitude of its second operand, if that is a number
/// other than 0.
fn grown(operation: Operation, x: &[Growth], divisor: Option<f64>) -> Growth {
    match (operation, divisor) {
        (Operation::Negate, _) => x[0],
        (Operation::Add | Operation::Subtract, _) => x[0].plus(x[1]),
        (Operation::Multiply, _) => x[0].times(x[1]),
        (Operation::Divide, Some(divisor)) => {
            Growth { value: x[0].value / divisor, slope: x[0].slope * divisor.recip().max(1.0) }
        }
        (Operation::Raise(n @ 1..), _) => x[0].raised(n),
        (Operation::Call(function), _) => function.growth(x, divisor),
        (Operation::Divide, None) | (Operation::Power | Operation::Raise(_), _) => Growth::UNKNOWN,
    }
}
