//! The compiler: shapes become kernels, and are remembered.

use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use jbt_ir::{Function, Level, Tables, limits};
use jbt_model::check::CheckedTree;

use crate::error::CompileError;
use crate::kernel::{BoundKernel, Engine, Kernel, Purpose, Wish, optimise, optimise_straight, straighten};
use crate::span::span;

/// Makes [compiled models](crate::Compiled), and remembers the code of every shape that it has met: models of
/// one shape share it.
///
/// Cloning gives another handle to the same memory.
#[derive(Clone, Default)]
pub struct Compiler {
    wish: Wish,
    /// Whether rows stay rows: see [`for_edits`](Self::for_edits).
    keeps_rows: bool,
    memory: Arc<CompilerMemory>,
}

/// What a compiler has made so far. A snapshot: see [`Compiler::counters`].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct CompileCounters {
    /// Programs that were compiled: one for each shape and purpose.
    pub kernels: u64,
    /// Programs that were given the numbers of a model.
    pub bound: u64,
    /// Edited models of which only changed rows were lowered: see
    /// [`Compiled::updated`](crate::Compiled::updated).
    pub patched: u64,
}

/// What the clones of a compiler share.
#[derive(Default)]
struct CompilerMemory {
    known: Mutex<Vec<KnownKernel>>,
    kernels: AtomicU64,
    bound: AtomicU64,
    patched: AtomicU64,
}

/// The code of a shape, for a purpose.
struct KnownKernel {
    purpose: Purpose,
    kernel: Arc<Kernel>,
}

/// Shapes that a compiler remembers; the oldest one goes first.
const REMEMBERED: usize = 64;

impl Compiler {
    /// A compiler for the best engine that this machine has: machine code, or the SIMD interpreter with one
    /// warning in the log.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A compiler for one engine and no other: where it cannot be had, compiling is an error.
    /// ([`new`](Self::new) takes the interpreter instead, and so does `jbt --engine jit`.)
    #[must_use]
    pub fn for_engine(engine: Engine) -> Self {
        Self::default().on_engine(engine)
    }

    /// The same compiler for one engine.
    #[must_use]
    pub fn on_engine(mut self, engine: Engine) -> Self {
        self.wish.engine = Some(engine);
        self.memory = Arc::default();
        self
    }

    /// The same compiler for a level of the instruction set, of the interpreter and of machine code. Without
    /// it, it is [`Level::best`].
    #[must_use]
    pub fn at_level(mut self, level: Level) -> Self {
        self.wish.level = Some(level);
        self.memory = Arc::default();
        self
    }

    /// The same compiler for models that are edited, or asked region by region: every row of a model stays a
    /// row of a table.
    ///
    /// Without it, formulas that have much in common become straight code ([`jbt_ir::straight`]), which takes
    /// up to a third less time. Straight code knows how many rows there are and which of their numbers are
    /// equal, so an edit that changes one of the two compiles anew; and regions run another kernel, which is
    /// made for the first of them. The answers have the same bits.
    ///
    /// Rows of primitives, and models with parameters, stay as they are in any case.
    #[must_use]
    pub fn for_edits(mut self) -> Self {
        self.keeps_rows = true;
        self
    }

    /// What it and its clones have made so far.
    #[must_use]
    pub fn counters(&self) -> CompileCounters {
        CompileCounters {
            kernels: self.memory.kernels.load(Ordering::Relaxed),
            bound: self.memory.bound.load(Ordering::Relaxed),
            patched: self.memory.patched.load(Ordering::Relaxed),
        }
    }

    /// Counts an edited model of which only changed rows were lowered.
    pub(crate) fn count_patched(&self) {
        self.memory.patched.fetch_add(1, Ordering::Relaxed);
    }

    /// Whether formulas of a model may become straight code. No value of a parameter compiles anything, so
    /// models with parameters keep their rows.
    pub(crate) fn may_straighten(&self, tree: &CheckedTree) -> bool {
        !self.keeps_rows && tree.parameters().is_empty()
    }

    /// Gives a kernel the numbers of a model.
    pub(crate) fn bind(&self, kernel: &Arc<Kernel>, tables: impl Into<Arc<Tables>>) -> BoundKernel {
        self.memory.bound.fetch_add(1, Ordering::Relaxed);
        kernel.bind(tables.into())
    }

    /// A kernel of straight code for a lowered function and these tables; `None` if rows are as good, or if
    /// it is beyond a limit.
    pub(crate) fn straight(
        &self,
        function: &Function,
        tables: &Tables,
        purpose: Purpose,
        present: Option<&Arc<Kernel>>,
    ) -> Option<Arc<Kernel>> {
        span!("straighten");
        let fits = |kernel: &Kernel| {
            let straight = kernel.straight.as_ref();
            kernel.lowered == *function && straight.is_some_and(|straight| straight.tables(tables).is_some())
        };
        let present = present.filter(|present| present.lowered == *function);
        if let Some(present) = present.filter(|present| fits(present)) {
            return Some(Arc::clone(present));
        }
        let before = match present {
            None => None,
            // The model had rows before: it keeps them, since straight code would compile.
            Some(present) => Some(present.straight.as_ref()?),
        };
        if let Some(kernel) = self.find(purpose, fits) {
            return Some(kernel);
        }
        let straight = straighten(function, tables, purpose, before).ok()??;
        let verified = optimise_straight(&straight, &mut |_, _| {}).ok()?;
        if verified.function().values.len() > limits::MAX_JIT_VALUES {
            return None;
        }
        let kernel = Kernel::new(function.copied(), Some(straight), verified, self.wish).ok()?;
        let kernel = Arc::new(kernel);
        self.remember(purpose, &kernel);
        Some(kernel)
    }

    /// The kernel of a lowered function: the present one, one that is remembered, or a new one.
    pub(crate) fn kernel(
        &self,
        function: Function,
        purpose: Purpose,
        present: Option<&Arc<Kernel>>,
    ) -> Result<Arc<Kernel>, CompileError> {
        let fits = |kernel: &Kernel| kernel.lowered == function && kernel.straight.is_none();
        let present = present.filter(|kernel| fits(kernel)).cloned();
        if let Some(kernel) = present.or_else(|| self.find(purpose, fits)) {
            return Ok(kernel);
        }
        span!("code");
        let verified = optimise(function.copied(), purpose, &mut |_, _| {})?;
        let kernel = Arc::new(Kernel::new(function, None, verified, self.wish)?);
        self.remember(purpose, &kernel);
        Ok(kernel)
    }

    fn remember(&self, purpose: Purpose, kernel: &Arc<Kernel>) {
        self.memory.kernels.fetch_add(1, Ordering::Relaxed);
        if let Ok(mut known) = self.memory.known.lock() {
            if known.len() == REMEMBERED {
                known.remove(0);
            }
            known.push(KnownKernel { purpose, kernel: Arc::clone(kernel) });
        }
    }

    fn find(&self, purpose: Purpose, fits: impl Fn(&Kernel) -> bool) -> Option<Arc<Kernel>> {
        let known = self.memory.known.lock().ok()?;
        let found = known.iter().find(|known| known.purpose == purpose && fits(&known.kernel))?;
        Some(Arc::clone(&found.kernel))
    }
}

impl fmt::Debug for Compiler {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Compiler").field("wish", &self.wish).finish_non_exhaustive()
    }
}
