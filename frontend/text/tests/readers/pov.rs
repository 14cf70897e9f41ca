//! POV-Ray scenes.

use std::time::{Duration, Instant};

use jbt_model::diagnostic::Diagnostics;
use jbt_model::model::Model;
use jbt_model::walk::walk;
use jbt_testkit::samples;
use jbt_text::Options;
use jbt_text::import::{self, Imported};

use crate::common::{SOON, bad, compare, ends, field, files, good, messages, near, truncated};

fn pov(bytes: &[u8]) -> Result<Imported, Diagnostics> {
    import::pov(bytes, &Options::default())
}

/// A declared object.
fn object(bytes: &[u8], name: &str) -> Imported {
    let options = Options { object: Some(name.to_owned()), ..Options::default() };
    import::pov(bytes, &options).unwrap_or_else(|errors| panic!("{}", messages(bytes, &errors)))
}

/// Whether no negative component reaches a point: POV-Ray lets them give their colours too.
fn is_positive(model: &Model) -> impl Fn([f64; 3]) -> bool {
    let negative = model.root.map_primitives(|leaf| leaf.strength = (-leaf.strength).max(0.0));
    let tree = Model { root: negative, ..model.clone() }.check().unwrap();
    move |place| walk(&tree, place).field == 0.0
}

#[test]
fn every_sample_agrees_with_its_table() {
    let Some(folder) = samples::folder("pov") else { return };
    let files = files(&folder, "pov");
    let mut tables = 0;
    for (name, bytes) in &files {
        truncated(pov, bytes);
        let stem = name.trim_end_matches(".pov");
        let objects: &[&str] = match stem {
            "bounding" => &["Group1"],
            "glassthing" => &["ObjX"],
            "potential" => &["BlobCenter", "BlobLeft", "BlobRight"],
            _ => &[""],
        };
        for chosen in objects {
            let (imported, table) = if chosen.is_empty() {
                (good(pov, bytes), format!("{stem}.oracle.csv"))
            } else {
                (object(bytes, chosen), format!("{stem}.{chosen}.oracle.csv"))
            };
            let positive = is_positive(&imported.model);
            compare(&imported.model, &folder.join(table), ["r", "g", "b"], 1e-8, &positive);
            tables += 1;
        }
    }
    assert_eq!((files.len(), tables), (8, 10));
}

const FLOWER: &[u8] = include_bytes!("files/flower.pov");

/// The falloff of all components, of a squared distance.
fn quartic(square: f64) -> f64 {
    (1.0 - square).max(0.0).powi(2)
}

#[test]
fn components_and_their_transformations() {
    let blob = |inner: &str| format!("blob {{ threshold 0.5 {inner} }}");
    let at = |inner: &str, p: [f64; 3]| field(pov, &blob(inner), p);
    near(at("sphere { <1, 0, 0>, 2, 3 }", [1.0, 1.0, 0.0]), 3.0 * quartic(0.25));
    near(at("sphere { 1 2 strength 3 }", [1.0, 1.0, 2.0]), 3.0 * quartic(0.25));
    near(at("component 3, 2, <1, 0, 0>", [1.0, 1.0, 0.0]), 3.0 * quartic(0.25));
    near(at("cylinder { -x, x, 1, 1 }", [1.5, 0.0, 0.0]), quartic(0.25));
    near(at("cylinder { 0, 0, 1, 1 }", [0.5, 0.0, 0.0]), quartic(0.25));
    near(at("sphere { 0, 1, 1 scale <2, 0, 1> }", [1.0, 0.0, 0.0]), quartic(0.25));
    near(at("sphere { x, 1, 1 rotate 90*z }", [0.0, 1.0, 0.0]), 1.0);
    near(at("sphere { y, 1, 1 rotate <90, 90, 0> }", [1.0, 0.0, 0.0]), 1.0);
    near(at("sphere { x, 1, 1 translate y scale 2 }", [2.0, 2.0, 0.0]), 1.0);
    near(at("sphere { x, 1, 1 } rotate -90*z translate x", [1.0, -1.0, 0.0]), 1.0);
    near(at("sphere { x, 1, 1 matrix <0, 1, 0, 1, 0, 0, 0, 0, 1, 5, 6, 7> }", [5.0, 7.0, 7.0]), 1.0);
    near(at("sphere { 0, 1, 1 } sphere { 0, 1, -0.25 } sturm hierarchy off", [0.0; 3]), 0.75);
    // One without strength is left out.
    let text = blob("sphere { 0, 1, 1 } sphere { 0, 1, 0 } component 1 0 0");
    let imported = good(pov, text.as_bytes());
    assert!(messages(text.as_bytes(), &imported.warnings).contains("is left out (2 times)"));
}

