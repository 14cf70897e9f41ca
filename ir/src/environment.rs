//! The floating-point environment that engines run in: the one of IEEE 754's defaults, whatever the host has
//! set.
//!
//! A host may flush subnormals to zero (audio programs do) or round in another direction, and then the same
//! program would give other bits. So every engine enters [`Standard`] before its first operation.

use std::marker::PhantomData;

/// The standard environment, from [`Standard::enter`] until it is dropped: round to nearest, subnormals kept,
/// no traps.
///
/// Dropping it restores what the caller had, also when a panic does it. It belongs to the thread that made
/// it. On CPUs other than x86-64 it does nothing: there, the environment has to be the standard one already.
///
/// The compiler does not know that the environment matters to arithmetic: what is to run in it stands in a
/// function that is not inlined.
#[must_use = "the environment lasts until this is dropped"]
#[derive(Debug)]
pub struct Standard {
    #[cfg(target_arch = "x86_64")]
    caller: u32,
    /// Keeps it on its thread.
    thread: PhantomData<*const ()>,
}

impl Standard {
    /// Changes the environment of this thread to the standard one.
    #[inline]
    pub fn enter() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let caller = mxcsr::get();
            mxcsr::set(mxcsr::STANDARD);
            Self { caller, thread: PhantomData }
        }
        #[cfg(not(target_arch = "x86_64"))]
        Self { thread: PhantomData }
    }
}

impl Drop for Standard {
    #[inline]
    fn drop(&mut self) {
        #[cfg(target_arch = "x86_64")]
        mxcsr::set(self.caller);
    }
}

/// The register that holds the environment of SSE, AVX and AVX-512.
#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
mod mxcsr {
    use std::arch::asm;

    /// Round to nearest, all exceptions masked, nothing flushed to zero, no flags raised.
    pub const STANDARD: u32 = 0x1F80;

    pub fn get() -> u32 {
        let mut bits: u32 = 0;
        // SAFETY: stmxcsr writes the four bytes that the pointer is to, and nothing else.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut bits, options(nostack, preserves_flags)) };
        bits
    }

    pub fn set(bits: u32) {
        // SAFETY: ldmxcsr reads the four bytes that the pointer is to. They are the standard, or what `get`
        // gave: so no reserved bit is set, and code of ours runs either in the environment that Rust assumes,
        // or in the one that its caller chose.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const bits, options(nostack, preserves_flags)) };
    }
}
