//! Outside of the support every engine's field is +0.0, to the bit.
//!
//! The support is a box in f64; the program knows it to within its rounding, which the box is inflated by
//! here.

use fastrand::Rng;
use jbt::Points;

use super::Verdict;
use crate::common::answers;
use crate::subject::Subject;

const POINTS: usize = 1000;
/// How far outside a point has to be, as a part of the largest coordinate of the support and of its longest
/// side together.
const ROUNDING: f64 = 1e-5;
/// How far outside points are, at most, as a multiple of the same.
const FAR: f64 = 1e12;

pub fn check(subject: &Subject) -> Verdict {
    let support = subject.tree.support();
    if subject.row.unbounded.is_some() && support.is_finite() {
        return Err(format!("the row says that the support has no end, but it is {support:?}"));
    }
    let [low, high] = [support.low(), support.high()];
    let sides = (0..3).flat_map(|axis| [(axis, low[axis], -1.0), (axis, high[axis], 1.0)]);
    let sides: Vec<(usize, f64, f64)> = sides.filter(|(_, side, _)| side.is_finite()).collect();
    if sides.is_empty() {
        return Ok(());
    }
    let largest = sides.iter().fold(0.0, |largest: f64, side| largest.max(side.1.abs()));
    let unit = largest + f64::from(subject.bounds.longest_side());
    let rng = &mut Rng::with_seed(2);
    let points: Points = (0..POINTS).map(|index| outside(rng, sides[index % sides.len()], unit)).collect();
    for evaluator in subject.field.iter().chain(&subject.all) {
        let samples = answers(evaluator, &points);
        if let Some(index) = samples.field().iter().position(|field| field.to_bits() != 0) {
            let (engine, field) = (evaluator.engine().name(), samples.field()[index]);
            return Err(format!(
                "the field by {engine} at {:?}: expected 0, got {field:e}",
                points.get(index)
            ));
        }
    }
    Ok(())
}

/// A point beyond a side; where it is along the others does not matter.
fn outside(rng: &mut Rng, (axis, side, direction): (usize, f64, f64), unit: f64) -> [f32; 3] {
    let far = ROUNDING * (FAR / ROUNDING).powf(rng.f64().powi(2));
    let reach = if rng.bool() { unit } else { far * unit };
    let mut point: [f64; 3] = std::array::from_fn(|_| (2.0 * rng.f64() - 1.0) * reach);
    point[axis] = side + direction * far * unit;
    point.map(|x| x as f32)
}