/// The value of an expression: the strength of a component at its centre.
fn value(before: &str, expression: &str) -> f64 {
    let text = format!("{before}\nblob {{ sphere {{ 0, 1, {expression} }} }}");
    walk(&good(pov, text.as_bytes()).model.check().unwrap(), [0.0; 3]).field
}

#[test]
fn expressions() {
    for (expression, expected) in [
        ("1 + 2*3 - 4/2", 5.0),
        ("-2*-3", 6.0),
        ("2 - -1", 3.0),
        ("(1 + 2)*3", 9.0),
        (".5 + 5. + 1e1", 15.5),
        ("<1, 2, 3>.y", 2.0),
        ("(<1, 2, 3>*2 + 1).z", 7.0),
        ("(x + 2*y).y", 2.0),
        ("vlength(3*x + 4*y)", 5.0),
        ("vdot(<1, 2, 3>, 2)", 12.0),
        ("vcross(x, y).z", 1.0),
        ("vrotate(x, 90*z).y", 1.0),
        ("vaxis_rotate(x, 3*z, 90).y", 1.0),
        ("(vnormalize(3*z)).z", 1.0),
        ("max(1, 7, 3) + min(4, 2)", 9.0),
        ("mod(7, 4) + div(7, 4) + int(-1.5) + floor(2.5) + ceil(2.5)", 8.0),
        ("sqr(3) + sqrt(16) + pow(2, 5) + abs(-1)", 46.0),
        ("log(100) + ln(exp(2))", 4.0),
        ("degrees(pi) + radians(180)/pi", 181.0),
        ("sin(pi/2) + cos(0) + atan2(0, 1)", 2.0),
        ("(1 < 2 ? 5 : 6)", 5.0),
        ("(0 ? 5 : 1 ? 6 : 7)", 6.0),
        ("(1 = 1 & !(2 != 2) | 0)", 1.0),
        ("((1 <= 1) + (2 >= 3) + (3 > 2))", 2.0),
        ("yes + on + true - no", 3.0),
        ("Red.red + Gray50.green", 1.5),
    ] {
        near(value("", expression), expected);
    }
    near(value("#declare A = 2; #local B = <1, A, 3>*2", "B.y + A"), 6.0);
    near(value("#declare C = color rgb <0.5, 0.25, 0> + 0.5;", "C.x"), 1.0);
    near(value("#declare C = srgb 0.5;", "C.x"), 0.21404114048223255);
}

#[test]
fn random_numbers_are_those_of_the_original() {
    // s = 1812433253 s + 12345 modulo 2^32, from the seed; the number is s / (2^32 - 1).
    let next = |s: u32| s.wrapping_mul(1_812_433_253).wrapping_add(12_345);
    let (a, b) = (next(7), next(next(7)));
    let number = |s: u32| f64::from(s) / f64::from(u32::MAX);
    let before = "#declare S = seed(7);";
    near(value(before, "rand(S)"), number(a));
    near(value(before, "(rand(S) + 10*rand(S))"), number(a) + 10.0 * number(b));
    // What is left out calls for them too.
    near(value(&format!("{before} box {{ <0, rand(S), 1>, 1 }}"), "rand(S)"), number(b));
}

#[test]
fn loops_and_choices() {
    let count = |before: &str| value(&format!("#declare N = 0; {before}"), "N + 1") - 1.0;
    near(count("#while (N < 5) #declare N = N + 1; #end"), 5.0);
    near(count("#for (I, 1, 4) #declare N = N + I; #end"), 10.0);
    near(count("#for (I, 1, 0, -0.25) #declare N = N + I; #end"), 2.5);
    near(count("#for (I, 1, 0) #declare N = 9; #end"), 0.0);
    near(count("#if (0) #declare N = 1; #elseif (1) #declare N = 2; #else #declare N = 3; #end"), 2.0);
    near(count("#if (1) #if (0) #else #declare N = 4; #end #else #declare N = 3; #end"), 4.0);
    near(count("#ifdef (N) #declare N = 7; #end #ifndef (N) #declare N = 8; #end"), 7.0);
    near(count("#undef N #ifndef (N) #declare N = 8; #end"), 8.0);
    near(
        count(
            "#switch (3) #case (1) #declare N = 1; #break #range (2, 4) #declare N = 2; #break #else #declare N = 3; #end",
        ),
        2.0,
    );
    near(
        count(
            "#switch (1) #case (1) #declare N = 1; #case (2) #declare N = N + 1; #break #case (3) #declare N = 9; #end",
        ),
        2.0,
    );
    near(count("#while (1) #declare N = N + 1; #if (N > 6) #break #end #end"), 7.0);
    near(count("#while (N < 3) #for (I, 1, 2) #end #declare N = N + 1; #end // #end"), 3.0);
    let inside = "blob { #declare N = 0; #while (N < 4) sphere { N*x*10, 1, 1 } #declare N = N + 1; #end }";
    near(field(pov, inside, [30.0, 0.0, 0.0]), 1.0);
    near(field(pov, inside, [40.0, 0.0, 0.0]), 0.0);
}

