//! Where commands write their results: the name, or what it is when nobody gives one, and the kind of file.

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

use crate::failure::Failure;
use crate::formats::{FileKind, FormatRow, first, listed, named, of_path};
use crate::output::{Destination, check_place};
use crate::standard::is_standard;

/// Where the result goes, and as what.
#[derive(Args, Debug)]
pub struct OutputArguments<K: FileKind> {
    #[arg(short, long, value_name = "OUT", help = output_help::<K>())]
    pub output: Option<PathBuf>,
    /// The kind of file, if the name does not say it
    #[arg(long, value_parser = kinds::<K>())]
    pub format: Option<&'static FormatRow<K>>,
    /// Replace a file that is there already, also without -o
    #[arg(long)]
    pub force: bool,
}

impl<K: FileKind> OutputArguments<K> {
    /// Where the result for a scene goes. A place that cannot be written to is refused here, before any work
    /// is done.
    pub fn destination(&self, scene: &Path) -> Result<Destination<K>, Failure> {
        let destination = match &self.output {
            Some(path) => Destination { path: path.clone(), kind: self.kind(path)?, replace: true },
            None => self.named_after(scene)?,
        };
        check_place(&destination.path)?;
        let same = |scene: PathBuf| destination.path.canonicalize().is_ok_and(|path| path == scene);
        if !is_standard(scene) && scene.canonicalize().is_ok_and(same) {
            let name = destination.path.display();
            return Err(Failure::Usage(format!(
                "{name} is the scene itself, and {} would replace it",
                K::RESULT
            )));
        }
        Ok(destination)
    }

    /// The kind of a file that has been named.
    fn kind(&self, path: &Path) -> Result<K, Failure> {
        let only = match K::ROWS {
            [only] if is_standard(path) => Some(only),
            _ => None,
        };
        let row = self.format.or(only).or_else(|| of_path(path));
        row.map(|row| row.kind).ok_or_else(|| {
            Failure::Usage(if is_standard(path) {
                format!("{} on the standard output needs --format {}", K::RESULT, listed::<K>(""))
            } else {
                let name = path.display();
                let endings = listed::<K>(".");
                format!("{name} does not end with {endings}; --format says what to write under such a name")
            })
        })
    }

    /// The file in the current folder that is called like the scene.
    fn named_after(&self, scene: &Path) -> Result<Destination<K>, Failure> {
        if scene.is_dir() {
            return Err(Failure::io("read", scene.display(), io::ErrorKind::IsADirectory.into()));
        }
        let Some(stem) = scene.file_stem().filter(|_| !is_standard(scene)) else {
            let what = K::RESULT;
            let message = format!("{what} of a scene without a name needs -o; -o - is the standard output");
            return Err(Failure::Usage(message));
        };
        let row = self.format.unwrap_or(first());
        let mut name = stem.to_owned();
        name.push(".");
        name.push(row.extension);
        let path = PathBuf::from(name);
        if !self.force && path.symlink_metadata().is_ok() {
            let name = path.display();
            return Err(Failure::Usage(format!("{name} is there already; -o {name} or --force replaces it")));
        }
        Ok(Destination { path, kind: row.kind, replace: self.force })
    }
}

/// What `--help` says about the file.
fn output_help<K: FileKind>() -> String {
    let (endings, default) = (listed::<K>("."), first::<K>().extension);
    let need = if K::ROWS.len() > 1 { " and needs --format" } else { "" };
    format!(
        "The {endings} file to write; `-` is the standard output{need} \
         [default: the scene's name with .{default}, in the current folder]"
    )
}

/// The words of `--format`.
fn kinds<K: FileKind>() -> impl TypedValueParser<Value = &'static FormatRow<K>> {
    let words = K::ROWS.iter().map(|row| PossibleValue::new(row.extension).help(row.about));
    // The parser lets the words of the table through, and no others.
    PossibleValuesParser::new(words).map(|word| named(&word).unwrap_or(first()))
}
