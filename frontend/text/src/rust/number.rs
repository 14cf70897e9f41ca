//! Numbers and formulas as Rust: operators and methods of `Number` and `Term`.

use std::collections::HashMap;

use jbt_model::expression::{Formula, FormulaSteps};
use jbt_model::falloff::Edge;
use jbt_model::field::{Field, FieldKind};
use jbt_model::function::Function;
use jbt_model::number::{Binary, Number, Step, Variable};
use jbt_model::written::{FieldNumber, WrittenFalloff};

use super::names::RustNames;

/// Parts of formulas longer than this become variables, so that no expression is too deep for a compiler.
const LONGEST: usize = 200;

/// Functions that are methods of `Number` and of `Term`.
const METHODS: [Function; 8] = [
    Function::Sqrt,
    Function::Sin,
    Function::Cos,
    Function::Abs,
    Function::Exp,
    Function::Ln,
    Function::Min,
    Function::Max,
];

/// Rust that is being printed: statements so far, and names.
pub(super) struct RustBody {
    pub(super) names: RustNames,
    /// The variables of parameters, by their names.
    pub(super) parameters: HashMap<String, String>,
    /// The parameters that somebody mentions.
    pub(super) mentioned: std::collections::BTreeSet<String>,
    pub(super) statements: String,
}

/// What a part of a formula is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum PartKind {
    /// A literal.
    Plain,
    /// A number that depends on parameters.
    Number,
    /// What depends on the point.
    Term,
}

/// A part of a formula in Rust.
struct RustPart {
    text: String,
    kind: PartKind,
    /// How strongly its outermost operator binds, as the operators' strengths.
    strength: u8,
    /// Whether it is a variable, which is lent where a value stands.
    is_variable: bool,
}

/// How strongly a minus sign binds, and a call.
const SIGN: u8 = 3;
const ATOM: u8 = 5;

impl RustPart {
    /// As an operand of an operator that needs this strength, or as an argument.
    fn operand(&self, least: u8) -> String {
        let lent = if self.is_variable { "&" } else { "" };
        if self.strength < least { format!("({})", self.text) } else { format!("{lent}{}", self.text) }
    }

    /// As what a method is called on.
    fn receiver(&self, of: &str) -> String {
        match self.kind {
            PartKind::Plain => format!("{of}::from({})", self.text),
            PartKind::Number if of == "Term" => format!("Term::from({})", self.operand(0)),
            PartKind::Number | PartKind::Term if self.strength < ATOM => format!("({})", self.text),
            PartKind::Number | PartKind::Term => self.text.clone(),
        }
    }

    /// As a value of its own of this type.
    fn owned(&self, of: &str) -> String {
        let is_owned = !self.is_variable && (self.kind == PartKind::Term) == (of == "Term");
        if is_owned && self.kind != PartKind::Plain {
            self.text.clone()
        } else {
            format!("{of}::from({})", self.operand(0))
        }
    }
}

/// A literal, which is an `f64`.
pub(super) fn literal(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { format!("f64::from_bits({})", value.to_bits()) }
}

/// A list in brackets.
pub(super) fn list(items: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", items.into_iter().collect::<Vec<_>>().join(", "))
}

impl RustBody {
    /// A number, wherever one is taken.
    pub(super) fn number(&mut self, number: &Number) -> String {
        if !number.depends_on_parameters() {
            return literal(number.value());
        }
        self.part(&number.steps(), &|_| String::new(), &[]).operand(0)
    }