#[test]
fn thresholds_that_differ_become_one() {
    let text = "blob { threshold 2 sphere { 0, 1, 3 } } blob { threshold 0.5 sphere { 9*x, 1, 1 } }";
    let imported = good(pov, text.as_bytes());
    let tree = imported.model.check().unwrap();
    assert_eq!(tree.iso(), 1.0);
    near(walk(&tree, [0.0; 3]).field, 1.5);
    near(walk(&tree, [9.0, 0.0, 0.0]).field, 2.0);
}

/// The colour at a point.
fn color(text: &str, p: [f64; 3]) -> Vec<f64> {
    walk(&good(pov, text.as_bytes()).model.check().unwrap(), p).attributes[0].clone()
}

#[test]
fn colours_of_components_blobs_and_groups() {
    let one = |look: &str| color(&format!("blob {{ sphere {{ 0, 1, 2 }} {look} }}"), [0.0; 3]);
    assert_eq!(one("pigment { color rgb <0.1, 0.2, 0.3> }"), [0.1, 0.2, 0.3]);
    assert_eq!(one("pigment { rgbt <0.1, 0.2, 0.3, 0.9> }"), [0.1, 0.2, 0.3]);
    assert_eq!(one("pigment { color red 0.5 blue 0.25 }"), [0.5, 0.0, 0.25]);
    assert_eq!(one("pigment { rgb 0.5 }"), [0.5; 3]);
    assert_eq!(one("pigment { SteelBlue }"), [0.137255, 0.419608, 0.556863]);
    assert_eq!(one("pigment { color Red*0.5 } finish { phong 1 }"), [0.5, 0.0, 0.0]);
    assert_eq!(
        one("texture { pigment { color Red } finish { ambient 1 } normal { bumps 1 } }"),
        [1.0, 0.0, 0.0]
    );
    assert_eq!(one("material { texture { pigment { Blue } } interior { ior 1 } }"), [0.0, 0.0, 1.0]);
    let own = "blob { sphere { 0, 1, 2 pigment { Red } } sphere { 9*x, 1, 2 } pigment { Green } }";
    assert_eq!(color(own, [0.0; 3]), [1.0, 0.0, 0.0]);
    assert_eq!(color(own, [9.0, 0.0, 0.0]), [0.0, 1.0, 0.0]);
    let group = "#declare P = pigment { color Blue }; union { blob { sphere { 0, 1, 2 } } texture { P } }";
    assert!(pov(group.as_bytes()).is_ok());
    let group =
        "#declare T = texture { pigment { color Blue } } union { blob { sphere { 0, 1, 2 } } texture { T } }";
    assert_eq!(color(group, [0.0; 3]), [0.0, 0.0, 1.0]);
    let display = format!("global_settings {{ assumed_gamma 2.2 }} {own}").replace("Red", "rgb 0.5");
    assert_eq!(color(&display, [0.0; 3]), [0.5f64.powf(2.2); 3]);
    let default = "#default { pigment { Yellow } } blob { sphere { 0, 1, 2 } }";
    assert_eq!(color(default, [0.0; 3]), [1.0, 1.0, 0.0]);
    let pattern = "blob { sphere { 0, 1, 2 } pigment { checker color Red color Blue scale 2 } }";
    let imported = good(pov, pattern.as_bytes());
    assert!(
        messages(pattern.as_bytes(), &imported.warnings).contains("checker gives no colour that is read")
    );
}

