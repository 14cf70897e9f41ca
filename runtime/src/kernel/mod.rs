//! Kernels: code for one shape and one purpose, without a model's numbers; and bound kernels, with them.
//!
//! ```text
//! Function ─optimise─► Verified ─Backend─► dyn engine::Program     code, on an engine
//! + the lowered function, what a row costs               = Kernel         one shape; models share it
//! + Tables, in a BoundProgram                            = Bound          one model's numbers
//! + a query and a layout | what pruning has to know      = AnswerProgram | RangeProgram
//! + counters                                             = Evaluator | Pruner
//! ```
//!
//! | engine | what it is |
//! |---|---|
//! | `scalar` | the reference: one point after the other, in the simplest way |
//! | `lanes` | the SIMD interpreter |
//! | `jit` | machine code: wide code of our own where the CPU has AVX2, else by Cranelift |
//!
//! All give the same bits, and all are asked through one door, [`jbt_ir::engine`]; `engine.rs` has their
//! list.

mod bound;
mod engine;
mod optimise;

pub(crate) use bound::{BoundKernel, Kernel};
pub(crate) use engine::Wish;
pub use engine::{Engine, form, forms};
pub(crate) use optimise::grown;
pub use optimise::{Purpose, optimise, optimise_straight, passes, straighten};
