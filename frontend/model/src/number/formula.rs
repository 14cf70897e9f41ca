//! Formulas: postfix lists of steps, evaluated and printed without recursion.

use std::fmt;
use std::hash::{Hash, Hasher};
use std::mem;
use std::sync::Arc;

use super::binary::Binary;
use super::value::Values;
use crate::diagnostic::{Diagnostic, Span};
use crate::field::plain;
use crate::function::Function;
use crate::report::clip;

/// A variable of a field's formula.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Variable {
    /// 0, 1, 2: x, y, z.
    Coordinate(u8),
    /// The field of a child, by its index.
    Child(u32),
    /// An earlier definition, by its index.
    Definition(u32),
}

/// A step of a formula: takes its operands from the end of a stack and pushes its value there.
#[derive(Clone, Debug)]
pub enum Step {
    /// A number as it is written.
    Literal(f64),
    /// The value of a parameter.
    Parameter {
        /// The name of the parameter.
        name: Arc<str>,
        /// Its value when the formula was written; in Rust, its default.
        default: f64,
    },
    /// A value that depends on the point; in formulas of fields only.
    Variable(Variable),
    /// One operand, with the other sign.
    Negate,
    /// Two operands.
    Binary(Binary),
    /// A function of so many operands.
    Call(Function, u32),
}

impl PartialEq for Step {
    /// Numbers by their bits, parameters by their names.
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Literal(a), Self::Literal(b)) => a.to_bits() == b.to_bits(),
            (Self::Parameter { name: a, .. }, Self::Parameter { name: b, .. }) => a == b,
            (Self::Variable(a), Self::Variable(b)) => a == b,
            (Self::Negate, Self::Negate) => true,
            (Self::Binary(a), Self::Binary(b)) => a == b,
            (Self::Call(f, a), Self::Call(g, b)) => f == g && a == b,
            (
                Self::Literal(_)
                | Self::Parameter { .. }
                | Self::Variable(_)
                | Self::Negate
                | Self::Binary(_)
                | Self::Call(..),
                _,
            ) => false,
        }
    }
}

/// Equality is that of bits and names, so it is reflexive.
impl Eq for Step {}

impl Hash for Step {
    fn hash<H: Hasher>(&self, state: &mut H) {
        mem::discriminant(self).hash(state);
        match self {
            Self::Literal(value) => value.to_bits().hash(state),
            Self::Parameter { name, .. } => name.hash(state),
            Self::Variable(variable) => variable.hash(state),
            Self::Negate => {}
            Self::Binary(binary) => binary.hash(state),
            Self::Call(function, count) => (function, count).hash(state),
        }
    }
}

impl Step {
    /// How many operands it takes.
    pub(crate) const fn operands(&self) -> usize {
        match self {
            Self::Literal(_) | Self::Parameter { .. } | Self::Variable(_) => 0,
            Self::Negate => 1,
            Self::Binary(_) => 2,
            Self::Call(_, count) => *count as usize,
        }
    }
}

/// A number as steps, at least one of which is a parameter.
#[derive(Clone, Debug)]
pub struct Formula {
    steps: Box<[Step]>,
    /// Its place in the text.
    span: Option<Span>,
}

impl PartialEq for Formula {
    fn eq(&self, other: &Self) -> bool {
        self.steps == other.steps
    }
}

impl Formula {
    /// A formula of steps that leave one value.
    pub fn new(steps: Vec<Step>, span: Option<Span>) -> Self {
        Self { steps: steps.into(), span }
    }

    /// The steps, in postfix order.
    #[must_use]
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    pub(crate) fn span(&self) -> Option<Span> {
        self.span
    }

    /// Its parameters, one entry for each instance: name and default.
    pub fn parameters(&self) -> impl Iterator<Item = (&Arc<str>, f64)> {
        self.steps.iter().filter_map(|step| match step {
            Step::Parameter { name, default } => Some((name, *default)),
            Step::Literal(_) | Step::Variable(_) | Step::Negate | Step::Binary(_) | Step::Call(..) => None,
        })
    }

