//! `jbt contour`: drawings and images of slices.

use std::f64::consts::{FRAC_PI_4, FRAC_PI_8};
use std::path::Path;

use crate::folder::{Folder, SCENE};

const RING: &str = "jbt 1 color (1 0.5 0) { ring { ring_radius 1 surface_radius 0.25 } }";

fn folder() -> Folder {
    Folder::new().with("ring.jbt", RING).with("scene.jbt", SCENE)
}

fn text(folder: &Folder, name: &str) -> String {
    String::from_utf8(folder.read(name)).expect("text")
}

#[test]
fn drawings_have_loops_and_say_what_they_took() {
    let folder = folder();
    let ran = folder.jbt(&["contour", "ring.jbt", "-o", "a.svg"]).code(0);
    assert!(ran.stdout().starts_with("a.svg: 2 loops, 1 of them holes, "), "{}", ran.stdout());
    for word in ["area 3.14", "length 12.56", "cells", "squares", "evaluations", "time"] {
        assert!(ran.stdout().contains(word), "{word}: {}", ran.stdout());
    }
    let drawing = text(&folder, "a.svg");
    assert!(drawing.starts_with("<svg xmlns=") && drawing.ends_with("</svg>\n"));
    assert_eq!(drawing.matches("fill-rule=\"evenodd\"").count(), 1, "one area, with its hole");
    // The plane through the axis has two discs.
    let side =
        folder.jbt(&["contour", "ring.jbt", "--plane", "y=0", "-o", "b.svg", "--cell", "0.02", "--json"]);
    let report = side.code(0).json();
    assert_eq!((&report["loops"], &report["holes"]), (&2.into(), &0.into()));
    assert!((report["area"].as_f64().unwrap() - FRAC_PI_8).abs() < 1e-3, "{report}");
    for key in ["vertices", "field_evaluations", "full_evaluations", "ranges", "primitive_evaluations"] {
        assert!(report[key].as_u64().is_some_and(|count| count > 0), "{key}");
    }
    assert_eq!((&report["plane"], &report["cut_sides"]), (&"y=0".into(), &"".into()));
    let oblique = ["contour", "ring.jbt", "--plane", "0,0,0,1,1,0,0,0,1", "-o", "c.svg", "--json"];
    let oblique = folder.jbt(&oblique).code(0).json();
    assert!((oblique["area"].as_f64().unwrap() - FRAC_PI_8).abs() < 2e-3, "{oblique}");
}

#[test]
fn the_quadtree_is_drawn_down_to_cells() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/circles.jbt");
    let folder = folder();
    let scene = scene.display().to_string();
    let whole =
        ["contour", &scene, "--region", "-1.75,-1.75,1.75,1.75", "--quadtree", "-o", "a.svg", "--json"];
    let report = folder.jbt(&whole).code(0).json();
    assert_eq!((&report["loops"], &report["holes"]), (&5.into(), &0.into()));
    let squares = report["squares"].as_array().unwrap();
    assert_eq!(squares.len(), 9);
    assert_eq!((&squares[8]["cells"], &squares[8]["crossed"]), (&1.into(), &1534.into()));
    assert_eq!(text(&folder, "a.svg").matches("<circle").count(), 20);
}

#[test]
fn paints_are_colours_and_attributes() {
    let folder = folder();
    let draw = |options: &[&str]| {
        folder.jbt(&[&["contour", "ring.jbt", "-o", "a.svg", "-q"], options].concat()).code(0);
        text(&folder, "a.svg")
    };
    assert!(draw(&["--fill", "attribute"]).contains("fill=\"#ff8000\""));
    assert!(draw(&["--stroke", "#123456", "--fill", "none"]).contains("stroke=\"#123456\""));
    assert!(!draw(&["--fill", "none"]).contains("evenodd"));
    let lines = draw(&["--stroke", "attribute", "--attribute", "color", "--fill", "none"]);
    assert_eq!(lines.matches("stroke=\"#ff8000\"").count(), 2);
}

#[test]
fn images_have_every_mode() {
    let folder = folder();
    for mode in ["field", "grey", "height", "inside", "attribute"] {
        let ran =
            folder.jbt(&["contour", "ring.jbt", "--mode", mode, "--resolution", "50", "-o", "a.PNG"]).code(0);
        assert!(ran.stdout().starts_with("a.PNG: 50 x 50 pixels"), "{}", ran.stdout());
        assert!(folder.read("a.PNG").starts_with(b"\x89PNG"));
    }
    let smooth =
        ["contour", "ring.jbt", "--mode", "inside", "--samples", "4", "-o", "-", "--format", "png", "-q"];
    assert!(folder.jbt(&smooth).code(0).stdout_bytes().starts_with(b"\x89PNG"));
    let vm = "_0 var-x\n_1 var-y\n_2 mul _0 _0\n_3 mul _1 _1\n_4 add _2 _3\n_5 const 0.25\n_6 sub _4 _5\n";
    let folder = folder.with("disc.vm", vm);
    let disc = ["contour", "disc.vm", "--region", "-1,-1,1,1", "-o", "disc.svg", "--json"];
    let report = folder.jbt(&disc).code(0).json();
    assert!((report["area"].as_f64().unwrap() - FRAC_PI_4).abs() < 1e-3, "{report}");
}

