//! Pruning: the rows that matter in a box, and bounds of the field there.
//!
//! ```text
//! ranges:  one call of the interval kernel, boxes as lanes, with the rows of the region around them
//! region:  of all rows, those whose supports reach one box; if small boxes are asked for, by a tree   (root, tree);
//!          of rows that meet in a contest, those that may win, by another                           (winners)
//! narrow:  for each table, row by row: the boxes that the row's support reaches              (cull)
//!          the rule of the operator says which of the zero rows may go                        (rule)
//!          operands of a union below its field in the whole box cannot win: left out (an intersection: above),
//!          as ranges of probes tell of tables of one row                                      (decide)
//!          of other rows, ranges in a box come from one run with rows as lanes                (contest)
//! split:   ranges and, of wanted boxes, regions: one call tells the field and the probes
//! ```
//!
//! A selection is right if evaluation with it gives, at every point of its box, the same bits as evaluation
//! with all rows: field, gradient, attributes. Three facts ensure this:
//!
//! * Outside of its support a row's field and gradient are exactly zero in the arithmetic of the kernels;
//!   each operator's rule says which zero rows may be left out ([`jbt_ir::Rule`]).
//! * The interval kernel runs the kernel's own ops on bounds, so a range encloses every f32 value that the
//!   kernel gives in the box. An operand is left out only if such ranges prove it strictly smaller (or
//!   larger).
//! * Rows stay in their order.

mod contest;
mod cull;
mod decide;
mod edit;
mod lanes;
mod limit;
pub(crate) mod program;
mod ranges;
mod root;
mod rule;
mod sharing;
mod survey;
mod tree;
mod winners;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use jbt_ir::domain::counting::of_selection;
use jbt_ir::selection::Extent;
use jbt_ir::{Entity as _, Selection, Tables, watch};
use jbt_lower::prune_info::SupportSpace;
use jbt_model::check::CheckedTree;
use jbt_model::origin::ModelOrigin;

use crate::boxes::{ANYTHING, Box3, Divisible, MAX_PARTS, Range, wanted};
use crate::compiled::Compiled;
use crate::compiler::Compiler;
use crate::debug::brief_debug;
use crate::error::{CompileError, EvalError, compiled_within_memory, once_within_memory};

use cull::Boxes;
use program::RangeProgram;
use ranges::{ProbeRanges, Ranges};
use sharing::{PartSelection, Sharing};

/// A box, and the rows of a model that run in it, for each table. A [`Pruner`] makes it
/// ([`Divisible::region`]). Every evaluator of the model takes a region
/// ([`Evaluator::eval_region`](crate::Evaluator::eval_region)).
#[derive(Clone, Debug)]
pub struct Region {
    bounds: Box3,
    selection: Arc<Selection>,
}

impl Region {
    /// The box.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        self.bounds
    }

    /// The rows that run.
    #[must_use]
    pub fn selection(&self) -> &Selection {
        &self.selection
    }

    /// Appends the regions of the parts in `boxes`: `masks` has a byte for each row that runs, with a bit for
    /// each part in which the row matters.
    fn narrow_by(&self, boxes: &[Box3], mut masks: Vec<u8>, parts: &mut Vec<Self>) {
        // Parts in which the same rows matter share a selection: of small boxes, as bricks are, most do.
        let sharing = Sharing::of(&masks, boxes.len());
        let mut selections: [Selection; MAX_PARTS] = Default::default();
        if sharing.own > 0 {
            sharing.gather(&mut masks);
            self.selection.narrow(&mut masks, &mut selections[..sharing.own]);
        }
        let mut own = selections.into_iter();
        let first = parts.len();
        for (&bounds, of) in boxes.iter().zip(sharing.parts) {
            let selection = match of {
                PartSelection::Whole => Arc::clone(&self.selection),
                PartSelection::Part(part) => Arc::clone(&parts[first + part].selection),
                PartSelection::Own => Arc::new(own.next().expect("each such part is counted")),
            };
            parts.push(Self { bounds, selection });
        }
    }

    /// The number of rows that run, over all tables.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.selection.len()
    }

    /// What it keeps, in bytes. Regions in which the same rows run may share them.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Self>() + self.selection.bytes()
    }
}

