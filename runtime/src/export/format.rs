//! The formats of mesh files, one row each: how files end, which axis points up, how colours are written, what there is room for.

use std::fmt;
use std::ops::Sub;
use std::path::Path;
use std::str::FromStr;

use thiserror::Error;

use super::ExportError;
use crate::srgb;

/// A kind of mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Binary glTF 2.0.
    Glb,
    /// Polygon file format, binary little-endian.
    Ply,
    /// Wavefront OBJ.
    Obj,
    /// Stereolithography, binary.
    Stl,
}

/// What a format is like: its row in the table of formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conventions {
    /// The extension of its files, without a dot, in small letters.
    pub extension: &'static str,
    /// What it is.
    pub title: &'static str,
    /// The axis that points up, unless [`ExportOptions::up`] says otherwise: the one that its readers assume.
    pub up: Up,
    /// How it has normals.
    pub normals: &'static str,
    /// How it has colours, if it has any.
    pub colors: Option<Colors>,
    /// How it has the uv, if it has.
    pub uv: Option<&'static str>,
    /// How it has other attributes, if it has any.
    pub attributes: Option<&'static str>,
    /// How it has the place of a mesh that is far from the origin of the world.
    pub far: FarMeshes,
}

/// How a format has the place of a mesh with an [origin](crate::mesh::Mesh::origin) of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FarMeshes {
    /// Vertices are as in the mesh, and a node moves them.
    Node,
    /// Vertices are in the world, in numbers that have the digits for it.
    Digits,
    /// Vertices are in the world, rounded to f32.
    Rounded,
}

impl FarMeshes {
    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            FarMeshes::Node => "a node's translation",
            FarMeshes::Digits => "64-bit floats or decimals",
            FarMeshes::Rounded => "rounded to 32 bits",
        }
    }
}

/// How a format has colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colors {
    /// The name and the type.
    pub place: &'static str,
    /// What the numbers mean, unless [`ExportOptions::colors`] says otherwise: what its readers assume.
    pub encoding: ColorEncoding,
}

const GLB: Conventions = Conventions {
    extension: "glb",
    title: "glTF 2.0, binary",
    up: Up::Y,
    normals: "`NORMAL`",
    colors: Some(Colors { place: "`COLOR_0`, 32-bit floats", encoding: ColorEncoding::Linear }),
    uv: Some("`TEXCOORD_0`, v downwards"),
    attributes: Some("`_NAME`, 32-bit floats"),
    far: FarMeshes::Node,
};

const PLY: Conventions = Conventions {
    extension: "ply",
    title: "Stanford polygons, binary",
    up: Up::Z,
    normals: "`nx ny nz`",
    colors: Some(Colors { place: "`red green blue`, 8 bits", encoding: ColorEncoding::Srgb }),
    uv: Some("`s t`"),
    attributes: Some("properties, 32-bit floats"),
    far: FarMeshes::Digits,
};

const OBJ: Conventions = Conventions {
    extension: "obj",
    title: "Wavefront, text",
    up: Up::Y,
    normals: "`vn`",
    colors: Some(Colors { place: "behind the position, decimals", encoding: ColorEncoding::Srgb }),
    uv: Some("`vt`"),
    attributes: None,
    far: FarMeshes::Digits,
};

const STL: Conventions = Conventions {
    extension: "stl",
    title: "stereolithography, binary",
    up: Up::Z,
    normals: "of the triangles",
    colors: None,
    uv: None,
    attributes: None,
    far: FarMeshes::Rounded,
};

impl Format {
    /// Every format.
    pub const ALL: [Format; 4] = [Format::Glb, Format::Ply, Format::Obj, Format::Stl];

