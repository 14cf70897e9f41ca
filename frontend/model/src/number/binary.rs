//! The operators of number expressions.

use crate::field::plain;

/// An operator between two numbers.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Binary {
    /// `a + b`.
    Add,
    /// `a - b`.
    Subtract,
    /// `a * b`.
    Multiply,
    /// `a / b`.
    Divide,
    /// `a ^ b`.
    Power,
}

impl Binary {
    /// The operator that is written so.
    pub const fn of_mark(mark: u8) -> Option<Self> {
        match mark {
            b'+' => Some(Self::Add),
            b'-' => Some(Self::Subtract),
            b'*' => Some(Self::Multiply),
            b'/' => Some(Self::Divide),
            b'^' => Some(Self::Power),
            _ => None,
        }
    }

    /// How it is written between its operands.
    pub(crate) const fn text(self) -> &'static str {
        match self {
            Self::Add => " + ",
            Self::Subtract => " - ",
            Self::Multiply => " * ",
            Self::Divide => " / ",
            Self::Power => "^",
        }
    }

    /// How strongly it binds; a minus sign has 3.
    pub const fn strength(self) -> u8 {
        match self {
            Self::Add | Self::Subtract => 1,
            Self::Multiply | Self::Divide => 2,
            Self::Power => 4,
        }
    }

    /// The value.
    pub fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => a.powf(b),
        }
    }

    /// The value, or why there is none.
    pub fn compute(self, a: f64, b: f64) -> Result<f64, String> {
        if self == Self::Divide && b == 0.0 {
            return Err("division by zero".to_owned());
        }
        let value = self.apply(a, b);
        if value.is_finite() {
            return Ok(value);
        }
        let (a, b) = (plain(a), plain(b));
        Err(match self {
            Self::Power => format!("pow({a}, {b}) is not a finite number"),
            Self::Add | Self::Subtract | Self::Multiply | Self::Divide => {
                format!("{a}{}{b} is not a finite number", self.text())
            }
        })
    }
}
