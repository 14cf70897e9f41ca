//! Registers of 32-bit reals, one type for each instruction set, and the choice between them when the program
//! runs.
//!
//! The `unsafe` here has one contract: an instruction runs on a CPU that has it. The register types are
//! private to this file; the rest of the module meets them as a type parameter of [`Job::run`] only, which
//! [`dispatch`] calls on a CPU that it has asked.

/// A register. Arithmetic rounds to nearest, lane by lane.
pub(super) trait Vector: Copy {
    /// Reals in a register.
    const LANES: usize;

    /// The same real in each lane.
    fn splat(value: f32) -> Self;
    /// The reals that a slice begins with. Panics if it is shorter than a register.
    fn load(from: &[f32]) -> Self;
    /// Writes the reals that a slice begins with. Panics if it is shorter than a register.
    fn store(self, to: &mut [f32]);
    /// `self + other`
    fn add(self, other: Self) -> Self;
    /// `self - other`
    fn sub(self, other: Self) -> Self;
    /// `self * other`
    fn mul(self, other: Self) -> Self;
    /// `self / other`
    fn div(self, other: Self) -> Self;
    /// `self > other ? self : other`, so `other` where one is NaN.
    fn max(self, other: Self) -> Self;
    /// `self < other ? self : other`, so `other` where one is NaN.
    fn min(self, other: Self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// `self * factor + term`, rounded once (twice by [`Plain`]).
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// `term - self * factor`, rounded once (twice by [`Plain`]).
    fn mul_sub_from(self, factor: Self, term: Self) -> Self;
    /// A bit for each lane, the first lane's lowest: `self >= other`.
    fn at_least(self, other: Self) -> u32;
}

/// Work that is written once for registers of any kind.
pub(super) trait Job {
    /// What it answers.
    type Output;

    /// Does the work. Has to be `#[inline(always)]`, and all that it calls with registers too, so that all of
    /// it is compiled for the instruction set of its caller.
    fn run<V: Vector>(self) -> Self::Output;
}

/// The name of the instruction set that [`dispatch`] takes: the best that this CPU has and `JBT_LEVEL`
/// allows.
pub(super) fn level() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if x86::has_avx512() {
            return "avx512";
        }
        if x86::has_avx2() {
            return "avx2";
        }
    }
    "plain"
}

/// Runs a job with the widest registers that this CPU has and `JBT_LEVEL` allows.
pub(super) fn dispatch<J: Job>(job: J) -> J::Output {
    #[cfg(target_arch = "x86_64")]
    {
        if x86::has_avx512() {
            // SAFETY: the CPU has just said that it has what this function is compiled for.
            return unsafe { x86::run_avx512(job) };
        }
        if x86::has_avx2() {
            // SAFETY: the CPU has just said that it has what this function is compiled for.
            return unsafe { x86::run_avx2(job) };
        }
    }
    job.run::<Plain<8>>()
}

/// Runs a job as on a CPU without any of the instructions, in registers of 8 reals as AVX2 has them, or of 16
/// as AVX-512.
#[cfg(test)]
pub(super) fn run_plain<const N: usize, J: Job>(job: J) -> J::Output {
    job.run::<Plain<N>>()
}

/// Reals in loops, for CPUs without the instructions. Its fused operations are not fused, for fusing in
/// software is slow.
#[derive(Clone, Copy)]
struct Plain<const N: usize>([f32; N]);

impl<const N: usize> Plain<N> {
    #[inline(always)]
    fn zip(self, other: Self, operation: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|lane| operation(self.0[lane], other.0[lane])))
    }
}

