//! What two solids have in common: boxes that may have points of both are cut, and points of them are asked.
//!
//! ```text
//! take a box, cut it into parts         -> those out of question are left out: one of the fields is below the
//!                                          iso-value all over the part grown by the tolerance
//! a part is inside of both              -> they overlap
//! the middle of a part is the best yet: -> climb from it to where min(f_a, f_b) is larger; if that is inside of
//!                                          both, look for a cube about it that is
//! a part is as small as the tolerance   -> it stays
//!
//! first the box with the best middle, so that an overlap is found soon; later the largest box, so that what is
//! left in the end is small everywhere
//! ```
//!
//! A part that is not grown has points of both if any box has. So two points of the solids that are nearer to
//! each other than the tolerance have the point between them in a part that stays. A middle that is inside of
//! both ends the search, so no ball that has a middle of a box in it is in both where it has not ended.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use jbt_ir::limits::MAX_OVERLAP_WORK;
use jbt_ir::watch;

use super::ranges::ranges;
use super::{Solid, SolidBatch};
use crate::boxes::{Box3, Divisible as _, MAX_PARTS};
use crate::error::EvalError;
use crate::ordered::ordered;
use crate::prune::Region;

/// The part of the work that is for the boxes with the best middles.
const GREEDY_WORK: u64 = MAX_OVERLAP_WORK / 8;

/// What a cut takes besides the rows that run in its box, in rows.
const CUT_WORK: u64 = 1 << 10;

/// Steps of a climb at most.
const MAX_CLIMB: usize = 48;

/// How often the cube about a point inside of both is halved at most. What is thinner than the last one,
/// compared with the space of the search, may be so by rounding.
const MAX_HALVINGS: i32 = 18;

/// What a search for points of both has found.
pub(super) enum PairFound {
    /// There are none.
    Nothing,
    /// There may be some.
    Left(LeftBoxes),
    /// A box inside of both.
    Both(Box3),
}

/// Boxes that may have points of both.
pub(super) struct LeftBoxes {
    /// The longest side of the largest one.
    pub longest: f32,
    /// Whether they are no larger than the tolerance.
    pub are_small: bool,
    /// The point with the largest field in both that was found in one of them.
    pub best: [f32; 3],
}

/// A box, what is known of it grown by the tolerance for both fields, and the smaller of them in its middle,
/// less the iso-value.
struct PairBox {
    bounds: Box3,
    regions: [Region; 2],
    middle: f32,
    /// How soon it is cut: by the first number, then by the second.
    urgency: [f32; 2],
    number: u64,
}

impl Ord for PairBox {
    /// The most urgent is the greatest; of equals the one that was found first.
    fn cmp(&self, other: &Self) -> Ordering {
        let by = |place: usize| self.urgency[place].total_cmp(&other.urgency[place]);
        by(0).then(by(1)).then(other.number.cmp(&self.number))
    }
}

ordered! { PairBox }

/// A point, and how far both fields are above the iso-value there.
type BothPoint = (f32, [f32; 3]);

/// A search for points of two solids.
pub(super) struct PairSearch<'a> {
    solids: [&'a Solid; 2],
    tolerance: f32,
    /// Where they may have points in common.
    whole: Box3,
    open: BinaryHeap<PairBox>,
    is_greedy: bool,
    /// Boxes that were found, and what was cut, in rows.
    count: u64,
    work: u64,
    /// The best point so far, and the best one inside of both about which no cube is.
    best: f32,
    failed: f32,
    /// The longest side of those that are as small as the tolerance, and the one with the best middle.
    small: f32,
    small_best: Option<(f32, Box3)>,
    batch: SolidBatch,
}

