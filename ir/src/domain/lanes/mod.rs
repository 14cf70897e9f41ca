//! The SIMD interpreter: each op runs over a block of points before the next op starts.
//!
//! A [`Tape`] is compiled once from a function, then run on planes of points of any length. Two things make
//! it fast: *what* to do is decided once per op and block instead of once per op and point, and values that
//! are the same for all points are never spread out.
//!
//! ```text
//!    Function ──schedule──► events in order, live ranges, which values are splats
//!             ──assign────► a register for each value; a loop's accumulator and its next value share one
//!             ──compile───► Tape: steps, constants, folds
//!                          two ops of which one feeds the other become one step (pairs)
//!             ──execute───► for each block of points: for each step: a loop over lanes, vectorised
//!
//!    register file, `stride` chunks a row:     r0       r1       r2      ...
//!      points  0..32                        [ chunk ][ chunk ][ chunk ]         a chunk: 32 lanes of 4 bytes
//!      points 32..64                        [ chunk ][ chunk ][ chunk ]
//!      ...                                                        as many rows as fit the first-level cache
//! ```
//!
//! A value is a *block* (a register: one number per point) or a *splat* (one number for all points: a
//! constant, a column of the current row, or a value computed from splats alone). Every op takes either in
//! each operand, through a loop made for that combination.
//!
//! **The bits are those of [`Scalar`](super::scalar::Scalar)**, because each lane loop calls its methods. The
//! loops are plain Rust that is inlined into one function per [`Level`] of the instruction set, chosen when
//! the program runs.

mod assign;
mod compile;
mod execute;
#[allow(unsafe_code)]
mod level;
mod ops;
mod pairs;
mod place;
mod run;
mod schedule;
mod tape;
#[cfg(test)]
mod tests;

pub use crate::level::Level;
pub use ops::WIDTH;
pub use run::NotLegalized;
pub use tape::{Scratch, Tape};
