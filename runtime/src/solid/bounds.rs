//! Tight bounds: how far the solid reaches along each axis, by branch and bound with ranges.
//!
//! ```text
//! for each of the six sides:                       ...+----+----+
//!     open = {the region}                             |    | ?  |  <- reaches farthest: the next one
//!     take the open box that reaches farthest         +----+----+
//!     stop if it reaches no farther than the           | in |  ?
//!         known inside points, but for the tolerance   +----+----
//!     take its slices off that are outside, or else cut it into parts that are open
//!     from points of it that are inside, climb to others that reach farther
//! ```

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use jbt_ir::limits::MAX_SEARCH_BOXES;
use jbt_ir::watch;

use super::{RegionError, Solid, SolidBatch};
use crate::boxes::{ANYTHING, Box3, Divisible as _, MAX_PARTS};
use crate::error::{Classified, ErrorKind, EvalError, within_memory};
use crate::ordered::ordered;
use crate::prune::Region;

/// A box around a solid, and one that the solid fills up to its sides.
#[derive(Clone, Copy, PartialEq, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct TightBounds {
    /// Every point of the region that is inside is in this box: proven. `None`: the region holds no inside
    /// point.
    pub outer: Option<Box3>,
    /// The smallest box around the points that are known to be inside. `None` if none was found.
    pub inner: Option<Box3>,
    /// Whether each side of the outer box is within the tolerance of that of the inner one, or the solid is
    /// empty. It is not where ranges do not converge, or do so after too many boxes ([`MAX_SEARCH_BOXES`] for
    /// a side), or where f32 is coarser than the tolerance.
    pub converged: bool,
}

impl TightBounds {
    /// Those of an empty solid.
    const NOTHING: Self = Self { outer: None, inner: None, converged: true };
}

/// Why a solid has no tight bounds.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BoundsError {
    /// There is no region to search.
    #[error(transparent)]
    Region(#[from] RegionError),
    /// The tolerance is zero, negative, infinite or not a number.
    #[error("the tolerance of bounds must be a finite number greater than 0, and it is {tolerance}")]
    Tolerance {
        /// What was given.
        tolerance: f32,
    },
    /// The field could not be evaluated.
    #[error(transparent)]
    Eval(#[from] EvalError),
}

impl Classified for BoundsError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Region(error) => error.kind(),
            Self::Tolerance { .. } => ErrorKind::Argument,
            Self::Eval(error) => error.kind(),
        }
    }
}

impl Solid {
    /// A box around the part of the solid that is in a region; each side is within the tolerance (in units of
    /// the model) of the true one, if the answer says [`converged`](TightBounds::converged). Without a region
    /// it is the model's support, so all of the solid.
    ///
    /// # Errors
    /// A region that is infinite, flat, not a number or not in order; none for an unbounded model; a
    /// tolerance that is not finite and greater than 0. Want of memory.
    pub fn tight_bounds(&self, region: Option<Box3>, tolerance: f32) -> Result<TightBounds, BoundsError> {
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(BoundsError::Tolerance { tolerance });
        }
        let outer = match self.region(region) {
            Ok(bounds) => bounds,
            Err(RegionError::Empty) => return Ok(TightBounds::NOTHING),
            Err(error @ (RegionError::Bounds { .. } | RegionError::Unbounded)) => return Err(error.into()),
        };
        within_memory(|| self.tightened(tolerance, outer))
    }

    /// The tight bounds of what is in a box.
    fn tightened(&self, tolerance: f32, mut outer: Box3) -> Result<TightBounds, BoundsError> {
        let mut found = TightBounds::NOTHING;
        for side in BoxSide::ALL {
            let mut search = SideSearch::new(self, side, tolerance, outer, found.inner);
            // What was found of a side narrows the search for the next one.
            let Some(reach) = search.run()? else {
                return Ok(found);
            };
            found.inner = search.inner;
            *side.of(&mut outer) = side.coordinate(reach);
        }
        if let Some(inner) = &mut found.inner {
            found.converged =
                BoxSide::ALL.iter().all(|side| side.reach(&outer) <= side.reach(inner) + tolerance);
        } else {
            found.converged = false;
        }
        found.outer = Some(outer);
        Ok(found)
    }
}

/// Steps of a climb at most.
const MAX_CLIMB: usize = 256;

/// One of the six sides of a box.
#[derive(Clone, Copy)]
struct BoxSide {
    axis: usize,
    upper: bool,
}

