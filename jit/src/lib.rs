//! Machine code for jbt programs: wide code of our own on x86-64 with AVX2 or AVX-512, elsewhere by
//! Cranelift.
//!
//! A verified function goes in, a [`Kernel`] comes out. Bound to the rows of its tables it takes planes of
//! numbers to planes of answers, and every lane has the bits that the scalar reference gives (a NaN for a
//! NaN).
//!
//! ```text
//!   Verified ──► strips ───► pressure ──► lower ─────────► memory ──► Kernel ──bind(Tables)──► BoundKernel
//!                where it    how many     Cranelift IR,    machine code                       run(inputs, outputs)
//!                is cut      are alive    by `vectors`     in pages
//! ```
//!
//! Wide code has a way of its own from the plan on, with the same result (`wide/`):
//!
//! ```text
//!   Verified ──► strips ───► wide: one list, registers in one walk, bytes ──► memory ──► Kernel
//! ```
//!
//! What the code does, in pseudo-code, with a block of K vectors of 4 points (8 or 16 in wide code):
//!
//! ```text
//! for offset in (0 .. points).step_by(4 * K):
//!     x = inputs[0][offset..], y = ..., z = ...                 K vectors each
//!     acc = initial                                             K vectors each
//!     for row in active[starts[parent row] .. starts[parent row + 1]]:
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
//! use jbt_ir::{Domain, FunctionBuilder, Tables, verify};
//! use jbt_jit::{CompileError, Kernel};
//!
//! let mut b = FunctionBuilder::new("twice", &["x"]);
//! let x = b.input(0);
//! let sum = b.add(x, x);
//! let function = verify(b.finish(&[("sum".to_owned(), sum)])).unwrap();
//!
//! let kernel = match Kernel::compile(&function) {
//!     Ok(kernel) => kernel,
//!     Err(CompileError::Processor { .. }) => return, // then interpret it
//!     Err(error) => panic!("{error}"),
//! };
//! let mut out = vec![0.0; Kernel::MAX_LANES];
//! let kernel = kernel.bind(Arc::new(Tables::default())).unwrap();
//! kernel.run(&[&[1.5; Kernel::MAX_LANES]], &mut [&mut out]).unwrap();
//! assert!(out.iter().all(|&number| number == 3.0));
//! ```

#![deny(unsafe_code)]

mod abi;
mod compile;
mod entry;
mod error;
mod isa;
mod lower;
mod memory;
mod options;
mod vectors;
mod wide;

pub use compile::{asm, clif};
pub use entry::{BoundKernel, Kernel, RunError};
pub use error::CompileError;
pub use options::{Allocator, Backend, Check, OptLevel, Options, Pieces, VectorCount};
