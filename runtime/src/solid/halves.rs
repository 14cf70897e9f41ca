//! Boxes of searches in solids: how they are cut, and the ranges of fields over them.

use super::Solid;
use crate::boxes::{ANYTHING, Box3, Divisible as _, MAX_PARTS, Range};
use crate::error::EvalError;
use crate::prune::Region;

/// In how many parts a box is cut along each axis: sides that are much shorter than the longest stay whole.
pub(super) fn halves(bounds: &Box3) -> [usize; 3] {
    let longest = bounds.longest_side();
    [0, 1, 2].map(|axis| if bounds.high[axis] - bounds.low[axis] > 0.5 * longest { 2 } else { 1 })
}

/// The ranges of a field over up to [`MAX_PARTS`] boxes.
pub(super) fn ranges(solid: &Solid, region: &Region, boxes: &[Box3]) -> Result<Vec<Range>, EvalError> {
    debug_assert!(boxes.len() <= MAX_PARTS);
    let mut ranges = vec![ANYTHING; boxes.len()];
    if !boxes.is_empty() {
        solid.pruner.ranges(region, boxes, &mut ranges)?;
    }
    Ok(ranges)
}
