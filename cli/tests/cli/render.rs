//! `jbt render`: files, streams, reports, and what it refuses.

use crate::folder::{Folder, SCENE};

/// A small picture.
const SMALL: [&str; 6] = ["--size", "40x30", "--antialias", "1", "--quality", "draft"];

fn folder() -> Folder {
    Folder::new().with("scene.jbt", SCENE)
}

fn render<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["render", "scene.jbt", "-o", "a.png"], &SMALL[..], more].concat()
}

/// Width and height of a PNG file.
fn size(png: &[u8]) -> [u32; 2] {
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"), "a PNG file");
    [16, 20].map(|at| u32::from_be_bytes(png[at..at + 4].try_into().unwrap()))
}

#[test]
fn render_writes_a_picture_and_says_what_it_took() {
    let folder = folder();
    let ran = folder.jbt(&render(&[])).code(0);
    assert!(ran.stdout().starts_with("a.png: 40 x 30 pixels, "), "{}", ran.stdout());
    for word in ["of them hit", "camera", "rays", "primitives", "to compile", "to trace", "in total"] {
        assert!(ran.stdout().contains(word), "{word}: {}", ran.stdout());
    }
    assert_eq!(ran.stderr(), "");
    assert_eq!(size(&folder.read("a.png")), [40, 30]);
    let quiet = ["render", "scene.jbt", "-o", "b.png", "--quiet"];
    let quiet = folder.jbt(&[&quiet[..], &SMALL].concat()).code(0);
    assert_eq!((quiet.stdout(), quiet.stderr()), (String::new(), String::new()));
    assert_eq!(folder.read("a.png"), folder.read("b.png"));
}

#[test]
fn render_reports_for_machines() {
    let report = folder().jbt(&render(&["--json"])).code(0).json();
    let count = |value: &serde_json::Value| value.as_u64().expect("a count");
    assert_eq!((count(&report["width"]), count(&report["height"]), count(&report["pixels"])), (40, 30, 1200));
    assert!((100..1100).contains(&count(&report["pixels_hit"])));
    let rays = &report["rays"];
    assert_eq!(count(&rays["total"]), count(&rays["camera"]));
    assert!(count(&report["evaluations"]) > count(&rays["camera"]));
    for key in ["evaluations_per_pixel", "tolerance", "compile_ms", "frame_ms", "trace_ms", "total_ms"] {
        assert!(report[key].as_f64().is_some_and(|number| number > 0.0), "{key}");
    }
    assert_eq!(report["camera"]["eye"].as_array().map(Vec::len), Some(3));
    assert_eq!((&report["engine"], &report["range"]), (&"jit".into(), &serde_json::Value::Null));
    assert_eq!(report["warnings"], serde_json::json!([]));
}

#[test]
fn render_has_modes_and_views() {
    let folder = folder();
    for (mode, said) in [
        (&["shaded", "--background", "#fff"][..], "in total"),
        (&["normal", "--view", "top"], "in total"),
        (&["depth", "--view", "-1,0.5,-2"], "distances from white to dark: from "),
        (&["attribute", "rough"], "`rough` from blue to yellow: from "),
        (&["attribute", "color", "--orthographic"], "in total"),
        (&["evaluations", "--zoom", "2"], "evaluations of a pixel, from black to yellow: from "),
    ] {
        let ran = folder.jbt(&render(&[&["--mode"], mode].concat())).code(0);
        assert!(ran.stdout().contains(said), "{mode:?}: {}", ran.stdout());
    }
    let camera = ["--eye", "4,-1,2", "--target", "0.5,0.5,0", "--up", "0,1,0", "--lens", "40"];
    let report = folder.jbt(&render(&[&camera[..], &["--json"]].concat())).code(0).json();
    assert_eq!(report["camera"]["eye"], serde_json::json!([4.0, -1.0, 2.0]));
}

#[test]
fn threads_and_engines_give_equal_pictures() {
    let folder = folder();
    let pictures = [["1", "jit"], ["2", "jit"], ["2", "lanes"]].map(|[threads, engine]| {
        folder.jbt(&render(&["--threads", threads, "--engine", engine])).code(0);
        folder.read("a.png")
    });
    assert!(pictures[0] == pictures[1] && pictures[0] == pictures[2]);
}

