//! The meaning of the ops in machine code: a lane type is K Cranelift vectors of 4 lanes each.
//!
//! ```text
//! real   [F32X4; K]
//! mask   [I32X4; K]   all ones or all zeros in each lane
//! bits   [I32X4; K]
//! ```
//!
//! Several vectors for each value hide the latency of an operation behind the same operation on the others. A
//! value that is the same in all lanes (a constant, a column, and whatever is made of these alone) is one
//! vector that stands K times in the array, and an op on such values is emitted once.

use std::array;
use std::collections::HashMap;

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::types::{F32X4, I32, I32X4};
use cranelift_codegen::ir::{ConstantData, Endianness, InstBuilder, MemFlagsData, Type, Value};
use cranelift_frontend::FunctionBuilder;
use jbt_ir::{Domain, math};

/// Bytes of one vector.
pub(crate) const VECTOR_BYTES: usize = 16;

/// Emits ops into a Cranelift function.
pub(crate) struct Vectors<'f, const K: usize> {
    /// Where instructions go.
    pub(crate) builder: FunctionBuilder<'f>,
    /// The number behind each bits constant, for shifts by it.
    amounts: HashMap<Value, u32>,
}

/// Whether one vector stands for all of them.
fn is_uniform<const K: usize>(vectors: &[Value; K]) -> bool {
    vectors.iter().all(|&vector| vector == vectors[0])
}

impl<'f, const K: usize> Vectors<'f, K> {
    /// Emits into this function, at the block that the builder has switched to.
    pub(crate) fn new(builder: FunctionBuilder<'f>) -> Self {
        Self { builder, amounts: HashMap::new() }
    }

    /// Emits `op` for each vector, or once if all operands are the same in all lanes.
    fn each<const N: usize>(
        &mut self,
        args: [[Value; K]; N],
        mut op: impl FnMut(&mut FunctionBuilder<'f>, [Value; N]) -> Value,
    ) -> [Value; K] {
        if args.iter().all(is_uniform) {
            return [op(&mut self.builder, args.map(|arg| arg[0])); K];
        }
        array::from_fn(|index| op(&mut self.builder, args.map(|arg| arg[index])))
    }

    /// The same 32 bits in every lane of a vector of this type.
    fn splat(&mut self, type_: Type, bits: u32) -> Value {
        let lanes = ConstantData::from(bits.to_le_bytes().repeat(4));
        let constant = self.builder.func.dfg.constants.insert(lanes);
        self.builder.ins().vconst(type_, constant)
    }

    /// All ones where the comparison holds.
    fn compare(&mut self, code: FloatCC, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| builder.ins().fcmp(code, a, b))
    }

    /// `if less[0] < less[1] { a } else { b }`. Where these are a and b, in either order, the backend knows
    /// it as `minps` or `maxps`: one instruction.
    fn extremum(builder: &mut FunctionBuilder<'f>, less: [Value; 2], a: Value, b: Value) -> Value {
        let mask = builder.ins().fcmp(FloatCC::LessThan, less[0], less[1]);
        let mask = reinterpret(builder, F32X4, mask);
        builder.ins().bitselect(mask, a, b)
    }

    /// The amount of a shift, modulo 32. The verifier has seen to it that it is a constant.
    fn amount(&mut self, by: [Value; K]) -> Value {
        let amount = self.amounts.get(&by[0]).expect("a verified function shifts by constants");
        let amount = i64::from(amount % 32);
        self.builder.ins().iconst(I32, amount)
    }
}

/// The same 128 bits as a vector of another type. Costs nothing.
fn reinterpret(builder: &mut FunctionBuilder<'_>, type_: Type, value: Value) -> Value {
    // Cranelift wants to be told the order of the lanes where a cast changes their width; ours never does.
    let flags = MemFlagsData::new().with_endianness(Endianness::Little);
    builder.ins().bitcast(type_, flags, value)
}

