//! Texts that are programs: what they expand to, what goes wrong in them, and what strangers send.

use std::sync::Arc;
use std::time::{Duration, Instant};

use jbt_model::diagnostic::{Diagnostics, Severity};
use jbt_model::model::Model;
use jbt_text::files::{FileRequest, Files, NamedFile, ResolveError, Resolver};
use jbt_text::{Options, parse, print};

/// Files in memory.
struct Memory(Vec<(&'static str, Vec<u8>)>);

impl Resolver for Memory {
    fn resolve(&self, request: &FileRequest<'_>) -> Result<NamedFile, ResolveError> {
        let path = request.joined();
        let (name, bytes) = self.0.iter().find(|(name, _)| *name == path).ok_or(ResolveError::Missing)?;
        Ok(NamedFile { path, identity: (*name).to_owned(), bytes: bytes.clone() })
    }
}

fn with_files(text: &str, files: &[(&'static str, &str)]) -> Result<Model, Diagnostics> {
    let files = files.iter().map(|(name, text)| (*name, text.as_bytes().to_vec())).collect();
    let files = Files::new(Arc::new(Memory(files)));
    parse(text.as_bytes(), &Options { files, ..Options::default() }).and_then(|model| {
        model.check()?;
        Ok(model)
    })
}

fn model(text: &str) -> Model {
    with_files(text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn errors(text: &str) -> String {
    with_files(text, &[]).expect_err("it is wrong").to_string()
}

/// Whether a program means what a plain text does.
#[track_caller]
fn same(program: &str, plain: &str) {
    let [program, plain] = [program, plain].map(model);
    assert!(program == plain, "{}\n{}", print(&program), print(&plain));
}

#[test]
fn definitions_have_arguments_of_every_kind() {
    let program = "jbt 1 let ball = point { radius 2 }
        def bead(at, r = 0.5, hue = \"#ff0000\", inner = use ball, path = [(0 0 0) (1 0 0)]) {
            let far = 2 * r
            color hue {
                translate at { sum { point { radius far } use inner polyline { points path radius 1 } } }
            }
        }
        sum {
            bead((0 0 0))
            bead((1 0 0), 0.25, (0 1 0), ball)
            bead((2 0 0), hue = srgb(1 0 0), inner = sum { point { radius 3 } point { radius 4 } })
            bead(path = [(0 0 0) (0 2 0)], at = (3 0 0), inner = use ball)
        }";
    let bead = |at: &str, far: f64, hue: &str, inner: &str, end: &str| {
        format!(
            "color {hue} {{ translate ({at}) {{ sum {{ point {{ radius {far} }} {inner}
               polyline {{ points ((0 0 0) {end}) radius 1 }} }} }} }}"
        )
    };
    let two = "point { radius 2 }";
    let plain = [
        bead("0 0 0", 1.0, "(1 0 0)", two, "(1 0 0)"),
        bead("1 0 0", 0.5, "(0 1 0)", two, "(1 0 0)"),
        bead("2 0 0", 1.0, "(1 0 0)", "sum { point { radius 3 } point { radius 4 } }", "(1 0 0)"),
        bead("3 0 0", 1.0, "(1 0 0)", two, "(0 2 0)"),
    ];
    same(program, &format!("jbt 1 sum {{ {} }}", plain.join(" ")));
}

