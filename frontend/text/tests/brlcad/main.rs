//! BRL-CAD databases: every published sample against points that other programs have judged, every solid
//! against its own inequality, and what strangers send.
//!
//! The samples are those of the folder `brlcad`, see `jbt_testkit::samples`.

mod solids;
mod write;

use jbt_model::walk::walk;
use jbt_testkit::samples;
use jbt_testkit::scene::assert_reads_back;
use jbt_text::Options;
use jbt_text::import::{Imported, brlcad};

use write::{COMPLEMENT, DIFFERENCE, EXCLUSIVE, INTERSECTION, MEMBER, UNION};
use write::{combination, file, list, record, solid};

fn of(object: &str) -> Options {
    Options { object: Some(object.to_owned()), ..Options::default() }
}

fn read(bytes: &[u8], options: &Options) -> Imported {
    brlcad(bytes, options).unwrap_or_else(|errors| panic!("{errors}"))
}

#[test]
fn every_sample_agrees_with_its_oracle() {
    let Some(folder) = samples::folder("brlcad") else { return };
    let mut tables = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let Some(stem) = name.strip_suffix(".oracle.csv") else { continue };
        let (file, object) = table_of(stem);
        let bytes = std::fs::read(folder.join(file)).unwrap();
        let scene = read(&bytes, &of(object));
        assert_eq!(scene.warnings.to_string(), "", "{name}");
        assert_reads_back(&scene.model);
        let tree = scene.model.check().unwrap_or_else(|errors| panic!("{name}: {errors}"));
        let (mut rows, mut wrong) = (0, Vec::new());
        for row in csv::Reader::from_path(&path).unwrap().deserialize() {
            let [x, y, z, inside, _, _, _, _, r, g, b]: [f64; 11] = row.unwrap();
            let found = walk(&tree, [x, y, z]);
            let is_inside = found.field >= 0.5;
            if is_inside != (inside == 1.0) {
                wrong.push(format!("{x} {y} {z}: field {}, inside {inside}", found.field));
            }
            if is_inside && !r.is_nan() {
                let color = &found.attributes[0];
                let off = [r, g, b].iter().zip(color).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                if off > 1e-9 {
                    wrong.push(format!("{x} {y} {z}: colour {color:?}, expected {r} {g} {b}"));
                }
            }
            rows += 1;
        }
        assert!(
            wrong.is_empty(),
            "{name}: {} of {rows} rows, {}",
            wrong.len(),
            wrong[..wrong.len().min(5)].join("\n")
        );
        assert!(rows >= 300, "{name}");
        tables += 1;
    }
    assert_eq!(tables, 18);
}

/// The file and the object of a table.
fn table_of(stem: &str) -> (&str, &str) {
    let ends = ["aet.asc", "moss.asc"];
    if let Some(file) = ends.iter().find(|file| stem.starts_with(**file)) {
        return (file, &stem[file.len() + 1..]);
    }
    let (file, object) = stem.split_once('.').unwrap();
    let file = FILES.iter().find(|name| name.split('.').next() == Some(file)).unwrap();
    (file, object)
}

/// The files that tables are named by.
const FILES: [&str; 15] = [
    "aet.asc",
    "arbs.g",
    "axis.asc",
    "bishop.asc",
    "boolean-ops.asc",
    "cup.g",
    "die.asc",
    "half_subtracts.g",
    "hilbert_3d.g",
    "matrix_tests.g",
    "moss_1.g",
    "operators.asc",
    "rook.g",
    "rounds.asc",
    "moss.asc",
];

/// Where the field says inside, of a few places.
fn inside(bytes: &[u8], options: &Options, places: &[[f64; 3]]) -> Vec<bool> {
    let tree = read(bytes, options).model.check().unwrap_or_else(|errors| panic!("{errors}"));
    places.iter().map(|&place| walk(&tree, place).field >= 0.5).collect()
}

