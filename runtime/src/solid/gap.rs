//! The distance between two solids: a tree of boxes about each, and pairs of boxes that may hold nearest
//! points, the nearest pair first.
//!
//! ```text
//! low    no point of one is nearer to one of the other: the least distance of all pairs that are left
//! high   two points are so far apart: a point of each, at which the kernels say that it is inside
//!
//! pop the nearest pair; cut the longer box of it, unless that has been cut; push the pairs with its parts
//! ```
//!
//! A box is cut once, however many pairs it is in. So solids of thousands of parts that are equally near to
//! each other take that many cuts, and not that of their pairs. A pair is a few bytes, a box that is not cut
//! yet keeps the rows that run in it. When the budget is used up, the bracket is that of the pairs so far.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::Range;

use jbt_ir::limits::{MAX_GAP_BYTES, MAX_GAP_PAIRS, MAX_GAP_WORK};
use jbt_ir::watch;

use super::{Solid, SolidBatch};
use crate::boxes::{self, Box3, Divisible as _};
use crate::error::EvalError;
use crate::ordered::ordered;
use crate::prune::Region;

/// What a cut takes besides the rows that run in its box, in rows.
const CUT_WORK: u64 = 1 << 10;

/// Cuts of one solid in search of a point inside. Thin ones have few.
const MAX_FIRST_CUTS: usize = 1 << 12;

/// A distance between bounds, in units of the model.
#[derive(Clone, Copy, PartialEq, Debug)]
#[non_exhaustive]
pub struct Gap {
    /// Proven: it is at least this much.
    pub low: f64,
    /// It is at most this much.
    pub high: f64,
    /// A point of each that are that far apart, in the world.
    pub points: [[f64; 3]; 2],
}

/// What the search for a distance may take.
#[derive(Clone, Copy)]
struct GapBudget {
    /// Pairs of boxes.
    pairs: u32,
    /// Rows that run in boxes which are cut, those of both solids.
    work: u64,
    /// Bytes that the boxes of both keep.
    bytes: usize,
}

impl GapBudget {
    const WHOLE: Self = Self { pairs: MAX_GAP_PAIRS, work: MAX_GAP_WORK, bytes: MAX_GAP_BYTES };

    /// Whether nothing may be cut any more.
    fn is_spent(&self, trees: &[GapTree<'_>; 2]) -> bool {
        let [a, b] = trees;
        a.work + b.work >= self.work || a.bytes + b.bytes >= self.bytes
    }
}

/// A box that may hold points of a solid.
struct GapBox {
    bounds: Box3,
    /// The highest field there.
    highest: f32,
    /// A point of the solid that is near it, if one is known.
    inside: Option<[f32; 3]>,
    parts: GapParts,
}

/// What a box has been cut into.
enum GapParts {
    /// Nothing yet.
    Uncut(Region),
    /// Boxes, by their numbers; none if no point of the solid is there.
    Cut(Range<u32>),
    /// There are no numbers between its sides.
    Smallest,
}

/// The boxes about one solid, the whole one first.
struct GapTree<'a> {
    solid: &'a Solid,
    boxes: Vec<GapBox>,
    /// What cuts have taken, in rows.
    work: u64,
    /// What is kept, in bytes, as if no two boxes shared rows.
    bytes: usize,
}

impl<'a> GapTree<'a> {
    fn new(solid: &'a Solid, bounds: Box3) -> Result<Self, EvalError> {
        let mut tree = Self { solid, boxes: Vec::new(), work: 0, bytes: 0 };
        tree.push(bounds, f32::INFINITY, None, solid.pruner.region(bounds)?);
        Ok(tree)
    }

    fn push(&mut self, bounds: Box3, highest: f32, inside: Option<[f32; 3]>, region: Region) {
        self.bytes += size_of::<GapBox>() + region.bytes();
        watch::take_for(&self.boxes, 1);
        self.boxes.push(GapBox { bounds, highest, inside, parts: GapParts::Uncut(region) });
    }

    /// The parts of a box that may hold points of the solid; nothing if it cannot be cut.
    fn parts(&mut self, number: u32) -> Result<Option<Range<u32>>, EvalError> {
        let place = number as usize;
        let region = match std::mem::replace(&mut self.boxes[place].parts, GapParts::Smallest) {
            GapParts::Uncut(region) => region,
            GapParts::Cut(parts) => {
                self.boxes[place].parts = GapParts::Cut(parts.clone());
                return Ok(Some(parts));
            }
            GapParts::Smallest => return Ok(None),
        };
        self.bytes -= region.bytes();
        let bounds = self.boxes[place].bounds;
        let parts = bounds.halved();
        if parts == [bounds] {
            return Ok(None);
        }
        self.work += CUT_WORK + region.rows() as u64;
        let first = self.boxes.len() as u32;
        self.add(&region, &parts, self.boxes[place].inside)?;
        let made = first..self.boxes.len() as u32;
        self.boxes[place].parts = GapParts::Cut(made.clone());
        Ok(Some(made))
    }

