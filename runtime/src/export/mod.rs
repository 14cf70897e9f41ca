//! Mesh files: GLB, PLY, OBJ and STL; contours: SVG; pictures: PNG.
//!
//! [`Format::conventions`] says for each format of meshes which axis points up in its files, how its colours are written, and what it
//! has room for; `docs/files.md` has the table, and what other programs make of it. [`ExportOptions`] write it otherwise.
//!
//! The colour is the attribute named `color` with three reals, which are linear, and are clamped to 0 .. 1. The uv is the attribute
//! named `uv` with two reals, v upwards: GLB, where v goes down, gets 1 - v. Every vertex has one uv, so a triangle across a seam shows
//! the picture backwards. [`write()`] writes to anything; [`save`] writes a file under a temporary name and renames it, so that nobody
//! ever sees half a file.
//!
//! A mesh may have an [origin](Mesh::origin) of its own. GLB has it in its node, and vertices as they are in
//! the mesh; in PLY and OBJ vertices are in the world, with all digits; in STL too, but rounded to f32, which
//! [loses digits](loses_digits).

mod conventions;
mod format;
mod glb;
mod obj;
mod parts;
mod ply;
mod png;
mod stl;
pub mod svg;

pub use conventions::{ColorEncoding, Colors, Conventions, FarMeshes, UnknownWord, Up};
pub use format::{ExportOptions, Format};
pub use png::write_png;

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use jbt_ir::limits::MAX_ATTRIBUTE_WIDTH;
use tempfile::NamedTempFile;
use thiserror::Error;

use crate::mesh::{Attribute, Mesh};
use conventions::Choices;
pub(crate) use conventions::find;
use parts::WriteError;

/// Bytes that are collected before they go to a file.
const BUFFER: usize = 1 << 18;

/// Why a mesh was not written.
#[derive(Debug, Error)]
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
    /// The format counts in 32 bits, and this is more.
    #[error("a {format} file holds at most {} bytes or triangles, and this one would need {size}", u32::MAX)]
    TooLarge {
        /// The format.
        format: Format,
        /// Bytes of a GLB, triangles of an STL.
        size: u64,
    },
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
/// [`ExportError::Malformed`] and [`ExportError::TooLarge`] before anything is written; [`ExportError::Write`] later.
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
    let choices = Choices::new(format, options);
    let mut out = BufWriter::with_capacity(BUFFER, out);
    format.write(mesh, choices, &mut out).map_err(|error| match error {
        WriteError::Write(error) => ExportError::Write(error),
        WriteError::TooLarge(size) => ExportError::TooLarge { format, size },
    })?;
    out.flush()?;
    Ok(())
}

/// Writes a mesh to a file, in the format that the extension names.
///
/// The file appears whole or not at all: it is written beside its place under a temporary name and then renamed. A file that is
/// there already is replaced and keeps its permissions; a new one gets those that files usually get. A link is followed. What is not a
/// file but can be written to (a pipe, a device) is written to.
///
/// # Errors
/// As [`write()`], with [`ExportError::File`] for whatever the system refuses, and [`ExportError::Extension`].
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
        | ExportError::TooLarge { .. }) => other,
    };
    // The file itself is replaced, and not a link to it.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let existing = match fs::metadata(&target) {
        Ok(existing) => Some(existing),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(at_path(error)),
    };
    if existing.as_ref().is_some_and(|existing| !existing.is_file()) {
        let mut out = fs::OpenOptions::new().write(true).open(&target).map_err(at_path)?;
        return write_with(mesh, format, options, &mut out).map_err(located);
    }
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        Some(_) | None => Path::new("."),
    };
    let mut file = temporary(folder).map_err(at_path)?;
    write_with(mesh, format, options, file.as_file_mut()).map_err(located)?;
    if let Some(existing) = existing {
        file.as_file().set_permissions(existing.permissions()).map_err(at_path)?;
    }
    // Dropping the temporary file, also when this fails, removes it.
    file.persist(&target).map_err(|error| at_path(error.error))?;
    Ok(())
}

/// A temporary file with the permissions of an ordinary new one.
fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".jbt-").suffix(".tmp");
    // The system's own words about a file that cannot be made: the temporary name means nothing to anybody.
    builder.make_in(folder, |path| fs::File::options().read(true).write(true).create_new(true).open(path))
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
    if let Some(triangle) = mesh.triangles.iter().flatten().position(|&vertex| vertex as usize >= count) {
        return malformed(format!("triangle {} names a vertex that does not exist", triangle / 3));
    }
    if let Some(index) = mesh.positions.iter().flatten().position(|c| !c.is_finite()) {
        return malformed(format!("the position of vertex {} is not finite", index / 3));
    }
    if let Some(index) = mesh.normals.iter().flatten().position(|c| !c.is_finite()) {
        return malformed(format!("the normal of vertex {} is not finite", index / 3));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
