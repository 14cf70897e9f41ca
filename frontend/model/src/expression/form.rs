//! Forms: formulas without their numbers, as lists of steps in which each step comes after its operands.
//!
//! ```text
//! 2 * x + sin(2 * x)      step 0  multiply  number 0, x          a step that several others use is there once
//!                         step 1  multiply  number 1, x          numbers are not shared: each use is a number of its own,
//!                         step 2  sin       step 1               so that formulas that differ in numbers alone have one form
//!                         step 3  add       step 0, step 2
//! ```
//!
//! A form is canonical: steps stand in the order in which a walk from the result, operands from left to
//! right, finishes them; numbers and children are numbered in the order of the steps. However a formula was
//! written, equal graphs give equal forms. A form may have several values: the walk visits them in turn.

use glam::DVec3;
use jbt_ir::Domain;

use super::operand::Operand;
use super::operation::{self, Operation};
use crate::falloff::Falloff;
use crate::function::ANY;
use crate::number::{Number, NumberFormula, Step, Variable};

/// A formula without its numbers: what selects code.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub struct Form {
    /// Each operation, and the end of its operands in the list.
    steps: Vec<(Operation, u32)>,
    operands: Vec<Operand>,
    /// The values: one for a field, three for a point.
    pub results: Vec<Operand>,
    children: u32,
    numbers: u32,
    /// Whether it is 0 outside of a box.
    pub bounded: bool,
}

impl Form {
    /// The number of children that it reads.
    #[must_use]
    pub fn children(&self) -> usize {
        self.children as usize
    }

    /// The number of numbers, with the numbers of its box.
    #[must_use]
    pub fn numbers(&self) -> usize {
        self.numbers as usize + if self.bounded { 6 } else { 0 }
    }

