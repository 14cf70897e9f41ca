//! The formats of scenes: a row for each, with the names of its files and what reads them.
//!
//! ```text
//! formats! { Jbt = jbt, Parsip = parsip, .. }     a variant, and the module with its row `FORMAT`
//! ```
//!
//! Commands, help texts, messages and the choice of a reader derive from the rows.

use super::imported::{Imported, ReadModel};
use super::particles::{MAX_PARTICLE_BYTES, ParticleOptions, ParticleUse};
use crate::Options;
use jbt_ir::limits::MAX_SCENE_BYTES;
use jbt_ir::watch;
use jbt_model::diagnostic::{Diagnostic, Diagnostics};

/// Bytes of memory that a byte of a file takes at least, while it is read: what it says, and lists that grow.
const TAKEN: usize = 2;

/// What a format is: the row that its module states.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SceneFormatRow {
    /// The endings of its files' names, without the dot, the usual one first.
    pub(crate) extensions: &'static [&'static str],
    /// One file of it in words, with its article.
    pub(crate) text: &'static str,
    /// Whether these bytes, the beginning of a file, are one by their content. The first row that says so
    /// has the file, so a row says it only of what no row before it means.
    pub(crate) recognizes: fn(&[u8]) -> bool,
    /// Its files declare parameters, which options may set.
    pub(crate) has_parameters: bool,
    /// Its files hold named objects, of which options may choose one.
    pub(crate) has_objects: bool,
    /// Its files hold particles or atoms, of which options say more.
    pub(crate) has_particles: bool,
    /// The options that its files have a use for, of those that not all particles have.
    pub(crate) uses: &'static [ParticleUse],
    /// The most bytes that are read of a file.
    pub(crate) max_bytes: usize,
    /// The model of a file of at most that many bytes.
    pub(crate) read: SceneReader,
}

/// What reads files of a format.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SceneReader {
    /// With all options.
    Scene(fn(&[u8], &Options) -> Result<Imported, Diagnostics>),
    /// With those of particles.
    Particles(fn(&[u8], &ParticleOptions) -> ReadModel),
}

impl SceneFormatRow {
    /// A text of usual size that has neither parameters nor objects and is known by its name alone.
    pub(crate) const fn new(
        extensions: &'static [&'static str],
        text: &'static str,
        read: fn(&[u8], &Options) -> Result<Imported, Diagnostics>,
    ) -> Self {
        let recognizes = |_: &[u8]| false;
        Self {
            extensions,
            text,
            recognizes,
            has_parameters: false,
            has_objects: false,
            has_particles: false,
            uses: &[],
            max_bytes: MAX_SCENE_BYTES,
            read: SceneReader::Scene(read),
        }
    }

    fn read(&self, bytes: &[u8], options: &Options) -> Result<Imported, Diagnostics> {
        match self.read {
            SceneReader::Scene(read) => read(bytes, options),
            SceneReader::Particles(read) => Imported::of_particles(bytes, read(bytes, &options.particles)),
        }
    }

    /// Particles or atoms.
    pub(crate) const fn of_particles(
        extensions: &'static [&'static str],
        (text, uses): (&'static str, &'static [ParticleUse]),
        recognizes: fn(&[u8]) -> bool,
        read: fn(&[u8], &ParticleOptions) -> ReadModel,
    ) -> Self {
        Self {
            extensions,
            text,
            recognizes,
            has_parameters: false,
            has_objects: false,
            has_particles: true,
            uses,
            max_bytes: MAX_PARTICLE_BYTES,
            read: SceneReader::Particles(read),
        }
    }
}

