//! The checks that answers have to pass before anything is timed.

use jbt::{Evaluator, Points};
use jbt_frontend::check::CheckedTree;
use jbt_frontend::walk::walk;

/// Compares the field with the f64 oracle at some of the points. Panics where it is off.
pub fn field(tree: &CheckedTree, evaluator: &Evaluator, points: &Points) {
    let mut samples = evaluator.samples();
    evaluator.eval(points, &mut samples).expect("the buffers fit");
    for index in (0..points.len()).step_by(points.len().div_ceil(200)) {
        let expected = walk(tree, points.get(index).map(f64::from)).field;
        let value = f64::from(samples.field()[index]);
        assert!((value - expected).abs() < 1e-4, "point {index}: {value}, the oracle has {expected}");
    }
}
