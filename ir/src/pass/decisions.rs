//! Adds the signature of the first output: which operands decided about it.
//!
//! A surface is sharp where one operand of a union, a mirror or a formula's `max` hands over to another one.
//! So ops that may do that are marked, by their [part](Part::Crease), and their outcomes are summed up along
//! the values that the output is made of:
//!
//! ```text
//! min, max      the signature of the operand that wins; a marked one adds its number where the first one wins
//! select        the same of the one that is chosen
//! abs, rounding a marked one adds its number where its operand is negative, or the whole number
//! sum           onto an accumulator: the sum of the signatures of operands that are not 0
//! other ops     the sum of the signatures of the operands
//! fold          its accumulators carry their signatures, 0 where rows of 0 may be left out and all are 0
//! ```
//!
//! The number of a marked op is made of its place in the function, and of the numbers of the rows around
//! it, so a union of rows tells which row wins. What is 0 or loses has no part in the signature. So rows
//! that may be left out in a box change nothing, and operands that are not rounded by a smooth union count
//! for nothing.
//!
//! A function without marked ops has no signature.

use smallvec::SmallVec;

use crate::builder::FunctionBuilder;
use crate::entity::{Entity, Table, Value};
use crate::function::{Fold, FoldKind, Function, InstData, InstKind, Rule};
use crate::op::{Domain, Op};
use crate::origin::{Origin, Part};
use crate::translate::{AccumulatorParts, Translation, translate};

/// The name of the output that the pass adds, behind the first one.
pub const SIGNATURE_OUTPUT: &str = "signature";

/// 1.5 * 2^23: subtracting it is the second half of rounding to a whole number.
const ROUND: f32 = 12_582_912.0;

/// Shifts to the left, whose result is added, and to the right, whose result is a difference: together they
/// stir all bits of a number.
const STIRS: [(u32, u32); 3] = [(10, 6), (3, 11), (15, 7)];

/// The first output and its signature, a number from 1 to 2; `None` if no marked op can decide about it.
#[must_use]
pub fn decisions(function: &Function) -> Option<Function> {
    let deciding = deciding(function);
    let traced = traced(function, &deciding);
    let &first = function.blocks[function.body].results.first()?;
    if !traced[first.index()] {
        return None;
    }
    let builder = FunctionBuilder::like(function);
    let mut accumulators = vec![false; function.values.len()];
    for block in function.blocks.values() {
        block.params.iter().for_each(|param| accumulators[param.index()] = true);
    }
    let mut tracing = Tracing { builder, function, deciding, traced, accumulators, rows: Vec::new() };
    let result = translate(function, &mut tracing)[0];
    let d = &mut tracing.builder;
    d.set_origin(Origin::SHARED);
    let signature = result.signature.unwrap_or_else(|| d.bits_constant(0));
    // The fraction alone, so that it is a number.
    let (mask, one) = (d.bits_constant(0x007f_ffff), d.bits_constant(0x3f80_0000));
    let fraction = d.bit_and(signature, mask);
    let bits = d.bit_or(fraction, one);
    let number = d.from_bits(bits);
    let outputs = [(function.outputs[0].clone(), result.value), (SIGNATURE_OUTPUT.to_owned(), number)];
    Some(tracing.builder.finish(&outputs))
}

/// For each value, whether a marked op that decides computes it.
fn deciding(function: &Function) -> Vec<bool> {
    let mut halves = vec![false; function.values.len()];
    let mut deciding = vec![false; function.values.len()];
    for inst in function.insts.values() {
        if matches!(inst.kind, InstKind::Constant(number) if number.to_bits() == ROUND.to_bits()) {
            halves[inst.results[0].index()] = true;
        }
    }
    for inst in function.insts.values() {
        let InstKind::Op { op, args } = &inst.kind else { continue };
        let decides = match op {
            Op::Min | Op::Max | Op::Select | Op::Abs => true,
            Op::Sub => halves[args[1].index()],
            _ => false,
        };
        deciding[inst.results[0].index()] = decides && inst.origin.part == Part::Crease;
    }
    deciding
}

/// The values that have a signature. Accumulators need a fixed point: what the body makes of one decides.
fn traced(function: &Function, deciding: &[bool]) -> Vec<bool> {
    let mut traced = vec![false; function.values.len()];
    if !deciding.contains(&true) {
        return traced;
    }
    loop {
        let before = traced.iter().filter(|&&traced| traced).count();
        for inst in function.insts.values() {
            crate::watch::look();
            match &inst.kind {
                InstKind::Input(_)
                | InstKind::Constant(_)
                | InstKind::BitsConstant(_)
                | InstKind::Column { .. } => {}
                InstKind::Op { op, args } => {
                    let any = args.iter().any(|arg| traced[arg.index()]);
                    let result = inst.results[0].index();
                    traced[result] = deciding[result] || any && passes_on(*op, inst.origin);
                }
                InstKind::Fold(fold) => {
                    let body = &function.blocks[fold.body];
                    for (place, result) in inst.results.iter().enumerate() {
                        let any = traced[fold.initial[place].index()] || traced[body.results[place].index()];
                        traced[body.params[place].index()] |= any;
                        traced[result.index()] |= any;
                    }
                }
            }
        }
        if traced.iter().filter(|&&traced| traced).count() == before {
            return traced;
        }
    }
}

