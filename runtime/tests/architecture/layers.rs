//! Layers within crates: which file may import which, and that no file imports itself through others.
//!
//! A crate has no circle of files, but for those in `KNOWN`. The folders of the frontend have an order besides.

use std::collections::BTreeSet;

use crate::circles::circles;
use crate::imports::{Import, imports};
use crate::sources;

/// All crates.
const CRATES: [&str; 6] = ["frontend", "ir", "jit", "runtime", "cli", "benches"];

/// Files that import each other in a loop still, each as it is below the folder of its crate. Nothing is added here.
const KNOWN: &[(&str, &[&str])] = &[
    (
        "frontend",
        &[
            "lower/computed.rs",
            "lower/demand.rs",
            "lower/occurrence.rs",
            "lower/occurrence/find.rs",
            "lower/position.rs",
            "lower/shape.rs",
        ],
    ),
    (
        "frontend",
        &[
            "lower/emit.rs",
            "lower/emit/guard.rs",
            "lower/emit/probe.rs",
            "lower/emit/select.rs",
            "lower/guide.rs",
            "lower/rows.rs",
            "lower/support.rs",
        ],
    ),
    (
        "ir",
        &[
            "domain/interval/arithmetic.rs",
            "domain/interval/mod.rs",
            "domain/interval/order.rs",
            "domain/interval/transcendental.rs",
        ],
    ),
    (
        "ir",
        &[
            "domain/lanes/compile.rs",
            "domain/lanes/execute.rs",
            "domain/lanes/level.rs",
            "domain/lanes/tape.rs",
        ],
    ),
    ("ir", &["domain/tangent/mod.rs", "domain/tangent/slope.rs"]),
    ("ir", &["text/line.rs", "text/mod.rs", "text/parse.rs"]),
    ("jit", &["compile.rs", "entry.rs", "isa.rs", "lower.rs", "memory.rs", "wide/mod.rs"]),
    ("runtime", &["contour/image.rs", "contour/shade.rs"]),
    ("runtime", &["divide/mod.rs", "divide/run.rs"]),
    ("runtime", &["evaluator.rs", "probe.rs", "prune/mod.rs", "statistics.rs"]),
    (
        "runtime",
        &[
            "export/format.rs",
            "export/glb.rs",
            "export/mod.rs",
            "export/obj.rs",
            "export/ply.rs",
            "export/stl.rs",
        ],
    ),
    (
        "runtime",
        &[
            "mesh/crossing.rs",
            "mesh/divide.rs",
            "mesh/mod.rs",
            "mesh/progress.rs",
            "mesh/sample.rs",
            "mesh/surface.rs",
            "mesh/thin/crossed.rs",
            "mesh/thin/measure.rs",
            "mesh/thin/mod.rs",
            "mesh/thin/search.rs",
            "mesh/thin/shreds.rs",
            "mesh/vertex.rs",
            "mesh/vertex/normal.rs",
            "mesh/vertex/room.rs",
            "mesh/vertex/start.rs",
        ],
    ),
    (
        "runtime",
        &[
            "render/cast.rs",
            "render/develop.rs",
            "render/frame.rs",
            "render/gather.rs",
            "render/mod.rs",
            "render/settings.rs",
            "render/shade.rs",
            "render/tile.rs",
        ],
    ),
    ("runtime", &["trace/found.rs", "trace/mod.rs", "trace/packet.rs", "trace/polish.rs", "trace/refine.rs"]),
    (
        "benches",
        &[
            "compare/dense.rs",
            "compare/mesh.rs",
            "compare/mod.rs",
            "compare/picture.rs",
            "compare/programs.rs",
            "compare/report.rs",
            "compare/rows.rs",
            "compare/train.rs",
        ],
    ),
    (
        "benches",
        &[
            "limit/mesh/brick.rs",
            "limit/mesh/finish.rs",
            "limit/mesh/flip.rs",
            "limit/mesh/join.rs",
            "limit/mesh/mod.rs",
            "limit/mesh/sample.rs",
            "limit/mesh/unit.rs",
        ],
    ),
];

/// The files and folders of `frontend/src`, from the ground up: those of a row import none of the rows behind it.
const FRONTEND: &[&[&str]] = &[
    // Ground: numbers, boxes, messages.
    &["affine", "angle", "bounds", "diagnostic", "field", "power", "query", "report", "word"],
    &["origin"],
    // Members.
    &["skeleton"],
    &["combine", "falloff", "texture"],
    &["function"],
    &["number"],
    &["expression", "interop"],
    &["attribute", "map", "warp"],
    // What was written.
    &["tree", "recipe", "traverse"],
    &["parameter"],
    &["model"],
    // What it means.
    &["check"],
    &["owner", "walk"],
    // Ways to write it.
    &["scopes", "term"],
    &["builder", "text"],
    &["import"],
    // Ways to run it.
    &["lower"],
];

/// The imports of a crate.
fn of_crate(name: &str) -> Vec<Import> {
    let read = sources(name).into_iter().map(|(path, text)| {
        let below = path.to_str().and_then(|path| path.split_once("/src/")).expect("sources are below src").1;
        (below.to_owned(), text)
    });
    imports(&read.collect::<Vec<_>>())
}

/// The circles that are not known, and what closes them.
fn new_circles(imports: &[Import], known: &BTreeSet<&str>) -> Vec<String> {
    let circles = circles(imports).into_iter();
    let news = circles.filter(|circle| circle.iter().any(|file| !known.contains(&**file)));
    let told = news.flat_map(|circle| {
        let inside = |import: &&Import| circle.contains(&import.from) && circle.contains(&import.to);
        imports.iter().filter(inside).map(told).collect::<Vec<_>>()
    });
    told.collect()
}