impl<'a> PairSearch<'a> {
    /// A search in a box.
    pub(super) fn new(solids: [&'a Solid; 2], whole: Box3, tolerance: f32) -> Self {
        Self {
            solids,
            tolerance,
            whole,
            open: BinaryHeap::new(),
            is_greedy: true,
            count: 0,
            work: 0,
            best: f32::NEG_INFINITY,
            failed: f32::NEG_INFINITY,
            small: 0.0,
            small_best: None,
            batch: SolidBatch::default(),
        }
    }

    /// Searches until all is known or the work is used up.
    pub(super) fn run(mut self) -> Result<PairFound, EvalError> {
        let around = grown(&self.whole, self.tolerance);
        let [a, b] = self.solids.map(|solid| solid.pruner.region(around));
        self.push(self.whole, [a?, b?], f32::NEG_INFINITY);
        while self.work < MAX_OVERLAP_WORK {
            watch::go_on()?;
            if self.is_greedy && self.work >= GREEDY_WORK {
                self.is_greedy = false;
                let open: Vec<PairBox> = std::mem::take(&mut self.open).into_vec();
                let again = |one: PairBox| PairBox { urgency: self.urgency(&one.bounds, one.middle), ..one };
                self.open = open.into_iter().map(again).collect();
            }
            let Some(first) = self.open.pop() else { break };
            let parts = first.bounds.halved();
            if parts.len() == 1 {
                self.keep(first.bounds, first.middle);
            } else if let Some(both) = self.expand(&first, &parts)? {
                return Ok(PairFound::Both(both));
            }
        }
        self.left()
    }

    /// The boxes that are left, if there are any.
    fn left(mut self) -> Result<PairFound, EvalError> {
        let are_small = self.open.is_empty();
        let longest = self.open.iter().fold(self.small, |most, one| most.max(one.bounds.longest_side()));
        // Of equals the one that was found first. What is no number is less than any.
        let value = |one: &PairBox| one.middle.max(f32::NEG_INFINITY);
        let order = |a: &&PairBox, b: &&PairBox| value(a).total_cmp(&value(b)).then(b.number.cmp(&a.number));
        let open = self.open.iter().max_by(order).map(|one| (one.middle, one.bounds));
        let is_best = |(value, _): &(f32, Box3)| self.small_best.is_none_or(|(small, _)| *value > small);
        let Some((_, bounds)) = open.filter(is_best).or(self.small_best) else {
            return Ok(PairFound::Nothing);
        };
        let (_, best) = self.climb(bounds.center(), &bounds)?;
        Ok(PairFound::Left(LeftBoxes { longest, are_small, best }))
    }

    fn urgency(&self, bounds: &Box3, middle: f32) -> [f32; 2] {
        let side = bounds.longest_side();
        if self.is_greedy { [middle, -side] } else { [side, middle] }
    }

    fn push(&mut self, bounds: Box3, regions: [Region; 2], middle: f32) {
        self.count += 1;
        let urgency = self.urgency(&bounds, middle);
        watch::take_for_heap(&self.open);
        self.open.push(PairBox { bounds, regions, middle, urgency, number: self.count });
    }

    /// A box stays as it is.
    fn keep(&mut self, bounds: Box3, middle: f32) {
        self.small = self.small.max(bounds.longest_side());
        if self.small_best.is_none_or(|(value, _)| middle > value) {
            self.small_best = Some((middle, bounds));
        }
    }

    /// Opens the parts of a box that may have points of both; a box that is inside of both ends the search.
    fn expand(&mut self, parent: &PairBox, parts: &[Box3]) -> Result<Option<Box3>, EvalError> {
        let rows: usize = parent.regions.iter().map(Region::rows).sum();
        self.work += CUT_WORK + rows as u64;
        let around: Vec<Box3> = parts.iter().map(|part| grown(part, self.tolerance)).collect();
        let mut is_open = vec![true; parts.len()];
        for (solid, region) in self.solids.iter().zip(&parent.regions) {
            for (open, range) in is_open.iter_mut().zip(ranges(solid, region, &around)?) {
                *open &= solid.side(range) != Some(false);
            }
        }
        let parts: Vec<Box3> = pick(parts, &is_open);
        if parts.is_empty() {
            return Ok(None);
        }
        let inside = self.is_inside([&parent.regions[0], &parent.regions[1]], &parts)?;
        if let Some(place) = inside.iter().position(|inside| *inside) {
            return Ok(Some(parts[place]));
        }
        let middles: Vec<[f32; 3]> = parts.iter().map(Box3::center).collect();
        let values = self.values([&parent.regions[0], &parent.regions[1]], &middles)?;
        for ((part, &value), &middle) in parts.iter().zip(&values).zip(&middles) {
            if value > self.best
                && let Some(both) = self.follow(middle, part)?
            {
                return Ok(Some(both));
            }
        }
        let is_large: Vec<bool> = parts.iter().map(|part| part.longest_side() > self.tolerance).collect();
        for ((&part, &value), _) in parts.iter().zip(&values).zip(&is_large).filter(|(_, large)| !**large) {
            self.keep(part, value);
        }
        let (parts, values) = (pick(&parts, &is_large), pick(&values, &is_large));
        let around: Vec<Box3> = parts.iter().map(|part| grown(part, self.tolerance)).collect();
        let [mut first, mut second] = [Vec::new(), Vec::new()];
        self.solids[0].pruner.narrow(&parent.regions[0], &around, &mut first)?;
        self.solids[1].pruner.narrow(&parent.regions[1], &around, &mut second)?;
        for ((part, value), regions) in parts.into_iter().zip(values).zip(first.into_iter().zip(second)) {
            self.push(part, regions.into(), value);
        }
        Ok(None)
    }

    /// Climbs from the best point so far, the middle of a box. The answer is a cube inside of both about
    /// where that leads, if one is known.
    fn follow(&mut self, middle: [f32; 3], bounds: &Box3) -> Result<Option<Box3>, EvalError> {
        let (value, point) = self.climb(middle, bounds)?;
        self.best = value;
        if value < 0.0 || value <= self.failed {
            return Ok(None);
        }
        let cube = self.cube(point)?;
        if cube.is_none() {
            self.failed = value;
        }
        Ok(cube)
    }

    /// Steps from a point of a box to where the smaller field is larger, in the box and as far again around
    /// it.
    fn climb(&mut self, start: [f32; 3], bounds: &Box3) -> Result<BothPoint, EvalError> {
        let mut step = 0.5 * bounds.longest_side();
        let around = grown(bounds, 2.0 * step);
        let [a, b] = self.solids.map(|solid| solid.pruner.region(around));
        let regions = [&a?, &b?];
        let mut best: BothPoint = (self.values(regions, &[start])?[0], start);
        for _ in 0..MAX_CLIMB {
            let to = |offset: [f32; 3]| {
                [0, 1, 2].map(|axis| {
                    (best.1[axis] + step * offset[axis]).clamp(around.low[axis], around.high[axis])
                })
            };
            let points: Vec<[f32; 3]> = OFFSETS.map(to).to_vec();
            let values = self.values(regions, &points)?;
            let from = best;
            for (value, point) in values.into_iter().zip(points) {
                if value > best.0 {
                    best = (value, point);
                }
            }
            if best == from {
                step *= 0.5;
            }
        }
        Ok(best)
    }

    /// The largest cube about a point that is proven to be inside of both, of some.
    fn cube(&self, point: [f32; 3]) -> Result<Option<Box3>, EvalError> {
        let side = self.whole.longest_side();
        let about = |halvings: i32| {
            let half = side * 0.5f32.powi(halvings);
            Box3::new(point.map(|x| x - half), point.map(|x| x + half))
        };
        let [a, b] = self.solids.map(|solid| solid.pruner.region(about(1)));
        let regions = [&a?, &b?];
        let cubes: Vec<Box3> = (1..=MAX_HALVINGS).map(about).filter(Box3::is_full).collect();
        for some in cubes.chunks(MAX_PARTS) {
            let inside = self.is_inside(regions, some)?;
            if let Some(place) = inside.into_iter().position(|inside| inside) {
                return Ok(Some(some[place]));
            }
        }
        Ok(None)
    }

    /// Whether each of up to [`MAX_PARTS`] boxes of two regions is proven to be inside of both.
    fn is_inside(&self, regions: [&Region; 2], boxes: &[Box3]) -> Result<Vec<bool>, EvalError> {
        let mut is_inside = vec![true; boxes.len()];
        for (solid, region) in self.solids.iter().zip(regions) {
            for (inside, range) in is_inside.iter_mut().zip(ranges(solid, region, boxes)?) {
                *inside &= solid.side(range) == Some(true);
            }
        }
        Ok(is_inside)
    }

    /// The smaller of both fields at points of two regions, less the iso-value.
    fn values(&mut self, regions: [&Region; 2], points: &[[f32; 3]]) -> Result<Vec<f32>, EvalError> {
        self.batch.clear();
        points.iter().for_each(|&point| self.batch.push(point));
        let mut least = vec![f32::INFINITY; points.len()];
        for (solid, region) in self.solids.iter().zip(regions) {
            let field = self.batch.values(solid, region)?;
            for (least, field) in least.iter_mut().zip(field) {
                let above = field - solid.iso;
                *least = if above.is_nan() { f32::NEG_INFINITY } else { least.min(above) };
            }
        }
        Ok(least)
    }
}

/// The steps of a climb, of length 1 along each axis.
const OFFSETS: [[f32; 3]; 14] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [1.0, -1.0, 1.0],
    [-1.0, -1.0, 1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [1.0, -1.0, -1.0],
    [-1.0, -1.0, -1.0],
];

/// The elements that are marked.
fn pick<T: Copy>(all: &[T], is_picked: &[bool]) -> Vec<T> {
    all.iter().zip(is_picked).filter(|(_, picked)| **picked).map(|(one, _)| *one).collect()
}

/// A box with so much around it, rounded outwards.
pub(super) fn grown(bounds: &Box3, margin: f32) -> Box3 {
    Box3 {
        low: bounds.low.map(|side| (side - margin).next_down().max(f32::MIN)),
        high: bounds.high.map(|side| (side + margin).next_up().min(f32::MAX)),
    }
}