/// Whether the result of an op has the signatures of its operands. A scale that cancels has none; truth
/// values have none, because the values that they choose tell more.
fn passes_on(op: Op, origin: Origin) -> bool {
    match op {
        Op::StopGradient => origin.part == Part::Crease,
        Op::Lt | Op::Le | Op::Eq | Op::Both | Op::Either | Op::Not => false,
        _ => true,
    }
}

/// A value of the new function, and its signature as bits.
#[derive(Clone, Copy)]
struct Traced {
    value: Value,
    signature: Option<Value>,
}

/// The translation into values with signatures.
struct Tracing<'a> {
    function: &'a Function,
    /// For each value, whether a marked op that decides computes it.
    deciding: Vec<bool>,
    /// For each value, whether it has a signature.
    traced: Vec<bool>,
    /// For each value, whether it is an accumulator of a fold.
    accumulators: Vec<bool>,
    builder: FunctionBuilder,
    /// For each open fold over several rows, a number of its row and of those around it.
    rows: Vec<Value>,
}

impl Tracing<'_> {
    /// Stirs bits, so that sums of them tell what they are sums of.
    fn stirred(&mut self, mut bits: Value, stirs: &[(u32, u32)]) -> Value {
        let d = &mut self.builder;
        for &(left, right) in stirs {
            let (left, right) = (d.bits_constant(left), d.bits_constant(right));
            let shifted = d.shl(bits, left);
            bits = d.int_add(bits, shifted);
            let shifted = d.shr(bits, right);
            bits = d.bit_xor(bits, shifted);
        }
        bits
    }

    /// A number of the row in the fold that has just begun, and of the rows around it, made of all that is in
    /// them. Marked ops share it: there may be dozens, as there may be columns.
    fn row_number(&mut self, table: Table) -> Value {
        let mut number = self.rows.last().copied().unwrap_or_else(|| self.builder.bits_constant(0));
        for column in 0..self.function.tables[table].columns.len() {
            let value = self.builder.column(table, column);
            let bits = self.builder.to_bits(value);
            number = self.builder.int_add(number, bits);
            number = self.stirred(number, &STIRS[..1]);
        }
        number
    }

    /// The number of a marked op.
    fn number(&mut self, inst: &InstData) -> Value {
        // No place has the number 0, which nothing has that decides.
        let place = inst.results[0].index() as u32;
        let mut number = self.builder.bits_constant(place.wrapping_mul(0x9e37_79b9).wrapping_add(1));
        if let Some(&row) = self.rows.last() {
            number = self.builder.int_add(number, row);
        }
        self.stirred(number, &STIRS)
    }

    fn sum(&mut self, a: Option<Value>, b: Option<Value>) -> Option<Value> {
        match (a, b) {
            (Some(a), Some(b)) => Some(self.builder.int_add(a, b)),
            (one, None) | (None, one) => one,
        }
    }

    /// One of two signatures.
    fn either(&mut self, first: Value, [a, b]: [Option<Value>; 2]) -> Option<Value> {
        if a == b {
            return a;
        }
        let d = &mut self.builder;
        let none = d.bits_constant(0);
        let [a, b] = [a, b].map(|signature| d.from_bits(signature.unwrap_or(none)));
        let chosen = d.select(first, a, b);
        Some(d.to_bits(chosen))
    }

    /// Whether an op adds a row to an accumulator.
    fn accumulates(&self, inst: &InstData) -> bool {
        matches!(&inst.kind, InstKind::Op { args, .. } if args.iter().any(|arg| self.accumulators[arg.index()]))
    }

    /// The signature of a real, or none where it is 0.
    fn counted(&mut self, Traced { value, signature }: Traced) -> Option<Value> {
        signature?;
        let zero = self.builder.constant(0.0);
        let nothing = self.builder.eq(value, zero);
        self.either(nothing, [None, signature])
    }

    /// The signature of an extreme: whether the first operand wins, and that of the winner.
    fn winner(&mut self, inst: &InstData, first: Value, args: &[Traced], marked: bool) -> Option<Value> {
        let [mut a, b] = [args[0].signature, args[1].signature];
        if marked {
            let number = self.number(inst);
            a = self.sum(a, Some(number));
        }
        self.either(first, [a, b])
    }

    fn signature(&mut self, inst: &InstData, op: Op, args: &[Traced]) -> Option<Value> {
        let result = inst.results[0].index();
        let marked = self.deciding[result];
        if !self.traced[result] {
            return None;
        }
        match op {
            Op::Max | Op::Min => {
                let [a, b] = [args[0].value, args[1].value];
                let first = if op == Op::Max { self.builder.lt(b, a) } else { self.builder.lt(a, b) };
                self.winner(inst, first, args, marked)
            }
            Op::Select => self.winner(inst, args[0].value, &args[1..], marked),
            Op::Abs if marked => {
                let zero = self.builder.constant(0.0);
                let negative = self.builder.lt(args[0].value, zero);
                let number = self.number(inst);
                let flipped = self.sum(args[0].signature, Some(number));
                self.either(negative, [flipped, args[0].signature])
            }
            Op::Sub if marked => {
                let (number, shifted) = (self.number(inst), self.builder.to_bits(args[0].value));
                let outcome = self.builder.int_add(number, shifted);
                Some(self.stirred(outcome, &STIRS))
            }
            Op::Add if self.accumulates(inst) => {
                let [a, b] = [args[0], args[1]].map(|operand| self.counted(operand));
                self.sum(a, b)
            }
            Op::Fma if self.accumulates(inst) => {
                let c = self.counted(args[2]);
                let product = self.sum(args[0].signature, args[1].signature);
                let product = product.map(|signature| {
                    let value = self.builder.mul(args[0].value, args[1].value);
                    self.counted(Traced { value, signature: Some(signature) })
                });
                self.sum(product.flatten(), c)
            }
            _ => args.iter().fold(None, |sum, arg| self.sum(sum, arg.signature)),
        }
    }
}

