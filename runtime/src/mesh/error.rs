//! Why there is no mesh, and the bounds of what may be asked for.

use std::any::Any;
use std::error::Error;

use jbt_ir::limits::MAX_ATTRIBUTE_WIDTH;
use jbt_ir::memory::NoMemory;
use thiserror::Error;

use crate::error::{Classified, ErrorKind, EvalError};
use crate::job::JobError;
use crate::progress::Cancelled;

/// The smallest [`Options::brick`](super::Options::brick).
pub const MIN_BRICK: usize = 2;
/// The largest [`Options::brick`](super::Options::brick).
pub const MAX_BRICK: usize = 32;
/// The largest [`Options::pulls`](super::Options::pulls). Newton's step has converged long before.
pub const MAX_PULLS: usize = 64;

/// Why there is no mesh. `E` is the error of the field.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError<E: Error + 'static> {
    /// The field could not be evaluated.
    #[error("the field cannot be evaluated")]
    Field(#[source] E),
    /// It was told to stop.
    #[error("meshing was cancelled")]
    Cancelled,
    /// The iso-value is infinite or NaN.
    #[error("the iso-value must be a finite number, and it is {iso}")]
    Iso {
        /// What was asked for.
        iso: f32,
    },
    /// The edge of a brick is no power of two, or not from [`MIN_BRICK`] to [`MAX_BRICK`].
    #[error(
        "the edge of a brick is a power of two from {MIN_BRICK} to {MAX_BRICK}, and {brick} was asked for"
    )]
    Brick {
        /// What was asked for.
        brick: usize,
    },
    /// More than [`MAX_PULLS`] pulls.
    #[error("a vertex is pulled at most {MAX_PULLS} times, and {pulls} were asked for")]
    Pulls {
        /// What was asked for.
        pulls: usize,
    },
    /// The field has an attribute of no reals, or of more than [`MAX_ATTRIBUTE_WIDTH`].
    #[error("an attribute has from 1 to {MAX_ATTRIBUTE_WIDTH} reals, and {name:?} has {width}")]
    Width {
        /// The name of the attribute.
        name: String,
        /// Its width.
        width: usize,
    },
    /// More bricks, or boxes of one larger size, than [`MAX_BRICKS`](jbt_ir::limits::MAX_BRICKS).
    #[error("the surface passes through more than {limit} bricks of the lattice")]
    TooManyBricks {
        /// How many there may be.
        limit: usize,
    },
    /// The memory for all bricks, points of bricks, vertices or triangles is not to be had.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// Whether faces of a block of cells are flipped depends on cells further away than was looked at: a
    /// chain of ambiguous faces leads there. It has to be asked again with a larger reach.
    #[error("flipped faces depend on cells more than {reach} cells away from the block")]
    Reach {
        /// How far was looked, in cells.
        reach: usize,
    },
    /// More vertices than a u32 can number.
    #[error("the mesh would have {vertices} vertices, more than can be numbered in 32 bits")]
    TooManyVertices {
        /// How many there would be.
        vertices: u64,
    },
}

impl Classified for MeshError<EvalError> {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Iso { .. } | Self::Brick { .. } | Self::Pulls { .. } | Self::Width { .. } => {
                ErrorKind::Argument
            }
            Self::TooManyBricks { .. }
            | Self::Memory(_)
            | Self::Reach { .. }
            | Self::TooManyVertices { .. } => ErrorKind::Limit,
            Self::Field(error) => error.kind(),
            Self::Cancelled => ErrorKind::Cancelled,
        }
    }
}

impl<E: Error + 'static> JobError for MeshError<E> {
    fn told(self) -> Self {
        let is_stop = |error: &E| (error as &dyn Any).downcast_ref() == Some(&EvalError::Cancelled);
        if matches!(&self, Self::Field(error) if is_stop(error)) { Self::Cancelled } else { self }
    }
}

impl<E: Error + 'static> From<Cancelled> for MeshError<E> {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}
