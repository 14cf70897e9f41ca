//! From a verified function to code: the limits, the choice of settings, and the errors.

use std::panic::{self, AssertUnwindSafe};

use cranelift_codegen::Context;
use cranelift_codegen::control::ControlPlane;
use jbt_ir::limits::{MAX_JIT_LIVE_VALUES, MAX_JIT_VALUES};
use jbt_ir::{Function, Inst, InstKind, Op, Verified};

use crate::memory::Code;
use crate::strips::Plan;
use crate::{isa, lower, pressure};

/// Vectors of 4 lanes for each value.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum VectorCount {
    /// Blocks of 4 points.
    One,
    /// Blocks of 8 points.
    Two,
    /// Blocks of 16 points.
    Four,
}

impl VectorCount {
    /// All counts.
    pub const ALL: [Self; 3] = [Self::One, Self::Two, Self::Four];

    /// Points in a block.
    #[must_use]
    pub const fn lanes(self) -> usize {
        match self {
            Self::One => 4,
            Self::Two => 8,
            Self::Four => 16,
        }
    }
}

/// How hard Cranelift tries to improve the code. The passes of the IR have done most of it already.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum OptLevel {
    /// Hardly: the fastest way to good code, since common subexpressions are gone already.
    #[default]
    None,
    /// For speed. Compile time grows faster than the function.
    Speed,
    /// For speed and size.
    SpeedAndSize,
}

impl OptLevel {
    /// All levels.
    pub const ALL: [Self; 3] = [Self::None, Self::Speed, Self::SpeedAndSize];

    /// The value of Cranelift's flag.
    pub(crate) const fn flag(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Speed => "speed",
            Self::SpeedAndSize => "speed_and_size",
        }
    }
}

/// How values are given registers.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Allocator {
    /// Well. Compile time grows with the square of the number of vectors that are alive at once.
    Backtracking,
    /// In one pass, in linear time. Code whose values would fit the registers runs at half the speed.
    SinglePass,
}

impl Allocator {
    /// All allocators.
    pub const ALL: [Self; 2] = [Self::Backtracking, Self::SinglePass];

    /// The value of Cranelift's flag.
    pub(crate) const fn flag(self) -> &'static str {
        match self {
            Self::Backtracking => "backtracking",
            Self::SinglePass => "single_pass",
        }
    }
}

/// How a function is cut. Each piece runs over a strip of points before the next piece does.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Pieces {
    /// Not at all: a block of points runs through the whole function before the next block does.
    One,
    /// Into pieces of at most so many instructions, with a cut before and behind every fold. If the values that pieces hand to each
    /// other are too many for the nearer caches, not at all.
    Of(usize),
}

/// Settings of the compiler. What is `None` is chosen by the size of the function.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Options {
    /// Vectors for each value.
    pub vectors: Option<VectorCount>,
    /// Effort.
    pub opt_level: OptLevel,
    /// Register allocator.
    pub allocator: Option<Allocator>,
    /// How a function is cut.
    pub pieces: Option<Pieces>,
}

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
    /// The system refuses executable memory.
    #[error("the system refuses memory for machine code: {0}")]
    Memory(String),
    /// Cranelift fails.
    #[error("the code generator fails: {0}")]
    Cranelift(String),
}

/// Up to this many live values the code is faster for having 16 points in a block: what is spilled costs less than reading every
/// number of a row four times.
const FOUR_VECTORS_UP_TO: usize = 14;
/// Where loops carry at most this many, a function is a field, and not a gradient or attributes: more points in a block pay longer.
const FIELD_CARRIES: usize = 3;
/// Up to this many live values 8 points are faster than 16; beyond, than 4 by so little that compiling twice as much is a waste.
const TWO_VECTORS_UP_TO: usize = 27;
/// The same for a field.
const TWO_VECTORS_OF_A_FIELD_UP_TO: usize = 64;
/// Up to this many live values a good choice of registers is worth its time. Beyond, nearly everything lives in the frame
/// whichever allocator chose, and the code of both runs at the same speed.
const BACKTRACKING_UP_TO: usize = 100;
/// A function with more values than this would take seconds to compile for 16 points in a block.
const LONG_FUNCTION: usize = 16_000;

/// A function of at most so many values gains nothing by being cut: with all its rows in the caches it is as fast, and where few
/// points are asked it has less to do.
const WHOLE_UP_TO: usize = 1_000;
/// Instructions of a piece: its code fits what the processor keeps decoded, and what one block of points waits for in it leaves room for
/// the next block to begin. From 100 to 500 the speed is the same.
const PIECE: usize = 200;
/// Bytes of slots beyond which they are not in the nearer caches when the next piece reads them.
const MOST_SLOT_BYTES: usize = 256 << 10;

