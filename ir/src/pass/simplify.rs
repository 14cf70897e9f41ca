//! Replaces ops by cheaper ones that give the same bits for **every** operand: signed zeros, infinities and
//! subnormals included; any NaN equals any NaN.
//!
//! Some rules are absent on purpose: `x + 0` is not x (`-0 + 0 = +0`), `x * 0` is not 0 (infinities, NaN,
//! signs), `x - x` is not 0, and `min` and `max` do not commute.

use crate::builder::FunctionBuilder;
use crate::entity::Value;
use crate::function::{Function, InstKind};
use crate::op::{Domain, Op};
use crate::translate::rewrite;

/// The function with cheaper ops.
#[must_use]
pub fn simplify(function: &Function) -> Function {
    rewrite(function, |builder, op, args| {
        let mut current = (op, args.to_vec());
        // Each step drops an op, a negation or a division, so this ends.
        loop {
            match step(builder, current.0, &current.1) {
                Simpler::Value(value) => return value,
                Simpler::Op(op, args) => current = (op, args),
                Simpler::Done => break,
            }
        }
        let (op, mut args) = current;
        // Then equal ops look equal.
        if op.commutes() && args[1] < args[0] {
            args.swap(0, 1);
        }
        builder.op(op, &args)
    })
}

/// One simplification.
enum Simpler {
    /// This value has the bits already.
    Value(Value),
    /// This op gives them.
    Op(Op, Vec<Value>),
    /// None applies.
    Done,
}

impl Simpler {
    fn op(op: Op, args: &[Value]) -> Self {
        Self::Op(op, args.to_vec())
    }
}

/// The operands of `value`, if it is this op.
fn operands_of(b: &FunctionBuilder, value: Value, wanted: Op) -> Option<&[Value]> {
    match b.definition(value)? {
        InstKind::Op { op, args } if *op == wanted => Some(args),
        InstKind::Op { .. }
        | InstKind::Input(_)
        | InstKind::Constant(_)
        | InstKind::BitsConstant(_)
        | InstKind::Column { .. }
        | InstKind::Fold(_) => None,
    }
}

/// The operand of a unary op, if `value` is that op.
fn operand_of(b: &FunctionBuilder, value: Value, op: Op) -> Option<Value> {
    operands_of(b, value, op).map(|args| args[0])
}

/// Whether `value` is the constant with exactly the bits of `number`.
fn is(b: &FunctionBuilder, value: Value, number: f32) -> bool {
    b.as_constant(value).is_some_and(|constant| constant.to_bits() == number.to_bits())
}

/// The bits, if `value` is a bits constant.
fn bits(b: &FunctionBuilder, value: Value) -> Option<u32> {
    match b.definition(value)? {
        InstKind::BitsConstant(bits) => Some(*bits),
        InstKind::Op { .. }
        | InstKind::Input(_)
        | InstKind::Constant(_)
        | InstKind::Column { .. }
        | InstKind::Fold(_) => None,
    }
}

fn step(b: &mut FunctionBuilder, op: Op, args: &[Value]) -> Simpler {
    match op {
        Op::Add => add(b, args[0], args[1]),
        Op::Sub => sub(b, args[0], args[1]),
        Op::Mul => mul(b, args[0], args[1]),
        Op::Div => div(b, args[0], args[1]),
        Op::Fma => fma(b, args[0], args[1], args[2]),
        // Both flip the sign bit, of anything.
        Op::Neg => operand_of(b, args[0], Op::Neg).map_or(Simpler::Done, Simpler::Value),
        Op::Abs => abs(b, args[0]),
        // Both branches are the same bits.
        Op::Min | Op::Max | Op::Both | Op::Either if args[0] == args[1] => Simpler::Value(args[0]),
        Op::Not => operand_of(b, args[0], Op::Not).map_or(Simpler::Done, Simpler::Value),
        Op::Select => select(b, args[0], args[1], args[2]),
        // A real and its encoding are the same bits.
        Op::ToBits => operand_of(b, args[0], Op::FromBits).map_or(Simpler::Done, Simpler::Value),
        Op::FromBits => operand_of(b, args[0], Op::ToBits).map_or(Simpler::Done, Simpler::Value),
        Op::BitAnd => bit_and(b, args[0], args[1]),
        // Equal bits stay.
        Op::BitOr if args[0] == args[1] => Simpler::Value(args[0]),
        // Equal bits leave nothing.
        Op::BitXor | Op::IntSub if args[0] == args[1] => Simpler::Value(b.bits_constant(0)),
        Op::BitOr | Op::BitXor | Op::IntAdd => zero_neutral(b, args[0], args[1]),
        // 0 changes nothing.
        Op::IntSub if bits(b, args[1]) == Some(0) => Simpler::Value(args[0]),
        // Shift amounts count modulo 32.
        Op::Shl | Op::Shr if bits(b, args[1]).is_some_and(|by| by % 32 == 0) => Simpler::Value(args[0]),
        Op::Pow => pow(b, args[0], args[1]),
        // What no rule knows stays: that is never wrong.
        _ => Simpler::Done,
    }
}

