//! A program on an engine: verified instructions, and whatever runs them.
//!
//! | engine | what it is |
//! |---|---|
//! | `scalar` | the reference: one point after the other, in the simplest way |
//! | `lanes` | the SIMD interpreter |
//! | `jit` | machine code: wide code of our own where the CPU has AVX2, else by Cranelift |
//!
//! All give the same bits.

use std::fmt;
use std::str::FromStr;
use std::sync::{Arc, Mutex, OnceLock};

use jbt_frontend::diagnostic::Diagnostic;
use jbt_frontend::query::Query;
use jbt_ir::domain::counting::{evaluations_per_row, ops_per_row};
use jbt_ir::domain::lanes::{Scratch, Tape};
use jbt_ir::domain::scalar::Scalar;
use jbt_ir::level::{self, Level};
use jbt_ir::pass::{GUARDED_GRADIENT, INTERVAL, PIPELINE, Pass, dce, run_pipeline};
use jbt_ir::{Function, Selection, Straight, Tables, Verified, interpret, limits, verify};

use crate::error::{CompileError, EvalError};
use crate::export::{UnknownWord, find};

/// What runs a program.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
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

/// What a kernel is for.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Purpose {
    /// To answer a query at points.
    Answers(Query),
    /// To answer with field and gradient where the gradient is not finite otherwise.
    Guarded,
    /// To enclose the field in boxes.
    Ranges,
}

impl Purpose {
    /// The passes that go before the others, and change what is computed.
    fn first_passes(self) -> Vec<&'static Pass> {
        match self {
            Self::Answers(query) => query.passes().collect(),
            Self::Guarded => vec![&GUARDED_GRADIENT],
            Self::Ranges => vec![&INTERVAL],
        }
    }
}

/// The passes that a function goes through.
pub fn passes(purpose: Purpose) -> impl Iterator<Item = &'static Pass> {
    purpose.first_passes().into_iter().chain(PIPELINE)
}

/// Runs the passes and verifies. The observer sees what every pass made.
///
/// # Errors
/// A function that a pass makes larger than [`limits::MAX_VALUES`]; broken rules, which are a defect of the
/// compiler.
pub fn optimise(
    function: Function,
    purpose: Purpose,
    observer: &mut dyn FnMut(&str, &Function),
) -> Result<Verified, CompileError> {
    finish(run(function, passes(purpose), observer)?)
}

/// Straight code for a lowered function and its tables, if it is worth it: made of what the purpose's own
/// passes make of the function, so that answers have the bits that they have without it. What was told apart
/// in straight code for other numbers stays apart.
///
/// # Errors
/// Those of [`optimise`].
pub fn straighten(
    function: &Function,
    tables: &Tables,
    purpose: Purpose,
    before: Option<&Straight>,
) -> Result<Option<Straight>, CompileError> {
    let made;
    let first = purpose.first_passes();
    let function = if first.is_empty() {
        function
    } else {
        // Most functions are told to be none for straight code without these passes.
        if before.is_none() && Straight::new(function, tables).is_none() {
            return Ok(None);
        }
        made = run(function.clone(), first, &mut |_, _| {})?;
        &made
    };
    Ok(match before {
        Some(before) => before.again(function, tables),
        None => Straight::new(function, tables),
    })
}

/// Runs the passes that straight code has still to go through, and verifies.
///
/// # Errors
/// Those of [`optimise`].
pub fn optimise_straight(
    straight: &Straight,
    observer: &mut dyn FnMut(&str, &Function),
) -> Result<Verified, CompileError> {
    finish(run(straight.function().clone(), PIPELINE, observer)?)
}

fn run<'a>(
    mut function: Function,
    passes: impl IntoIterator<Item = &'a Pass>,
    observer: &mut dyn FnMut(&str, &Function),
) -> Result<Function, CompileError> {
    for pass in passes {
        function = run_pipeline(function, [pass], observer);
        let values = function.values.len();
        if values > limits::MAX_VALUES {
            let most = limits::MAX_VALUES;
            let message = format!(
                "after the pass {}, the model's program has {values} values; it may have {most}",
                pass.name
            );
            return Err(CompileError::Model(vec![Diagnostic::limit(None, message)].into()));
        }
    }
    Ok(function)
}