    /// Adds those parts of a region that may hold points of the solid.
    fn add(&mut self, region: &Region, parts: &[Box3], near: Option<[f32; 3]>) -> Result<(), EvalError> {
        let solid = self.solid;
        let (mut left, mut regions) = (Vec::new(), Vec::new());
        let mut wants = |part: usize, range: boxes::Range| {
            let may_hold = solid.side(range) != Some(false);
            left.extend(may_hold.then_some((parts[part], range[1])));
            may_hold
        };
        solid.pruner.split(region, parts, &mut wants, &mut regions)?;
        if left.is_empty() {
            return Ok(());
        }
        let mut batch = SolidBatch::default();
        left.iter().for_each(|(part, _)| batch.push(part.center()));
        let sides = batch.sides(solid, region)?;
        for (((bounds, highest), region), is_inside) in left.into_iter().zip(regions).zip(sides) {
            let inside = if is_inside { Some(bounds.center()) } else { near };
            self.push(bounds, highest, inside, region);
        }
        Ok(())
    }

    /// Looks for a point of the solid, where its field may be highest; the whole box knows it then. Says
    /// whether there may be one. It takes half of what both may keep.
    fn find(&mut self, budget: GapBudget) -> Result<bool, EvalError> {
        let mut open = BinaryHeap::from([HighBox { highest: f32::INFINITY, number: 0 }]);
        for _ in 0..MAX_FIRST_CUTS {
            if self.work >= budget.work || self.bytes >= budget.bytes / 2 {
                break;
            }
            let Some(HighBox { number, .. }) = open.pop() else { return Ok(false) };
            for part in self.parts(number)?.unwrap_or_default() {
                let GapBox { highest, inside, .. } = self.boxes[part as usize];
                if inside.is_some() {
                    self.boxes[0].inside = inside;
                    return Ok(true);
                }
                open.push(HighBox { highest, number: part });
            }
        }
        Ok(true)
    }
}

/// A box by its field.
struct HighBox {
    highest: f32,
    number: u32,
}

impl Ord for HighBox {
    /// The highest is the greatest; of equals the one that was found last, which is the smallest.
    fn cmp(&self, other: &Self) -> Ordering {
        self.highest.total_cmp(&other.highest).then(self.number.cmp(&other.number))
    }
}

/// Two boxes, of both solids.
struct GapPair {
    low: f64,
    number: u32,
    boxes: [u32; 2],
}

impl Ord for GapPair {
    /// The nearest is the greatest; of equals the one that was found first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.low.total_cmp(&self.low).then(other.number.cmp(&self.number))
    }
}

ordered! { HighBox GapPair }

/// Two points inside, and how far apart they are.
type Witness = (f64, [[f32; 3]; 2]);

/// The distance between two solids in boxes around them; `None` if no point of one of them is found. Points
/// count from the origin of the model.
pub(super) fn gap(solids: [&Solid; 2], around: [Box3; 2], tolerance: f32) -> Result<Option<Gap>, EvalError> {
    gap_within(GapBudget::WHOLE, solids, around, tolerance)
}

fn gap_within(
    budget: GapBudget,
    solids: [&Solid; 2],
    around: [Box3; 2],
    tolerance: f32,
) -> Result<Option<Gap>, EvalError> {
    let mut trees = [GapTree::new(solids[0], around[0])?, GapTree::new(solids[1], around[1])?];
    for tree in &mut trees {
        if !tree.find(budget)? {
            return Ok(None);
        }
    }
    let mut best: Option<Witness> = None;
    let low = search(budget, &mut trees, f64::from(tolerance), &mut best)?;
    Ok(best.map(|(high, points)| Gap {
        low: low.min(high),
        high,
        points: points.map(|point| point.map(f64::from)),
    }))
}