#[test]
fn objects_are_chosen_by_name_and_number() {
    let text = b"#declare A = blob { threshold 0.5 sphere { x, 1, 2 } } #declare B = object { A translate y }
        #declare C = intersection { blob { sphere { 0, 1, 3 } scale 2 } box { 0, 1 } translate 5 }
        object { A scale 2 } object { B rotate 90*z }";
    let at = |imported: &Imported, p: [f64; 3]| walk(&imported.model.check().unwrap(), p).field;
    near(at(&object(text, "A"), [1.0, 0.0, 0.0]), 2.0);
    near(at(&object(text, "B"), [1.0, 1.0, 0.0]), 2.0);
    near(at(&object(text, "2"), [-1.0, 1.0, 0.0]), 2.0);
    let alone = object(text, "C");
    near(at(&alone, [1.0, 0.0, 0.0]), 3.0 * quartic(0.25));
    assert!(messages(text, &alone.warnings).contains("with other shapes: box: it is read alone"));
    let missing = import::pov(text, &Options { object: Some("D".to_owned()), ..Options::default() });
    assert!(messages(text, &missing.unwrap_err()).contains("no object with blobs is called D"));
    let both = good(pov, text);
    near(at(&both, [2.0, 0.0, 0.0]), 2.0);
    near(at(&both, [-1.0, 1.0, 0.0]), 2.0);
}

#[test]
fn the_example_is_read_and_says_what_is_left_out() {
    let imported = good(pov, FLOWER);
    let warnings = messages(FLOWER, &imported.warnings);
    for part in ["camera is left out", "light_source is left out", "scene:47:1: warning: box is no blob"] {
        assert!(warnings.contains(part), "{warnings}");
    }
    let tree = imported.model.check().unwrap();
    // Seven petals, a middle, five stamens, a negative bar; a stem of two.
    let leaves =
        tree.nodes().iter().filter(|node| matches!(node.kind, jbt_model::kind::NodeKind::Primitive(_)));
    assert_eq!(leaves.count(), 16);
    assert_eq!(tree.iso(), 1.0);
    truncated(pov, FLOWER);
}

#[test]
fn errors_have_places() {
    for (text, message) in [
        ("", "scene:1:1: error: the scene places no blob"),
        ("#declare A = blob { sphere { 0, 1, 1 } }", "--object reads one alone: A"),
        ("blob { sphere { 0, 1, 1 }", "scene:1:1: error: the blob is not closed"),
        ("blob { sphere { 0, 1 } }", "scene:1:8: error: the component has 2 of 3 arguments"),
        ("blob { cylinder { 0, 1, 1, 1, 1, 1 } }", "the component has too many numbers"),
        ("blob { sphere { 0, 1, Foo } }", "scene:1:23: error: `Foo` has no number"),
        ("#include \"my.inc\" blob { sphere { Foo, 1, 1 } }", "perhaps it is in \"my.inc\""),
        ("blob { sphere { 0, 1, 1/0 } }", "is inf, which is not finite"),
        ("blob { sphere { 0, <1, 2>, 1 } }", "a vector stands where a number should"),
        ("blob { threshold 0 sphere { 0, 1, 1 } }", "the threshold is 0"),
        ("blob { threshold -1 sphere { 0, 1, 1 } }", "expected a number above 0"),
        ("blob { box { 0, 1 } }", "scene:1:8: error: unexpected `box`"),
        ("#macro M() sphere { 0, 1, 1 } #end blob { M() }", "the macro `M` is called in a blob"),
        (
            "intersection { blob { sphere { 0, 1, 1 } } plane { y, 0 } }",
            "in an intersection with other shapes: plane",
        ),
        (
            "difference { blob { sphere { 0, 1, 2 } } blob { sphere { x, 1, 2 } } }",
            "in a difference with other shapes",
        ),
        ("#while (1) #end", "scene:1:2: error: the loop never ends"),
        ("#while (1)", "scene:1:2: error: the directive has no end"),
        ("#if (0) #else", "the directive has no end"),
        ("#end", "#end has no beginning"),
        ("#else", "#else has no beginning"),
        ("#if (Foo) #end", "`Foo` has no number"),
        ("#fopen F \"x\" write", "#fopen is not read"),
        ("#error \"stop\"", "the scene itself ends here"),
        ("#declare A 5", "scene:1:12: error: unexpected `5`"),
        ("#declare A = (1 + ;", "unexpected `;`"),
        ("#declare A = (1 + 2;", "expected the end of `(`"),
        ("#declare A = <1, 2, 3, 4, 5, 6>;", "a vector of 6 numbers"),
        ("#declare A = <x, 2>;", "a vector within a vector"),
        ("#declare A = sin(1, 2);", "the function has 2 arguments, and takes 1"),
        ("#declare A = rand(7);", "`rand` takes what `seed` gave"),
        ("blob { sphere { 0, 1, 1 matrix <1,0,0, 0,1,0, 0,0,0, 0,0,0> } }", "the matrix has no inverse"),
        ("/* a /* b */", "the comment is not closed"),
        ("#include \"a", "the string is not closed"),
        ("\u{1}", "this is no text of a scene"),
        ("}", "unexpected `}`"),
        ("global_settings { assumed_gamma 0 }", "the gamma is 0"),
    ] {
        let found = bad(pov, text);
        assert!(found.contains(message), "{text}\n{found}");
    }
}