impl Translation for Tracing<'_> {
    type Value = Traced;
    type Part = Value;

    fn begin(&mut self, origin: Origin) {
        self.builder.set_origin(origin);
    }

    fn input(&mut self, index: usize) -> Traced {
        Traced { value: self.builder.input(index), signature: None }
    }

    fn constant(&mut self, number: f32) -> Traced {
        Traced { value: self.builder.constant(number), signature: None }
    }

    fn bits_constant(&mut self, bits: u32) -> Traced {
        Traced { value: self.builder.bits_constant(bits), signature: None }
    }

    fn column(&mut self, table: Table, column: usize) -> Traced {
        Traced { value: self.builder.column(table, column), signature: None }
    }

    fn op(&mut self, inst: &InstData, op: Op, args: &[Traced]) -> Traced {
        let values: SmallVec<[Value; 3]> = args.iter().map(|arg| arg.value).collect();
        let value = self.builder.op(op, &values);
        self.builder.keep_distance(value, inst.origin);
        Traced { value, signature: self.signature(inst, op, args) }
    }

    fn split(&mut self, value: Traced, accumulator: Value, parts: &mut AccumulatorParts<Value>) {
        parts.push(value.value);
        if self.traced[accumulator.index()] {
            parts.push(value.signature.unwrap_or_else(|| self.builder.bits_constant(0)));
        }
    }

    fn whole(&mut self, accumulator: Value, mut next: impl FnMut() -> Value) -> Traced {
        let value = next();
        Traced { value, signature: self.traced[accumulator.index()].then(next) }
    }

    fn enter(&mut self, fold: &Fold, _: usize, initial: AccumulatorParts<Value>) -> AccumulatorParts<Value> {
        let params = self.builder.begin_fold(fold.table, (fold.kind, fold.rule), &initial).into();
        if fold.kind != FoldKind::Guard {
            let number = self.row_number(fold.table);
            self.rows.push(number);
        }
        params
    }

    fn leave(
        &mut self,
        fold: &Fold,
        origin: Origin,
        next: AccumulatorParts<Value>,
    ) -> AccumulatorParts<Value> {
        if fold.kind != FoldKind::Guard {
            self.rows.pop();
        }
        self.builder.set_origin(origin);
        let mut results: AccumulatorParts<Value> = self.builder.end_fold(&next).into();
        // Elsewhere a 0 may be on the surface.
        if matches!(fold.rule, Rule::Neutral | Rule::OnlyZero) {
            let mut place = 0;
            for &param in &self.function.blocks[fold.body].params {
                let signed = self.traced[param.index()];
                if signed && self.function.values[param] == crate::op::Type::Real {
                    let whole = Traced { value: results[place], signature: Some(results[place + 1]) };
                    if let Some(counted) = self.counted(whole) {
                        results[place + 1] = counted;
                    }
                }
                place += 1 + usize::from(signed);
            }
        }
        results
    }
}
