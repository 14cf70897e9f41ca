//! The kinds of files that commands write: a table for each command, in which a kind is a row. Help, defaults
//! and messages derive from it.
//!
//! ```text
//! mesh      .glb .ply .obj .stl        the first one is written where nothing says which
//! render    .png
//! contour   .svg .png
//! sample    .npy .vdb
//! eval      .csv
//! convert   .jbt
//! ```

use std::fmt::Debug;
use std::path::Path;

use jbt::export::Format;

/// The kinds of files that one command writes.
pub trait FileKind: Copy + Debug + Send + Sync + 'static {
    /// What a file of them holds, with its article.
    const RESULT: &'static str;
    /// The table. Its first row counts where nothing says what to write.
    const ROWS: &'static [FormatRow<Self>];
}

/// A kind of file.
#[derive(Clone, Copy, Debug)]
pub struct FormatRow<K> {
    /// What is written.
    pub kind: K,
    /// How names of its files end, without the dot; also the word of `--format`.
    pub extension: &'static str,
    /// What such a file holds.
    pub about: &'static str,
}

const fn row<K: Copy>(kind: K, extension: &'static str, about: &'static str) -> FormatRow<K> {
    FormatRow { kind, extension, about }
}

impl FileKind for Format {
    const RESULT: &'static str = "a mesh";
    const ROWS: &'static [FormatRow<Self>] = &{
        let mut rows = [row(Self::ALL[0], "", ""); Self::ALL.len()];
        let mut index = 0;
        while index < rows.len() {
            let format = Self::ALL[index];
            rows[index] = row(format, format.extension(), format.conventions().title);
            index += 1;
        }
        rows
    };
}

/// What `jbt render` writes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PictureKind {
    /// Portable Network Graphics.
    Png,
}

impl FileKind for PictureKind {
    const RESULT: &'static str = "a picture";
    const ROWS: &'static [FormatRow<Self>] = &[row(Self::Png, "png", "An image")];
}

/// What `jbt contour` writes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SliceKind {
    /// Lines.
    Svg,
    /// Pixels.
    Png,
}

impl FileKind for SliceKind {
    const RESULT: &'static str = "a slice";
    const ROWS: &'static [FormatRow<Self>] =
        &[row(Self::Svg, "svg", "The contour as a drawing"), row(Self::Png, "png", "The slice as an image")];
}

/// What `jbt sample` writes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ArrayKind {
    /// An array of numpy.
    Npy,
    /// A sparse volume of OpenVDB.
    Vdb,
}

impl FileKind for ArrayKind {
    const RESULT: &'static str = "an array";
    const ROWS: &'static [FormatRow<Self>] = &[
        row(Self::Npy, "npy", "An array for numpy"),
        row(Self::Vdb, "vdb", "A sparse volume of OpenVDB: points where the field is not 0"),
    ];
}

/// What `jbt eval` writes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TableKind {
    /// Values with commas between.
    Csv,
}

impl FileKind for TableKind {
    const RESULT: &'static str = "a table";
    const ROWS: &'static [FormatRow<Self>] = &[row(Self::Csv, "csv", "A table with a header")];
}

/// What `jbt convert` writes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TextKind {
    /// The text format of this project.
    Jbt,
}

impl FileKind for TextKind {
    const RESULT: &'static str = "a text";
    const ROWS: &'static [FormatRow<Self>] = &[row(Self::Jbt, "jbt", "A model as text")];
}

/// The row that counts where nothing says which.
pub fn first<K: FileKind>() -> &'static FormatRow<K> {
    &K::ROWS[0]
}

/// The row that a word of `--format` means.
pub fn named<K: FileKind>(word: &str) -> Option<&'static FormatRow<K>> {
    K::ROWS.iter().find(|row| row.extension == word)
}

/// The row that the end of a path names, in any case.
pub fn of_path<K: FileKind>(path: &Path) -> Option<&'static FormatRow<K>> {
    let extension = path.extension()?;
    K::ROWS.iter().find(|row| extension.eq_ignore_ascii_case(row.extension))
}

/// All endings in words, each behind `before`: `.glb, .ply, .obj or .stl`.
pub fn listed<K: FileKind>(before: &str) -> String {
    let all: Vec<String> = K::ROWS.iter().map(|row| format!("{before}{}", row.extension)).collect();
    match all.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_by_word_and_by_path() {
        let kind = |row: Option<&FormatRow<SliceKind>>| row.map(|row| row.kind);
        assert_eq!(kind(named("png")), Some(SliceKind::Png));
        assert_eq!(kind(named("jpg")), None);
        assert_eq!(kind(of_path(Path::new("a.b.SVG"))), Some(SliceKind::Svg));
        assert_eq!(kind(of_path(Path::new("svg"))), None);
        assert!(listed::<Format>(".").starts_with(".glb, .ply, .obj, .stl"));
        assert_eq!(listed::<Format>(".").matches(" or ").count(), 1);
        assert_eq!(listed::<SliceKind>(""), "svg or png");
        assert_eq!(listed::<PictureKind>("."), ".png");
    }
}
