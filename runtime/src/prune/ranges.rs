//! Results of a run of the interval kernel: ranges of the field and of all probes in some boxes.

use jbt_ir::Selection;
use smallvec::SmallVec;

use crate::boxes::{Box3, Range};
use crate::error::EvalError;
use crate::kernel::BoundKernel;

/// Boxes, a lane each, and the ranges in them.
pub(super) struct Ranges {
    /// The low and the high ends of the boxes along each axis, plane by plane.
    boxes: Vec<f32>,
    /// The low and the high ends of the field and of each probe, plane by plane.
    numbers: Vec<f32>,
    /// Numbers of a plane: the number of boxes, or a whole block of the kernel if that is more.
    stride: usize,
}

impl Ranges {
    /// Boxes without ranges.
    pub(super) fn new(kernel: &BoundKernel, boxes: &[Box3]) -> Self {
        // A run of fewer boxes than a block would copy them to a block and back: whole blocks run in place.
        let stride = boxes.len().max(kernel.kernel.block());
        let mut ends = vec![0.0; 6 * stride];
        for lane in 0..stride {
            let bounds = boxes.get(lane).or(boxes.last()).copied().unwrap_or_default();
            for axis in 0..3 {
                ends[2 * axis * stride + lane] = bounds.low[axis];
                ends[(2 * axis + 1) * stride + lane] = bounds.high[axis];
            }
        }
        let planes = kernel.kernel.function.function().outputs.len();
        Self { boxes: ends, numbers: vec![0.0; planes * stride], stride }
    }

    /// Computes the ranges with the rows of a selection.
    pub(super) fn find(&mut self, kernel: &BoundKernel, rows: &Selection) -> Result<(), EvalError> {
        let boxes: [&[f32]; 6] =
            std::array::from_fn(|plane| &self.boxes[plane * self.stride..][..self.stride]);
        let mut planes: SmallVec<[&mut [f32]; 8]> = self.numbers.chunks_exact_mut(self.stride).collect();
        kernel.run(rows, &boxes, &mut planes)?;
        Ok(())
    }

    /// The range of the field in a box.
    pub(super) fn field(&self, lane: usize) -> Range {
        [self.numbers[lane], self.numbers[self.stride + lane]]
    }

    /// The ranges of the probes in some of the boxes.
    pub(super) fn probes<'a>(&'a self, lanes: &'a [usize]) -> ProbeRanges<'a> {
        ProbeRanges { ranges: self, lanes }
    }
}

/// Ranges of all probes in some boxes.
#[derive(Clone, Copy)]
pub(super) struct ProbeRanges<'a> {
    ranges: &'a Ranges,
    /// The lane of each box.
    lanes: &'a [usize],
}

impl<'a> ProbeRanges<'a> {
    /// The number of boxes.
    pub(super) fn count(self) -> usize {
        self.lanes.len()
    }

    /// The probes of chunk `index` of the boxes: `size` boxes, fewer in the last chunk.
    pub(super) fn chunk(self, index: usize, size: usize) -> ProbeRanges<'a> {
        let start = index * size;
        ProbeRanges { lanes: &self.lanes[start..self.lanes.len().min(start + size)], ..self }
    }

    /// The range of a probe in a box, by the box's index.
    pub(super) fn range(self, probe: usize, place: usize) -> Range {
        let Ranges { numbers, stride, .. } = self.ranges;
        // The field's range comes before the ranges of the probes.
        let low = 2 * (1 + probe) * stride + self.lanes[place];
        [numbers[low], numbers[low + stride]]
    }
}
