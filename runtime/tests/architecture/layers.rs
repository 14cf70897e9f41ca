//! Layers within crates: which file may import which, and that no file imports itself through others.
//!
//! No crate has a circle of files. The folders of the frontend have an order besides.

use std::collections::BTreeSet;

use crate::circles::circles;
use crate::imports::{Import, imports};
use crate::{CRATES, sources};

/// The files and folders of `frontend/model/src`, from the ground up: those of a row import none of the rows
/// behind it.
const MODEL: &[&[&str]] = &[
    // Ground: numbers, boxes, messages.
    &[
        "affine",
        "angle",
        "bounds",
        "constant",
        "diagnostic",
        "eigen",
        "field",
        "label",
        "orientation",
        "power",
        "precedence",
        "query",
        "report",
        "word",
    ],
    &["origin"],
    // Members.
    &["axis", "member"],
    &["skeleton"],
    &["combine", "falloff", "texture"],
    &["function"],
    &["number"],
    &["expression", "interop"],
    &["attribute", "map", "particles", "warp"],
    // What nodes mean, and what was written.
    &["kind"],
    &["written"],
    &["tree", "traverse"],
    &["parameter", "path"],
    &["model"],
    // What it means.
    &["check"],
    &["descent"],
    &["owner", "tour", "walk"],
    &["weights"],
    // Ways to write it.
    &["scopes", "term"],
    &["builder"],
];

/// The imports of a crate.
fn of_crate(name: &str) -> Vec<Import> {
    let read = sources(name).into_iter().map(|(path, text)| {
        let below = path.to_str().and_then(|path| path.split_once("/src/")).expect("sources are below src").1;
        (below.to_owned(), text)
    });
    imports(&read.collect::<Vec<_>>())
}

/// The imports of all circles, as a message names them.
fn told_circles(imports: &[Import]) -> Vec<String> {
    let told = circles(imports).into_iter().flat_map(|circle| {
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
        let found = told_circles(&of_crate(name));
        assert!(found.is_empty(), "{name} has a circle of files:\n{}", found.join("\n"));
    }
}

#[test]
fn a_model_is_built_from_the_ground_up() {
    let found = of_crate("frontend/model");
    let named: BTreeSet<&str> = MODEL.iter().copied().flatten().copied().collect();
    let rooms: BTreeSet<&str> =
        found.iter().flat_map(|import| [room(&import.from), room(&import.to)]).collect();
    let missing: Vec<&&str> = rooms.difference(&named).collect();
    assert!(missing.is_empty(), "{missing:?} have no place in MODEL");
    let up = upwards(&found, MODEL);
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
    let told = told_circles(&found);
    assert!(told.contains(&"b/c.rs:1 imports crate::a::A of a.rs".to_owned()), "{told:?}");

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
        "pub(in crate::a) struct B;",
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
