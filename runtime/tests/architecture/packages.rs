//! How many packages of others somebody takes who embeds the evaluator: `cargo tree` is asked.

use std::collections::BTreeSet;
use std::process::Command;

use crate::root;

/// Packages that are not ours, in what `jbt` needs with these features.
fn packages(features: &str) -> BTreeSet<String> {
    let mut command = Command::new(env!("CARGO"));
    command.current_dir(root()).args(["tree", "--offline", "--locked", "-e", "normal", "--prefix", "none"]);
    command.args(["-p", "jbt", "--no-default-features", "--features", features]);
    let output = command.output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("text");
    // A line is a name, a version, and what else there is to say.
    let names = text.lines().filter_map(|line| line.split_whitespace().next());
    names.filter(|name| *name != "jbt" && !name.starts_with("jbt-")).map(str::to_owned).collect()
}

/// The crate's documentation counts them in words.
#[test]
fn the_counts_that_are_told_are_right() {
    let text = std::fs::read_to_string(root().join("runtime/src/lib.rs")).expect("text");
    let told = "Without default features fifteen packages of others are built, with `jit` forty-five.";
    assert!(text.contains(told), "the counts are told in other words");
    assert_eq!((packages("").len(), packages("jit").len()), (15, 45));
}

/// All packages that are locked, those of benches and tests for every system among them: a change of their
/// number is looked at.
#[test]
fn locked_packages_are_counted() {
    let text = std::fs::read_to_string(root().join("Cargo.lock")).expect("text");
    let found = text.lines().filter(|line| *line == "[[package]]").count();
    assert!((300..=320).contains(&found), "{found} packages in Cargo.lock");
}

#[test]
fn the_interpreters_need_few_packages() {
    let found = packages("");
    assert!(found.len() <= 15, "{} packages: {found:?}", found.len());
}

#[test]
fn machine_code_needs_cranelift_and_little_else() {
    let without = packages("");
    let with = packages("jit");
    let more: Vec<&String> = with.difference(&without).filter(|name| !name.contains("cranelift")).collect();
    assert!(more.len() <= 24, "{} packages beside Cranelift's: {more:?}", more.len());
}
