//! The door to wide code: its settings, and the functions that a kernel consists of.

use std::sync::Arc;

use jbt_ir::engine::{Backend, Declined, Form, Program};
use jbt_ir::pass::{Gates, gates};
use jbt_ir::plan::Plan;
use jbt_ir::{Function, Level, Verified, watch};

use super::{EmitterWish, emit, lanes};
use crate::blob::{CodeBlob, Emitted};
use crate::entry::Kernel;
use crate::error::CompileError;
use crate::memory::MachineCode;
use crate::options::{Check, Pieces, VectorCount, asm};
use crate::prepare;

/// A function of at most so many values gains nothing by being cut.
const WHOLE_UP_TO: usize = 1_000;

/// What emitting takes for a value: 250 bytes were seen.
const EMIT_BYTES: usize = 400;

/// The emitter of wide code with its settings. They change the time that compiling and running takes, and no
/// bit of an answer. What is `None` is chosen by the level and the function.
///
/// It covers levels from [`Level::Avx2`] on; [`Level::Baseline`] is taken for that one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Wide {
    /// Vectors for each value. Where they are open, there is a second function of one vector, for points that
    /// fill no larger block.
    pub vectors: Option<VectorCount>,
    /// How a function is cut.
    pub pieces: Option<Pieces>,
    /// How the code is checked while it is made.
    pub check: Check,
}

impl Wide {
    /// The settings that measurements favour for each function.
    pub const STANDARD: Self = Self { vectors: None, pieces: None, check: Check::Off };

    /// Lanes of one vector.
    #[must_use]
    pub const fn lanes(level: Level) -> usize {
        lanes(level)
    }

    /// Compiles a function for a level of this CPU.
    ///
    /// # Errors
    /// When the processor, a limit or the system forbids it.
    pub fn kernel(&self, function: &Verified, level: Level) -> Result<Kernel, CompileError> {
        require(level)?;
        let code = MachineCode::from_emitted(&self.emit(function, level)?)?;
        Ok(Kernel::new(code, function.function()))
    }

    /// The machine instructions of a function as text, of any level on any machine, if the build has the
    /// feature `listing`.
    ///
    /// # Errors
    /// When the function is beyond our limits; in a build without the feature.
    pub fn asm(&self, function: &Verified, level: Level) -> Result<String, CompileError> {
        listing(&self.emit(function, level)?)
    }

    /// Code for a level, which this CPU need not have.
    pub(crate) fn emit(&self, function: &Verified, level: Level) -> Result<Emitted, CompileError> {
        let function = function.function();
        prepare::check(function)?;
        watch::take(function.values.len() * EMIT_BYTES);
        let wish = EmitterWish {
            level: level.max(Level::Avx2),
            vectors: self.vectors,
            is_checked: self.check != Check::Off,
            few_registers: self.check == Check::FewRegisters,
        };
        let plan = prepare::plan(function, self.pieces, WHOLE_UP_TO);
        let gates = gates(function);
        let blocks = emit(function, (&plan, &gates), &wish)?;
        let rest = match self.vectors {
            // Whoever wishes so many vectors gets them at each point.
            Some(_) => None,
            None => emit_rest(function, (&plan, &gates), &wish, blocks.lanes)?,
        };
        Ok(Emitted { blocks, rest })
    }
}

impl Backend for Wide {
    fn name(&self) -> &'static str {
        "wide"
    }

    fn covers(&self, level: Level) -> bool {
        match level {
            Level::Baseline => false,
            Level::Avx2 | Level::Avx512Vl | Level::Avx512 => true,
        }
    }

    fn supports(&self, level: Level) -> Result<(), Declined> {
        Ok(require(level)?)
    }

    fn compile(&self, function: &Arc<Verified>, level: Level) -> Result<Arc<dyn Program>, Declined> {
        Ok(Arc::new(self.kernel(function, level)?))
    }

    fn forms(&self) -> &'static [Form] {
        const INSTRUCTIONS: Form = asm(|function, level| Ok(Wide::STANDARD.asm(function, level)?));
        &[INSTRUCTIONS]
    }
}

/// Asks the CPU for a level.
fn require(level: Level) -> Result<(), CompileError> {
    let level = level.max(Level::Avx2);
    let missing = |_| CompileError::Processor { missing: level.name() };
    level.require().map_err(missing)
}

/// Code for a few points: rays, boxes and small bricks have no more, and would compute a large block for
/// them. None if it would be no smaller.
fn emit_rest(
    function: &Function,
    (plan, gates): (&Plan, &Gates),
    wish: &EmitterWish,
    block: usize,
) -> Result<Option<CodeBlob>, CompileError> {
    if block <= lanes(wish.level) {
        return Ok(None);
    }
    let wish = EmitterWish { vectors: Some(VectorCount::One), ..*wish };
    // A strip of one block has nothing to share: pieces would but store what they hand to each other.
    match emit(function, (&Plan::whole(function), gates), &wish) {
        Err(CompileError::Frame { .. }) if !plan.is_whole() => emit(function, (plan, gates), &wish).map(Some),
        emitted => emitted.map(Some),
    }
}

#[cfg(any(feature = "listing", test))]
fn listing(emitted: &Emitted) -> Result<String, CompileError> {
    Ok(super::listing::listing(emitted))
}

#[cfg(not(any(feature = "listing", test)))]
const fn listing(_: &Emitted) -> Result<String, CompileError> {
    Err(CompileError::Listing)
}