impl BoxSide {
    const ALL: [Self; 6] = [
        Self { axis: 0, upper: false },
        Self { axis: 0, upper: true },
        Self { axis: 1, upper: false },
        Self { axis: 1, upper: true },
        Self { axis: 2, upper: false },
        Self { axis: 2, upper: true },
    ];

    fn of(self, bounds: &mut Box3) -> &mut f32 {
        if self.upper { &mut bounds.high[self.axis] } else { &mut bounds.low[self.axis] }
    }

    /// How far a box reaches: larger is farther, on lower sides too.
    fn reach(self, bounds: &Box3) -> f32 {
        if self.upper { bounds.high[self.axis] } else { -bounds.low[self.axis] }
    }

    /// The coordinate of a reach.
    fn coordinate(self, reach: f32) -> f32 {
        if self.upper { reach } else { -reach }
    }
}

/// A box that may hold inside points farther than all that are known.
struct FartherBox {
    reach: f32,
    /// The number of boxes that were open before it: of equals the first is taken first.
    number: usize,
    bounds: Box3,
    around: Region,
}

impl Ord for FartherBox {
    fn cmp(&self, other: &Self) -> Ordering {
        self.reach.total_cmp(&other.reach).then(other.number.cmp(&self.number))
    }
}

ordered! { FartherBox }

/// The search for one side.
struct SideSearch<'a> {
    solid: &'a Solid,
    side: BoxSide,
    tolerance: f32,
    whole: Box3,
    /// The smallest box around all points that are known to be inside.
    inner: Option<Box3>,
    open: BinaryHeap<FartherBox>,
    /// Boxes that were opened.
    opened: usize,
    /// Boxes that were asked about.
    asked: usize,
    batch: SolidBatch,
}

impl<'a> SideSearch<'a> {
    fn new(solid: &'a Solid, side: BoxSide, tolerance: f32, whole: Box3, inner: Option<Box3>) -> Self {
        let (open, batch) = (BinaryHeap::new(), SolidBatch::default());
        Self { solid, side, tolerance, whole, inner, open, opened: 0, asked: 0, batch }
    }

    /// How far the solid reaches at most. `None`: there is none in this box.
    fn run(&mut self) -> Result<Option<f32>, EvalError> {
        self.push(self.whole, &self.solid.pruner.everywhere());
        while let Some(open) = self.open.pop() {
            if open.reach <= self.known() + self.tolerance || self.asked >= MAX_SEARCH_BOXES {
                return Ok(Some(open.reach.max(self.known())));
            }
            if !self.expand(&open)? {
                // One f32 from side to side: nothing more can be told.
                return Ok(Some(open.reach));
            }
        }
        Ok(self.inner.map(|inner| self.side.reach(&inner)))
    }

    /// How far the known points reach.
    fn known(&self) -> f32 {
        self.inner.map_or(f32::NEG_INFINITY, |inner| self.side.reach(&inner))
    }

    fn push(&mut self, bounds: Box3, around: &Region) {
        let reach = self.side.reach(&bounds);
        if reach > self.known() {
            self.opened += 1;
            watch::take_for_heap(&self.open);
            self.open.push(FartherBox { reach, number: self.opened, bounds, around: around.clone() });
        }
    }

    /// All points of a box are inside.
    fn learn(&mut self, bounds: &Box3) {
        let inner = self.inner.get_or_insert(*bounds);
        for axis in 0..3 {
            inner.low[axis] = inner.low[axis].min(bounds.low[axis]);
            inner.high[axis] = inner.high[axis].max(bounds.high[axis]);
        }
    }

    /// Makes an open box smaller, or cuts it. False if it cannot be cut.
    fn expand(&mut self, open: &FartherBox) -> Result<bool, EvalError> {
        let mut bounds = open.bounds;
        // What is nearer than known points does not matter.
        if self.known() > f32::NEG_INFINITY {
            let known = self.side.coordinate(self.known());
            let near = if self.side.upper { &mut bounds.low } else { &mut bounds.high };
            let near = &mut near[self.side.axis];
            *near = if self.side.upper { near.max(known) } else { near.min(known) };
        }
        let mut regions = Vec::with_capacity(1);
        self.solid.pruner.narrow(&open.around, &[bounds], &mut regions)?;
        let region = &regions[0];
        let mut counts = [1; 3];
        counts[self.side.axis] = MAX_PARTS;
        let mut slices = bounds.cut(counts);
        if !self.side.upper {
            slices.reverse();
        }
        let outside =
            self.ask(&slices, region)?.iter().rev().take_while(|side| **side == Some(false)).count();
        if outside > 0 {
            slices.truncate(slices.len() - outside);
            if let Some(farthest) = slices.last() {
                *self.side.of(&mut bounds) = self.side.coordinate(self.side.reach(farthest));
                self.push(bounds, region);
            }
            return Ok(true);
        }
        let parts = bounds.halved();
        if parts.len() == 1 {
            return Ok(false);
        }
        let sides = self.ask(&parts, region)?;
        for (part, _) in parts.iter().zip(sides).filter(|(_, side)| *side != Some(false)) {
            self.push(*part, region);
        }
        Ok(true)
    }

