//! Golden files: what a stage makes of an input. `BLESS=1 cargo test` writes what came out as expected.
//!
//! A file holds an input, a line of dashes, and the expected output ([`check_golden`]), or the expected
//! output alone, beside the file of the input ([`compare`]).
//!
//! A review reads the difference of these files, so blessing is no proof of anything: what changed has to be
//! explained.

use std::fs;
use std::path::{Path, PathBuf};

/// Between the input and the expected output.
const SEPARATOR: &str = "\n----\n";

/// The folder of the golden files of one stage, `tests/golden/<name>` of the package that is tested.
#[must_use]
pub fn folder(name: &str) -> PathBuf {
    // Cargo sets it for the programs that it runs, too; whoever runs one by hand stands in the package.
    let package = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| ".".into());
    Path::new(&package).join("tests/golden").join(name)
}

/// The golden files of one stage with this extension, in order, with their texts. Fails if there are none:
/// then the stage is not tested.
#[must_use]
pub fn files(name: &str, extension: &str) -> Vec<(PathBuf, String)> {
    let folder = folder(name);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> =
        entries.map(|entry| entry.expect("a folder can be listed").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|found| found == extension));
    paths.sort();
    assert!(!paths.is_empty(), "{} has no golden file", folder.display());
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        (path, text)
    };
    paths.into_iter().map(read).collect()
}

/// Whether expected outputs are to be rewritten.
pub fn blessing() -> bool {
    std::env::var_os("BLESS").is_some_and(|bless| bless == "1")
}

/// Runs every file of `tests/golden/<name>` and compares what comes out with what stands below its line of
/// dashes.
pub fn check_golden(name: &str, run: impl Fn(&str) -> String) {
    let mut failures = String::new();
    for (path, text) in files(name, "txt") {
        let (input, expected) = text.split_once(SEPARATOR).unwrap_or((text.trim_end(), ""));
        let mut found = run(&format!("{input}\n"));
        if !found.ends_with('\n') {
            found.push('\n');
        }
        if found != expected {
            let whole = format!("{input}{SEPARATOR}{found}");
            differ(&path, &text, &whole, &mut failures);
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

/// Compares what was found with the file that expects it.
#[track_caller]
pub fn compare(path: &Path, found: &str) {
    let expected = fs::read_to_string(path).unwrap_or_default();
    let mut failures = String::new();
    if found != expected {
        differ(path, &expected, found, &mut failures);
    }
    assert!(failures.is_empty(), "{failures}");
}

/// Rewrites a file when blessing; otherwise adds the first difference to `failures`.
pub fn differ(path: &Path, expected: &str, found: &str, failures: &mut String) {
    if blessing() {
        fs::write(path, found).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        return;
    }
    let mut lines = expected.lines().zip(found.lines()).enumerate();
    let same = expected.lines().count().min(found.lines().count());
    let line = lines.find(|(_, (expected, found))| expected != found).map_or(same, |(line, _)| line);
    let show = |text: &str| text.lines().nth(line).unwrap_or("(the end)").to_owned();
    failures.push_str(&format!(
        "{}:{}: differs\n  expected  {}\n  found     {}\n  BLESS=1 cargo test accepts what was found.\n",
        path.display(),
        line + 1,
        show(expected),
        show(found),
    ));
}
