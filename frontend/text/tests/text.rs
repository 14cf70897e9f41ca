//! The text format: golden files, round trips, and what strangers send.
//!
//! `golden/text/NAME.jbt` prints as `NAME.print`. In `golden/text/error_NAME.jbt` every line that earns an
//! error says so behind `#~`, with the columns; the marks are taken off before the text is read. `BLESS=1`
//! writes what is found. What reads well is checked. A line `#! -D NAME=VALUE` sets a parameter from outside.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use jbt_ir::limits;
use jbt_model::attribute::AttributeValue;
use jbt_model::builder::point;
use jbt_model::diagnostic::{Diagnostic, Diagnostics, Severity, Source};
use jbt_model::kind::NodeKind;
use jbt_model::model::Model;
use jbt_model::orientation::{Handed, Orientation};
use jbt_model::traverse::Visit;
use jbt_model::tree::Tree;
use jbt_testkit::golden::{compare, files};
use jbt_testkit::random::{Numbers, Random, Settings};
use jbt_testkit::scene::{assert_reads_back, model};
use jbt_text::{Options, parse, print};

/// The golden files of errors, or the others.
fn golden_files(of_errors: bool) -> impl Iterator<Item = (PathBuf, String)> {
    let is_wanted =
        move |path: &Path| path.file_name().unwrap().to_str().unwrap().starts_with("error_") == of_errors;
    files("text", "jbt").into_iter().filter(move |(path, _)| is_wanted(path))
}

fn options(text: &str) -> Options {
    let set = text.lines().filter_map(|line| line.strip_prefix("#! -D ")?.split_once('='));
    Options {
        parameters: set.map(|(name, value)| (name.to_owned(), value.parse().unwrap())).collect(),
        ..Options::default()
    }
}

/// The text without marks.
fn unmarked(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with("#~"));
    lines.map(|line| line.split(" #~ ").next().unwrap().to_owned() + "\n").collect()
}

/// The text with a mark for each diagnostic, on its line or at the end.
fn marked(text: &str, diagnostics: &[Diagnostic]) -> String {
    let source = Source { name: "", text: text.as_bytes() };
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut rest = String::new();
    for diagnostic in diagnostics {
        let severity = match diagnostic.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Limit => "limit",
        };
        let help = diagnostic.help.as_ref().map(|help| format!(" | {help}")).unwrap_or_default();
        let message = format!("{severity}: {}{help}", diagnostic.message);
        let place = diagnostic.span.map(|span| {
            let (line, from) = source.position(span.start as usize);
            let (last, to) = source.position(span.end as usize);
            let more = if last > line { format!("{last}:") } else { String::new() };
            (line, format!("{from}-{more}{to}"))
        });
        match place {
            Some((line, columns)) if line <= lines.len() => {
                let _ = write!(lines[line - 1], " #~ {columns} {message}");
            }
            Some((_, columns)) => {
                let _ = writeln!(rest, "#~ {columns} {message}");
            }
            None => {
                let _ = writeln!(rest, "#~ {message}");
            }
        }
    }
    lines.join("\n") + "\n" + &rest
}

#[test]
fn golden_prints() {
    for (path, text) in golden_files(false) {
        let model = parse(text.as_bytes(), &options(&text))
            .unwrap_or_else(|errors| panic!("{}\n{}", path.display(), marked(&text, &errors)));
        compare(&path.with_extension("print"), &print(&model));
        let again = assert_reads_back(&model);
        assert_eq!(distinct(&again.root), distinct(&model.root), "{}", path.display());
    }
}

#[test]
fn golden_errors() {
    for (path, file) in golden_files(true) {
        let text = unmarked(&file);
        // What reads well may make no sense: then the check says so.
        let model = parse(text.as_bytes(), &options(&text)).and_then(|model| model.check());
        let errors = model.expect_err(path.to_str().unwrap());
        inside(&text, &errors);
        compare(&path, &marked(&text, &errors));
    }
}

