//! The room of vertices: their cells, a little off the sides, so that vertices of different cells never
//! coincide; and off other vertices of their own cell.
//!
//! ```text
//!     +-----------+-----------+
//!     | +-------+ | +-------+ |      Programs that read a mesh merge equal positions. If two sheets
//!     | |       | | |       | |      that come near each other had a vertex in common, the mesh would
//!     | |     o | | | o     | |      be pinched there, and no manifold any more.
//!     | +-------+ | +-------+ |
//!     +-----------+-----------+
//! ```

use super::batch::{Shared, VertexBatch};
use super::margin::{four_steps, quarter};

/// Whether four steps of f32 are more than a quarter of a cell, somewhere between the first and the last
/// coordinate along an axis: then vertices lie on a coarse grid, and vertices of different cells may
/// coincide.
pub(in super::super) fn is_crowded(axes: &[Vec<f32>; 3]) -> bool {
    axes.iter().any(|axis| {
        let (first, last) = (axis[0], axis[axis.len() - 1]);
        // Cells are equal, except for rounding.
        let quarter = quarter(first, last) / (axis.len() - 1) as f32;
        four_steps(first, last) > quarter
    })
}

impl VertexBatch {
    /// Separates vertices of one cell: step by step towards the mean of their sheet's crossings, where they
    /// started at different places, and then towards the middle of the cell.
    pub(super) fn separate(&mut self) {
        for &Shared { vertex, earlier, start: mean, .. } in &self.shared {
            let earlier = vertex - earlier;
            let at = |vertex: usize| [0, 1, 2].map(|axis| self.points[axis][vertex]);
            let is_free = |p: [f32; 3]| (earlier..vertex).all(|other| at(other) != p);
            let start = at(vertex);
            if is_free(start) {
                continue;
            }
            let bounds = self.bounds(vertex);
            let middle = [0, 1, 2].map(|axis| bounds.middle(axis));
            let parts = [1.0 / 64.0, 1.0 / 16.0, 0.25, 0.5];
            let ways = [mean, middle].into_iter().flat_map(|aim| parts.map(|part| (aim, part)));
            let mut steps =
                ways.map(|(aim, part)| [0, 1, 2].map(|axis| start[axis] * (1.0 - part) + aim[axis] * part));
            let Some(free) = steps.find(|&step| is_free(step)) else { continue };
            self.points.iter_mut().zip(free).for_each(|(plane, coordinate)| plane[vertex] = coordinate);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_few_steps_are_crowded() {
        let axes =
            |first: f32, size: f32| [0; 3].map(|_| (0_u8..9).map(|n| first + size * f32::from(n)).collect());
        assert!(!is_crowded(&axes(0.0, 1e-3)));
        // Near 1e5 a step is 2^-7, and 16 of them are an eighth.
        assert!(!is_crowded(&axes(1e5, 0.125)));
        assert!(is_crowded(&axes(1e5, 0.0625)));
        assert!(is_crowded(&axes(-1e5, 0.0625)));
    }
}
