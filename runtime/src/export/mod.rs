//! Mesh files: GLB, PLY, OBJ, STL, 3MF and USDA; contours: SVG; pictures: PNG.
//!
//! [`Format::conventions`] says for each format of meshes which axis points up in its files, how its colours
//! are written, and what it has room for; `docs/files.md` has the table, and what other programs make of it.
//! [`ExportOptions`] write it otherwise.
//!
//! The colour is the attribute named `color` with three reals, which are linear, and are clamped to 0 .. 1.
//! The uv is the attribute named `uv` with two reals, v upwards: GLB, where v goes down, gets 1 - v. Every
//! vertex has one uv, so a triangle across a seam shows the picture backwards. [`write()`] writes to
//! anything; [`save`] writes a file under a temporary name and renames it, so that nobody ever sees half a
//! file.
//!
//! A mesh may have an [origin](Mesh::origin) of its own. GLB, 3MF and USDA have it in a node, and vertices
//! as they are in the mesh; in PLY and OBJ vertices are in the world, with all digits; in STL too, but
//! rounded to f32, which [loses digits](loses_digits).

mod atomic;
mod conventions;
mod format;
mod glb;
mod obj;
mod palette;
mod parts;
mod ply;
mod png;
mod stl;
pub mod svg;
mod three_mf;
mod usda;
mod zip;

pub use atomic::{AtomicFile, WrittenFile};
pub use conventions::{ColorEncoding, Colors, Conventions, FarMeshes, LengthUnit, Up};
pub use format::{ExportOptions, Format};
pub use parts::constant_json;
pub use png::{PngEffort, write_png, write_png_with};

use std::borrow::Cow;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use jbt_ir::limits::MAX_ATTRIBUTE_WIDTH;
use jbt_ir::memory::NoMemory;
use jbt_ir::watch::{self, Stopped};
use thiserror::Error;

use crate::error::{Classified, ErrorKind};
use crate::mesh::{Attribute, Creases, Mesh};
use crate::parallel::*;
use conventions::FileChoices;
use parts::WriteError;

/// Bytes that are collected before they go to a file.
const BUFFER: usize = 1 << 18;

/// Why a mesh was not written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The extension of the path names no format.
    #[error("the name of a mesh file ends in {}, and not like {path:?}", Format::extensions())]
    Extension {
        /// The path.
        path: PathBuf,
    },
    /// The file could not be written. No temporary file is left behind.
    #[error("{path:?} cannot be written")]
    File {
        /// The path.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The writer failed.
    #[error("the mesh cannot be written")]
    Write(#[from] io::Error),
    /// The parts of the mesh do not fit each other, or a position or normal is not finite.
    #[error("the mesh is malformed: {0}")]
    Malformed(String),
    /// A token has stopped it: see [`CancelToken::watches`](crate::CancelToken::watches).
    #[error("writing the mesh was cancelled")]
    Cancelled,
    /// The memory for what files need besides the mesh is not to be had.
    #[error(transparent)]
    Memory(#[from] NoMemory),
    /// The format counts in 32 bits, and this is more.
    #[error("a {format} file holds at most {} bytes or triangles, and this one would need {size}", u32::MAX)]
    TooLarge {
        /// The format.
        format: Format,
        /// Bytes of a GLB, triangles of an STL.
        size: u64,
    },
}

impl Classified for ExportError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Extension { .. } | Self::Malformed(_) => ErrorKind::Argument,
            Self::File { .. } | Self::Write(_) => ErrorKind::System,
            Self::Cancelled => ErrorKind::Cancelled,
            Self::TooLarge { .. } | Self::Memory(_) => ErrorKind::Limit,
        }
    }
}

impl From<Stopped> for ExportError {
    fn from(_: Stopped) -> Self {
        Self::Cancelled
    }
}

/// Whether a mesh loses digits in a format: an STL has room for the world in f32 alone, whatever the origin
/// of the mesh.
#[must_use]
pub fn loses_digits(mesh: &Mesh, format: Format) -> bool {
    !mesh.is_about_world() && format.conventions().far == FarMeshes::Rounded
}

/// Writes a mesh as the readers of a format expect it.
///
/// # Errors
/// [`ExportError::Malformed`] and [`ExportError::TooLarge`] before anything is written;
/// [`ExportError::Write`] and [`ExportError::Memory`] later.
pub fn write(mesh: &Mesh, format: Format, out: &mut impl Write) -> Result<(), ExportError> {
    write_with(mesh, format, &ExportOptions::default(), out)
}

/// Writes a mesh as options say.
///
/// # Errors
/// As [`write()`].
pub fn write_with(
    mesh: &Mesh,
    format: Format,
    options: &ExportOptions,
    out: &mut impl Write,
) -> Result<(), ExportError> {
    check(mesh)?;
    watch::guarded(|| write_checked(mesh, format, options, out))?
}

/// Writes a mesh that is well formed.
fn write_checked(
    mesh: &Mesh,
    format: Format,
    options: &ExportOptions,
    out: &mut impl Write,
) -> Result<(), ExportError> {
    let mesh = &*mesh.right_handed();
    watch::go_on()?;
    let split =
        if format.conventions().splits { mesh.split_asking(&watch::go_on)? } else { Cow::Borrowed(mesh) };
    watch::go_on()?;
    let mesh = &*split;
    let choices = FileChoices::new(mesh, format, options);
    let mut out = BufWriter::with_capacity(BUFFER, out);
    format.write(mesh, choices, &mut out).map_err(|error| match error {
        WriteError::Write(error) => ExportError::Write(error),
        WriteError::TooLarge(size) => ExportError::TooLarge { format, size },
        WriteError::Cancelled => ExportError::Cancelled,
    })?;
    out.flush()?;
    Ok(())
}