fn inside(text: &str, diagnostics: &[Diagnostic]) {
    assert!(!diagnostics.is_empty());
    for diagnostic in diagnostics {
        assert!(!diagnostic.message.is_empty(), "{diagnostics:?}");
        if let Some(span) = diagnostic.span {
            assert!(span.start <= span.end && span.end as usize <= text.len(), "{diagnostic:?} in {text:?}");
            assert!(text.is_char_boundary(span.start as usize) && text.is_char_boundary(span.end as usize));
        }
    }
}

/// The nodes of a tree, shared ones once.
fn distinct(root: &Tree) -> usize {
    let mut seen = HashSet::new();
    let mut stack = vec![root];
    while let Some(tree) = stack.pop() {
        if seen.insert(tree.identity()) {
            stack.extend(tree.node().children());
        }
    }
    seen.len()
}

/// Every number of a tree as bits, in preorder: what equality of floats does not tell apart.
fn bits(root: &Tree) -> Vec<u64> {
    let numbers =
        |tree: &Tree| tree.node().written().numbers().map(|number| number.value().to_bits()).collect();
    root.prefix(Visit::Nodes).flat_map::<Vec<u64>, _>(numbers).collect()
}

/// What the root of a model means.
fn root(model: &Model) -> NodeKind {
    model.root.node().written().evaluated(model.iso.value()).expect("it means something")
}

#[test]
fn random_models_survive_printing() {
    let settings = Settings { numbers: Numbers::Hostile, ..Settings::default() };
    for seed in 0..2_000 {
        let model = Random::with_settings(seed, !seed, settings).model(1 + seed as usize % 20);
        let text = print(&model);
        let again = parse(text.as_bytes(), &Options::default())
            .unwrap_or_else(|errors| panic!("seed {seed}\n{}", marked(&text, &errors)));
        assert_eq!(again, model, "seed {seed}\n{text}");
        assert_eq!(bits(&again.root), bits(&model.root), "seed {seed}\n{text}");
        assert_eq!(distinct(&again.root), distinct(&model.root), "seed {seed}\n{text}");
        assert_eq!(print(&again), text, "seed {seed}");
    }
}

#[test]
fn a_graph_prints_as_long_as_it_is() {
    let mut tree = point([0.0; 3], 1.0);
    for _ in 0..30 {
        tree = Tree::sum(vec![tree.clone(), point([0.0; 3], 1.0), tree]);
    }
    let model = Model::new(tree);
    let text = print(&model);
    assert!(text.len() < 5_000, "{}", text.len());
    let again = assert_reads_back(&model);
    assert_eq!(distinct(&again.root), 61);
}

#[test]
fn parameters_are_listed_and_set() {
    let text = b"jbt 1 param a = 2 param b = a * 3 point { radius b }";
    let options = Options { parameters: vec![("a".to_owned(), 5.0)], ..Options::default() };
    let model = parse(text, &options).unwrap();
    let shown: Vec<_> = model.parameters.iter().map(|p| (p.name(), p.default(), p.value())).collect();
    assert_eq!(shown, [("a", 2.0, 5.0), ("b", 15.0, 15.0)]);
    let NodeKind::Primitive(leaf) = root(&model) else { panic!() };
    assert_eq!(leaf.radius, 15.0);
}

#[test]
fn a_surface_radius_is_where_the_field_is_iso() {
    for (text, iso) in [
        ("jbt 1 point { surface_radius 0.7 }", 0.5),
        ("jbt 1 iso 0.25 point { surface_radius 0.7 falloff wyvill strength 3 }", 0.25),
        ("jbt 1 iso 0.9 point { surface_radius 0.7 falloff soft }", 0.9),
    ] {
        let model = parse(text.as_bytes(), &Options::default()).unwrap();
        let NodeKind::Primitive(leaf) = root(&model) else { panic!() };
        let field = leaf.strength * leaf.falloff.value((0.7 / leaf.radius).powi(2));
        assert!((field - iso).abs() < 1e-14, "{text}: {field}");
    }
}

#[test]
fn spans_are_bytes() {
    let text = "jbt 1 # é\nunion { point { radius 1 } translate (1 0 0) { point { at (0 0 1) radius 1 } } }";
    let model = parse(text.as_bytes(), &Options::default()).unwrap();
    let shown = |tree: &Tree| {
        let span = tree.node().span().unwrap();
        text[span.start as usize..span.end as usize].to_owned()
    };
    assert_eq!(shown(&model.root), "union");
    let children = model.root.node().children();
    assert_eq!(shown(&children[0]), "point { radius 1 }");
    assert_eq!(shown(&children[1]), "translate (1 0 0)");
}

