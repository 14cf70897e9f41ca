//! Ranges of many parts of a box, and the regions of the wanted parts, from one run of the interval kernel.
//!
//! ```text
//! survey(region, boxes):   ranges of the field and of all probes in all boxes         one run, any number of lanes
//!                          for the boxes that are wanted, by their ranges, 8 at a time:
//!                              rows that matter, by supports and by the same probes    no second run
//! ```

use jbt_ir::watch;

use super::{MAX_RANGED_ROWS, Pruner, Region};
use crate::boxes::{ANYTHING, Box3, Range};
use crate::error::{EvalError, once_within_memory};

impl Pruner {
    /// The ranges of the field in any number of proper boxes inside a region, and the regions of the boxes
    /// whose range is wanted.
    ///
    /// The result equals that of [`ranges`](crate::boxes::Divisible::ranges) and
    /// [`narrow`](crate::boxes::Divisible::narrow), at lower cost: both run the interval kernel where
    /// operands may not decide, and a run of few boxes fills few of its lanes.
    ///
    /// # Errors
    /// A region of a model with other numbers of rows.
    pub fn survey(
        &self,
        region: &Region,
        boxes: &[Box3],
        wanted: &dyn Fn(Range) -> bool,
    ) -> Result<Vec<(Range, Option<Region>)>, EvalError> {
        once_within_memory(|| self.surveyed(region, boxes, wanted))
    }

    fn surveyed(
        &self,
        region: &Region,
        boxes: &[Box3],
        wanted: &dyn Fn(Range) -> bool,
    ) -> Result<Vec<(Range, Option<Region>)>, EvalError> {
        let each = size_of::<(Range, Option<Region>)>() + 2 * size_of::<(usize, Box3)>();
        watch::take(boxes.len() * each);
        let mut found: Vec<(Range, Option<Region>)> = Vec::with_capacity(boxes.len());
        let mut chosen = Vec::new();
        let mut wants = |index: usize, range: Range| {
            found.push((range, None));
            chosen.extend(wanted(range).then_some(index));
            wanted(range)
        };
        let mut regions = Vec::new();
        self.divided(region, boxes, &mut wants, &mut regions)?;
        for (index, region) in chosen.into_iter().zip(regions) {
            found[index].1 = Some(region);
        }
        Ok(found)
    }

    /// The interval evaluations of distances that ranges of so many boxes inside a region take.
    pub(crate) fn range_evaluations(&self, region: &Region, boxes: usize) -> u64 {
        if region.rows() > MAX_RANGED_ROWS { 0 } else { self.evaluations(&region.selection, boxes) }
    }

