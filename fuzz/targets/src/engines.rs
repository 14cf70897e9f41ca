//! Every engine at every level of this CPU gives the bits of the scalar reference, for any query.
//!
//! Most of an input's time is its compilation, once for each engine and level. So one input in eight goes to
//! all levels, the others to one of each engine: as much time finds more.

use jbt::text::print;
use jbt::{
    CheckedTree, Classified as _, Compiler, Engine, ErrorKind, Evaluator, Level, Points, Query, Samples,
};
use jbt_testkit::bits::same;
use jbt_testkit::points::{HOSTILE, spicy};

use crate::model::{model, rng, small_tree};
use jbt_testkit::random::Numbers;

/// Compiles the model that bytes mean for one query, and compares answers at points.
pub(crate) fn run(bytes: &[u8]) {
    let Some(tree) = small_tree(bytes) else { return };
    let mut rng = rng(bytes);
    let query = Query::EVERY[rng.usize(0..Query::EVERY.len())];
    // Lengths of last blocks, with and without whole blocks before.
    let count = 1 + rng.usize(0..45);
    let points: Points = spicy(&mut rng, count, 1.6)
        .map(|mut point| {
            if rng_is_hostile(point) {
                point[1] = HOSTILE[(point[0].to_bits() as usize) % HOSTILE.len()];
            }
            point
        })
        .collect();
    let Some(reference) = evaluator(&Compiler::for_engine(Engine::Scalar), &tree, query) else { return };
    let expected = answers(&reference, &points);
    let levels = Level::available();
    let is_for_all = rng.u8(0..8) == 0;
    for engine in [Engine::Lanes, Engine::Jit] {
        let first = if is_for_all { 0 } else { rng.usize(0..levels.len()) };
        let end = if is_for_all { levels.len() } else { first + 1 };
        for &level in &levels[first..end] {
            let compiler = Compiler::for_engine(engine).at_level(level);
            let Some(evaluator) = evaluator(&compiler, &tree, query) else { continue };
            let what = || format!("{} at {level} for {}\n{}", engine.name(), query.name(), text(bytes));
            compare(&expected, &answers(&evaluator, &points), &points, &what);
        }
    }
}

/// One point in eight, by its own bits.
fn rng_is_hostile(point: [f32; 3]) -> bool {
    point[2].to_bits().is_multiple_of(8)
}

/// The text of the model that bytes mean.
pub(crate) fn text(bytes: &[u8]) -> String {
    model(bytes, Numbers::Ordinary).as_ref().map(print).unwrap_or_default()
}

/// None if the model is beyond a limit; every other error is a defect.
pub(crate) fn evaluator(compiler: &Compiler, tree: &CheckedTree, query: Query) -> Option<Evaluator> {
    match compiler.evaluator(tree, query) {
        Ok(evaluator) => Some(evaluator),
        Err(error) if matches!(error.kind(), ErrorKind::Limit | ErrorKind::System) => None,
        Err(error) => panic!("a checked model compiles: {error}"),
    }
}

/// The answers at points.
pub(crate) fn answers(evaluator: &Evaluator, points: &Points) -> Samples {
    let mut samples = evaluator.samples();
    evaluator.eval(points, &mut samples).unwrap_or_else(|error| panic!("{error}"));
    samples
}

/// Panics unless all answers are the same.
pub(crate) fn compare(expected: &Samples, given: &Samples, points: &Points, what: &dyn Fn() -> String) {
    let planes = expected.planes().iter().zip(given.planes());
    for (name, (expected, given)) in expected.layout().names().iter().zip(planes) {
        for (index, (&old, &new)) in expected.iter().zip(given.iter()).enumerate() {
            let point = points.get(index);
            assert!(same(old, new), "{name} is {old:e}, and {new:e} at {point:?} by {}", what());
        }
    }
}