    /// Its row in the table of formats.
    #[must_use]
    pub const fn conventions(self) -> &'static Conventions {
        match self {
            Format::Glb => &GLB,
            Format::Ply => &PLY,
            Format::Obj => &OBJ,
            Format::Stl => &STL,
        }
    }

    /// The extension of its files, without a dot.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        self.conventions().extension
    }

    /// The format that the extension of a path names, in any case.
    ///
    /// # Errors
    /// [`ExportError::Extension`].
    pub fn of(path: &Path) -> Result<Self, ExportError> {
        let extension = path.extension().unwrap_or_default();
        let format =
            Format::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()));
        format.ok_or_else(|| ExportError::Extension { path: path.to_owned() })
    }

    /// The extensions of all formats, as `.glb, .ply, .obj or .stl`.
    #[must_use]
    pub fn extensions() -> String {
        let [first @ .., last] = Format::ALL.map(|format| format!(".{format}"));
        format!("{} or {last}", first.join(", "))
    }
}

/// Which axis of a file points up. Models are z-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Up {
    /// The model is turned by -90 degrees about x: its (x, y, z) is (x, z, -y) in the file. The model's -y is the file's +z.
    Y,
    /// As in the model.
    Z,
}

impl Up {
    /// Both.
    pub const ALL: [Up; 2] = [Up::Y, Up::Z];

    /// The axis as a word: `y` or `z`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Up::Y => "y",
            Up::Z => "z",
        }
    }

    /// Where a point of the model, or a direction, is in a file.
    #[must_use]
    pub fn place<T: Default + Sub<Output = T>>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        match self {
            // As a difference, so that no zero becomes a negative one.
            Up::Y => [x, z, T::default() - y],
            Up::Z => [x, y, z],
        }
    }
}

/// What the numbers of a colour mean. Those of a model are linear: twice the number is twice the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ColorEncoding {
    /// As screens take them, in even steps for the eye (sRGB, IEC 61966-2-1): half the light is 0.735, or 188 of 255.
    Srgb,
    /// As in the model.
    Linear,
}

impl ColorEncoding {
    /// Both.
    pub const ALL: [ColorEncoding; 2] = [ColorEncoding::Srgb, ColorEncoding::Linear];

    /// The encoding as a word: `srgb` or `linear`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            ColorEncoding::Srgb => "srgb",
            ColorEncoding::Linear => "linear",
        }
    }

    /// The number of a file, 0 .. 1, for one channel of a model. What is no number is 0, and others are clamped.
    #[must_use]
    pub fn encode(self, linear: f32) -> f32 {
        match self {
            ColorEncoding::Srgb => srgb::encode_precisely(linear),
            ColorEncoding::Linear => srgb::unit(linear),
        }
    }
}

/// How a mesh is written where users may want it otherwise than a format's readers do. `None` is what [`Conventions`] say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExportOptions {
    /// The axis of the file that points up.
    pub up: Option<Up>,
    /// What the numbers of colours mean. A format without colours does not care.
    pub colors: Option<ColorEncoding>,
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
}

/// What a file is like: what options say, else the conventions of its format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Choices {
    pub up: Up,
    /// Any, where there are no colours.
    pub colors: ColorEncoding,
}

impl Choices {
    pub fn new(format: Format, options: &ExportOptions) -> Self {
        Self { up: options.up_in(format), colors: options.colors_in(format).unwrap_or(ColorEncoding::Linear) }
    }
}

/// A word that stands for no member of a list.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{word:?} is none of: {known}")]
pub struct UnknownWord {
    /// The word.
    pub word: String,
    /// All members, with commas between them.
    pub known: String,
}

/// The member of a list that prints as a word.
pub(crate) fn find<T: Copy + fmt::Display>(all: &[T], word: &str) -> Result<T, UnknownWord> {
    let words: Vec<String> = all.iter().map(T::to_string).collect();
    let found = words.iter().position(|known| known == word).map(|index| all[index]);
    found.ok_or_else(|| UnknownWord { word: word.to_owned(), known: words.join(", ") })
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.extension())
    }
}

impl fmt::Display for Up {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl fmt::Display for ColorEncoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Format {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, UnknownWord> {
        find(&Format::ALL, word)
    }
}

impl FromStr for Up {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, UnknownWord> {
        find(&Up::ALL, word)
    }
}

impl FromStr for ColorEncoding {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, UnknownWord> {
        find(&ColorEncoding::ALL, word)
    }
}
