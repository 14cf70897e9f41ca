//! Numbers of the documents that are counts, sizes or outputs: what gives each of them stands beside it, and
//! is asked.
//!
//! ```text
//! <!-- claim "takes six" = "6.00": jbt count examples/hero.jbt -->     a command of the binary says 6.00
//! <!-- claim "64 MiB" = MAX_SCENE_BYTES -->                            a limit has this value
//! <!-- claim "27 examples" = count examples/*.jbt -->                  so many files
//! ```
//!
//! What is quoted first stands in the same document. Times are in `benches/record/` alone.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// README, ARCHITECTURE, and the pages of docs: name and text.
fn documents() -> Vec<(String, String)> {
    let mut names = vec!["README.md".to_owned(), "ARCHITECTURE.md".to_owned(), "SECURITY.md".to_owned()];
    for entry in fs::read_dir(root().join("docs")).expect("a folder") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        if name.ends_with(".md") {
            names.push(format!("docs/{name}"));
        }
    }
    names.sort();
    names
        .into_iter()
        .map(|name| (name.clone(), fs::read_to_string(root().join(name)).expect("text")))
        .collect()
}

/// The claims of a text: what is claimed, and what gives it.
fn claims(text: &str) -> Vec<(&str, &str)> {
    let comments = text.split("<!-- claim ").skip(1).map(|rest| rest.split(" -->").next().unwrap_or(rest));
    let claims = comments.map(|comment| {
        let parts = comment.strip_prefix('"').and_then(|rest| rest.split_once("\" = "));
        parts.unwrap_or_else(|| panic!("a claim is \"TEXT\" = WHAT GIVES IT: {comment}"))
    });
    claims.collect()
}

