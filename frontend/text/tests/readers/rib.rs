//! RenderMan RIB.

use jbt_model::walk::walk;
use jbt_testkit::samples;
use jbt_text::import::rib;

use crate::common::{SOON, bad, compare, ends, field, files, good, messages, near, truncated};

#[test]
fn every_sample_agrees_with_its_table() {
    let Some(folder) = samples::folder("rib") else { return };
    let files = files(&folder, "rib");
    for (name, bytes) in &files {
        truncated(rib, bytes);
        if name == "blobplane.rib" {
            let errors = messages(bytes, &rib(bytes).unwrap_err());
            assert!(
                errors.contains("scene:20:12: error: ") && errors.contains("(9000) `dbo_plane`"),
                "{errors}"
            );
            continue;
        }
        let imported = good(rib, bytes);
        let table = folder.join(name.replace(".rib", ".oracle.csv"));
        compare(&imported.model, &table, ["r", "g", "b"], 1e-8, &|_| true);
    }
    assert_eq!(files.len(), 12);
}

const TOOLS: &[u8] = include_bytes!("files/tools.rib");

/// The falloff of all leaves, of a squared distance.
fn cubic(square: f64) -> f64 {
    (1.0 - square).max(0.0).powi(3)
}

const UNIT: &str = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
/// Moved by 0.5 along x.
const MOVED: &str = "1 0 0 0 0 1 0 0 0 0 1 0 0.5 0 0 1";

#[test]
fn every_instruction() {
    let p = [0.2, 0.0, 0.0];
    let (a, b) = (cubic(0.04), cubic(0.09));
    let of = |leaves: usize, code: &str| {
        let text = format!("Blobby {leaves} [1001 0 1001 16 {code}] [{UNIT} {MOVED} 0.25] [\"\"]\n");
        field(rib, &text, p)
    };
    near(of(2, "0 2 0 1"), a + b);
    near(of(2, "1 2 0 1"), a * b);
    near(of(2, "2 2 0 1"), a.max(b));
    near(of(2, "3 2 0 1"), a.min(b));
    near(of(2, "4 0 1"), a - b);
    near(of(2, "5 0 1"), a / b);
    near(of(2, "7 1 6 2 4 3 0"), -b - a);
    near(of(2, "0 3 0 0 1 4 2 0"), a + b);
    let far = of(2, "5 0 1");
    near(far, a / b);
    let bar = format!("Blobby 1 [1002 0] [0 0 0 0 0 2 0.5 {MOVED}] \"\"\n");
    near(field(rib, &bar, [0.75, 0.0, 1.0]), cubic(0.25));
    near(field(rib, &bar, [0.5, 0.0, 2.25]), cubic(0.25));
}

#[test]
fn a_quotient_by_zero_is_zero() {
    let text =
        format!("Blobby 2 [1001 0 1001 16 5 0 1] [{UNIT} 0.1 0 0 0 0 0.1 0 0 0 0 0.1 0 9 0 0 1] [\"\"]\n");
    near(field(rib, &text, [0.0; 3]), 0.0);
}

#[test]
fn constants_join_the_fields() {
    let of = |code: &str, p: [f64; 3]| {
        let text = format!("Blobby 2 [1001 0 1000 16 {code}] [{UNIT} 0.25] [\"\"]\n");
        let imported = good(rib, text.as_bytes());
        assert!(messages(text.as_bytes(), &imported.warnings).contains("ends at the box of its leaves"));
        walk(&imported.model.check().unwrap(), p).field
    };
    near(of("0 2 0 1", [0.5, 0.0, 0.0]), cubic(0.25) + 0.25);
    near(of("2 2 0 1", [0.9, 0.0, 0.0]), 0.25);
    near(of("4 0 1", [0.5, 0.0, 0.0]), cubic(0.25) - 0.25);
    near(of("0 2 0 1", [3.0, 0.0, 0.0]), 0.0);
    // 0 where a factor is, and so without a wall.
    let text = format!("Blobby 2 [1001 0 1000 16 1 2 0 1] [{UNIT} 0.25] [\"\"]\n");
    near(field(rib, &text, [0.5, 0.0, 0.0]), 0.25 * cubic(0.25));
    let full = format!("Blobby 2 [1001 0 1000 16 0 2 0 1] [{UNIT} 0.5] [\"\"]\n");
    let imported = rib(full.as_bytes()).unwrap();
    assert!(messages(full.as_bytes(), &imported.warnings).contains("everywhere beyond its leaves"));
}

