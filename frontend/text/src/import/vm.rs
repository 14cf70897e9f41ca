//! Programs of implicit surfaces (`.vm`): one instruction a line, as fidget and libfive's tools write and
//! read them.
//!
//! ```text
//! # a slab
//! _0 var-x
//! _1 square _0            name, operation, operands: names of lines before
//! _2 const 0.25
//! _3 sub _1 _2            the last line is the value: negative inside
//! ```
//!
//! The model has the usual iso-value, 1/2, and its field is `1/2 - value`. So `field >= iso` exactly where
//! `value <= 0`, and the surface is the same.
//!
//! Minima and maxima on the way from the value down, through minus signs, become unions and intersections of
//! formulas, `1/2 - min(a, b) = max(1/2 - a, 1/2 - b)`. So operands that do not decide in a box can be left
//! out there, and formulas of one form are rows of one table. Parts that several formulas share are written
//! again in each; if that would make the program more than [`LONGEST`] times as long, all of it becomes one
//! formula instead.
//!
//! Undefined operations have the values of [`expression`](crate::expression): a quotient by 0 is 0, the root
//! of a negative number is 0.

use std::collections::HashMap;

use jbt_ir::limits::MAX_SCENE_BYTES;

use super::Imported;
use super::format::{SceneFormatRow, first_line};
use jbt_model::combine::{Combinator, Intersection, Union};
use jbt_model::diagnostic::{Diagnostic, Diagnostics, Span};
use jbt_model::expression::{Assembler, Draft, Formula};
use jbt_model::function::Function;
use jbt_model::model::Model;
use jbt_model::number::{Binary, Number, Step};
use jbt_model::report::{Report, clip, nearest};
use jbt_model::tree::Tree;
use jbt_model::written::Written;

/// How much longer a program may become by being split.
const LONGEST: usize = 4;
/// What has fewer operations is not split: a row, and what is around it, takes about as long as this many.
const SMALLEST: u32 = 96;

/// What an instruction does.
#[derive(Clone, Copy, PartialEq, Debug)]
enum VmOp {
    Coordinate(u8),
    Constant(f64),
    Negate,
    Binary(Binary),
    Call(Function),
    Reciprocal,
    /// -1, 0 or 1, if the first is below, at or above the second.
    Compare,
    /// 1 if the operand is 0, else 0.
    Not,
    /// The second if the first is not 0, else 0.
    And,
    /// The first if it is not 0, else the second.
    Or,
}

/// The operations that have operands.
const CODES: &[(&str, VmOp, usize)] = &[
    ("neg", VmOp::Negate, 1),
    ("abs", VmOp::Call(Function::Abs), 1),
    ("recip", VmOp::Reciprocal, 1),
    ("sqrt", VmOp::Call(Function::Sqrt), 1),
    ("square", VmOp::Call(Function::Square), 1),
    ("floor", VmOp::Call(Function::Floor), 1),
    ("ceil", VmOp::Call(Function::Ceil), 1),
    ("round", VmOp::Call(Function::Round), 1),
    ("sin", VmOp::Call(Function::Sin), 1),
    ("cos", VmOp::Call(Function::Cos), 1),
    ("tan", VmOp::Call(Function::Tan), 1),
    ("asin", VmOp::Call(Function::Asin), 1),
    ("acos", VmOp::Call(Function::Acos), 1),
    ("atan", VmOp::Call(Function::Atan), 1),
    ("exp", VmOp::Call(Function::Exp), 1),
    ("ln", VmOp::Call(Function::Ln), 1),
    ("log", VmOp::Call(Function::Ln), 1),
    ("not", VmOp::Not, 1),
    ("add", VmOp::Binary(Binary::Add), 2),
    ("sub", VmOp::Binary(Binary::Subtract), 2),
    ("mul", VmOp::Binary(Binary::Multiply), 2),
    ("div", VmOp::Binary(Binary::Divide), 2),
    ("pow", VmOp::Binary(Binary::Power), 2),
    ("min", VmOp::Call(Function::Min), 2),
    ("max", VmOp::Call(Function::Max), 2),
    ("mod", VmOp::Call(Function::Mod), 2),
    ("atan2", VmOp::Call(Function::Atan2), 2),
    ("compare", VmOp::Compare, 2),
    ("and", VmOp::And, 2),
    ("or", VmOp::Or, 2),
];

/// The operations without operands.
const LEAVES: [&str; 4] = ["const", "var-x", "var-y", "var-z"];

