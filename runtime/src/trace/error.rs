//! Why rays have no answer.

use jbt_ir::limits::{MAX_PACKET_RAYS, MAX_RAY_WORK};

use crate::error::{Classified, ErrorKind, EvalError};

/// Why rays were not followed. Rays are counted from 0, in the packet in which they were given.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TraceError {
    /// A number of a ray is infinite or no number.
    #[error(
        "the numbers of ray {ray} have to be finite: origin {origin:?}, direction {direction:?}, span {span:?}"
    )]
    NotFinite {
        /// Which ray.
        ray: usize,
        /// Its origin.
        origin: [f64; 3],
        /// Its direction.
        direction: [f64; 3],
        /// Its span.
        span: [f64; 2],
    },
    /// A ray goes nowhere.
    #[error("the direction of ray {ray} is zero")]
    Direction {
        /// Which ray.
        ray: usize,
    },
    /// The span of a ray ends before it begins.
    #[error("the span of ray {ray} goes from {} to {}, which is less", span[0], span[1])]
    Span {
        /// Which ray.
        ray: usize,
        /// Its span.
        span: [f64; 2],
    },
    /// A ray gets to where f32 has no numbers.
    #[error("ray {ray} gets to {position:?}, which is too far away for f32")]
    Far {
        /// Which ray.
        ray: usize,
        /// How far it gets.
        position: [f64; 3],
    },
    /// More rays than a packet may have.
    #[error("a packet has up to {MAX_PACKET_RAYS} rays, and this one has {rays}")]
    Rays {
        /// How many were given.
        rays: usize,
    },
    /// The tolerance is not a length.
    #[error("the tolerance of rays is a finite length above 0, and not {tolerance}")]
    Tolerance {
        /// What was given.
        tolerance: f64,
    },
    /// The tolerance is finer than the positions that can be told apart.
    #[error(
        "the tolerance {tolerance} is too small for ray {ray}: positions on it are only told apart from {resolution} on; \
         shorten its span, or allow more"
    )]
    Resolution {
        /// Which ray.
        ray: usize,
        /// What was given.
        tolerance: f64,
        /// The smallest tolerance for this ray.
        resolution: f64,
    },
    /// The field said too little about boxes, and the tolerance is so small that nobody would want to wait.
    #[error(
        "after {MAX_RAY_WORK} points and boxes a ray, {rays} rays are still not done: the tolerance is too small \
         for their length"
    )]
    Work {
        /// How many rays were given.
        rays: usize,
    },
    /// The field could not be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
}

impl Classified for TraceError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotFinite { .. }
            | Self::Direction { .. }
            | Self::Span { .. }
            | Self::Far { .. }
            | Self::Tolerance { .. }
            | Self::Resolution { .. } => ErrorKind::Argument,
            Self::Rays { .. } | Self::Work { .. } => ErrorKind::Limit,
            Self::Eval(error) => error.kind(),
        }
    }
}
