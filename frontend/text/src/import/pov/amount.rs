//! Numbers and vectors of the scene language, and what operators and functions make of them.

use glam::DVec3;
use jbt_model::diagnostic::Span;

/// The value of an expression.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Amount {
    Number(f64),
    /// Two to five numbers; those behind the last are 0. A colour has red, green, blue, filter, transmit.
    Vector([f64; 5], usize),
    /// It is made of a name or a text that has no number: its place.
    Unknown(Span),
}

impl Amount {
    pub(super) fn of(vector: DVec3) -> Self {
        Self::Vector([vector.x, vector.y, vector.z, 0.0, 0.0], 3)
    }

    /// As five numbers: a number counts for all of them.
    fn promoted(self) -> [f64; 5] {
        match self {
            Self::Number(number) => [number; 5],
            Self::Vector(numbers, _) => numbers,
            Self::Unknown(_) => [f64::NAN; 5],
        }
    }

    /// The same operation on each pair of numbers; a number meets all of a vector.
    fn zip(self, other: Self, operation: impl Fn(f64, f64) -> f64) -> Self {
        match (self, other) {
            (Self::Unknown(span), _) | (_, Self::Unknown(span)) => Self::Unknown(span),
            (Self::Number(a), Self::Number(b)) => Self::Number(operation(a, b)),
            _ => {
                let size = self.size().max(other.size());
                let (a, b) = (self.promoted(), other.promoted());
                let at = |place: usize| if place < size { operation(a[place], b[place]) } else { 0.0 };
                Self::Vector(std::array::from_fn(at), size)
            }
        }
    }

    fn size(self) -> usize {
        match self {
            Self::Vector(_, size) => size,
            Self::Number(_) | Self::Unknown(_) => 1,
        }
    }

    /// One of its numbers: `V.x`.
    pub(super) fn component(self, place: usize) -> Self {
        match self {
            Self::Unknown(span) => Self::Unknown(span),
            Self::Number(number) => Self::Number(number),
            Self::Vector(numbers, _) => Self::Number(numbers[place]),
        }
    }

    pub(super) fn negated(self) -> Self {
        Self::Number(0.0).zip(self, |_, b| -b)
    }

    pub(super) fn not(self) -> Self {
        self.zip(Self::Number(0.0), |a, _| truth(a == 0.0))
    }
}

/// An operator between two operands; later ones bind closer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum PovOperator {
    Or,
    And,
    Less,
    Greater,
    AtMost,
    AtLeast,
    Equal,
    Unequal,
    Add,
    Subtract,
    Multiply,
    Divide,
}

/// How far apart numbers count as equal in comparisons, as in the original.
const EQUAL: f64 = 1e-10;

impl PovOperator {
    pub(super) const fn precedence(self) -> u8 {
        match self {
            Self::Or => 1,
            Self::And => 2,
            Self::Less | Self::Greater | Self::AtMost | Self::AtLeast | Self::Equal | Self::Unequal => 3,
            Self::Add | Self::Subtract => 4,
            Self::Multiply | Self::Divide => 5,
        }
    }

    pub(super) fn apply(self, a: Amount, b: Amount) -> Amount {
        let equal = |a: f64, b: f64| (a - b).abs() < EQUAL;
        match self {
            Self::Or => a.zip(b, |a, b| truth(a != 0.0 || b != 0.0)),
            Self::And => a.zip(b, |a, b| truth(a != 0.0 && b != 0.0)),
            Self::Less => a.zip(b, |a, b| truth(a < b)),
            Self::Greater => a.zip(b, |a, b| truth(a > b)),
            Self::AtMost => a.zip(b, |a, b| truth(a < b || equal(a, b))),
            Self::AtLeast => a.zip(b, |a, b| truth(a > b || equal(a, b))),
            Self::Equal => a.zip(b, |a, b| truth(equal(a, b))),
            Self::Unequal => a.zip(b, |a, b| truth(!equal(a, b))),
            Self::Add => a.zip(b, |a, b| a + b),
            Self::Subtract => a.zip(b, |a, b| a - b),
            Self::Multiply => a.zip(b, |a, b| a * b),
            Self::Divide => a.zip(b, |a, b| a / b),
        }
    }
}

const fn truth(is: bool) -> f64 {
    if is { 1.0 } else { 0.0 }
}

/// What a function does.
#[derive(Clone, Copy, Debug)]
pub(super) enum PovFunction {
    One(fn(f64) -> f64),
    Two(fn(f64, f64) -> f64),
    /// Of at least one number.
    Several(fn(f64, f64) -> f64),
    /// Of one vector.
    Length,
    Normalize,
    Dot,
    Cross,
    Rotate,
    AxisRotate,
    Seed,
    Random,
}

