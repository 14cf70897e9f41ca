//! The absences that ARCHITECTURE.md states: who depends on whom, and where `unsafe` lives.

mod circles;
mod imports;
mod layers;
mod lengths;
mod packages;
mod paths;
mod types;

use std::path::{Path, PathBuf};

/// All crates.
const CRATES: [&str; 11] = [
    "frontend/model",
    "frontend/text",
    "frontend/lower",
    "ir",
    "jit",
    "runtime",
    "cli",
    "benches",
    "testkit",
    "fuzz/targets",
    "python",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Rust files of a crate's sources.
fn sources(name: &str) -> Vec<(PathBuf, String)> {
    let mut files = Vec::new();
    let mut folders = vec![root().join(name).join("src")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a readable folder") {
            let path = entry.expect("a readable folder").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = std::fs::read_to_string(&path).expect("a readable file");
                files.push((path, text));
            }
        }
    }
    files
}

fn dependencies(name: &str) -> String {
    let manifest = std::fs::read_to_string(root().join(name).join("Cargo.toml")).expect("a manifest");
    let start = manifest.find("[dependencies]").expect("dependencies");
    let end = manifest[start + 1..].find("\n[").map_or(manifest.len(), |end| start + 1 + end);
    manifest[start..end].to_owned()
}

#[test]
fn crates_depend_downwards() {
    for (name, absent) in [
        ("ir", &["jbt-", "cranelift", "glam", "rayon"][..]),
        ("frontend/model", &["jbt-text", "jbt-lower", "jbt-jit", "cranelift", "rayon"]),
        ("frontend/text", &["jbt-lower", "jbt-jit", "cranelift", "rayon"]),
        ("frontend/lower", &["jbt-text", "jbt-jit", "cranelift", "rayon"]),
        ("jit", &["jbt-model", "jbt-text", "jbt-lower", "glam", "rayon"]),
        ("runtime", &["cranelift"]),
        ("cli", &["jbt-"]),
        ("python", &["jbt-lower", "jbt-ir", "jbt-jit", "cranelift", "glam"]),
        ("benches", &["jbt-model", "jbt-text", "jbt-lower", "jbt-ir", "jbt-jit"]),
    ] {
        let dependencies = dependencies(name);
        for word in absent {
            let found = dependencies.lines().any(|line| line.starts_with(word));
            assert!(!found, "{name} does not depend on {word}");
        }
    }
}

#[test]
fn unsafe_code_has_its_homes() {
    let homes = [
        "jit/src/memory.rs",
        "ir/src/environment.rs",
        "ir/src/domain/lanes/level.rs",
        "runtime/src/mesh/fill.rs",
        "benches/src/limit/vector.rs",
        "cli/src/memory.rs",
    ];
    for name in CRATES {
        for (path, text) in sources(name) {
            let at_home = homes.iter().any(|home| path.ends_with(home));
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
            let has = code.into_iter().any(|line| {
                line.contains("unsafe {") || line.contains("unsafe fn") || line.contains("unsafe impl")
            });
            assert!(at_home || !has, "{} has unsafe code", path.display());
        }
    }
}

/// Scenes are read, files that they name are found, and meshes are saved by three parts of the library,
/// besides the binary.
#[test]
fn files_are_opened_at_three_doors() {
    let doors = [
        "runtime/src/folder.rs",
        "runtime/src/scene.rs",
        "runtime/src/export/atomic.rs",
        "runtime/src/export/atomic/nameless.rs",
        "runtime/src/export/atomic/tests.rs",
    ];
    for name in ["frontend/model", "frontend/text", "frontend/lower", "ir", "jit", "runtime"] {
        for (path, text) in sources(name) {
            let is_door = doors.iter().any(|door| path.ends_with(door));
            let mut code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
            let opens = code.any(|line| {
                // That is one of the doors.
                let line = line.replace("AtomicFile::", "");
                ["std::fs", "File::", "fs::read", "fs::write"].iter().any(|word| line.contains(word))
            });
            // What the system says of its pages of memory is no file of anybody's.
            assert!(
                is_door || !opens || path.ends_with("jit/src/memory.rs"),
                "{} opens files",
                path.display()
            );
        }
    }
}

/// What a thread does for somebody else while it waits must not be stopped by who waits.
#[test]
fn work_is_given_to_threads_by_one_word() {
    let gives = ["into_par_iter()", ".par_iter()", ".par_chunks(", ".par_sort_", " join("];
    let mut seen = 0;
    for (path, text) in sources("runtime") {
        if path.ends_with("parallel.rs") || !text.contains("use crate::parallel::") {
            continue;
        }
        let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        // `fn join(` of a file's own is no join of threads.
        let is_own = code.iter().any(|line| line.contains("fn join("));
        let gives = gives.iter().filter(|word| !(is_own && **word == " join("));
        let given: Vec<&&str> = gives.filter(|word| code.iter().any(|line| line.contains(**word))).collect();
        seen += usize::from(!given.is_empty());
        let scatters = given.is_empty() || code.iter().any(|line| line.contains("scatter(|"));
        assert!(scatters, "{} has {given:?} without `scatter`", path.display());
    }
    assert!(seen > 20, "{seen} files give work to threads");
}

#[test]
fn every_file_says_what_it_is() {
    for name in CRATES {
        for (path, text) in sources(name) {
            assert!(text.starts_with("//! "), "{} begins with a sentence", path.display());
        }
    }
}

#[test]
fn nothing_is_left_for_later() {
    for name in CRATES {
        for (path, text) in sources(name) {
            for word in ["todo!(", "unimplemented!(", "dbg!("] {
                assert!(!text.contains(word), "{} has {word}", path.display());
            }
        }
    }
}