fn add(b: &FunctionBuilder, x: Value, y: Value) -> Simpler {
    // -0 is neutral: -0 + -0 = -0 and +0 + -0 = +0.
    if is(b, y, -0.0) {
        return Simpler::Value(x);
    }
    if is(b, x, -0.0) {
        return Simpler::Value(y);
    }
    // A difference is defined as the sum with the negation.
    if let Some(y) = operand_of(b, y, Op::Neg) {
        return Simpler::op(Op::Sub, &[x, y]);
    }
    if let Some(x) = operand_of(b, x, Op::Neg) {
        return Simpler::op(Op::Sub, &[y, x]);
    }
    Simpler::Done
}

fn sub(b: &FunctionBuilder, x: Value, y: Value) -> Simpler {
    // Adding -0 is neutral.
    if is(b, y, 0.0) {
        return Simpler::Value(x);
    }
    // -0 is neutral: -0 - y = -0 + -y.
    if is(b, x, -0.0) {
        return Simpler::op(Op::Neg, &[y]);
    }
    // The sum with the negation of the negation.
    if let Some(y) = operand_of(b, y, Op::Neg) {
        return Simpler::op(Op::Add, &[x, y]);
    }
    Simpler::Done
}

fn mul(b: &mut FunctionBuilder, x: Value, y: Value) -> Simpler {
    for (x, y) in [(x, y), (y, x)] {
        // 1 is neutral, and -1 only flips the sign.
        if is(b, y, 1.0) {
            return Simpler::Value(x);
        }
        if is(b, y, -1.0) {
            return Simpler::op(Op::Neg, &[x]);
        }
    }
    match without_signs(b, x, y) {
        Some((x, y)) => Simpler::op(Op::Mul, &[x, y]),
        None => Simpler::Done,
    }
}

/// Factors with the same product and fewer negations: two cancel, and one goes into a constant.
fn without_signs(b: &mut FunctionBuilder, x: Value, y: Value) -> Option<(Value, Value)> {
    let (negated_x, negated_y) = (operand_of(b, x, Op::Neg), operand_of(b, y, Op::Neg));
    match (negated_x, negated_y) {
        (Some(x), Some(y)) => Some((x, y)),
        (Some(x), None) => b.as_constant(y).map(|number| (x, b.constant(-number))),
        (None, Some(y)) => b.as_constant(x).map(|number| (b.constant(-number), y)),
        (None, None) => None,
    }
}

fn div(b: &mut FunctionBuilder, x: Value, y: Value) -> Simpler {
    if let Some(divisor) = b.as_constant(y) {
        // 2^k has the exact inverse 2^-k if that is a number too: the real quotient and product are one
        // number, rounded once.
        let inverse = divisor.recip();
        let power_of_two = is_power_of_two(divisor) && is_power_of_two(inverse);
        if power_of_two {
            let inverse = b.constant(inverse);
            return Simpler::op(Op::Mul, &[x, inverse]);
        }
    }
    // The signs of both cancel.
    match without_signs(b, x, y) {
        Some((x, y)) => Simpler::op(Op::Div, &[x, y]),
        None => Simpler::Done,
    }
}

/// Whether a number is 2^k or -2^k, subnormal ones included.
fn is_power_of_two(number: f32) -> bool {
    let magnitude = number.abs().to_bits();
    let mantissa = magnitude & 0x007f_ffff;
    let exponent = magnitude >> 23;
    match exponent {
        0 => mantissa.is_power_of_two(),
        255 => false,
        _ => mantissa == 0,
    }
}