const FUNCTIONS: &[(&str, PovFunction)] = &[
    ("sin", PovFunction::One(f64::sin)),
    ("cos", PovFunction::One(f64::cos)),
    ("tan", PovFunction::One(f64::tan)),
    ("asin", PovFunction::One(f64::asin)),
    ("acos", PovFunction::One(f64::acos)),
    ("atan", PovFunction::One(f64::atan)),
    ("atan2", PovFunction::Two(f64::atan2)),
    ("sinh", PovFunction::One(f64::sinh)),
    ("cosh", PovFunction::One(f64::cosh)),
    ("tanh", PovFunction::One(f64::tanh)),
    ("asinh", PovFunction::One(f64::asinh)),
    ("acosh", PovFunction::One(f64::acosh)),
    ("atanh", PovFunction::One(f64::atanh)),
    ("exp", PovFunction::One(f64::exp)),
    ("ln", PovFunction::One(f64::ln)),
    ("log", PovFunction::One(f64::log10)),
    ("sqrt", PovFunction::One(f64::sqrt)),
    ("sqr", PovFunction::One(|x| x * x)),
    ("pow", PovFunction::Two(f64::powf)),
    ("abs", PovFunction::One(f64::abs)),
    ("int", PovFunction::One(f64::trunc)),
    ("floor", PovFunction::One(f64::floor)),
    ("ceil", PovFunction::One(f64::ceil)),
    ("mod", PovFunction::Two(|a, b| a % b)),
    ("div", PovFunction::Two(|a, b| (a / b).trunc())),
    ("min", PovFunction::Several(f64::min)),
    ("max", PovFunction::Several(f64::max)),
    ("radians", PovFunction::One(f64::to_radians)),
    ("degrees", PovFunction::One(f64::to_degrees)),
    ("vlength", PovFunction::Length),
    ("vnormalize", PovFunction::Normalize),
    ("vdot", PovFunction::Dot),
    ("vcross", PovFunction::Cross),
    ("vrotate", PovFunction::Rotate),
    ("vaxis_rotate", PovFunction::AxisRotate),
    ("seed", PovFunction::Seed),
    ("rand", PovFunction::Random),
];

/// The function of a name.
pub(super) fn function(name: &str) -> Option<PovFunction> {
    FUNCTIONS.iter().find(|(known, _)| *known == name).map(|&(_, function)| function)
}

/// Sequences of numbers that look random: one for each call of `seed`.
#[derive(Default)]
pub(super) struct Streams(Vec<u32>);

impl Streams {
    /// The number of bytes that each stream keeps is small, but their number is the caller's to bound.
    fn seed(&mut self, seed: f64) -> f64 {
        // As a conversion in C: through a signed number, and what does not fit wraps.
        self.0.push(seed as i64 as u32);
        (self.0.len() - 1) as f64
    }

    fn next(&mut self, stream: f64) -> Option<f64> {
        let state = self.0.get_mut(stream as usize).filter(|_| stream >= 0.0)?;
        *state = state.wrapping_mul(1_812_433_253).wrapping_add(12_345);
        Some(f64::from(*state) / f64::from(u32::MAX))
    }
}

impl PovFunction {
    /// The value for these arguments; an error says what is wrong with them.
    pub(super) fn call(self, arguments: &[Amount], streams: &mut Streams) -> Result<Amount, String> {
        if let Some(&unknown) = arguments.iter().find(|argument| matches!(argument, Amount::Unknown(_))) {
            return Ok(unknown);
        }
        let number = |place: usize| match arguments[place] {
            Amount::Number(number) => Ok(number),
            Amount::Vector(..) | Amount::Unknown(_) => {
                Err("a vector stands where a number should".to_owned())
            }
        };
        let vector = |place: usize| vector(arguments[place]);
        let expected = match self {
            Self::One(_) | Self::Length | Self::Normalize | Self::Seed | Self::Random => 1,
            Self::Two(_) | Self::Dot | Self::Cross | Self::Rotate => 2,
            Self::AxisRotate => 3,
            Self::Several(_) => arguments.len().max(1),
        };
        if arguments.len() != expected {
            return Err(format!("the function has {} arguments, and takes {expected}", arguments.len()));
        }
        Ok(match self {
            Self::One(of) => Amount::Number(of(number(0)?)),
            Self::Two(of) => Amount::Number(of(number(0)?, number(1)?)),
            Self::Several(of) => {
                let mut so_far = number(0)?;
                for place in 1..arguments.len() {
                    so_far = of(so_far, number(place)?);
                }
                Amount::Number(so_far)
            }
            Self::Length => Amount::Number(vector(0).length()),
            Self::Normalize => Amount::of(vector(0).normalize_or_zero()),
            Self::Dot => Amount::Number(vector(0).dot(vector(1))),
            Self::Cross => Amount::of(vector(0).cross(vector(1))),
            Self::Rotate => Amount::of(super::transform::rotation(vector(1)) * vector(0)),
            Self::AxisRotate => {
                let turn = super::transform::about(vector(1), number(2)?);
                Amount::of(turn.ok_or("the axis has no length")? * vector(0))
            }
            Self::Seed => Amount::Number(streams.seed(number(0)?)),
            Self::Random => {
                let next = streams.next(number(0)?);
                Amount::Number(next.ok_or("`rand` takes what `seed` gave, and this is none")?)
            }
        })
    }
}

/// The first three numbers of an amount, a number for all of them.
pub(super) fn vector(amount: Amount) -> DVec3 {
    DVec3::from_slice(&amount.promoted())
}