#[test]
fn loops_go_over_ranges_and_lists() {
    let points = |xs: &[f64]| {
        let all: Vec<String> = xs.iter().map(|x| format!("point {{ at ({x} 0 0) radius 1 }}")).collect();
        format!("jbt 1 union {{ {} }}", all.join(" "))
    };
    let looped = |head: &str| {
        format!("jbt 1 let xs = [5 6 7] union {{ for i in {head} {{ point {{ at (i 0 0) radius 1 }} }} }}")
    };
    same(&looped("0 .. 3"), &points(&[0.0, 1.0, 2.0]));
    same(&looped("0..2"), &points(&[0.0, 1.0]));
    same(&looped("1 .. 0 step -0.25"), &points(&[1.0, 0.75, 0.5, 0.25]));
    same(&looped("0 .. 1.1 step 0.1 * 5"), &points(&[0.0, 0.5, 1.0]));
    same(&looped("xs"), &points(&[5.0, 6.0, 7.0]));
    same(&looped("[1 2 + 3, -4]"), &points(&[1.0, 5.0, -4.0]));
    same(&looped("0 .. count(xs)").replace("(i 0 0)", "(xs[i] 0 0)"), &points(&[5.0, 6.0, 7.0]));
    same(
        "jbt 1 let all = [[(1 0 0) (2 0 0)] [(3 0 0)]]
         union { for row in all { for p in row { point { at p radius 1 } } } }",
        &points(&[1.0, 2.0, 3.0]),
    );
    same(
        "jbt 1 let all = [[(1 0 0) (2 0 0)] [(3 0 0)]] let v = all[0][1]
         union { point { at all[0][0] radius 1 } point { at (v[0] 0 0) radius 1 } point { at (all[1][0][0] 0 0) radius 1 } }",
        &points(&[1.0, 2.0, 3.0]),
    );
    // Half a step more is one more, and a step that rounding has put there is not.
    assert_eq!(
        model("jbt 1 sum { for t in 0 .. 1.1 step 0.1 { point { at (t 0 0) radius 1 } } }")
            .root
            .node()
            .children()
            .len(),
        11
    );
    assert_eq!(
        model("jbt 1 sum { for t in 0 .. 0.35 step 0.1 { point { at (t 0 0) radius 1 } } }")
            .root
            .node()
            .children()
            .len(),
        4
    );
    assert_eq!(
        model("jbt 1 sum { point { radius 1 } for t in 3 .. 0 { point { at (t 0 0) radius 1 } } }")
            .root
            .node()
            .children()
            .len(),
        1
    );
}

#[test]
fn conditions_choose() {
    let chosen = |condition: &str| {
        let text = format!(
            "jbt 1 param p = 2 union {{ for i in 0 .. 5 {{ if {condition} {{ point {{ at (i 0 0) radius 1 }} }} }} point {{ radius 9 }} }}"
        );
        let model = model(&text);
        let children = model.root.node().children();
        let at = |index: usize| children[index].node().written().numbers().next().unwrap().value();
        (0..children.len() - 1).map(at).collect::<Vec<_>>()
    };
    assert_eq!(chosen("i < p"), [0.0, 1.0]);
    assert_eq!(chosen("i >= p and i != 3"), [2.0, 4.0]);
    assert_eq!(chosen("i == 1 or i == 2 and i > 2"), [1.0]);
    assert_eq!(chosen("not i <= 3"), [4.0]);
    assert_eq!(chosen("mod(i, 2)"), [1.0, 3.0]);
    assert_eq!(chosen("not mod(i, 2) and i > 0"), [2.0, 4.0]);
    let grade = "jbt 1 def grade(n) { if n < 1 { point { radius 1 } } else if n < 2 { point { radius 2 } } else { point { radius 3 } } }
        sum { grade(0) grade(1) grade(5) }";
    same(grade, "jbt 1 sum { point { radius 1 } point { radius 2 } point { radius 3 } }");
}

#[test]
fn definitions_call_themselves_and_each_other() {
    let text = "jbt 1
        def branch(n) {
            segment { from (0 0 0) to (0 0 1) radius 0.3 }
            if n > 0 {
                translate (0 0 1) { scale 0.7 { sum {
                    rotate axis x degrees 30 { sum { branch(n - 1) } }
                    rotate axis x degrees -30 { sum { branch(n - 1) } }
                } } }
            }
        }
        sum { branch(5) }";
    let model = model(text);
    // Each level is expanded once, and shared.
    assert!(model.root.count() < 40, "{}", model.root.count());
    let uses = model.check().unwrap().leaf_uses();
    assert_eq!(uses, 63);
}