fn fma(b: &mut FunctionBuilder, x: Value, y: Value, z: Value) -> Simpler {
    for (x, y) in [(x, y), (y, x)] {
        // The product is exact, so only the sum rounds.
        if is(b, y, 1.0) {
            return Simpler::op(Op::Add, &[x, z]);
        }
        if is(b, y, -1.0) {
            return Simpler::op(Op::Sub, &[z, x]);
        }
    }
    // -0 is neutral; +0 is neutral for a square, which is never -0.
    if is(b, z, -0.0) || (x == y && is(b, z, 0.0)) {
        return Simpler::op(Op::Mul, &[x, y]);
    }
    match without_signs(b, x, y) {
        Some((x, y)) => Simpler::op(Op::Fma, &[x, y, z]),
        None => Simpler::Done,
    }
}

fn abs(b: &FunctionBuilder, x: Value) -> Simpler {
    // The sign bit is clear already.
    if operands_of(b, x, Op::Abs).is_some() {
        return Simpler::Value(x);
    }
    // It is cleared anyway.
    match operand_of(b, x, Op::Neg) {
        Some(x) => Simpler::op(Op::Abs, &[x]),
        None => Simpler::Done,
    }
}

fn select(b: &FunctionBuilder, condition: Value, x: Value, y: Value) -> Simpler {
    // Both branches are the same bits.
    if x == y {
        return Simpler::Value(x);
    }
    if let Some(condition) = operand_of(b, condition, Op::Not) {
        return Simpler::op(Op::Select, &[condition, y, x]);
    }
    // A branch that asks the same question again knows the answer.
    if let Some(&[inner, kept, _]) = operands_of(b, x, Op::Select)
        && inner == condition
    {
        return Simpler::op(Op::Select, &[condition, kept, y]);
    }
    if let Some(&[inner, _, kept]) = operands_of(b, y, Op::Select)
        && inner == condition
    {
        return Simpler::op(Op::Select, &[condition, x, kept]);
    }
    Simpler::Done
}

fn bit_and(b: &FunctionBuilder, x: Value, y: Value) -> Simpler {
    for (x, y) in [(x, y), (y, x)] {
        // All ones are neutral, 0 absorbs, and equal bits stay.
        match bits(b, y) {
            Some(u32::MAX) => return Simpler::Value(x),
            Some(0) => return Simpler::Value(y),
            Some(_) | None if x == y => return Simpler::Value(x),
            Some(_) | None => {}
        }
    }
    Simpler::Done
}

/// An op on bits for which 0 is neutral on both sides.
fn zero_neutral(b: &FunctionBuilder, x: Value, y: Value) -> Simpler {
    match (bits(b, x), bits(b, y)) {
        (_, Some(0)) => Simpler::Value(x),
        (Some(0), _) => Simpler::Value(y),
        (Some(_) | None, Some(_) | None) => Simpler::Done,
    }
}

fn pow(b: &mut FunctionBuilder, x: Value, y: Value) -> Simpler {
    // Both hold by definition, for every other operand.
    if is(b, x, 1.0) || is(b, y, 0.0) || is(b, y, -0.0) {
        return Simpler::Value(b.constant(1.0));
    }
    Simpler::Done
}

#[cfg(test)]
mod tests {
    use jbt_testkit::bits::same;
    use jbt_testkit::points::OPERANDS;

    use super::*;
    use crate::domain::scalar::Scalar;
    use crate::interpret::run;
    use crate::pass::dce;
    use crate::table::Tables;
    use crate::verify::verify;

    /// How many instructions that are not inputs or constants are left, after checking that every spicy pair
    /// gives the same bits.
    fn left(name: &str, write: impl FnOnce(&mut FunctionBuilder, Value, Value) -> Value) -> usize {
        let mut b = FunctionBuilder::new(name, &["x", "y"]);
        let (x, y) = (b.input(0), b.input(1));
        let result = write(&mut b, x, y);
        let before = b.finish(&[("out".into(), result)]);
        let after = dce(simplify(&before));
        let count = after.insts.values().filter(|data| matches!(data.kind, InstKind::Op { .. })).count();
        let before = verify(before).expect("it obeys the rules");
        let after = verify(after).expect("it obeys the rules");
        // Miri takes some seconds for all pairs.
        let operands = if cfg!(miri) { &OPERANDS[..5] } else { &OPERANDS[..] };
        for &x in operands {
            for &y in operands {
                let run = |function| run(function, &Tables::default(), &mut Scalar, &[x, y])[0];
                let (old, new): (f32, f32) = (run(&before), run(&after));
                assert!(same(old, new), "{name}({x:e}, {y:e}): {old:e} became {new:e}");
            }
        }
        count
    }

