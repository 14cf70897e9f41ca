//! What the tests of this crate share: `jbt_testkit` knows no evaluators.

use jbt::{AsPoints, Evaluator, Samples};

/// The answers at points. Panics with the error, if there is one.
pub fn answers<P: AsPoints + ?Sized>(evaluator: &Evaluator, points: &P) -> Samples {
    let mut samples = evaluator.samples();
    evaluator.eval(points, &mut samples).unwrap_or_else(|error| panic!("{error}"));
    samples
}
