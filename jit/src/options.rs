//! What the settings of generators are made of.

use jbt_ir::engine::{Declined, Form};
use jbt_ir::{Level, Verified};

/// The form that all generators have.
pub(crate) const fn asm(text: fn(&Verified, Level) -> Result<String, Declined>) -> Form {
    Form { name: "asm", what: "The machine's instructions, registers chosen.", text }
}

/// Vectors for each value. A vector has as many lanes as the generator says.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum VectorCount {
    /// One.
    One,
    /// Two.
    Two,
    /// Four.
    Four,
}

impl VectorCount {
    /// All counts.
    pub const ALL: [Self; 3] = [Self::One, Self::Two, Self::Four];

    /// How many.
    #[must_use]
    pub const fn count(self) -> usize {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
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
    /// Into pieces of at most so many instructions, with a cut before and behind every fold. If the values
    /// that pieces hand to each other are too many for the nearer caches, not at all.
    Of(usize),
}

/// How wide code is checked while it is made. For tests: it takes time, and code with few registers is slow.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Check {
    /// Not at all.
    #[default]
    Off,
    /// The finished code is replayed: each instruction has to find the values that it is meant to read.
    Registers,
    /// The same for code in 3 vector registers and 1 mask register, in which nearly everything is in the
    /// frame.
    FewRegisters,
}
