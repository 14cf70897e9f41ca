//! A program on an engine: verified instructions, and whatever runs them.
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
pub use optimise::{Purpose, optimise, optimise_straight, passes, straighten};