/// What is made of a function, with nothing left open.
struct Choice {
    plan: Plan,
    vectors: VectorCount,
    allocator: Allocator,
}

impl Options {
    /// Fills in what is open.
    ///
    /// # Errors
    /// When the function is beyond our limits.
    fn choose(&self, function: &Function) -> Result<Choice, CompileError> {
        check(function)?;
        let plan = self.plan(function);
        let live = pressure::live_values(function, &plan);
        if live > MAX_JIT_LIVE_VALUES {
            return Err(CompileError::LiveValues { live, limit: MAX_JIT_LIVE_VALUES });
        }
        let long = function.values.len() > LONG_FUNCTION;
        let field = pressure::carried_values(function) <= FIELD_CARRIES;
        let few = if field { TWO_VECTORS_OF_A_FIELD_UP_TO } else { TWO_VECTORS_UP_TO };
        let (vectors, allocator) = if live > BACKTRACKING_UP_TO {
            (if long { VectorCount::One } else { VectorCount::Four }, Allocator::SinglePass)
        } else if live <= FOUR_VECTORS_UP_TO && field && !long {
            (VectorCount::Four, Allocator::Backtracking)
        } else if live <= few || long {
            (VectorCount::Two, Allocator::Backtracking)
        } else {
            (VectorCount::One, Allocator::Backtracking)
        };
        Ok(Choice {
            plan,
            vectors: self.vectors.unwrap_or(vectors),
            allocator: self.allocator.unwrap_or(allocator),
        })
    }

    /// The pieces.
    fn plan(&self, function: &Function) -> Plan {
        let is_short = function.values.len() <= WHOLE_UP_TO;
        let plan = match self.pieces.unwrap_or(if is_short { Pieces::One } else { Pieces::Of(PIECE) }) {
            Pieces::One => Plan::whole(function),
            Pieces::Of(longest) => Plan::cut(function, longest),
        };
        if plan.slot_bytes() > MOST_SLOT_BYTES { Plan::whole(function) } else { plan }
    }
}

/// Compiles a function.
pub(crate) fn compile(function: &Verified, options: &Options) -> Result<(Code, VectorCount), CompileError> {
    let function = function.function();
    let Choice { plan, vectors, allocator } = options.choose(function)?;
    let isa = isa::host(options.opt_level, allocator)?;
    let code = guard(|| Code::new(lower::lower(function, &plan, vectors), isa))??;
    Ok((code, vectors))
}

/// The Cranelift IR that [`crate::Kernel::compile`] makes of a function, as text. Needs no particular processor.
///
/// # Errors
/// When the function is beyond our limits.
pub fn clif(function: &Verified) -> Result<String, CompileError> {
    let function = function.function();
    let Choice { plan, vectors, .. } = Options::default().choose(function)?;
    guard(|| lower::lower(function, &plan, vectors).into_function().display().to_string())
}

/// The machine instructions that [`crate::Kernel::compile_with`] makes of a function, registers chosen, as text.
///
/// # Errors
/// Those of [`crate::Kernel::compile_with`].
pub fn asm(function: &Verified, options: &Options) -> Result<String, CompileError> {
    let function = function.function();
    let Choice { plan, vectors, allocator } = options.choose(function)?;
    let isa = isa::host(options.opt_level, allocator)?;
    guard(|| {
        let mut context = Context::for_function(lower::lower(function, &plan, vectors).into_function());
        context.set_disasm(true);
        let compiled = context.compile(&*isa, &mut ControlPlane::default());
        let compiled = compiled.map_err(|error| CompileError::Cranelift(error.inner.to_string()))?;
        Ok(compiled.vcode.clone().unwrap_or_default())
    })?
}

/// Looks for what we decline before anything is planned.
fn check(function: &Function) -> Result<(), CompileError> {
    let values = function.values.len();
    if values > MAX_JIT_VALUES {
        return Err(CompileError::Values { values, limit: MAX_JIT_VALUES });
    }
    for (inst, data) in function.insts.iter() {
        match data.kind {
            InstKind::Op { op, .. } if op.is_expanded() => return Err(CompileError::Op { op, inst }),
            InstKind::Op { .. }
            | InstKind::Input(_)
            | InstKind::Constant(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. }
            | InstKind::Fold(_) => {}
        }
    }
    Ok(())
}

/// Cranelift panics where one of its own limits is exceeded. Ours are below those; this is for the case that they are not.
fn guard<T>(work: impl FnOnce() -> T) -> Result<T, CompileError> {
    panic::catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
        CompileError::Cranelift(text.to_owned())
    })
}
