//! Files of scenes: read, or refused with errors that have a place.

use jbt::SceneFormat;
use jbt::diagnostic::Diagnostics;
use jbt::import::Imported;
use jbt::import::particles::ParticleOptions;
use jbt::text::Options;

use crate::print;

/// Nodes of a model that is printed and read again.
const MAX_NODES: usize = 2_000;

/// The word for a format, in names of targets.
#[must_use]
pub fn format_word(format: SceneFormat) -> String {
    format!("{format:?}").to_lowercase()
}

/// Reads bytes as a file of a format, checks the model, and prints it.
pub fn read(format: SceneFormat, bytes: &[u8]) {
    // What a name and the content say is asked for any bytes.
    let _ = SceneFormat::of_content(bytes);
    // Points without a radius take it from an option, which formats without points refuse.
    let particles = ParticleOptions { radius: Some(0.5), ..ParticleOptions::default() };
    for options in [Options::default(), Options { particles, ..Options::default() }] {
        match format.read("stranger", bytes, &options) {
            Ok(imported) => checked(imported),
            Err(errors) => told(&errors),
        }
    }
}

fn checked(imported: Imported) {
    let Imported { model, warnings } = imported;
    if !warnings.is_empty() {
        told(&warnings);
    }
    match model.check() {
        Ok(tree) if tree.nodes().len() <= MAX_NODES => print::reads_back(&model),
        Ok(_) => {}
        Err(errors) => told(&errors),
    }
}

/// Messages can be shown, and hold nothing that changes a terminal.
fn told(errors: &Diagnostics) {
    let text = errors.to_string();
    assert!(!errors.is_empty() && !text.is_empty(), "a refusal has a reason");
    let control = text.chars().find(|letter| letter.is_control() && *letter != '\n');
    assert_eq!(control, None, "control characters are escaped: {text:?}");
}
