//! What formats of mesh files differ in: how files end, which axis points up, how colours are written, what
//! there is room for.

use std::fmt;
use std::num::NonZeroU16;
use std::ops::Sub;
use std::str::FromStr;

use jbt_model::constant::ConstantValues;
use jbt_model::orientation::ModelUp;

use crate::srgb;
use crate::word::{UnknownWord, find};

/// What a format is like: what its file in this folder states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conventions {
    /// The extension of its files, without a dot, in small letters.
    pub extension: &'static str,
    /// What it is.
    pub title: &'static str,
    /// The axis that points up, unless [`ExportOptions::up`](super::ExportOptions::up) says otherwise: the
    /// one that its readers assume.
    pub up: Up,
    /// How it has normals.
    pub normals: &'static str,
    /// How it has colours, if it has any.
    pub colors: Option<Colors>,
    /// How it has the uv, if it has.
    pub uv: Option<&'static str>,
    /// How it has other attributes, if it has any.
    pub attributes: Option<&'static str>,
    /// How it has the name of a mesh, if it has.
    pub name: Option<&'static str>,
    /// How it has the constants of the leaves of a mesh, if it has.
    pub constants: Option<&'static str>,
    /// How it has the place of a mesh that is far from the origin of the world.
    pub far: FarMeshes,
    /// Whether a vertex on an edge of the surface is there once for each side, because a vertex has one
    /// normal. Else positions are shared, and corners have normals of their own or none.
    pub splits: bool,
    /// Whether a file may have materials, each triangle of one, in place of colours.
    pub materials: bool,
    /// The unit of lengths that a file states, unless [`ExportOptions::unit`](super::ExportOptions::unit)
    /// says otherwise; `None` if it states none.
    pub unit: Option<LengthUnit>,
}

/// What a unit of a scene is, in a file that says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum LengthUnit {
    /// 10^-6 m.
    Micrometre,
    /// 10^-3 m.
    Millimetre,
    /// 10^-2 m.
    Centimetre,
    /// 0.0254 m.
    Inch,
    /// 0.3048 m.
    Foot,
    /// The unit of SI.
    Metre,
}

impl LengthUnit {
    /// All, the smallest first.
    pub const ALL: [Self; 6] =
        [Self::Micrometre, Self::Millimetre, Self::Centimetre, Self::Inch, Self::Foot, Self::Metre];

    /// The unit as a word: `um`, `mm`, `cm`, `in`, `ft` or `m`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Micrometre => "um",
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Inch => "in",
            Self::Foot => "ft",
            Self::Metre => "m",
        }
    }

    /// How many metres it is.
    #[must_use]
    pub const fn metres(self) -> f64 {
        match self {
            Self::Micrometre => 1e-6,
            Self::Millimetre => 1e-3,
            Self::Centimetre => 1e-2,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
            Self::Metre => 1.0,
        }
    }
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
    /// What the numbers mean, unless [`ExportOptions::colors`](super::ExportOptions::colors) says otherwise:
    /// what its readers assume.
    pub encoding: ColorEncoding,
}

/// Which axis of a file points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Up {
    /// A model with z up is turned by -90 degrees about x: its (x, y, z) is (x, z, -y) in the file. The
    /// model's -y is the file's +z.
    Y,
    /// As in a model with z up.
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

    /// Where a point of a model with z up, or a direction, is in a file.
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
    /// As screens take them, in even steps for the eye (sRGB, IEC 61966-2-1): half the light is 0.735, or 188
    /// of 255.
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

    /// The number of a file, 0 .. 1, for one channel of a model. What is no number is 0, and others are
    /// clamped.
    #[must_use]
    pub fn encode(self, linear: f32) -> f32 {
        match self {
            ColorEncoding::Srgb => srgb::encode_precisely(linear),
            ColorEncoding::Linear => srgb::unit(linear),
        }
    }
}

/// What a file is like: what options say, else the conventions of its format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FileChoices<'a> {
    pub up: Up,
    /// The axis of the model that points up.
    pub model: ModelUp,
    /// Any, where there are no colours.
    pub colors: ColorEncoding,
    /// Any, where a file states no unit.
    pub unit: LengthUnit,
    /// The most materials, in a format that has any.
    pub palette: Option<NonZeroU16>,
    /// What the mesh is called, where the format has a place for it.
    pub name: Option<&'a str>,
    /// The constants of the leaves of each piece of the mesh.
    pub constants: &'a [Vec<ConstantValues>],
}

impl<'a> FileChoices<'a> {
    /// The constants of the leaves of a piece, by its place.
    pub fn constants_of(self, piece: usize) -> &'a [ConstantValues] {
        self.constants.get(piece).map_or(&[], Vec::as_slice)
    }

    /// Where a point of the model, or a direction, is in the file.
    pub fn place<T: Default + Sub<Output = T>>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        match (self.model, self.up) {
            (ModelUp::Z, up) => up.place([x, y, z]),
            (ModelUp::Y, Up::Y) => [x, y, z],
            (ModelUp::Y, Up::Z) => [x, T::default() - z, y],
        }
    }
}

impl fmt::Display for Up {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for LengthUnit {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, UnknownWord> {
        find(&LengthUnit::ALL, word)
    }
}

impl fmt::Display for ColorEncoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
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

#[cfg(test)]
mod tests;
