//! Field, attributes and gradient agree with the oracle at points all over the model: the gradient with its
//! central differences.
//!
//! * The field and the attributes are those of `walk`, within what f32 makes of coordinates where the field
//!   is steep.
//! * The gradient is off by less than 1e-3 of its length at 99.9 % of the points.
//! * Nowhere does it have a wrong sign: where it is not small against the largest gradient of the model, it
//!   points to the same side as the difference (their product is positive), and every component that is not
//!   small against the others has the sign of the difference.
//!
//! Where the field jumps, the one on either side is right.
//!
//! Points near a decision (a tie, a rim: `walk` says how near) are left out, since a difference would look at
//! both sides of it.

use fastrand::Rng;
use jbt::{CheckedTree, Engine, Points, Samples};
use jbt_model::walk::{Sample, walk, walk_gradient};
use jbt_testkit::skip::short_or_long;
use jbt_testkit::vector::length;

use super::Verdict;
use crate::points;
use crate::subject::Subject;

/// Of a check in short, and of one at length.
const POINTS: [usize; 2] = [2_500, 10_000];
/// The step of differences: in f64 both the error of the formula (the square of it) and that of rounding
/// (2^-53 over it) are below 1e-9.
const STEP: f64 = 1e-5;
/// How near to a decision is too near, where the field changes by 1 for each unit of length.
const DECISION: f64 = 10.0 * STEP;
/// What f32 may do to the field and to attributes, at such points.
const FIELD: f64 = 1e-5;
const ATTRIBUTE: f64 = 1e-3;
/// Attributes of a field below this are quotients of small numbers.
const FAINT: f64 = 1e-3;
/// What a gradient may be off by, relatively, and how many may be off by more: one of a thousand.
const GRADIENT: f64 = 1e-3;
const EXCEPTIONS: usize = 1000;
/// What is small: a gradient against the largest one of the model, where errors count as those of one so
/// large; where its direction does not count; a component against its gradient.
const TINY: f64 = 1e-4;
const FLAT: f64 = 1e-3;
const SMALL: f64 = 1e-2;

/// A gradient, and the difference that it should be.
struct Slope {
    at: [f64; 3],
    got: [f64; 3],
    expected: [f64; 3],
}

pub fn check(subject: &Subject) -> Verdict {
    let count = short_or_long(POINTS);
    let points = points::anywhere(&mut Rng::with_seed(4), &subject.bounds, count);
    let samples = subject.answers(Engine::Lanes, &points);
    let mut slopes = Vec::new();
    for index in 0..points.len() {
        slopes.extend(compare(subject, &points, &samples, index)?);
    }
    let steep = slopes.iter().filter(|slope| length(slope.expected) > 0.0).count();
    if 2 * slopes.len() < count || 100 * steep < count {
        let all = slopes.len();
        return Err(format!("of {count} points {all} are away from decisions, {steep} of them on a slope"));
    }
    judge(&slopes)
}

/// Compares field and attributes at a point; the gradient, if nothing is decided near the point.
fn compare(
    subject: &Subject,
    points: &Points,
    samples: &Samples,
    index: usize,
) -> Result<Option<Slope>, String> {
    let at = points.get(index).map(f64::from);
    let plain = walk(&subject.tree, at);
    let got = samples.gradient().expect("it was asked for").map(|plane| f64::from(plane[index]));
    let expected = walk_gradient(&subject.tree, at, STEP);
    let steep = length(expected).max(1.0);
    let field = f64::from(samples.field()[index]);
    let decided = plain.kink_distance < DECISION * steep;
    let near = (field - plain.field).abs() <= FIELD * steep;
    if !(near || decided && is_beside(&subject.tree, at, field)) {
        return Err(format!("the field at {at:?}: expected {:?}, got {field:?}", plain.field));
    }
    if decided {
        return Ok(None);
    }
    if plain.field.abs() > FAINT {
        compare_attributes(samples, &plain, index, ATTRIBUTE * steep)
            .map_err(|wrong| format!("{wrong} at {at:?}"))?;
    }
    Ok(Some(Slope { at, got, expected }))
}

/// Whether this is the field on some side of a jump at a point: a falloff with an exact edge jumps at the
/// rim.
fn is_beside(tree: &CheckedTree, at: [f64; 3], field: f64) -> bool {
    let beside = |axis: usize, offset: f64| {
        let mut p = at;
        p[axis] += offset;
        (field - walk(tree, p).field).abs() <= FIELD
    };
    (0..3).any(|axis| beside(axis, STEP) || beside(axis, -STEP))
}

