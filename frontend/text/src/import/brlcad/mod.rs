//! BRL-CAD databases: named solids, combinations of them with matrices, regions and colours.
//!
//! ```text
//! .g     binary, version 5                        records of bytes                  binary.rs
//! .asc   text, version 5                          commands of Tcl                   text.rs
//! .asc   text, version 4                          lines of one object each          lines.rs
//!                                                        v
//!                                     objects: solids, combinations                 database.rs
//!                                                        v
//!        a tree of sets of points: each object once, an affine map a use            build.rs
//! ```
//!
//! A solid is a set of points, and its leaf is exactly that set (`leaf.rs`). Combinations become unions,
//! intersections, differences and symmetric differences. All lengths are millimetres, whatever unit a file
//! shows to people.
//!
//! A matrix acts on points here. BRL-CAD applies it to parameters, so that radii of tori, pipes and the like
//! follow the last entry of a matrix and no other; where that differs, a warning says so.

mod binary;
mod build;
mod database;
mod leaf;
mod lines;
mod operand;
mod solid;
mod tcl;
#[cfg(test)]
mod tests;
mod text;
mod text_tree;

use jbt_model::diagnostic::{Diagnostic, Diagnostics, Span};
use jbt_model::model::Model;

use self::database::Database;
use self::tcl::Words;
use super::Imported;
use super::format::SceneFormatRow;
use crate::Options;

pub(crate) const FORMAT: SceneFormatRow = SceneFormatRow {
    recognizes: |bytes| DatabaseKind::of(bytes).is_some(),
    has_objects: true,
    ..SceneFormatRow::new(&["g", "asc"], "a BRL-CAD database", brlcad)
};

/// How a database is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum DatabaseKind {
    Binary,
    /// Binary of version 4, which is not read.
    OldBinary,
    Text,
    OldText,
}

impl DatabaseKind {
    /// By the first bytes.
    fn of(bytes: &[u8]) -> Option<Self> {
        let words =
            || bytes.split(|byte| byte.is_ascii_whitespace() || *byte == 0).filter(|word| !word.is_empty());
        match words().next()? {
            _ if bytes.starts_with(&binary::HEADER) => Some(Self::Binary),
            lines::FIRST_WORD if words().nth(2).is_some_and(|word| word.starts_with(b"v")) => {
                Some(Self::OldText)
            }
            _ if first_command(bytes).is_some_and(is_known) => Some(Self::Text),
            // A version 4 record: the letter, a unit, and the version.
            _ if bytes.first() == Some(&b'I') && bytes.get(2..4) == Some(b"v4") => Some(Self::OldBinary),
            _ => None,
        }
    }
}

/// Whether a text of version 5 may begin with a command.
fn is_known(command: &[u8]) -> bool {
    matches!(command, b"title" | b"units" | b"put" | b"attr" | b"color")
}

/// The first word of a text after its comments.
fn first_command(bytes: &[u8]) -> Option<&[u8]> {
    let mut words = Words::commands(bytes);
    let word = if words.next_command() { words.next().ok()?? } else { return None };
    bytes.get(word.start as usize..word.end as usize)
}

/// The model of a BRL-CAD database (`.g` of version 5, `.asc` of versions 4 and 5): of the object that
/// `options` name, or of all that no other object refers to.
///
/// # Errors
///
/// All errors of the file, with their places: records and lists that do not fit, numbers that are none,
/// objects that contain themselves, a name that no object has, and a file without solids. What is left out
/// for want of a counterpart, as meshes, is a warning with its path.
pub fn brlcad(bytes: &[u8], options: &Options) -> Result<Imported, Diagnostics> {
    Imported::from(bytes, read(bytes, options))
}

fn read(bytes: &[u8], options: &Options) -> Result<(Model, Vec<Diagnostic>), Vec<Diagnostic>> {
    let mut database = database(bytes)?;
    let root = build::build(&mut database, options.object.as_deref());
    match root {
        Some(root) if database.errors.is_empty() => Ok((Model::new(root), database.warnings.finish())),
        _ => Err([database.errors.finish(), database.warnings.finish()].concat()),
    }
}

/// All objects of a file.
fn database(bytes: &[u8]) -> Result<Database<'_>, Vec<Diagnostic>> {
    let mut database = Database::new(bytes);
    let start = Span::new(0, bytes.len().min(1));
    match DatabaseKind::of(bytes) {
        Some(DatabaseKind::Binary) => binary::read(&mut database, bytes),
        Some(DatabaseKind::Text) => text::read(&mut database, bytes),
        Some(DatabaseKind::OldText) => lines::read(&mut database, bytes),
        Some(DatabaseKind::OldBinary) => {
            let error = Diagnostic::error(Some(start), "this is a binary database of version 4");
            return Err(vec![error.expected("BRL-CAD's dbupgrade makes one of version 5, g2asc a text")]);
        }
        None => {
            let error = Diagnostic::error(Some(start), "this is no BRL-CAD database");
            return Err(vec![error.expected("expected a .g file of version 5, or a text of g2asc")]);
        }
    }
    if database.errors.is_empty() { Ok(database) } else { Err(database.errors.finish()) }
}
