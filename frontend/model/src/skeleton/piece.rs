//! Skeletons of any number of points: their pieces are rows of their own table, and their distance is a fold
//! over these rows.
//!
//! ```text
//! row of the leaf     point in the pose;  accumulators = begin(beyond)
//!   row of a piece    accumulators = step(point, piece, accumulators)
//! row of the leaf     squared distance = emit(point, columns and accumulators);  falloff
//! ```
//!
//! So a curve through 5 points and a curve through 700 points share one code. A smallest distance begins at
//! [`BEYOND`] support radii, where the field is exactly zero: pieces that are out of reach of a box can be
//! left out there, even all of them.

/// What is folded over the pieces of a skeleton.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pieces {
    /// The names of the columns of a piece.
    pub columns: &'static [&'static str],
    /// Whether a piece counts only within the support radius around itself, so that it may be left out
    /// elsewhere.
    pub local: bool,
}

/// Where smallest distances begin, in support radii: far enough that no rounding brings the field above zero.
pub const BEYOND: f64 = 2.0;