    /// Numbers in an array: of `Number` if one depends on a parameter.
    pub(super) fn numbers<'a>(&mut self, numbers: impl IntoIterator<Item = &'a Number>) -> String {
        let numbers: Vec<&Number> = numbers.into_iter().collect();
        let depends = numbers.iter().any(|number| number.depends_on_parameters());
        let item = |number: &&Number| match depends {
            true => self.part(&number.steps(), &|_| String::new(), &[]).owned("Number"),
            false => literal(number.value()),
        };
        list(numbers.iter().map(item).collect::<Vec<_>>())
    }

    /// The arguments of a constructor, each with a comma behind it; lists of lengths and flags have methods.
    pub(super) fn arguments(&mut self, fields: &[Field], values: &[FieldNumber]) -> Vec<String> {
        let mut all = Vec::new();
        for (field, value) in fields.iter().zip(values) {
            let text = match (field.kind, value) {
                (FieldKind::Lengths | FieldKind::Flag, _) => continue,
                (FieldKind::Axis, FieldNumber::Vector(axis)) => {
                    let place = axis.iter().position(|x| x.value() != 0.0).unwrap_or(2);
                    ["Axis::X", "Axis::Y", "Axis::Z"][place].to_owned()
                }
                (FieldKind::Choice(words), FieldNumber::Real(number)) => {
                    choice(words.get(number.value() as usize).unwrap_or(&words[0]))
                }
                (FieldKind::Whole { .. }, FieldNumber::Real(number)) => format!("{}", number.value() as u32),
                (FieldKind::Rows, FieldNumber::Reals(numbers)) => {
                    let depends = numbers.iter().any(Number::depends_on_parameters);
                    let row = |row: &[Number]| match depends {
                        true => {
                            list(row.iter().map(|number| format!("Number::from({})", self.number(number))))
                        }
                        false => self.numbers(row),
                    };
                    list(numbers.chunks(4).map(row).collect::<Vec<_>>())
                }
                (_, FieldNumber::Real(number)) => self.number(number),
                (_, FieldNumber::Vector(numbers)) => self.numbers(numbers),
                (_, FieldNumber::Reals(numbers)) => self.numbers(numbers),
                (_, FieldNumber::Vectors(vectors)) => {
                    let depends = vectors.iter().flatten().any(Number::depends_on_parameters);
                    let item = |vector: &[Number; 3]| match depends {
                        true => format!("Vector::from({})", self.numbers(vector)),
                        false => self.numbers(vector),
                    };
                    list(vectors.iter().map(item).collect::<Vec<_>>())
                }
            };
            all.push(text);
        }
        all
    }

    /// A falloff.
    pub(super) fn falloff(&mut self, falloff: &WrittenFalloff) -> String {
        let kind = falloff.kind();
        if kind.fields().is_empty() {
            return format!("Falloff::{kind:?}");
        }
        format!("{}({})", kind.constructor(), self.arguments(kind.fields(), falloff.fields()).join(", "))
    }

    /// The values of a formula, and its parts as statements in front. `child` has the variables of trees.
    pub(super) fn formula(&mut self, formula: &Formula, child: &dyn Fn(usize) -> String) -> Vec<String> {
        let FormulaSteps { definitions, results } = FormulaSteps::new(&formula.form, &formula.numbers);
        let mut known = Vec::new();
        for steps in &definitions {
            let part = self.part(steps, child, &known);
            known.push(self.variable(&part));
        }
        results.iter().map(|steps| self.part(steps, child, &known).owned("Term")).collect()
    }

    /// A variable with a part of a formula.
    fn variable(&mut self, part: &RustPart) -> String {
        let name = self.names.numbered("t");
        self.statements.push_str(&format!("    let {name} = {};\n", part.owned("Term")));
        name
    }

    /// The value of steps.
    fn part(&mut self, steps: &[Step], child: &dyn Fn(usize) -> String, known: &[String]) -> RustPart {
        let mut stack: Vec<RustPart> = Vec::new();
        let part = |text: String, kind, strength| RustPart { text, kind, strength, is_variable: false };
        for step in steps {
            let operands = stack.split_off(stack.len().saturating_sub(operands_of(step)));
            let made = match step {
                Step::Literal(value) => {
                    part(literal(*value), PartKind::Plain, if value.is_sign_negative() { SIGN } else { ATOM })
                }
                Step::Parameter { name, .. } => {
                    self.mentioned.insert(name.to_string());
                    let text = self.parameters.get(&**name).cloned().unwrap_or_default();
                    RustPart { is_variable: true, ..part(text, PartKind::Number, ATOM) }
                }
                Step::Variable(Variable::Coordinate(axis)) => {
                    part(["x()", "y()", "z()"][usize::from(*axis)].to_owned(), PartKind::Term, ATOM)
                }
                Step::Variable(Variable::Child(index)) => {
                    part(format!("{}.field()", child(*index as usize)), PartKind::Term, ATOM)
                }
                Step::Variable(Variable::Definition(index)) => RustPart {
                    is_variable: true,
                    ..part(known[*index as usize].clone(), PartKind::Term, ATOM)
                },
                Step::Negate => part(format!("-{}", operands[0].operand(SIGN + 1)), kind_of(&operands), SIGN),
                Step::Binary(Binary::Power) => self.call("powf", &operands),
                Step::Binary(binary) => operator(*binary, &operands),
                Step::Call(function, _) => self.function(*function, &operands),
            };
            let is_long = made.text.len() > LONGEST && made.kind == PartKind::Term;
            stack.push(match is_long {
                true => {
                    let text = self.variable(&made);
                    RustPart { is_variable: true, ..part(text, PartKind::Term, ATOM) }
                }
                false => made,
            });
        }
        stack.pop().unwrap_or_else(|| part(literal(0.0), PartKind::Plain, ATOM))
    }

    /// A method of the first operand.
    fn call(&self, method: &str, operands: &[RustPart]) -> RustPart {
        let kind = kind_of(operands);
        let receiver = operands[0].receiver(type_of(kind));
        let arguments: Vec<String> = operands[1..].iter().map(|operand| operand.operand(0)).collect();
        let text = format!("{receiver}.{method}({})", arguments.join(", "));
        RustPart { text, kind, strength: ATOM, is_variable: false }
    }

    fn function(&mut self, function: Function, operands: &[RustPart]) -> RustPart {
        let kind = kind_of(operands);
        let of = type_of(kind);
        if METHODS.contains(&function) {
            return self.call(function.name(), operands);
        }
        let text = if let Function::Falloff(falloff) = function {
            let falloff = WrittenFalloff::from(falloff.falloff());
            let is_plain = falloff.fields().is_empty();
            let value = format!("{}{}", self.falloff(&falloff), if is_plain { "" } else { ".falloff()" });
            format!("{}.falloff({value})", operands[0].receiver(of))
        } else {
            let operands = list(operands.iter().map(|operand| operand.owned(of)));
            format!("{of}::of_function(Function::{function:?}, {operands})")
        };
        RustPart { text, kind, strength: ATOM, is_variable: false }
    }
}