/// Files of any system: the same model, and the same messages, which have no character that no terminal
/// shows.
#[test]
fn lines_end_as_on_any_system() {
    let good = "jbt 1 # a comment\nparam r = 1 // another\npoint {\n    radius r # the last\n}\n";
    let bad = "jbt 1\n# a comment\nunion {\n    point { radus 1 } # one\n    piont { }\n    color #ff8800 {\n    }\n}\n";
    let read = |text: &str, end: &str| {
        let text = text.replace('\n', end);
        let read = parse(text.as_bytes(), &Options::default());
        let source = Source { name: "a.jbt", text: text.as_bytes() };
        let show = |errors: Diagnostics| errors.iter().map(|error| source.render(error)).collect::<Vec<_>>();
        read.map(|model| print(&model)).map_err(show)
    };
    assert!(read(good, "\n").is_ok() && read(bad, "\n").is_err());
    for end in ["\r\n", "\r"] {
        assert_eq!(read(good, end), read(good, "\n"));
        assert_eq!(read(bad, end), read(bad, "\n"));
    }
    assert!(
        read(bad, "\r\n").unwrap_err().iter().all(|shown| !shown.contains("\\u{") && !shown.contains('\r'))
    );
}

#[test]
fn colours_of_screens_become_linear_as_they_are_read() {
    let colored = |color: &str| {
        let text = format!("jbt 1 param r = 1 attribute glass 4 color {color} {{ point {{ radius 1 }} }}");
        let options = Options { parameters: vec![("r".to_owned(), 0.2)], ..Options::default() };
        let model =
            parse(text.as_bytes(), &options).unwrap_or_else(|errors| panic!("{}", marked(&text, &errors)));
        let again = parse(print(&model).as_bytes(), &Options::default()).unwrap();
        assert_eq!((&again, bits(&again.root)), (&model, bits(&model.root)), "{color}");
        let NodeKind::Attribute { value: AttributeValue::Numbers(numbers), .. } = root(&model) else {
            panic!("numbers")
        };
        numbers
    };
    // IEC 61966-2-1, in another form: what is dark is a line.
    let linear = |byte: u8| {
        let screen = f64::from(byte) / 255.0;
        if byte < 11 { screen / 12.92 } else { ((screen * 200.0 + 11.0) / 211.0).powf(2.4) }
    };
    let near = |found: &[f64], expected: [u8; 3]| {
        let close = |(a, b): (&f64, u8)| (a - linear(b)).abs() < 1e-12;
        assert!(found.iter().zip(expected).all(close) && found.len() == 3, "{found:?} {expected:?}");
    };
    near(&colored("\"#ff8800\""), [255, 136, 0]);
    near(&colored("\"#F80\""), [255, 136, 0]);
    near(&colored("\"#0a0B0c\""), [10, 11, 12]);
    near(&colored("srgb(1 128/255 0)"), [255, 128, 0]);
    near(&colored("srgb (1, 10 / 255, 0)"), [255, 10, 0]);
    near(&colored("srgb(r 1 - r 0)"), [51, 204, 0]);
    assert_eq!(colored("\"#fff\""), [1.0; 3]);
    assert_eq!(colored("\"#000\""), [0.0; 3]);
    assert_eq!(
        colored("srgb(r r r)"),
        colored("srgb(0.2 0.2 0.2)"),
        "a parameter and its value give the same bits"
    );
}

#[test]
fn bytes_that_are_no_text() {
    let errors = parse(b"jbt 1\npoint { \xff radius 1 }", &Options::default()).unwrap_err();
    assert_eq!((errors[0].span.unwrap().start, errors[0].span.unwrap().end), (14, 15));
    let errors = parse(b"jbt 1 \xc3", &Options::default()).unwrap_err();
    assert_eq!((errors[0].span.unwrap().start, errors[0].span.unwrap().end), (6, 7));
    assert!(parse("\u{feff}jbt 1 point { radius 1 }".as_bytes(), &Options::default()).is_ok());
}