/// A line with an instruction.
#[derive(Clone, Copy, Debug)]
struct Instruction {
    code: VmOp,
    operands: [u32; 2],
    count: usize,
    span: Span,
}

impl Instruction {
    fn operands(&self) -> &[u32] {
        &self.operands[..self.count]
    }
}

/// Instructions have names that begin with an underscore as a rule; no other text begins with one.
pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow {
    recognizes: |bytes| first_line(bytes).starts_with(b"_"),
    ..SceneFormatRow::new(&["vm"], "a program of instructions", |bytes, _| vm(bytes))
};

/// The model of a program (`.vm`).
///
/// # Errors
///
/// All errors of the file, with their places: unknown operations and names, missing operands, unreadable
/// numbers, names that are defined twice, and a file without instructions.
pub fn vm(bytes: &[u8]) -> Result<Imported, Diagnostics> {
    Imported::from(bytes, read(bytes))
}

fn read(bytes: &[u8]) -> Result<(Model, Vec<Diagnostic>), Vec<Diagnostic>> {
    if bytes.len() > MAX_SCENE_BYTES {
        let message = format!("the file has {} bytes; at most {MAX_SCENE_BYTES} are read", bytes.len());
        return Err(vec![Diagnostic::limit(None, message)]);
    }
    let mut reader = Reader { names: HashMap::new(), instructions: Vec::new(), report: Report::default() };
    let mut start = 0;
    for line in bytes.split(|byte| matches!(byte, b'\n' | b'\r')) {
        reader.line(line, start);
        start += line.len() + 1;
    }
    if reader.instructions.is_empty() && reader.report.is_empty() {
        let end = Span::new(bytes.len(), bytes.len());
        let error = Diagnostic::error(Some(end), "the file has no instruction");
        reader.report.add(|| error.expected("expected a line like: _0 var-x"));
    }
    if !reader.report.is_empty() {
        return Err(reader.report.finish());
    }
    let program = VmProgram { instructions: reader.instructions, iso: Model::DEFAULT_ISO.into() };
    Ok((Model::new(program.tree()), Vec::new()))
}

struct Reader<'a> {
    names: HashMap<&'a [u8], u32>,
    instructions: Vec<Instruction>,
    report: Report,
}

impl<'a> Reader<'a> {
    /// A line, which begins at this byte.
    fn line(&mut self, line: &'a [u8], start: usize) {
        let line = line.split(|&byte| byte == b'#').next().unwrap_or_default();
        let mut words = Vec::new();
        let mut at = 0;
        // One word more than any instruction takes is enough to report too many.
        for word in line.split(u8::is_ascii_whitespace) {
            if !word.is_empty() && words.len() < 5 {
                words.push((word, Span::new(start + at, start + at + word.len())));
            }
            at += word.len() + 1;
        }
        let Some(&(name, span)) = words.first() else { return };
        let end = words[words.len() - 1].1.end;
        let instruction = self.instruction(&words, Span { start: span.start, end });
        // A line with an error still defines its name, so that uses of the name are no further errors.
        let instruction = instruction.unwrap_or(Instruction {
            code: VmOp::Constant(0.0),
            operands: [0; 2],
            count: 0,
            span,
        });
        if self.names.insert(name, self.instructions.len() as u32).is_some() {
            let shown = shown(name);
            self.report.add(|| Diagnostic::error(Some(span), format!("a second line is called `{shown}`")));
        }
        self.instructions.push(instruction);
    }

