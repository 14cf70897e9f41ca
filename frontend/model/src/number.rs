//! Numbers of a model: plain ones, and formulas of parameters that can be set again at run time.
//!
//! ```
//! use jbt_model::number::{Number, param};
//! let bulge = param("bulge", 0.6);
//! let radius: Number = 2.0 * &bulge + 1.0;
//! assert_eq!(radius.value(), 2.2);
//! assert_eq!(radius.to_string(), "2 * bulge + 1");
//! assert!(radius.depends_on_parameters() && !Number::from(2.2).depends_on_parameters());
//! ```
//!
//! A formula is a list of steps in postfix order, `2 bulge * 1 +`, evaluated in f64 on a stack. A plain
//! number has no formula, and arithmetic of plain numbers gives plain numbers.

mod binary;
mod formula;
mod value;

use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use crate::diagnostic::Diagnostic;
use crate::field::{NumberText, plain};
use crate::function::Function;
use crate::word::normalized;

pub use binary::Binary;
pub use formula::{NumberFormula, Step, Variable, show};

pub(crate) use value::ParameterValues;

/// A number of a model: a plain one, or one that depends on parameters.
///
/// It converts from `f64`, `f32`, and integers of up to 32 bits, all exactly (so that 0.1f32 is
/// 0.10000000149011612), and has the operators
/// `+ - * /` with `f64`, `i32` and its own kind, and functions of the text format. See the module.
#[derive(Clone)]
pub struct Number {
    value: f64,
    formula: Option<Arc<NumberFormula>>,
}

/// A parameter: a number with a name that can be set at run time, see
/// [`CheckedTree::with_parameters`](crate::check::CheckedTree::with_parameters).
///
/// All uses of a name in one model are one parameter and have to give the same default. A name is a letter,
/// then letters, digits and underscores, and not a word of the text format's expressions.
#[must_use]
pub fn param(name: &str, default: f64) -> Number {
    let steps = vec![Step::Parameter { name: normalized(name).into(), default }];
    Number { value: default, formula: Some(Arc::new(NumberFormula::new(steps, None))) }
}

impl Number {
    /// Its value, with the parameters' values at the time when it was made.
    #[must_use]
    pub const fn value(&self) -> f64 {
        self.value
    }

    /// Whether it depends on a parameter.
    #[must_use]
    pub const fn depends_on_parameters(&self) -> bool {
        self.formula.is_some()
    }

    /// A number with a formula, whose value is known.
    pub fn with_formula(value: f64, formula: NumberFormula) -> Self {
        Self { value, formula: Some(Arc::new(formula)) }
    }

    /// What the number comes from, unless it is plain.
    #[must_use]
    pub fn formula(&self) -> Option<&NumberFormula> {
        self.formula.as_deref()
    }

    /// The number for these values of the parameters. An error has the place of the formula, if that is
    /// known.
    pub(crate) fn refreshed(&self, values: &ParameterValues) -> Result<Self, Diagnostic> {
        match &self.formula {
            None => Ok(self.clone()),
            Some(formula) => {
                Ok(Self { value: formula.evaluate(values)?, formula: Some(Arc::clone(formula)) })
            }
        }
    }

    /// The steps that give this number.
    pub fn steps(&self) -> Vec<Step> {
        match &self.formula {
            Some(formula) => formula.steps().to_vec(),
            None => vec![Step::Literal(self.value)],
        }
    }

    fn unary(&self, step: Step, value: f64) -> Self {
        if !self.depends_on_parameters() {
            return Self::from(value);
        }
        let mut steps = self.steps();
        steps.push(step);
        Self::with_formula(value, NumberFormula::new(steps, None))
    }

    fn binary(&self, other: &Self, step: Step, value: f64) -> Self {
        if !self.depends_on_parameters() && !other.depends_on_parameters() {
            return Self::from(value);
        }
        let mut steps = self.steps();
        steps.extend(other.steps());
        steps.push(step);
        Self::with_formula(value, NumberFormula::new(steps, None))
    }

    /// The result of a step on its operands, as a number. Its value may be infinite or NaN.
    pub fn of_step(step: Step, operands: &[&Self]) -> Self {
        let values: Vec<f64> = operands.iter().map(|number| number.value).collect();
        let value = match &step {
            Step::Negate => -values[0],
            Step::Binary(binary) => binary.apply(values[0], values[1]),
            Step::Call(function, _) => function.apply(&values),
            Step::Literal(value) | Step::Parameter { default: value, .. } => *value,
            Step::Variable(_) => f64::NAN,
        };
        if !operands.iter().any(|number| number.depends_on_parameters()) {
            return Self::from(value);
        }
        let mut steps: Vec<Step> = operands.iter().flat_map(|number| number.steps()).collect();
        steps.push(step);
        Self::with_formula(value, NumberFormula::new(steps, None))
    }

