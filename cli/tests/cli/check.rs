//! `jbt check`: several files, and answers for machines.

use serde_json::json;

use crate::folder::{BLOB, Folder, SCENE};

const BAD: &str = "jbt 1\r\n# \u{e9}\r\nunion {\r\n    point { radus 1 radius 1 }\r\n    piont { }\r\n}\r\n";

fn folder() -> Folder {
    Folder::new().with("scene.jbt", SCENE).with("scene.blob", BLOB).with("bad.jbt", BAD)
}

#[test]
fn several_files_are_checked_each() {
    let folder = folder();
    let ran = folder.jbt(&["check", "scene.jbt", "bad.jbt", "none.jbt", "scene.blob"]).code(1);
    assert!(ran.stdout().contains("scene.jbt: no errors") && ran.stdout().contains("scene.blob: no errors"));
    let ran = ran.says("bad.jbt:4:13: error: ").says("bad.jbt:5:5: error: ").says("cannot read none.jbt");
    assert!(!ran.stderr().contains("\\u{d}"), "{}", ran.stderr());
    // The code of the first that is wrong.
    folder.jbt(&["check", "scene.jbt", "none.jbt", "bad.jbt"]).code(4);
    folder.jbt(&["check", "-q", "scene.jbt", "scene.blob"]).code(0);
    folder.jbt(&["check", "-", "scene.jbt", "-"]).code(2).says("the standard input can be read once");
    folder.jbt(&["check"]).code(2).says("SCENE");
    folder.jbt(&["check", "scene.jbt", "scene.jbt", "-D", "bulge=0.7"]).code(0);
}

#[test]
fn check_reports_for_machines() {
    let folder = folder();
    let ran = folder.jbt(&["check", "--json", "bad.jbt", "scene.jbt", "none.jbt"]).code(1);
    assert_eq!(ran.stderr(), "");
    let report = ran.json();
    let diagnostics = report["diagnostics"].as_array().unwrap();
    assert_eq!(
        diagnostics[0],
        json!({
            "file": "bad.jbt",
            "severity": "error",
            "byte": 34,
            "line": 4,
            "column": 13,
            "end": { "line": 4, "column": 18 },
            "message": "`point` has no parameter `radus`",
            "hint": "perhaps `radius`",
            "notes": [],
        })
    );
    assert_eq!((&diagnostics[1]["line"], &diagnostics[1]["column"]), (&json!(5), &json!(5)));
    assert_eq!((&diagnostics[2]["file"], &diagnostics[2]["line"]), (&json!("none.jbt"), &json!(null)));
    assert_eq!((&diagnostics[2]["end"], &diagnostics[2]["hint"]), (&json!(null), &json!(null)));
    assert_eq!(diagnostics.len(), 3);
    let files = report["files"].as_array().unwrap();
    let of = |key: &str| files.iter().map(|file| file[key].clone()).collect::<Vec<_>>();
    assert_eq!(of("file"), ["bad.jbt", "scene.jbt", "none.jbt"]);
    assert_eq!(of("ok"), [false, true, false]);
    let model = &files[1]["model"];
    assert_eq!((&model["leaves"], &model["instances"], &model["iso"]), (&json!(2), &json!(3), &json!(0.5)));
    assert_eq!(model["parameters"], json!({ "bulge": 0.6 }));
    assert_eq!(model["bounds"].as_array().map(Vec::len), Some(6));
    assert_eq!(model["attributes"][1], json!({ "name": "rough", "width": 1, "mixing": "dominant" }));
    assert_eq!(files[0]["model"], json!(null));
    // Warnings are there, too, and do not count as errors.
    let odd = folder.with("odd.blob", BLOB.replace("ChildrenCount=2", "ChildrenCount=3"));
    let report = odd.jbt(&["check", "--json", "odd.blob"]).code(0).json();
    let severities = report["diagnostics"].as_array().unwrap().iter().map(|one| &one["severity"]);
    assert!(severities.eq(["warning"]), "{report}");
    let stdin = odd.jbt_with_input(&["check", "--json", "-"], b"jbt 1 point { radius 0 }").code(1).json();
    assert_eq!(stdin["diagnostics"][0]["file"], "<stdin>");
}