    /// How many operations it has.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.steps.len()
    }

    /// Each operation with its operands, in order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (Operation, &[Operand])> {
        let mut first = 0;
        self.steps.iter().map(move |&(operation, end)| {
            let operands = &self.operands[first..end as usize];
            first = end as usize;
            (operation, operands)
        })
    }

    /// The falloffs that it calls.
    pub(crate) fn falloffs(&self) -> impl Iterator<Item = Falloff> {
        self.steps.iter().filter_map(|(operation, _)| operation.falloff())
    }

    /// Whether the value depends on the point other than through the children.
    pub fn asks_point(&self) -> bool {
        self.bounded || self.asks_coordinates()
    }

    /// Whether the formula itself reads coordinates.
    pub fn asks_coordinates(&self) -> bool {
        let coordinate = |operand: &Operand| matches!(operand, Operand::Coordinate(_));
        self.results.iter().any(coordinate) || self.operands.iter().any(coordinate)
    }

    /// The numbers of the box, from all numbers.
    pub fn box_numbers<'a, T>(&self, numbers: &'a [T]) -> Option<&'a [T]> {
        self.bounded.then(|| &numbers[self.numbers as usize..])
    }

    /// The numbers that something is divided by.
    pub(crate) fn divisors(&self) -> impl Iterator<Item = usize> {
        self.iter().filter_map(|(operation, operands)| {
            if let (Operation::Divide, [_, Operand::Number(number)]) = (operation, operands) {
                Some(*number as usize)
            } else {
                None
            }
        })
    }

    /// How often each step is used.
    pub(crate) fn uses(&self) -> Vec<u32> {
        let mut uses = vec![0; self.steps.len()];
        for operand in self.operands.iter().chain(&self.results) {
            if let Operand::Step(step) = operand {
                uses[*step as usize] += 1;
            }
        }
        uses
    }

    /// A property of the value, computed for each step from the same property of its operands.
    pub(crate) fn fold<T: Copy>(
        &self,
        leaf: impl FnMut(Operand) -> T,
        step: impl FnMut(Operation, &[Operand], &[T]) -> T,
    ) -> T {
        self.fold_all(leaf, step)[0]
    }

    /// The same property for all values.
    pub(crate) fn fold_all<T: Copy>(
        &self,
        mut leaf: impl FnMut(Operand) -> T,
        mut step: impl FnMut(Operation, &[Operand], &[T]) -> T,
    ) -> Vec<T> {
        let mut done: Vec<T> = Vec::with_capacity(self.steps.len());
        let mut arguments: Vec<T> = Vec::new();
        let mut of = |done: &[T], operand: Operand| match operand {
            Operand::Step(step) => done[step as usize],
            Operand::Coordinate(_) | Operand::Child(_) | Operand::Number(_) => leaf(operand),
        };
        for (operation, operands) in self.iter() {
            arguments.clear();
            arguments.extend(operands.iter().map(|&operand| of(&done, operand)));
            let value = step(operation, operands, &arguments);
            done.push(value);
        }
        self.results.iter().map(|&result| of(&done, result)).collect()
    }

    /// The first value, in f64.
    pub(super) fn value(&self, numbers: &[f64], p: DVec3, children: &[f64]) -> f64 {
        self.values(numbers, p, children)[0]
    }

    /// All values, in f64.
    pub(crate) fn values(&self, numbers: &[f64], p: DVec3, children: &[f64]) -> Vec<f64> {
        self.fold_all(|operand| leaf(operand, numbers, p, children), |operation, _, x| operation.value(x))
    }

    /// All values over the ops; `leaf` gives the values of coordinates, children and numbers.
    pub fn emit<D: Domain>(&self, d: &mut D, leaf: impl Fn(Operand) -> D::Real) -> Vec<D::Real> {
        // Each with whether it is known not to be negative, and whether it is a number of the row.
        let leaf = |operand| (leaf(operand), false, matches!(operand, Operand::Number(_)));
        let all = self.fold_all(leaf, |operation, operands, arguments| {
            let values: Vec<D::Real> = arguments.iter().map(|argument| argument.0).collect();
            let signs: Vec<bool> = arguments.iter().map(|argument| argument.1).collect();
            let numbers: Vec<bool> = arguments.iter().map(|argument| argument.2).collect();
            let value = operation.emit(d, &values, &signs, &numbers);
            (value, operation.non_negative(operands, &signs), false)
        });
        all.into_iter().map(|(value, ..)| value).collect()
    }

    /// The distance to the nearest jump or kink of an operation.
    pub(crate) fn kink_distance(&self, numbers: &[f64], p: DVec3, children: &[f64]) -> f64 {
        let mut nearest = f64::INFINITY;
        self.fold(
            |operand| leaf(operand, numbers, p, children),
            |operation, _, x| {
                nearest = nearest.min(operation.kink_distance(x));
                operation.value(x)
            },
        );
        nearest
    }

    /// Whether it is 0 where all children are 0, for any coordinates and for any value of the numbers that
    /// `known` does not give. Without children only the number 0 itself is.
    pub fn vanishes(&self, known: impl Fn(usize) -> Option<f64>) -> bool {
        let range = |operand| match operand {
            Operand::Child(_) => [0.0; 2],
            Operand::Number(number) => known(number as usize).map_or(ANY, |value| [value; 2]),
            Operand::Coordinate(_) | Operand::Step(_) => ANY,
        };
        let is_known = self.children > 0 || self.steps.is_empty();
        is_known && self.fold(range, |operation, _, ranges| operation.range(ranges)) == [0.0; 2]
    }

    /// Whether it is never negative, derived from the signs of children and numbers.
    pub fn non_negative(&self, children: &[bool], number: impl Fn(usize) -> bool) -> bool {
        let sign = |operand| match operand {
            Operand::Child(child) => children[child as usize],
            Operand::Number(index) => number(index as usize),
            Operand::Coordinate(_) | Operand::Step(_) => false,
        };
        self.fold(sign, Operation::non_negative)
    }
}

