//! The distance between two solids: pairs of boxes that may hold nearest points, the nearest pair first.
//!
//! ```text
//! low    no point of one is nearer to one of the other: the least distance of all pairs that are left
//! high   two points are so far apart: a point of each, at which the kernels say that it is inside
//! ```

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::halves::{halves, ranges};
use super::{Solid, SolidBatch, center, cut};
use crate::boxes::{Box3, Divisible as _};
use crate::error::EvalError;
use crate::prune::Region;

/// Pairs that are opened at most.
const MAX_PAIRS: usize = 1 << 17;

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

/// A box that may hold points of a solid, and a point of the solid that is near it, if one is known.
#[derive(Clone)]
struct GapBox {
    bounds: Box3,
    region: std::sync::Arc<Region>,
    inside: Option<[f32; 3]>,
}

/// Two boxes, of both solids.
struct GapPair {
    low: f64,
    number: usize,
    boxes: [GapBox; 2],
}

impl Ord for GapPair {
    /// The nearest is the greatest; of equals the one that was found first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.low.total_cmp(&self.low).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for GapPair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for GapPair {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for GapPair {}

/// The distance between two solids in boxes around them; `None` if no point of one of them is found. Points
/// count from the origin of the model.
pub(super) fn gap(solids: [&Solid; 2], around: [Box3; 2], tolerance: f32) -> Result<Option<Gap>, EvalError> {
    let whole = |place: usize| -> Result<GapBox, EvalError> {
        let (bounds, solid): (Box3, &Solid) = (around[place], solids[place]);
        Ok(GapBox { bounds, region: solid.pruner.region(bounds)?.into(), inside: None })
    };
    let mut open = BinaryHeap::from([GapPair { low: 0.0, number: 0, boxes: [whole(0)?, whole(1)?] }]);
    let mut best: Option<(f64, [[f32; 3]; 2])> = None;
    let (mut number, mut low) = (0, f64::INFINITY);
    while let Some(pair) = open.pop() {
        let high = best.map_or(f64::INFINITY, |(high, _)| high);
        low = pair.low.min(high);
        if high - low <= f64::from(tolerance) || number >= MAX_PAIRS {
            break;
        }
        low = f64::INFINITY;
        let side = usize::from(pair.boxes[1].bounds.longest_side() > pair.boxes[0].bounds.longest_side());
        for part in parts(solids[side], &pair.boxes[side])? {
            let mut boxes = pair.boxes.clone();
            boxes[side] = part;
            if let (Some(a), Some(b)) = (boxes[0].inside, boxes[1].inside) {
                let apart = between(a, b);
                if best.is_none_or(|(high, _)| apart < high) {
                    best = Some((apart, [a, b]));
                }
            }
            let low = least(&boxes[0].bounds, &boxes[1].bounds);
            if best.is_none_or(|(high, _)| low < high) {
                number += 1;
                open.push(GapPair { low, number, boxes });
            }
        }
    }
    Ok(best.map(|(high, points)| Gap {
        low: low.min(high),
        high,
        points: points.map(|point| point.map(f64::from)),
    }))
}

/// The parts of a box that may hold points of a solid.
fn parts(solid: &Solid, whole: &GapBox) -> Result<Vec<GapBox>, EvalError> {
    let parts = cut(&whole.bounds, halves(&whole.bounds));
    let left: Vec<Box3> = parts
        .iter()
        .zip(ranges(solid, &whole.region, &parts)?)
        .filter(|(_, range)| solid.side(*range) != Some(false))
        .map(|(part, _)| *part)
        .collect();
    if left.is_empty() {
        return Ok(Vec::new());
    }
    let mut regions = Vec::new();
    solid.pruner.narrow(&whole.region, &left, &mut regions)?;
    let mut batch = SolidBatch::default();
    left.iter().for_each(|part| batch.push(center(part)));
    let sides = batch.sides(solid, &whole.region)?;
    let part = |((&bounds, region), inside): ((&Box3, Region), bool)| {
        let inside = if inside { Some(center(&bounds)) } else { whole.inside };
        GapBox { bounds, region: region.into(), inside }
    };
    Ok(left.iter().zip(regions).zip(sides).map(part).collect())
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