/// A model, compiled for questions about boxes: see the module.
pub struct Pruner {
    /// Boxes are in coordinates about its origin.
    compiled: Compiled,
    program: Arc<RangeProgram>,
    counts: Counts,
}

brief_debug!(Pruner, "Pruner", this: counters = this.counters());

/// The work of a pruner so far.
#[derive(Debug, Default)]
struct Counts {
    boxes: AtomicU64,
    primitives: AtomicU64,
}

/// The work of a pruner so far. A snapshot: see [`Pruner::counters`].
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PruneCounters {
    /// Boxes for which a range was computed.
    pub boxes: u64,
    /// Interval evaluations of distances to skeletons for these boxes.
    pub interval_evaluations: u64,
}

/// The most rows in a region for which ranges of its parts are computed. With more rows the ranges are too
/// wide to be useful; smaller parts will have better ones.
const MAX_RANGED_ROWS: usize = 4096;
/// What a region keeps besides its rows: an estimate.
const REGION_BYTES: usize = 256;

impl Compiled {
    /// What can be asked about boxes of the model. It has done nothing so far.
    ///
    /// # Errors
    /// The model is beyond a limit, or the engine cannot be had.
    pub fn pruner(&self) -> Result<Pruner, CompileError> {
        let program = Arc::clone(self.ranges()?);
        Ok(Pruner { compiled: self.clone(), program, counts: Counts::default() })
    }
}

impl Pruner {
    /// A pruner for a model of which nothing else is asked: see [`Compiled::pruner`].
    ///
    /// # Errors
    /// Those of [`Compiled::pruner`].
    pub fn new(compiler: &Compiler, tree: &CheckedTree) -> Result<Self, CompileError> {
        compiler.compile(tree).pruner()
    }

    /// A pruner for another model, usually an edited one: see [`Compiled::updated`].
    ///
    /// # Errors
    /// Those of [`Compiled::pruner`].
    pub fn updated(&self, tree: &CheckedTree) -> Result<Self, CompileError> {
        compiled_within_memory(|| self.compiled.updated(tree).pruner())
    }

    /// What it runs.
    pub(crate) fn program(&self) -> &RangeProgram {
        &self.program
    }

    /// The model.
    pub(crate) fn compiled(&self) -> &Compiled {
        &self.compiled
    }

    /// The origin of the coordinates of boxes: the same as [`Evaluator::origin`](crate::Evaluator::origin).
    #[must_use]
    pub fn origin(&self) -> ModelOrigin {
        self.compiled.origin()
    }

    /// The work so far.
    #[must_use]
    pub fn counters(&self) -> PruneCounters {
        PruneCounters {
            boxes: self.counts.boxes.load(Ordering::Relaxed),
            interval_evaluations: self.counts.primitives.load(Ordering::Relaxed),
        }
    }

    /// The region of all space: every row runs.
    #[must_use]
    pub fn everywhere(&self) -> Region {
        let bounds = Box3::new([f32::MIN; 3], [f32::MAX; 3]);
        Region { bounds, selection: Arc::clone(self.program.bound.all()) }
    }

    fn extent(&self) -> &Arc<Extent> {
        self.program.bound.all().extent()
    }

    fn tables(&self) -> &Tables {
        self.program.bound.tables()
    }

    /// Ranges of the field and of all probes in boxes, by one counted run of the interval kernel.
    fn evaluate(&self, rows: &Selection, boxes: &[Box3]) -> Result<Ranges, EvalError> {
        let mut ranges = Ranges::new(&self.program.bound, boxes);
        ranges.find(&self.program.bound, rows)?;
        self.counts.boxes.fetch_add(boxes.len() as u64, Ordering::Relaxed);
        self.counts.primitives.fetch_add(self.evaluations(rows, boxes.len()), Ordering::Relaxed);
        Ok(ranges)
    }

