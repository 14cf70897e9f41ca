//! Computes ops on constants with the reference domain, so the bits are those that any engine would give.
//!
//! * An op whose result is a NaN stays: which NaN it gives is the engine's business.
//! * There is no constant mask. A comparison of constants stays, but its truth is remembered, so that a
//!   selection by it becomes one of its operands; the comparison then has no use and `dce` removes it.

use std::collections::HashMap;

use crate::builder::FunctionBuilder;
use crate::domain::scalar::Scalar;
use crate::entity::Value;
use crate::function::{Function, InstKind};
use crate::op::{Any, Domain, Op, apply};
use crate::translate::rewrite;

/// The function with ops on constants computed.
#[must_use]
pub fn fold_constants(function: &Function) -> Function {
    let mut masks = HashMap::new();
    rewrite(function, |builder, op, args| fold(builder, &mut masks, op, args))
}

/// The new value for one op. `masks` are the masks of the new function whose truth is known.
fn fold(builder: &mut FunctionBuilder, masks: &mut HashMap<Value, bool>, op: Op, args: &[Value]) -> Value {
    if let Some(value) = decide(masks, op, args) {
        return value;
    }
    let constants: Option<Vec<Any<Scalar>>> = args.iter().map(|&arg| constant(builder, masks, arg)).collect();
    let Some(constants) = constants else { return builder.op(op, args) };
    match apply(&mut Scalar, op, &constants) {
        Any::Real(number) if number.is_nan() => builder.op(op, args),
        Any::Real(number) => builder.constant(number),
        Any::Bits(bits) => builder.bits_constant(bits),
        Any::Mask(truth) => {
            let value = builder.op(op, args);
            masks.insert(value, truth);
            value
        }
    }
}

/// The constant that a value is, if it is one.
fn constant(builder: &FunctionBuilder, masks: &HashMap<Value, bool>, value: Value) -> Option<Any<Scalar>> {
    match builder.definition(value)? {
        InstKind::Constant(number) => Some(Any::Real(*number)),
        InstKind::BitsConstant(bits) => Some(Any::Bits(*bits)),
        InstKind::Op { .. } => masks.get(&value).map(|&truth| Any::Mask(truth)),
        InstKind::Input(_) | InstKind::Column { .. } | InstKind::Fold(_) => None,
    }
}

/// The operand that an op with a known mask passes through.
fn decide(masks: &HashMap<Value, bool>, op: Op, args: &[Value]) -> Option<Value> {
    match op {
        Op::Select => masks.get(&args[0]).map(|&truth| if truth { args[1] } else { args[2] }),
        Op::Both => match (masks.get(&args[0]), masks.get(&args[1])) {
            (Some(true), _) | (_, Some(false)) => Some(args[1]),
            (Some(false), _) | (_, Some(true)) => Some(args[0]),
            (None, None) => None,
        },
        Op::Either => match (masks.get(&args[0]), masks.get(&args[1])) {
            (Some(false), _) | (_, Some(true)) => Some(args[1]),
            (Some(true), _) | (_, Some(false)) => Some(args[0]),
            (None, None) => None,
        },
        Op::Add
        | Op::Sub
        | Op::Mul
        | Op::Div
        | Op::Fma
        | Op::Neg
        | Op::Abs
        | Op::Sqrt
        | Op::Min
        | Op::Max
        | Op::Lt
        | Op::Le
        | Op::Eq
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
        | Op::Sin
        | Op::Cos
        | Op::Exp
        | Op::Ln
        | Op::Pow
        | Op::StopGradient
        | Op::SlopeX
        | Op::SlopeY
        | Op::SlopeZ
        | Op::LowEnd => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass::dce;

    /// What the only output is after folding: the number, if it is one.
    fn folded(write: impl FnOnce(&mut FunctionBuilder, Value) -> Value) -> (Function, Option<f32>) {
        let mut b = FunctionBuilder::new("test", &["x"]);
        let x = b.input(0);
        let result = write(&mut b, x);
        let function = dce(fold_constants(&b.finish(&[("out".into(), result)])));
        let constant = function.insts.values().find_map(|data| match data.kind {
            InstKind::Constant(number) if data.results == function.blocks[function.body].results => {
                Some(number)
            }
            InstKind::Input(_)
            | InstKind::Constant(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. }
            | InstKind::Op { .. }
            | InstKind::Fold(_) => None,
        });
        (function, constant)
    }

    #[test]
    fn numbers_are_computed() {
        let (function, number) = folded(|b, _| {
            let (two, three) = (b.constant(2.0), b.constant(3.0));
            let product = b.mul(two, three);
            b.sub(two, product)
        });
        assert_eq!(number, Some(-4.0));
        assert_eq!(function.insts.len(), 1);
    }

    #[test]
    fn bits_are_computed() {
        let (_, number) = folded(|b, _| {
            let (one, by) = (b.bits_constant(0x7f), b.bits_constant(23));
            let bits = b.shl(one, by);
            b.from_bits(bits)
        });
        assert_eq!(number, Some(1.0));
    }

    #[test]
    fn the_sign_of_zero_is_kept() {
        let (_, number) = folded(|b, _| {
            let zero = b.constant(0.0);
            b.neg(zero)
        });
        assert_eq!(number.map(f32::to_bits), Some((-0.0f32).to_bits()));
    }

    #[test]
    fn a_nan_is_left_to_the_engine() {
        let (function, number) = folded(|b, _| {
            let zero = b.constant(0.0);
            b.div(zero, zero)
        });
        assert_eq!((number, function.insts.len()), (None, 2));
    }

    #[test]
    fn a_known_mask_decides_a_selection() {
        let (function, number) = folded(|b, x| {
            let (two, three) = (b.constant(2.0), b.constant(3.0));
            let less = b.lt(two, three);
            let unknown = b.lt(x, two);
            let both = b.both(less, unknown);
            let not = b.not(less);
            let neither = b.either(not, not);
            let x_or_two = b.select(both, x, two);
            b.select(neither, x_or_two, three)
        });
        assert_eq!((number, function.insts.len()), (Some(3.0), 1));
    }

    #[test]
    fn an_unknown_mask_next_to_a_known_one_remains() {
        let (function, _) = folded(|b, x| {
            let (two, three) = (b.constant(2.0), b.constant(3.0));
            let less = b.lt(two, three);
            let unknown = b.lt(x, two);
            let both = b.both(unknown, less);
            let not = b.not(less);
            let either = b.either(not, both);
            b.select(either, x, two)
        });
        // x, 2, the comparison, the selection.
        assert_eq!(function.insts.len(), 4);
    }
}
