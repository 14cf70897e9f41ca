//! One word, one type name: a name that several files define is in a list, with the reason.

use std::collections::{BTreeMap, BTreeSet};

use crate::lengths::lines;
use crate::{CRATES, root, sources};

/// Contestants of the benches restate models in their own words, each for itself.
const APART: [&str; 3] = ["benches/src/limit", "benches/src/naive", "benches/src/peers"];

/// Names that more than one file defines, and the most files of each; by reason.
#[rustfmt::skip]
const SHARED: [(&str, &[(&str, usize)]); 5] = [
    ("The door of a package, and what the package below calls so.", &[
        ("CompileError", 2), ("Compiler", 2), ("Kernel", 2), ("Lowered", 2), ("Lowering", 2), ("Options", 3),
    ]),
    ("Text of models and text of programs are read and written alike.", &[
        ("Lexer", 2), ("Parser", 2), ("Printer", 2), ("Token", 2),
    ]),
    ("A member of an open set is called as its file; the list of its family tells which one it is.", &[
        ("Clamp", 2), ("Cone", 2), ("Rectangle", 2), ("Sign", 2), ("Step", 4),
    ]),
    ("A word of the model, and what of it selects code.", &[
        ("MapKind", 2), ("Operator", 2),
    ]),
    ("One thing in each of two packages that have nothing to do with each other.", &[
        ("Arguments", 2), ("Binary", 2), ("Block", 2), ("Code", 2), ("Decision", 2), ("Event", 2),
        ("Extent", 2), ("Field", 2), ("Fold", 2), ("Form", 2), ("Frame", 2), ("Function", 2), ("Job", 2),
        ("Key", 3), ("Member", 2), ("Number", 2), ("Operand", 4), ("Pattern", 2), ("Pieces", 2),
        ("Planes", 2), ("Probe", 2), ("Range", 2), ("Rows", 2), ("Scene", 2), ("Source", 2), ("Tape", 2), ("Task", 2), ("Vector", 3), ("Watch", 2),
        ("Writer", 2), ("Written", 3),
    ]),
];

/// The name of the type or trait that a line of code defines.
fn defined(line: &str) -> Option<&str> {
    let code = line.trim_start();
    let code = match code.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(") ")?.1,
        Some(rest) => rest.trim_start(),
        None => code,
    };
    let (word, rest) = code.split_once(' ')?;
    // A type further in is one of a trait.
    let is_type = word == "type" && !line.starts_with(' ');
    let name = rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()?;
    let is_definition = is_type || ["struct", "enum", "trait"].contains(&word);
    (is_definition && name.starts_with(char::is_uppercase)).then_some(name)
}

/// The files that define each name.
fn homes() -> BTreeMap<String, BTreeSet<String>> {
    let mut homes: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (path, text) in CRATES.into_iter().flat_map(sources) {
        let file = path.strip_prefix(root()).expect("sources are in the project").display().to_string();
        if APART.iter().any(|folder| file.starts_with(folder)) {
            continue;
        }
        for name in lines(&path, &text).into_iter().filter_map(defined) {
            homes.entry(name.to_owned()).or_default().insert(file.clone());
        }
    }
    homes
}

#[test]
fn a_second_type_of_a_name_says_whose_it_is() {
    let homes = homes();
    assert!(homes.len() > 500, "only {} names were found", homes.len());
    let shared: BTreeMap<&str, usize> = SHARED.iter().flat_map(|(_, names)| names.iter().copied()).collect();
    assert_eq!(shared.len(), SHARED.iter().map(|(_, names)| names.len()).sum(), "a name has one reason");
    for (name, files) in &homes {
        let most = shared.get(name.as_str()).copied().unwrap_or(1);
        assert!(
            files.len() <= most,
            "{name} is defined in {} files, and may be in {most}: call the new one by what it is of\n{files:#?}",
            files.len()
        );
    }
    for name in shared.keys() {
        let count = homes.get(*name).map_or(0, BTreeSet::len);
        assert!(count > 1, "{name} is defined in {count} files: take it off the list");
    }
}

#[test]
fn definitions_are_told_from_other_lines() {
    for line in ["struct Name;", "pub(crate) struct Name<T> {", "    pub enum Name {", "pub type Name = u8;"]
    {
        assert_eq!(defined(line), Some("Name"), "{line}");
    }
    for line in
        ["    type Name = u8;", "pub use Name;", "    struct: Name,", "fn name() {", "pub struct $name {"]
    {
        assert_eq!(defined(line), None, "{line}");
    }
}
