//! Runs a tape at a [`Level`] of the instruction set. The `unsafe` here has one contract: a function that is
//! compiled for an instruction set is called only on a CPU that has it. A level that this CPU lacks is
//! replaced by the largest level that it has.

use crate::environment::Standard;
use crate::level::Level;

use super::execute::{Job, execute};

/// Runs a job at a level, in the standard floating-point environment.
pub(super) fn run(level: Level, job: Job<'_, '_>) {
    let _environment = Standard::enter();
    match level.min(Level::of_cpu()) {
        Level::Baseline => run_baseline(job),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the level is at most that of the CPU.
        Level::Avx2 | Level::Avx512Vl => unsafe { run_avx2(job) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the level is at most that of the CPU.
        Level::Avx512 => unsafe { run_avx512(job) },
        #[cfg(not(target_arch = "x86_64"))]
        Level::Avx2 | Level::Avx512Vl | Level::Avx512 => {
            unreachable!("such a CPU has no more than the baseline")
        }
    }
}

// None of these is inlined: their arithmetic must not move out to code that runs in the caller's environment.

#[inline(never)]
fn run_baseline(job: Job<'_, '_>) {
    execute(job);
}

#[cfg(target_arch = "x86_64")]
#[inline(never)]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(job: Job<'_, '_>) {
    execute(job);
}

#[cfg(target_arch = "x86_64")]
#[inline(never)]
#[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq,avx512bw")]
fn run_avx512(job: Job<'_, '_>) {
    execute(job);
}
