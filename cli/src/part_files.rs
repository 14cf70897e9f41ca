//! A file for each part: `jbt mesh robot.jbt --parts -o 'robot_{}.stl'`.
//!
//! The name of the part takes the place of the braces, as far as every file system takes it. All files are
//! written before the first one takes its place: one that cannot be written leaves the others as they were.
//! All are open until then, so that a kill leaves none of them; if they are more than the process may have
//! open, they have temporary names meanwhile.

use std::collections::{HashMap, HashSet};
use std::ffi::OsStr;
use std::path::Path;

use jbt::CheckedTree;
use jbt::export::{self, ExportError, ExportOptions, Format};
use jbt::mesh::Mesh;

use crate::failure::Failure;
use crate::output::{Destination, Output, WrittenOutput, check_place};
use crate::sequence::BRACES;

/// The longest name of a part in the name of a file, in bytes: file systems take 255 for all of it.
const LONGEST: usize = 120;

/// Files that this program has open besides.
const OTHERS: usize = 64;

/// Names that stand for devices on Windows, whatever follows behind a point.
const DEVICES: [&str; 4] = ["con", "prn", "aux", "nul"];

/// Refuses a name of files that has no place for the name of a part.
pub fn check(output: Option<&Path>) -> Result<(), Failure> {
    let name = output.and_then(Path::file_name).and_then(OsStr::to_str).unwrap_or_default();
    if name.contains(BRACES) {
        return Ok(());
    }
    Err(Failure::Usage(format!(
        "--parts needs {BRACES} in the name of -o, for the name of a part: 'robot_{BRACES}.stl'"
    )))
}

/// Where the parts of a model go, in their order.
pub fn destinations(
    template: &Destination<Format>,
    scene: &Path,
    tree: &CheckedTree,
) -> Result<Vec<Destination<Format>>, Failure> {
    let parts = tree.parts();
    if parts.is_empty() {
        return Err(Failure::Usage("--parts needs a scene of parts: part \"NAME\" { .. }".to_owned()));
    }
    let file = template.path.file_name().and_then(OsStr::to_str).unwrap_or_default();
    let names = file_names(parts.iter().map(|part| part.name));
    let scene = scene.canonicalize().ok();
    let mut destinations = Vec::with_capacity(names.len());
    for name in names {
        let path = template.path.with_file_name(file.replace(BRACES, &name));
        check_place(&path)?;
        if scene.is_some() && path.canonicalize().ok() == scene {
            let name = path.display();
            return Err(Failure::Usage(format!("{name} is the scene itself, and a part would replace it")));
        }
        destinations.push(Destination { path, kind: template.kind, replace: template.replace });
    }
    Ok(destinations)
}

/// Why a mesh was not written.
pub enum MeshFileError {
    /// Its file cannot be had.
    Output(Failure),
    /// The format does not take it.
    Export(ExportError),
}

/// Writes a mesh to a file that is not in its place yet.
pub fn write(
    mesh: &Mesh,
    destination: &Destination<Format>,
    options: &ExportOptions,
) -> Result<WrittenOutput, MeshFileError> {
    write_to(Output::open(destination).map_err(MeshFileError::Output)?, mesh, destination.kind, options)
}

/// Writes each piece of a mesh to a file that is not in its place yet.
pub fn write_parts(
    mesh: &Mesh,
    options: &ExportOptions,
    places: &[Destination<Format>],
) -> Result<Vec<WrittenOutput>, MeshFileError> {
    let pieces = mesh.pieces();
    let many = places.len() > most_open();
    let mut written = Vec::with_capacity(places.len());
    for (place, (destination, piece)) in places.iter().zip(&pieces).enumerate() {
        let output = if many { Output::open_one_of_many(destination) } else { Output::open(destination) };
        let constants = options.constants.get(place).cloned().into_iter().collect();
        let options = ExportOptions { name: piece.name.map(str::to_owned), constants, ..options.clone() };
        let output = output.map_err(MeshFileError::Output)?;
        written.push(write_to(output, &mesh.piece(piece), destination.kind, &options)?);
    }
    Ok(written)
}