    /// Checks that an op with a constant second operand leaves so many instructions.
    #[track_caller]
    fn with_constant(op: Op, number: f32, expected: usize) {
        let name = format!("{op:?} {number:e}");
        let count = left(&name, |b, x, _| {
            let number = b.constant(number);
            b.op(op, &[x, number])
        });
        assert_eq!(count, expected, "{name}");
    }

    #[test]
    fn neutral_numbers_go() {
        with_constant(Op::Add, -0.0, 0);
        with_constant(Op::Sub, 0.0, 0);
        with_constant(Op::Mul, 1.0, 0);
        with_constant(Op::Div, 1.0, 0);
        with_constant(Op::Mul, -1.0, 1);
    }

    #[test]
    fn numbers_that_are_not_quite_neutral_stay() {
        with_constant(Op::Add, 0.0, 1);
        with_constant(Op::Sub, -0.0, 1);
        with_constant(Op::Mul, 0.0, 1);
        with_constant(Op::Mul, 2.0, 1);
        let count = left("0 - x", |b, x, _| {
            let zero = b.constant(0.0);
            b.sub(zero, x)
        });
        assert_eq!(count, 1);
        assert_eq!(left("x - x", |b, x, _| b.sub(x, x)), 1);
        assert_eq!(left("min", Domain::min), 1);
    }

    #[test]
    fn division_by_a_power_of_two_is_a_product() {
        let step = if cfg!(miri) { 92 } else { 1 };
        for k in (-149..=127).step_by(step) {
            for sign in [1.0, -1.0] {
                let divisor = (2f64.powi(k) * sign) as f32;
                let op = |b: &mut FunctionBuilder, x| {
                    let divisor = b.constant(divisor);
                    b.div(x, divisor)
                };
                left(&format!("div {divisor:e}"), |b, x, _| op(b, x));
                let mut b = FunctionBuilder::new("div", &["x"]);
                let x = b.input(0);
                let result = op(&mut b, x);
                let function = simplify(&b.finish(&[("out".into(), result)]));
                let divides = |data: &crate::InstData| matches!(data.kind, InstKind::Op { op: Op::Div, .. });
                // The inverse of 2^-128 and below is no number.
                assert_eq!(function.insts.values().any(divides), k < -127, "2^{k}");
            }
        }
        with_constant(Op::Div, 3.0, 1);
        with_constant(Op::Div, 0.0, 1);
        with_constant(Op::Div, f32::INFINITY, 1);
    }

    #[test]
    fn negations_cancel_or_move() {
        let negated = |op: Op| {
            move |b: &mut FunctionBuilder, x: Value, y: Value| {
                let (x, y) = (b.neg(x), b.neg(y));
                b.op(op, &[x, y])
            }
        };
        assert_eq!(left("-x * -y", negated(Op::Mul)), 1);
        assert_eq!(left("-x / -y", negated(Op::Div)), 1);
        assert_eq!(left("-x + -y", negated(Op::Add)), 2);
        assert_eq!(left("-x - -y", negated(Op::Sub)), 1);
        for (op, second) in [(Op::Mul, 3.0), (Op::Div, 3.0)] {
            let count = left("-x op 3", |b, x, _| {
                let (x, second) = (b.neg(x), b.constant(second));
                b.op(op, &[x, second])
            });
            assert_eq!(count, 1);
        }
        let count = left("--x", |b, x, _| {
            let x = b.neg(x);
            b.neg(x)
        });
        assert_eq!(count, 0);
        let count = left("| |-x| |", |b, x, _| {
            let x = b.neg(x);
            let x = b.abs(x);
            b.abs(x)
        });
        assert_eq!(count, 1);
    }