/// A text with one blank for all blanks, and without comments.
fn plain(text: &str) -> String {
    let without = text.split("<!--").map(|part| part.split_once("-->").map_or(part, |(_, rest)| rest));
    without.collect::<String>().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The constants of the file of limits.
fn limits() -> BTreeMap<String, f64> {
    let text = fs::read_to_string(root().join("ir/src/limits.rs")).expect("text");
    let lines = text.lines().filter_map(|line| line.strip_prefix("pub const ")?.strip_suffix(';'));
    let constants = lines.filter_map(|line| {
        let (name, rest) = line.split_once(": ")?;
        let (_, value) = rest.split_once(" = ")?;
        let value = value.trim_end_matches(" as f64").trim_matches(['(', ')']).replace('_', "");
        let number = match value.split_once(" << ") {
            Some((of, by)) => of.parse::<f64>().ok()? * 2_f64.powi(by.parse().ok()?),
            None => value.parse().ok()?,
        };
        Some((name.to_owned(), number))
    });
    constants.collect()
}

/// A number as pages write it.
fn written(number: f64) -> Vec<String> {
    let digits = format!("{number:.0}");
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    vec![
        grouped,
        format!("{} MiB", number / 1_048_576.0),
        format!("{number:e}"),
        format!("2^{}", number.log2()),
    ]
}

/// How many files there are of a pattern, as `examples/*.jbt`.
fn count(pattern: &str) -> usize {
    let (folder, ending) = pattern.split_once('*').unwrap_or_else(|| panic!("{pattern} has a star"));
    let entries = fs::read_dir(root().join(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
    entries
        .filter(|entry| entry.as_ref().is_ok_and(|one| one.file_name().to_string_lossy().ends_with(ending)))
        .count()
}

/// Panics unless a claim holds.
fn check(document: &str, claimed: &str, by: &str) {
    let what = format!("{document} claims \"{claimed}\" by {by}");
    if let Some(pattern) = by.strip_prefix("count ") {
        let words: Vec<&str> = claimed.split_whitespace().collect();
        assert!(words.contains(&count(pattern).to_string().as_str()), "{what}: there are {}", count(pattern));
    } else if let Some((expected, command)) =
        by.strip_prefix('"').and_then(|rest| rest.split_once("\": jbt "))
    {
        let begin = Instant::now();
        let output = Command::new(env!("CARGO_BIN_EXE_jbt"))
            .args(command.split_whitespace())
            .current_dir(root())
            .output()
            .expect("the binary runs");
        let told = [output.stdout, output.stderr].concat();
        let told = plain(&String::from_utf8_lossy(&told));
        assert!(told.contains(expected), "{what}, which says\n{told}");
        // Quick commands alone: this many seconds on a loaded machine.
        assert!(begin.elapsed() < Duration::from_secs(20), "{what}: that took {:?}", begin.elapsed());
    } else {
        let limits = limits();
        let number =
            limits.get(by).unwrap_or_else(|| panic!("{what}, which is no limit of ir/src/limits.rs"));
        let ways = written(*number);
        assert!(
            ways.iter().any(|way| claimed.contains(way.as_str())),
            "{what}, which is {}",
            ways.join(" or ")
        );
    }
}

#[test]
fn claims_hold() {
    let mut total = 0;
    for (document, text) in documents() {
        let prose = plain(&text);
        for (claimed, by) in claims(&text) {
            assert!(prose.contains(claimed), "{document} does not say \"{claimed}\"");
            check(&document, claimed, by);
            total += 1;
        }
    }
    assert!(total >= 20, "only {total} claims were found");
}

/// What times and sizes are told in.
const UNITS: [&str; 11] =
    ["ns", "µs", "ms", "s", "second", "seconds", "minute", "minutes", "hours", "MB", "GB"];

/// What commands that measure begin with.
const PROGRAMS: [&str; 12] = [
    "cargo",
    "jbt",
    "compare",
    "gaps",
    "python",
    "python3",
    "env",
    "/usr/bin/time",
    "checks/",
    "fuzz/",
    "outside/",
    "python/",
];

/// The times, sizes and ratios of a section in prose and tables; what stands in code is no measurement.
fn measured(section: &str) -> Vec<String> {
    let prose: String = section.split('`').step_by(2).collect::<Vec<_>>().join("`");
    let prose = plain(&prose).replace('|', " ");
    let words: Vec<&str> = prose.split_whitespace().chain([""]).collect();
    let bare = |word: &str| word.trim_matches(|c: char| !c.is_alphanumeric()).replace(',', "");
    let is_measured = |words: &&[&str]| {
        let unit = bare(words[1]);
        bare(words[0]).parse::<f64>().is_ok()
            && (UNITS.contains(&unit.as_str()) || (unit == "times" && words[2] == "as"))
    };
    words.windows(3).filter(is_measured).map(|words| words[..2].join(" ")).collect()
}

/// Whether a section names a command, or a record that names one.
fn names_a_command(section: &str) -> bool {
    let begins = |code: &str| {
        let word = code.trim_start_matches(['`', '$', ' ']).split([' ', '`']).next().unwrap_or("");
        PROGRAMS
            .iter()
            .any(|program| word == *program || (program.ends_with('/') && word.starts_with(program)))
    };
    let mut codes = section.split('`').skip(1).step_by(2);
    codes.any(|code| code.lines().any(begins)) || section.contains("benches/record")
}

/// A section that tells what was measured tells by what.
#[test]
fn measurements_name_their_commands() {
    let mut total = 0;
    for (document, text) in documents() {
        let mut sections: Vec<String> = vec![String::new()];
        for line in text.lines() {
            if line.starts_with("## ") {
                sections.push(String::new());
            }
            let section = sections.last_mut().expect("there is one");
            section.push_str(line);
            section.push('\n');
        }
        for section in sections {
            let found = measured(&section);
            total += found.len();
            let title = section.lines().next().unwrap_or_default();
            assert!(
                found.is_empty() || names_a_command(&section),
                "{document}, {title}: no command beside {found:?}"
            );
        }
    }
    assert!(total >= 50, "only {total} measurements were found");
    assert_eq!(measured("It takes 5 ms, or `6 s`, and 1,200 MB."), ["5 ms,", "1,200 MB."]);
    assert!(names_a_command("see `cargo run` there") && !names_a_command("a `word` or a cargo"));
}

/// The folders of packages.
const PACKAGES: [(&str, &str); 9] = [
    ("jbt", "runtime"),
    ("jbt-cli", "cli"),
    ("jbt-targets", "fuzz/targets"),
    ("jbt-benches", "benches"),
    ("jbt-ir", "ir"),
    ("jbt-jit", "jit"),
    ("jbt-lower", "frontend/lower"),
    ("jbt-model", "frontend/model"),
    ("jbt-text", "frontend/text"),
];

/// The folder of a package.
fn folder_of(package: &str) -> PathBuf {
    let found = PACKAGES.iter().find(|(name, _)| *name == package);
    root().join(found.unwrap_or_else(|| panic!("a package {package}")).1)
}

/// The texts of a file or of all files of Rust below a folder, one behind the other.
fn sources(path: &Path) -> String {
    let mut text = String::new();
    let mut stack = vec![path.to_owned()];
    while let Some(path) = stack.pop() {
        if let Ok(entries) = fs::read_dir(&path) {
            stack.extend(entries.map(|entry| entry.expect("an entry").path()));
        } else if path.extension().is_some_and(|extension| extension == "rs") && path.exists() {
            text.push_str(&fs::read_to_string(path).expect("text"));
        }
    }
    text
}

/// Whether a source has a test of this name.
fn has_test(source: &str, name: &str) -> bool {
    let head = format!("fn {name}() {{");
    let is_test = |(at, _): (usize, &str)| source[..at].trim_end().ends_with("#[test]");
    source.match_indices(&head).any(is_test)
}

/// Each feature of the page has a test that is there.
#[test]
fn features_name_tests_that_are_there() {
    let text = fs::read_to_string(root().join("docs/features.md")).expect("the page");
    let rows: Vec<&str> = text.lines().filter(|line| line.starts_with("| ")).skip(1).collect();
    assert!(rows.len() >= 20, "{} features", rows.len());
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let [_, id, feature, what, _, command, _] = cells[..] else { panic!("six bars: {row}") };
        assert!(![id, feature, what].contains(&""), "{row}");
        let words: Vec<&str> = command.trim_matches('`').split_whitespace().collect();
        let (folder, name) = match words[..] {
            ["cargo", "test", "--release", "-p", package, "--test", test, name] => {
                (folder_of(package).join("tests"), (Some(test), name))
            }
            ["cargo", "test", "--release", "-p", package, "--lib", name] => {
                (folder_of(package).join("src"), (None, name))
            }
            _ => panic!("{row}"),
        };
        let (program, name) = name;
        let source = match program {
            None => sources(&folder),
            Some(program) => [folder.join(format!("{program}.rs")), folder.join(program)]
                .map(|path| sources(&path))
                .concat(),
        };
        assert!(has_test(&source, name), "no test {name}: {row}");
    }
    assert!(has_test("#[test]\nfn a() {", "a") && !has_test("fn a() {", "a"));
}

/// Tests that the page of promises names are there.
#[test]
fn promises_name_tests_that_are_there() {
    let text = fs::read_to_string(root().join("docs/promises.md")).expect("the page");
    let rows: Vec<&str> = text.lines().filter(|line| line.starts_with("| R")).collect();
    assert!(rows.len() >= 20, "{} promises", rows.len());
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let [_, _, promise, figure, command, date, machine, _] = cells[..] else {
            panic!("seven bars: {row}")
        };
        assert!([promise, figure, date, machine].iter().all(|cell| !cell.is_empty()), "{row}");
        let words: Vec<&str> = command.trim_matches('`').split_whitespace().collect();
        let after = |flag: &str| {
            words.iter().position(|word| *word == flag).and_then(|at| words.get(at + 1)).copied()
        };
        if let (Some(package), Some(test)) = (after("-p"), after("--test")) {
            let path = folder_of(package).join("tests");
            let is_there =
                path.join(format!("{test}.rs")).exists() || path.join(test).join("main.rs").exists();
            assert!(is_there, "{package} has no test {test}: {row}");
        } else if let Some(program) = after("--bin") {
            let folder = folder_of(after("-p").unwrap_or("jbt-targets"));
            assert!(folder.join(format!("src/bin/{program}.rs")).exists(), "{row}");
        } else if !command.contains("cargo deny") {
            let script = words.iter().find(|word| word.contains('/')).unwrap_or_else(|| panic!("{row}"));
            assert!(root().join(script).exists(), "{script} is not there: {row}");
        }
    }
}
