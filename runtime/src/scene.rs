//! Scene files: a path or bytes become a model, by the ending of the name.

use crate::span::span;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use jbt_ir::limits::MAX_SCENE_BYTES;
use jbt_model::check::CheckedTree;
use jbt_model::diagnostic::{Diagnostic, Diagnostics, SourceText};
use jbt_model::model::Model;
use jbt_text::import::{Imported, parsip, vm};
use jbt_text::{self, Options};

/// A scene that was read: its model, and what is odd about its text.
///
/// ```no_run
/// use jbt::{Compiler, Polygonize, Scene};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let tree = Scene::load("hero.jbt")?.check()?;
/// let made = Polygonize::default().mesh(&Compiler::new(), &tree).run()?;
/// jbt::export::save("hero.glb".as_ref(), &made.mesh)?;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Scene {
    /// What the text says.
    pub model: Model,
    /// What in the file is odd, and was read as best it could be.
    pub warnings: Diagnostics,
    /// How it was written.
    pub format: SceneFormat,
    /// The text, for messages.
    pub text: SourceText,
    /// What it was read with.
    options: Options,
}

/// How a scene is written.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[non_exhaustive]
pub enum SceneFormat {
    /// The [text format](crate::text) of jbt.
    Jbt,
    /// A ParsIP scene: see [`parsip`](fn@crate::import::parsip).
    Parsip,
    /// A program of instructions: see [`vm`](fn@crate::import::vm).
    Vm,
}

impl SceneFormat {
    /// All formats.
    pub const ALL: [Self; 3] = [Self::Jbt, Self::Parsip, Self::Vm];

    /// The endings of its files' names, without the dot.
    #[must_use]
    pub const fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Jbt => &["jbt"],
            Self::Parsip => &["blob", "scene"],
            Self::Vm => &["vm"],
        }
    }

    /// In words.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Jbt => "a model",
            Self::Parsip => "a ParsIP scene",
            Self::Vm => "a program of instructions",
        }
    }

    /// The format by the ending of a file's name, in any case; `None` if the name has no ending.
    ///
    /// # Errors
    /// An ending that is not known: the message lists those that are.
    pub fn of_name(name: &str) -> Result<Option<Self>, Diagnostics> {
        let Some(extension) = Path::new(name).extension().and_then(|extension| extension.to_str()) else {
            return Ok(None);
        };
        let is_mine =
            |format: &Self| format.extensions().iter().any(|own| own.eq_ignore_ascii_case(extension));
        if let Some(format) = Self::ALL.into_iter().find(is_mine) {
            return Ok(Some(format));
        }
        let known = Self::ALL.iter().flat_map(|format| format.extensions());
        let known: Vec<String> = known.map(|extension| format!(".{extension}")).collect();
        let message = format!("{name} is no scene by its ending `.{extension}`");
        let error = Diagnostic::error(None, message).expected(format!("scenes end in {}", known.join(", ")));
        Err(vec![error].into())
    }

    /// The format by the first line that means something. ParsIP scenes are sections, the first of which
    /// begins with a bracket, and instructions have
    /// names that begin with an underscore as a rule; no `.jbt` text begins with either. All have comments.
    #[must_use]
    pub fn of_content(text: &[u8]) -> Self {
        let blank = |byte: &u8| byte.is_ascii_whitespace() || *byte == 0;
        let mut lines = text.split(|&byte| byte == b'\n').map(|line| {
            let start = line.iter().position(|byte| !blank(byte)).unwrap_or(line.len());
            &line[start..]
        });
        match lines.find(|line| !line.is_empty() && !line.starts_with(b"#")) {
            Some(line) if line.starts_with(b"[") => Self::Parsip,
            Some(line) if line.starts_with(b"_") => Self::Vm,
            Some(_) | None => Self::Jbt,
        }
    }
}

