//! The door to the lanes interpreter: a function becomes a tape, and a tape runs on planes.

use crate::engine::{Planes, RunError, check};
use crate::entity::Inst;
use crate::function::InstKind;
use crate::level::Level;
use crate::op::Op;
use crate::selection::Selection;
use crate::table::Tables;
use crate::verify::Verified;

use super::compile::compile;
use super::execute::Job;
use super::level;
use super::tape::{Scratch, Tape};

/// An op that the lanes interpreter leaves to the pass that expands it.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{inst}: {} must be expanded before the function is interpreted", .op.name())]
pub struct NotLegalized {
    /// The first such instruction.
    pub inst: Inst,
    /// Its op.
    pub op: Op,
}

impl Tape {
    /// Compiles a function.
    ///
    /// # Errors
    /// The first op that the `legalize` pass would have expanded.
    pub fn new(function: &Verified) -> Result<Self, NotLegalized> {
        let function = function.function();
        for (inst, data) in function.insts.iter() {
            if let InstKind::Op { op, .. } = data.kind
                && op.is_expanded()
            {
                return Err(NotLegalized { inst, op });
            }
        }
        Ok(compile(function))
    }

    /// Runs the function: computes output planes from input planes, point by point with the bits of the
    /// scalar domain.
    ///
    /// All planes have one length, any length. `tables` fit the function: call [`Tables::check`] when they
    /// change. `selection` says which of their rows run. (Tables that do not fit give wrong numbers or a
    /// panic, nothing worse.) The run has its own floating-point environment, with subnormals and round to
    /// nearest, and restores the caller's.
    ///
    /// # Errors
    /// Another number of planes than the function has, or planes of different lengths.
    pub fn run(
        &self,
        (tables, selection): (&Tables, &Selection),
        inputs: &[&[f32]],
        outputs: &mut [&mut [f32]],
        scratch: &mut Scratch,
    ) -> Result<(), RunError> {
        self.run_at(Level::best(), (tables, selection), inputs, outputs, scratch)
    }

    /// Like [`run`](Self::run), at a chosen level of the instruction set. The bits are the same at every
    /// level.
    ///
    /// # Errors
    /// Those of [`run`](Self::run).
    pub fn run_at(
        &self,
        level: Level,
        (tables, selection): (&Tables, &Selection),
        inputs: &[&[f32]],
        outputs: &mut [&mut [f32]],
        scratch: &mut Scratch,
    ) -> Result<(), RunError> {
        let points = check((self.inputs, self.outputs.len()), inputs, outputs)?;
        self.run_checked(level, Planes { points, tables, selection, inputs, outputs }, scratch);
        Ok(())
    }

    /// Like [`run_at`](Self::run_at), for planes that have been checked.
    pub(crate) fn run_checked(&self, level: Level, planes: Planes<'_, '_>, scratch: &mut Scratch) {
        let Planes { points, tables, selection, inputs, outputs } = planes;
        scratch.reserve(self);
        level::run(level, Job { tape: self, tables, selection, inputs, outputs, scratch, points });
    }
}