const GOOD: &str = include_str!("golden/text/maps.jbt");

#[test]
fn every_truncation_is_an_error() {
    let whole = GOOD.trim_end();
    for end in 0..whole.len() {
        let text = &whole[..end];
        inside(text, &parse(text.as_bytes(), &Options::default()).expect_err(text));
    }
    assert!(parse(whole.as_bytes(), &Options::default()).is_ok());
}

#[test]
fn garbage_is_an_error() {
    let mut rng = fastrand::Rng::with_seed(7);
    for _ in 0..3_000 {
        let bytes: Vec<u8> = (0..rng.usize(..200)).map(|_| rng.u8(..)).collect();
        assert!(parse(&bytes, &Options::default()).is_err());
    }
    let words = [
        "jbt",
        "1",
        "iso",
        "param",
        "attribute",
        "let",
        "point",
        "sum",
        "union",
        "ricci",
        "blend",
        "translate",
        "rotate",
        "scale",
        "affine",
        "twist",
        "with",
        "use",
        "color",
        "axis",
        "degrees",
        "rate",
        "at",
        "radius",
        "surface_radius",
        "strength",
        "falloff",
        "soft",
        "default",
        "x",
        "a",
        "sqrt",
        "min",
        "pi",
        "{",
        "{",
        "}",
        "}",
        "(",
        ")",
        ",",
        "=",
        "+",
        "-",
        "*",
        "/",
        "^",
        "0",
        "2.5",
        "1e400",
        "$",
        "é",
        "#\n",
        "(1 2 3)",
        "point { radius 1 }",
        "\n",
    ];
    for _ in 0..20_000 {
        let mut text = String::from(if rng.bool() { "jbt 1 " } else { "" });
        for _ in 0..rng.usize(..60) {
            text.push_str(rng.choice(words).unwrap());
            text.push_str(if rng.u8(..4) == 0 { "" } else { " " });
        }
        if let Err(errors) = parse(text.as_bytes(), &Options::default()) {
            inside(&text, &errors);
        }
    }
}

#[test]
fn a_good_file_with_a_token_changed_never_panics() {
    let mut rng = fastrand::Rng::with_seed(11);
    for _ in 0..3_000 {
        let mut bytes = GOOD.as_bytes().to_vec();
        for _ in 0..rng.usize(1..4) {
            let at = rng.usize(..bytes.len());
            match rng.u8(..3) {
                0 => bytes[at] = rng.u8(32..127),
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, *rng.choice(b"{}()-1 ,").unwrap()),
            }
        }
        if let Err(errors) = parse(&bytes, &Options::default()) {
            inside(std::str::from_utf8(&bytes).unwrap(), &errors);
        }
    }
}

/// Runs on a stack that a recursion over the depth of the text would overflow.
fn on_a_small_stack(test: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new().stack_size(256 << 10).spawn(test).unwrap().join().unwrap();
}

#[test]
fn a_million_blocks_deep() {
    on_a_small_stack(|| {
        for (open, close) in
            [("sum{", "}"), ("translate (1 0 0) { ", " }"), ("color (1 0 0) { union { ", "}}")]
        {
            let deep = if open == "sum{" { 1_000_000 } else { 100_000 };
            let text = format!("jbt 1 {}point {{ radius 1 }}{}", open.repeat(deep), close.repeat(deep));
            let model = parse(text.as_bytes(), &Options::default()).unwrap();
            let printed = print(&model);
            let again = parse(printed.as_bytes(), &Options::default()).unwrap();
            assert!(again == model);
        }
    });
}

#[test]
fn a_deep_expression() {
    on_a_small_stack(|| {
        let deep = limits::MAX_EXPRESSION_DEPTH - 1;
        let nested = |deep: usize| {
            format!("jbt 1 point {{ radius {}1{} }}", "(".repeat(deep), ")".repeat(deep)).into_bytes()
        };
        assert!(parse(&nested(deep), &Options::default()).is_ok());
        let errors = parse(&nested(deep + 1), &Options::default()).unwrap_err();
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!(errors[0].severity, Severity::Limit);
        let signs = format!("jbt 1 point {{ radius {}1 }}", "-".repeat(100_000));
        assert!(parse(signs.as_bytes(), &Options::default()).is_ok());
        let powers = format!("jbt 1 point {{ radius 1{} }}", "^1".repeat(100_000));
        assert!(parse(powers.as_bytes(), &Options::default()).is_ok());
    });
}