fn ball(name: &str, x: f64) -> Vec<u8> {
    solid(name, 3, &[x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
}

/// A matrix that moves along x, with this last entry.
fn moved(x: f64, last: f64) -> Option<[f64; 16]> {
    Some([1.0, 0.0, 0.0, x, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, last])
}

/// Places in the first ball alone, in both, in the second alone, in none.
const PLACES: [[f64; 3]; 4] = [[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], [1.5, 0.0, 0.0], [3.0, 0.0, 0.0]];

#[test]
fn steps_are_operations_on_sets() {
    let pair = [("a", None), ("b", None)];
    for (steps, expected) in [
        (vec![], [true, true, true, false]),
        (vec![MEMBER, MEMBER, UNION], [true, true, true, false]),
        (vec![MEMBER, MEMBER, INTERSECTION], [false, true, false, false]),
        (vec![MEMBER, MEMBER, DIFFERENCE], [true, false, false, false]),
        (vec![MEMBER, MEMBER, EXCLUSIVE], [true, false, true, false]),
        (vec![MEMBER, MEMBER, COMPLEMENT, INTERSECTION], [true, false, false, false]),
    ] {
        let bytes = file([ball("a", 0.0), ball("b", 1.0), combination("c", &[], &pair, &steps)]);
        assert_eq!(inside(&bytes, &Options::default(), &PLACES), expected, "{steps:?}");
    }
    // A binary step pops the right operand first.
    let three = [("a", None), ("b", None), ("a", None)];
    let steps = [MEMBER, MEMBER, MEMBER, DIFFERENCE, UNION];
    let bytes = file([ball("a", 0.0), ball("b", 1.0), combination("c", &[], &three, &steps)]);
    assert_eq!(inside(&bytes, &Options::default(), &PLACES), [true, true, true, false]);
    for steps in [vec![MEMBER, UNION], vec![MEMBER, MEMBER], vec![MEMBER, MEMBER, UNION, MEMBER]] {
        let bytes = file([ball("a", 0.0), ball("b", 1.0), combination("c", &[], &pair, &steps)]);
        let error = brlcad(&bytes, &Options::default()).unwrap_err().to_string();
        assert!(error.contains("/c: its steps do not fit its members"), "{error}");
    }
}

#[test]
fn matrices_act_down_the_path_and_their_last_entry_divides() {
    let bytes = file([
        ball("a", 0.0),
        combination("c", &[], &[("a", moved(2.0, 1.0))], &[MEMBER]),
        // Half as large: the ball at 2 goes to 1, and is a half in radius.
        combination("d", &[], &[("c", moved(0.0, 2.0))], &[MEMBER]),
    ]);
    let places = [[0.6, 0.0, 0.0], [0.4, 0.0, 0.0], [1.4, 0.0, 0.0], [1.6, 0.0, 0.0]];
    assert_eq!(inside(&bytes, &of("d"), &places), [true, false, true, false]);
    let scene = read(&bytes, &of("d"));
    assert_eq!(scene.warnings.to_string(), "");
    // A scale by the upper part acts on radii as well here, and a warning says so.
    let twice = [2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let bytes = file([
        solid("rim", 1, &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.5]),
        combination("c", &[], &[("rim", Some(twice)), ("rim", Some(twice))], &[]),
    ]);
    let warnings = read(&bytes, &Options::default()).warnings.to_string();
    assert!(warnings.contains("warning: /c/rim: a matrix scales a solid with a radius"), "{warnings}");
    assert!(warnings.ends_with("and 1 more like it"), "{warnings}");
    for matrix in [[0.0; 16], {
        let mut m = twice;
        m[12] = 0.1;
        m
    }] {
        let bytes = file([ball("a", 0.0), combination("c", &[], &[("a", Some(matrix))], &[])]);
        let error = brlcad(&bytes, &Options::default()).unwrap_err().to_string();
        assert!(error.contains("error: /c/a: its matrix"), "{error}");
    }
}

#[test]
fn colours_belong_to_regions_and_to_what_is_above() {
    let region = |name: &str, color: &str, member: &str| {
        combination(name, &[("region", "R"), ("color", color)], &[(member, None)], &[])
    };
    let color = |bytes: &[u8], place: [f64; 3]| -> Vec<f64> {
        let tree = read(bytes, &of("top")).model.check().unwrap();
        walk(&tree, place).attributes[0].clone()
    };
    let (red, green, blue) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let part = combination("part", &[("rgb", "0/0/255")], &[("a", None)], &[]);
    // What is below a region changes nothing; a region's own colour replaces that from above.
    let bytes = file([
        ball("a", 0.0),
        part.clone(),
        region("r", "255/0/0", "part"),
        combination("top", &[("color", "0/255/0")], &[("r", None)], &[]),
    ]);
    assert_eq!(color(&bytes, PLACES[0]), red);
    // Unless that above is inherited.
    let bytes = file([
        ball("a", 0.0),
        part.clone(),
        region("r", "255/0/0", "part"),
        combination("top", &[("color", "0/255/0"), ("inherit", "1")], &[("r", None)], &[]),
    ]);
    assert_eq!(color(&bytes, PLACES[0]), green);
    // What is inherited is the colour and the shader: regions below keep their numbers.
    let numbered = combination(
        "r",
        &[("region", "R"), ("region_id", "7"), ("color", "255/0/0"), ("oshader", "plastic")],
        &[("part", None)],
        &[],
    );
    let above = [("color", "0/255/0"), ("inherit", "1"), ("oshader", "glass")];
    let bytes =
        file([ball("a", 0.0), part.clone(), numbered, combination("top", &above, &[("r", None)], &[])]);
    assert_eq!(color(&bytes, PLACES[0]), green);
    let constants = read(&bytes, &of("top")).model.check().unwrap().constants();
    let told: Vec<_> = constants.iter().map(|one| format!("{} {:?}", one.name, one.values)).collect();
    assert_eq!(told, ["region_id [Whole(7)]", "shader [Text(\"glass\")]"]);
    // Without a region the lowest colour counts.
    let bytes =
        file([ball("a", 0.0), part, combination("top", &[("color", "0/255/0")], &[("part", None)], &[])]);
    assert_eq!(color(&bytes, PLACES[0]), blue);
    // What is subtracted gives no colour: near the cut, the first ball has its own.
    let bytes = file([
        ball("a", 0.0),
        ball("b", 1.0),
        region("r", "255/0/0", "a"),
        region("s", "0/0/255", "b"),
        combination("top", &[], &[("r", None), ("s", None)], &[MEMBER, MEMBER, DIFFERENCE]),
    ]);
    assert_eq!(color(&bytes, [-0.02, 0.0, 0.0]), red);
    let text = "title {t}\nput {a} ell V {0 0 0} A {1 0 0} B {0 1 0} C {0 0 1}\n\
                put {top} comb region yes region_id 1005 tree {l a}\ncolor 1000 1999 0 255 0\n";
    assert_eq!(color(text.as_bytes(), PLACES[0]), green);
}

#[test]
fn what_cannot_be_read_is_a_warning_with_its_path() {
    let mesh = |name: &str| record(name, 1, 30, &[], &[0; 16]);
    let pair =
        |steps: &[u8], second: &'static str| combination("top", &[], &[("a", None), (second, None)], steps);
    for (second, message) in [
        ("gone", "warning: /top/gone: there is no object `gone`; the set is made without it"),
        ("hull", "warning: /top/hull: a bot has no counterpart here; it is left out"),
        ("flat", "warning: /top/flat: this ell is no solid: its vectors are in one plane; it is left out"),
    ] {
        let with = |steps: &[u8]| {
            let flat = solid("flat", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
            file([ball("a", 0.0), mesh("hull"), flat, pair(steps, second)])
        };
        for steps in [[MEMBER, MEMBER, UNION], [MEMBER, MEMBER, DIFFERENCE], [MEMBER, MEMBER, EXCLUSIVE]] {
            let bytes = with(&steps);
            assert_eq!(inside(&bytes, &of("top"), &PLACES), [true, true, false, false]);
            let warnings = read(&bytes, &of("top")).warnings.to_string();
            assert!(warnings.starts_with("<text>: byte ") && warnings.ends_with(message), "{warnings}");
        }
        let error = brlcad(&with(&[MEMBER, MEMBER, INTERSECTION]), &of("top")).unwrap_err().to_string();
        assert!(error.contains("`top` has no solid that can be read") && error.contains(message), "{error}");
    }
    // Said once, with the number of places.
    let uses: Vec<(&str, Option<[f64; 16]>)> = [("a", None)].into_iter().chain([("gone", None); 7]).collect();
    let bytes = file([ball("a", 0.0), combination("top", &[], &uses, &[])]);
    let warnings = read(&bytes, &Options::default()).warnings.to_string();
    assert_eq!(warnings.lines().count(), 1);
    assert!(warnings.ends_with(", and 6 more like it"), "{warnings}");
}

#[test]
fn objects_are_chosen_by_name_or_by_being_nobody_s_part() {
    let bytes = file([
        ball("a", 0.0),
        ball("b", 1.0),
        ball("alone", 10.0),
        combination("c", &[], &[("a", None), ("b", None)], &[MEMBER, MEMBER, DIFFERENCE]),
    ]);
    let places = [PLACES[0], PLACES[2], [10.0, 0.0, 0.0]];
    assert_eq!(inside(&bytes, &Options::default(), &places), [true, false, true]);
    assert_eq!(inside(&bytes, &of("c"), &places), [true, false, false]);
    assert_eq!(inside(&bytes, &of("b"), &places), [false, true, false]);
    let error = brlcad(&bytes, &of("alnoe")).unwrap_err().to_string();
    assert!(error.contains("the file has no object `alnoe`") && error.contains("perhaps `alone`"), "{error}");
    let twice = file([ball("a", 0.0), ball("a", 5.0)]);
    assert!(read(&twice, &Options::default()).warnings.to_string().contains("a second object is called `a`"));
    assert_eq!(inside(&twice, &Options::default(), &[PLACES[0], [5.0, 0.0, 0.0]]), [true, false]);
}

/// Nodes have the names of their objects, through a text and back.
#[test]
fn names_survive() {
    let bytes = file([
        ball("s.1", 0.0),
        ball("let", 4.0),
        ball("2", 8.0),
        combination("hull.r", &[], &[("s.1", None), ("let", moved(1.0, 1.0))], &[MEMBER, MEMBER, UNION]),
        combination("all", &[], &[("hull.r", None), ("hull.r", moved(20.0, 1.0)), ("2", None)], &[]),
    ]);
    let model = read(&bytes, &of("all")).model;
    let printed = jbt_text::parse(jbt_text::print(&model).as_bytes(), &Options::default()).unwrap();
    for model in [&model, &printed] {
        for (path, places) in
            [("all", 1), ("all/hull_r", 2), ("all/hull_r.1/s_1", 1), ("hull_r/o_let", 2), ("all/o_2", 1)]
        {
            let found = model.check().unwrap().find(path).unwrap_or_else(|error| panic!("{path}: {error}"));
            assert_eq!(found.len(), places, "{path}");
        }
        let hull = model.only("all/hull_r.0").unwrap().check().unwrap();
        let is_inside = |x: f64| walk(&hull, [x, 0.0, 0.0]).field >= 0.5;
        assert_eq!([0.0, 5.0, 8.0, 20.0].map(is_inside), [true, true, false, false]);
    }
}

#[test]
fn circles_are_errors_with_their_path() {
    let link = |name: &str, to: &'static str| combination(name, &[], &[("a", None), (to, None)], &[]);
    let circle = [ball("a", 0.0), link("one", "two"), link("two", "three"), link("three", "two")];
    for options in [of("one"), Options::default()] {
        let error = brlcad(&file(circle.clone()), &options).unwrap_err().to_string();
        assert!(error.contains("an object contains itself: /two/three/two"), "{error}");
    }
    // One that nobody outside of it refers to is no root, and not forgotten.
    let error = brlcad(&file(circle[..1].iter().cloned().chain([link("b", "b")])), &Options::default());
    assert!(error.unwrap_err().to_string().contains("/b/b"));
    assert!(brlcad(&file(circle), &of("a")).is_ok());
}

#[test]
fn text_of_both_versions_says_the_same() {
    let five = "# by hand {\n\ntitle {of cups}\nunits in\n# a comment; {\n\
        put {a} ell V {0 0 0} A {1 0 0} B {0 1 0} C {0 0 1}\n\
        put {pin} part V {0 0 0} H {0 0 2} r_v 0.5 r_h 0.25; put {eight} arbn N 6 P0 {1 0 0 1} P1 {-1 0 0 1} \
        P2 {0 1 0 1} P3 {0 -1 0 1} P4 {0 0 1 1} P5 {0 0 -1 1}\n\
        put {tube} pipe V0 {0 0 0} O0 1 I0 0.5 R0 0 V1 {3 0 0} O1 1 I1 0.5 R1 0\n\
        put {top} comb region no tree {u {- {l a} {l pin {1 0 0 0.5  0 1 0 0  0 0 1 0\n 0 0 0 1}}} {+ {l eight} {l tube}}}\n\
        attr set {top} {color} {255/0/0} {shader} plastic\nfoo bar\n";
    let four = "I 0 v4\nof cups\n\
        S 19 a 0 0 0 0 1 0 0 0 1 0 0 0 1 0 0 0 0 0 0 0 0 0 0 0 0\n\
        p pin 0 0 0 0 0 2 0.5 0.25\n\
        n eight 6\nn 1 0 0 1\nn -1 0 0 1\nn 0 1 0 1\nn 0 -1 0 1\nn 0 0 1 1\nn 0 0 -1 1\n\
        w tube\n0.5 1 0 0 0 0\n0.5 1 0 3 0 0\nEND_PIPE tube\n\
        C N top 0 0 4 0 0 0 1 255 0 0 1 0 0\nplastic\n\
        M - a 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0\n\
        M - pin 1 0 0 0.5 0 1 0 0 0 0 1 0 0 0 0 1 0\n\
        M u eight 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0\n\
        M + tube 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0\n";
    let [five, four] = [five, four].map(|text| read(text.as_bytes(), &Options::default()));
    assert_eq!(five.model, four.model);
    assert!(five.warnings.to_string().contains("1 commands `foo` are left out"), "{}", five.warnings);
    assert_eq!(four.warnings.to_string(), "");
    let crlf = read("I 0 v4\r\nx\r\nS 19 a 0 0 0 0 1 0 0 0 1 0 0 0 1\r\n".as_bytes(), &Options::default());
    assert!(crlf.model.check().is_ok());
}

#[test]
fn mistakes_in_text_have_their_place() {
    for (text, expected) in [
        ("put {a} ell V {0 0} A {1 0 0} B {0 1 0} C {0 0 1}", "<text>:1:16: error: `V` has 2 numbers"),
        (
            "put {a} ell V {0 0 x} A {1 0 0} B {0 1 0} C {0 0 1}",
            "<text>:1:20: error: `x` is no finite number",
        ),
        ("put {a} ell V {0 0 nan} A {1 0 0} B {0 1 0} C {0 0 1}", "error: `nan` is no finite number"),
        ("put {a} ell V {0 0 0}", "<text>:1:9: error: the ell has no `A`"),
        ("units mm\nput {a} comb tree {u {l b} {x c}}", "<text>:2:29: error: there is no operation `x`"),
        ("put {a} comb tree {u {l b}}", "error: `u` has 1 operands"),
        ("put {a} comb tree {u {l b} {l c}", "<text>:1:19: error: this has no end"),
        ("put {a} comb tree {l b {1 2}}", "error: the matrix has 2 numbers"),
        ("put {a} comb tree {u {l b} {l c}}}", "error: the value of `}` is missing"),
        ("I 0 v4\nt\nS 19 a 0 0 0 0 1 0 0", "<text>:3:21: error: a number is missing"),
        ("I 0 v4\nt\nC N c 0 0 1 0 0 0 0\nM ? a 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0", ""),
        ("I 0 v4\nt\nw p\n1 1 0 0 0 0\n", "error: the pipe has no end"),
        ("title {x}", "error: the file has no solid that can be read"),
        ("hello", "error: this is no BRL-CAD database"),
    ] {
        let error = brlcad(text.as_bytes(), &Options::default()).unwrap_err().to_string();
        assert!(error.contains(expected), "{text}: {error}");
    }
}

#[test]
fn hostile_files_end_soon() {
    let mut files: Vec<Vec<u8>> = Vec::new();
    let good = file([
        ball("a", 0.0),
        list("p", 15, &[2], &[0.0, 0.0, 0.0, 0.5, 1.0, 0.0, 3.0, 0.0, 0.0, 0.5, 1.0, 0.0]),
        combination(
            "c",
            &[("color", "1/2/3")],
            &[("a", moved(1.0, 1.0)), ("p", None)],
            &[MEMBER, MEMBER, UNION],
        ),
    ]);
    let text = b"title {x}\nput {a} ell V {0 0 0} A {1 0 0} B {0 1 0} C {0 0 1}\nput {c} comb region yes tree {u {l a} {l a {1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1}}}\n";
    let lines = b"I 0 v4\nx\nS 19 a 0 0 0 0 1 0 0 0 1 0 0 0 1\nC N c 0 0 1 0 0 0 0 0 0 0\nM u a 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0\n";
    for whole in [&good[..], text, lines] {
        files.extend((0..20).map(|part| whole[..whole.len() * part / 20].to_vec()));
    }
    // Every byte of the binary file turned over, one at a time.
    for at in 0..good.len() {
        for value in [0, 0xff, good[at] ^ 0x80] {
            let mut broken = good.clone();
            broken[at] = value;
            files.push(broken);
        }
    }
    // Counts that no file holds.
    files.push(file([list("p", 15, &[u32::MAX], &[])]));
    files.push(file([list("p", 14, &[u32::MAX], &[1.0; 8])]));
    files.push(file([list("m", 36, &[u32::MAX, 1], &[1.0; 8])]));
    files.push(file([record("c", 1, 31, &[], &[3; 41])]));
    files.push(file([record("c", 1, 31, &[], &[[3].as_slice(), &[0xff; 64]].concat())]));
    files.push(file([solid("a", 3, &[f64::NAN; 12])]));
    files.push(file([solid("a", 3, &[1e300; 12])]));
    files.push(file([solid("a", 4, &[0.0; 24])]));
    // Planes without number, members without number.
    files.push(file([list("p", 14, &[5000], &[1.0; 20_000])]));
    let many: Vec<(&str, Option<[f64; 16]>)> = vec![("c", None); 200_000];
    files.push(file([ball("a", 0.0), combination("c", &[], &many, &[])]));
    // Deep nests: of braces, of combinations, of operations.
    let deep = 100_000;
    let nest = |open: &str, close: &str| {
        format!("put {{c}} comb tree {{{}l a{}}}", open.repeat(deep), close.repeat(deep))
    };
    files.push(nest("! {", "}").into_bytes());
    files.push(nest("{", "}").into_bytes());
    files.push(format!("put {{a}} comb tree {{{}l a", "- {".repeat(deep)).into_bytes());
    let chain = |at: usize| combination(&format!("c{at}"), &[], &[(&format!("c{}", at + 1), None)], &[]);
    files.push(file((0..deep).map(chain).chain([ball(&format!("c{deep}"), 0.0)])));
    let doubled = |at: usize| {
        let next = format!("c{}", at + 1);
        combination(&format!("c{at}"), &[], &[(&next, moved(1.0, 1.0)), (&next, moved(2.0, 1.0))], &[])
    };
    files.push(file((0..64).map(doubled).chain([ball("c64", 0.0)])));
    for bytes in files {
        let start = std::time::Instant::now();
        if let Ok(scene) = brlcad(&bytes, &Options::default()) {
            let _ = scene.model.check();
        }
        let shown = String::from_utf8_lossy(&bytes[..bytes.len().min(60)]).into_owned();
        assert!(start.elapsed().as_secs_f64() < 5.0, "{shown}: {:?}", start.elapsed());
    }
}

#[test]
fn regions_have_their_numbers_as_constants() {
    let told = |bytes: &[u8], p: [f64; 3]| -> Vec<String> {
        let imported = read(bytes, &Options::default());
        assert_reads_back(&imported.model);
        let tree = imported.model.check().unwrap();
        let owner = jbt_model::owner::owner(&tree, p).unwrap();
        owner.constants(&tree).into_iter().map(|(name, value)| format!("{name} {value}")).collect()
    };
    let attributes = [
        ("region", "R"),
        ("region_id", "1001"),
        ("aircode", "0"),
        ("giftmater", "7"),
        ("material_name", "mild \"steel\""),
        ("oshader", "plastic {sp 0.5}"),
    ];
    let bytes = file([
        ball("a", 0.0),
        ball("b", 10.0),
        combination("r", &attributes, &[("a", None)], &[]),
        combination("s", &[("region", "R"), ("region_id", "1002"), ("aircode", "3")], &[("b", None)], &[]),
        combination("all", &[("shader", "glass"), ("region_id", "5")], &[("r", None), ("s", None)], &[]),
    ]);
    let expected =
        ["material \"mild 'steel'\"", "material_id 7", "region_id 1001", "shader \"plastic {sp 0.5}\""];
    assert_eq!(told(&bytes, PLACES[0]), expected);
    assert_eq!(told(&bytes, [10.0, 0.0, 0.0]), ["aircode 3", "region_id 1002", "shader \"glass\""]);
    // The same in the texts of both versions.
    let text = "title {t}\nput {a} ell V {0 0 0} A {1 0 0} B {0 1 0} C {0 0 1}\n\
                put {top} comb region yes region_id 1005 air 2 mat 4 tree {l a}\n";
    assert_eq!(told(text.as_bytes(), PLACES[0]), ["aircode 2", "material_id 4", "region_id 1005"]);
    // Numbers that no reader of a file would get as they are make no constants.
    let beyond = text.replace("mat 4", "mat -9223372036854775808");
    assert_eq!(told(beyond.as_bytes(), PLACES[0]), ["aircode 2", "region_id 1005"]);
    let numbers = "0 0 0 1 0 0 0 1 0 0 0 1 0 0 0 0 0 0 0 0 0 0 0 0";
    let matrix = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1";
    let text = format!(
        "I 0 v4\nt\nS 19 a 0 {numbers}\nC Y top 1006 9 1 0 8 100 0 0 0 0 1 0 0\nmirror re=0.9\nM u a {matrix} 0\n"
    );
    let expected = ["aircode 9", "material_id 8", "region_id 1006", "shader \"mirror re=0.9\""];
    assert_eq!(told(text.as_bytes(), PLACES[0]), expected);
}
