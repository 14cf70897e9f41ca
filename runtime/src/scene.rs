//! Scene files: a path or bytes become a model, by the ending of the name.

use crate::span::span;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use jbt_model::check::CheckedTree;
use jbt_model::diagnostic::{Diagnostics, SourceText};
use jbt_model::model::Model;
use jbt_text::Options;
use jbt_text::import::{Imported, SceneFormat};

/// The beginning of a file, in bytes, that tells its format.
const BEGINNING: u64 = 64 << 10;

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

impl Scene {
    /// Reads a file: `.jbt`, `.blob`, `.scene` or `.vm`, or one whose name has no ending, by its first line.
    ///
    /// # Errors
    /// A file that cannot be read ([`Diagnostics::io`] says why), an ending that is not known, a file of more
    /// than [`SceneFormat::max_bytes`], and
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
        SceneFormat::check_name(&name)?;
        let file = File::open(path.as_ref()).map_err(|cause| Diagnostics::unreadable(&name, cause))?;
        Self::from_reader(&name, file, options)
    }

    /// Reads at most the limit of the format and one byte more; the format is that of the name and of the
    /// beginning of what is read, as with [`SceneFormat::of`].
    ///
    /// # Errors
    /// Those of [`load_with`](Self::load_with).
    pub fn from_reader(name: &str, reader: impl Read, options: &Options) -> Result<Self, Diagnostics> {
        let failed = |cause| Diagnostics::unreadable(name, cause);
        let mut bytes = Vec::new();
        let mut reader = reader.take(BEGINNING);
        reader.read_to_end(&mut bytes).map_err(failed)?;
        let format = SceneFormat::of(name, &bytes)?;
        reader.set_limit(format.max_bytes() as u64 + 1 - bytes.len() as u64);
        reader.read_to_end(&mut bytes).map_err(failed)?;
        Self::read(name, &bytes, format, options)
    }

    /// A scene that somebody else has read, with a name for messages. The format is that of the name, as if
    /// it were a file's, and of the content, as with [`SceneFormat::of`].
    ///
    /// ```
    /// let error = jbt::Scene::from_bytes("ball.jbt", b"jbt 1\npoint { radius 1 } }").unwrap_err();
    /// assert!(error.to_string().starts_with("ball.jbt:2:20: error: "), "{error}");
    /// ```
    ///
    /// # Errors
    /// Those of [`load`](Self::load).
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, Diagnostics> {
        Self::read(name, bytes, SceneFormat::of(name, bytes)?, &Options::default())
    }

    fn read(name: &str, bytes: &[u8], format: SceneFormat, options: &Options) -> Result<Self, Diagnostics> {
        span!("read");
        let Imported { mut model, warnings } = format.read(name, bytes, options)?;
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
        Self::read(self.text.name(), self.text.text(), self.format, &options)
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

#[cfg(test)]
mod tests {
    use std::io;

    use jbt_model::diagnostic::Severity;

    use super::*;

    #[test]
    fn reads_up_to_the_limit_and_no_further() {
        let blanks = |count: u64| {
            Scene::from_reader("a.jbt", io::repeat(b' ').take(count), &Options::default()).unwrap_err()
        };
        assert_eq!(blanks(SceneFormat::Jbt.max_bytes() as u64)[0].severity, Severity::Error);
        assert_eq!(blanks(u64::MAX)[0].severity, Severity::Limit);
    }
}
