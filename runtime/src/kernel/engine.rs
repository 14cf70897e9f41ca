//! The list of engines, and the choice of one.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use jbt_ir::Verified;
use jbt_ir::engine::{Backend, Form, Interpreter, Program, Reference, choose};
use jbt_ir::level::{self, Level, MissingLevel};

use crate::error::CompileError;
use crate::word::{UnknownWord, find};

/// What runs a program.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Engine {
    /// The reference: one point after the other.
    Scalar,
    /// The SIMD interpreter.
    Lanes,
    /// Machine code.
    Jit,
}

impl Engine {
    /// All engines.
    pub const ALL: [Self; 3] = [Self::Scalar, Self::Lanes, Self::Jit];

    /// The word of the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Lanes => "lanes",
            Self::Jit => "jit",
        }
    }

    /// What makes its programs, from the general to the special: a level has the last one that covers it. An
    /// engine that this build lacks has none.
    #[must_use]
    pub fn backends(self) -> &'static [&'static dyn Backend] {
        ENGINES.iter().find(|row| row.engine == self).map_or(&[], |row| row.backends)
    }

    /// The engine for the few points that need a second program: one that compiles at once.
    pub(super) const fn for_few(self) -> Self {
        match self {
            Self::Scalar => Self::Scalar,
            Self::Lanes | Self::Jit => Self::Lanes,
        }
    }

    /// Ops that take some milliseconds.
    pub(super) const fn ops_between_looks(self) -> u64 {
        match self {
            Self::Scalar => 1 << 19,
            Self::Lanes | Self::Jit => 1 << 23,
        }
    }

    /// A program for a function. The reason if there is none.
    fn compile(self, function: &Arc<Verified>, level: Level) -> Result<Arc<dyn Program>, String> {
        let absent = || format!("this build has no {} (cargo feature `{self}`)", self.name().to_uppercase());
        let backend = choose(self.backends(), level).ok_or_else(absent)?;
        backend.compile(function, level).map_err(|declined| declined.reason)
    }
}

/// An engine of this build.
struct EngineRow {
    engine: Engine,
    backends: &'static [&'static dyn Backend],
}

/// The engines of this build: the one place that knows them.
static ENGINES: &[EngineRow] = &[
    EngineRow { engine: Engine::Scalar, backends: &[&Reference] },
    EngineRow { engine: Engine::Lanes, backends: &[&Interpreter] },
    #[cfg(feature = "jit")]
    EngineRow { engine: Engine::Jit, backends: jbt_jit::BACKENDS },
];

/// The texts that the engines of this build make of functions, each once.
pub fn forms() -> Vec<&'static Form> {
    let mut all: Vec<&Form> = Vec::new();
    for form in ENGINES.iter().flat_map(|row| row.backends).flat_map(|backend| backend.forms()) {
        if all.iter().all(|other| other.name != form.name) {
            all.push(form);
        }
    }
    all
}

/// The form of a name at a level, which this CPU need not have: that of the backend that the level has, or of
/// another one that covers it.
#[must_use]
pub fn form(name: &str, level: Level) -> Option<&'static Form> {
    let backends = ENGINES.iter().flat_map(|row| row.backends).rev();
    let mut forms = backends.filter(|backend| backend.covers(level)).flat_map(|backend| backend.forms());
    forms.find(|form| form.name == name)
}

impl fmt::Display for Engine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Engine {
    type Err = UnknownWord;

    /// The engine of a [`name`](Self::name).
    fn from_str(word: &str) -> Result<Self, UnknownWord> {
        find(&Self::ALL, word)
    }
}

/// What a kernel is asked to run on. `None` is the best that there is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct Wish {
    pub(crate) engine: Option<Engine>,
    /// The level of the instruction set, of the interpreter and of machine code.
    pub(crate) level: Option<Level>,
}

/// A function on an engine.
pub(super) struct CompiledFunction {
    pub(super) engine: Engine,
    pub(super) level: Level,
    pub(super) program: Arc<dyn Program>,
}

/// Compiles a function. Without an engine in mind, machine code is tried first and the interpreter then: for
/// each kernel by itself.
pub(super) fn compile(function: &Arc<Verified>, wish: Wish) -> Result<CompiledFunction, CompileError> {
    let level = wish.level.unwrap_or_else(best_level);
    let declined = |engine: Engine, reason| CompileError::Engine { engine: engine.name(), reason };
    let first = wish.engine.unwrap_or(Engine::Jit);
    level.require().map_err(|missing| declined(first, missing.to_string()))?;
    let engine = match (first.compile(function, level), wish.engine) {
        (Ok(program), _) => return Ok(CompiledFunction { engine: first, level, program }),
        (Err(reason), Some(engine)) => return Err(declined(engine, reason)),
        (Err(reason), None) => {
            warn_once(&reason);
            Engine::Lanes
        }
    };
    let program = engine.compile(function, level).map_err(|reason| declined(engine, reason))?;
    Ok(CompiledFunction { engine, level, program })
}

/// The best level that may be used. Says once for each process what is wrong with the variable that bounds
/// it.
fn best_level() -> Level {
    static WARNED: std::sync::Once = std::sync::Once::new();
    WARNED.call_once(|| {
        let Ok(word) = std::env::var(level::VARIABLE) else { return };
        match word.parse::<Level>() {
            Ok(level) if level.is_available() => {}
            Ok(level) => log::warn!("{}: {}", level::VARIABLE, MissingLevel(level)),
            Err(error) => log::warn!("{}: {error}", level::VARIABLE),
        }
    });
    Level::best()
}

/// Says once for each process that there is no machine code, and why.
fn warn_once(reason: &str) {
    static WARNED: std::sync::Once = std::sync::Once::new();
    WARNED.call_once(|| log::warn!("interpreting, because the JIT declined: {reason}"));
}

#[cfg(test)]
mod tests {
    use super::{ENGINES, Engine};

    #[test]
    fn the_list_and_the_enum_agree() {
        let listed: Vec<Engine> = ENGINES.iter().map(|row| row.engine).collect();
        let known = Engine::ALL.into_iter().filter(|&engine| engine != Engine::Jit || cfg!(feature = "jit"));
        assert_eq!(listed, known.collect::<Vec<_>>());
        for engine in listed {
            assert!(!engine.backends().is_empty());
        }
    }
}
