//! Tests that had to be skipped: said at once, and said again when all test programs have run.
//!
//! ```text
//! test program ── skip(reason) ──► standard error, past the capture of passing tests
//!                              └─► notes of this run ── tests/skipped.rs, the last program ──► its last line
//! ```
//!
//! All programs of one `cargo test` are children of one process, whose number names the file of notes. A
//! script that runs `cargo test` several times names a file of its own by `JBT_SKIPPED`; nobody removes that.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Whether tests are asked for that take long: those of faults, and more random cases. `JBT_FAULTS=1` does.
#[must_use]
pub fn at_length() -> bool {
    std::env::var_os("JBT_FAULTS").is_some_and(|value| value == "1")
}

/// One of two numbers, such as those of random cases: the first one in short, the second one [at
/// length](at_length).
#[must_use]
pub fn short_or_long<T>([short, long]: [T; 2]) -> T {
    if at_length() { long } else { short }
}

/// Says that the running test is skipped, and why: in words that name what is missing and how to get it.
pub fn skip(reason: &str) {
    let program = program();
    // The macros that print write into the capture of the test, and the handle does not.
    let _ = writeln!(std::io::stderr(), "skipped in {program}: {reason}");
    note(reason, &program);
}

/// Adds a note for the last line of the run. `program`: what could not run.
pub fn note(reason: &str, program: &str) {
    let opened = OpenOptions::new().append(true).create(true).open(notes().0);
    let mut file = opened.expect("the folder of test programs takes a file");
    // One write for each line: programs may add lines at the same time.
    file.write_all(format!("{reason}\t{program}\n").as_bytes()).expect("the notes take a line");
}

/// The line that a run ends with. Forgets the notes, unless `JBT_SKIPPED` names them.
#[must_use]
pub fn last_line() -> String {
    let (path, is_given) = notes();
    let line = told(&fs::read_to_string(&path).unwrap_or_default());
    if !is_given {
        // There is none if nobody has added a note.
        let _ = fs::remove_file(path);
    }
    line
}

/// The notes in one line: every reason once, with the programs that gave it.
fn told(notes: &str) -> String {
    let mut reasons: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (reason, program) in notes.lines().filter_map(|line| line.split_once('\t')) {
        reasons.entry(reason).or_default().insert(program);
    }
    if reasons.is_empty() {
        return "skipped: nothing".to_owned();
    }
    let told = reasons.iter().map(|(reason, programs)| {
        let programs: Vec<&str> = programs.iter().copied().collect();
        format!("{} ({reason})", programs.join(", "))
    });
    format!("skipped: {}", told.collect::<Vec<_>>().join("; "))
}

/// The file of notes, and whether `JBT_SKIPPED` names it.
fn notes() -> (PathBuf, bool) {
    if let Some(given) = std::env::var_os("JBT_SKIPPED") {
        return (PathBuf::from(given), true);
    }
    let program = std::env::current_exe().expect("a program knows its place");
    let folder = program.parent().unwrap_or(Path::new("."));
    (folder.join(format!("skipped-{}.txt", run())), false)
}

/// The number of the run: of the process that starts all test programs.
#[cfg(unix)]
fn run() -> u32 {
    std::os::unix::process::parent_id()
}

/// Elsewhere there is no such number: runs at the same time share their notes.
#[cfg(not(unix))]
fn run() -> u32 {
    0
}

/// The name of the running test program, without the hash that cargo adds.
fn program() -> String {
    let program = std::env::current_exe().expect("a program knows its place");
    let name = program.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    name.rsplit_once('-').map_or(name.clone(), |(name, _)| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_told_once_with_their_programs() {
        assert_eq!(told(""), "skipped: nothing");
        let notes = "no python3\tcli\nno samples\tvm\nno samples\tparsip\nno samples\tvm\n";
        assert_eq!(told(notes), "skipped: cli (no python3); parsip, vm (no samples)");
    }

    #[test]
    fn the_program_has_the_name_of_its_target() {
        assert_eq!(program(), "jbt_testkit");
    }
}
