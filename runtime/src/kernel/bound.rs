//! A kernel: a program with what it was made of; and a bound kernel, which has its numbers.

use std::sync::{Arc, OnceLock};

use jbt_ir::domain::counting::{evaluations_per_row, of_selection, ops_per_row};
use jbt_ir::engine::BoundProgram;
use jbt_ir::pass::{dce, take_for_pass};
use jbt_ir::{Function, Selection, Straight, Tables, Verified, watch};

use super::engine::{CompiledFunction, Engine, Wish, compile};
use super::optimise::{Purpose, optimise};
use crate::error::{CompileError, EvalError};

/// The code of one shape on an engine. It has no numbers: see [`BoundKernel`].
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
    compiled: CompiledFunction,
    /// What runs where the gradient is not finite, once that has been met; see [`guarded`](Self::guarded).
    guarded: OnceLock<Option<Arc<Kernel>>>,
}

impl Kernel {
    /// Prepares a function for an engine.
    pub(crate) fn new(
        lowered: Function,
        straight: Option<Straight>,
        function: Verified,
        wish: Wish,
    ) -> Result<Self, CompileError> {
        let function = Arc::new(function);
        let compiled = compile(&function, wish)?;
        Ok(Self {
            lowered,
            straight,
            per_row: evaluations_per_row(function.function()),
            ops_per_row: ops_per_row(function.function()),
            function,
            compiled,
            guarded: OnceLock::new(),
        })
    }

    pub(crate) fn engine(&self) -> Engine {
        self.compiled.engine
    }

    /// A kernel for field and gradient at points where the gradient by this one is not finite; `None` if
    /// guards make its program too long. It interprets: there are few such points as a rule, and a guarded
    /// program is several times as long.
    pub(crate) fn guarded(&self) -> Option<&Arc<Self>> {
        let make = || {
            let mut field = self.lowered.copied();
            field.outputs.truncate(1);
            let body = field.body;
            field.blocks[body].results.truncate(1);
            take_for_pass(&field);
            let field = dce(field);
            let verified = optimise(field.copied(), Purpose::FiniteGradient, &mut |_, _| {}).ok()?;
            let CompiledFunction { engine, level, .. } = self.compiled;
            let wish = Wish { engine: Some(engine.for_few()), level: Some(level) };
            Self::new(field, None, verified, wish).ok().map(Arc::new)
        };
        self.guarded.get_or_init(make).as_ref()
    }

    /// Points that run together.
    pub(crate) fn block(&self) -> usize {
        self.compiled.program.block()
    }

    /// Gives the kernel its numbers: those of the lowered function, which fit its straight code if it has
    /// one.
    pub(crate) fn bind(self: &Arc<Self>, lowered: Arc<Tables>) -> BoundKernel {
        let tables = match &self.straight {
            None => Arc::clone(&lowered),
            Some(straight) => Arc::new(straight.tables(&lowered).expect("whoever binds has seen to that")),
        };
        // Lowering made both, so they fit. It is checked all the same, because the engines' safety rests on
        // it.
        let program = Arc::clone(&self.compiled.program);
        let program = BoundProgram::new(program, tables).expect("lowering gives tables that fit");
        let few = self.between_looks(program.all());
        BoundKernel { kernel: Arc::clone(self), program, lowered, few, guarded: OnceLock::new() }
    }

    /// Points that run without a look whether they are wanted: whole blocks that take some milliseconds.
    fn between_looks(&self, selection: &Selection) -> usize {
        let ops = of_selection(&self.ops_per_row, selection).max(1);
        let blocks = self.engine().ops_between_looks() / ops / self.block() as u64;
        blocks.max(1) as usize * self.block()
    }
}

/// A kernel with its numbers: the thing that runs.
pub(crate) struct BoundKernel {
    pub(crate) kernel: Arc<Kernel>,
    program: BoundProgram,
    /// Those of the lowered function: others than its own only if the kernel is straight code.
    pub(crate) lowered: Arc<Tables>,
    /// Points that run without a look with all rows.
    few: usize,
    /// The guarded kernel with the same numbers.
    pub(crate) guarded: OnceLock<Option<Box<BoundKernel>>>,
}

impl BoundKernel {
    /// Its numbers.
    pub(crate) fn tables(&self) -> &Arc<Tables> {
        self.program.tables()
    }

    /// All rows that are active.
    pub(crate) fn all(&self) -> &Arc<Selection> {
        self.program.all()
    }

    /// Runs all points with the rows of a selection from these tables; returns how many lanes were computed.
    pub(crate) fn run(
        &self,
        selection: &Selection,
        inputs: &[&[f32]],
        outputs: &mut [&mut [f32]],
    ) -> Result<usize, EvalError> {
        let (count, block) = (inputs.first().map_or(0, |plane| plane.len()), self.kernel.block());
        let lanes = count.next_multiple_of(block);
        // Whoever asks about a single point gets its answer, and looks between two of them.
        if count > 1 {
            watch::go_on()?;
        }
        // Planes that differ in length are refused as a whole.
        let is_even = || {
            inputs.iter().all(|plane| plane.len() == count)
                && outputs.iter().all(|plane| plane.len() == count)
        };
        let most = if count > self.few { self.kernel.between_looks(selection) } else { self.few };
        if count <= most || !is_even() {
            self.program.run_selected(selection, inputs, outputs)?;
            return Ok(lanes);
        }
        for start in (0..count).step_by(most) {
            watch::go_on()?;
            let some = start..count.min(start + most);
            let inputs: Vec<&[f32]> = inputs.iter().map(|plane| &plane[some.clone()]).collect();
            let mut outputs: Vec<&mut [f32]> =
                outputs.iter_mut().map(|plane| &mut plane[some.clone()]).collect();
            self.program.run_selected(selection, &inputs, &mut outputs)?;
        }
        Ok(lanes)
    }
}
