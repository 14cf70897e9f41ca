//! What the documents name is there: every link to a file, and every path in backticks.
//!
//! ```text
//! `runtime/src/job.rs`            a path from the project's folder
//! `combine/step.rs`, `point.rs`   the end of a path
//! `ir/tests/golden/<pass>/`       a path up to its first placeholder
//! `benches/record.py run`         a path among other words: its first part is a folder of the project
//! ```

use std::collections::BTreeSet;
use std::path::Path;

use crate::root;

/// Endings of files that are named without a folder, too.
const ENDINGS: [&str; 6] = [".rs", ".py", ".md", ".toml", ".mjs", ".ir"];

/// Files and folders of the project, below its own folder; folders end with a slash.
fn present() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut folders = vec![String::new()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root().join(&folder)).expect("a readable folder") {
            let entry = entry.expect("a readable folder");
            let name = entry.file_name().into_string().expect("names are text");
            if ["target", ".git", "node_modules"].contains(&name.as_str()) {
                continue;
            }
            let path = format!("{folder}{name}");
            if entry.path().is_dir() {
                found.insert(format!("{path}/"));
                folders.push(format!("{path}/"));
            } else {
                found.insert(path);
            }
        }
    }
    found
}

/// README and its like, and the pages of `docs`: path and text.
fn documents() -> Vec<(String, String)> {
    let pages = present().into_iter().filter(|path| {
        let is_page = path.starts_with("docs/") || path.starts_with("outside/") || !path.contains('/');
        // The changelog names what is gone, too.
        is_page && path.ends_with(".md") && path != "CHANGELOG.md"
    });
    pages.map(|path| (path.clone(), std::fs::read_to_string(root().join(path)).expect("text"))).collect()
}

/// The text outside of blocks of code.
fn prose(text: &str) -> String {
    let mut in_block = false;
    let lines = text.lines().filter(|line| {
        let is_fence = line.trim_start().starts_with("```");
        in_block ^= is_fence;
        !is_fence && !in_block && !line.starts_with("    ")
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// The files that links and pictures of a text lead to, relative to the text.
fn links(text: &str) -> Vec<&str> {
    let mut targets: Vec<&str> = Vec::new();
    for (before, after) in [("](", ')'), ("src=\"", '"'), ("href=\"", '"')] {
        targets.extend(text.split(before).skip(1).filter_map(|rest| rest.split(after).next()));
    }
    let files = targets.iter().filter(|target| !target.contains("://")).map(|target| {
        // What is behind is a heading of the file.
        target.split('#').next().unwrap_or(target)
    });
    files.filter(|file| !file.is_empty()).collect()
}

/// The paths in backticks of a text, each up to its first placeholder. `rooms`: the folders of the project.
fn named<'a>(text: &'a str, rooms: &BTreeSet<&str>) -> Vec<&'a str> {
    let spans = text.split('`').skip(1).step_by(2);
    let mut paths = Vec::new();
    for span in spans {
        let is_alone = !span.contains(char::is_whitespace);
        for word in span.split_whitespace() {
            let is_path = |c: char| c.is_ascii_alphanumeric() || "._-/<>*{},".contains(c);
            let room = word.split('/').next().filter(|room| word.contains('/') && rooms.contains(room));
            let ends = ENDINGS.iter().any(|ending| word.ends_with(ending) && word.len() > ending.len());
            if word.chars().all(is_path) && (room.is_some() || is_alone && ends) {
                let end = word
                    .find(['<', '*', '{'])
                    .map_or(word.len(), |at| word[..at].rfind('/').map_or(0, |at| at + 1));
                paths.push(&word[..end]);
            }
        }
    }
    paths.retain(|path| !path.is_empty());
    paths
}

/// A path without `.` and `..`.
fn plain(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/').filter(|part| *part != ".") {
        if part == ".." {
            parts.pop();
        } else {
            parts.push(part);
        }
    }
    parts.join("/")
}

/// Whether there is a file or a folder whose path ends so.
fn is_present(present: &BTreeSet<String>, path: &str) -> bool {
    let path = path.trim_end_matches('/');
    present.iter().any(|known| {
        let known = known.trim_end_matches('/');
        known.strip_suffix(path).is_some_and(|before| before.is_empty() || before.ends_with('/'))
    })
}

#[test]
fn what_documents_name_is_there() {
    let present = present();
    let rooms: BTreeSet<&str> =
        present.iter().filter_map(|path| path.split_once('/')).map(|(room, _)| room).collect();
    let mut count = 0;
    for (document, text) in documents() {
        let folder = Path::new(&document).parent().and_then(Path::to_str).unwrap_or_default();
        let prose = prose(&text);
        for link in links(&prose) {
            let path = plain(&format!("{folder}/{link}"));
            let path = path.trim_matches('/');
            let found = path.is_empty() || present.contains(path) || present.contains(&format!("{path}/"));
            assert!(found, "{document} links to {link}, which is not there");
            count += 1;
        }
        for path in named(&prose, &rooms) {
            assert!(is_present(&present, path), "{document} names `{path}`, which is not there");
            count += 1;
        }
    }
    assert!(count > 300, "only {count} paths were found");
}

#[test]
fn paths_are_told_from_other_words() {
    let rooms = BTreeSet::from(["ir", "examples"]);
    let text = "see `ir/src/op.rs`, [it](docs/a.md#b), `a / b`, `x/y`, `lower/rows.rs`, `1/x`, `jbt mesh examples/a.jbt`,\n\
                `ir/tests/<pass>/x.ir`, `ir/{a,b}.rs`, <img src=\"c.png\">, [away](https://a.b/c)";
    assert_eq!(named(text, &rooms), ["ir/src/op.rs", "lower/rows.rs", "examples/a.jbt", "ir/tests/", "ir/"]);
    assert_eq!(links(text), ["docs/a.md", "c.png"]);
    assert_eq!(prose("a\n```text\n`b.rs`\n```\nc"), "a\nc");
    assert_eq!(plain("docs/../ir/./src"), "ir/src");
}