/// A bound of the distance from below; `best` are the nearest points that were met.
fn search(
    budget: GapBudget,
    trees: &mut [GapTree<'_>; 2],
    tolerance: f64,
    best: &mut Option<Witness>,
) -> Result<f64, EvalError> {
    let mut open = BinaryHeap::new();
    let mut count = 0;
    let mut meet = |trees: &[GapTree<'_>; 2], boxes: [u32; 2], open: &mut BinaryHeap<GapPair>| {
        let [a, b] = [0, 1].map(|side| &trees[side].boxes[boxes[side] as usize]);
        if let (Some(a), Some(b)) = (a.inside, b.inside) {
            let apart = between(a, b);
            if best.is_none_or(|(high, _)| apart < high) {
                *best = Some((apart, [a, b]));
            }
        }
        let high = best.map_or(f64::INFINITY, |(high, _)| high);
        let low = least(&a.bounds, &b.bounds);
        if low < high {
            count += 1;
            watch::take_for_heap(open);
            open.push(GapPair { low, number: count, boxes });
        }
        (high, count)
    };
    let (mut high, mut pairs) = meet(trees, [0, 0], &mut open);
    while let Some(GapPair { low, boxes, .. }) = open.pop() {
        watch::go_on()?;
        if high - low <= tolerance || pairs >= budget.pairs || budget.is_spent(trees) {
            return Ok(low);
        }
        let side = |side: usize| trees[side].boxes[boxes[side] as usize].bounds.longest_side();
        let longer = usize::from(side(1) > side(0));
        let Some(parts) = trees[longer].parts(boxes[longer])? else { return Ok(low) };
        for part in parts {
            let mut boxes = boxes;
            boxes[longer] = part;
            (high, pairs) = meet(trees, boxes, &mut open);
        }
    }
    // No pair is left that is nearer than the best one.
    Ok(f64::INFINITY)
}

/// The distance of two points.
fn between(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3).map(|axis| (f64::from(a[axis]) - f64::from(b[axis])).powi(2)).sum::<f64>().sqrt()
}

/// The distance of the nearest points of two boxes.
fn least(a: &Box3, b: &Box3) -> f64 {
    let apart = |axis: usize| {
        let gap = |from: f32, to: f32| f64::from(to) - f64::from(from);
        gap(a.high[axis], b.low[axis]).max(gap(b.high[axis], a.low[axis])).max(0.0)
    };
    (0..3).map(|axis| apart(axis).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Compiler;

    /// Whatever is used up first, the bracket holds; with less of it, it is no narrower.
    #[test]
    fn budgets_that_end_leave_brackets_that_hold() {
        let wall = |x: f64| {
            let text = format!("jbt 1 box {{ center ({x} 0 0) half (1 4 4) surface_radius 0.1 }}");
            let tree = jbt_text::model(&text).unwrap().check().unwrap();
            Solid::new(&Compiler::new(), &tree).unwrap()
        };
        let solids = [wall(0.0), wall(4.0)];
        let around = [0.0, 4.0].map(|x| Box3 { low: [x - 2.0, -5.0, -5.0], high: [x + 2.0, 5.0, 5.0] });
        let expected = 4.0 - 2.0 - 0.2;
        let width = |budget: GapBudget| {
            let gap = gap_within(budget, [&solids[0], &solids[1]], around, 1e-3).unwrap().unwrap();
            assert!(gap.low <= expected + 1e-6 && expected <= gap.high + 1e-6, "{gap:?}");
            gap.high - gap.low
        };
        let whole = width(GapBudget { pairs: 1 << 14, ..GapBudget::WHOLE });
        let by_pairs = [1, 6, 12].map(|bits| width(GapBudget { pairs: 1 << bits, ..GapBudget::WHOLE }));
        let by_bytes = [13, 15, 18]
            .map(|bits| width(GapBudget { pairs: 1 << 14, bytes: 1 << bits, ..GapBudget::WHOLE }));
        let by_work =
            [11, 14, 17].map(|bits| width(GapBudget { pairs: 1 << 14, work: 1 << bits, ..GapBudget::WHOLE }));
        for widths in [by_pairs, by_bytes, by_work] {
            assert!(
                widths[0] >= widths[1] && widths[1] >= widths[2] && widths[2] >= whole,
                "{widths:?} {whole}"
            );
            assert!(widths[0] > whole, "{widths:?} {whole}");
        }
    }

    /// What a tree says that it keeps is what its boxes keep.
    #[test]
    fn bytes_are_those_of_uncut_boxes() {
        let text = "jbt 1 union { point { radius 1 } point { at (3 0 0) radius 1 } }";
        let tree = jbt_text::model(text).unwrap().check().unwrap();
        let solid = Solid::new(&Compiler::new(), &tree).unwrap();
        let mut tree = GapTree::new(&solid, Box3 { low: [-2.0; 3], high: [5.0; 3] }).unwrap();
        for number in 0..40 {
            if (number as usize) < tree.boxes.len() {
                tree.parts(number).unwrap();
            }
            let kept = |one: &GapBox| match &one.parts {
                GapParts::Uncut(region) => region.bytes(),
                GapParts::Cut(_) | GapParts::Smallest => 0,
            };
            let kept: usize = tree.boxes.iter().map(kept).sum();
            assert_eq!(tree.bytes, kept + tree.boxes.len() * size_of::<GapBox>());
        }
        assert!(tree.boxes.len() > 20, "{}", tree.boxes.len());
    }
}
