//! Skeletons of any number of points: their pieces are rows of a table of their own, and their distance is a
//! fold over these.
//!
//! ```text
//! row of the leaf     point in the pose;  accumulators = begin(beyond)
//!   row of a piece    accumulators = step(point, piece, accumulators)
//! row of the leaf     squared distance = emit(point, columns and accumulators);  falloff
//! ```
//!
//! So a curve through 5 points and one through 700 are the same code. A smallest distance begins at
//! [`BEYOND`] support radii, where the field is exactly zero: a piece that is out of reach in a box, or all
//! of them, can be left out there.

/// What is folded over the pieces of a skeleton.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pieces {
    /// The names of the columns of a piece.
    pub columns: &'static [&'static str],
    /// Whether a piece counts only within the support radius of itself, so that it may be left out elsewhere.
    pub local: bool,
}

/// Where smallest distances begin, in support radii: far enough that no rounding brings the field above zero.
pub const BEYOND: f64 = 2.0;
