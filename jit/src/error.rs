//! Why there is no machine code for a function.

use jbt_ir::engine::Declined;
use jbt_ir::{Inst, Op};

/// Why there is no machine code for a function. An interpreter can run it all the same.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum CompileError {
    /// The processor is not one that we make code for.
    #[error("machine code needs a processor with {missing}")]
    Processor {
        /// What it lacks.
        missing: &'static str,
    },
    /// The function has too many values.
    #[error("the function has {values} values, machine code is made for at most {limit}")]
    Values {
        /// Values of the function.
        values: usize,
        /// Values that are allowed.
        limit: usize,
    },
    /// Too many values are alive at once.
    #[error("{live} values are alive at once, machine code is made for at most {limit}")]
    LiveValues {
        /// Values alive at once.
        live: usize,
        /// Values that are allowed.
        limit: usize,
    },
    /// The code would take too much of the stack.
    #[error("the code needs {bytes} bytes of stack, at most {limit} are allowed")]
    Frame {
        /// Bytes that it needs.
        bytes: usize,
        /// Bytes that are allowed.
        limit: usize,
    },
    /// The function has an op that the legalize pass has to expand first.
    #[error("{inst}: {} has no machine instruction and is expanded before", op.name())]
    Op {
        /// The op.
        op: Op,
        /// The first instruction that has it.
        inst: Inst,
    },
    /// Code was checked, and reads what it should not: a defect of the emitter.
    #[error("wide code is wrong: {0}")]
    Registers(String),
    /// The build has no decoder to list wide code with.
    #[error("this build lists no wide code (cargo feature `listing`)")]
    Listing,
    /// The system refuses executable memory.
    #[error("the system refuses memory for machine code: {0}")]
    Memory(String),
    /// Cranelift fails.
    #[error("the code generator fails: {0}")]
    Cranelift(String),
}

impl From<CompileError> for Declined {
    fn from(error: CompileError) -> Self {
        Self { reason: error.to_string() }
    }
}
