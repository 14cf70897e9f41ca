//! The one door for engines: what makes programs that run, and what is asked of them.
//!
//! ```text
//!   Verified, Level ──Backend::compile──► dyn Program ──BoundProgram::new──► BoundProgram ──run_selected──► answers
//!                                                            ▲                                 │
//!                                                   Tables: checked once         selection, planes: checked at each run
//! ```
//!
//! A [`Backend`] says at which levels of the instruction set it makes programs, and whether this CPU runs
//! them. A [`Program`] runs points; what it is given has been checked by its door, [`BoundProgram`], and
//! cannot be had in another way ([`Run`]). So all engines refuse the same planes with the same [`RunError`],
//! and none of them looks at planes itself.
//!
//! What an engine needs besides (blocks that are filled up, memory of a run) is its own business.
//!
//! ```
//! use std::sync::Arc;
//! use jbt_ir::engine::{Backend, BoundProgram, Interpreter};
//! use jbt_ir::{Domain, FunctionBuilder, Level, verify};
//!
//! let mut b = FunctionBuilder::new("square", &["x"]);
//! let x = b.input(0);
//! let square = b.mul(x, x);
//! let function = Arc::new(verify(b.finish(&[("field".to_owned(), square)])).unwrap());
//!
//! let program = Interpreter.compile(&function, Level::best()).unwrap();
//! let bound = BoundProgram::new(program, Arc::default()).unwrap();
//! let mut field = [0.0; 3];
//! bound.run(&[&[1.0, 2.0, 3.0]], &mut [&mut field]).unwrap();
//! assert_eq!(field, [1.0, 4.0, 9.0]);
//! ```

mod backend;
mod lanes;
mod planes;
mod program;
mod scalar;

pub use backend::{Backend, Declined, Form, choose};
pub use lanes::Interpreter;
pub use planes::RunError;
pub(crate) use planes::check;
pub use program::{BoundProgram, Interface, Planes, Program, Run};
pub use scalar::Reference;
