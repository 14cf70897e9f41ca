//! Functions of formulas: of parameters, and of a point. One row a member.
//!
//! A member states its word and operands, its value in f64 (the oracle), facts about the value that hold at
//! every point, and the value over [`Domain`] (the compiler). To add one: write it into a file of this
//! folder, add its line to the list.
//!
//! Formulas of a point also have functions outside of the list: falloffs of a distance. See
//! [`Function::Falloff`].
//!
//! The rounding error over the ops, in units in the last place (ULP) of the result, is half a unit for
//! arithmetic and roots, the error of [`jbt_ir::math`] for `sin`, `cos`, `exp`, `ln` and powers, at most 4
//! for `atan`, `atan2`, `asin` and `acos` (see `angle`), 3.5 for `tan`.

use std::hash::{Hash, Hasher};

use jbt_ir::Domain;

use crate::falloff::{Falloff, Nearness};
use crate::field::plain;

mod angles;
mod formulas;
mod growth;
mod member;
mod powers;
mod several;
mod steps;

pub(crate) use formulas::{power, quotient};
pub(crate) use growth::Growth;
pub(crate) use member::ANY;
use member::FunctionMember as _;

/// A falloff with plain numbers: formulas with different numbers have different code.
#[derive(Clone, Copy, Debug)]
pub struct FixedFalloff(pub(crate) Falloff);

impl FixedFalloff {
    /// The falloff.
    #[must_use]
    pub const fn falloff(self) -> Falloff {
        self.0
    }

    /// The numbers of its parameters.
    fn bits(&self) -> impl Iterator<Item = u64> + use<> {
        self.0.to_fields().into_iter().flat_map(|field| field.numbers().to_vec()).map(f64::to_bits)
    }

    /// The field at a distance; distance 1 is the support radius.
    fn value(&self, x: &[f64]) -> f64 {
        self.0.value(x[0].max(0.0).powi(2))
    }

    fn kink_distance(&self, x: &[f64]) -> f64 {
        let tip = if self.0.is_pointed() { x[0].abs() } else { f64::INFINITY };
        (1.0 - x[0]).abs().min(tip)
    }

    fn emit<D: Domain>(&self, d: &mut D, x: &[D::Real]) -> D::Real {
        let zero = d.constant(0.0);
        let distance = d.max(x[0], zero);
        let minus = d.neg(distance);
        let near = Nearness::emit(d, minus, distance);
        let (kind, mut numbers) = (self.0.kind(), Vec::new());
        self.0.columns(kind, &mut numbers);
        let row: Vec<D::Real> = numbers.into_iter().map(|number| d.constant(number as f32)).collect();
        kind.emit(d, near, &row)
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

macro_rules! functions {
    ($($module:ident :: $name:ident),+ $(,)?) => {
        /// A function of the text format: one of the list, or a falloff.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        pub enum Function {
            $( #[doc = concat!("One of `function/", stringify!($module), ".rs`.")] $name, )+
            /// A falloff of a distance, where 1 is the support radius and negative numbers count as 0. Only
            /// formulas of a point have it.
            Falloff(FixedFalloff),
        }

        impl Function {
            /// All functions but falloffs.
            pub const ALL: [Self; [$( stringify!($name) ),+].len()] = [$( Self::$name ),+];

            /// The word of the text format.
            pub const fn name(self) -> &'static str {
                match self { $( Self::$name => $module::$name::NAME, )+ Self::Falloff(falloff) => falloff.0.name() }
            }

            /// Whether its word is reserved, even where it is not called: no parameter may have the name.
            pub const fn is_reserved(self) -> bool {
                match self { $( Self::$name => $module::$name::RESERVED, )+ Self::Falloff(_) => false }
            }

            /// The allowed numbers of arguments.
            pub const fn arity(self) -> (usize, usize) {
                match self { $( Self::$name => $module::$name::ARITY, )+ Self::Falloff(_) => (1, 1) }
            }

            /// The value; `arguments` are as many as [`arity`](Self::arity) allows.
            pub fn apply(self, arguments: &[f64]) -> f64 {
                match self {
                    $( Self::$name => $module::$name::value(arguments), )+
                    Self::Falloff(falloff) => falloff.value(arguments),
                }
            }

            /// The value in formulas of a point, in f64, defined for all operands.
            pub fn total(self, x: &[f64]) -> f64 {
                match self { $( Self::$name => $module::$name::total(x), )+ Self::Falloff(falloff) => falloff.value(x) }
            }

            /// The distance of the operands from the nearest jump, kink or pole.
            pub(crate) fn kink_distance(self, x: &[f64]) -> f64 {
                match self { $( Self::$name => $module::$name::kink_distance(x), )+ Self::Falloff(falloff) => falloff.kink_distance(x) }
            }

            /// Whether the value, with rounding, is never negative, derived from the same facts about the
            /// operands.
            pub(crate) fn non_negative(self, x: &[bool]) -> bool {
                match self { $( Self::$name => $module::$name::non_negative(x), )+ Self::Falloff(_) => true }
            }

            /// A range of the value from ranges of the operands, not all of which are points.
            pub(crate) fn range(self, x: &[[f64; 2]]) -> [f64; 2] {
                match self { $( Self::$name => $module::$name::range(x), )+ Self::Falloff(_) => [0.0, 1.0] }
            }

            /// Bounds of the value from bounds of the operands. `divisor` is the magnitude of the second
            /// operand, if that is a number other than 0.
            pub(crate) fn growth(self, x: &[Growth], divisor: Option<f64>) -> Growth {
                match self { $( Self::$name => $module::$name::growth(x, divisor), )+ Self::Falloff(_) => Growth::UNKNOWN }
            }

            /// The value in formulas of a point, over the ops. `positive` means that the first operand is
            /// known not to be negative.
            pub(crate) fn emit<D: Domain>(self, d: &mut D, x: &[D::Real], positive: bool) -> D::Real {
                match self {
                    $( Self::$name => $module::$name::emit(d, x, positive), )+
                    Self::Falloff(falloff) => falloff.emit(d, x),
                }
            }
        }
    };
}

functions! {
    powers::Sqrt,
    angles::Sin,
    angles::Cos,
    angles::Tan,
    angles::Asin,
    angles::Acos,
    angles::Atan,
    angles::Atan2,
    steps::Abs,
    steps::Sign,
    steps::Floor,
    steps::Ceil,
    steps::Round,
    steps::Mod,
    powers::Exp,
    powers::Ln,
    powers::Square,
    several::Min,
    several::Max,
    several::Clamp,
    several::Mix,
    steps::Step,
    several::Length,
    powers::Pow,
}

impl Function {
    /// The function that a word names.
    pub fn named(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|function| function.name() == word)
    }

    /// The function of a falloff.
    pub const fn falloff(falloff: Falloff) -> Self {
        Self::Falloff(FixedFalloff(falloff))
    }

    /// The value, or the reason why it is undefined.
    pub fn compute(self, arguments: &[f64]) -> Result<f64, String> {
        let value = self.apply(arguments);
        if value.is_finite() {
            return Ok(value);
        }
        let shown: Vec<String> = arguments.iter().map(|&x| plain(x)).collect();
        Err(format!("{}({}) is not a finite number", self.name(), shown.join(", ")))
    }
}
