//! Why there is no picture.

use jbt_ir::limits::{MAX_ANTIALIAS, MAX_PICTURE_PIXELS, MAX_PICTURE_SIDE};
use jbt_ir::memory::NoMemory;
use jbt_model::diagnostic::Diagnostics;

use super::camera::CameraError;
use crate::boxes::Box3;
use crate::error::{Classified, CompileError, ErrorKind, EvalError};
use crate::job::JobError;
use crate::solid::BoundsError;
use crate::trace::TraceError;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The picture has no pixels.
    #[error("a picture needs at least one pixel along each side, and this one is {width} x {height}")]
    Empty {
        /// Pixels of a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The picture has more pixels than are allowed.
    #[error(
        "a picture may have {MAX_PICTURE_SIDE} pixels along a side and {MAX_PICTURE_PIXELS} in all, and this one is {width} x {height}"
    )]
    TooLarge {
        /// Pixels of a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// No rays for a pixel, or more than are allowed.
    #[error(
        "a pixel takes 1 x 1 to {MAX_ANTIALIAS} x {MAX_ANTIALIAS} rays, and not {antialias} x {antialias}"
    )]
    Antialias {
        /// Rays along each side of a pixel.
        antialias: u32,
    },
    /// The camera is none.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The camera's numbers are beyond those of any model.
    #[error("the camera is too far away, or sees too much or too little, for its numbers")]
    Unusable,
    /// The camera stands inside the solid, from where no surface can be seen from outside.
    #[error(
        "the camera stands inside the solid, at ({}, {}, {}): move it out, or cut the solid open by a region that it is outside of",
        eye[0], eye[1], eye[2]
    )]
    Inside {
        /// Where it stands.
        eye: [f64; 3],
    },
    /// The region is infinite, flat, not a number or not in order.
    #[error(
        "a region has finite corners, each number of the first below that of the second, and this one goes from {:?} to {:?}",
        region.low, region.high
    )]
    Region {
        /// What was given.
        region: Box3,
    },
    /// The model's field may differ from zero arbitrarily far away, and no region was given.
    #[error("the model is unbounded: its picture needs a region")]
    Unbounded,
    /// There is no such attribute.
    #[error("the model has no attribute `{name}`; it has {}", known.join(", "))]
    Attribute {
        /// What was asked for.
        name: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// The memory for the work is not to be had.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// The model could not be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// The bounds of the model were not found.
    #[error(transparent)]
    Bounds(#[from] BoundsError),
    /// A ray could not be traced.
    #[error(transparent)]
    Trace(#[from] TraceError),
    /// The field could not be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
    /// It was told to stop.
    #[error("the picture was cancelled")]
    Cancelled,
}

impl JobError for RenderError {
    fn told(self) -> Self {
        if self.kind() == ErrorKind::Cancelled { Self::Cancelled } else { self }
    }
}

impl Classified for RenderError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Empty { .. }
            | Self::Unusable
            | Self::Inside { .. }
            | Self::Region { .. }
            | Self::Attribute { .. } => ErrorKind::Argument,
            Self::Unbounded => ErrorKind::Unbounded,
            Self::TooLarge { .. } | Self::Antialias { .. } | Self::Memory(_) => ErrorKind::Limit,
            Self::Camera(error) => error.kind(),
            Self::Compile(error) => error.kind(),
            Self::Bounds(error) => error.kind(),
            Self::Trace(error) => error.kind(),
            Self::Eval(error) => error.kind(),
            Self::Cancelled => ErrorKind::Cancelled,
        }
    }

    fn diagnostics(&self) -> Option<&Diagnostics> {
        if let Self::Compile(error) = self { error.diagnostics() } else { None }
    }
}