    #[test]
    fn fma_with_a_trivial_part() {
        for (factor, addend, expected) in
            [(1.0, 3.0, 1), (-1.0, 3.0, 1), (3.0, -0.0, 1), (1.0, -0.0, 0), (3.0, 0.0, 1)]
        {
            let count = left(&format!("fma(x, {factor}, {addend})"), |b, x, _| {
                let (factor, addend) = (b.constant(factor), b.constant(addend));
                b.fma(x, factor, addend)
            });
            assert_eq!(count, expected);
        }
        let ops = |factors: fn(&mut FunctionBuilder, Value, Value) -> (Value, Value), addend: f32| {
            left("fma(.., .., constant)", |b, x, y| {
                let (x, y) = factors(b, x, y);
                let addend = b.constant(addend);
                let sum = b.fma(x, y, addend);
                // The quotient tells zeros apart.
                let one = b.constant(1.0);
                b.div(one, sum)
            })
        };
        assert_eq!(ops(|_, x, _| (x, x), 0.0), 2);
        assert_eq!(ops(|_, x, y| (x, y), 0.0), 2);
        assert_eq!(ops(|_, x, y| (x, y), -0.0), 2);
        assert_eq!(ops(|b, x, y| (b.neg(x), b.neg(y)), 3.0), 2);
        let count = left("fma(x, 1, y)", |b, x, y| {
            let one = b.constant(1.0);
            b.fma(one, x, y)
        });
        assert_eq!(count, 1);
        let count = left("fma(x, -1, y)", |b, x, y| {
            let one = b.constant(-1.0);
            b.fma(one, x, y)
        });
        assert_eq!(count, 1);
    }

    #[test]
    fn equal_branches_and_repeated_questions() {
        for op in [Op::Min, Op::Max] {
            assert_eq!(left("the same", |b, x, _| b.op(op, &[x, x])), 0);
        }
        assert_eq!(
            left("select(c, x, x)", |b, x, y| {
                let less = b.lt(x, y);
                b.select(less, x, x)
            }),
            0
        );
        assert_eq!(
            left("select(not not (c and c), ..)", |b, x, y| {
                let less = b.lt(x, y);
                let same = b.both(less, less);
                let same = b.either(same, same);
                let not = b.not(same);
                let same = b.not(not);
                b.select(same, x, y)
            }),
            2
        );
        assert_eq!(
            left("select(not c, x, y)", |b, x, y| {
                let less = b.lt(x, y);
                let not = b.not(less);
                b.select(not, x, y)
            }),
            2
        );
        assert_eq!(
            left("select(c, select(c, x, y), select(c, y, x))", |b, x, y| {
                let less = b.lt(x, y);
                let first = b.select(less, x, y);
                let second = b.select(less, y, x);
                b.select(less, first, second)
            }),
            0
        );
    }

    #[test]
    fn neutral_bits_go() {
        for (op, number, expected) in [
            // What is left: the inner absolute value, the bits of it, the op, the real, the outer absolute
            // value.
            (Op::BitAnd, u32::MAX, 1),
            (Op::BitAnd, 0, 2),
            (Op::BitAnd, 1, 5),
            (Op::BitOr, 0, 1),
            (Op::BitXor, 0, 1),
            (Op::IntAdd, 0, 1),
            (Op::IntSub, 0, 1),
            (Op::IntSub, 1, 5),
            (Op::Shl, 32, 1),
            (Op::Shr, 64, 1),
            (Op::Shr, 1, 5),
        ] {
            for swapped in [false, true] {
                if swapped && !op.commutes() {
                    continue;
                }
                let count = left(&format!("{op:?} {number}"), |b, x, _| {
                    let x = b.abs(x);
                    let (x, number) = (b.to_bits(x), b.bits_constant(number));
                    let bits = b.op(op, &if swapped { [number, x] } else { [x, number] });
                    let real = b.from_bits(bits);
                    b.abs(real)
                });
                assert_eq!(count, expected, "{op:?} {number}");
            }
        }
        for op in [Op::BitXor, Op::IntSub] {
            let count = left("equal bits", |b, x, _| {
                let x = b.to_bits(x);
                let bits = b.op(op, &[x, x]);
                b.from_bits(bits)
            });
            assert_eq!(count, 1, "only the zero bits become a real");
        }
    }

    #[test]
    fn powers_that_are_one() {
        for number in [0.0, -0.0] {
            with_constant(Op::Pow, number, 0);
        }
        let count = left("pow(1, y)", |b, _, y| {
            let one = b.constant(1.0);
            b.pow(one, y)
        });
        assert_eq!(count, 0);
    }

    #[test]
    fn operands_of_commuting_ops_are_ordered() {
        let count = left("(x + y) / (y + x)", |b, x, y| {
            let (sum, other) = (b.add(x, y), b.add(y, x));
            b.div(sum, other)
        });
        assert_eq!(count, 2);
    }
}