fn leaf(operand: Operand, numbers: &[f64], p: DVec3, children: &[f64]) -> f64 {
    match operand {
        Operand::Coordinate(axis) => p[axis as usize],
        Operand::Child(child) => children[child as usize],
        Operand::Number(number) => numbers[number as usize],
        Operand::Step(_) => f64::NAN,
    }
}

/// A part of a formula under construction.
#[derive(Clone, Debug)]
pub enum Draft {
    /// 0, 1, 2: x, y, z.
    Coordinate(u8),
    /// A child, by the name that its maker gave it.
    Child(u32),
    /// A number.
    Constant(Number),
    /// The value of an operation, by its place.
    Step(u32),
}

/// A formula that is complete.
#[derive(Debug)]
pub struct Assembled {
    pub(crate) form: Form,
    pub(crate) numbers: Vec<Number>,
    /// The names of the children, in the order of the form.
    pub children: Vec<u32>,
}

/// Makes forms.
#[derive(Default, Debug)]
pub struct Assembler {
    steps: Vec<(Operation, u32)>,
    operands: Vec<Draft>,
}

impl Assembler {
    /// How many operations there are so far.
    pub fn steps(&self) -> usize {
        self.steps.len()
    }

    /// The result of a postfix step on its operands. Constants give a constant.
    pub fn apply(&mut self, step: &Step, operands: Vec<Draft>) -> Draft {
        let constants: Option<Vec<&Number>> = operands
            .iter()
            .map(|operand| if let Draft::Constant(number) = operand { Some(number) } else { None })
            .collect();
        if let Some(constants) = constants {
            return Draft::Constant(Number::of_step(step.clone(), &constants));
        }
        let Some(operation) = Operation::of(step) else { unreachable!("leaves have no operands that vary") };
        self.push(operation, operands)
    }

    fn push(&mut self, operation: Operation, mut operands: Vec<Draft>) -> Draft {
        let mut operation = operation;
        if operation == Operation::Power
            && let Some(Draft::Constant(exponent)) = operands.get(1)
            && let Some(n) = operation::whole_exponent(exponent)
        {
            operation = Operation::Raise(n);
            operands.truncate(1);
        }
        self.operands.append(&mut operands);
        self.steps.push((operation, self.operands.len() as u32));
        Draft::Step(self.steps.len() as u32 - 1)
    }

    /// The value of a list of steps in postfix order; `definition` holds the values of earlier definitions.
    ///
    /// Steps that depend on no variable become one number, in time linear in the list.
    pub fn postfix(&mut self, steps: &[Step], definitions: &[Draft]) -> Draft {
        /// An operand: a number, whose steps begin here, or something else.
        enum StackEntry {
            Constant(usize),
            Varying(Draft),
        }
        let mut stack: Vec<(StackEntry, usize)> = Vec::new();
        let drafted = |(entry, end): (StackEntry, usize)| match entry {
            StackEntry::Varying(draft) => draft,
            StackEntry::Constant(first) => Draft::Constant(number(&steps[first..end])),
        };
        for (index, step) in steps.iter().enumerate() {
            let first = stack.len() - step.operands();
            let constant = stack[first..].iter().all(|(entry, _)| matches!(entry, StackEntry::Constant(_)));
            let entry = match step {
                Step::Variable(Variable::Coordinate(axis)) => StackEntry::Varying(Draft::Coordinate(*axis)),
                Step::Variable(Variable::Child(child)) => StackEntry::Varying(Draft::Child(*child)),
                Step::Variable(Variable::Definition(place)) => {
                    StackEntry::Varying(definitions[*place as usize].clone())
                }
                Step::Literal(_) | Step::Parameter { .. } => StackEntry::Constant(index),
                Step::Negate | Step::Binary(_) | Step::Call(..) if constant => match &stack[first].0 {
                    StackEntry::Constant(start) => StackEntry::Constant(*start),
                    StackEntry::Varying(_) => unreachable!("all are constant"),
                },
                Step::Negate | Step::Binary(_) | Step::Call(..) => {
                    let operands = stack.drain(first..).map(drafted).collect();
                    StackEntry::Varying(self.apply(step, operands))
                }
            };
            stack.truncate(first);
            stack.push((entry, index + 1));
        }
        stack.pop().map_or_else(|| Draft::Constant(f64::NAN.into()), drafted)
    }

