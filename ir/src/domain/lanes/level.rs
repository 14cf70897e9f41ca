//! Which instruction set a tape runs on. The `unsafe` here has one contract: a function that is compiled for an instruction set is
//! called on a CPU that has it. A [`Level`] proves that, for it only comes from [`Level::best`] and [`Level::available`],
//! which ask the CPU, and from [`Level::BASELINE`], which needs nothing.

use crate::environment::Standard;

use super::execute::{Job, execute};

/// An instruction set that this CPU has. Faster ones are larger.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Level(Kind);

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
enum Kind {
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// What the program was compiled for: every CPU that it runs on has this. On plain x86-64, `fma` is a call for each lane.
    pub const BASELINE: Self = Self(Kind::Baseline);

    /// The largest one that this CPU has. The CPU is asked once per process.
    #[must_use]
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            return Self(if has_avx512() { Kind::Avx512 } else { Kind::Avx2 });
        }
        Self::BASELINE
    }

    /// All that this CPU has, from the smallest.
    #[must_use]
    pub fn available() -> Vec<Self> {
        #[cfg(target_arch = "x86_64")]
        let kinds = [Kind::Baseline, Kind::Avx2, Kind::Avx512];
        #[cfg(not(target_arch = "x86_64"))]
        let kinds = [Kind::Baseline];
        kinds.into_iter().map(Self).filter(|&level| level <= Self::best()).collect()
    }

    /// A name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self.0 {
            Kind::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => "avx512",
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
}

/// Runs a job at a level, in the standard floating-point environment.
pub(super) fn run(level: Level, job: Job<'_, '_>) {
    let _environment = Standard::enter();
    match level.0 {
        Kind::Baseline => run_baseline(job),
        #[cfg(target_arch = "x86_64")]
        // SAFETY: a level of this kind is only made where `has_avx2` said yes.
        Kind::Avx2 => unsafe { run_avx2(job) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: a level of this kind is only made where `has_avx2` and `has_avx512` said yes.
        Kind::Avx512 => unsafe { run_avx512(job) },
    }
}

// None of these is inlined: no arithmetic of theirs may move out to where the environment is the caller's.

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