impl<const K: usize> Domain for Vectors<'_, K> {
    type Real = [Value; K];
    type Mask = [Value; K];
    type Bits = [Value; K];

    fn constant(&mut self, value: f32) -> [Value; K] {
        [self.splat(F32X4, value.to_bits()); K]
    }

    fn bits_constant(&mut self, value: u32) -> [Value; K] {
        let vector = self.splat(I32X4, value);
        self.amounts.insert(vector, value);
        [vector; K]
    }

    fn add(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| builder.ins().fadd(a, b))
    }

    fn sub(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| builder.ins().fsub(a, b))
    }

    fn mul(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| builder.ins().fmul(a, b))
    }

    fn div(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| builder.ins().fdiv(a, b))
    }

    fn fma(&mut self, a: [Value; K], b: [Value; K], c: [Value; K]) -> [Value; K] {
        self.each([a, b, c], |builder, [a, b, c]| builder.ins().fma(a, b, c))
    }

    fn neg(&mut self, a: [Value; K]) -> [Value; K] {
        self.each([a], |builder, [a]| builder.ins().fneg(a))
    }

    fn abs(&mut self, a: [Value; K]) -> [Value; K] {
        self.each([a], |builder, [a]| builder.ins().fabs(a))
    }

    fn sqrt(&mut self, a: [Value; K]) -> [Value; K] {
        self.each([a], |builder, [a]| builder.ins().sqrt(a))
    }

    fn min(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| Self::extremum(builder, [a, b], a, b))
    }

    fn max(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| Self::extremum(builder, [b, a], a, b))
    }

    fn lt(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.compare(FloatCC::LessThan, a, b)
    }

    fn le(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.compare(FloatCC::LessThanOrEqual, a, b)
    }

    fn eq(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.compare(FloatCC::Equal, a, b)
    }

    fn both(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.bit_and(a, b)
    }

    fn either(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.bit_or(a, b)
    }

    fn not(&mut self, a: [Value; K]) -> [Value; K] {
        self.each([a], |builder, [a]| builder.ins().bnot(a))
    }

    /// By `blendv`, which is one instruction for any mask; `bitselect` is three unless the mask is a
    /// comparison.
    fn select(&mut self, condition: [Value; K], a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([condition, a, b], |builder, [condition, a, b]| {
            let (a, b) = (reinterpret(builder, I32X4, a), reinterpret(builder, I32X4, b));
            let blend = builder.ins().blendv(condition, a, b);
            reinterpret(builder, F32X4, blend)
        })
    }

    fn to_bits(&mut self, a: [Value; K]) -> [Value; K] {
        self.each([a], |builder, [a]| reinterpret(builder, I32X4, a))
    }

    fn from_bits(&mut self, a: [Value; K]) -> [Value; K] {
        self.each([a], |builder, [a]| reinterpret(builder, F32X4, a))
    }

    fn bit_and(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| builder.ins().band(a, b))
    }

    fn bit_or(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| builder.ins().bor(a, b))
    }

    fn bit_xor(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| builder.ins().bxor(a, b))
    }

    fn int_add(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| builder.ins().iadd(a, b))
    }

    fn int_sub(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        self.each([a, b], |builder, [a, b]| builder.ins().isub(a, b))
    }

    fn shl(&mut self, a: [Value; K], by: [Value; K]) -> [Value; K] {
        let amount = self.amount(by);
        self.each([a], |builder, [a]| builder.ins().ishl(a, amount))
    }

    fn shr(&mut self, a: [Value; K], by: [Value; K]) -> [Value; K] {
        let amount = self.amount(by);
        self.each([a], |builder, [a]| builder.ins().ushr(a, amount))
    }

    fn sin(&mut self, a: [Value; K]) -> [Value; K] {
        math::sin(self, a)
    }

    fn cos(&mut self, a: [Value; K]) -> [Value; K] {
        math::cos(self, a)
    }

    fn exp(&mut self, a: [Value; K]) -> [Value; K] {
        math::exp(self, a)
    }

    fn ln(&mut self, a: [Value; K]) -> [Value; K] {
        math::ln(self, a)
    }

    fn pow(&mut self, a: [Value; K], b: [Value; K]) -> [Value; K] {
        math::pow(self, a, b)
    }

    fn stop_gradient(&mut self, a: [Value; K]) -> [Value; K] {
        a
    }

    fn slope_x(&mut self, _: [Value; K]) -> [Value; K] {
        self.constant(0.0)
    }

    fn slope_y(&mut self, _: [Value; K]) -> [Value; K] {
        self.constant(0.0)
    }

    fn slope_z(&mut self, _: [Value; K]) -> [Value; K] {
        self.constant(0.0)
    }

    fn low_end(&mut self, a: [Value; K]) -> [Value; K] {
        a
    }
}
