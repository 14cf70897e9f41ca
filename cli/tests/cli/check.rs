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
    assert_eq!(
        model["attributes"][1],
        json!({ "name": "rough", "width": 1, "mixing": "dominant", "direction": false })
    );
    assert_eq!(files[0]["model"], json!(null));
    // Warnings are there, too, and do not count as errors.
    let odd = folder.with("odd.blob", BLOB.replace("ChildrenCount=2", "ChildrenCount=3"));
    let report = odd.jbt(&["check", "--json", "odd.blob"]).code(0).json();
    let severities = report["diagnostics"].as_array().unwrap().iter().map(|one| &one["severity"]);
    assert!(severities.eq(["warning"]), "{report}");
    let stdin = odd.jbt_with_input(&["check", "--json", "-"], b"jbt 1 point { radius 0 }").code(1).json();
    assert_eq!(stdin["diagnostics"][0]["file"], "<stdin>");
}

#[test]
fn overlaps_are_told() {
    let ball =
        |name: &str, x: f64| format!("part \"{name}\" {{ point {{ at ({x} 0 0) surface_radius 1 }} }}\n");
    let text = format!("jbt 1\n{}{}{}", ball("hub", 0.0), ball("pin", 1.5), ball("far", 6.0));
    let folder = Folder::new().with("parts.jbt", &text).with("scene.jbt", SCENE);
    let told = folder.jbt(&["check", "--overlaps", "parts.jbt"]).code(0).stdout();
    assert!(told.contains("overlap      hub and pin near ("), "{told}");
    assert!(
        told.contains("apart        2 of 3 pairs") && told.contains("part         far: volume 3."),
        "{told}"
    );
    let report = folder.jbt(&["check", "--overlaps", "--json", "parts.jbt"]).code(0).json();
    let pairs = &report["files"][0]["model"]["overlaps"]["pairs"];
    assert_eq!((&pairs[0]["relation"], &pairs[1]["relation"]), (&json!("overlapping"), &json!("apart")));
    // Two caps of height 0.25.
    let exact = 2.0 * std::f64::consts::PI * 0.0625 * (3.0 - 0.25) / 3.0;
    let volume = |key: &str| pairs[0]["volume"][key].as_f64().unwrap();
    assert!(volume("low") <= exact && exact <= volume("high"), "{pairs}");
    let told = folder.jbt(&["check", "--overlaps", "scene.jbt"]).code(0).stdout();
    assert!(told.contains("the scene is one solid"), "{told}");
    folder.jbt(&["check", "--tolerance", "0.1", "scene.jbt"]).code(2);
}

/// Between faces that meet there are more boxes than there is time for: without a tolerance, one is found.
#[test]
fn faces_that_meet_touch() {
    let plate = |name: &str, z: f64| {
        format!("part \"{name}\" {{ box {{ center (0 0 {z}) half (10 10 0.4) surface_radius 0.1 }} }}\n")
    };
    let folder = Folder::new()
        .with("flush.jbt", format!("jbt 1\n{}{}", plate("a", 0.0), plate("b", 1.0)))
        .with("thin.jbt", format!("jbt 1\n{}{}", plate("a", 0.0), plate("b", 0.97)));
    let relation = |words: &[&str]| {
        let report = folder.jbt(&[&["check", "--overlaps", "--json"], words].concat()).code(0).json();
        report["files"][0]["model"]["overlaps"]["pairs"][0].clone()
    };
    let told = relation(&["flush.jbt"]);
    let (within, z) = (told["within"].as_f64().unwrap(), told["at"][2].as_f64().unwrap());
    assert!(told["relation"] == "touching" && within < 0.5 && (z - 0.5).abs() < 1e-3, "{told}");
    assert_eq!(relation(&["flush.jbt", "--tolerance", "0.001"])["relation"], "undecided");
    assert_eq!(relation(&["thin.jbt"])["relation"], "overlapping");
}

#[test]
fn two_scenes_are_compared() {
    let scene = |radius: &str| {
        format!("jbt 1 union {{ hub: point {{ radius {radius} }} ring {{ ring_radius 2 radius 0.5 }} }}")
    };
    let folder = Folder::new()
        .with("a.jbt", scene("1"))
        .with("b.jbt", scene("1.5"))
        .with("c.jbt", format!("# the same\n{}", scene("1.0")));
    let told = folder.jbt(&["diff", "a.jbt", "b.jbt"]).code(0).stdout();
    assert!(told.starts_with("a.jbt and b.jbt: 1 difference\n  at union.0/hub\n"), "{told}");
    assert!(
        told.contains("- point { radius 1 }\n  + point { radius 1.5 }\n  fields differ from ("),
        "{told}"
    );
    let told = folder.jbt(&["diff", "a.jbt", "c.jbt"]).code(0).stdout();
    assert!(told.starts_with("a.jbt and c.jbt are the same model, 2-"), "{told}");
    let report = folder.jbt(&["diff", "a.jbt", "b.jbt", "--json"]).code(0).json();
    assert_eq!((&report["same"], &report["differences"][0]["path"]), (&json!(false), &json!("union.0/hub")));
    folder.jbt(&["diff", "a.jbt", "none.jbt"]).code(4);
}

