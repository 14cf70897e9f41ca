//! Scenes of tests: models from text, their programs, how many of them to try.

use jbt_ir::pass::{PIPELINE, run_pipeline};
use jbt_ir::{Tables, Verified, verify};
use jbt_lower::{Lowered, lower};
use jbt_model::check::CheckedTree;
use jbt_model::model::Model;
use jbt_model::query::Query;
use jbt_text::{Options, parse};

/// The model of a text. Panics with the text and its errors, if it does not read.
#[must_use]
pub fn model(text: &str) -> Model {
    parse(text.as_bytes(), &Options::default()).unwrap_or_else(|errors| panic!("{text}\n{errors:?}"))
}

/// The checked model of a text. Panics with the text and its errors, if it is no good model.
#[must_use]
pub fn tree(text: &str) -> CheckedTree {
    model(text).check().unwrap_or_else(|errors| panic!("{text}\n{errors:?}"))
}

/// The program of a model for a query, after all passes, with its numbers.
#[must_use]
pub fn compiled(tree: &CheckedTree, query: Query) -> (Verified, Tables) {
    let Lowered { function, tables } = lower(tree, query).expect("it can be lowered");
    let passes = query.passes().chain(PIPELINE);
    (verify(run_pipeline(function, passes, &mut |_, _| {})).expect("passes keep the rules"), tables)
}

/// How many cases to try: what this environment variable says, or the default.
#[must_use]
pub fn count(variable: &str, default: u64) -> u64 {
    std::env::var(variable).ok().and_then(|value| value.parse().ok()).unwrap_or(default)
}