    /// Which side of the surface boxes of a region are on, and what inside points are in them.
    fn ask(&mut self, boxes: &[Box3], region: &Region) -> Result<Vec<Option<bool>>, EvalError> {
        self.asked += boxes.len();
        let mut ranges = [ANYTHING; MAX_PARTS];
        self.solid.pruner.ranges(region, boxes, &mut ranges[..boxes.len()])?;
        let sides: Vec<Option<bool>> =
            ranges[..boxes.len()].iter().map(|&range| self.solid.side(range)).collect();
        self.batch.clear();
        for (bounds, side) in boxes.iter().zip(&sides) {
            match side {
                Some(true) => self.learn(bounds),
                Some(false) => {}
                None => {
                    self.batch.push(bounds.center());
                    self.batch.push(self.far_point(bounds));
                }
            }
        }
        let inside = self.batch.sides(self.solid, region)?;
        let before = self.known();
        let mut farthest = None;
        for index in (0..inside.len()).filter(|&index| inside[index]) {
            let point = self.batch.point(index);
            let bounds = Box3::new(point, point);
            if self.side.reach(&bounds) >= self.known() {
                farthest = Some(point);
            }
            self.learn(&bounds);
        }
        match farthest {
            Some(point) if self.known() > before => self.climb(point)?,
            Some(_) | None => {}
        }
        Ok(sides)
    }

    /// A point of a box that would do if it were inside: its far side is within the tolerance.
    fn far_point(&self, bounds: &Box3) -> [f32; 3] {
        let mut point = bounds.center();
        let (low, high) = (bounds.low[self.side.axis], bounds.high[self.side.axis]);
        let far = self.side.coordinate(self.side.reach(bounds) - self.tolerance);
        point[self.side.axis] = far.clamp(low, high);
        point
    }

    /// Goes from an inside point to inside points that reach farther, as far as there are any: straight
    /// ahead, or to the sides and a little ahead, in steps that get smaller where all lead outside.
    fn climb(&mut self, mut point: [f32; 3]) -> Result<(), EvalError> {
        let everywhere = self.solid.pruner.everywhere();
        let whole = self.whole;
        let side = self.side;
        let reach = |point: [f32; 3]| side.reach(&Box3::new(point, point));
        let mut step = whole.longest_side() / 16.0;
        for _ in 0..MAX_CLIMB {
            if step < self.tolerance / 4.0 {
                break;
            }
            self.batch.clear();
            for [ahead, aside, across] in steps() {
                let mut to = point;
                to[side.axis] += side.coordinate(step * ahead);
                to[(side.axis + 1) % 3] += step * aside;
                to[(side.axis + 2) % 3] += step * across;
                self.batch.push([0, 1, 2].map(|axis| to[axis].clamp(whole.low[axis], whole.high[axis])));
            }
            let inside = self.batch.sides(self.solid, &everywhere)?;
            let best = (0..inside.len()).filter(|&index| inside[index]).fold(point, |best, index| {
                let to = self.batch.point(index);
                if reach(to) > reach(best) { to } else { best }
            });
            if reach(best) > reach(point) {
                point = best;
                self.learn(&Box3::new(point, point));
            } else {
                step /= 2.0;
            }
        }
        Ok(())
    }
}

/// The steps of a climb, of length 1: ahead, and to two sides.
fn steps() -> impl Iterator<Item = [f32; 3]> {
    let straight = (0..8).map(|halvings| [1.0 / (1 << halvings) as f32, 0.0, 0.0]);
    let aside = (0..9).filter(|&index| index != 4);
    straight.chain(aside.map(|index| [1.0 / 64.0, (index % 3 - 1) as f32, (index / 3 - 1) as f32]))
}
