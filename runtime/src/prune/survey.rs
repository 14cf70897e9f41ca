//! Ranges of many parts of a box, and the regions of those that are worth it, from one run of the interval kernel.
//!
//! ```text
//! survey(region, boxes):   ranges of the field and of all probes in all boxes         one run, any number of lanes
//!                          for the boxes that are wanted, by their ranges, 8 at a time:
//!                              rows that matter, by supports and by the same probes    no second run
//! ```

use super::{MAX_RANGED_ROWS, Pruner, Region};
use crate::error::EvalError;
use crate::region::{ANYTHING, Box3, MAX_PARTS, Range};

impl Pruner {
    /// The ranges of the field in any number of proper boxes inside a region, and the regions of those whose range is wanted.
    ///
    /// It is what [`ranges`](crate::region::Divisible::ranges) and [`narrow`](crate::region::Divisible::narrow) give, and costs less: where operands
    /// that do not decide are to be found, both run the interval kernel, and a run of few boxes fills few of its lanes.
    ///
    /// # Errors
    /// A region of a model with other numbers of rows.
    pub fn survey(
        &self,
        region: &Region,
        boxes: &[Box3],
        wanted: &dyn Fn(Range) -> bool,
    ) -> Result<Vec<(Range, Option<Region>)>, EvalError> {
        let ranged = region.rows() <= MAX_RANGED_ROWS;
        let planes = if ranged { self.evaluate_many(region, boxes)? } else { Vec::new() };
        let range = |index: usize| if ranged { [planes[0][index], planes[1][index]] } else { ANYTHING };
        let mut found: Vec<(Range, Option<Region>)> =
            (0..boxes.len()).map(|index| (range(index), None)).collect();
        let chosen: Vec<usize> = (0..boxes.len()).filter(|&index| wanted(found[index].0)).collect();
        let probed = ranged && self.guide.probes > 0;
        let mut regions = Vec::with_capacity(chosen.len());
        for some in chosen.chunks(MAX_PARTS) {
            let mut parts = [Box3::default(); MAX_PARTS];
            some.iter().zip(&mut parts).for_each(|(&index, part)| *part = boxes[index]);
            let parts = &parts[..some.len()];
            let probes: Option<Vec<[f32; MAX_PARTS]>> =
                probed.then(|| planes.iter().map(|plane| gather(plane, some)).collect());
            let masks = self.masks(region, parts, probes.as_deref())?;
            region.narrow_by(parts, masks, &mut regions);
        }
        for (index, region) in chosen.into_iter().zip(regions) {
            found[index].1 = Some(region);
        }
        Ok(found)
    }

    /// Up to [`MAX_PARTS`] boxes inside a region whose ranges are wanted, each by its place among them and with its region; and how many ranges of distances to
    /// skeletons that took. It is [`ranges`](Divisible::ranges) and [`narrow`](Divisible::narrow) at the cost of one.
    pub(crate) fn split(
        &self,
        region: &Region,
        boxes: &[Box3],
        wanted: &dyn Fn(Range) -> bool,
    ) -> Result<(Vec<(usize, Region)>, u64), EvalError> {
        let ranged = region.rows() <= MAX_RANGED_ROWS;
        let mut probes = if ranged { self.evaluate(&region.selection, boxes)? } else { Vec::new() };
        let is_wanted = |&lane: &usize| !ranged || wanted([probes[0][lane], probes[1][lane]]);
        let kept: Vec<usize> = (0..boxes.len()).filter(is_wanted).collect();
        let evaluations = if ranged { self.evaluations(&region.selection, boxes.len()) } else { 0 };
        if kept.is_empty() {
            return Ok((Vec::new(), evaluations));
        }
        let mut some = [Box3::default(); MAX_PARTS];
        for (lane, &from) in kept.iter().enumerate() {
            some[lane] = boxes[from];
            probes.iter_mut().for_each(|plane| plane[lane] = plane[from]);
        }
        let mut regions = Vec::with_capacity(kept.len());
        let (some, probed) = (&some[..kept.len()], ranged && self.guide.probes > 0);
        let masks = self.masks(region, some, probed.then_some(&probes[..]))?;
        region.narrow_by(some, masks, &mut regions);
        Ok((kept.into_iter().zip(regions).collect(), evaluations))
    }

    /// The ranges of the field in any number of proper boxes inside a region, and how many ranges of distances to
    /// skeletons each of them took.
    pub(crate) fn many_ranges(
        &self,
        region: &Region,
        boxes: &[Box3],
    ) -> Result<(Vec<Range>, u64), EvalError> {
        if region.rows() > MAX_RANGED_ROWS || boxes.is_empty() {
            return Ok((vec![ANYTHING; boxes.len()], 0));
        }
        let count = boxes.len();
        let mut inputs = vec![0.0; 6 * count];
        for (index, bounds) in boxes.iter().enumerate() {
            for axis in 0..3 {
                inputs[2 * axis * count + index] = bounds.low[axis];
                inputs[(2 * axis + 1) * count + index] = bounds.high[axis];
            }
        }
        let mut outputs = vec![0.0; self.planes() * count];
        let mut planes: Vec<&mut [f32]> = outputs.chunks_exact_mut(count).collect();
        let inputs: [&[f32]; 6] = std::array::from_fn(|plane| &inputs[plane * count..][..count]);
        self.run(&region.selection, &inputs, &mut planes)?;
        let ranges = planes[0].iter().zip(&*planes[1]).map(|(&low, &high)| [low, high]).collect();
        Ok((ranges, self.evaluations(&region.selection, 1)))
    }

    /// Ranges of the field and of all probes: plane by plane, the low and the high ends, one for each box.
    fn evaluate_many(&self, region: &Region, boxes: &[Box3]) -> Result<Vec<Vec<f32>>, EvalError> {
        let side = |plane: usize| {
            let axis = plane / 2;
            let of =
                |bounds: &Box3| if plane.is_multiple_of(2) { bounds.low[axis] } else { bounds.high[axis] };
            boxes.iter().map(of).collect::<Vec<f32>>()
        };
        let inputs: [Vec<f32>; 6] = std::array::from_fn(side);
        let mut outputs = vec![vec![0.0; boxes.len()]; self.planes()];
        let mut planes: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
        self.run(&region.selection, &inputs.each_ref().map(Vec::as_slice), &mut planes)?;
        Ok(outputs)
    }
}

fn gather(plane: &[f32], some: &[usize]) -> [f32; MAX_PARTS] {
    let mut lanes = [0.0; MAX_PARTS];
    some.iter().zip(&mut lanes).for_each(|(&index, lane)| *lane = plane[index]);
    lanes
}