fn finish(function: Function) -> Result<Verified, CompileError> {
    verify(function).map_err(CompileError::Internal)
}

/// What a kernel is asked to run on. `None` is the best that there is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct Wish {
    pub(crate) engine: Option<Engine>,
    /// The level of the instruction set, of the interpreter and of machine code.
    pub(crate) level: Option<Level>,
}

enum Code {
    Scalar,
    Lanes(Tape),
    #[cfg(feature = "jit")]
    Jit(jbt_jit::Kernel),
}

/// A program that is ready to run on any numbers that fit it.
pub(crate) struct Kernel {
    /// The function as it was lowered: what tells whether another model has the same shape.
    pub(crate) lowered: Function,
    /// Where it is straight code: how the tables of the lowered function become its own.
    pub(crate) straight: Option<Straight>,
    pub(crate) function: Arc<Verified>,
    /// For each table, the distances that an active row takes.
    pub(crate) per_row: Vec<u64>,
    /// For each table, the ops that an active row takes.
    pub(crate) ops_per_row: Vec<u64>,
    code: Code,
    level: Level,
    /// What runs where the gradient is not finite, once that has been met; see [`guarded`](Self::guarded).
    guarded: OnceLock<Option<Arc<Kernel>>>,
}

impl Kernel {
    /// Prepares a function for an engine. Without an engine in mind, machine code is tried first and the
    /// interpreter then.
    pub(crate) fn new(
        lowered: Function,
        straight: Option<Straight>,
        function: Verified,
        wish: Wish,
    ) -> Result<Self, CompileError> {
        let level = wish.level.unwrap_or_else(best_level);
        if !level.is_available() {
            let engine = wish.engine.unwrap_or(Engine::Jit).name();
            return Err(CompileError::Engine { engine, reason: unavailable(level) });
        }
        let code = match wish.engine {
            Some(Engine::Scalar) => Code::Scalar,
            Some(Engine::Lanes) => lanes(&function)?,
            Some(Engine::Jit) => jit(&function, level)
                .map_err(|reason| CompileError::Engine { engine: Engine::Jit.name(), reason })?,
            None => match jit(&function, level) {
                Ok(code) => code,
                Err(reason) => {
                    warn_once(&reason);
                    lanes(&function)?
                }
            },
        };
        let per_row = evaluations_per_row(function.function());
        let ops_per_row = ops_per_row(function.function());
        Ok(Self {
            lowered,
            straight,
            function: Arc::new(function),
            per_row,
            ops_per_row,
            code,
            level,
            guarded: OnceLock::new(),
        })
    }

    pub(crate) fn engine(&self) -> Engine {
        match &self.code {
            Code::Scalar => Engine::Scalar,
            Code::Lanes(_) => Engine::Lanes,
            #[cfg(feature = "jit")]
            Code::Jit(_) => Engine::Jit,
        }
    }

    /// A kernel for field and gradient at points where the gradient by this one is not finite; `None` if
    /// guards make its program too long. It interprets: there are few such points as a rule, and a guarded
    /// program is several times as long.
    pub(crate) fn guarded(&self) -> Option<&Arc<Self>> {
        let make = || {
            let mut field = self.lowered.clone();
            field.outputs.truncate(1);
            let body = field.body;
            field.blocks[body].results.truncate(1);
            let field = dce(&field);
            let verified = optimise(field.clone(), Purpose::Guarded, &mut |_, _| {}).ok()?;
            let engine = match self.engine() {
                Engine::Scalar => Engine::Scalar,
                Engine::Lanes | Engine::Jit => Engine::Lanes,
            };
            let wish = Wish { engine: Some(engine), level: Some(self.level) };
            Self::new(field, None, verified, wish).ok().map(Arc::new)
        };
        self.guarded.get_or_init(make).as_ref()
    }

    /// Points that run together.
    pub(crate) fn block(&self) -> usize {
        match &self.code {
            Code::Scalar => 1,
            Code::Lanes(_) => jbt_ir::domain::lanes::WIDTH,
            #[cfg(feature = "jit")]
            Code::Jit(kernel) => kernel.lanes(),
        }
    }

