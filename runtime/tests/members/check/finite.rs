//! Field, gradient and attributes are finite wherever coordinates are: far away, where squares overflow, at
//! subnormal numbers, at zeros of both signs, on skeletons. Engines agree on a NaN, so nothing else would see
//! one. Outside of the support the field is +0 there, too.

use jbt::Points;

use super::Verdict;
use crate::common::answers;
use crate::subject::Subject;
use jbt_testkit::points::HOSTILE;

pub fn check(subject: &Subject) -> Verdict {
    let points = points(subject);
    let support = subject.tree.support();
    let [low, high] = [support.low(), support.high()];
    let unit = low.iter().chain(&high).fold(1.0, |largest: f64, side| largest.max(side.abs()));
    for evaluator in &subject.all {
        let samples = answers(evaluator, &points);
        let engine = evaluator.engine().name();
        for (name, plane) in samples.layout().names().iter().zip(samples.planes()) {
            if let Some(index) = plane.iter().position(|x| !x.is_finite()) {
                return Err(format!(
                    "{name} by {engine} at {:?}: expected a number, got {}",
                    points.get(index),
                    plane[index]
                ));
            }
        }
        for (index, field) in samples.field().iter().enumerate() {
            let point = points.get(index);
            let away = |axis: usize| {
                let x = f64::from(point[axis]);
                x < low[axis] - 0.01 * unit || x > high[axis] + 0.01 * unit
            };
            if (0..3).any(away) && field.to_bits() != 0 {
                return Err(format!("the field by {engine} at {point:?}: expected 0, got {field:e}"));
            }
        }
    }
    Ok(())
}

/// Hostile coordinates in all places of the named points, and alone.
fn points(subject: &Subject) -> Points {
    let mut all = Vec::new();
    for named in subject.named() {
        let named = named.map(|x| x as f32);
        all.push(named);
        for axis in 0..3 {
            for &x in &HOSTILE {
                let mut point = named;
                point[axis] = x;
                all.push(point);
                point[(axis + 1) % 3] = x;
                all.push(point);
            }
        }
    }
    for &x in &HOSTILE {
        for &y in &HOSTILE {
            all.extend(HOSTILE.iter().map(|&z| [x, y, z]));
        }
    }
    all.into_iter().collect()
}
