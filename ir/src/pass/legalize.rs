//! Expands the ops that no machine has.
//!
//! The transcendentals become the steps of [`crate::math`], written through the builder, so every engine runs
//! the same steps. `stop_gradient` matters to the gradient only, which has been taken by now: it becomes its
//! operand. Slopes of values, as directions need them under warps, are written out, if the gradient has not
//! done that.

use super::gradient::slopes;
use crate::builder::FunctionBuilder;
use crate::entity::Value;
use crate::function::Function;
use crate::math;
use crate::op::{Domain as _, Op};
use crate::translate::rewrite;

/// The function without transcendentals, `stop_gradient` and `low_end`.
#[must_use]
pub fn legalize(function: &Function) -> Function {
    // Whoever asks for slopes and not for the gradient has them here.
    rewrite(&slopes(function), expand)
}

fn expand(builder: &mut FunctionBuilder, op: Op, args: &[Value]) -> Value {
    match op {
        Op::Sin => math::sin(builder, args[0]),
        Op::Cos => math::cos(builder, args[0]),
        Op::Exp => math::exp(builder, args[0]),
        Op::Ln => math::ln(builder, args[0]),
        Op::Pow => math::pow(builder, args[0], args[1]),
        Op::StopGradient | Op::LowEnd => args[0],
        Op::SlopeX | Op::SlopeY | Op::SlopeZ => builder.constant(0.0),
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
        | Op::Both
        | Op::Either
        | Op::Not
        | Op::Select
        | Op::ToBits
        | Op::FromBits
        | Op::BitAnd
        | Op::BitOr
        | Op::BitXor
        | Op::IntAdd
        | Op::IntSub
        | Op::Shl
        | Op::Shr => builder.op(op, args),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::function::InstKind;
    use crate::op::Domain;

    #[test]
    fn nothing_is_left_to_expand() {
        let mut b = FunctionBuilder::new("all", &["x", "y"]);
        let (x, y) = (b.input(0), b.input(1));
        let values = [b.sin(x), b.cos(x), b.exp(x), b.ln(x), b.pow(x, y), b.stop_gradient(x)];
        let outputs: Vec<_> = values.iter().map(|&value| (value.to_string(), value)).collect();
        let legal = legalize(&b.finish(&outputs));
        for data in legal.insts.values() {
            if let InstKind::Op { op, .. } = data.kind {
                assert!(!op.is_expanded() && op != Op::StopGradient);
            }
        }
        assert_eq!(legal.outputs.len(), 6);
    }

    #[test]
    fn sine_and_cosine_of_one_angle_share_their_reduction() {
        let count = |both: bool| {
            let mut b = FunctionBuilder::new("angle", &["x"]);
            let x = b.input(0);
            let sin = b.sin(x);
            let cos = if both { b.cos(x) } else { sin };
            legalize(&b.finish(&[("sin".into(), sin), ("cos".into(), cos)])).insts.len()
        };
        assert!(count(true) < count(false) + 15, "{} after {}", count(true), count(false));
    }
}