#[test]
fn equal_subtrees_are_shared() {
    let text = "jbt 1 sum { for i in 0 .. 9 { translate (i 0 0) { point { radius 1 } } } }";
    assert_eq!(model(text).root.count(), 11);
    // What is no program stays as it is.
    assert_eq!(model("jbt 1 sum { point { radius 1 } point { radius 1 } }").root.count(), 3);
}

#[test]
fn what_follows_parameters_is_told_when_it_cannot() {
    let text =
        "jbt 1 param count = 3 param r = 1 sum { for i in 0 .. count { point { at (i 0 0) radius r } } }";
    let options = Options { parameters: vec![("count".to_owned(), 5.0)], ..Options::default() };
    assert_eq!(parse(text.as_bytes(), &options).unwrap().root.node().children().len(), 5);
    let tree = model(text).check().unwrap();
    assert_eq!(tree.with_parameters(&[("r", 2.0)]).unwrap().support().high(), [4.0, 2.0, 2.0]);
    let error = tree.with_parameters(&[("count", 4.0)]).unwrap_err();
    assert!(error[0].message.starts_with("`count` decides which nodes there are"), "{error}");
    assert!(error.to_string().starts_with("<text>:1:41: error"), "{error}");
}

#[test]
fn files_bring_names_and_nodes() {
    let parts = "jbt 1
        param size = 2
        attribute rough 1
        include \"sub/common.jbt\"
        let ball = point { radius size }
        def pair(r) { use ball tiny(r) }
        sum { use ball tiny(7) }";
    let common = "jbt 1 iso 0.5 def tiny(r) { point { radius r / 10 } } include \"../other.jbt\"";
    let files = [
        ("parts.jbt", parts),
        ("sub/common.jbt", common),
        ("sub/../other.jbt", "jbt 1 let other = point { radius 5 }"),
    ];
    let text = "jbt 1
        include \"parts.jbt\"
        include \"parts.jbt\"
        union { pair(3) include \"parts.jbt\" use other rough 0.5 { point { radius 1 } } }";
    let found = with_files(text, &files).unwrap_or_else(|error| panic!("{error}"));
    let plain = model(
        "jbt 1 param size = 2 attribute rough 1
         union { point { radius size } point { radius 0.3 } sum { point { radius size } point { radius 0.7 } }
           point { radius 5 } rough 0.5 { point { radius 1 } } }",
    );
    assert!(found == plain, "{}", print(&found));
}

#[test]
fn errors_are_in_the_file_that_has_them() {
    let files = [("a.jbt", "jbt 1\n\ndef f(r) {\n  point { radius r }\n}\nlet q = point { radius 0 - }\n")];
    let error = with_files("jbt 1\ninclude \"a.jbt\"\nsum { f(1)\n f(-1) }", &files).unwrap_err().to_string();
    assert!(error.starts_with("a.jbt:6:28: error: unexpected `}`"), "{error}");
    assert!(error.contains("\n  in `a.jbt`, which is used at <text>:2:1"), "{error}");
    let files = [("a.jbt", "jbt 1\n\ndef f(r) {\n  point { radius r }\n}\n")];
    let error = with_files("jbt 1\ninclude \"a.jbt\"\nsum { f(1)\n f(-1) }", &files).unwrap_err().to_string();
    assert_eq!(
        error,
        "a.jbt:4:3: error: the radius is -1\n  4 |   point { radius r }\n    |   ^^^^^^^^^^^^^^^^^^ expected a number of at least 1e-15\n  \
         in `f`, which is used at <text>:4:2"
    );
}

#[test]
fn errors_in_expansions_show_the_chain() {
    let error = errors(
        "jbt 1
def inner(a) { point { radius 1 / a } }
def outer(b) { sum { for i in 0 .. 3 { inner(b - i) } } }
outer(2)",
    );
    assert_eq!(
        error,
        "<text>:2:31: error: division by zero\n  2 | def inner(a) { point { radius 1 / a } }\n    |                               ^^^^^\n  \
         in `inner`, which is used at <text>:3:40\n  in the loop with i = 2 at <text>:3:22\n  in `outer`, which is used at <text>:4:1"
    );
    // What is wrong once is told once.
    let error = errors("jbt 1 sum { for i in 0 .. 1000 { piont { radius 1 } } }");
    assert_eq!(error.matches("no node is called").count(), 1, "{error}");
}

#[test]
fn what_is_no_scene_is_not_quoted() {
    for secret in ["root:x:0:0:secret", "", "jbtx secret", "\u{feff}# comment\n secret", "secret \u{0}"] {
        let error =
            with_files("jbt 1\ninclude \"s\" point { radius 1 }", &[("s", secret)]).unwrap_err().to_string();
        assert!(error.starts_with("<text>:2:9: error: `s` is no scene"), "{error}");
        assert!(!error.contains("secret"), "{error}");
    }
    let files = Files::new(Arc::new(Memory(vec![("s", b"\xff\xfesecret".to_vec())])));
    let error =
        parse(b"jbt 1 include \"s\"", &Options { files, ..Options::default() }).unwrap_err().to_string();
    assert!(error.contains("`s` is no scene") && !error.contains("secret"), "{error}");
    let error =
        parse(b"jbt 1 include \"s\" point { radius 1 }", &Options::default()).unwrap_err().to_string();
    assert!(error.contains("cannot include `s`: a text may name no files here"), "{error}");
}

#[test]
fn circles_are_named() {
    let files = [("a", "jbt 1 include \"b\""), ("b", "jbt 1 include \"c\""), ("c", "jbt 1 include \"a\"")];
    let error = with_files("jbt 1 include \"a\" point { radius 1 }", &files).unwrap_err().to_string();
    assert!(error.starts_with("c:1:15: error: `a` includes itself"), "{error}");
    assert!(error.contains("the circle is a, b, c, a"), "{error}");
    assert!(error.contains("in `c`, which is used at b:1:7\n  in `b`, which is used at a:1:7\n  in `a`, which is used at <text>:1:7"), "{error}");
}

/// Refused at once, with a place.
#[track_caller]
fn refused(text: &str, message: &str) {
    let start = Instant::now();
    let error =
        parse(text.as_bytes(), &Options::default()).and_then(|model| model.check()).expect_err("too much");
    let taken = start.elapsed();
    assert!(error.iter().any(|one| one.message.contains(message)), "{error}");
    assert!(error.iter().any(|one| one.severity == Severity::Limit && one.span.is_some()), "{error}");
    // Far more than it takes, far less than it would.
    assert!(taken < Duration::from_secs(5), "{taken:?}");
}

#[test]
fn hostile_programs_are_refused() {
    let point = "point { radius 1 }";
    refused(&format!("jbt 1 sum {{ for i in 0 .. 1e12 {{ {point} }} }}"), "1000000000000 turns of this loop");
    refused(&format!("jbt 1 sum {{ for i in 0 .. 1e300 step 1e-300 {{ {point} }} }}"), "inf turns");
    refused(&format!("jbt 1 sum {{ for i in 0 .. 1e9 {{ }} {point} }}"), "turns of this loop");
    let nested = "for i in 0 .. 1000 { ".repeat(4) + point + &"}".repeat(4);
    refused(&format!("jbt 1 sum {{ {nested} }}"), "turns of this loop");
    refused(
        &format!("jbt 1 def f(n) {{ f(n + 1) }} sum {{ f(0) {point} }}"),
        "calls and loops in each other",
    );
    refused(&format!("jbt 1 def f() {{ f() }} sum {{ f() {point} }}"), "calls and loops in each other");
    refused(
        &format!("jbt 1 def f(n) {{ g(n) }} def g(n) {{ f(n + 1) }} sum {{ f(0) {point} }}"),
        "calls and loops",
    );
    refused(&format!("jbt 1 def f(n) {{ f(f(n)) }} sum {{ f({point}) }}"), "calls and loops in each other");
    refused(
        &format!("jbt 1 sum {{ {} {point} }}", "for i in 0 .. 1 { ".repeat(300) + &"}".repeat(300)),
        "in each other",
    );
    refused(&format!("jbt 1 let a = {}1 {point}", "[".repeat(100_000)), "lists stand");
    // The sum of all that is expanded is bounded, and not only each.
    let doubled: String =
        (1..60).map(|n| format!("def f{n}(a) {{ f{}(2 * a) f{}(2 * a + 1) }}\n", n - 1, n - 1)).collect();
    refused(
        &format!("jbt 1 def f0(a) {{ point {{ radius a }} }} {doubled} sum {{ f59(1) }}"),
        "make the text longer",
    );
    let doubled = doubled.replace("(2 * a)", "(a)").replace("(2 * a + 1)", "(a)");
    refused(
        &format!("jbt 1 def f0(a) {{ point {{ radius a }} }} {doubled} sum {{ f59(1) }}"),
        "make the text longer",
    );
}

#[test]
fn doubling_is_expanded_once() {
    let doubled: String =
        (1..60).map(|n| format!("def f{n}(a) {{ sum {{ f{}(a) f{}(a) }} }}\n", n - 1, n - 1)).collect();
    let text = format!("jbt 1 def f0(a) {{ point {{ radius a }} }} {doubled} f59(1)");
    let model = parse(text.as_bytes(), &Options::default()).unwrap();
    assert_eq!(model.root.count(), 60);
    assert_eq!(model.check().unwrap_err()[0].severity, Severity::Limit);
}

#[test]
fn numbers_that_double_are_refused() {
    // Each is twice the one before it, as a formula of a parameter.
    let lets: String = (1..80).map(|n| format!("let a{n} = a{} + a{}\n", n - 1, n - 1)).collect();
    refused(&format!("jbt 1 param p = 1 let a0 = p {lets} point {{ radius a79 }}"), "");
}

#[test]
fn deep_arguments_are_no_recursion() {
    let depth = 100_000;
    let text = format!(
        "jbt 1 def f(a) {{ scale 0.9999999 {{ use a }} }} {}point {{ radius 1 }}{}",
        "f(".repeat(depth),
        ")".repeat(depth)
    );
    let model = parse(text.as_bytes(), &Options::default()).unwrap();
    assert_eq!(model.root.count(), depth + 1);
    // And where nothing is right.
    assert!(
        parse(format!("jbt 1 def f(a) {{ }} {}", "f(".repeat(depth)).as_bytes(), &Options::default())
            .is_err()
    );
    assert!(
        parse(format!("jbt 1 def f(a) {{ {}", "if 1 { ".repeat(depth)).as_bytes(), &Options::default())
            .is_err()
    );
    let ifs =
        format!("jbt 1 sum {{ {} point {{ radius 1 }} {} }}", "if 1 { ".repeat(depth), "}".repeat(depth));
    assert_eq!(parse(ifs.as_bytes(), &Options::default()).unwrap().root.count(), 2);
    let named = format!("jbt 1 {} point {{ radius 1 }}", "a: ".repeat(depth));
    assert_eq!(parse(named.as_bytes(), &Options::default()).unwrap().root.node().name(), Some("a"));
    let indices =
        format!("jbt 1 let a = [0 0] point {{ radius 1 + {}0{} }}", "a[".repeat(depth), "]".repeat(depth));
    assert_eq!(parse(indices.as_bytes(), &Options::default()).unwrap().root.count(), 1);
}

#[test]
fn parameters_have_ranges_and_labels() {
    let text = "jbt 1\nparam bulge = 0.6 in 0 .. 1 step 0.05 \"Bulge of the arm\"\nparam wide = 2 * bulge in 0 .. 3\nparam n = 1 \"Number\"\npoint { radius bulge + wide + n }";
    let model = model(text);
    let range = model.parameters[0].range().unwrap();
    assert_eq!((range.low, range.high, range.step), (0.0, 1.0, Some(0.05)));
    assert_eq!(model.parameters[0].label(), Some("Bulge of the arm"));
    let printed = print(&model);
    assert!(printed.contains("param bulge = 0.6 in 0 .. 1 step 0.05 \"Bulge of the arm\"\nparam wide = 2 * bulge in 0 .. 3\nparam n = 1 \"Number\"\n"), "{printed}");
    let tree = model.check().unwrap();
    assert!(tree.with_parameters(&[("bulge", 1.0)]).is_ok());
    let error = tree.with_parameters(&[("bulge", 1.01)]).unwrap_err();
    assert_eq!(error[0].message, "the parameter `bulge` is 1.01");
    assert_eq!(error[0].help.as_deref(), Some("expected a number from 0 to 1"));
    let options = Options { parameters: vec![("bulge".to_owned(), -1.0)], ..Options::default() };
    let error = parse(text.as_bytes(), &options).unwrap().check().unwrap_err().to_string();
    assert!(error.starts_with("<text>:2:7: error: the parameter `bulge` is -1"), "{error}");
    for (declaration, message) in [
        ("a = 1 in 2 .. 3", "the parameter `a` is 1"),
        ("a = 1 in 3 .. 1", "this range makes no sense"),
        ("a = 1 in 0 .. 2 step 0", "this range makes no sense"),
        ("a = 1 in 0 2", "unexpected `2`"),
        ("a = 1 in 0 .. 2 step 5", "this range makes no sense"),
    ] {
        let error = errors(&format!("jbt 1 param {declaration} point {{ radius a }}"));
        assert!(error.contains(message), "{declaration}: {error}");
    }
}

#[test]
fn a_value_out_of_range_decides_no_nodes() {
    let text = "jbt 1 param n = 3 in 0 .. 1000000000 param m = 2 * n
        union { for i in 0 .. m { point { radius 1 } } if n > 5 { point { radius 2 } } point { radius n } }";
    let options = Options { parameters: vec![("n".to_owned(), 2e9)], ..Options::default() };
    let error = parse(text.as_bytes(), &options).unwrap_err().to_string();
    assert!(
        error.contains("the parameter `n` is 2000000000\n") && error.contains("from 0 to 1000000000"),
        "{error}"
    );
    assert_eq!(error.matches("error:").count(), 1, "{error}");
}

#[test]
fn long_lists_are_shared_and_their_copies_are_charged() {
    let numbers: String = (0..60_000).map(|n| format!("{n} ")).collect();
    let text = format!(
        "jbt 1 let l = [{numbers}] def f(l, i) {{ point {{ at (l[i] 0 0) radius 1 }} }}
         union {{ for i in 0 .. count(l) {{ f(l, i) }} }}"
    );
    let model = model(&text);
    assert_eq!(model.root.node().children().len(), 60_000);
    // Each of these would have a list of its own.
    let points: String = (0..10_000).map(|n| format!("({n} 0 0) ")).collect();
    let error = errors(&format!(
        "jbt 1 let l = [{points}] union {{ for i in 0 .. 5000 {{ polyline {{ points l radius 1 + i }} }} }}"
    ));
    assert!(error.contains("limit: a copy of these 10000 elements would make the text longer"), "{error}");
}

#[test]
fn calls_that_double_are_refused() {
    let error = errors(
        "jbt 1 def f(n, k) {
            if n < 1 { point { at (k 0 0) radius 1 } } else { union { f(n-1, 2*k) f(n-1, 2*k+1) } }
         } f(40, 0)",
    );
    assert!(error.contains("limit: this call of `f` would make the text longer"), "{error}");
}
