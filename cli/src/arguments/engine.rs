//! What all commands take that evaluate: the engine, and the instruction set.

use clap::{Args, ValueEnum};
use jbt::{Compiler, Engine, Level};

use crate::failure::Failure;

/// The words for engines.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum EngineName {
    /// The reference: one point after the other
    Scalar,
    /// The SIMD interpreter
    Lanes,
    /// Machine code; the SIMD interpreter, with a warning, where that cannot be had
    Jit,
}

impl EngineName {
    /// The engine to insist on; machine code is not insisted on.
    pub fn required(self) -> Option<Engine> {
        match self {
            Self::Scalar => Some(Engine::Scalar),
            Self::Lanes => Some(Engine::Lanes),
            Self::Jit => None,
        }
    }
}

/// The words for levels of the instruction set.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub enum LevelName {
    /// What every CPU of the architecture has
    Baseline,
    /// AVX2 and FMA, in vectors of 256 bits
    Avx2,
    /// AVX-512, in vectors of 256 bits
    Avx512vl,
    /// AVX-512
    Avx512,
}

impl LevelName {
    /// The level, whether this CPU has it or not.
    pub fn level(self) -> Level {
        match self {
            Self::Baseline => Level::Baseline,
            Self::Avx2 => Level::Avx2,
            Self::Avx512vl => Level::Avx512Vl,
            Self::Avx512 => Level::Avx512,
        }
    }
}

/// What computes.
#[derive(Args, Debug)]
pub struct EngineArguments {
    /// What evaluates the field: all engines give the same bits
    #[arg(long, value_enum, default_value_t = EngineName::Jit)]
    pub engine: EngineName,
    /// The largest instruction set that it uses: the bits stay the same [default: the best that this CPU has,
    /// or JBT_LEVEL]
    #[arg(long, value_enum)]
    pub level: Option<LevelName>,
}

impl EngineArguments {
    /// A compiler for the engine and the level.
    pub fn compiler(&self) -> Result<Compiler, Failure> {
        let compiler = self.engine.required().map_or_else(Compiler::new, Compiler::for_engine);
        let Some(level) = self.level.map(LevelName::level) else { return Ok(compiler) };
        level.require().map_err(|missing| Failure::Usage(missing.to_string()))?;
        Ok(compiler.at_level(level))
    }
}
