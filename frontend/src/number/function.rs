//! The operators and functions of number expressions.

use super::plain;

/// A function of the text format.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Function {
    Sqrt,
    Sin,
    Cos,
    Abs,
    Exp,
    Ln,
    Min,
    Max,
    Pow,
}

impl Function {
    /// All functions.
    pub(crate) const ALL: [Self; 9] =
        [Self::Sqrt, Self::Sin, Self::Cos, Self::Abs, Self::Exp, Self::Ln, Self::Min, Self::Max, Self::Pow];

    /// The word of the text format.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Sqrt => "sqrt",
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Abs => "abs",
            Self::Exp => "exp",
            Self::Ln => "ln",
            Self::Min => "min",
            Self::Max => "max",
            Self::Pow => "pow",
        }
    }

    /// The function that a word names.
    pub(crate) fn named(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|function| function.name() == word)
    }

    /// The allowed numbers of arguments.
    pub(crate) const fn arity(self) -> (usize, usize) {
        match self {
            Self::Sqrt | Self::Sin | Self::Cos | Self::Abs | Self::Exp | Self::Ln => (1, 1),
            Self::Min | Self::Max => (1, usize::MAX),
            Self::Pow => (2, 2),
        }
    }

    /// The value; `arguments` are as many as [`arity`](Self::arity) allows.
    pub(crate) fn apply(self, arguments: &[f64]) -> f64 {
        let x = arguments[0];
        match self {
            Self::Sqrt => x.sqrt(),
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Abs => x.abs(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Min => arguments.iter().copied().fold(x, f64::min),
            Self::Max => arguments.iter().copied().fold(x, f64::max),
            Self::Pow => x.powf(arguments[1]),
        }
    }

    /// The value, or why there is none.
    pub(crate) fn compute(self, arguments: &[f64]) -> Result<f64, String> {
        let value = self.apply(arguments);
        if value.is_finite() {
            return Ok(value);
        }
        let shown: Vec<String> = arguments.iter().map(|&x| plain(x)).collect();
        Err(format!("{}({}) is not a finite number", self.name(), shown.join(", ")))
    }
}

/// An operator between two numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

impl Binary {
    /// The operator that is written so.
    pub(crate) const fn of_mark(mark: u8) -> Option<Self> {
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
    pub(crate) const fn strength(self) -> u8 {
        match self {
            Self::Add | Self::Subtract => 1,
            Self::Multiply | Self::Divide => 2,
            Self::Power => 4,
        }
    }

    /// The value.
    pub(crate) fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Power => a.powf(b),
        }
    }

    /// The value, or why there is none.
    pub(crate) fn compute(self, a: f64, b: f64) -> Result<f64, String> {
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
