//! What second looks at the vertices of a brick find; the memory is used again by the next brick.

use super::super::pull::LANES;
use super::bracket::BracketPoints;
use super::sheet::Sheet;

/// The results of the tests of vertices, as 1 or 0 each.
pub(super) struct VertexTests {
    /// Far from the surface.
    pub(super) far: [u32; LANES],
    /// The gradient does not explain the spread of the field in the cell, or is NaN.
    pub(super) odd: [u32; LANES],
    /// The gradient is far from the rise of the field in the cell.
    pub(super) turned: [u32; LANES],
}

/// Room for second looks at the suspects of a brick.
#[derive(Default)]
pub(super) struct SecondLooks {
    pub(super) verdicts: Vec<(usize, VertexTests)>,
    /// The suspects, each with whether it is far from the surface.
    pub(super) found: Vec<(usize, bool)>,
    pub(super) sheets: Vec<Sheet>,
    pub(super) again: Vec<Again>,
    /// The field and what belongs to it where it is asked for again.
    pub(super) points: BracketPoints,
    pub(super) attributes: Vec<f32>,
}

/// A second evaluation: the vertex, its position, and the point to evaluate.
pub(super) struct Again {
    pub(super) vertex: usize,
    pub(super) position: [f32; 3],
    pub(super) asked: [f32; 3],
    pub(super) normal: Option<[f32; 3]>,
}
