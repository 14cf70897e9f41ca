//! Settings of the compiler.

use jbt_ir::Level;

/// Vectors for each value. A vector has as many lanes as the [`Backend`] says.
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

/// What makes the machine code. All give the same bits.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Backend {
    /// Cranelift: vectors of 128 bits.
    Cranelift,
    /// An emitter of our own for x86-64, at a level from [`Level::Avx2`] on. [`Level::Baseline`] is taken for
    /// that one.
    Wide(Level),
}

impl Backend {
    /// The one that is used where nobody wishes another: wide code, if [`Level::best`] has it.
    #[must_use]
    pub fn best() -> Self {
        Self::at(Level::best())
    }

    /// The one for a level.
    #[must_use]
    pub const fn at(level: Level) -> Self {
        match level {
            Level::Baseline => Self::Cranelift,
            level @ (Level::Avx2 | Level::Avx512Vl | Level::Avx512) => Self::Wide(level),
        }
    }

    /// All whose code this CPU can run.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let wide = Level::available().into_iter().filter(|&level| level > Level::Baseline);
        std::iter::once(Self::Cranelift).chain(wide.map(Self::Wide)).collect()
    }

    /// Lanes of one vector.
    #[must_use]
    pub const fn lanes(self) -> usize {
        match self {
            Self::Cranelift => 4,
            Self::Wide(Level::Baseline | Level::Avx2 | Level::Avx512Vl) => 8,
            Self::Wide(Level::Avx512) => 16,
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

/// Settings of the compiler. What is `None` is chosen by the CPU and the function.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Options {
    /// What makes the code.
    pub backend: Option<Backend>,
    /// Vectors for each value. Where they are open, wide code has a second function of one vector, for points
    /// that fill no larger block.
    pub vectors: Option<VectorCount>,
    /// Effort of Cranelift.
    pub opt_level: OptLevel,
    /// Register allocator of Cranelift.
    pub allocator: Option<Allocator>,
    /// How a function is cut.
    pub pieces: Option<Pieces>,
    /// How wide code is checked while it is made.
    pub check: Check,
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