    /// The value for these values of the parameters.
    pub(crate) fn evaluate(&self, values: &Values) -> Result<f64, Diagnostic> {
        let error = |message: String| Diagnostic::error(self.span, message);
        let mut stack: Vec<f64> = Vec::new();
        for step in &self.steps {
            let first = stack.len() - step.operands();
            let operands = &stack[first..];
            let value = match step {
                Step::Literal(value) => *value,
                Step::Parameter { name, .. } => *values
                    .get(name)
                    .ok_or_else(|| error(format!("no parameter is named `{}`", clip(name))))?,
                Step::Variable(_) => return Err(error("a number depends on the point".to_owned())),
                Step::Negate => -operands[0],
                Step::Binary(binary) => binary.compute(operands[0], operands[1]).map_err(error)?,
                Step::Call(function, _) => function.compute(operands).map_err(error)?,
            };
            stack.truncate(first);
            stack.push(value);
        }
        Ok(stack[0])
    }
}

/// For each step, the steps of its operands, in order: one list of all operands, and where each step's
/// operands begin.
fn operands(steps: &[Step]) -> (Vec<u32>, Vec<u32>) {
    let (mut all, mut starts, mut stack) = (Vec::new(), Vec::new(), Vec::new());
    for (index, step) in steps.iter().enumerate() {
        starts.push(all.len() as u32);
        all.extend(stack.drain(stack.len() - step.operands()..));
        stack.push(index as u32);
    }
    (all, starts)
}

/// How strongly a minus sign binds.
const SIGN: u8 = 3;
/// How strongly a number, a name, or anything in parentheses holds together.
const ATOM: u8 = 5;

/// Output that is still to be printed.
enum Piece {
    Text(&'static str),
    /// A step, in parentheses if it binds less strongly than this.
    Step(u32, u8),
}

impl fmt::Display for Formula {
    /// In the text format, with no more parentheses than it needs.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        show(&self.steps, f, |_, _| Ok(()))
    }
}

/// Writes steps in the text format, with no more parentheses than they need; `name` writes variables.
pub fn show<W: fmt::Write>(
    steps: &[Step],
    f: &mut W,
    mut name: impl FnMut(&mut W, Variable) -> fmt::Result,
) -> fmt::Result {
    let (operands, starts) = operands(steps);
    let mut pieces = vec![Piece::Step(steps.len() as u32 - 1, 0)];
    while let Some(piece) = pieces.pop() {
        let (index, least) = match piece {
            Piece::Text(text) => {
                f.write_str(text)?;
                continue;
            }
            Piece::Step(index, least) => (index, least),
        };
        let step = &steps[index as usize];
        let mine = &operands[starts[index as usize] as usize..][..step.operands()];
        let strength = strength(step);
        if strength < least {
            f.write_str("(")?;
            pieces.push(Piece::Text(")"));
        }
        match step {
            Step::Literal(value) => f.write_str(&plain(*value))?,
            Step::Parameter { name, .. } => f.write_str(name)?,
            Step::Variable(variable) => name(f, *variable)?,
            Step::Negate => {
                f.write_str("-")?;
                pieces.push(Piece::Step(mine[0], SIGN));
            }
            Step::Binary(binary) => {
                // Operands group to the left, powers to the right; a sign in an exponent needs no
                // parentheses.
                let (left, right) = match binary {
                    Binary::Power => (ATOM, SIGN),
                    Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide => {
                        (strength, strength + 1)
                    }
                };
                pieces.push(Piece::Step(mine[1], right));
                pieces.push(Piece::Text(binary.text()));
                pieces.push(Piece::Step(mine[0], left));
            }
            Step::Call(function, _) => {
                match function {
                    Function::Falloff(falloff) => write!(f, "{}(", falloff.0.text())?,
                    _ => write!(f, "{}(", function.name())?,
                }
                pieces.push(Piece::Text(")"));
                for (place, &operand) in mine.iter().enumerate().rev() {
                    pieces.push(Piece::Step(operand, 0));
                    if place > 0 {
                        pieces.push(Piece::Text(", "));
                    }
                }
            }
        }
    }
    Ok(())
}

/// The binding strength of a step's outermost operator.
fn strength(step: &Step) -> u8 {
    match step {
        Step::Literal(value) if value.is_sign_negative() => SIGN,
        Step::Literal(_) | Step::Parameter { .. } | Step::Variable(_) | Step::Call(..) => ATOM,
        Step::Negate => SIGN,
        Step::Binary(binary) => binary.strength(),
    }
}