    /// Gives the kernel its numbers: those of the lowered function, which fit its straight code if it has
    /// one.
    pub(crate) fn bind(self: &Arc<Self>, lowered: Arc<Tables>) -> Bound {
        let tables = match &self.straight {
            None => Arc::clone(&lowered),
            Some(straight) => Arc::new(straight.tables(&lowered).expect("whoever binds has seen to that")),
        };
        // Lowering made both, so they fit. It is checked all the same, because the engines' safety rests on
        // it.
        let interpreted = || Arc::new(Selection::new(self.function.function(), &tables));
        #[cfg(feature = "jit")]
        let (machine, all) = match &self.code {
            Code::Scalar | Code::Lanes(_) => (None, interpreted()),
            Code::Jit(kernel) => {
                let bound = kernel.bind(Arc::clone(&tables)).expect("lowering gives tables that fit");
                let all = Arc::clone(bound.all());
                (Some(bound), all)
            }
        };
        #[cfg(not(feature = "jit"))]
        let all = interpreted();
        Bound {
            kernel: Arc::clone(self),
            tables,
            lowered,
            all,
            #[cfg(feature = "jit")]
            machine,
            scratch: Mutex::new(Vec::new()),
            guarded: OnceLock::new(),
        }
    }
}

fn lanes(function: &Verified) -> Result<Code, CompileError> {
    let failed = |error: jbt_ir::domain::lanes::NotLegalized| CompileError::Engine {
        engine: Engine::Lanes.name(),
        reason: error.to_string(),
    };
    Tape::new(function).map(Code::Lanes).map_err(failed)
}

#[cfg(feature = "jit")]
fn jit(function: &Verified, level: Level) -> Result<Code, String> {
    let backend = Some(jbt_jit::Backend::at(level));
    let options = jbt_jit::Options { backend, ..jbt_jit::Options::default() };
    jbt_jit::Kernel::compile_with(function, &options).map(Code::Jit).map_err(|error| error.to_string())
}

#[cfg(not(feature = "jit"))]
fn jit(_function: &Verified, _level: Level) -> Result<Code, String> {
    Err("this build has no JIT (cargo feature `jit`)".to_owned())
}

/// What is wrong with a level that this CPU lacks.
fn unavailable(level: Level) -> String {
    let available: Vec<&str> = Level::available().into_iter().map(Level::name).collect();
    format!("this CPU has no level {level}; it has {}", available.join(", "))
}

