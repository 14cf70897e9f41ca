//! A file for each part: `jbt mesh robot.jbt --parts -o 'robot_{}.stl'`.
//!
//! The name of the part takes the place of the braces, as far as every file system takes it. All files are
//! written before the first one takes its place: one that cannot be written leaves the others as they were.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::path::Path;

use jbt::CheckedTree;
use jbt::export::{self, ExportError, ExportOptions, Format};
use jbt::mesh::Mesh;

use crate::failure::Failure;
use crate::output::{Destination, Output, check_place};
use crate::sequence::BRACES;

/// The longest name of a part in the name of a file, in bytes: file systems take 255 for all of it.
const LONGEST: usize = 120;

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
    let mut destinations = Vec::with_capacity(names.len());
    for name in names {
        let path = template.path.with_file_name(file.replace(BRACES, &name));
        check_place(&path)?;
        let is_scene = || Some(path.canonicalize().ok()? == scene.canonicalize().ok()?);
        if is_scene() == Some(true) {
            let name = path.display();
            return Err(Failure::Usage(format!("{name} is the scene itself, and a part would replace it")));
        }
        destinations.push(Destination { path, kind: template.kind, replace: template.replace });
    }
    Ok(destinations)
}

/// Writes each piece of a mesh to its place. An error comes with that of the file.
pub fn write(
    mesh: &Mesh,
    format: Format,
    options: &ExportOptions,
    outputs: &mut [Output],
) -> Result<(), (usize, ExportError)> {
    let pieces = mesh.pieces();
    for (place, (output, piece)) in outputs.iter_mut().zip(&pieces).enumerate() {
        let constants = options.constants.get(place).cloned().into_iter().collect();
        let name = piece.name.map(str::to_owned);
        let options = ExportOptions { name, constants, ..options.clone() };
        export::write_with(&mesh.piece(piece), format, &options, output).map_err(|error| (place, error))?;
    }
    Ok(())
}

/// Names of parts as names of files, each another one, also where upper case and lower case are one.
fn file_names<'a>(parts: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut names = Vec::new();
    for part in parts {
        let first = file_name(part);
        let numbered = |number: usize| if number == 1 { first.clone() } else { format!("{first}-{number}") };
        let free = (1..).map(numbered).find(|name| taken.insert(name.to_lowercase()));
        names.extend(free);
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
    }
}
