//! Writes a folder of seeds and a list of words for each target, from the files of the project:
//! `seeds FOLDER` makes `FOLDER/<target>/` and `FOLDER/<target>.dict`.
//!
//! Seeds are those of `fuzz/seeds`, examples, golden files, scenes of tests and pages, and the samples
//! where they are. Words are those that several seeds of a target have, and numbers that hurt. Samples
//! are no part of the project, so nothing that is written here is, either.

#![allow(clippy::print_stdout, reason = "it says what it has written")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use jbt::SceneFormat;
use jbt_targets::{format_word, targets};

/// The longest seed, in bytes: mutations of longer ones tell little.
const MAX_BYTES: u64 = 16 << 10;
/// Seeds of one target, at most.
const MAX_SEEDS: usize = 600;
/// Words of one target, at most.
const MAX_WORDS: usize = 800;
/// Folders of the project where there are seeds.
const FOLDERS: [&str; 9] = [
    "examples",
    "docs",
    "outside",
    "frontend/text/tests",
    "ir/tests/golden",
    "cli/tests",
    "runtime/tests",
    "fuzz/regressions",
    "fuzz/seeds",
];
/// Numbers at which readers have failed.
const NUMBERS: [&str; 12] = [
    "0",
    "-0",
    "1e300",
    "-1e-300",
    "1e15",
    "1e38",
    "4294967296",
    "18446744073709551616",
    "nan",
    "inf",
    "0.5",
    "1e-45",
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args_os().nth(1).ok_or("usage: seeds FOLDER")?);
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut roots: Vec<PathBuf> = FOLDERS.iter().map(|name| project.join(name)).collect();
    roots.push(jbt_testkit::samples::root());
    let mut files = BTreeSet::new();
    roots.iter().for_each(|root| list(root, &mut files));
    let mut seeds: BTreeMap<String, Vec<Vec<u8>>> = BTreeMap::new();
    let mut page_words = BTreeSet::new();
    for path in files {
        let bytes = fs::read(&path)?;
        for (target, input) in seeds_of(&path, &bytes) {
            if is_page(&path) {
                page_words.extend(words_of(&String::from_utf8_lossy(input)).map(str::to_owned));
            }
            let own = seeds.entry(target).or_default();
            if own.len() < MAX_SEEDS && !own.iter().any(|known| known == input) {
                own.push(input.to_vec());
            }
        }
    }
    for target in targets() {
        let mut own = seeds.remove(&target.name).unwrap_or_default();
        if target.compiles() || target.name == "print" {
            own.extend((0..64_u64).map(random));
        }
        if own.is_empty() {
            return Err(format!("there is no seed for {0}: fuzz/seeds/{0} takes one", target.name).into());
        }
        let inputs = folder.join(&target.name);
        fs::create_dir_all(&inputs)?;
        for (number, bytes) in own.iter().enumerate() {
            fs::write(inputs.join(format!("seed-{number:03}")), bytes)?;
        }
        fs::write(folder.join(format!("{}.dict", target.name)), words(&own, &page_words))?;
        println!("{}: {} seeds", target.name, own.len());
    }
    Ok(())
}

/// Files that are short enough, in all folders below; of pages, scenes are.
fn list(folder: &Path, files: &mut BTreeSet<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            list(&path, files);
        } else if is_page(&path) || entry.metadata().is_ok_and(|data| data.len() <= MAX_BYTES) {
            files.insert(path);
        }
    }
}

/// Whether it is a page, which has scenes between its prose.
fn is_page(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "md")
}

/// The targets that a file is a seed of, each with the part of the file that is one. A page has several.
fn seeds_of<'a>(path: &Path, bytes: &'a [u8]) -> Vec<(String, &'a [u8])> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let name = path.to_string_lossy();
    if ["/fuzz/regressions/", "/fuzz/seeds/"].iter().any(|own| name.contains(own)) {
        let target = path.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        return target.into_iter().map(|target| (target, bytes)).collect();
    }
    if name.contains("/ir/tests/golden/") || ending == "ir" {
        // Of a golden file, what is above its line of dashes.
        let input = bytes.windows(6).position(|part| part == b"\n----\n").unwrap_or(bytes.len());
        let is_function = bytes[..input].windows(9).any(|part| part == b"function ");
        return if is_function { vec![("function".to_owned(), &bytes[..input])] } else { Vec::new() };
    }
    if is_page(path) {
        let page = std::str::from_utf8(bytes).unwrap_or_default();
        let scenes = page.split("```jbt\n").skip(1).filter_map(|rest| rest.split_once("```"));
        let scene = Path::new("scene.jbt");
        return scenes.flat_map(|(scene_text, _)| seeds_of(scene, scene_text.as_bytes())).collect();
    }
    let formats = SceneFormat::ALL.into_iter().filter(|format| format.extensions().contains(&ending));
    let mut found: Vec<String> = formats.map(|format| format!("read-{}", format_word(format))).collect();
    if ending == "jbt" {
        found.extend(["print", "engines", "prune", "mesh"].map(str::to_owned));
    }
    if ending == "csv" {
        found.push("points".to_owned());
    }
    found.into_iter().map(|target| (target, bytes)).collect()
}

/// Seeds of a random model.
fn random(seed: u64) -> Vec<u8> {
    let mut rng = fastrand::Rng::with_seed(seed);
    (0..18).map(|_| rng.u8(..)).collect()
}

/// The words of a text.
fn words_of(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter: char| !letter.is_ascii_alphanumeric() && !"_#$".contains(letter))
        .filter(|word| (2..25).contains(&word.len()) && !word.starts_with(|c: char| c.is_ascii_digit()))
}

/// The words that two seeds or more have, or one of a page: the frequent ones first, as libFuzzer reads them.
fn words(seeds: &[Vec<u8>], page_words: &BTreeSet<String>) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for seed in seeds {
        let text = String::from_utf8_lossy(seed);
        let words: BTreeSet<&str> = words_of(&text).collect();
        words.into_iter().for_each(|word| *counts.entry(word.to_owned()).or_default() += 1);
    }
    let mut all: Vec<(usize, String)> = counts.into_iter().map(|(word, count)| (count, word)).collect();
    all.retain(|(count, word)| *count >= 2 || seeds.len() < 4 || page_words.contains(word));
    all.sort_by(|a, b| b.cmp(a));
    let numbers = NUMBERS.iter().map(|number| (*number).to_owned());
    let lines = numbers.chain(all.into_iter().take(MAX_WORDS).map(|(_, word)| word));
    lines.map(|word| format!("\"{word}\"\n")).collect()
}