/// The best level that may be used. Says once for each process what is wrong with the variable that bounds
/// it.
fn best_level() -> Level {
    static WARNED: std::sync::Once = std::sync::Once::new();
    WARNED.call_once(|| {
        let Ok(word) = std::env::var(level::VARIABLE) else { return };
        match word.parse::<Level>() {
            Ok(level) if level.is_available() => {}
            Ok(level) => log::warn!("{}: {}", level::VARIABLE, unavailable(level)),
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

/// A kernel with its numbers: the thing that runs.
pub(crate) struct Bound {
    pub(crate) kernel: Arc<Kernel>,
    pub(crate) tables: Arc<Tables>,
    /// Those of the lowered function: others only if the kernel is straight code.
    pub(crate) lowered: Arc<Tables>,
    /// All rows that are active.
    pub(crate) all: Arc<Selection>,
    #[cfg(feature = "jit")]
    machine: Option<jbt_jit::BoundKernel>,
    /// Memory of interpreter runs, one for each thread that runs at once.
    scratch: Mutex<Vec<Scratch>>,
    /// The guarded kernel with the same numbers.
    pub(crate) guarded: OnceLock<Option<Box<Bound>>>,
}

/// The most points that fill up a last block.
#[cfg(feature = "jit")]
const MAX_BLOCK: usize = jbt_jit::Kernel::MAX_LANES;
/// The most input planes: a range along each axis.
#[cfg(feature = "jit")]
const MAX_INPUTS: usize = 6;
/// Output planes of a small kernel: field, gradient, colour.
#[cfg(feature = "jit")]
const FEW_OUTPUTS: usize = 8;

impl Bound {
    /// Runs all points with the rows of a selection from these tables; returns how many lanes were computed.
    pub(crate) fn run(
        &self,
        selection: &Selection,
        inputs: &[&[f32]],
        outputs: &mut [&mut [f32]],
    ) -> Result<usize, EvalError> {
        let points = self.check(selection, inputs, outputs)?;
        match &self.kernel.code {
            Code::Scalar => self.run_scalar(selection, inputs, outputs),
            Code::Lanes(tape) => {
                let mut scratch =
                    self.scratch.lock().map(|mut pool| pool.pop()).ok().flatten().unwrap_or_default();
                let (level, rows) = (self.kernel.level, (&*self.tables, selection));
                let ran = tape.run_at(level, rows, inputs, outputs, &mut scratch);
                debug_assert_eq!(ran, Ok(()), "the planes have been checked");
                if let Ok(mut pool) = self.scratch.lock() {
                    pool.push(scratch);
                }
            }
            #[cfg(feature = "jit")]
            Code::Jit(kernel) => self.run_machine(kernel.lanes(), selection, inputs, outputs),
        }
        Ok(points.next_multiple_of(self.kernel.block()))
    }

    fn check(
        &self,
        selection: &Selection,
        inputs: &[&[f32]],
        outputs: &[&mut [f32]],
    ) -> Result<usize, EvalError> {
        let function = self.kernel.function.function();
        if !selection.fits(self.all.extent()) {
            return Err(EvalError::Selection);
        }
        if (inputs.len(), outputs.len()) != (function.inputs.len(), function.outputs.len()) {
            return Err(EvalError::Planes { expected: function.outputs.len(), given: outputs.len() });
        }
        let expected = inputs[0].len();
        let input = inputs.iter().map(|plane| plane.len()).find(|&given| given != expected);
        let output = || outputs.iter().map(|plane| plane.len()).find(|&given| given != expected);
        match input.or_else(output) {
            Some(given) => Err(EvalError::Length { expected, given }),
            None => Ok(expected),
        }
    }

    fn run_scalar(&self, selection: &Selection, inputs: &[&[f32]], outputs: &mut [&mut [f32]]) {
        let _environment = jbt_ir::environment::Standard::enter();
        for point in 0..inputs[0].len() {
            let at: Vec<f32> = inputs.iter().map(|plane| plane[point]).collect();
            let function = &self.kernel.function;
            let answers = interpret::run_selected(function, &self.tables, selection, &mut Scalar, &at);
            for (plane, answer) in outputs.iter_mut().zip(answers) {
                plane[point] = answer;
            }
        }
    }

    /// Straight from the caller's planes; fewer points than a block go through one that is filled up with the
    /// last.
    #[cfg(feature = "jit")]
    fn run_machine(
        &self,
        lanes: usize,
        selection: &Selection,
        inputs: &[&[f32]],
        outputs: &mut [&mut [f32]],
    ) {
        let machine = self.machine.as_ref().expect("machine code was bound");
        let points = inputs[0].len();
        if points == 0 || points >= lanes {
            machine.run_selected(selection, inputs, outputs).expect("the planes have been checked");
            return;
        }
        assert!(lanes <= MAX_BLOCK && inputs.len() <= MAX_INPUTS, "blocks of machine code are small");
        let mut padded = [[0.0; MAX_BLOCK]; MAX_INPUTS];
        for (block, plane) in padded.iter_mut().zip(inputs) {
            block[..points].copy_from_slice(plane);
            block[points..].fill(plane[points - 1]);
        }
        let padded = padded.each_ref().map(|block| &block[..lanes]);
        // Many blocks come from the heap, a few of them from the stack.
        let count = outputs.len();
        let mut run = |blocks: &mut [&mut [f32]]| {
            let ran = machine.run_selected(selection, &padded[..inputs.len()], blocks);
            ran.expect("the block is whole");
            for (plane, block) in outputs.iter_mut().zip(blocks) {
                plane.copy_from_slice(&block[..points]);
            }
        };
        if count <= FEW_OUTPUTS {
            let mut answers = [[0.0; MAX_BLOCK]; FEW_OUTPUTS];
            run(&mut answers.each_mut().map(|block| &mut block[..lanes])[..count]);
        } else {
            let mut answers = vec![0.0; lanes * count];
            run(&mut answers.chunks_mut(lanes).collect::<Vec<_>>());
        }
    }
}