fn compare_attributes(samples: &Samples, plain: &Sample, index: usize, within: f64) -> Verdict {
    for ((name, first, width), expected) in samples.layout().attributes().zip(&plain.attributes) {
        for (plane, expected) in samples.planes()[first..first + width].iter().zip(expected) {
            let got = f64::from(plane[index]);
            if (got - expected).abs() > within {
                return Err(format!("{name}: expected {expected:?}, got {got:?}"));
            }
        }
    }
    Ok(())
}

fn judge(slopes: &[Slope]) -> Verdict {
    let largest = slopes.iter().map(|slope| length(slope.expected)).fold(0.0, f64::max);
    let error = |slope: &Slope| {
        let off = [0, 1, 2].map(|axis| slope.got[axis] - slope.expected[axis]);
        length(off) / length(slope.expected).max(TINY * largest)
    };
    if let Some(slope) = slopes.iter().find(|slope| length(slope.expected) > FLAT * largest && turned(slope))
    {
        return Err(format!("the gradient has a wrong sign {}", shown(slope)));
    }
    let off = |slope: &&Slope| {
        let error = error(slope);
        error > GRADIENT || error.is_nan()
    };
    let off: Vec<&Slope> = slopes.iter().filter(off).collect();
    if off.len() * EXCEPTIONS <= slopes.len() {
        return Ok(());
    }
    let worst = off.iter().max_by(|a, b| error(a).total_cmp(&error(b))).expect("there are some");
    let (count, all) = (off.len(), slopes.len());
    Err(format!("{count} of {all} gradients are off by more than {GRADIENT}, the worst {}", shown(worst)))
}

/// Whether a gradient has a wrong sign.
fn turned(slope: &Slope) -> bool {
    let Slope { got, expected, .. } = slope;
    let product: f64 = (0..3).map(|axis| got[axis] * expected[axis]).sum();
    let large = SMALL * length(*expected);
    let opposite = |axis: usize| expected[axis].abs() > large && got[axis] * expected[axis] <= 0.0;
    product <= 0.0 || product.is_nan() || (0..3).any(opposite)
}

fn shown(slope: &Slope) -> String {
    format!("at {:?}: expected {:?}, got {:?}", slope.at, slope.expected, slope.got)
}

/// What the judgement is worth.
mod tests {
    use jbt::build::point;
    use jbt::{Falloff, Model};
    use jbt_model::falloff::{Blinn, Edge};

    use super::*;

    /// A thousand good gradients and those that are given.
    fn judged(others: &[([f64; 3], [f64; 3])]) -> Verdict {
        let good = ([3.0, 4.0, 0.0], [3.0, 4.0, 0.0]);
        let slopes = std::iter::repeat_n(&good, 1000).chain(others);
        judge(&slopes.map(|&(expected, got)| Slope { at: [0.0; 3], got, expected }).collect::<Vec<_>>())
    }

    #[test]
    fn one_in_a_thousand_may_be_off() {
        let off = ([3.0, 4.0, 0.0], [3.0, 4.01, 0.0]);
        assert_eq!(judged(&[off]), Ok(()));
        assert!(judged(&[off, off]).is_err());
        assert!(judged(&[([3.0, 4.0, 0.0], [3.0, 4.001, 0.0]); 50]).is_ok(), "within a thousandth");
        assert!(judged(&[([3.0, 4.0, 0.0], [f64::NAN; 3])]).is_err());
    }

    #[test]
    fn at_a_jump_either_side_is_right() {
        let edge = Falloff::Blinn(Blinn { hardness: 0.001, cutoff: 0.01, edge: Edge::Exact });
        let tree = Model::new(point([0.0; 3], 1.0).falloff(edge)).check().expect("a good model");
        for (field, right) in [(0.0, true), (1.0, true), (0.5, false)] {
            assert_eq!(is_beside(&tree, [1.0, 0.0, 0.0], field), right, "{field}");
        }
    }

    #[test]
    fn none_may_have_a_wrong_sign() {
        for got in [[-3.0, -4.0, 0.0], [3.0, -4.0, 0.0], [0.0; 3]] {
            assert!(judged(&[([3.0, 4.0, 0.0], got)]).is_err(), "{got:?}");
        }
        // A component that is small against the others says nothing, nor does a gradient that is small
        // against those elsewhere.
        assert_eq!(judged(&[([3.0, 4.0, 0.001], [3.0, 4.0, -0.001])]), Ok(()));
        assert_eq!(judged(&[([1e-8, 0.0, 0.0], [-1e-8, 0.0, 0.0])]), Ok(()));
    }
}
