//! Every input that ever failed (`fuzz/regressions/<target>/`), seeds, noise and random models, on any Rust.

#![allow(clippy::print_stdout, reason = "a test may show its figures")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use jbt_targets::{FuzzTarget, targets};

/// What one input may take, on a loaded machine without optimisation of the tests' own code.
const LONGEST: Duration = Duration::from_secs(10);

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn entries(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("a readable folder").path())
        .collect();
    paths.sort();
    paths
}

#[test]
fn what_ever_failed_holds() {
    let targets = targets();
    let mut count = 0;
    let folders = ["regressions", "seeds"].map(|name| entries(&folder().join(name)));
    for own in folders.into_iter().flatten().filter(|path| path.is_dir()) {
        let name = own.file_name().expect("a folder").to_string_lossy().into_owned();
        let target = targets.iter().find(|target| target.name == name);
        let target = target.unwrap_or_else(|| panic!("{} is the folder of no target", own.display()));
        for path in entries(&own) {
            let begin = Instant::now();
            println!("{}", path.display());
            target.run(&fs::read(&path).expect("a readable file"));
            let took = begin.elapsed();
            assert!(took < LONGEST, "{} took {took:?}", path.display());
            count += 1;
        }
    }
    println!("{count} inputs");
    assert!(count > 15, "{count} inputs");
}

#[test]
fn targets_take_nothing_and_noise() {
    for target in targets() {
        target.run(b"");
        let mut rng = fastrand::Rng::with_seed(1);
        for length in [1, 2, 17, 18, 19, 400] {
            let noise: Vec<u8> = (0..length).map(|_| rng.u8(..)).collect();
            target.run(&noise);
        }
    }
}

/// Random models: `JBT_TARGET_MODELS` says how many for each target that compiles.
#[test]
fn random_models_hold() {
    let count = jbt_testkit::scene::count("JBT_TARGET_MODELS", 40);
    for target in targets().into_iter().filter(FuzzTarget::compiles) {
        for seed in 0..count {
            let mut rng = fastrand::Rng::with_seed(seed);
            let bytes: Vec<u8> = (0..18).map(|_| rng.u8(..)).collect();
            target.run(&bytes);
        }
    }
}

/// libFuzzer's programs are those of the table, and each is declared.
#[test]
fn every_target_has_its_program() {
    let manifest = fs::read_to_string(folder().join("Cargo.toml")).expect("a manifest");
    let programs: BTreeSet<&str> = targets().iter().map(|target| target.program).collect();
    let files: BTreeSet<String> = entries(&folder().join("fuzz_targets"))
        .iter()
        .map(|path| path.file_stem().expect("a file").to_string_lossy().into_owned())
        .collect();
    let files: BTreeSet<&str> = files.iter().map(String::as_str).collect();
    assert_eq!(programs, files);
    for program in programs {
        assert!(manifest.contains(&format!("name = \"{program}\"")), "{program} is not in fuzz/Cargo.toml");
    }
}
