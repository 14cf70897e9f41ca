//! Ranges of fields over boxes of searches in solids.

use super::Solid;
use crate::boxes::{ANYTHING, Box3, Divisible as _, MAX_PARTS, Range};
use crate::error::EvalError;
use crate::prune::Region;

/// The ranges of a field over up to [`MAX_PARTS`] boxes.
pub(super) fn ranges(solid: &Solid, region: &Region, boxes: &[Box3]) -> Result<Vec<Range>, EvalError> {
    debug_assert!(boxes.len() <= MAX_PARTS);
    let mut ranges = vec![ANYTHING; boxes.len()];
    if !boxes.is_empty() {
        solid.pruner.ranges(region, boxes, &mut ranges)?;
    }
    Ok(ranges)
}
