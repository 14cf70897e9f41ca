//! From a verified function to code: the limits, and the choice of settings.

use std::panic::{self, AssertUnwindSafe};

use cranelift_codegen::Context;
use cranelift_codegen::control::ControlPlane;
use jbt_ir::limits::{MAX_JIT_LIVE_VALUES, MAX_JIT_VALUES};
use jbt_ir::pass::{Gates, gates};
use jbt_ir::plan::Plan;
use jbt_ir::plan::pressure::{self, FIELD_CARRIES};
use jbt_ir::{Function, InstKind, Level, Verified};

use crate::error::CompileError;
use crate::memory::Code;
use crate::options::{Allocator, Backend, Check, Options, Pieces, VectorCount};
use crate::wide::{self, Blob, Emitted, Wish};
use crate::{isa, lower};

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

/// A function of at most so many values gains nothing by being cut: with all its rows in the caches it is as
/// fast, and where few points are asked it has less to do.
const WHOLE_UP_TO: usize = 1_000;
/// The same for wide code.
const WIDE_WHOLE_UP_TO: usize = 1_000;
/// Instructions of a piece: its code fits what the processor keeps decoded, and what one block of points
/// waits for in it leaves room for the next block to begin. From 100 to 500 the speed is the same.
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
        let plan = self.plan(function, WHOLE_UP_TO);
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
    fn plan(&self, function: &Function, whole_up_to: usize) -> Plan {
        let is_short = function.values.len() <= whole_up_to;
        let plan = match self.pieces.unwrap_or(if is_short { Pieces::One } else { Pieces::Of(PIECE) }) {
            Pieces::One => Plan::whole(function),
            Pieces::Of(longest) => Plan::cut(function, longest),
        };
        if plan.slot_bytes() > MOST_SLOT_BYTES { Plan::whole(function) } else { plan }
    }
}

/// Compiles a function.
pub(crate) fn compile(function: &Verified, options: &Options) -> Result<Code, CompileError> {
    match options.backend.unwrap_or_else(Backend::best) {
        Backend::Cranelift => by_cranelift(function.function(), options),
        Backend::Wide(level) if !level.max(Level::Avx2).is_available() => {
            Err(CompileError::Processor { missing: level.max(Level::Avx2).name() })
        }
        Backend::Wide(level) => {
            let emitted = emit(function, level, options)?;
            Code::from_emitted(&emitted, isa::host(options.opt_level, Allocator::SinglePass)?)
        }
    }
}

/// Wide code for a level, which this CPU need not have.
pub(crate) fn emit(function: &Verified, level: Level, options: &Options) -> Result<Emitted, CompileError> {
    let function = function.function();
    check(function)?;
    let wish = Wish {
        level: level.max(Level::Avx2),
        vectors: options.vectors,
        is_checked: options.check != Check::Off,
        few_registers: options.check == Check::FewRegisters,
    };
    let plan = options.plan(function, WIDE_WHOLE_UP_TO);
    let gates = gates(function);
    let blocks = wide::emit(function, (&plan, &gates), &wish)?;
    let rest = match options.vectors {
        // Whoever wishes so many vectors gets them at each point.
        Some(_) => None,
        None => emit_rest(function, (&plan, &gates), &wish, blocks.lanes)?,
    };
    Ok(Emitted { blocks, rest })
}

/// Code for a few points: rays, boxes and small bricks have no more, and would compute a large block for
/// them. None if it would be no smaller.
fn emit_rest(
    function: &Function,
    (plan, gates): (&Plan, &Gates),
    wish: &Wish,
    lanes: usize,
) -> Result<Option<Blob>, CompileError> {
    if lanes <= Backend::Wide(wish.level).lanes() {
        return Ok(None);
    }
    let wish = Wish { vectors: Some(VectorCount::One), ..*wish };
    // A strip of one block has nothing to share: pieces would but store what they hand to each other.
    match wide::emit(function, (&Plan::whole(function), gates), &wish) {
        Err(CompileError::Frame { .. }) if !plan.is_whole() => {
            wide::emit(function, (plan, gates), &wish).map(Some)
        }
        emitted => emitted.map(Some),
    }
}

fn by_cranelift(function: &Function, options: &Options) -> Result<Code, CompileError> {
    let Choice { plan, vectors, allocator } = options.choose(function)?;
    let isa = isa::host(options.opt_level, allocator)?;
    let lanes = vectors.count() * Backend::Cranelift.lanes();
    guard(|| Code::new(lower::lower(function, &plan, vectors), lanes, isa))?
}

/// The Cranelift IR that [`crate::Kernel::compile`] makes of a function, as text. Needs no particular
/// processor.
///
/// # Errors
/// When the function is beyond our limits.
pub fn clif(function: &Verified) -> Result<String, CompileError> {
    let function = function.function();
    let Choice { plan, vectors, .. } = Options::default().choose(function)?;
    guard(|| lower::lower(function, &plan, vectors).into_function().display().to_string())
}

/// The machine instructions that [`crate::Kernel::compile_with`] makes of a function, registers chosen, as
/// text. Wide code of any level is listed on any machine, if the build has the feature `listing`.
///
/// # Errors
/// Those of [`crate::Kernel::compile_with`].
pub fn asm(function: &Verified, options: &Options) -> Result<String, CompileError> {
    if let Backend::Wide(level) = options.backend.unwrap_or_else(Backend::best) {
        return listing(&emit(function, level, options)?);
    }
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

#[cfg(feature = "listing")]
fn listing(emitted: &Emitted) -> Result<String, CompileError> {
    Ok(wide::listing::listing(emitted))
}

#[cfg(not(feature = "listing"))]
const fn listing(_: &Emitted) -> Result<String, CompileError> {
    Err(CompileError::Listing)
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

/// Cranelift panics where one of its own limits is exceeded. Ours are below those; this is for the case that
/// they are not.
fn guard<T>(work: impl FnOnce() -> T) -> Result<T, CompileError> {
    panic::catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
        CompileError::Cranelift(text.to_owned())
    })
}
