//! The door to the lanes interpreter: a function becomes a tape, and a tape runs on planes.

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

/// Why planes do not fit a tape.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum RunError {
    /// Another number of input planes.
    #[error("the function has {expected} input planes, {given} were given")]
    Inputs {
        /// What the function has.
        expected: usize,
        /// What was given.
        given: usize,
    },
    /// Another number of output planes.
    #[error("the function has {expected} output planes, {given} were given")]
    Outputs {
        /// What the function has.
        expected: usize,
        /// What was given.
        given: usize,
    },
    /// Planes of different lengths.
    #[error("the first plane has {expected} points, another one has {given}")]
    Length {
        /// The length of the first input plane; of the first output plane, where there are no inputs.
        expected: usize,
        /// The length of the first plane that differs.
        given: usize,
    },
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
        let points = self.check_planes(inputs, outputs)?;
        scratch.reserve(self);
        level::run(level, Job { tape: self, tables, selection, inputs, outputs, scratch, points });
        Ok(())
    }

    /// The common length of all planes.
    fn check_planes(&self, inputs: &[&[f32]], outputs: &[&mut [f32]]) -> Result<usize, RunError> {
        if inputs.len() != self.inputs {
            return Err(RunError::Inputs { expected: self.inputs, given: inputs.len() });
        }
        if outputs.len() != self.outputs.len() {
            return Err(RunError::Outputs { expected: self.outputs.len(), given: outputs.len() });
        }
        let mut lengths =
            inputs.iter().map(|plane| plane.len()).chain(outputs.iter().map(|plane| plane.len()));
        let expected = lengths.next().unwrap_or(0);
        match lengths.find(|&given| given != expected) {
            Some(given) => Err(RunError::Length { expected, given }),
            None => Ok(expected),
        }
    }
}
