//! Machine code for jbt programs: wide code of our own on x86-64 with AVX2 or AVX-512, elsewhere by
//! Cranelift.
//!
//! A verified function goes in, a program comes out ([`jbt_ir::engine`] is its door). Bound to the rows of
//! its tables it takes planes of numbers to planes of answers, and every lane has the bits that the scalar
//! reference gives (a NaN for a NaN).
//!
//! ```text
//!   Verified ──► prepare ──► cranelift ──► Cranelift IR ──┐
//!                limits,                                  ├─► memory ──► Kernel
//!                pieces  ──► wide ───────► bytes ─────────┘   pages
//! ```
//!
//! A generator of machine code is a [`Backend`](jbt_ir::engine::Backend): [`BACKENDS`] lists them, and says
//! which one makes the code for a level of the instruction set.
//!
//! What the code does, in pseudo-code, with a block of K vectors of 4 points (8 or 16 in wide code):
//!
//! ```text
//! for offset in (0 .. points).step_by(4 * K):
//!     x = inputs[0][offset..], y = ..., z = ...                 K vectors each
//!     acc = initial                                             K vectors each
//!     for row in active[starts[p] .. starts[p + 1]]:            p: the place of the parent's row among its active rows
//!         column = broadcast(numbers[row * stride + index])     one vector, read where it is needed
//!         acc = body(row, acc)
//!     outputs[0][offset..] = acc
//! ```
//!
//! Wide code has the same function a second time for few points, with one vector for each value:
//! whole blocks run through the first one, what is left through the second.
//!
//! A long function is cut into pieces, and has rows outside and points inside: see `strips`.
//!
//! ```
//! use std::sync::Arc;
//! use jbt_ir::engine::{BoundProgram, choose};
//! use jbt_ir::{Domain, FunctionBuilder, Level, verify};
//!
//! let mut b = FunctionBuilder::new("twice", &["x"]);
//! let x = b.input(0);
//! let sum = b.add(x, x);
//! let function = Arc::new(verify(b.finish(&[("sum".to_owned(), sum)])).unwrap());
//!
//! let level = Level::best();
//! let generator = choose(jbt_jit::BACKENDS, level).unwrap();
//! if generator.supports(level).is_err() {
//!     return; // then interpret it
//! }
//! let bound = BoundProgram::new(generator.compile(&function, level).unwrap(), Arc::default()).unwrap();
//! let mut out = [0.0; 20];
//! bound.run(&[&[1.5; 20]], &mut [&mut out]).unwrap();
//! assert!(out.iter().all(|&number| number == 3.0));
//! ```

#![deny(unsafe_code)]

mod abi;
mod backends;
mod blob;
mod cranelift;
mod entry;
mod error;
#[cfg(test)]
mod golden;
mod isa;
mod memory;
mod options;
mod prepare;
mod wide;

pub use backends::{BACKENDS, available};
pub use cranelift::Cranelift;
pub use entry::Kernel;
pub use error::CompileError;
pub use options::{Allocator, Check, OptLevel, Pieces, VectorCount};
pub use wide::Wide;
