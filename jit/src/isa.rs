//! The processor that we compile for: the one that we run on, with the flags that suit short-lived vector
//! code.

use cranelift_codegen::isa::OwnedTargetIsa;
use cranelift_codegen::settings::{self, Configurable};

use crate::error::CompileError;
use crate::options::{Allocator, OptLevel};

/// The host, or what it lacks.
///
/// `fma` is an op whose result is rounded once, and without the instruction it would be a call for each lane:
/// then we decline. AVX is wanted for its three operand forms and its unaligned memory operands.
pub(crate) fn host(opt_level: OptLevel, allocator: Allocator) -> Result<OwnedTargetIsa, CompileError> {
    require()?;
    let flags = flags(opt_level, allocator).map_err(|error| CompileError::Cranelift(error.to_string()))?;
    let builder = cranelift_native::builder().map_err(|error| CompileError::Cranelift(error.to_owned()))?;
    builder.finish(flags).map_err(|error| CompileError::Cranelift(error.to_string()))
}

/// Asks the processor for what we need.
pub(crate) fn require() -> Result<(), CompileError> {
    missing_feature().map_or(Ok(()), |missing| Err(CompileError::Processor { missing }))
}

/// What the processor would need to have and has not.
#[cfg(target_arch = "x86_64")]
fn missing_feature() -> Option<&'static str> {
    if !std::is_x86_feature_detected!("avx") {
        Some("AVX")
    } else if !std::is_x86_feature_detected!("fma") {
        Some("FMA")
    } else {
        None
    }
}

/// What the processor would need to have and has not.
#[cfg(not(target_arch = "x86_64"))]
fn missing_feature() -> Option<&'static str> {
    Some("the x86-64 instruction set")
}

fn flags(opt_level: OptLevel, allocator: Allocator) -> Result<settings::Flags, settings::SetError> {
    let mut flags = settings::builder();
    flags.set("opt_level", opt_level.flag())?;
    flags.set("regalloc_algorithm", allocator.flag())?;
    // A large frame touches its pages in order, so that an overflow hits the guard page and nothing else.
    flags.set("enable_probestack", "true")?;
    flags.set("probestack_strategy", "inline")?;
    flags.set("enable_verifier", if cfg!(debug_assertions) { "true" } else { "false" })?;
    // Nothing unwinds through a kernel: it calls nothing and does not trap.
    flags.set("unwind_info", "false")?;
    flags.set("is_pic", "false")?;
    flags.set("use_colocated_libcalls", "false")?;
    Ok(settings::Flags::new(flags))
}