#[test]
fn a_picture_goes_to_the_standard_output() {
    let folder = folder();
    folder.jbt(&render(&[])).code(0);
    let arguments = [&["render", "-", "-o", "-"], &SMALL[..]].concat();
    let ran = folder.jbt_with_input(&arguments, SCENE.as_bytes()).code(0);
    assert!(ran.stderr().starts_with("<stdout>: 40 x 30 pixels"), "{}", ran.stderr());
    assert!(ran.stdout_bytes() == folder.read("a.png"));
    folder
        .jbt(&["render", "scene.jbt", "-o", "-", "--json"])
        .code(2)
        .says("the picture and the JSON report cannot both go to the standard output");
}

#[test]
fn nothing_in_view_is_a_picture_with_a_warning() {
    let folder = folder().with(
        "empty.jbt",
        "jbt 1 intersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }",
    );
    let away = ["--eye", "5,5,5", "--target", "6,6,6"];
    folder.jbt(&render(&away)).code(0).says("jbt: warning: the picture is empty: the camera sees no surface");
    let json = folder.jbt(&render(&[&away[..], &["--json"]].concat())).code(0).json();
    assert_eq!((&json["pixels_hit"], json["warnings"].as_array().map(Vec::len)), (&0.into(), Some(1)));
    let empty = folder.jbt(&["render", "empty.jbt", "-o", "b.png", "--size", "8"]).code(0);
    empty.says("no point of the model is inside");
    assert_eq!(size(&folder.read("b.png")), [8, 8]);
}

#[test]
fn what_makes_no_sense_leaves_the_old_file() {
    let folder = folder()
        .with("half.jbt", "jbt 1 half_space { normal (1 1 1) radius 1 }")
        .with("bad.jbt", "jbt 1\npoint { radius 0 }")
        .with("a.png", "old");
    for (more, code, words) in [
        (&["--size", "0x5"][..], 2, "at least one pixel along each side, and this one is 0 x 5"),
        (&["--size", "20000"], 3, "and this one is 20000 x 20000"),
        (&["--size", "wide"], 2, "expected WIDTHxHEIGHT"),
        (&["--antialias", "99"], 3, "and not 99 x 99"),
        (&["--view", "above"], 2, "three-quarter, iso, front"),
        (&["--view", "0,0,0"], 2, "the camera's direction is no direction"),
        (&["--up", "1,-0.62,0.5"], 2, "looks along its up direction"),
        (&["--eye", "nan,0,0", "--target", "0,0,0"], 2, "the camera's eye must be a finite number"),
        (&["--eye", "1,2,3", "--target", "1,2,3"], 2, "eye and target are both at (1, 2, 3)"),
        (&["--eye", "1,2,3"], 2, "--target"),
        (&["--eye", "0.5,0,0", "--target", "0,0,0"], 2, "the camera stands inside the solid, at (0.5, 0, 0)"),
        (&["--lens", "-3"], 2, "less than 180 degrees, and it is -3"),
        (&["--zoom", "0"], 2, "zoom must be greater than 0"),
        (
            &["--mode", "pretty"],
            2,
            "there is no mode `pretty`; there are shaded, normal, depth, owner, attribute NAME and",
        ),
        (&["--mode", "attribute"], 2, "needs the name of an attribute"),
        (&["--mode", "attribute", "shine"], 2, "no attribute `shine`; it has color, rough"),
        (&["--background", "mauve"], 2, "expected studio, transparent, #rrggbb"),
    ] {
        // Of an option that stands twice, clap refuses the second.
        let small: &[&str] = if more[0] == "--size" { &[] } else { &["--size", "8"] };
        let arguments = [&["render", "scene.jbt", "-o", "a.png"], small, more].concat();
        folder.jbt(&arguments).code(code).says(words);
    }
    folder.jbt(&["render", "half.jbt", "-o", "a.png"]).code(2).says("needs a region; --region gives it one");
    folder.jbt(&["render", "bad.jbt", "-o", "a.png"]).code(1).says("bad.jbt:2:");
    assert_eq!(folder.read("a.png"), b"old");
    let region = ["--size", "8", "--region", "-1,-1,-1,1,1,1"];
    folder.jbt(&[&["render", "half.jbt", "-o", "a.png"], &region[..]].concat()).code(0);
    assert_eq!(size(&folder.read("a.png")), [8, 8]);
    folder
        .jbt(&["render", "scene.jbt", "-o", "none/a.png", "--size", "8"])
        .code(4)
        .says("cannot write none/a.png");
}
