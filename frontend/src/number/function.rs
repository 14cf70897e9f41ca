//! The operators and functions of number expressions.

use std::hash::{Hash, Hasher};

use crate::falloff::Falloff;
use crate::field::plain;

/// A function of the text format. The list is the one below.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Function {
    Sqrt,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    /// The angle of the point (second, first).
    Atan2,
    Abs,
    /// -1, 0 or 1.
    Sign,
    /// Down to a whole number.
    Floor,
    /// Up to a whole number.
    Ceil,
    /// To the nearest whole number, ties to the even one.
    Round,
    /// What is left of the first after whole multiples of the second: at least 0, and below the second's magnitude.
    Mod,
    Exp,
    Ln,
    Square,
    Min,
    Max,
    /// The first, but not below the second and not above the third.
    Clamp,
    /// From the first to the second, as the third goes from 0 to 1.
    Mix,
    /// 0 where the second is below the first, else 1.
    Step,
    /// The length of a vector.
    Length,
    Pow,
    /// A falloff of the distance, 1 being where it ends; what is below 0 counts as 0. Known in field expressions alone.
    Falloff(FixedFalloff),
}

/// A falloff whose numbers are plain: formulas with different ones have different code.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FixedFalloff(pub(crate) Falloff);

impl FixedFalloff {
    /// The numbers of its parameters.
    fn bits(&self) -> impl Iterator<Item = u64> + use<> {
        self.0.to_fields().into_iter().flat_map(|field| field.numbers().to_vec()).map(f64::to_bits)
    }
}

impl PartialEq for FixedFalloff {
    fn eq(&self, other: &Self) -> bool {
        self.0.kind() == other.0.kind() && self.bits().eq(other.bits())
    }
}

impl Eq for FixedFalloff {}

impl Hash for FixedFalloff {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.kind().hash(state);
        self.bits().for_each(|bits| bits.hash(state));
    }
}

impl Function {
    /// All functions but falloffs.
    pub(crate) const ALL: [Self; 24] = [
        Self::Sqrt,
        Self::Sin,
        Self::Cos,
        Self::Tan,
        Self::Asin,
        Self::Acos,
        Self::Atan,
        Self::Atan2,
        Self::Abs,
        Self::Sign,
        Self::Floor,
        Self::Ceil,
        Self::Round,
        Self::Mod,
        Self::Exp,
        Self::Ln,
        Self::Square,
        Self::Min,
        Self::Max,
        Self::Clamp,
        Self::Mix,
        Self::Step,
        Self::Length,
        Self::Pow,
    ];

    /// The word of the text format.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Sqrt => "sqrt",
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tan => "tan",
            Self::Asin => "asin",
            Self::Acos => "acos",
            Self::Atan => "atan",
            Self::Atan2 => "atan2",
            Self::Abs => "abs",
            Self::Sign => "sign",
            Self::Floor => "floor",
            Self::Ceil => "ceil",
            Self::Round => "round",
            Self::Mod => "mod",
            Self::Exp => "exp",
            Self::Ln => "ln",
            Self::Square => "square",
            Self::Min => "min",
            Self::Max => "max",
            Self::Clamp => "clamp",
            Self::Mix => "mix",
            Self::Step => "step",
            Self::Length => "length",
            Self::Pow => "pow",
            Self::Falloff(falloff) => falloff.0.name(),
        }
    }

    /// The function that a word names.
    pub(crate) fn named(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|function| function.name() == word)
    }

    /// Whether its word means nothing else, also where it is not called: no parameter has such a name.
    pub(crate) const fn is_reserved(self) -> bool {
        matches!(
            self,
            Self::Sqrt
                | Self::Sin
                | Self::Cos
                | Self::Abs
                | Self::Exp
                | Self::Ln
                | Self::Min
                | Self::Max
                | Self::Pow
        )
    }

    /// The function of a falloff.
    pub(crate) const fn falloff(falloff: Falloff) -> Self {
        Self::Falloff(FixedFalloff(falloff))
    }

    /// The allowed numbers of arguments.
    pub(crate) const fn arity(self) -> (usize, usize) {
        match self {
            Self::Sqrt
            | Self::Sin
            | Self::Cos
            | Self::Tan
            | Self::Asin
            | Self::Acos
            | Self::Atan
            | Self::Abs
            | Self::Sign
            | Self::Floor
            | Self::Ceil
            | Self::Round
            | Self::Exp
            | Self::Ln
            | Self::Square
            | Self::Falloff(_) => (1, 1),
            Self::Min | Self::Max | Self::Length => (1, usize::MAX),
            Self::Atan2 | Self::Mod | Self::Step | Self::Pow => (2, 2),
            Self::Clamp | Self::Mix => (3, 3),
        }
    }

    /// The value; `arguments` are as many as [`arity`](Self::arity) allows.
    pub(crate) fn apply(self, arguments: &[f64]) -> f64 {
        let x = arguments[0];
        match self {
            Self::Sqrt => x.sqrt(),
            Self::Sin => x.sin(),
            Self::Cos => x.cos(),
            Self::Tan => x.tan(),
            Self::Asin => x.asin(),
            Self::Acos => x.acos(),
            Self::Atan => x.atan(),
            Self::Atan2 => x.atan2(arguments[1]),
            Self::Abs => x.abs(),
            Self::Sign if x == 0.0 => 0.0,
            Self::Sign => x.signum(),
            Self::Floor => x.floor(),
            Self::Ceil => x.ceil(),
            Self::Round => x.round_ties_even(),
            Self::Mod => {
                let by = arguments[1].abs();
                x - by * (x / by).floor()
            }
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Square => x * x,
            Self::Min => arguments.iter().copied().fold(x, f64::min),
            Self::Max => arguments.iter().copied().fold(x, f64::max),
            Self::Clamp => x.max(arguments[1]).min(arguments[2]),
            Self::Mix => x + (arguments[1] - x) * arguments[2],
            Self::Step => f64::from(u8::from(arguments[1] >= x)),
            Self::Length => arguments.iter().map(|x| x * x).sum::<f64>().sqrt(),
            Self::Pow => x.powf(arguments[1]),
            Self::Falloff(falloff) => falloff.0.value(x.max(0.0).powi(2)),
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
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
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