#[test]
fn scenes_in_another_order_are_not_the_same() {
    let [a, b] = ["point { at (-0.4 0 0) radius 1 }", "point { at (0.4 0 0) radius 1 }"];
    let scene = |[a, b]: [&str; 2]| format!("jbt 1 difference {{ {a} {b} }}");
    let part = |name: &str| format!("jbt 1 part \"{name}\" {{ {a} }}");
    let ground = |z: &str| format!("jbt 1 half_space {{ at (0 0 {z}) radius 1 }}");
    let folder = Folder::new()
        .with("a.jbt", scene([a, b]))
        .with("b.jbt", scene([b, a]))
        .with("c.jbt", part("a"))
        .with("d.jbt", part("b"))
        .with("e.jbt", ground("0"))
        .with("f.jbt", ground("1"));
    let told = folder.jbt(&["diff", "a.jbt", "b.jbt"]).code(0).stdout();
    assert!(told.contains("at difference.0/point\n  ~ in another order, place 0 is 1: point {"), "{told}");
    assert!(told.contains("\n  fields differ from (-1.4"), "{told}");
    let report = folder.jbt(&["diff", "a.jbt", "b.jbt", "--json"]).code(0).json();
    assert_eq!((&report["same"], &report["differences"][0]["moved"]), (&json!(false), &json!([0, 1])));
    assert_ne!(report["hashes"][0], report["hashes"][1]);
    assert!(report["field"][0]["most"].as_f64().unwrap() > 0.5, "{report}");
    // Parts have names, and the same field.
    let report = folder.jbt(&["diff", "c.jbt", "d.jbt", "--json"]).code(0).json();
    assert_eq!((&report["same"], &report["field"]), (&json!(false), &json!([])));
    assert_eq!(report["differences"][0]["first"], "part \"a\"");
    let told = folder.jbt(&["diff", "e.jbt", "f.jbt"]).code(0).stdout();
    assert!(told.contains("--region says where"), "{told}");
    let region = ["diff", "e.jbt", "f.jbt", "--region", "-1,-1,-3,1,1,3"];
    assert!(folder.jbt(&region).code(0).stdout().contains("fields differ from (-1"));
}

#[test]
fn thin_overlaps_and_unbounded_parts_are_told() {
    let slab = |name: &str, z: f64| {
        format!("part \"{name}\" {{ box {{ center (0 0 {z}) half (10 10 0.4) surface_radius 0.1 }} }}\n")
    };
    let ground = "part \"ground\" { half_space { surface_radius 0.1 } }";
    let folder = Folder::new()
        .with("thin.jbt", format!("jbt 1 {}{}", slab("a", 0.0), slab("b", 0.8)))
        .with("flush.jbt", format!("jbt 1 {}{}", slab("a", 0.0), slab("b", 1.0)))
        .with("ground.jbt", format!("jbt 1 {}{ground}", slab("a", 0.3)));
    let told = folder.jbt(&["check", "--overlaps", "thin.jbt"]).code(0).stdout();
    assert!(told.contains("overlap      a and b near ("), "{told}");
    let told = folder.jbt(&["check", "--overlaps", "--tolerance", "0.0001", "flush.jbt"]).code(0).stdout();
    assert!(told.contains("undecided    a and b near (") && told.contains("is thinner than 0."), "{told}");
    folder.jbt(&["check", "--overlaps", "ground.jbt"]).code(2).says("--region gives it one");
    let region = ["check", "--overlaps", "ground.jbt", "--region", "-12,-12,-2,12,12,2"];
    let told = folder.jbt(&region).code(0).stdout();
    assert!(told.contains("overlap      a and ground near ("), "{told}");
    folder.jbt(&["check", "--region", "0,0,0,1,1,1", "thin.jbt"]).code(2);
}

#[test]
fn constants_are_told_compared_and_written() {
    let text = |material: &str| {
        format!(
            "jbt 1 part \"hub\" {{ constant material \"{material}\" {{ point {{ radius 1 }} }} }}\n\
            part \"rim\" {{ constant part 17 {{ torus {{ ring_radius 2 tube_radius 0.3 radius 0.4 }} }} }}"
        )
    };
    let folder = Folder::new().with("a.jbt", text("steel")).with("b.jbt", text("oak"));
    let told = folder.jbt(&["check", "a.jbt"]).code(0).stdout();
    assert!(
        told.contains("constant     material: \"steel\"") && told.contains("constant     part: 17"),
        "{told}"
    );
    let json = folder.jbt(&["check", "a.jbt", "--json"]).code(0).json();
    let constants = json["files"][0]["model"]["constants"].to_string();
    assert_eq!(constants, r#"{"material":["steel"],"part":[17]}"#);
    let told = folder.jbt(&["diff", "a.jbt", "b.jbt"]).code(0).stdout();
    assert!(
        told.contains("constant material \"steel\"") && told.contains("constant material \"oak\""),
        "{told}"
    );
    folder.jbt(&["mesh", "a.jbt", "-o", "a.obj", "--resolution", "16"]).code(0);
    let obj = std::fs::read_to_string(folder.path("a.obj")).unwrap();
    assert!(obj.contains("o hub\n# material steel\n") && obj.contains("o rim\n# part 17\n"));
}

#[test]
fn a_default_is_told_from_a_value() {
    let text = "jbt 1 union { color (1 1 1) { point { radius 1 } } point { at (3 0 0) radius 1 } }";
    let folder = Folder::new().with("a.jbt", text).with("points.csv", "x,y,z\n0,0,0\n3,0,0\n9,0,0\n");
    let eval = |query: &str| {
        folder.jbt(&["eval", "a.jbt", "--points", "points.csv", "--query", query, "-o", "-"]).code(0).stdout()
    };
    let expected = "x,y,z,field,color.defined\n0,0,0,1,1\n3,0,0,1,0\n9,0,0,0,0";
    assert_eq!(eval("field,color.defined").trim_end(), expected);
    let arguments = ["eval", "a.jbt", "--points", "points.csv", "--query", "rough.defined", "-o", "-"];
    folder.jbt(&arguments).code(2).says("no attribute is named `rough`");
}
