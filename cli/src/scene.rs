//! Loading scenes: a path or the standard input becomes a model, whatever its format.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use jbt::ir::limits::MAX_SCENE_BYTES;
use jbt::{Compiler, Engine, Evaluator, Model, Query};
use jbt_frontend::check::CheckedTree;
use jbt_frontend::diagnostic::{Severity, Source, escape};
use jbt_frontend::import::{Imported, parsip, vm};
use jbt_frontend::text;

use crate::arguments::SceneArguments;
use crate::failure::Failure;
use crate::output::{highlight, tell};

/// A scene: its text for messages, and its model.
pub struct Scene {
    name: String,
    text: Vec<u8>,
    /// What the text says.
    pub model: Model,
    /// What is odd about the text, rendered.
    pub warnings: Vec<String>,
}

/// The format of a scene file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Format {
    Jbt,
    Parsip,
    Vm,
}

impl Format {
    /// In words.
    fn name(self) -> &'static str {
        match self {
            Self::Jbt => "a model",
            Self::Parsip => "a ParsIP scene",
            Self::Vm => "a program of instructions",
        }
    }
}

impl Scene {
    /// Reads and parses a scene.
    pub fn load(arguments: &SceneArguments) -> Result<Self, Failure> {
        let path = &arguments.path;
        let (name, text) = if is_standard(path) {
            ("<stdin>".to_owned(), read(io::stdin().lock(), "<stdin>")?)
        } else {
            let name = path.display().to_string();
            let text = read_file(path, &name)?;
            (name, text)
        };
        let source = Source { name: &name, text: &text };
        let fail = |diagnostics: Vec<_>| Failure::diagnostics(&source, &diagnostics);
        let format = format(path, &text);
        let Imported { model, warnings } = match format {
            Format::Jbt => {
                let options = text::Options { parameters: arguments.definitions.clone() };
                Imported { model: text::parse(&text, &options).map_err(fail)?, warnings: Vec::new() }
            }
            Format::Parsip | Format::Vm => {
                if let Some((parameter, _)) = arguments.definitions.first() {
                    let message = format!(
                        "{} is {}: it has no parameter `{parameter}` to define",
                        escape(&name),
                        format.name()
                    );
                    return Err(Failure::Usage(message));
                }
                if format == Format::Vm { vm(&text) } else { parsip(&text) }.map_err(fail)?
            }
        };
        let warnings = warnings.iter().map(|warning| source.render(warning)).collect();
        Ok(Self { name, text, model, warnings })
    }

    /// Tells people what is odd about the text.
    pub fn warn(&self, quiet: bool) {
        if !quiet {
            for warning in &self.warnings {
                tell(&highlight(warning, Severity::Warning));
            }
        }
    }

    /// The text, for messages.
    pub fn source(&self) -> Source<'_> {
        Source { name: &self.name, text: &self.text }
    }

    /// Its name, as it stands on the command line.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The checked model, or all that is wrong with it.
    pub fn check(&self) -> Result<CheckedTree, Failure> {
        self.model.check().map_err(|diagnostics| Failure::diagnostics(&self.source(), &diagnostics))
    }

    /// An evaluator. Without an engine to insist on, it is the best one.
    pub fn evaluator(
        &self,
        tree: &CheckedTree,
        query: Query,
        engine: Option<Engine>,
    ) -> Result<Evaluator, Failure> {
        let compiler = engine.map_or_else(Compiler::new, Compiler::for_engine);
        compiler.evaluator(tree, query).map_err(|error| Failure::compile(&self.source(), &error))
    }
}

/// Whether a path of the command line means the standard input or output.
pub fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

fn read_file(path: &Path, name: &str) -> Result<Vec<u8>, Failure> {
    let fail = |error| Failure::io("read", name, error);
    let file = File::open(path).map_err(fail)?;
    // The length of a pipe or device is not known; `read` stops at the limit for these.
    if file.metadata().map_err(fail)?.len() > MAX_SCENE_BYTES as u64 {
        return Err(too_large(name));
    }
    read(file, name)
}

/// Reads at most the limit and one byte more.
fn read(reader: impl Read, name: &str) -> Result<Vec<u8>, Failure> {
    let mut text = Vec::new();
    let mut reader = reader.take(MAX_SCENE_BYTES as u64 + 1);
    reader.read_to_end(&mut text).map_err(|error| Failure::io("read", name, error))?;
    if text.len() > MAX_SCENE_BYTES { Err(too_large(name)) } else { Ok(text) }
}

fn too_large(name: &str) -> Failure {
    Failure::Limit(format!(
        "{} is larger than {} MiB, the limit for scenes",
        escape(name),
        MAX_SCENE_BYTES >> 20
    ))
}

/// The format by extension; else by the first line that means something.
fn format(path: &Path, text: &[u8]) -> Format {
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("jbt") => Format::Jbt,
        Some("blob" | "scene") => Format::Parsip,
        Some("vm") => Format::Vm,
        _ => sniff(text),
    }
}

/// ParsIP scenes are sections, the first of which begins with a bracket, and instructions have names that begin with an underscore as a rule; no
/// `.jbt` text begins with either. All have comments.
fn sniff(text: &[u8]) -> Format {
    let blank = |byte: &u8| byte.is_ascii_whitespace() || *byte == 0;
    let mut lines = text.split(|&byte| byte == b'\n').map(|line| {
        let start = line.iter().position(|byte| !blank(byte)).unwrap_or(line.len());
        &line[start..]
    });
    match lines.find(|line| !line.is_empty() && !line.starts_with(b"#")) {
        Some(line) if line.starts_with(b"[") => Format::Parsip,
        Some(line) if line.starts_with(b"_") => Format::Vm,
        Some(_) | None => Format::Jbt,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_by_extension_and_by_content() {
        assert_eq!(format(Path::new("a.JBT"), b"[Global]"), Format::Jbt);
        assert_eq!(format(Path::new("a.scene"), b"jbt 1"), Format::Parsip);
        assert_eq!(format(Path::new("-"), b"\n\0\r\n# x\r\n [BLOBNODE 0]\0"), Format::Parsip);
        assert_eq!(format(Path::new("-"), b"# x\njbt 1 point { radius 1 }"), Format::Jbt);
        assert_eq!(format(Path::new("a.vm"), b"# x"), Format::Vm);
        assert_eq!(format(Path::new("-"), b"# x\n_0 var-x"), Format::Vm);
        assert_eq!(format(Path::new("a"), b""), Format::Jbt);
    }

    #[test]
    fn reads_up_to_the_limit_and_no_further() {
        assert_eq!(
            read(io::repeat(b' ').take(MAX_SCENE_BYTES as u64), "a").map(|text| text.len()).ok(),
            Some(MAX_SCENE_BYTES)
        );
        assert!(matches!(read(io::repeat(b' '), "a"), Err(Failure::Limit(_))));
    }
}