    /// The ranges of the field in any number of proper boxes inside a region, and the number of interval
    /// evaluations of distances for each box.
    pub(crate) fn many_ranges(
        &self,
        region: &Region,
        boxes: &[Box3],
    ) -> Result<(Vec<Range>, u64), EvalError> {
        if region.rows() > MAX_RANGED_ROWS || boxes.is_empty() {
            return Ok((vec![ANYTHING; boxes.len()], 0));
        }
        let ranges = self.evaluate(&region.selection, boxes)?;
        let fields = (0..boxes.len()).map(|lane| ranges.field(lane)).collect();
        Ok((fields, self.evaluations(&region.selection, 1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boxes::Divisible;
    use crate::compiler::Compiler;
    use crate::kernel::Engine;
    use jbt_model::builder::{point, segment};
    use jbt_model::model::Model;
    use jbt_model::tree::Tree;

    /// So many points in a row along x.
    fn pruner(count: usize) -> Pruner {
        let tree = Tree::sum((0..count).map(|at| point([at as f64, 0.0, 0.0], 0.75)));
        Pruner::new(&Compiler::for_engine(Engine::Lanes), &Model::new(tree).check().expect("a good model"))
            .expect("it compiles")
    }

    fn boxes() -> [Box3; 4] {
        [0.0, 1.0, 2.25, -9.0].map(|at| Box3::new([at, 0.0, 0.0], [at + 0.25, 0.25, 0.25]))
    }

    /// The wanted boxes inside a region, each by its index and with its region.
    fn split(
        pruner: &Pruner,
        region: &Region,
        boxes: &[Box3],
        wanted: fn(Range) -> bool,
    ) -> Vec<(usize, Region)> {
        let (mut kept, mut regions) = (Vec::new(), Vec::new());
        let mut wants = |lane: usize, range: Range| {
            kept.extend(wanted(range).then_some(lane));
            wanted(range)
        };
        pruner.split(region, boxes, &mut wants, &mut regions).expect("parts");
        assert_eq!(kept.len(), regions.len());
        kept.into_iter().zip(regions).collect()
    }

    #[test]
    fn ranges_and_regions_are_those_of_single_questions() {
        let pruner = pruner(3);
        let region = pruner.everywhere();
        let mut expected = [ANYTHING; 4];
        pruner.ranges(&region, &boxes(), &mut expected).expect("ranges");
        let before = pruner.counters();
        let (ranges, evaluations) = pruner.many_ranges(&region, &boxes()).expect("ranges");
        assert_eq!((&ranges[..], evaluations), (&expected[..], 3), "three distances for a box");
        let taken = pruner.counters();
        assert_eq!(taken.boxes - before.boxes, 4);
        assert_eq!(taken.interval_evaluations - before.interval_evaluations, 12);
        assert_eq!(pruner.many_ranges(&region, &[]).expect("no ranges"), (Vec::new(), 0));
        assert_eq!(pruner.range_evaluations(&region, 4), 12);
        let before = pruner.counters();
        let kept = split(&pruner, &region, &boxes(), |range| range[1] > 0.0);
        let taken = pruner.counters();
        assert_eq!(taken.interval_evaluations - before.interval_evaluations, 12);
        let (mut parts, before) = (Vec::new(), taken);
        pruner.narrow(&region, &boxes(), &mut parts).expect("regions");
        assert_eq!(pruner.counters(), before, "without probes nobody asks for ranges");
        let found: Vec<_> = kept.iter().map(|(lane, region)| (*lane, region.selection())).collect();
        let expected: Vec<_> = [0, 1, 2].map(|lane| (lane, parts[lane].selection())).to_vec();
        assert_eq!(found, expected);
    }

    #[test]
    fn operands_that_cannot_win_are_in_no_region() {
        // In the first box both sums are there, and the second of them, of another shape, is less.
        let strong = point([0.0; 3], 2.0) + point([0.25, 0.0, 0.0], 2.0);
        let weak = point([0.0, 1.5, 0.0], 2.0) + segment([0.0, 1.5, 0.0], [0.0, 3.0, 0.0], 2.0);
        let tree = Model::new(Tree::union([strong, weak])).check().expect("a good model");
        let pruner = Pruner::new(&Compiler::for_engine(Engine::Lanes), &tree).expect("it compiles");
        let region = pruner.everywhere();
        let bounds = [Box3::new([-0.1; 3], [0.1; 3])];
        let before = pruner.counters().boxes;
        let kept = split(&pruner, &region, &bounds, |_| true);
        assert_eq!(pruner.counters().boxes, before + 1, "one run tells both");
        let surveyed = pruner.survey(&region, &bounds, &|_| true).expect("parts");
        let mut parts = Vec::new();
        pruner.narrow(&region, &bounds, &mut parts).expect("regions");
        assert!(
            pruner.program.info.probes > 0 && parts[0].rows() < region.rows(),
            "{} rows",
            parts[0].rows()
        );
        assert_eq!(kept[0].1.selection(), parts[0].selection());
        assert_eq!(surveyed[0].1.as_ref().map(Region::selection), Some(parts[0].selection()));
    }

    #[test]
    fn of_too_many_rows_there_are_no_ranges() {
        for (count, ranged) in [(MAX_RANGED_ROWS - 1, true), (MAX_RANGED_ROWS, false)] {
            // The scene is a row, too.
            let pruner = pruner(count);
            let region = pruner.everywhere();
            let (ranges, evaluations) = pruner.many_ranges(&region, &boxes()).expect("ranges");
            assert_eq!(evaluations, if ranged { count as u64 } else { 0 });
            assert_eq!(ranges.iter().any(|&range| range != ANYTHING), ranged);
            let kept = split(&pruner, &region, &boxes(), |range| range[1] > 0.0);
            assert_eq!(pruner.range_evaluations(&region, 4), if ranged { 4 * count as u64 } else { 0 });
            assert_eq!(kept.len(), if ranged { 3 } else { 4 });
        }
    }

    #[test]
    fn operands_of_too_many_rows_are_not_decided() {
        let weak = point([0.0, 1.5, 0.0], 2.0) + segment([0.0, 1.5, 0.0], [0.0, 3.0, 0.0], 2.0);
        let pruner = |count: usize| {
            let strong = Tree::sum((0..count).map(|at| point([1e-4 * at as f64, 0.0, 0.0], 2.0)));
            let tree = Model::new(Tree::union([strong, weak.clone()])).check().expect("a good model");
            Pruner::new(&Compiler::for_engine(Engine::Lanes), &tree).expect("it compiles")
        };
        let others = pruner(2).everywhere().rows() - 2;
        for (rows, decided) in [(MAX_RANGED_ROWS, true), (MAX_RANGED_ROWS + 1, false)] {
            let pruner = pruner(rows - others);
            let region = pruner.everywhere();
            assert_eq!(region.rows(), rows);
            let mut parts = Vec::new();
            pruner.narrow(&region, &[Box3::new([-0.1; 3], [0.1; 3])], &mut parts).expect("regions");
            assert_eq!(parts[0].rows() < rows, decided, "{} of {rows} rows", parts[0].rows());
        }
    }
}