/// The word of a choice in Rust: of sets or of edges.
fn choice(word: &str) -> String {
    let of = if Edge::WORDS.contains(&word) { "Edge" } else { "SetOperation" };
    let (first, rest) = word.split_at(1);
    format!("{of}::{}{rest}", first.to_uppercase())
}

fn kind_of(operands: &[RustPart]) -> PartKind {
    let has = |kind| operands.iter().any(|operand| operand.kind == kind);
    match (has(PartKind::Term), has(PartKind::Number)) {
        (true, _) => PartKind::Term,
        (false, true) => PartKind::Number,
        (false, false) => PartKind::Plain,
    }
}

fn type_of(kind: PartKind) -> &'static str {
    if kind == PartKind::Term { "Term" } else { "Number" }
}

fn operator(binary: Binary, operands: &[RustPart]) -> RustPart {
    let (sign, strength) = match binary {
        Binary::Add => ("+", 1),
        Binary::Subtract => ("-", 1),
        Binary::Multiply => ("*", 2),
        Binary::Divide => ("/", 2),
        Binary::Power => unreachable!("powers are methods"),
    };
    let text = format!("{} {sign} {}", operands[0].operand(strength), operands[1].operand(strength + 1));
    RustPart { text, kind: kind_of(operands), strength, is_variable: false }
}

fn operands_of(step: &Step) -> usize {
    match step {
        Step::Literal(_) | Step::Parameter { .. } | Step::Variable(_) => 0,
        Step::Negate => 1,
        Step::Binary(_) => 2,
        Step::Call(_, count) => *count as usize,
    }
}
