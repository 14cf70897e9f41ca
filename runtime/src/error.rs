//! What an error says about whose fault it is, and why a model has no evaluator.

use std::error::Error;

use jbt_ir::VerifyError;
use jbt_ir::engine::RunError;
use jbt_ir::memory::NoMemory;
use jbt_ir::watch::{self, Ended, Stopped};
use jbt_model::diagnostic::{Diagnostics, Severity};

/// What has to change so that an error goes away. Programs map it to what their users know: an exit code, an
/// exception, a status. There will be no other kinds, so a `match` needs no wildcard.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum ErrorKind {
    /// The model, by its author.
    Model,
    /// An argument or a setting, by the caller.
    Argument,
    /// The model is unbounded: a region has to be stated.
    Unbounded,
    /// The size of the task: it is more than a limit allows or than this machine has.
    Limit,
    /// The file or whatever else the operating system refused.
    System,
    /// Nothing: a token of the caller's stopped the work.
    Cancelled,
    /// jbt: it has a defect.
    Internal,
}

/// What every error of jbt's can say of itself besides its message.
///
/// ```
/// use jbt::build::point;
/// use jbt::{Classified, Compiler, ErrorKind, Model, Polygonize};
/// let tree = Model::new(!point([0, 0, 0], 1)).check().unwrap();
/// let error = Polygonize::default().mesh(&Compiler::new(), &tree).run().unwrap_err();
/// assert_eq!(error.kind(), ErrorKind::Unbounded);
/// ```
pub trait Classified: Error + Send + Sync + 'static {
    /// What has to change.
    fn kind(&self) -> ErrorKind;

    /// Located messages for the author of the model, if there are any.
    fn diagnostics(&self) -> Option<&Diagnostics> {
        None
    }
}

impl Classified for Diagnostics {
    fn kind(&self) -> ErrorKind {
        let any = |severity| self.iter().any(|one| one.severity == severity);
        if self.io().is_some() {
            ErrorKind::System
        } else if any(Severity::Limit) && !any(Severity::Error) {
            ErrorKind::Limit
        } else {
            // A model with both is wrong first and large second.
            ErrorKind::Model
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        Some(self)
    }
}

/// Why a model could not be compiled.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompileError {
    /// The model is beyond a limit, or its numbers leave the range of f32: located messages for its author.
    #[error(transparent)]
    Model(#[from] Diagnostics),
    /// The engine that was asked for by name cannot be had on this machine.
    #[error("the engine `{engine}` is not available: {reason}")]
    Engine {
        /// Its name.
        engine: &'static str,
        /// Why.
        reason: String,
    },
    /// A token of the caller's stopped it. Whoever asks again begins anew.
    #[error("compiling was cancelled")]
    Cancelled,
    /// The memory for the rows of the model, for what is known about them, or for its program is not to be
    /// had. Whoever asks again begins anew.
    #[error(transparent)]
    Memory(NoMemory),
    /// The compiler made a program that breaks its own rules: a defect of jbt.
    #[error("the compiler broke its own rules: {}", .0.first().map_or(String::new(), ToString::to_string))]
    Internal(Vec<VerifyError>),
}

impl Classified for CompileError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Model(diagnostics) => diagnostics.kind(),
            Self::Engine { .. } | Self::Memory(_) => ErrorKind::Limit,
            Self::Cancelled => ErrorKind::Cancelled,
            Self::Internal(_) => ErrorKind::Internal,
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        if let Self::Model(diagnostics) = self { Some(diagnostics) } else { None }
    }
}

impl From<Ended> for CompileError {
    fn from(end: Ended) -> Self {
        match end {
            Ended::Stopped => Self::Cancelled,
            Ended::NoMemory(error) => Self::Memory(error),
        }
    }
}

/// Why points were not evaluated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EvalError {
    /// The planes of x, y and z differ in length, or from a plane of answers.
    #[error("the first plane has {expected} points, another one has {given}")]
    Length {
        /// The length of the plane of x.
        expected: usize,
        /// The length of the first plane that differs.
        given: usize,
    },
    /// Another number of planes than the query has answers.
    #[error("the query has {expected} planes of answers, {given} were given")]
    Planes {
        /// Number of answers.
        expected: usize,
        /// What was given.
        given: usize,
    },
    /// The rows were selected from a model with other numbers of rows.
    #[error("the region was made for another model")]
    Selection,
    /// The buffer was made for another query or model.
    #[error("the samples were made for another query or model")]
    Layout,
    /// A token of the caller's stopped it. Some of the answers may be written.
    #[error("evaluating was cancelled")]
    Cancelled,
    /// The memory for the answers, or for what is made on the way to them, is not to be had.
    #[error(transparent)]
    Memory(NoMemory),
}

impl Classified for EvalError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Length { .. } | Self::Planes { .. } | Self::Selection | Self::Layout => ErrorKind::Argument,
            Self::Cancelled => ErrorKind::Cancelled,
            Self::Memory(_) => ErrorKind::Limit,
        }
    }
}

impl From<Ended> for EvalError {
    fn from(end: Ended) -> Self {
        match end {
            Ended::Stopped => Self::Cancelled,
            Ended::NoMemory(error) => Self::Memory(error),
        }
    }
}

/// Does work that is no job, and ends it with an error where there is no memory for it.
pub(crate) fn within_memory<T, E: From<EvalError>>(work: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
    watch::guarded(work).unwrap_or_else(|error| Err(EvalError::from(error).into()))
}

/// The same of small questions, of which larger work asks many: there it ends that work.
pub(crate) fn once_within_memory<T>(work: impl FnOnce() -> Result<T, EvalError>) -> Result<T, EvalError> {
    watch::guarded_once(work).unwrap_or_else(|error| Err(error.into()))
}

/// The same of work that compiles.
pub(crate) fn compiled_within_memory<T, E: From<CompileError>>(
    work: impl FnOnce() -> Result<T, E>,
) -> Result<T, E> {
    watch::guarded(work).unwrap_or_else(|error| Err(CompileError::Memory(error).into()))
}

impl From<NoMemory> for EvalError {
    fn from(error: NoMemory) -> Self {
        Self::Memory(error)
    }
}

impl From<Stopped> for EvalError {
    fn from(_: Stopped) -> Self {
        Self::Cancelled
    }
}

impl From<RunError> for EvalError {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Selection => Self::Selection,
            RunError::Inputs { expected, given } | RunError::Outputs { expected, given } => {
                Self::Planes { expected, given }
            }
            RunError::Length { expected, given, .. } => Self::Length { expected, given },
        }
    }
}
