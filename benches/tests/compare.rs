//! What the program `compare` promises to scripts: its exit codes, and the keys of its JSON.

use std::process::{Command, Output};

use jbt_benches::compare::Case;
use serde_json::Value;

fn compare(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_compare")).args(arguments).output().expect("the program starts")
}

#[test]
fn an_unknown_case_is_a_usage_error_that_lists_the_cases() {
    let output = compare(&["compile", "nonsense"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty(), "nothing runs");
    let message = String::from_utf8(output.stderr).expect("text");
    assert!(message.contains("no case `nonsense`"), "{message}");
    for case in Case::ALL {
        assert!(message.contains(case.name) && message.contains(case.what), "{message}");
    }
}

#[test]
fn help_names_the_cases_and_the_keys() {
    let output = compare(&["--help"]);
    assert_eq!(output.status.code(), Some(0));
    let help = String::from_utf8(output.stdout).expect("text");
    let keys = ["primitives", "unit", "ours", "fidget_jit", "ratio_limit", "checksum", "limit_level"];
    for word in Case::ALL.iter().map(|case| case.name).chain(keys) {
        assert!(help.contains(word), "{word} is not in\n{help}");
    }
}

#[test]
fn each_line_of_json_has_the_documented_keys() {
    let output = compare(&["--quick", "--json", "compile"]);
    let text = String::from_utf8(output.stdout).expect("text");
    assert_eq!(output.status.code(), Some(0), "{text}");
    let rows: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("an object")).collect();
    assert_eq!(rows.len(), 3, "one for each number of primitives");
    for row in &rows {
        assert_eq!(row["case"], "compile");
        assert_eq!(row["unit"], "primitive");
        assert_eq!(row["checksum"], "ok");
        for key in ["what", "engine", "fidget_jit_form", "fidget_vm_form"] {
            assert!(row[key].is_string(), "{key} in {row}");
        }
        for key in ["primitives", "points"] {
            assert!(row[key].is_u64(), "{key} in {row}");
        }
        for key in ["ours_ns", "fidget_jit_ns", "fidget_vm_ns", "walk_ns", "ratio_fidget"] {
            assert!(row[key].as_f64().is_some_and(|number| number > 0.0), "{key} in {row}");
        }
    }
}