#[test]
fn the_last_transformation_acts_first() {
    let text = format!(
        "Translate 9 9 9 WorldBegin Translate 1 0 0 Rotate 90 0 0 1 Scale 2 1 1 Blobby 1 [1001 0] [{UNIT}] [\"\"] WorldEnd"
    );
    // Stretched along x, which turns to y.
    near(field(rib, &text, [1.0, 1.0, 0.0]), cubic(0.25));
    near(field(rib, &text, [1.5, 0.0, 0.0]), cubic(0.25));
    let concat =
        format!("ConcatTransform [0 1 0 0 -1 0 0 0 0 0 1 0 3 0 0 1] Blobby 1 [1001 0] [{MOVED}] [\"\"]\n");
    near(field(rib, &concat, [3.0, 0.5, 0.0]), 1.0);
}

/// The colour of a scene at a point.
fn color(text: &str, p: [f64; 3]) -> Vec<f64> {
    let imported = good(rib, text.as_bytes());
    walk(&imported.model.check().unwrap(), p).attributes[0].clone()
}

#[test]
fn colours_by_parameter_by_leaf_and_by_state() {
    let two = format!("Blobby 2 [1001 0 1001 16 2 2 0 1] [{UNIT} {MOVED}] [\"\"]");
    let (left, right) = ([-0.2, 0.0, 0.0], [0.7, 0.0, 0.0]);
    assert_eq!(color(&format!("Color [1 0 0] {two}"), left), [1.0, 0.0, 0.0]);
    assert_eq!(color(&two, left), [1.0; 3]);
    for (parameter, other) in [
        ("\"constant color Cs\" [0 1 0]", [0.0, 1.0, 0.0]),
        ("\"color Cs\" [0 1 0]", [0.0, 1.0, 0.0]),
        ("\"color Cs\" [0 1 0 0 0 1]", [0.0, 0.0, 1.0]),
        ("\"vertex color Cs\" [0 1 0 0 0 1]", [0.0, 0.0, 1.0]),
    ] {
        let text = format!("{two} {parameter}");
        assert_eq!(color(&text, left), [0.0, 1.0, 0.0], "{text}");
        assert_eq!(color(&text, right), other, "{text}");
    }
    let declared = format!("Declare \"Cs\" \"vertex color\" {two} \"Cs\" [0 1 0 0 0 1]");
    assert_eq!(color(&declared, right), [0.0, 0.0, 1.0]);
    let nested = format!(
        "Color [1 0 0] AttributeBegin Color [0 0 1] AttributeEnd TransformBegin Color [0 1 0] TransformEnd {two}"
    );
    assert_eq!(color(&nested, left), [0.0, 1.0, 0.0]);
}

#[test]
fn the_example_says_what_is_left_out() {
    let imported = good(rib, TOOLS);
    let warnings = messages(TOOLS, &imported.warnings);
    assert!(warnings.contains("scene:56:1: warning: Sphere is no blob and is left out"), "{warnings}");
    assert!(warnings.contains("the constant field of a Blobby ends at the box of its leaves"), "{warnings}");
    assert_eq!(imported.warnings.len(), 2, "{warnings}");
    let tree = imported.model.check().unwrap();
    let instance = |p: [f64; 3]| walk(&tree, p);
    near(instance([0.0, -2.0, 0.5]).field, cubic(0.25));
    assert_eq!(instance([0.0, -2.0, 0.5]).attributes[0], [0.2, 0.5, 0.9]);
    near(instance([0.25, 2.0, 0.0]).field, cubic(0.25));
    assert_eq!(instance([0.25, 2.0, 0.0]).attributes[0], [1.0, 0.0, 0.0]);
    truncated(rib, TOOLS);
}

