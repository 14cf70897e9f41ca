//! `jbt convert`: a scene of any format as a text of this project.

use std::io::Write as _;

use jbt::diagnostic::escape;
use jbt::internals::ir::limits::MAX_SCENE_BYTES;
use jbt::text;

use crate::arguments::ConvertArguments;
use crate::failure::Failure;
use crate::formats::TextKind;
use crate::output::{Output, Told, grouped};
use crate::scene::LoadedScene;

/// Runs the command.
pub fn run(arguments: &ConvertArguments, quiet: bool) -> Result<(), Failure> {
    let destination = arguments.output.destination(&arguments.scene.path)?;
    let scene = LoadedScene::load(&arguments.scene)?;
    scene.warn(quiet);
    let tree = scene.check()?;
    let mut output = Output::open(&destination)?;
    let written = match destination.kind {
        TextKind::Jbt => text::print(&scene.model),
    };
    if written.len() > MAX_SCENE_BYTES {
        let most = MAX_SCENE_BYTES >> 20;
        let message = format!("the text has {} bytes; texts of at most {most} MiB are read", written.len());
        return Err(Failure::Limit(message));
    }
    output.write_all(written.as_bytes()).map_err(|error| output.failure(error))?;
    output.finish()?;
    let told = Told::Text { quiet };
    let summary = |name: &str| {
        let (nodes, bytes) = (grouped(tree.nodes().len() as u64), grouped(written.len() as u64));
        format!("{}: {nodes} nodes, {bytes} bytes", escape(name))
    };
    told.report(&destination.path, String::new, summary)
}
