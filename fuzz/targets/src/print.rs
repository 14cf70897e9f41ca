//! What is printed of a model reads back as the same model.

use jbt::Model;
use jbt::limits::MAX_SCENE_BYTES;
use jbt::text::{Options, parse, print};
use jbt_testkit::random::Numbers;

use crate::model::model;

/// Prints a model that bytes mean, and reads it.
pub(crate) fn run(bytes: &[u8]) {
    if let Some(model) = model(bytes, Numbers::Hostile)
        && model.check().is_ok()
    {
        reads_back(&model);
    }
}

/// Panics unless the text of a checked model is that model.
pub(crate) fn reads_back(model: &Model) {
    let text = print(model);
    if text.len() > MAX_SCENE_BYTES {
        return;
    }
    let again = parse(text.as_bytes(), &Options::default());
    let again = again.unwrap_or_else(|errors| panic!("{errors}\n{text}"));
    assert!(again == *model, "another model was read back\n{text}\n{}", print(&again));
}
