//! Why there is no part of a model.

use jbt_ir::table::TableError;
use jbt_model::diagnostic::Diagnostics;

use crate::boxes::Box3;
use crate::bytes::FormatError;
use crate::error::{Classified, CompileError, ErrorKind, EvalError};

/// Why there is no part of a model, or why it does not answer.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RemoteError {
    /// Bytes are not what they should be.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The model could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A box was refused.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// The rows are those of a model of another shape.
    #[error("the rows belong to another shape: {rows:016x} instead of {shape:016x}")]
    Shape {
        /// What the rows say.
        rows: u64,
        /// What the shape is.
        shape: u64,
    },
    /// The rows do not fit the programs.
    #[error("the rows do not fit: {0}")]
    Rows(#[from] TableError),
    /// The shape has no program for a query, or one that answers something else.
    #[error("the shape has no program for the query `{query}`")]
    Query {
        /// What was asked.
        query: String,
    },
    /// What is asked for is not within the box of the rows.
    #[error("the rows are those of another box: {asked:?} is not within {known:?}")]
    Bounds {
        /// Where it would be asked.
        asked: Box3,
        /// Where the rows are all that matters.
        known: Box3,
    },
}

impl Classified for RemoteError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Compile(error) => error.kind(),
            Self::Eval(error) => error.kind(),
            Self::Format(error) => error.kind(),
            Self::Shape { .. } | Self::Rows(_) | Self::Query { .. } | Self::Bounds { .. } => {
                ErrorKind::Argument
            }
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        if let Self::Compile(error) = self { error.diagnostics() } else { None }
    }
}
