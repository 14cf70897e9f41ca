//! Machine code by Cranelift: vectors of 128 bits, on every x86-64 with AVX and FMA.
//!
//! ```text
//!   Verified ──► strips ───► pressure ──► lower ─────────► memory ──► Kernel
//!                where it    how many     Cranelift IR,    machine code
//!                is cut      are alive    by `vectors`     in pages
//! ```

mod aside;
pub(crate) mod lower;
mod vectors;

use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;

use cranelift_codegen::Context;
use cranelift_codegen::control::ControlPlane;
use jbt_ir::engine::{Backend, Declined, Form, Program};
use jbt_ir::limits::MAX_JIT_LIVE_VALUES;
use jbt_ir::plan::Plan;
use jbt_ir::plan::pressure::{self, FIELD_CARRIES};
use jbt_ir::{Function, Level, Verified, watch};

use crate::entry::Kernel;
use crate::error::CompileError;
use crate::memory::MachineCode;
use crate::options::{Allocator, OptLevel, Pieces, VectorCount, asm};
use crate::{isa, prepare};

/// Lanes of one vector.
const LANES: usize = 4;

/// Up to this many live values the code is faster for having 16 points in a block: what is spilled costs less
/// than reading every number of a row four times.
const FOUR_VECTORS_UP_TO: usize = 14;
/// Up to this many live values 8 points are faster than 16; beyond, than 4 by so little that compiling twice
/// as much is a waste.
const TWO_VECTORS_UP_TO: usize = 27;
/// The same for a field.
const TWO_VECTORS_OF_A_FIELD_UP_TO: usize = 64;
/// Up to this many live values a good choice of registers is worth its time. Beyond, nearly everything lives
/// in the frame whichever allocator chose, and the code of both runs at the same speed.
const BACKTRACKING_UP_TO: usize = 100;
/// A function with more values than this would take seconds to compile for 16 points in a block.
const LONG_FUNCTION: usize = 16_000;
/// What compiling takes for a value: 3.4 KB were seen.
const COMPILE_BYTES: usize = 4_000;
/// Functions with more values than this are compiled on a thread that is not waited for once nobody wants
/// them: shorter ones take some 20 ms at most.
const ASIDE_FROM: usize = 1_000;
/// A function of at most so many values gains nothing by being cut: with all its rows in the caches it is as
/// fast, and where few points are asked it has less to do.
const WHOLE_UP_TO: usize = 1_000;

/// Cranelift with its settings. They change the time that compiling and running takes, and no bit of an
/// answer. What is `None` is chosen by the function.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cranelift {
    /// Vectors for each value.
    pub vectors: Option<VectorCount>,
    /// Effort.
    pub opt_level: OptLevel,
    /// Register allocator.
    pub allocator: Option<Allocator>,
    /// How a function is cut.
    pub pieces: Option<Pieces>,
}

/// What is made of a function, with nothing left open.
struct ChosenPlan {
    plan: Plan,
    vectors: VectorCount,
    allocator: Allocator,
}

impl Cranelift {
    /// The settings that measurements favour for each function.
    pub const STANDARD: Self =
        Self { vectors: None, opt_level: OptLevel::None, allocator: None, pieces: None };

    /// Compiles a function.
    ///
    /// # Errors
    /// When the processor, a limit or the system forbids it.
    pub fn kernel(&self, function: &Verified) -> Result<Kernel, CompileError> {
        let outside = function.function();
        prepare::check(outside)?;
        watch::take(outside.values.len() * COMPILE_BYTES);
        let ChosenPlan { plan, vectors, allocator } = self.choose(outside)?;
        let isa = isa::host(self.opt_level, allocator)?;
        let lanes = vectors.count() * LANES;
        let lowered = guard(|| lower::lower(outside, &plan, vectors))?;
        let compile = move || guard(|| MachineCode::new(lowered, lanes, isa));
        let is_long = outside.values.len() > ASIDE_FROM;
        let code = if is_long { aside::aside(compile)?? } else { compile()?? };
        Ok(Kernel::new(code, outside))
    }

    /// The Cranelift IR of a function as text. Needs no particular processor.
    ///
    /// # Errors
    /// When the function is beyond our limits.
    pub fn clif(&self, function: &Verified) -> Result<String, CompileError> {
        let function = function.function();
        let ChosenPlan { plan, vectors, .. } = self.choose(function)?;
        guard(|| lower::lower(function, &plan, vectors).into_function().display().to_string())
    }

    /// The machine instructions of a function, registers chosen, as text.
    ///
    /// # Errors
    /// Those of [`kernel`](Self::kernel).
    pub fn asm(&self, function: &Verified) -> Result<String, CompileError> {
        let function = function.function();
        let ChosenPlan { plan, vectors, allocator } = self.choose(function)?;
        let isa = isa::host(self.opt_level, allocator)?;
        guard(|| {
            let mut context = Context::for_function(lower::lower(function, &plan, vectors).into_function());
            context.set_disasm(true);
            let compiled = context.compile(&*isa, &mut ControlPlane::default());
            let compiled = compiled.map_err(|error| CompileError::Cranelift(error.inner.to_string()))?;
            Ok(compiled.vcode.clone().unwrap_or_default())
        })?
    }

    /// Fills in what is open.
    ///
    /// # Errors
    /// When the function is beyond our limits.
    fn choose(&self, function: &Function) -> Result<ChosenPlan, CompileError> {
        prepare::check(function)?;
        let plan = prepare::plan(function, self.pieces, WHOLE_UP_TO);
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
        Ok(ChosenPlan {
            plan,
            vectors: self.vectors.unwrap_or(vectors),
            allocator: self.allocator.unwrap_or(allocator),
        })
    }
}

impl Backend for Cranelift {
    fn name(&self) -> &'static str {
        "cranelift"
    }

    /// The code is that of this CPU at every level: none is made for another one.
    fn covers(&self, _: Level) -> bool {
        true
    }

    fn supports(&self, level: Level) -> Result<(), Declined> {
        level.require()?;
        Ok(isa::require()?)
    }

    fn compile(&self, function: &Arc<Verified>, _: Level) -> Result<Arc<dyn Program>, Declined> {
        Ok(Arc::new(self.kernel(function)?))
    }

    fn forms(&self) -> &'static [Form] {
        const CLIF: Form = Form {
            name: "clif",
            what: "The program in Cranelift's language.",
            text: |function, _| Ok(Cranelift::STANDARD.clif(function)?),
        };
        const INSTRUCTIONS: Form = asm(|function, _| Ok(Cranelift::STANDARD.asm(function)?));
        &[CLIF, INSTRUCTIONS]
    }
}

/// Cranelift panics where one of its own limits is exceeded. Ours are below those; this is for the case that
/// they are not.
fn guard<T>(work: impl FnOnce() -> T) -> Result<T, CompileError> {
    panic::catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        if watch::is_stop(&*panic) {
            panic::resume_unwind(panic);
        }
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
        CompileError::Cranelift(text.to_owned())
    })
}
