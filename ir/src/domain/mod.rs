//! The meanings of the ops: one `impl Domain` in one file each.
//!
//! | file | a real is | for |
//! |---|---|---|
//! | [`scalar`] | an `f32` | the reference |
//! | [`counting`] | nothing | what a point costs |
//! | [`lanes`] | a block of `f32`, or one for all points | the interpreter |
//! | [`interval`] | two bounds, computed or emitted | what a box can hold |
//! | [`tangent`] | a value and its tangent, emitted | the gradient |
//!
//! Elsewhere, `FunctionBuilder` (`builder.rs`) writes instructions, `Vectors` (`jit/src/cranelift/`) machine
//! code.

pub mod counting;
pub mod interval;
pub mod lanes;
pub mod scalar;
pub mod tangent;