#[test]
fn errors_have_places() {
    let blobby = |codes: &str| format!("\nBlobby 1 [1001 0 {codes}] [{UNIT}] [\"\"]");
    for (text, message) in [
        (String::new(), "scene:1:1: error: the file has no Blobby"),
        ("\x1f\u{b}".to_owned(), "no Blobby"),
        (blobby("0 2 0 2"), "scene:2:10: error: instruction 1 asks for the result of instruction 2"),
        (blobby("0 2 0 -1"), "the result of instruction -1"),
        (blobby("1001 3"), "instruction 1 asks for 16 numbers from 3 on"),
        (blobby("0 9"), "the codes end within instruction 1"),
        (blobby("0"), "instruction 1 has no number of operands"),
        (blobby("8 1"), "instruction 1 has the code 8"),
        (blobby("0 0"), "instruction 1 has no operands"),
        (blobby("0 1e300 1"), "instruction 1 has no number of operands"),
        (blobby("1003 0 0"), "a repelling plane (1003)"),
        (blobby("1004 0 1 2 3 4"), "a plug-in (1004)"),
        (blobby("").replace(UNIT, "0 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"), "no inverse"),
        (blobby("").replace(UNIT, "1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1"), "no affine map"),
        (format!("Blobby 1 [1002 0] [0 0 0 1 0 0 0 {UNIT}] [\"\"]"), "has the radius 0"),
        ("Blobby 1".to_owned(), "scene:1:1: error: the Blobby is not complete"),
        ("Blobby 1 [1 2".to_owned(), "scene:1:10: error: the array is not closed"),
        ("Blobby 1 [1 \"a\"] [] []".to_owned(), "numbers and strings"),
        ("Color \"a".to_owned(), "the string is not closed"),
        ("Color 1e999 0 0".to_owned(), "`1e999` is no finite number"),
        ("Color nan".to_owned(), "the request has 0 numbers"),
        ("Translate 1 2".to_owned(), "scene:1:1: error: the request has 2 numbers"),
        ("AttributeEnd".to_owned(), "AttributeEnd without AttributeBegin"),
        ("TransformBegin AttributeEnd".to_owned(), "AttributeEnd within TransformBegin"),
        (format!("Scale 0 1 1 {}", blobby("")), "scene:1:1: error: no shape can be placed by this Scale"),
        (format!("Rotate 9 0 0 0 {}", blobby("")), "no shape can be placed by this Rotate"),
        ("ObjectInstance 7".to_owned(), "there is no object 7"),
        (format!("{} \"vertex color Cs\" [1 1]", blobby("")), "the colour Cs has 2 numbers"),
    ] {
        let found = bad(rib, &text);
        assert!(found.contains(message), "{text}\n{found}");
    }
    for bytes in [&b"\x1f\x8b\x08"[..], b"\xcd\x00"] {
        assert!(messages(bytes, &rib(bytes).unwrap_err()).contains("compressed or binary"));
    }
    let count = format!("Blobby 7 [1001 0] [{UNIT}] [\"\"] Blobbi AttributeBegin");
    let warnings = rib(count.as_bytes()).unwrap().warnings;
    let shown = messages(count.as_bytes(), &warnings);
    for part in [
        "says that it has 7 leaves, and has 1",
        "Blobbi is no request that is known; perhaps Blobby",
        "AttributeBegin has no end",
    ] {
        assert!(shown.contains(part), "{shown}");
    }
}

#[test]
fn hostile_files_end_soon() {
    let leaves = |count: usize| "1001 0 ".repeat(count);
    let doubling: String = (0..60).map(|k| format!("0 2 {k} {k} ")).collect();
    let chain: String = (0..100_000).map(|k| format!("7 {k} ")).collect();
    let opposites: String = (0..50_000).map(|k| format!("6 {k} ")).collect();
    let program = |codes: &str| format!("Blobby 1 [1001 0 {codes}] [{UNIT}] [\"\"]");
    let all = [
        program(&doubling),
        program(&chain),
        program(&opposites),
        program(&leaves(200_000)),
        program(&format!("{} 0 50000 {}", leaves(50_000), "0 ".repeat(50_000))),
        program(&format!("{} 1 200000 {}", leaves(1), "0 ".repeat(200_000))),
        "TransformBegin ".repeat(300_000),
        "[".repeat(1_000_000),
        "Color [".repeat(300_000),
        "\"".repeat(1_000_001),
        "# ".repeat(1_000_000),
        "1 ".repeat(6_000_000),
        format!("Blobby {}", "1 ".repeat(5_000_000)),
        "a ".repeat(1_000_000),
        "Blobbyx[] ".repeat(300_000),
        format!("Blobby 1 [1001 0] [{UNIT}] [\"\"] {}", "\"x\" [1] ".repeat(200_000)),
        "Scale 1e200 1e200 1e200 ".repeat(10) + &program(""),
        "Rotate 1e300 1 1e300 0 ".to_owned() + &program(""),
        program("").replace("1 0 0 0", "1e-200 0 0 0"),
        program("").replace("0 0 0 1", "0 0 0 1e-300"),
        "ObjectBegin 1 ".repeat(1000),
        "MotionBegin [0 1] ".to_owned() + &program(""),
    ];
    for text in all {
        let took = ends(rib, text.as_bytes());
        assert!(took < SOON, "{took:?}: {}", &text[..40.min(text.len())]);
    }
}

#[test]
fn maps_that_make_no_model_have_a_place() {
    let said = crate::common::no_model(rib, &format!("Scale 1e-300 1 1\nBlobby 1 [1001 0] [{UNIT}] [\"\"]"));
    assert!(said.starts_with("scene:2:1: error: the affine map is singular"), "{said}");
}