    /// The interval evaluations of distances to skeletons for some boxes.
    fn evaluations(&self, rows: &Selection, boxes: usize) -> u64 {
        of_selection(&self.program.bound.kernel.per_row, rows).saturating_mul(boxes as u64)
    }

    /// For each active row of the region, the boxes in which it matters, a bit each. `probes` are the ranges
    /// of the field and of all probes in these boxes, if they are known.
    fn masks(
        &self,
        region: &Region,
        boxes: &[Box3],
        probes: Option<ProbeRanges<'_>>,
    ) -> Result<Vec<u8>, EvalError> {
        let world = Boxes::new(boxes);
        let selection = &*region.selection;
        watch::take(selection.len());
        let mut masks = vec![world.all(); selection.len()];
        let mut first = 0;
        for &table in selection.present() {
            let (info, supports) = (&self.program.info.tables[table], &self.program.supports[table.index()]);
            let active = selection.active(table);
            let mine = &mut masks[first..][..active.len()];
            first += active.len();
            let inside;
            let boxes = match (info.space, probes) {
                (SupportSpace::World, _) => &world,
                (SupportSpace::Probed(probe), Some(probes)) => {
                    inside = inner_boxes(probes, probe);
                    &inside
                }
                (SupportSpace::Probed(_), None) | (SupportSpace::Unknown, _) => continue,
            };
            let Some(supports) = supports else { continue };
            for (mask, &row) in mine.iter_mut().zip(active) {
                *mask = supports.reach(row, boxes);
            }
            rule::apply(info.rule, selection.starts(table), mine, boxes.all());
        }
        if let Some(probes) = probes {
            decide::leave_out(&self.program.info, probes, selection, &mut masks);
        }
        let RangeProgram { bound, contests, info, .. } = &*self.program;
        let taken = contests.leave_out((bound, info), (selection, boxes), probes, &mut masks)?;
        self.counts.primitives.fetch_add(taken, Ordering::Relaxed);
        Ok(masks)
    }

    /// Appends the regions of some parts of a region; the probes have these ranges there.
    fn regions(
        &self,
        region: &Region,
        boxes: &[Box3],
        probes: Option<ProbeRanges<'_>>,
        regions: &mut Vec<Region>,
    ) -> Result<(), EvalError> {
        watch::take(REGION_BYTES * boxes.len());
        for (index, boxes) in boxes.chunks(MAX_PARTS).enumerate() {
            let probes = probes.map(|probes| probes.chunk(index, MAX_PARTS));
            region.narrow_by(boxes, self.masks(region, boxes, probes)?, regions);
        }
        Ok(())
    }

    /// The region of a box.
    fn region_of(&self, bounds: Box3) -> Result<Region, EvalError> {
        let mut region = self.everywhere();
        if region.rows() > MAX_RANGED_ROWS {
            // Supports first: they tell of most rows, and ranges are computed of few rows only.
            let RangeProgram { bound, contests, trees, .. } = &*self.program;
            let mut winners = |table| {
                let (positions, taken) = contests.winners(bound, table, &bounds)?;
                self.counts.primitives.fetch_add(taken, Ordering::Relaxed);
                Ok(positions)
            };
            let selection = trees.reaching(self.program.bounded_rows(), &bounds, &mut winners)?;
            region = Region { bounds, selection: Arc::new(selection) };
            if region.rows() > MAX_RANGED_ROWS && contests.is_empty() {
                return Ok(region);
            }
        }
        let mut parts = Vec::with_capacity(1);
        self.narrowed(&region, &[bounds], &mut parts)?;
        let region = parts.pop().expect("one box has one region");
        self.program.trees.note(self.program.bound.all().len(), region.rows());
        Ok(region)
    }

    /// Appends the regions of some parts of a region: see [`Divisible::narrow`].
    fn narrowed(&self, region: &Region, boxes: &[Box3], parts: &mut Vec<Region>) -> Result<(), EvalError> {
        let probed = self.program.info.probes > 0 && region.rows() <= MAX_RANGED_ROWS;
        let ranges = if probed { Some(self.evaluate(&region.selection, boxes)?) } else { None };
        let lanes: [usize; MAX_PARTS] = std::array::from_fn(|lane| lane);
        self.regions(region, boxes, ranges.as_ref().map(|ranges| ranges.probes(&lanes[..boxes.len()])), parts)
    }