impl Scene {
    /// Reads a file: `.jbt`, `.blob`, `.scene` or `.vm`, or one whose name has no ending, by its first line.
    ///
    /// # Errors
    /// A file that cannot be read ([`Diagnostics::io`] says why), an ending that is not known, a file of more
    /// than [`MAX_SCENE_BYTES`], and
    /// everything that is wrong with its text. What is wrong with the model, [`check`](Self::check) says.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Diagnostics> {
        Self::load_with(path, &Options::default())
    }

    /// As [`load`](Self::load), with values of parameters.
    ///
    /// # Errors
    /// Those of [`load`](Self::load), and a parameter that the scene does not have.
    pub fn load_with(path: impl AsRef<Path>, options: &Options) -> Result<Self, Diagnostics> {
        let name = path.as_ref().display().to_string();
        SceneFormat::of_name(&name)?;
        let failed = |cause| Diagnostics::unreadable(&name, cause);
        let file = File::open(path.as_ref()).map_err(failed)?;
        // The length of a pipe or device is not known; reading stops at the limit for these.
        if file.metadata().map_err(failed)?.len() > MAX_SCENE_BYTES as u64 {
            return Err(too_large(&name));
        }
        Self::from_reader(&name, file, options)
    }

    /// Reads at most the limit and one byte more; the format is that of the name.
    ///
    /// # Errors
    /// Those of [`load_with`](Self::load_with).
    pub fn from_reader(name: &str, reader: impl Read, options: &Options) -> Result<Self, Diagnostics> {
        let mut bytes = Vec::new();
        let mut reader = reader.take(MAX_SCENE_BYTES as u64 + 1);
        reader.read_to_end(&mut bytes).map_err(|cause| Diagnostics::unreadable(name, cause))?;
        Self::read(name, &bytes, options)
    }

    /// A scene that somebody else has read, with a name for messages. The format is that of the name, as if
    /// it were a file's; a name without an ending
    /// leaves it to the first line.
    ///
    /// ```
    /// let error = jbt::Scene::from_bytes("ball.jbt", b"jbt 1\npoint { radius 1 } }").unwrap_err();
    /// assert!(error.to_string().starts_with("ball.jbt:2:20: error: "), "{error}");
    /// ```
    ///
    /// # Errors
    /// Those of [`load`](Self::load).
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, Diagnostics> {
        Self::read(name, bytes, &Options::default())
    }

    fn read(name: &str, bytes: &[u8], options: &Options) -> Result<Self, Diagnostics> {
        span!("read");
        let format = SceneFormat::of_name(name)?.unwrap_or_else(|| SceneFormat::of_content(bytes));
        if bytes.len() > MAX_SCENE_BYTES {
            return Err(too_large(name));
        }
        let imported = match format {
            SceneFormat::Jbt => jbt_text::parse(bytes, options)
                .map(|model| Imported { model, warnings: Diagnostics::default() }),
            SceneFormat::Parsip | SceneFormat::Vm => {
                if let Some((parameter, _)) = options.parameters.first() {
                    return Err(fixed(name, format, parameter));
                }
                if format == SceneFormat::Vm { vm(bytes) } else { parsip(bytes) }
            }
        };
        let Imported { mut model, warnings } = imported.map_err(|error| error.named(name))?;
        let text = match model.source.take() {
            Some(source) => source.named(name),
            None => SourceText::new(name, bytes),
        };
        model.source = Some(text.clone());
        let options = options.clone();
        Ok(Self { model, warnings: warnings.named(name), format, text, options })
    }

    /// The scene with other values of some parameters: its text is read again, so that loops and conditions
    /// follow them. Files that it includes are opened again. Nodes may be other ones then, and the model is
    /// compiled anew; where numbers alone follow a parameter,
    /// [`CheckedTree::with_parameters`] takes less ([`Parameter::fixture`](crate::Parameter::fixture) tells).
    ///
    /// ```
    /// let text = b"jbt 1 param n = 2 sum { for i in 0 .. n { point { at (i 0 0) radius 1 } } }";
    /// let scene = jbt::Scene::from_bytes("row.jbt", text)?;
    /// assert!(scene.check()?.with_parameters(&[("n", 3.0)]).is_err());
    /// assert_eq!(scene.with_parameters(&[("n", 3.0)])?.model.root.node().children().len(), 3);
    /// # Ok::<(), jbt::Diagnostics>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`load_with`](Self::load_with).
    pub fn with_parameters(&self, settings: &[(&str, f64)]) -> Result<Self, Diagnostics> {
        let mut options = self.options.clone();
        options.parameters.extend(settings.iter().map(|&(name, value)| (name.to_owned(), value)));
        // A name without an ending has been read as what its text is.
        Self::read(self.text.name(), self.text.text(), &options)
    }

    /// The checked model.
    ///
    /// # Errors
    /// Those of [`Model::check`], with the places in the file.
    pub fn check(&self) -> Result<CheckedTree, Diagnostics> {
        span!("check");
        self.model.check()
    }
}

fn too_large(name: &str) -> Diagnostics {
    let message = format!("{name} is larger than {} MiB, the limit for scenes", MAX_SCENE_BYTES >> 20);
    vec![Diagnostic::limit(None, message)].into()
}

fn fixed(name: &str, format: SceneFormat, parameter: &str) -> Diagnostics {
    let message = format!("{name} is {}: it has no parameter `{parameter}` to define", format.text());
    vec![Diagnostic::error(None, message)].into()
}

#[cfg(test)]
mod tests {
    use std::io;

    use jbt_model::diagnostic::Severity;

    use super::*;

    fn format(name: &str, text: &[u8]) -> SceneFormat {
        SceneFormat::of_name(name).unwrap().unwrap_or_else(|| SceneFormat::of_content(text))
    }

    #[test]
    fn formats_by_extension_and_by_content() {
        assert_eq!(format("a.JBT", b"[Global]"), SceneFormat::Jbt);
        assert_eq!(format("a.scene", b"jbt 1"), SceneFormat::Parsip);
        assert_eq!(format("-", b"\n\0\r\n# x\r\n [BLOBNODE 0]\0"), SceneFormat::Parsip);
        assert_eq!(format("-", b"# x\njbt 1 point { radius 1 }"), SceneFormat::Jbt);
        assert_eq!(format("a.vm", b"# x"), SceneFormat::Vm);
        assert_eq!(format("-", b"# x\n_0 var-x"), SceneFormat::Vm);
        assert_eq!(format("a", b""), SceneFormat::Jbt);
    }

    #[test]
    fn reads_up_to_the_limit_and_no_further() {
        let blanks = |count: u64| {
            Scene::from_reader("a.jbt", io::repeat(b' ').take(count), &Options::default()).unwrap_err()
        };
        assert_eq!(blanks(MAX_SCENE_BYTES as u64)[0].severity, Severity::Error);
        assert_eq!(blanks(u64::MAX)[0].severity, Severity::Limit);
    }
}
