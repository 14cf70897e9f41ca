//! Why a model has no evaluator.

use jbt_ir::VerifyError;
use jbt_ir::engine::RunError;
use jbt_model::diagnostic::Diagnostics;

/// Why a model could not be compiled.
#[derive(Clone, Debug, thiserror::Error)]
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
    /// The compiler made a program that breaks its own rules: a defect of jbt.
    #[error("the compiler broke its own rules: {}", .0.first().map_or(String::new(), ToString::to_string))]
    Internal(Vec<VerifyError>),
}

/// Why points were not evaluated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
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