macro_rules! formats {
    ($($(#[$about:meta])+ $name:ident = $module:ident,)+) => {
        /// How a scene is written.
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
        #[non_exhaustive]
        pub enum SceneFormat {
            $($(#[$about])+ $name,)+
        }

        impl SceneFormat {
            /// All formats, in the order in which they are recognized.
            pub const ALL: [Self; [$(Self::$name),+].len()] = [$(Self::$name),+];

            const fn row(self) -> &'static SceneFormatRow {
                match self {
                    $(Self::$name => &super::$module::FORMAT,)+
                }
            }
        }
    };
}

formats! {
    /// An array of numpy: see [`particles`](super::particles).
    Npy = npy,
    /// A polygon file, of which the vertices are read.
    Ply = ply,
    /// A legacy file of VTK.
    Vtk = vtk,
    /// An XML file of VTK.
    Vtu = vtu,
    /// A structure of a molecule: mmCIF.
    Cif = cif,
    /// A structure of a molecule: PDB.
    Pdb = pdb,
    /// Atoms, or a cloud of points.
    Xyz = xyz,
    /// A table of points.
    Csv = csv,
    /// A tree of three-js-blobtree: see [`threejs`](fn@super::threejs).
    ThreeJs = threejs,
    /// A POV-Ray scene: see [`pov`](fn@super::pov).
    Pov = pov,
    /// A RenderMan scene: see [`rib`](fn@super::rib).
    Rib = rib,
    /// A ParsIP scene: see [`parsip`](fn@super::parsip).
    Parsip = parsip,
    /// A BRL-CAD database: see [`brlcad`](fn@super::brlcad).
    Brlcad = brlcad,
    /// A program of instructions: see [`vm`](fn@super::vm).
    Vm = vm,
    /// The [text format](crate) of jbt; whatever no other format recognizes.
    Jbt = jbt,
}

impl SceneFormat {
    /// The endings of its files' names, without the dot, the usual one first.
    #[must_use]
    pub const fn extensions(self) -> &'static [&'static str] {
        self.row().extensions
    }

    /// One file of it in words, with its article.
    #[must_use]
    pub const fn text(self) -> &'static str {
        self.row().text
    }

    /// The most bytes that are read of a file.
    #[must_use]
    pub const fn max_bytes(self) -> usize {
        self.row().max_bytes
    }

    /// All formats and their endings in words, as for a help text.
    #[must_use]
    pub fn list() -> String {
        let mut formats: Vec<String> = Vec::new();
        // What everybody writes comes first.
        for format in Self::ALL.into_iter().rev() {
            let endings: Vec<String> =
                format.extensions().iter().map(|ending| format!(".{ending}")).collect();
            formats.push(format!("{} ({})", format.text(), endings.join(", ")));
        }
        let last = formats.pop().unwrap_or_default();
        format!("{} or {last}", formats.join(", "))
    }

    /// The formats whose files' names end like this, in any case.
    fn of_extension(extension: &str) -> impl Iterator<Item = Self> {
        let is_mine =
            move |format: &Self| format.extensions().iter().any(|own| own.eq_ignore_ascii_case(extension));
        Self::ALL.into_iter().filter(is_mine)
    }

    /// Whether the ending of a file's name is one of a scene; a name without an ending may be.
    ///
    /// # Errors
    /// An ending that is not known: the message lists those that are.
    pub fn check_name(name: &str) -> Result<(), Diagnostics> {
        let Some(extension) = extension(name) else { return Ok(()) };
        if Self::of_extension(extension).next().is_some() {
            return Ok(());
        }
        let mut known: Vec<String> = Vec::new();
        for ending in
            Self::ALL.into_iter().rev().flat_map(Self::extensions).map(|ending| format!(".{ending}"))
        {
            if !known.contains(&ending) {
                known.push(ending);
            }
        }
        let message = format!("{name} is no scene by its ending `.{extension}`");
        let error = Diagnostic::error(None, message).expected(format!("scenes end in {}", known.join(", ")));
        Err(vec![error].into())
    }

    /// The format of a file: by the ending of its name, and by its content where several formats share the
    /// ending or there is none.
    ///
    /// # Errors
    /// Those of [`check_name`](Self::check_name).
    pub fn of(name: &str, bytes: &[u8]) -> Result<Self, Diagnostics> {
        Self::check_name(name)?;
        let Some(extension) = extension(name) else { return Ok(Self::of_content(bytes)) };
        let recognized = Self::of_extension(extension).find(|format| (format.row().recognizes)(bytes));
        Ok(recognized.or_else(|| Self::of_extension(extension).next()).unwrap_or(Self::Jbt))
    }

    /// The format by the content alone; [`Jbt`](Self::Jbt) if nothing else will do.
    #[must_use]
    pub fn of_content(bytes: &[u8]) -> Self {
        Self::ALL.into_iter().find(|format| (format.row().recognizes)(bytes)).unwrap_or(Self::Jbt)
    }

    /// The model of a file of this format; `name` is for messages.
    ///
    /// # Errors
    /// Everything that is wrong with the file, too many bytes among them, and options that files of this
    /// format do not take.
    pub fn read(self, name: &str, bytes: &[u8], options: &Options) -> Result<Imported, Diagnostics> {
        let row = self.row();
        if bytes.len() > row.max_bytes {
            return Err(self.too_large(name));
        }
        let refused = match (options.parameters.first(), &options.object) {
            (Some((parameter, _)), _) if !row.has_parameters => {
                format!("no parameter `{parameter}` to define")
            }
            (_, Some(object)) if !row.has_objects => format!("no objects to choose `{object}` from"),
            _ if options.particles.is_set() && !row.has_particles => {
                "no particles for options to be about".to_owned()
            }
            _ if let Some(what) = options.particles.useless(row.uses) => what.to_owned(),
            _ => {
                let read = || {
                    watch::take(TAKEN * bytes.len());
                    row.read(bytes, options)
                };
                return watch::guarded(read)?.map_err(|error| error.named(name));
            }
        };
        let message = format!("{name} is {}: it has {refused}", row.text);
        Err(vec![Diagnostic::error(None, message)].into())
    }

    /// The model of a file of particles; nothing if files of this format are something else.
    pub(crate) fn read_particles(self, bytes: &[u8], options: &ParticleOptions) -> Option<ReadModel> {
        match self.row().read {
            SceneReader::Scene(_) => None,
            SceneReader::Particles(read) => Some(read(bytes, options)),
        }
    }

    /// What is said of a file of more than [`max_bytes`](Self::max_bytes).
    #[must_use]
    pub fn too_large(self, name: &str) -> Diagnostics {
        let most = self.max_bytes() >> 20;
        let message = format!("{name} is larger than {most} MiB, the limit for {}", self.text());
        vec![Diagnostic::limit(None, message)].into()
    }
}

fn extension(name: &str) -> Option<&str> {
    let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let (stem, extension) = file.rsplit_once('.')?;
    (!stem.is_empty() && !extension.is_empty()).then_some(extension)
}

/// The first line that is neither blank nor a comment of `#`, without the blanks and NUL bytes in front.
pub(crate) fn first_line(bytes: &[u8]) -> &[u8] {
    let blank = |byte: &u8| byte.is_ascii_whitespace() || *byte == 0;
    let mut lines = bytes.split(|&byte| byte == b'\n').map(|line| {
        let start = line.iter().position(|byte| !blank(byte)).unwrap_or(line.len());
        &line[start..]
    });
    lines.find(|line| !line.is_empty() && !line.starts_with(b"#")).unwrap_or(b"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_by_extension_and_by_content() {
        let format = |name: &str, bytes: &[u8]| SceneFormat::of(name, bytes).unwrap();
        assert_eq!(format("a.JBT", b"[Global]"), SceneFormat::Jbt);
        assert_eq!(format("a.scene", b"jbt 1"), SceneFormat::Parsip);
        assert_eq!(format("-", b"\n\0\r\n# x\r\n [BLOBNODE 0]\0"), SceneFormat::Parsip);
        assert_eq!(format("-", b"# x\njbt 1 point { radius 1 }"), SceneFormat::Jbt);
        assert_eq!(format("a.vm", b"# x"), SceneFormat::Vm);
        assert_eq!(format("-", b"# x\n_0 var-x"), SceneFormat::Vm);
        assert_eq!(format("a", b""), SceneFormat::Jbt);
        assert_eq!(format("folder.d/a", b"_0 var-x"), SceneFormat::Vm);
        assert!(SceneFormat::of("a.stl", b"").is_err());
    }

    #[test]
    fn options_that_a_format_does_not_take_are_refused() {
        let read =
            |options: &Options| SceneFormat::Vm.read("a.vm", b"_0 var-x\n", options).unwrap_err().to_string();
        let parameter = Options { parameters: vec![("r".to_owned(), 1.0)], ..Options::default() };
        assert!(read(&parameter).contains("a.vm is a program of instructions: it has no parameter `r`"));
        let object = Options { object: Some("ball".to_owned()), ..Options::default() };
        assert!(read(&object).contains("it has no objects to choose `ball` from"));
        let particles = |format: SceneFormat, particles: ParticleOptions| {
            let options = Options { particles, ..Options::default() };
            format.read("a", b"x,y,z\n0,0,0\n", &options).unwrap_err().to_string()
        };
        let of_atoms = [
            (ParticleOptions { waters: true, ..ParticleOptions::default() }, "it has no water to keep"),
            (
                ParticleOptions { frame: Some(2), ..ParticleOptions::default() },
                "it has no frames to choose from",
            ),
        ];
        for (options, expected) in of_atoms {
            assert!(particles(SceneFormat::Csv, options).contains(expected), "{expected}");
        }
        let columns = ParticleOptions { columns: vec!["x".to_owned()], ..ParticleOptions::default() };
        assert!(particles(SceneFormat::Pdb, columns).contains("it has no columns to name"));
    }

    #[test]
    fn no_format_has_an_ending_in_capitals_or_with_a_dot() {
        for ending in SceneFormat::ALL.into_iter().flat_map(SceneFormat::extensions) {
            assert!(ending.chars().all(|one| one.is_ascii_lowercase() || one.is_ascii_digit()), "{ending}");
        }
    }
}