    fn instruction(&mut self, words: &[(&'a [u8], Span)], span: Span) -> Option<Instruction> {
        let Some(&(operation, at)) = words.get(1) else {
            self.report.add(|| {
                Diagnostic::error(Some(span), "an operation is missing")
                    .expected("expected a name, an operation and its operands")
            });
            return None;
        };
        let plain = |code| Instruction { code, operands: [0; 2], count: 0, span };
        let (instruction, count) = match operation {
            b"var-x" => (plain(VmOp::Coordinate(0)), 0),
            b"var-y" => (plain(VmOp::Coordinate(1)), 0),
            b"var-z" => (plain(VmOp::Coordinate(2)), 0),
            b"const" => (plain(VmOp::Constant(0.0)), 1),
            _ => {
                let known = CODES.iter().find(|(name, ..)| name.as_bytes() == operation);
                let Some(&(_, code, count)) = known else {
                    self.unknown(operation, at);
                    return None;
                };
                (Instruction { count, ..plain(code) }, count)
            }
        };
        let found = words.len() - 2;
        if found != count {
            let operation = shown(operation);
            self.report.add(|| {
                let plural = if count == 1 { "" } else { "s" };
                Diagnostic::error(Some(span), format!("`{operation}` has {found} operands"))
                    .expected(format!("expected {count} operand{plural}"))
            });
            return None;
        }
        if operation == b"const" {
            return self.constant(words[2]).map(|value| plain(VmOp::Constant(value)));
        }
        self.operands(instruction, &words[2..])
    }

    fn constant(&mut self, (word, span): (&[u8], Span)) -> Option<f64> {
        let value = std::str::from_utf8(word).ok().and_then(|word| word.parse::<f64>().ok());
        let value = value.filter(|value| value.is_finite());
        if value.is_none() {
            let shown = shown(word);
            self.report.add(|| {
                Diagnostic::error(Some(span), format!("`{shown}` is no finite number"))
                    .expected("expected a number")
            });
        }
        value
    }

    fn operands(&mut self, mut instruction: Instruction, words: &[(&'a [u8], Span)]) -> Option<Instruction> {
        for (place, &(word, span)) in words.iter().enumerate() {
            let Some(&known) = self.names.get(word) else {
                let shown = shown(word);
                self.report
                    .add(|| Diagnostic::error(Some(span), format!("no line above is called `{shown}`")));
                return None;
            };
            instruction.operands[place] = known;
        }
        Some(instruction)
    }

    fn unknown(&mut self, operation: &[u8], at: Span) {
        let shown = shown(operation);
        self.report.add(|| {
            let error = Diagnostic::error(Some(at), format!("there is no operation `{shown}`"));
            let known = CODES.iter().map(|(name, ..)| *name).chain(LEAVES);
            match nearest(&shown, known) {
                Some(near) => error.expected(format!("perhaps `{near}`")),
                None => error,
            }
        });
    }
}

/// A word of the file, for a message.
fn shown(word: &[u8]) -> String {
    clip(&String::from_utf8_lossy(word))
}

/// A program without errors.
struct VmProgram {
    instructions: Vec<Instruction>,
    iso: Number,
}

/// A field to build: the iso-value plus or minus the value of this line.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
struct WantedField {
    line: u32,
    negative: bool,
}

/// How a wanted field is built.
enum FieldSplit {
    Same(WantedField),
    Combine(Combinator, [WantedField; 2]),
    Leaf,
}

impl VmProgram {
    /// The tree of `iso - value`.
    fn tree(&self) -> Tree {
        let root = WantedField { line: self.instructions.len() as u32 - 1, negative: true };
        self.split(root).unwrap_or_else(|| self.leaf(root, usize::MAX).0)
    }

    fn parts(&self, WantedField { line, negative }: WantedField) -> FieldSplit {
        let instruction = &self.instructions[line as usize];
        let [a, b] = instruction.operands;
        let both = [a, b].map(|line| WantedField { line, negative });
        match instruction.code {
            VmOp::Negate => FieldSplit::Same(WantedField { line: a, negative: !negative }),
            VmOp::Call(Function::Min) if negative => FieldSplit::Combine(Union {}.into(), both),
            VmOp::Call(Function::Min) => FieldSplit::Combine(Intersection {}.into(), both),
            VmOp::Call(Function::Max) if negative => FieldSplit::Combine(Intersection {}.into(), both),
            VmOp::Call(Function::Max) => FieldSplit::Combine(Union {}.into(), both),
            VmOp::Coordinate(_)
            | VmOp::Constant(_)
            | VmOp::Binary(_)
            | VmOp::Call(_)
            | VmOp::Reciprocal
            | VmOp::Compare
            | VmOp::Not
            | VmOp::And
            | VmOp::Or => FieldSplit::Leaf,
        }
    }

    /// A tree of unions and intersections of formulas; `None` if these are too long together.
    fn split(&self, root: WantedField) -> Option<Tree> {
        let mut left = LONGEST * self.instructions.len();
        let sizes = self.sizes();
        let mut done: HashMap<WantedField, Tree> = HashMap::new();
        let mut stack = vec![(root, false)];
        while let Some((wanted, opened)) = stack.pop() {
            if done.contains_key(&wanted) {
                continue;
            }
            let parts =
                if sizes[wanted.line as usize] < SMALLEST { FieldSplit::Leaf } else { self.parts(wanted) };
            let tree = match parts {
                FieldSplit::Leaf => {
                    let (tree, steps) = self.leaf(wanted, left);
                    left = left.checked_sub(steps)?;
                    tree
                }
                FieldSplit::Same(other) if opened => done[&other].clone(),
                FieldSplit::Combine(combinator, parts) if opened => {
                    let children = parts.iter().map(|part| done[part].clone()).collect();
                    let span = self.instructions[wanted.line as usize].span;
                    Tree::at(span, combinator, children)
                }
                FieldSplit::Same(other) => {
                    stack.extend([(wanted, true), (other, false)]);
                    continue;
                }
                FieldSplit::Combine(_, [a, b]) => {
                    stack.extend([(wanted, true), (b, false), (a, false)]);
                    continue;
                }
            };
            done.insert(wanted, tree);
        }
        done.remove(&root)
    }

    /// A lower bound of the operations behind each line: shared parts count for each use.
    fn sizes(&self) -> Vec<u32> {
        let mut sizes: Vec<u32> = Vec::with_capacity(self.instructions.len());
        for instruction in &self.instructions {
            let below = instruction.operands().iter().map(|&line| sizes[line as usize]);
            sizes.push(below.fold(1, u32::saturating_add));
        }
        sizes
    }

    /// One formula, and its number of operations; the count may stop beyond `most`.
    fn leaf(&self, wanted: WantedField, most: usize) -> (Tree, usize) {
        let mut assembler = Assembler::default();
        let value = self.draft(&mut assembler, wanted.line, most);
        let sign = if wanted.negative { Binary::Subtract } else { Binary::Add };
        let field = assembler.apply(&Step::Binary(sign), vec![Draft::Constant(self.iso.clone()), value]);
        let steps = assembler.steps();
        let written = Written::Expression(Formula::new(assembler.finish(&[field]), None));
        let span = self.instructions[wanted.line as usize].span;
        (Tree::at(span, written, Vec::new()), steps)
    }

    /// The value of a line.
    fn draft(&self, assembler: &mut Assembler, line: u32, most: usize) -> Draft {
        let mut done: HashMap<u32, Draft> = HashMap::new();
        let mut stack = vec![(line, false)];
        while let Some((line, opened)) = stack.pop() {
            if done.contains_key(&line) {
                continue;
            }
            let instruction = &self.instructions[line as usize];
            if !opened && instruction.count > 0 {
                stack.push((line, true));
                stack.extend(instruction.operands().iter().rev().map(|&operand| (operand, false)));
                continue;
            }
            if assembler.steps() > most {
                return Draft::Constant(0.0.into());
            }
            let operands = instruction.operands().iter().map(|operand| done[operand].clone()).collect();
            done.insert(line, step(assembler, instruction.code, operands));
        }
        done[&line].clone()
    }
}

/// The result of an instruction on its operands.
fn step(assembler: &mut Assembler, code: VmOp, operands: Vec<Draft>) -> Draft {
    let one = || Draft::Constant(1.0.into());
    let binary = |assembler: &mut Assembler, binary, a: Draft, b: Draft| {
        assembler.apply(&Step::Binary(binary), vec![a, b])
    };
    // 1 where it is not 0.
    let truth = |assembler: &mut Assembler, a: Draft| {
        let sign = assembler.apply(&Step::Call(Function::Sign, 1), vec![a]);
        assembler.apply(&Step::Call(Function::Abs, 1), vec![sign])
    };
    let operand = |place: usize| operands[place].clone();
    match code {
        VmOp::Coordinate(axis) => Draft::Coordinate(axis),
        VmOp::Constant(value) => Draft::Constant(value.into()),
        VmOp::Negate => assembler.apply(&Step::Negate, operands),
        VmOp::Binary(binary) => assembler.apply(&Step::Binary(binary), operands),
        VmOp::Call(function) => assembler.apply(&Step::Call(function, operands.len() as u32), operands),
        VmOp::Reciprocal => binary(assembler, Binary::Divide, one(), operand(0)),
        VmOp::Compare => {
            let difference = binary(assembler, Binary::Subtract, operand(0), operand(1));
            assembler.apply(&Step::Call(Function::Sign, 1), vec![difference])
        }
        VmOp::Not => {
            let truth = truth(assembler, operand(0));
            binary(assembler, Binary::Subtract, one(), truth)
        }
        VmOp::And => {
            let truth = truth(assembler, operand(0));
            binary(assembler, Binary::Multiply, truth, operand(1))
        }
        VmOp::Or => {
            let truth = truth(assembler, operand(0));
            let not = binary(assembler, Binary::Subtract, one(), truth);
            let other = binary(assembler, Binary::Multiply, not, operand(1));
            binary(assembler, Binary::Add, operand(0), other)
        }
    }
}
