//! The formats of mesh files: one line each, and a file that says what is usual in them and writes them.

use std::fmt;
use std::io::Write;
use std::num::NonZeroU16;
use std::path::Path;
use std::str::FromStr;

use jbt_model::constant::ConstantValues;

use super::conventions::{ColorEncoding, Conventions, FileChoices, LengthUnit, Up};
use super::parts::WriteError;
use super::{glb, obj, ply, stl, three_mf, usda};
use crate::mesh::Mesh;
use crate::word::{UnknownWord, find};

macro_rules! formats {
    ($( $(#[doc = $doc:literal])* $variant:ident $module:ident; )+) => {
        /// A kind of mesh file.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum Format {
            $( $(#[doc = $doc])* $variant, )+
        }

        impl Format {
            /// Every format.
            pub const ALL: [Format; [$( stringify!($module) ),+].len()] = [$( Format::$variant ),+];

            /// What is usual in its files.
            #[must_use]
            pub const fn conventions(self) -> &'static Conventions {
                match self { $( Format::$variant => &$module::CONVENTIONS, )+ }
            }

            /// Writes a mesh that is well formed.
            pub(super) fn write(
                self,
                mesh: &Mesh,
                choices: FileChoices<'_>,
                out: &mut impl Write,
            ) -> Result<(), WriteError> {
                match self { $( Format::$variant => $module::write(mesh, choices, out), )+ }
            }
        }
    };
}

formats! {
    /// Binary glTF 2.0.
    Glb glb;
    /// Polygon file format, binary little-endian.
    Ply ply;
    /// Wavefront OBJ.
    Obj obj;
    /// Stereolithography, binary.
    Stl stl;
    /// 3D Manufacturing Format, for printers.
    ThreeMf three_mf;
    /// Universal Scene Description, as text.
    Usda usda;
}

impl Format {
    /// The extension of its files, without a dot.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        self.conventions().extension
    }

    /// The format that the extension of a path names, in any case.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        Format::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// The extensions of all formats, as `.glb, .ply, .obj or .stl`.
    #[must_use]
    pub fn extensions() -> String {
        let [first @ .., last] = Format::ALL.map(|format| format!(".{format}"));
        format!("{} or {last}", first.join(", "))
    }
}

/// How a mesh is written where users may want it otherwise than a format's readers do. `None` is what
/// [`Conventions`] say.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExportOptions {
    /// The axis of the file that points up.
    pub up: Option<Up>,
    /// What the numbers of colours mean. A format without colours does not care.
    pub colors: Option<ColorEncoding>,
    /// What a unit of the scene is, in a format that says so.
    pub unit: Option<LengthUnit>,
    /// At most so many materials, each triangle of one, in a format that has any: for printers.
    pub palette: Option<NonZeroU16>,
    /// What the mesh is called, in a format that has a place for it: see [`Conventions::name`].
    pub name: Option<String>,
    /// The constants of the leaves of each piece of the mesh, in a format that has a place for them:
    /// [`CheckedTree::constants_of_pieces`](crate::CheckedTree::constants_of_pieces) has those of a model.
    pub constants: Vec<Vec<ConstantValues>>,
}

impl ExportOptions {
    /// The axis that points up in a file of this format.
    #[must_use]
    pub fn up_in(&self, format: Format) -> Up {
        self.up.unwrap_or(format.conventions().up)
    }

    /// What the numbers of colours mean in a file of this format, if it has any.
    #[must_use]
    pub fn colors_in(&self, format: Format) -> Option<ColorEncoding> {
        format.conventions().colors.map(|colors| self.colors.unwrap_or(colors.encoding))
    }

    /// The unit that a file of this format states, if it states any.
    #[must_use]
    pub fn unit_in(&self, format: Format) -> Option<LengthUnit> {
        format.conventions().unit.map(|unit| self.unit.unwrap_or(unit))
    }
}

impl<'a> FileChoices<'a> {
    pub(super) fn new(mesh: &Mesh, format: Format, options: &'a ExportOptions) -> Self {
        Self {
            up: options.up_in(format),
            model: mesh.orientation.up,
            colors: options.colors_in(format).unwrap_or(ColorEncoding::Linear),
            unit: options.unit_in(format).unwrap_or(LengthUnit::Metre),
            palette: options.palette,
            name: options.name.as_deref(),
            constants: &options.constants,
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.extension())
    }
}

impl FromStr for Format {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, UnknownWord> {
        find(&Format::ALL, word)
    }
}