#[test]
fn the_longest_files_of_one_byte() {
    for byte in [b'{', b'}', b'(', b'-', b',', b' ', b'a', b'1', b'$'] {
        let mut text = b"jbt 1 sum { ".to_vec();
        // Braces are what a hostile file is made of: as many as are read at all.
        let length = if byte == b'{' && !cfg!(debug_assertions) { limits::MAX_SCENE_BYTES } else { 1 << 20 };
        text.resize(length, byte);
        let errors = parse(&text, &Options::default()).unwrap_err();
        assert!(errors.len() <= limits::MAX_ERRORS + 2);
        inside(std::str::from_utf8(&text).unwrap(), &errors);
    }
}

#[test]
fn one_byte_too_many() {
    let text = vec![b' '; limits::MAX_SCENE_BYTES + 1];
    let errors = parse(&text, &Options::default()).unwrap_err();
    assert_eq!(errors[0].severity, Severity::Limit);
    let errors = parse(&text[1..], &Options::default()).unwrap_err();
    assert_eq!(errors[0].severity, Severity::Error, "a file of blanks is empty, and not too long");
}

#[test]
fn one_node_too_many() {
    if cfg!(debug_assertions) {
        return;
    }
    let blocks = |count: usize| format!("jbt 1 {}{}", "sum{".repeat(count), "}".repeat(count)).into_bytes();
    let errors = parse(&blocks(limits::MAX_NODES + 1), &Options::default()).unwrap_err();
    assert_eq!((errors.len(), errors[0].severity), (1, Severity::Limit), "{errors:?}");
    assert!(parse(&blocks(limits::MAX_NODES), &Options::default()).is_ok());
}

#[test]
fn errors_past_the_limit_are_counted() {
    let text = "jbt 1 union {\n".to_owned() + &"use nothing\n".repeat(1_000) + "}";
    let errors = parse(text.as_bytes(), &Options::default()).unwrap_err();
    assert_eq!(errors.len(), limits::MAX_ERRORS + 1);
    assert_eq!(errors[limits::MAX_ERRORS].message, "and 950 more errors");
}

#[test]
fn escapes_of_the_file_do_not_reach_the_terminal() {
    let text = b"jbt 1 \x1b[31m { \xe2\x80\xae }";
    let source = Source { name: "a.jbt", text };
    for error in parse(text, &Options::default()).unwrap_err() {
        assert!(!source.render(&error).contains(['\x1b', '\u{202e}']));
    }
}

#[test]
fn an_orientation_is_read_and_printed() {
    let ball = "point { radius 1 }";
    let orientation = |statement: &str| model(&format!("jbt 1 {statement} {ball}")).orientation;
    assert_eq!(orientation(""), Orientation::default());
    assert_eq!(orientation("orientation up y"), Orientation::Y_RIGHT);
    assert_eq!(orientation("orientation up y handed left"), Orientation::Y_LEFT);
    let left = Orientation { handed: Handed::Left, ..Orientation::default() };
    assert_eq!(orientation("orientation handed left"), left);
    for orientation in [Orientation::default(), Orientation::Y_LEFT, Orientation::Y_RIGHT, left] {
        let plain = model(&format!("jbt 1 {ball}"));
        let turned = Model { orientation, ..plain.clone() };
        assert_eq!(turned == plain, orientation == Orientation::default());
        assert_reads_back(&turned);
        assert_eq!(turned.check().unwrap().orientation(), orientation);
    }
    for (statement, message) in [
        ("orientation", "expected `up` and an axis, or `handed` and a hand"),
        ("orientation up x", "expected `y` or `z`"),
        ("orientation up y handed both", "expected `right` or `left`"),
        ("orientation up y orientation up z", "a second `orientation`"),
    ] {
        let text = format!("jbt 1 {statement} {ball}");
        let errors = parse(text.as_bytes(), &Options::default()).unwrap_err().to_string();
        assert!(errors.contains(message), "{errors}");
    }
}
