//! How a formula's value follows the fields of its children: `dF/df_i` for all of them, in one walk back over
//! its ops (Linnainmaa 1970).
//!
//! ```text
//! forward    each op that the formula emits goes on a tape
//! backward   dF/dF = 1; an op r = op(a, b) adds dF/dr dr/da to dF/da, and dF/dr dr/db to dF/db
//! ```
//!
//! This is for the weights that mix attributes, `max(0, f_i dF/df_i)`. Time is linear in the formula, however
//! many children it has. The gradient in space is another matter, and that of a pass.

use rustc_hash::FxHashMap as HashMap;

use jbt_ir::{Domain, FunctionBuilder, Op, Value};

/// Emits ops and remembers them.
pub(super) struct Tape<'a> {
    builder: &'a mut FunctionBuilder,
    ops: Option<Vec<Entry>>,
}

/// An op that was emitted: unused operands repeat the first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    op: Op,
    args: [Value; 3],
    result: Value,
}

impl<'a> Tape<'a> {
    /// A tape; one that does not `record` emits alone.
    pub(super) fn new(builder: &'a mut FunctionBuilder, record: bool) -> Self {
        Self { builder, ops: record.then(Vec::new) }
    }

    /// What was recorded.
    pub(super) fn finish(self) -> Vec<Entry> {
        self.ops.unwrap_or_default()
    }

    fn op(&mut self, op: Op, args: &[Value]) -> Value {
        let result = self.builder.op(op, args);
        if let Some(ops) = &mut self.ops {
            let arg = |place: usize| args.get(place).copied().unwrap_or(args[0]);
            ops.push(Entry { op, args: [arg(0), arg(1), arg(2)], result });
        }
        result
    }
}

/// The slopes of `value` along each of `fields`.
pub(super) fn slopes(d: &mut FunctionBuilder, tape: &[Entry], value: Value, fields: &[Value]) -> Vec<Value> {
    let (zero, one) = (d.constant(0.0), d.constant(1.0));
    let mut slopes: HashMap<Value, Value> = HashMap::from_iter([(value, one)]);
    let mut seen = rustc_hash::FxHashSet::default();
    // An op that was emitted before is there already, and its entry stands first of the equal ones.
    let first: Vec<Entry> = tape.iter().copied().filter(|entry| seen.insert(entry.result)).collect();
    for entry in first.iter().rev() {
        // A child, or a number, may be the result of nothing on the tape; then it is where the walk ends.
        let Some(&slope) = slopes.get(&entry.result) else { continue };
        if fields.contains(&entry.result) {
            continue;
        }
        back(d, entry, slope, &mut slopes);
    }
    fields.iter().map(|field| slopes.get(field).copied().unwrap_or(zero)).collect()
}

/// Hands the slope of an op's result back to its operands.
fn back(d: &mut FunctionBuilder, entry: &Entry, slope: Value, slopes: &mut HashMap<Value, Value>) {
    let &Entry { op, args: [a, b, c], result } = entry;
    let (zero, one) = (d.constant(0.0), d.constant(1.0));
    let mut add = |d: &mut FunctionBuilder, to: Value, part: Value| {
        if !d.is_uniform(to) {
            let sum = slopes.get(&to).map_or(part, |&sum| d.add(sum, part));
            slopes.insert(to, sum);
        }
    };
    match op {
        Op::Add => {
            add(d, a, slope);
            add(d, b, slope);
        }
        Op::Sub => {
            add(d, a, slope);
            let minus = d.neg(slope);
            add(d, b, minus);
        }
        Op::Mul | Op::Fma => {
            let (left, right) = (d.mul(slope, b), d.mul(slope, a));
            add(d, a, left);
            add(d, b, right);
            if op == Op::Fma {
                add(d, c, slope);
            }
        }
        Op::Div => {
            let left = d.div(slope, b);
            add(d, a, left);
            let right = d.mul(left, result);
            let right = d.neg(right);
            add(d, b, right);
        }
        Op::Neg => {
            let minus = d.neg(slope);
            add(d, a, minus);
        }
        Op::Abs => {
            let (minus, negative) = (d.neg(slope), d.lt(a, zero));
            let part = d.select(negative, minus, slope);
            add(d, a, part);
        }
        Op::Sqrt => {
            let half = d.constant(0.5);
            let (part, positive) = (d.mul(slope, half), d.lt(zero, result));
            let part = d.div(part, result);
            let part = d.select(positive, part, zero);
            add(d, a, part);
        }
        Op::Min | Op::Max => {
            let first = if op == Op::Min { d.lt(a, b) } else { d.lt(b, a) };
            let (left, right) = (d.select(first, slope, zero), d.select(first, zero, slope));
            add(d, a, left);
            add(d, b, right);
        }
        Op::Select => {
            let (left, right) = (d.select(a, slope, zero), d.select(a, zero, slope));
            add(d, b, left);
            add(d, c, right);
        }
        Op::Sin => {
            let cos = d.cos(a);
            let part = d.mul(slope, cos);
            add(d, a, part);
        }
        Op::Cos => {
            let sin = d.sin(a);
            let part = d.mul(slope, sin);
            let part = d.neg(part);
            add(d, a, part);
        }
        Op::Exp => {
            let part = d.mul(slope, result);
            add(d, a, part);
        }
        Op::Ln => {
            let part = d.div(slope, a);
            add(d, a, part);
        }
        Op::Pow => {
            let positive = d.lt(zero, a);
            let base = d.select(positive, a, one);
            let ratio = d.div(result, base);
            let along = d.mul(b, ratio);
            let left = d.mul(slope, along);
            let left = d.select(positive, left, zero);
            add(d, a, left);
            let logarithm = d.ln(base);
            let along = d.mul(result, logarithm);
            let right = d.mul(slope, along);
            let right = d.select(positive, right, zero);
            add(d, b, right);
        }
        // These do not follow: masks, bits, and what stands still.
        Op::Lt
        | Op::Le
        | Op::Eq
        | Op::Both
        | Op::Either
        | Op::Not
        | Op::ToBits
        | Op::FromBits
        | Op::BitAnd
        | Op::BitOr
        | Op::BitXor
        | Op::IntAdd
        | Op::IntSub
        | Op::Shl
        | Op::Shr
        | Op::StopGradient
        | Op::SlopeX
        | Op::SlopeY
        | Op::SlopeZ
        | Op::LowEnd => {}
    }
}

macro_rules! recorded {
    ($(
        $(#[doc = $doc:literal])*
        $variant:ident $name:ident ( $($arg:ident : $type:ident),+ ) -> $result:ident $(, $flag:ident)*;
    )+) => {
        impl Domain for Tape<'_> {
            type Real = Value;
            type Mask = Value;
            type Bits = Value;

            fn constant(&mut self, value: f32) -> Value {
                self.builder.constant(value)
            }

            fn bits_constant(&mut self, value: u32) -> Value {
                self.builder.bits_constant(value)
            }

            $(
                fn $name(&mut self, $($arg: Value),+) -> Value {
                    self.op(Op::$variant, &[$($arg),+])
                }
            )+
        }
    };
}

jbt_ir::for_each_op!(recorded);