    /// The formula with these values, of which there is at least one.
    pub fn finish(&self, results: &[Draft]) -> Assembled {
        let mut finish = Finish {
            source: self,
            names: vec![None; self.steps.len()],
            child_names: rustc_hash::FxHashMap::default(),
            steps: Vec::new(),
            operands: Vec::new(),
            numbers: Vec::new(),
            children: Vec::new(),
        };
        for result in results {
            finish.run(result);
        }
        let results = results.iter().map(|result| finish.operand(result)).collect();
        let form = Form {
            steps: finish.steps,
            operands: finish.operands,
            results,
            children: finish.children.len() as u32,
            numbers: finish.numbers.len() as u32,
            bounded: false,
        };
        Assembled { form, numbers: finish.numbers, children: finish.children }
    }

    /// The range of a step's operands in the list.
    fn range(&self, step: u32) -> std::ops::Range<usize> {
        let first = (step as usize).checked_sub(1).map_or(0, |before| self.steps[before].1);
        first as usize..self.steps[step as usize].1 as usize
    }
}

/// The number of steps without variables.
fn number(steps: &[Step]) -> Number {
    if let [Step::Literal(value)] = steps {
        return (*value).into();
    }
    let formula = NumberFormula::new(steps.to_vec(), None);
    let known = formula.parameters().map(|(name, value)| (name.clone(), value)).collect();
    let value = formula.evaluate(&known).unwrap_or(f64::NAN);
    Number::with_formula(value, formula)
}

/// The canonical order under construction.
struct Finish<'a> {
    source: &'a Assembler,
    names: Vec<Option<u32>>,
    child_names: rustc_hash::FxHashMap<u32, u32>,
    steps: Vec<(Operation, u32)>,
    operands: Vec<Operand>,
    numbers: Vec<Number>,
    children: Vec<u32>,
}

impl Finish<'_> {
    fn run(&mut self, result: &Draft) {
        let Draft::Step(root) = *result else { return };
        // Each step, and whether its operands were pushed above it.
        let mut stack = vec![(root, false)];
        while let Some((step, opened)) = stack.pop() {
            if self.names[step as usize].is_some() {
                continue;
            }
            let range = self.source.range(step);
            if !opened {
                stack.push((step, true));
                let below = self.source.operands[range].iter().rev();
                stack.extend(below.filter_map(|draft| match draft {
                    Draft::Step(step) => Some((*step, false)),
                    Draft::Coordinate(_) | Draft::Child(_) | Draft::Constant(_) => None,
                }));
                continue;
            }
            for index in range {
                let operand = self.operand(&self.source.operands[index]);
                self.operands.push(operand);
            }
            self.names[step as usize] = Some(self.steps.len() as u32);
            self.steps.push((self.source.steps[step as usize].0, self.operands.len() as u32));
        }
    }

    fn operand(&mut self, draft: &Draft) -> Operand {
        match draft {
            Draft::Coordinate(axis) => Operand::Coordinate(*axis),
            Draft::Child(child) => {
                let next = self.children.len() as u32;
                let name = *self.child_names.entry(*child).or_insert(next);
                if name == next {
                    self.children.push(*child);
                }
                Operand::Child(name)
            }
            Draft::Constant(number) => {
                self.numbers.push(number.clone());
                Operand::Number(self.numbers.len() as u32 - 1)
            }
            Draft::Step(step) => {
                Operand::Step(self.names[*step as usize].expect("operands are finished before their users"))
            }
        }
    }
}
