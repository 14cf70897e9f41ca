//! Scalar, lanes and machine code agree to the bit, for the field alone and for everything, at ordinary
//! points, at NaN, at infinities and at huge numbers; and wherever the model is, on skeletons, axes and
//! centres too, all answers are finite.

use fastrand::Rng;
use jbt::{Evaluator, Points, Samples};
use jbt_testkit::bits;

use super::Verdict;
use crate::common::answers;
use crate::points;
use crate::subject::Subject;

/// Points, hostile ones among them.
const POINTS: usize = 1000;

pub fn check(subject: &Subject) -> Verdict {
    let rng = &mut Rng::with_seed(1);
    let named: Points = subject.named().map(|point| point.map(|x| x as f32)).collect();
    agree(subject, &points::spiced(rng, &subject.bounds, POINTS))?;
    for points in [named, points::round(&subject.bounds), points::anywhere(rng, &subject.bounds, POINTS)] {
        let samples = agree(subject, &points)?;
        finite(&points, &samples)?;
    }
    Ok(())
}

/// All answers, once all engines agree on them.
fn agree(subject: &Subject, points: &Points) -> Result<Samples, String> {
    let field = same(&subject.field, points)?;
    let all = same(&subject.all, points)?;
    same_bits("the field, when it is asked alone,", points, all.field(), field.field())?;
    Ok(all)
}

/// The answers of the first evaluator, once the others agree.
fn same(evaluators: &[Evaluator], points: &Points) -> Result<Samples, String> {
    let first = answers(&evaluators[0], points);
    for evaluator in &evaluators[1..] {
        let other = answers(evaluator, points);
        for ((name, expected), got) in first.layout().names().iter().zip(first.planes()).zip(other.planes()) {
            same_bits(&format!("{name} by {}", evaluator.engine().name()), points, expected, got)?;
        }
    }
    Ok(first)
}

/// Two planes have the same bits; a NaN equals any NaN.
pub fn same_bits(what: &str, points: &Points, expected: &[f32], got: &[f32]) -> Verdict {
    let differs = |(&a, &b): (&f32, &f32)| !bits::same(a, b);
    match expected.iter().zip(got).position(differs) {
        None => Ok(()),
        Some(index) => {
            let point = points.get(index);
            Err(format!("{what} at {point:?}: expected {:e}, got {:e}", expected[index], got[index]))
        }
    }
}

fn finite(points: &Points, samples: &Samples) -> Verdict {
    for (name, plane) in samples.layout().names().iter().zip(samples.planes()) {
        if let Some(index) = plane.iter().position(|x| !x.is_finite()) {
            return Err(format!(
                "{name} at {:?}: expected a number, got {}",
                points.get(index),
                plane[index]
            ));
        }
    }
    Ok(())
}