impl<const N: usize> Vector for Plain<N> {
    const LANES: usize = N;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self([value; N])
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        Self(std::array::from_fn(|lane| from[lane]))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[..N].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f32::sqrt))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self.mul(factor).add(term)
    }
    #[inline(always)]
    fn mul_sub_from(self, factor: Self, term: Self) -> Self {
        term.sub(self.mul(factor))
    }
    #[inline(always)]
    fn at_least(self, other: Self) -> u32 {
        (0..N).fold(0, |mask, lane| mask | u32::from(self.0[lane] >= other.0[lane]) << lane)
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    //! The registers of x86-64.

    use std::arch::x86_64::*;

    use jbt::Level;

    use super::{Job, Vector};

    /// Whether this CPU has AVX2 and FMA, and they may be used: `JBT_LEVEL` bounds everybody alike.
    pub(super) fn has_avx2() -> bool {
        Level::best() >= Level::Avx2
    }

    /// The same for AVX-512.
    pub(super) fn has_avx512() -> bool {
        Level::best() >= Level::Avx512
    }

    #[target_feature(enable = "avx2,fma")]
    pub(super) fn run_avx2<J: Job>(job: J) -> J::Output {
        job.run::<Ymm>()
    }

    #[target_feature(enable = "avx2,fma,avx512f")]
    pub(super) fn run_avx512<J: Job>(job: J) -> J::Output {
        job.run::<Zmm>()
    }

    /// Eight reals. Made by [`run_avx2`] only, on CPUs with AVX2 and FMA.
    #[derive(Clone, Copy)]
    struct Ymm(__m256);

    /// Sixteen reals. Made by [`run_avx512`] only, on CPUs with AVX-512F.
    #[derive(Clone, Copy)]
    struct Zmm(__m512);

    /// Implements [`Vector`] for a register, given the instructions that differ in nothing but the width.
    macro_rules! vector {
        ($register:ident, $lanes:literal, $splat:ident, $load:ident, $store:ident, $sqrt:ident, $fma:ident, $fnma:ident,
         two: { $($name:ident: $instruction:ident),* }, at_least: |$a:ident, $b:ident| $compare:expr) => {
            // In all methods, the register is of a type that is met only where a CPU with these instructions
            // runs, see the two above.
            impl Vector for $register {
                const LANES: usize = $lanes;

                #[inline(always)]
                fn splat(value: f32) -> Self {
                    // SAFETY: this CPU has the instruction.
                    Self(unsafe { $splat(value) })
                }
                #[inline(always)]
                fn load(from: &[f32]) -> Self {
                    let from = &from[..$lanes];
                    // SAFETY: this CPU has the instruction; it reads as many reals as the slice has, wherever
                    // they lie.
                    Self(unsafe { $load(from.as_ptr()) })
                }
                #[inline(always)]
                fn store(self, to: &mut [f32]) {
                    let to = &mut to[..$lanes];
                    // SAFETY: this CPU has the instruction; it writes as many reals as the slice has,
                    // wherever they lie.
                    unsafe { $store(to.as_mut_ptr(), self.0) };
                }
                #[inline(always)]
                fn sqrt(self) -> Self {
                    // SAFETY: this CPU has the instruction.
                    Self(unsafe { $sqrt(self.0) })
                }
                #[inline(always)]
                fn mul_add(self, factor: Self, term: Self) -> Self {
                    // SAFETY: this CPU has the instruction.
                    Self(unsafe { $fma(self.0, factor.0, term.0) })
                }
                #[inline(always)]
                fn mul_sub_from(self, factor: Self, term: Self) -> Self {
                    // SAFETY: this CPU has the instruction.
                    Self(unsafe { $fnma(self.0, factor.0, term.0) })
                }
                $(
                    #[inline(always)]
                    fn $name(self, other: Self) -> Self {
                        // SAFETY: this CPU has the instruction.
                        Self(unsafe { $instruction(self.0, other.0) })
                    }
                )*
                #[inline(always)]
                fn at_least(self, other: Self) -> u32 {
                    let ($a, $b) = (self.0, other.0);
                    // SAFETY: this CPU has the instructions.
                    unsafe { $compare }
                }
            }
        };
    }

    vector!(Ymm, 8, _mm256_set1_ps, _mm256_loadu_ps, _mm256_storeu_ps, _mm256_sqrt_ps, _mm256_fmadd_ps, _mm256_fnmadd_ps,
        two: { add: _mm256_add_ps, sub: _mm256_sub_ps, mul: _mm256_mul_ps, div: _mm256_div_ps,
               max: _mm256_max_ps, min: _mm256_min_ps },
        at_least: |a, b| _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(a, b)) as u32);

    vector!(Zmm, 16, _mm512_set1_ps, _mm512_loadu_ps, _mm512_storeu_ps, _mm512_sqrt_ps, _mm512_fmadd_ps, _mm512_fnmadd_ps,
        two: { add: _mm512_add_ps, sub: _mm512_sub_ps, mul: _mm512_mul_ps, div: _mm512_div_ps,
               max: _mm512_max_ps, min: _mm512_min_ps },
        at_least: |a, b| u32::from(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(a, b)));
}
