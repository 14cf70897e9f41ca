//! Hashes of models, and what two models differ in.

use jbt_model::model::Model;
use jbt_text::{compare, hash, model, print};

fn read(text: &str) -> Model {
    model(&format!("jbt 1 {text}")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn hashes_are_of_what_a_model_means() {
    // Its value is that of version 1, computed by another program.
    let ball = read("point { radius 1 }");
    assert_eq!(hash(&ball).to_string(), "1-d3865ed2e8c82e874bb0c23c53b32fb9");
    let shared = "let a = point { radius 1 } union { use a translate (1 0 0) { use a } }";
    for (first, second) in [
        ("point { radius 1 }", "name: point { radius 1.0 }"),
        (shared, "union { point { radius 1 } translate (1 0 0) { point { radius 1 } } }"),
        ("param r = 2 point { radius r }", "param r = 1 + 1 point { radius r }"),
    ] {
        assert_eq!(hash(&read(first)), hash(&read(second)), "{first}");
    }
    let all = [
        "point { radius 1 }",
        "point { radius 2 }",
        "iso 0.25 point { radius 1 }",
        "orientation up y point { radius 1 }",
        "sum { point { radius 1 } }",
        "union { point { radius 1 } }",
        "param r = 1 point { radius r }",
        "param s = 1 point { radius s }",
        "attribute heat 1 point { radius 1 }",
        "particles { at ((0 0 0)) radius 1 }",
        "empty",
        "part \"a\" { point { radius 1 } }",
    ];
    for (place, a) in all.iter().enumerate() {
        for b in &all[..place] {
            assert_ne!(hash(&read(a)), hash(&read(b)), "{a} and {b}");
        }
        assert_eq!(hash(&model(&print(&read(a))).unwrap()), hash(&read(a)), "{a}");
    }
}

#[test]
fn items_that_differ_are_named() {
    let first = read(
        "iso 0.5 union { hub: color (1 0 0) { point { radius 1 } } arm: point { radius 2 } point { radius 3 } }",
    );
    let second = read(
        "iso 0.4 union { arm: point { radius 2 } hub: color (0 1 0) { point { radius 1 } } ring { ring_radius 1 radius 1 } }",
    );
    assert!(compare(&first, &first).is_empty());
    let found = compare(&first, &second);
    let words: Vec<(String, Option<String>, Option<String>)> =
        found.into_iter().map(|one| (one.path, one.first, one.second)).collect();
    let some = |text: &str| Some(text.to_owned());
    assert_eq!(words[0], (String::new(), some("iso 0.5"), None));
    assert_eq!(words[1], (String::new(), None, some("iso 0.4")));
    assert_eq!(words[2], ("union.0/hub".to_owned(), some("color (1 0 0)"), some("color (0 1 0)")));
    assert_eq!(words[3], ("union.2/point".to_owned(), some("point { radius 3 }"), None));
    assert!(words[4].0.starts_with("union.3/ring") && words[4].1.is_none(), "{words:?}");
    assert_eq!(words.len(), 5);
    // Subtrees that are shared differ once, and so do long chains.
    let deep = |radius: i32| {
        let mut text = format!("let a0 = point {{ radius {radius} }} ");
        for level in 0..40 {
            text +=
                &format!("let a{} = sum {{ use a{level} translate (1 0 0) {{ use a{level} }} }} ", level + 1);
        }
        read(&(text + "use a40"))
    };
    assert_eq!(compare(&deep(1), &deep(2)).len(), 1);
}