#[test]
fn threads_and_engines_give_equal_slices() {
    let folder = folder();
    for (name, more) in [("a.svg", vec!["--fill", "attribute"]), ("a.png", vec!["--mode", "field"])] {
        let slices =
            [["1", "jit"], ["2", "jit"], ["7", "lanes"], ["2", "scalar"]].map(|[threads, engine]| {
                let arguments = [
                    "contour",
                    "scene.jbt",
                    "-o",
                    name,
                    "--resolution",
                    "60",
                    "--threads",
                    threads,
                    "--engine",
                    engine,
                ];
                folder.jbt(&[&arguments[..], &more[..]].concat()).code(0);
                folder.read(name)
            });
        assert!(slices.iter().all(|slice| *slice == slices[0]), "{name}");
    }
}

#[test]
fn what_is_cut_or_empty_is_told() {
    let folder = folder();
    let cut = ["contour", "ring.jbt", "-o", "a.svg", "--region", "0,0,2,2"];
    folder.jbt(&cut).code(0).says("the region cuts the solid at its sides -u -v");
    let far = ["contour", "ring.jbt", "-o", "a.svg", "--plane", "z=9"];
    folder.jbt(&far).code(0).says("jbt: warning: the slice is empty");
    assert!(text(&folder, "a.svg").ends_with("</svg>\n"));
}

#[test]
fn what_makes_no_sense_is_a_message() {
    let folder = folder().with("half.jbt", "jbt 1 half_space { radius 1 }").with(
        "empty.jbt",
        "jbt 1 intersection { point { radius 1 } translate (5 0 0) { point { radius 1 } } }",
    );
    let fails = |scene: &str, options: &[&str], code: i32, words: &str| {
        let ran = folder.jbt(&[&["contour", scene][..], options].concat()).code(code).says(words);
        assert_eq!(ran.stdout(), "");
    };
    let svg = ["-o", "a.svg"];
    fails("half.jbt", &svg, 2, "the model is unbounded: its slice needs a region; --region gives it one");
    fails("empty.jbt", &svg, 1, "the model is empty");
    fails("ring.jbt", &["-o", "a.pdf"], 2, "a.pdf does not end with .svg or .png");
    fails("ring.jbt", &["-o", "-"], 2, "needs --format svg or png");
    fails("ring.jbt", &["-o", "-", "--format", "svg", "--json"], 2, "cannot both go to the standard output");
    for bad in ["", "z", "w=1", "z=nan", "1,2,3", "0,0,0,1,0,0,2,0,0"] {
        fails("ring.jbt", &["-o", "a.svg", "--plane", bad], 2, "plane");
    }
    for bad in ["0,0,1", "0,0,0,1", "1,0,0,1", "0,0,nan,1", "0,0,1,inf", "a,b,c,d"] {
        fails("ring.jbt", &["-o", "a.svg", "--region", bad], 2, "--region");
    }
    fails("ring.jbt", &["-o", "a.svg", "--resolution", "0"], 2, "at least one cell");
    fails("ring.jbt", &["-o", "a.svg", "--cell", "-1"], 2, "greater than zero");
    fails("ring.jbt", &["-o", "a.svg", "--resolution", "2000000"], 3, "2000000 cells");
    fails("ring.jbt", &["-o", "a.png", "--resolution", "20000"], 3, "more than 67108864 points");
    fails("ring.jbt", &["-o", "a.svg", "--fill", "red"], 2, "expected `none`, `attribute`, or a colour");
    fails(
        "ring.jbt",
        &["-o", "a.svg", "--fill", "attribute", "--attribute", "rough"],
        2,
        "no attribute `rough`",
    );
    fails("ring.jbt", &["-o", "a.png", "--mode", "attribute", "--attribute", "x\u{1b}"], 2, "no attribute");
    fails("ring.jbt", &["-o", "a.svg", "--mode", "field"], 2, "--mode is for an image (.png)");
    fails("ring.jbt", &["-o", "a.png", "--quadtree"], 2, "--quadtree is for a drawing (.svg)");
    fails("ring.jbt", &["-o", "no/such/folder/a.svg"], 4, "cannot write");
    assert!(!folder.path("a.svg").exists() && !folder.path("a.png").exists());
}
