//! Functions of one op: operands of any type made of input planes, and results of any type as reals.

use jbt_ir::{Domain as _, FunctionBuilder, Type, Value};

/// An operand of a type, made of an input plane: as a mask, whether the number is less than a quarter.
pub fn operand(b: &mut FunctionBuilder, plane: usize, type_: Type) -> Value {
    let real = b.input(plane);
    match type_ {
        Type::Real => real,
        Type::Mask => {
            let quarter = b.constant(0.25);
            b.lt(real, quarter)
        }
        Type::Bits => b.to_bits(real),
    }
}

/// An op's result as reals: a mask is 1 or -0, bits are two halves. As one real, bits that happen to be a NaN
/// may come back as another one, which halves never are.
pub fn reals(b: &mut FunctionBuilder, value: Value, type_: Type) -> Vec<Value> {
    match type_ {
        Type::Real => vec![value],
        Type::Mask => {
            let (one, zero) = (b.constant(1.0), b.constant(-0.0));
            vec![b.select(value, one, zero)]
        }
        Type::Bits => {
            let (low, high, by) =
                (b.bits_constant(0xFFFF), b.bits_constant(0x3F80_0000), b.bits_constant(16));
            let halves = [b.bit_and(value, low), b.shr(value, by)];
            halves.map(|half| b.bit_or(half, high)).map(|half| b.from_bits(half)).to_vec()
        }
    }
}
