//! The margin of vertices to the sides of their cells: so large that rounding takes no vertex across a side.

/// The margin, in quarters of the cell's edge.
const MARGIN: f32 = 1.0 / 1024.0;

/// Four steps of f32 between two coordinates: four times the largest distance of neighbouring numbers there.
pub(super) fn four_steps(low: f32, high: f32) -> f32 {
    /// The exponent bits: a number with only these bits is a power of two, 2^23 steps long.
    const EXPONENT: u32 = 0x7f80_0000;
    let largest = low.abs().max(high.abs());
    f32::from_bits(largest.to_bits() & EXPONENT) * (4.0 * f32::EPSILON)
}

/// A quarter of the way between two coordinates, without overflow.
pub(super) fn quarter(low: f32, high: f32) -> f32 {
    0.25 * high - 0.25 * low
}

/// The range of a vertex in a cell from `low` to `high`: the cell without a margin of 2^-12 of the cell, or
/// of four steps of f32 if that is more, but of at most a quarter.
#[inline(always)]
pub(super) fn room([low, high]: [f32; 2]) -> [f32; 2] {
    let quarter = quarter(low, high);
    let margin = (MARGIN * quarter).max(four_steps(low, high)).min(quarter);
    [low + margin, high - margin]
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
}
