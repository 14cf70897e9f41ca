//! Where vertices may be: in their cells, a little off the sides, so that vertices of different cells never
//! coincide; and not where another vertex of their own cell is.
//!
//! ```text
//!     +-----------+-----------+
//!     | +-------+ | +-------+ |      Programs that read a mesh merge equal positions. If two sheets
//!     | |       | | |       | |      that come near each other had a vertex in common, the mesh would
//!     | |     o | | | o     | |      be pinched there, and no manifold any more.
//!     | +-------+ | +-------+ |
//!     +-----------+-----------+
//! ```

use super::Batch;

/// What vertices keep from the sides of their cells, in parts of a quarter of the cell's edge.
const MARGIN: f32 = 1.0 / 1024.0;

/// Four steps of f32 between two coordinates: that many times the distance of neighbouring numbers, where it
/// is largest.
fn four_steps(low: f32, high: f32) -> f32 {
    /// The bits of the exponent; what is left with the others cleared is a power of two, 2^23 steps long.
    const EXPONENT: u32 = 0x7f80_0000;
    let largest = low.abs().max(high.abs());
    f32::from_bits(largest.to_bits() & EXPONENT) * (4.0 * f32::EPSILON)
}

/// A quarter of the way between two coordinates. Nothing overflows.
fn quarter(low: f32, high: f32) -> f32 {
    0.25 * high - 0.25 * low
}

/// Between which coordinates a vertex stays in a cell from `low` to `high`: off these by 2^-12 of the cell,
/// and by four steps of f32 where that is more, but never by more than a quarter.
#[inline(always)]
pub(super) fn room([low, high]: [f32; 2]) -> [f32; 2] {
    let quarter = quarter(low, high);
    let margin = (MARGIN * quarter).max(four_steps(low, high)).min(quarter);
    [low + margin, high - margin]
}

/// Whether four steps of f32 are more than a quarter of a cell, somewhere between the first and the last
/// coordinate along an axis: then vertices lie on a coarse grid, and those of different cells may coincide.
pub(in super::super) fn is_crowded(axes: &[Vec<f32>; 3]) -> bool {
    axes.iter().any(|axis| {
        let (first, last) = (axis[0], axis[axis.len() - 1]);
        // Cells are equal but for rounding.
        let quarter = quarter(first, last) / (axis.len() - 1) as f32;
        four_steps(first, last) > quarter
    })
}

impl Batch {
    /// Moves vertices off others of their cells: step by step towards the mean of their sheet's crossings,
    /// which is not where others have theirs, and then towards the middle of the cell. `doubles` are the
    /// vertices of second and further sheets, with these means.
    pub(super) fn separate(&mut self) {
        for &(vertex, mean) in &self.doubles {
            let earlier = vertex - self.owners[vertex].1 as usize;
            let at = |vertex: usize| [0, 1, 2].map(|axis| self.points[axis][vertex]);
            let is_free = |p: [f32; 3]| (earlier..vertex).all(|other| at(other) != p);
            let start = at(vertex);
            if is_free(start) {
                continue;
            }
            let [low, high] = self.bounds(vertex);
            let middle = [0, 1, 2].map(|axis| 0.5 * low[axis] + 0.5 * high[axis]);
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
    fn vertices_stay_off_the_sides() {
        assert_eq!(room([0.0, 1.0]), [1.0 / 4096.0, 1.0 - 1.0 / 4096.0]);
        // Near 1000 a step is 2^-14: four are more than 2^-12 of a cell of 1/8.
        assert_eq!(room([1000.0, 1000.125]), [1000.0 + 4.0 / 16384.0, 1000.125 - 4.0 / 16384.0]);
        // Two steps for a cell: in between there is one number.
        let far = [16_777_212.0, 16_777_214.0];
        let [low, high] = room(far);
        assert!(far[0] <= low && low <= high && high <= far[1]);
        let [low, high] = room([-3e38, 3e38]);
        assert!(-3e38 < low && low < high && high < 3e38);
        let [low, high] = room([-1e-45, 1e-45]);
        assert!(-1e-45 <= low && low <= high && high <= 1e-45);
    }

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
