//! Formulas as text: first definitions of parts that are used more than once, then the value, or several
//! values in parentheses.

use std::fmt;

use super::form::Form;
use super::operand::Operand;
use super::operation::Operation;
use crate::function::Function;
use crate::number::{Binary, Number, Step, Variable, show};

/// The steps of a formula, in postfix order.
#[derive(Clone, Debug)]
pub struct FormulaSteps {
    /// Of the parts that are used more than once: a part knows those in front of it by their places.
    pub definitions: Vec<Vec<Step>>,
    /// Of the values.
    pub results: Vec<Vec<Step>>,
}

impl FormulaSteps {
    /// Those of a form with these numbers.
    #[must_use]
    pub fn new(form: &Form, numbers: &[Number]) -> Self {
        let shared = (0..).zip(form.uses()).filter(|(_, uses)| *uses > 1).map(|(step, _)| step);
        let mut place = vec![None; form.steps()];
        let all: Vec<(Operation, &[Operand])> = form.iter().collect();
        let mut definitions = Vec::new();
        for step in shared {
            definitions.push(postfix(&all, Operand::Step(step), numbers, &place));
            place[step as usize] = Some(definitions.len() as u32 - 1);
        }
        let results = form.results.iter().map(|&result| postfix(&all, result, numbers, &place)).collect();
        Self { definitions, results }
    }
}

/// Writes a formula; `child` and `definition` name children and definitions.
pub fn write<W: fmt::Write>(
    out: &mut W,
    form: &Form,
    numbers: &[Number],
    child: impl Fn(usize) -> String,
    definition: impl Fn(usize) -> String,
    tuple: bool,
) -> fmt::Result {
    let FormulaSteps { definitions, results } = FormulaSteps::new(form, numbers);
    let mut name = |out: &mut W, variable: Variable| match variable {
        Variable::Coordinate(axis) => out.write_str(["x", "y", "z"][axis as usize]),
        Variable::Child(index) => write!(out, "field({})", child(index as usize)),
        Variable::Definition(index) => out.write_str(&definition(index as usize)),
    };
    for (index, steps) in definitions.iter().enumerate() {
        write!(out, "{} = ", definition(index))?;
        show(steps, out, &mut name)?;
        out.write_str(", ")?;
    }
    out.write_str(if tuple { "(" } else { "" })?;
    for (index, steps) in results.iter().enumerate() {
        out.write_str(if index == 0 { "" } else { ", " })?;
        show(steps, out, &mut name)?;
    }
    out.write_str(if tuple { ")" } else { "" })
}

/// The steps of a part, in postfix order; parts with a definition become its name.
fn postfix(
    all: &[(Operation, &[Operand])],
    part: Operand,
    numbers: &[Number],
    definitions: &[Option<u32>],
) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut stack = vec![(part, false)];
    while let Some((operand, done)) = stack.pop() {
        match operand {
            Operand::Coordinate(axis) => steps.push(Step::Variable(Variable::Coordinate(axis))),
            Operand::Child(child) => steps.push(Step::Variable(Variable::Child(child))),
            Operand::Number(number) => steps.extend(numbers[number as usize].steps()),
            Operand::Step(step) => {
                let (operation, operands) = all[step as usize];
                if let Some(definition) = definitions[step as usize] {
                    steps.push(Step::Variable(Variable::Definition(definition)));
                } else if done {
                    finish(&mut steps, operation, operands.len());
                } else {
                    stack.push((operand, true));
                    stack.extend(operands.iter().rev().map(|&operand| (operand, false)));
                }
            }
        }
    }
    steps
}

fn finish(steps: &mut Vec<Step>, operation: Operation, operands: usize) {
    let last = match operation {
        Operation::Negate => Step::Negate,
        Operation::Add => Step::Binary(Binary::Add),
        Operation::Subtract => Step::Binary(Binary::Subtract),
        Operation::Multiply => Step::Binary(Binary::Multiply),
        Operation::Divide => Step::Binary(Binary::Divide),
        Operation::Power => Step::Binary(Binary::Power),
        Operation::Raise(n) => {
            steps.push(Step::Literal(f64::from(n)));
            Step::Binary(Binary::Power)
        }
        Operation::Call(function) => {
            debug_assert!(function != Function::Pow && function != Function::Square, "these have operations");
            Step::Call(function, operands as u32)
        }
    };
    steps.push(last);
}
