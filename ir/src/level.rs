//! Levels of the instruction set: what an engine may use of a CPU.
//!
//! One type for the interpreter and for machine code. A level is a word; whether this CPU has it is asked
//! where code runs.

use std::fmt;
use std::str::FromStr;
use std::sync::OnceLock;

/// A level of the instruction set. Larger ones have all that smaller ones have.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Level {
    /// What the program was compiled for: every CPU that it runs on has this.
    Baseline,
    /// AVX2 and FMA: vectors of 256 bits, 16 registers.
    Avx2,
    /// AVX-512 F, VL, DQ and BW in vectors of 256 bits: 32 registers, and registers for masks.
    Avx512Vl,
    /// The same in vectors of 512 bits.
    Avx512,
}

/// The environment variable with the largest level that may be used.
pub const VARIABLE: &str = "JBT_LEVEL";

impl Level {
    /// All levels, from the smallest.
    pub const ALL: [Self; 4] = [Self::Baseline, Self::Avx2, Self::Avx512Vl, Self::Avx512];

    /// The word of the command line and of [`VARIABLE`].
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512Vl => "avx512vl",
            Self::Avx512 => "avx512",
        }
    }

    /// The largest level that this CPU has. The CPU is asked once per process.
    #[must_use]
    pub fn of_cpu() -> Self {
        static LEVEL: OnceLock<Level> = OnceLock::new();
        *LEVEL.get_or_init(detect)
    }

    /// The largest level that this CPU has and [`VARIABLE`] allows: what engines use by themselves. Both are
    /// asked once per process. A variable that is no level counts for nothing.
    #[must_use]
    pub fn best() -> Self {
        static LEVEL: OnceLock<Level> = OnceLock::new();
        *LEVEL.get_or_init(|| Self::of_cpu().min(Self::allowed().unwrap_or(Self::Avx512)))
    }

    /// The level that [`VARIABLE`] names, if it names one.
    #[must_use]
    pub fn allowed() -> Option<Self> {
        std::env::var(VARIABLE).ok()?.parse().ok()
    }

    /// Whether this CPU has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        self <= Self::of_cpu()
    }

    /// Asks for it.
    ///
    /// # Errors
    /// This CPU lacks it.
    pub fn require(self) -> Result<(), MissingLevel> {
        if self.is_available() { Ok(()) } else { Err(MissingLevel(self)) }
    }

    /// All levels that this CPU has, from the smallest.
    #[must_use]
    pub fn available() -> Vec<Self> {
        Self::ALL.into_iter().filter(|level| level.is_available()).collect()
    }
}

#[cfg(target_arch = "x86_64")]
fn detect() -> Level {
    if !(is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")) {
        Level::Baseline
    } else if is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512bw")
    {
        Level::Avx512
    } else {
        Level::Avx2
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn detect() -> Level {
    Level::Baseline
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A level that this CPU lacks.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct MissingLevel(pub Level);

impl fmt::Display for MissingLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let available: Vec<&str> = Level::available().into_iter().map(Level::name).collect();
        write!(f, "this CPU has no level {}; it has {}", self.0, available.join(", "))
    }
}

impl std::error::Error for MissingLevel {}

/// A word that names no level.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("`{0}` is no level: there are baseline, avx2, avx512vl and avx512")]
pub struct UnknownLevel(pub String);

impl FromStr for Level {
    type Err = UnknownLevel;

    /// The level of a [`name`](Self::name).
    fn from_str(word: &str) -> Result<Self, UnknownLevel> {
        let level = Self::ALL.into_iter().find(|level| level.name() == word);
        level.ok_or_else(|| UnknownLevel(word.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::Level;

    #[test]
    fn levels_ascend_and_are_named() {
        assert!(Level::ALL.is_sorted_by(|a, b| a < b));
        for level in Level::ALL {
            assert_eq!(level.name().parse(), Ok(level));
        }
        assert!("avx1024".parse::<Level>().is_err());
        assert!(Level::available().contains(&Level::Baseline));
        assert!(Level::best() <= Level::of_cpu());
        for level in Level::ALL {
            assert_eq!(level.require().is_ok(), level.is_available());
        }
    }
}