/// Writes a mesh to a file, in the format that the extension names.
///
/// The file appears whole or not at all: see [`AtomicFile`].
///
/// # Errors
/// As [`write()`], with [`ExportError::File`] for whatever the system refuses, and
/// [`ExportError::Extension`].
pub fn save(path: &Path, mesh: &Mesh) -> Result<(), ExportError> {
    let format = Format::of(path).ok_or_else(|| ExportError::Extension { path: path.to_owned() })?;
    save_as(path, mesh, format)
}

/// As [`save`], in a given format.
///
/// # Errors
/// As [`save`].
pub fn save_as(path: &Path, mesh: &Mesh, format: Format) -> Result<(), ExportError> {
    save_with(path, mesh, format, &ExportOptions::default())
}

/// As [`save`], in a given format and as options say.
///
/// # Errors
/// As [`save`].
pub fn save_with(
    path: &Path,
    mesh: &Mesh,
    format: Format,
    options: &ExportOptions,
) -> Result<(), ExportError> {
    check(mesh)?;
    let at_path = |source| ExportError::File { path: path.to_owned(), source };
    let located = |error| match error {
        ExportError::Write(source) => at_path(source),
        other @ (ExportError::Extension { .. }
        | ExportError::File { .. }
        | ExportError::Malformed(_)
        | ExportError::Cancelled
        | ExportError::Memory(_)
        | ExportError::TooLarge { .. }) => other,
    };
    let mut file = AtomicFile::create(path, true).map_err(at_path)?;
    write_with(mesh, format, options, &mut file).map_err(located)?;
    file.finish().map_err(at_path)
}

/// Checks what every writer relies on.
fn check(mesh: &Mesh) -> Result<(), ExportError> {
    let malformed = |what: String| Err(ExportError::Malformed(what));
    let count = mesh.positions.len();
    if count > u32::MAX as usize {
        return malformed(format!("{count} vertices cannot be numbered in 32 bits"));
    }
    if mesh.normals.len() != count {
        return malformed(format!("{count} positions and {} normals", mesh.normals.len()));
    }
    for Attribute { name, width, values } in &mesh.attributes {
        if !(1..=MAX_ATTRIBUTE_WIDTH).contains(width) {
            return malformed(format!(
                "the attribute {name:?} has {width} reals; 1 to {MAX_ATTRIBUTE_WIDTH} are allowed"
            ));
        }
        if values.len() != width * count {
            let found = values.len();
            return malformed(format!(
                "the attribute {name:?} has {found} reals for {count} vertices of {width}"
            ));
        }
    }
    let is_missing = |triangle: &[u32; 3]| triangle.iter().any(|&vertex| vertex as usize >= count);
    if let Some(index) = first(&mesh.triangles, is_missing)? {
        return malformed(format!("triangle {index} names a vertex that does not exist"));
    }
    let is_endless = |numbers: &[f32; 3]| !numbers.iter().all(|number| number.is_finite());
    if let Some(index) = first(&mesh.positions, is_endless)? {
        return malformed(format!("the position of vertex {index} is not finite"));
    }
    if let Some(index) = first(&mesh.normals, is_endless)? {
        return malformed(format!("the normal of vertex {index} is not finite"));
    }
    check_creases(mesh)?.map_or(Ok(()), malformed)
}

/// What is wrong with the creases of a mesh.
fn check_creases(mesh: &Mesh) -> Result<Option<String>, Stopped> {
    let Creases { vertices, normals, attributes, corners } = &mesh.creases;
    let (sides, count) = (vertices.len(), mesh.positions.len());
    if normals.len() != sides {
        return Ok(Some(format!("{sides} sides of creases and {} normals", normals.len())));
    }
    let widths = mesh.attributes.iter().map(|attribute| attribute.width * sides);
    if !corners.is_empty() && !attributes.iter().map(Vec::len).eq(widths) {
        return Ok(Some("the attributes of creases are not those of the mesh".to_owned()));
    }
    if let Some(side) = first(vertices, |&vertex| vertex as usize >= count)? {
        return Ok(Some(format!("side {side} of a crease names a vertex that does not exist")));
    }
    if let Some(side) = first(normals, |normal| !normal.iter().all(|number| number.is_finite()))? {
        return Ok(Some(format!("the normal of side {side} of a crease is not finite")));
    }
    let is_missing = |&[corner, side]: &[u32; 2]| {
        let vertex = mesh.triangles.get(corner as usize / 3).map(|triangle| triangle[corner as usize % 3]);
        vertex.is_none() || vertices.get(side as usize).copied() != vertex
    };
    let corner = first(corners, is_missing)?;
    Ok(corner.map(|corner| format!("corner {corner} of a crease is not at the vertex of its side")))
}

/// The index of the first item with a property.
fn first<T: Sync>(items: &[T], has: impl Fn(&T) -> bool + Sync) -> Result<Option<usize>, Stopped> {
    const PART: usize = 1 << 14;
    let found = |part: &[T]| watch::go_on().map(|()| part.iter().position(&has));
    let parts: Result<Vec<Option<usize>>, Stopped> =
        scatter(|watches| items.par_chunks(PART).map(|part| watches.hold(|| found(part))).collect());
    Ok(parts?.into_iter().enumerate().find_map(|(part, place)| Some(part * PART + place?)))
}

#[cfg(test)]
mod tests;
