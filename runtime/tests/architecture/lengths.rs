//! Lengths: files and functions that a reader can hold, and prose no wider than a page.

use std::path::Path;

use crate::{CRATES, sources};

/// The most lines of a file, its tests left out.
const FILE: usize = 500;
/// The most lines of a function, unless it is a table.
const FUNCTION: usize = 70;
/// Functions that are one arm for each op, and nothing else.
const TABLES: [(&str, &str); 1] = [("frontend/lower/src/slopes.rs", "back")];
/// The widest line of prose, in characters. Figures and tables may be wider.
const WIDEST: usize = 110;

/// The lines of a file without its tests; none of a file of tests.
pub fn lines<'a>(path: &Path, text: &'a str) -> Vec<&'a str> {
    let is_test = path.components().any(|part| part.as_os_str() == "tests")
        || path.file_name().is_some_and(|name| name == "tests.rs" || name == "testing.rs");
    let code = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    if is_test { Vec::new() } else { code.lines().collect() }
}

/// The functions with a body, each with its name and its number of lines.
fn functions<'a>(lines: &[&'a str]) -> Vec<(&'a str, usize)> {
    let ends = |line: &&str| line.ends_with(['{', ';', '}']);
    let found = lines.iter().enumerate().filter_map(|(start, line)| {
        let indent = &line[..line.len() - line.trim_start().len()];
        let mut words = line.trim_start().split_inclusive([' ', '(', '<']);
        let is_head = |word: &&str| {
            ["pub ", "pub(", "in ", "const ", "unsafe ", "extern ", "\"C\" "].contains(word)
                || word.ends_with(") ")
        };
        let name =
            words.find(|word| !is_head(word)).filter(|word| *word == "fn ").and_then(|_| words.next())?;
        let open = start + lines[start..].iter().position(ends)?;
        let close = lines[open..].iter().position(|line| line.strip_prefix(indent) == Some("}"))?;
        lines[open].ends_with('{').then(|| (name.trim_end_matches(['(', '<']), open + close + 1 - start))
    });
    found.collect()
}

#[test]
fn files_are_short() {
    for name in CRATES {
        for (path, text) in sources(name) {
            let count = lines(&path, &text).len();
            assert!(count <= FILE, "{} has {count} lines, and may have {FILE}", path.display());
        }
    }
}

#[test]
fn functions_are_short() {
    let mut count = 0;
    for name in CRATES {
        for (path, text) in sources(name) {
            for (function, length) in functions(&lines(&path, &text)) {
                let is_table = TABLES.iter().any(|(file, table)| path.ends_with(file) && function == *table);
                let fits = length <= FUNCTION || is_table;
                assert!(fits, "{}: {function} has {length} lines, and may have {FUNCTION}", path.display());
                count += 1;
            }
        }
    }
    assert!(count > 1_000, "only {count} functions were found");
}

#[test]
fn lengths_are_those_of_bodies() {
    let text = "fn one() {}\n\npub(crate) fn two<T>(\n    a: T,\n) {\n    three();\n}\n\n    fn declared(&self);\n    const fn four() -> u8 {\n        4\n    }\n";
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(functions(&lines), [("two", 5), ("four", 3)]);
}

#[test]
fn prose_is_no_wider_than_a_page() {
    for name in CRATES {
        for (path, text) in sources(name) {
            let mut in_figure = false;
            for (number, line) in (1..).zip(text.lines()) {
                let Some(comment) = line.trim_start().strip_prefix("//") else {
                    in_figure = false;
                    continue;
                };
                let prose = comment.trim_start_matches(['/', '!']).trim_start();
                in_figure ^= prose.starts_with("```");
                let fits = in_figure || prose.starts_with('|') || line.chars().count() <= WIDEST;
                assert!(fits, "{}:{number} is wider than {WIDEST} columns", path.display());
            }
        }
    }
}