#[test]
fn an_endless_loop_is_refused_in_ten_milliseconds() {
    for body in ["", "sphere { 0, 1, 1 }", "#declare N = N + 1;", "#declare A = rand(S);"] {
        let text = format!("#declare N = 0; #declare S = seed(1); blob {{ #while (1) {body} #end }}");
        let fastest = (0..5).map(|_| {
            let start = Instant::now();
            assert!(bad(pov, &text).contains("the loop never ends"));
            start.elapsed()
        });
        let fastest = fastest.min().unwrap();
        assert!(fastest < Duration::from_millis(10), "{body}: {fastest:?}");
    }
}

#[test]
fn hostile_files_end_soon() {
    let loops =
        |body: &str| format!("#declare N = 0; #declare S = seed(1); blob {{ #while (N < 1) {body} #end }}");
    let all = [
        loops(""),
        loops("#declare M = 1;"),
        loops("sphere { 0, 1, 1 }"),
        loops("#declare Q = seed(2);"),
        loops("#declare Q = rand(S) + rand(S);"),
        loops("#if (0) #end"),
        loops(&"#if (1) #else #end ".repeat(1000)),
        loops(&format!("#if (0) {} #end", "1 ".repeat(100_000))),
        loops(&format!("#declare Q = {}0;", "1+".repeat(100_000))),
        loops("sphere { 0, 1, 1 pigment { rgb 1 } rotate 1 scale 2 translate 3 }"),
        "#for (I, 0, 1e15, 1e-300) #end".to_owned(),
        "#for (I, 0, 1e300, 1) sphere { 0, 1 } #end".to_owned(),
        "#for (A, 0, 1e9) #for (B, 0, 1e9) #for (C, 0, 1e9) #end #end #end".to_owned(),
        "#declare A = blob { sphere { 0, 1, 1 } } ".to_owned()
            + &"#declare A = union { object { A } object { A } } ".repeat(64),
        "#declare B = blob { sphere { 0, 1, 1 } } ".to_owned()
            + &"#declare B = blob { B sphere { 0, 1, 1 } } ".repeat(10_000),
        "union { ".repeat(200_000),
        "union { ".repeat(60_000) + "blob { sphere { 0, 1, 1 } }" + &"}".repeat(60_000),
        "#declare A = ".repeat(100_000),
        "#declare A = union { ".repeat(100_000),
        "#if (1) ".repeat(200_000),
        "#if (0) ".repeat(200_000),
        "#switch (1) ".repeat(200_000),
        "#declare A = ".to_owned() + &"(".repeat(1_000_000),
        "#declare A = ".to_owned() + &"-".repeat(1_000_000) + "1;",
        "#declare A = (".to_owned() + &"1 ? 2 : ".repeat(300_000) + "3);",
        "#declare A = ".to_owned() + &"<".repeat(1_000_000),
        "#declare A = ".to_owned() + &"sin(".repeat(300_000),
        "#declare A = min(".to_owned() + &"1,".repeat(500_000) + "1);",
        "/*".repeat(1_000_000),
        "blob { ".to_owned() + &"sphere { 0, 1, 1 } ".repeat(100_000) + "}",
        "blob { sphere { 0, 1e300, 1e300 } sphere { 1e300, 1, 1 } }".to_owned(),
        "blob { sphere { 0, 1, 1 } scale 1e-200 scale 1e-200 }".to_owned(),
        "blob { sphere { 0, 1, 1 scale 1e200 scale 1e200 rotate 1e300 } }".to_owned(),
        "blob { sphere { 0, 1, 1 } ".to_owned() + &"rotate 1 ".repeat(300_000) + "}",
        "texture { ".repeat(200_000),
        "camera { ".to_owned() + &"{".repeat(1_000_000),
    ];
    for text in all {
        let took = ends(pov, text.as_bytes());
        assert!(took < SOON, "{took:?}: {}", &text[..80.min(text.len())]);
    }
}

#[test]
fn maps_that_make_no_model_have_a_place() {
    let said = crate::common::no_model(pov, "\nblob { sphere { 0, 1, 1 } scale 1e-300 }");
    assert!(said.starts_with("scene:2:1: error: the affine map shrinks"), "{said}");
    let said = crate::common::no_model(pov, "blob {\n  sphere { 0, 1, 1 scale 1e-300 } }");
    assert!(said.starts_with("scene:2:3: error: the affine map shrinks"), "{said}");
}