    /// The value of any function; `operands` are as many as its [`arity`](Function::arity) allows.
    #[must_use]
    pub fn of_function(function: Function, operands: impl IntoIterator<Item = Self>) -> Self {
        let operands: Vec<Self> = operands.into_iter().collect();
        Self::of_step(Step::Call(function, operands.len() as u32), &operands.iter().collect::<Vec<_>>())
    }

    fn call(&self, function: Function) -> Self {
        self.unary(Step::Call(function, 1), function.apply(&[self.value]))
    }

    fn call2(&self, function: Function, other: &Self) -> Self {
        self.binary(other, Step::Call(function, 2), function.apply(&[self.value, other.value]))
    }

    /// The square root.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        self.call(Function::Sqrt)
    }

    /// The sine of an angle in radians.
    #[must_use]
    pub fn sin(&self) -> Self {
        self.call(Function::Sin)
    }

    /// The cosine of an angle in radians.
    #[must_use]
    pub fn cos(&self) -> Self {
        self.call(Function::Cos)
    }

    /// The magnitude.
    #[must_use]
    pub fn abs(&self) -> Self {
        self.call(Function::Abs)
    }

    /// e to this power.
    #[must_use]
    pub fn exp(&self) -> Self {
        self.call(Function::Exp)
    }

    /// The natural logarithm.
    #[must_use]
    pub fn ln(&self) -> Self {
        self.call(Function::Ln)
    }

    /// The smaller one.
    #[must_use]
    pub fn min(&self, other: impl Into<Self>) -> Self {
        self.call2(Function::Min, &other.into())
    }

    /// The larger one.
    #[must_use]
    pub fn max(&self, other: impl Into<Self>) -> Self {
        self.call2(Function::Max, &other.into())
    }

    /// This number to a power.
    #[must_use]
    pub fn powf(&self, exponent: impl Into<Self>) -> Self {
        let exponent = exponent.into();
        self.binary(&exponent, Step::Binary(Binary::Power), self.value.powf(exponent.value))
    }
}

impl From<f64> for Number {
    fn from(value: f64) -> Self {
        Self { value, formula: None }
    }
}

macro_rules! lossless {
    ($($type:ty)+) => { $(
        impl From<$type> for Number {
            /// The same number, exactly.
            fn from(value: $type) -> Self {
                Self::from(f64::from(value))
            }
        }
    )+ };
}

lossless! { f32 i8 i16 i32 u8 u16 u32 }

impl From<&Self> for Number {
    fn from(number: &Self) -> Self {
        number.clone()
    }
}

impl PartialEq for Number {
    /// Formulas by their steps, plain numbers by their values.
    fn eq(&self, other: &Self) -> bool {
        match (&self.formula, &other.formula) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b) || a == b,
            (None, None) => self.value == other.value,
            (Some(_), None) | (None, Some(_)) => false,
        }
    }
}

impl fmt::Debug for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.formula {
            None => fmt::Debug::fmt(&self.value, f),
            Some(_) => write!(f, "{self} = {:?}", self.value),
        }
    }
}

impl NumberText for Number {
    fn present(&self) -> f64 {
        self.value
    }

    fn is_fixed(&self) -> bool {
        !self.depends_on_parameters()
    }

    /// Plain numbers, the common case, in one piece.
    fn text(&self) -> String {
        if self.depends_on_parameters() { self.to_string() } else { plain(self.value) }
    }
}

impl fmt::Display for Number {
    /// As the text format has it: reads back as the same number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.formula {
            None => f.write_str(&plain(self.value)),
            Some(formula) => formula.fmt(f),
        }
    }
}

impl Neg for Number {
    type Output = Self;

    fn neg(self) -> Self {
        -&self
    }
}

impl Neg for &Number {
    type Output = Number;

    fn neg(self) -> Number {
        self.unary(Step::Negate, -self.value)
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident $binary:ident),+ $(,)?) => { $(
        impl $trait<&Number> for &Number {
            type Output = Number;

            fn $method(self, other: &Number) -> Number {
                let value = Binary::$binary.apply(self.value, other.value);
                self.binary(other, Step::Binary(Binary::$binary), value)
            }
        }
        operators! { @ $trait $method Number, Number }
        operators! { @ $trait $method Number, &Number }
        operators! { @ $trait $method &Number, Number }
        operators! { @ $trait $method Number, f64 }
        operators! { @ $trait $method &Number, f64 }
        operators! { @ $trait $method f64, Number }
        operators! { @ $trait $method f64, &Number }
        operators! { @ $trait $method Number, i32 }
        operators! { @ $trait $method &Number, i32 }
        operators! { @ $trait $method i32, Number }
        operators! { @ $trait $method i32, &Number }
    )+ };
    (@ $trait:ident $method:ident $left:ty, $right:ty) => {
        impl $trait<$right> for $left {
            type Output = Number;

            fn $method(self, other: $right) -> Number {
                $trait::$method(&Number::from(self), &Number::from(other))
            }
        }
    };
}

