//! The checks that answers have to pass before anything is timed.

use jbt::walk::{walk, walk_gradient};
use jbt::{AnswerKind, CheckedTree, Evaluator, Points, Polygonized};

/// Compares the field with the f64 oracle at some of the points. Panics where it is off.
pub fn field(tree: &CheckedTree, evaluator: &Evaluator, points: &Points) {
    let mut samples = evaluator.samples();
    evaluator.eval(points, &mut samples).expect("the buffers fit");
    for index in some(points.len(), 200) {
        let expected = walk(tree, points.get(index).map(f64::from)).field;
        let value = f64::from(samples.field()[index]);
        assert!((value - expected).abs() < 1e-4, "point {index}: {value}, the oracle has {expected}");
    }
}

/// How near to a decision (a tie, the rim of a support) a point may be for its gradient and attributes to be
/// compared: nearer ones may have been decided otherwise, in f32 or at the ends of a difference.
const DECISION: f64 = 1e-3;

/// Compares every answer of an evaluator with the f64 oracle at some of the points. Panics where one is off,
/// or if hardly any gradients and attributes can be compared.
pub fn answers(tree: &CheckedTree, evaluator: &Evaluator, points: &Points) {
    field(tree, evaluator, points);
    let mut samples = evaluator.samples();
    evaluator.eval(points, &mut samples).expect("the buffers fit");
    let indices = || some(points.len(), 50);
    let mut compared = 0;
    for index in indices() {
        let p = points.get(index).map(f64::from);
        let expected = walk(tree, p);
        if expected.kink_distance < DECISION {
            continue;
        }
        compared += 1;
        if let Some(gradient) = samples.gradient() {
            let expected = walk_gradient(tree, p, 1e-6);
            let scale = 1.0 + expected.iter().fold(0.0, |most: f64, g| most.max(g.abs()));
            for (plane, expected) in gradient.iter().zip(expected) {
                let off = (f64::from(plane[index]) - expected).abs();
                assert!(off < 1e-3 * scale, "gradient at point {index}: {}, not {expected}", plane[index]);
            }
        }
        if !evaluator.query().contains(AnswerKind::Attributes) {
            continue;
        }
        for (group, expected) in tree.attributes().iter().zip(&expected.attributes) {
            let channels = samples.attribute(&group.name).expect("the query has attributes");
            for (plane, expected) in channels.iter().zip(expected) {
                let off = (f64::from(plane[index]) - expected).abs();
                assert!(off < 1e-3, "{} at point {index}: {}, not {expected}", group.name, plane[index]);
            }
        }
    }
    assert!(2 * compared >= indices().count(), "{compared} points are far from any decision");
}

/// Asserts that a mesh is closed, and that the f64 oracle finds its vertices on the surface. Panics where one
/// is off.
pub fn mesh(tree: &CheckedTree, made: &Polygonized) {
    assert!(made.report.closed && !made.mesh.triangles.is_empty(), "the mesh is closed");
    let positions = &made.mesh.positions;
    for index in some(positions.len(), 200) {
        let field = walk(tree, positions[index].map(f64::from)).field;
        assert!((field - tree.iso()).abs() < 1e-2, "vertex {index} has the field {field}");
    }
}

/// Indices below `length`, spread evenly: at most `count`.
fn some(length: usize, count: usize) -> impl Iterator<Item = usize> {
    (0..length).step_by(length.div_ceil(count).max(1))
}

/// A value that is not what it should be.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
#[error("answer {index} is {value}, expected {expected}")]
pub struct Disagreement {
    /// Which of the answers.
    pub index: usize,
    /// The answer.
    pub value: f32,
    /// What another engine or the oracle has there.
    pub expected: f32,
}

/// Compares answers with expected ones, within `tolerance` of `1 + |expected|`.
///
/// # Errors
/// The first answer that is off. A NaN is; so is the first one that is missing on either side.
pub fn agree(values: &[f32], expected: &[f32], tolerance: f32) -> Result<(), Disagreement> {
    for index in 0..values.len().max(expected.len()) {
        let of = |slice: &[f32]| slice.get(index).copied().unwrap_or(f32::NAN);
        let (value, expected) = (of(values), of(expected));
        let near = (value - expected).abs() <= tolerance * (1.0 + expected.abs());
        if !near {
            return Err(Disagreement { index, value, expected });
        }
    }
    Ok(())
}