    /// Appends the regions of the wanted ones of any number of parts of a region, by one run of the interval
    /// kernel: see [`Divisible::split`].
    fn divided(
        &self,
        region: &Region,
        boxes: &[Box3],
        wants: &mut dyn FnMut(usize, Range) -> bool,
        parts: &mut Vec<Region>,
    ) -> Result<(), EvalError> {
        let known = region.rows() <= MAX_RANGED_ROWS;
        let ranges = if known { Some(self.evaluate(&region.selection, boxes)?) } else { None };
        let range = |lane| ranges.as_ref().map_or(ANYTHING, |ranges| ranges.field(lane));
        let (lanes, kept) = wanted(boxes, &mut |lane| wants(lane, range(lane)));
        if kept.is_empty() {
            return Ok(());
        }
        let probes = if self.program.info.probes > 0 { ranges.as_ref() } else { None };
        self.regions(region, &kept, probes.map(|ranges| ranges.probes(&lanes)), parts)
    }
}

/// The boxes of a point inside of a warp, whose ranges are probes.
fn inner_boxes(probes: ProbeRanges<'_>, probe: usize) -> Boxes {
    let mut boxes = [Box3::default(); MAX_PARTS];
    let boxes = &mut boxes[..probes.count()];
    for (lane, bounds) in boxes.iter_mut().enumerate() {
        for axis in 0..3 {
            [bounds.low[axis], bounds.high[axis]] = probes.range(probe + axis, lane);
        }
    }
    Boxes::new(boxes)
}

/// What has a pruner, which divides space for it.
pub(crate) trait Pruned: Sync {
    fn pruner(&self) -> &Pruner;
}

impl<T: Pruned> Divisible for T {
    type Error = EvalError;
    type Region = Region;

    fn region(&self, bounds: Box3) -> Result<Region, EvalError> {
        self.pruner().region(bounds)
    }

    fn ranges(&self, region: &Region, boxes: &[Box3], ranges: &mut [Range]) -> Result<(), EvalError> {
        self.pruner().ranges(region, boxes, ranges)
    }

    fn narrow(&self, region: &Region, boxes: &[Box3], parts: &mut Vec<Region>) -> Result<(), EvalError> {
        self.pruner().narrow(region, boxes, parts)
    }

    fn split(
        &self,
        region: &Region,
        boxes: &[Box3],
        wants: &mut dyn FnMut(usize, Range) -> bool,
        parts: &mut Vec<Region>,
    ) -> Result<(), EvalError> {
        self.pruner().divided(region, boxes, wants, parts)
    }
}

impl Divisible for Pruner {
    type Error = EvalError;
    type Region = Region;

    fn region(&self, bounds: Box3) -> Result<Region, EvalError> {
        once_within_memory(|| self.region_of(bounds))
    }

    fn ranges(&self, region: &Region, boxes: &[Box3], ranges: &mut [Range]) -> Result<(), EvalError> {
        if region.rows() > MAX_RANGED_ROWS {
            ranges.fill(ANYTHING);
            return Ok(());
        }
        let found = once_within_memory(|| self.evaluate(&region.selection, boxes))?;
        for (lane, range) in ranges.iter_mut().enumerate() {
            *range = found.field(lane);
        }
        Ok(())
    }

    fn narrow(&self, region: &Region, boxes: &[Box3], parts: &mut Vec<Region>) -> Result<(), EvalError> {
        once_within_memory(|| self.narrowed(region, boxes, parts))
    }

    fn split(
        &self,
        region: &Region,
        boxes: &[Box3],
        wants: &mut dyn FnMut(usize, Range) -> bool,
        parts: &mut Vec<Region>,
    ) -> Result<(), EvalError> {
        once_within_memory(|| self.divided(region, boxes, wants, parts))
    }
}