/// An import, as a message names it.
fn told(import: &Import) -> String {
    format!("{}:{} imports {} of {}", import.from, import.line, import.name, import.to)
}

/// The folder or file that a path below `src` begins with.
fn room(path: &str) -> &str {
    path.split('/').next().map_or(path, |first| first.strip_suffix(".rs").unwrap_or(first))
}

/// The imports that lead up, in an order of rooms from the ground up.
fn upwards(imports: &[Import], order: &[&[&str]]) -> Vec<String> {
    let height = |path: &str| order.iter().position(|row| row.contains(&room(path)));
    let up = imports.iter().filter(|import| height(&import.from) < height(&import.to));
    up.map(told).collect()
}

#[test]
fn no_file_imports_itself_through_others() {
    for name in CRATES {
        let known: BTreeSet<&str> =
            KNOWN.iter().filter(|row| row.0 == name).flat_map(|row| row.1).copied().collect();
        let found = of_crate(name);
        let news = new_circles(&found, &known);
        assert!(news.is_empty(), "{name} has a circle of files:\n{}", news.join("\n"));
        // A file that is in no circle any more leaves the list.
        let round: BTreeSet<String> = circles(&found).into_iter().flatten().collect();
        let gone: Vec<&&str> = known.iter().filter(|file| !round.contains(**file)).collect();
        assert!(gone.is_empty(), "{name}: {gone:?} are in no circle: strike them from KNOWN");
    }
}

#[test]
fn the_frontend_is_built_from_the_ground_up() {
    let found = of_crate("frontend");
    let named: BTreeSet<&str> = FRONTEND.iter().copied().flatten().copied().collect();
    let rooms: BTreeSet<&str> =
        found.iter().flat_map(|import| [room(&import.from), room(&import.to)]).collect();
    let missing: Vec<&&str> = rooms.difference(&named).collect();
    assert!(missing.is_empty(), "{missing:?} have no place in FRONTEND");
    let up = upwards(&found, FRONTEND);
    assert!(up.is_empty(), "imports lead up:\n{}", up.join("\n"));
}

/// Files of a crate that does not exist.
fn invented(files: &[(&str, &str)]) -> Vec<Import> {
    let root = ("lib.rs", "//! The root.");
    let owned = files.iter().chain([&root]).map(|&(path, text)| (path.to_owned(), text.to_owned()));
    imports(&owned.collect::<Vec<_>>())
}

#[test]
fn a_circle_is_found_and_named() {
    let a = ("a.rs", "use crate::b::B;\npub struct A(B);");
    let b = ("b/mod.rs", "mod c;\npub use c::C;\npub struct B;");
    // Through a re-export, in the body of a function, and in the list of a macro.
    for last in ["use crate::a::A;\npub struct C(A);", "fn f() {\n crate::a::g(); }"] {
        let found = invented(&[a, b, ("b/c.rs", last)]);
        assert!(circles(&found).is_empty(), "the re-export of C is no import: {found:?}");
    }
    let uses_child = ("b/mod.rs", "mod c;\npub use c::C;\npub struct B(C);");
    let found = invented(&[a, uses_child, ("b/c.rs", "use crate::a::A;\npub struct C(A);")]);
    assert_eq!(circles(&found), [["a.rs", "b/c.rs", "b/mod.rs"]]);
    let news = new_circles(&found, &BTreeSet::new());
    assert!(news.contains(&"b/c.rs:1 imports crate::a::A of a.rs".to_owned()), "{news:?}");
    assert!(new_circles(&found, &BTreeSet::from(["a.rs", "b/c.rs", "b/mod.rs"])).is_empty());

    let list = ("list.rs", "pub trait Member {}\nmembers! {\n    one::One,\n}");
    let member = ("list/one.rs", "use super::Member;\npub struct One;\nimpl Member for One {}");
    assert_eq!(circles(&invented(&[list, member])), [["list.rs", "list/one.rs"]]);
}

#[test]
fn tests_comments_and_strings_import_nothing() {
    let a = ("a.rs", "use crate::b::B;");
    for text in [
        "// use crate::a::A;\npub struct B;",
        "/// See [`crate::a::A`].\npub struct B; const S: &str = \"crate::a::A\";",
        "pub struct B;\n#[cfg(test)]\nmod tests {\n    use crate::a::A;\n}",
        "#[cfg(test)]\nuse crate::a::A;\npub struct B;",
        "pub struct B;\nconst Q: char = '\"'; fn f<'a>(x: &'a str) {} // crate::a::A",
    ] {
        assert!(circles(&invented(&[a, ("b.rs", text)])).is_empty(), "{text}");
    }
    let itself = ("b.rs", "pub struct B;\nmod inner { use super::B; mod more { use super::super::B; } }");
    assert_eq!(invented(&[a, itself]).len(), 1, "a module in the file itself is no other file");
    let really = ("b.rs", "pub struct B;\n#[cfg(not(test))]\nuse crate::a::A;");
    assert_eq!(circles(&invented(&[a, really])).len(), 1);
}

#[test]
fn an_import_that_leads_up_is_named() {
    let found = invented(&[("low.rs", "use crate::high::Top;"), ("high/mod.rs", "pub struct Top;")]);
    assert_eq!(upwards(&found, &[&["low"], &["high"]]), ["low.rs:1 imports crate::high::Top of high/mod.rs"]);
    assert!(upwards(&found, &[&["high"], &["low"]]).is_empty());
}