operators! {
    Add add Add,
    Sub sub Subtract,
    Mul mul Multiply,
    Div div Divide,
}

/// Three numbers: from an array, or from a tuple where some are plain and some depend on parameters; with the
/// features `glam` and `mint` from their vectors.
#[derive(Clone, PartialEq, Debug)]
pub struct Vector(pub(crate) [Number; 3]);

impl<T: Into<Number>> From<[T; 3]> for Vector {
    fn from(numbers: [T; 3]) -> Self {
        Self(numbers.map(Into::into))
    }
}

impl<X: Into<Number>, Y: Into<Number>, Z: Into<Number>> From<(X, Y, Z)> for Vector {
    fn from((x, y, z): (X, Y, Z)) -> Self {
        Self([x.into(), y.into(), z.into()])
    }
}

/// The rows of a 3x4 matrix, an affine map: the last column is the shift. From arrays of rows, and with the
/// features `glam` and `mint` from their maps.
#[derive(Clone, PartialEq, Debug)]
pub struct Rows(pub(crate) [[Number; 4]; 3]);

impl<T: Into<Number>> From<[[T; 4]; 3]> for Rows {
    fn from(rows: [[T; 4]; 3]) -> Self {
        Self(rows.map(|row| row.map(Into::into)))
    }
}

/// The values of several numbers.
pub(crate) fn values<const N: usize>(numbers: &[Number; N]) -> [f64; N] {
    std::array::from_fn(|index| numbers[index].value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(number: &Number, p: f64) -> f64 {
        number.refreshed(&ParameterValues::from([("p".into(), p)])).unwrap().value()
    }

    #[test]
    fn arithmetic_follows_the_parameter() {
        let p = param("p", 2.0);
        type Plain = fn(f64) -> f64;
        let all: [(Number, Plain); 8] = [
            (1.0 - &p, |p| 1.0 - p),
            (&p / 4.0 + &p, |p| p / 4.0 + p),
            (-(&p * &p), |p| -(p * p)),
            (p.sqrt().max(1.5), |p| p.sqrt().max(1.5)),
            (p.sin().min(p.cos()), |p| p.sin().min(p.cos())),
            ((-&p).abs().exp().ln(), |p| (-p).abs().exp().ln()),
            (p.powf(3.0), |p| p.powf(3.0)),
            (Number::from(-2.0).powf(&p), |p| (-2f64).powf(p)),
        ];
        for (number, plain) in all {
            assert_eq!(number.value().to_bits(), plain(2.0).to_bits(), "{number}");
            assert_eq!(at(&number, 3.0).to_bits(), plain(3.0).to_bits(), "{number}");
        }
        assert_eq!((Number::from(2.0) * 3.0).to_string(), "6");
    }

    #[test]
    fn text_has_no_more_parentheses_than_it_needs() {
        let (a, b) = (param("a", 1.0), param("b", 2.0));
        for (number, text) in [
            (&a + &b - 1.0, "a + b - 1"),
            (&a - (&b - 1.0), "a - (b - 1)"),
            ((&a + &b) * 2.0, "(a + b) * 2"),
            (&a + &b * 2.0, "a + b * 2"),
            (&a / (&b / -2.0), "a / (b / -2)"),
            (-(&a + &b), "-(a + b)"),
            ((-&a).powf(2.0), "(-a)^2"),
            (-(a.powf(2.0)), "-a^2"),
            (a.powf(&b).powf(2.0), "(a^b)^2"),
            (a.powf(b.powf(2.0)), "a^b^2"),
            (Number::from(-1.0).powf(&a), "(-1)^a"),
            (a.powf(-1.0), "a^-1"),
            ((&a + 1.0).min(&b), "min(a + 1, b)"),
        ] {
            assert_eq!(number.to_string(), text);
        }
    }

    #[test]
    fn what_cannot_be_computed_is_an_error() {
        let p = param("p", 1.0);
        let message = |number: Number, p: f64| {
            number.refreshed(&ParameterValues::from([("p".into(), p)])).unwrap_err().message
        };
        assert_eq!(message(1.0 / &p, 0.0), "division by zero");
        assert_eq!(message(p.sqrt(), -1.0), "sqrt(-1) is not a finite number");
        assert_eq!(message(p.exp(), 1e9), "exp(1000000000) is not a finite number");
        assert_eq!(message(&p * &p, 1e300), "1e300 * 1e300 is not a finite number");
        assert_eq!(message(param("q", 1.0), 1.0), "no parameter is named `q`");
    }
}