/// Files of parts that may be open at once. Systems let a process have few, and more if it asks.
#[cfg(unix)]
fn most_open() -> usize {
    use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    let raised = setrlimit(Resource::Nofile, Rlimit { current: maximum, maximum });
    let limit = if raised.is_ok() { maximum } else { current };
    limit.map_or(usize::MAX, |limit| usize::try_from(limit).unwrap_or(usize::MAX)).saturating_sub(OTHERS)
}

/// Files of parts that may be open at once: as many as any system has for a process.
#[cfg(not(unix))]
fn most_open() -> usize {
    256 - OTHERS
}

fn write_to(
    mut output: Output,
    mesh: &Mesh,
    format: Format,
    options: &ExportOptions,
) -> Result<WrittenOutput, MeshFileError> {
    match export::write_with(mesh, format, options, &mut output) {
        Ok(()) => output.close().map_err(MeshFileError::Output),
        Err(ExportError::Write(error)) => Err(MeshFileError::Output(output.failure(error))),
        Err(error) => Err(MeshFileError::Export(error)),
    }
}

/// Names of parts as names of files, each another one, also where upper case and lower case are one.
fn file_names<'a>(parts: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = HashSet::new();
    // Of each name, the number from which others may be free.
    let mut next: HashMap<String, usize> = HashMap::new();
    let mut names = Vec::new();
    for part in parts {
        let first = file_name(part);
        let number = next.entry(first.to_lowercase()).or_insert(1);
        let name = loop {
            let name = if *number == 1 { first.clone() } else { format!("{first}-{number}") };
            *number += 1;
            if taken.insert(name.to_lowercase()) {
                break name;
            }
        };
        names.push(name);
    }
    names
}

/// A name of letters, digits, `_`, `-` and points, none of them first or last; others become `_`.
fn file_name(part: &str) -> String {
    let safe = |c: char| if c.is_alphanumeric() || "_-.".contains(c) { c } else { '_' };
    let mut name: String = part.trim().chars().map(safe).collect();
    name.truncate(name.floor_char_boundary(LONGEST));
    let name = name.trim_matches('.');
    let stem = name.split('.').next().unwrap_or_default().to_lowercase();
    let is_port = ["com", "lpt"].iter().any(|port| {
        stem.strip_prefix(port)
            .is_some_and(|rest| rest.len() == 1 && rest.bytes().all(|b| b.is_ascii_digit()))
    });
    if name.is_empty() || is_port || DEVICES.contains(&stem.as_str()) {
        return format!("_{name}");
    }
    name.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_parts_become_names_of_files() {
        for (part, expected) in [
            ("hub", "hub"),
            ("left arm", "left_arm"),
            ("колесо 2", "колесо_2"),
            ("../../etc/passwd", "_.._etc_passwd"),
            ("a/b\\c:d*e?f|g<h>i", "a_b_c_d_e_f_g_h_i"),
            ("..", "_"),
            ("", "_"),
            ("CON", "_CON"),
            ("com1.x", "_com1.x"),
            ("com10", "com10"),
            ("-rf", "-rf"),
        ] {
            assert_eq!(file_name(part), expected, "{part}");
        }
        assert!(file_name(&"ж".repeat(1000)).len() <= LONGEST);
        let names = ["a b", "a_b", "A_B", "a_b-2", "c"];
        assert_eq!(file_names(names.into_iter()), ["a_b", "a_b-2", "A_B-3", "a_b-2-2", "c"]);
        // In time that grows with their number alone.
        let many: Vec<String> = (0..60_000).map(|index| format!("{}{index}", "x".repeat(LONGEST))).collect();
        let names = file_names(many.iter().map(String::as_str));
        assert_eq!(names.iter().collect::<HashSet<_>>().len(), many.len());
        assert!(names[59_999].ends_with("x-60000"));
    }
}
