//! Parts of a text, and the node `empty`: what they mean, how they are printed, what is wrong with them.

use jbt_model::builder::point;
use jbt_model::model::Model;
use jbt_model::owner::owner;
use jbt_model::tree::Tree;
use jbt_model::walk::walk;
use jbt_testkit::scene::assert_reads_back;
use jbt_text::{Options, model, parse, print};

fn read(text: &str) -> Model {
    model(text).unwrap_or_else(|error| panic!("{error}"))
}

/// The first error of a text.
fn error(text: &str) -> String {
    model(text).expect_err(text)[0].message.clone()
}

const WHEEL: &str = "jbt 1
# what turns
part \"hub\" { color (1 0 0) { point { radius 1 } } }
let spoke = segment { from (0 0 0) to (3 0 0) radius 0.5 }
part \"rim\" { use spoke rotate axis z degrees 90 { use spoke } }
";

#[test]
fn parts_are_solids_with_names() {
    let wheel = read(WHEEL);
    let tree = wheel.check().unwrap();
    let names: Vec<&str> = tree.parts().into_iter().map(|part| part.name).collect();
    assert_eq!(names, ["hub", "rim"]);
    for p in [[0.1, 0.0, 0.0], [2.0, 0.1, 0.0], [0.0, 2.0, 0.2], [0.4, 0.1, 0.0]] {
        let of = |part: usize| walk(&tree.part(part), p).field;
        let larger = if of(0) >= of(1) { 0 } else { 1 };
        assert_eq!(walk(&tree, p).field, of(larger), "{p:?}");
        assert_eq!(tree.part_at(p), Some(larger), "{p:?}");
        let part = owner(&tree, p).unwrap().part(&tree).unwrap();
        assert!(part.starts_with(names[larger]), "{part}");
    }
    assert_eq!(tree.part_at([9.0; 3]), None);
    // Paths begin with parts.
    assert_eq!(tree.find("rim/spoke").unwrap().len(), 2);
    assert_eq!(wheel.only("rim").unwrap().check().unwrap().parts().len(), 1);
    assert_eq!(wheel.without("rim").unwrap().check().unwrap().parts()[0].name, "hub");
}

#[test]
fn parts_are_printed_and_read() {
    let wheel = read(WHEEL);
    let printed = print(&wheel);
    assert!(
        printed.contains("# what turns\npart \"hub\" {\n    color (1 0 0) { point { radius 1 } }\n}\n"),
        "{printed}"
    );
    assert!(printed.contains("part \"rim\" {\n    use spoke\n"), "{printed}");
    let again = assert_reads_back(&wheel);
    assert_eq!(print(&again), printed);
    assert_eq!(again.check().unwrap().parts().len(), 2);
    // The same as the builder's.
    let built = Model::new(Tree::of_parts([("a", point([0; 3], 1)), ("b", point([1, 0, 0], 2))]));
    let text = "jbt 1 part \"a\" { point { radius 1 } } part \"b\" { point { at (1 0 0) radius 2 } }";
    assert_eq!(read(text), built);
    assert_eq!(print(&read(text)), print(&built));
}

#[test]
fn wrong_parts_are_errors() {
    let part = "part \"a\" { point { radius 1 } }";
    for (text, expected) in [
        (format!("jbt 1 {part} {part}"), "a second part `a`"),
        (format!("jbt 1 {part} point {{ radius 1 }}"), "a node beside parts"),
        ("jbt 1 part \"a\" { }".to_owned(), "the part `a` has no node"),
        ("jbt 1 part \"two words\" { point { radius 1 } }".to_owned(), "a part is called `two words`"),
        (format!("jbt 1 part \"a\" {{ {part} }}"), "`part` here"),
        ("jbt 1 part \"a\" { point { radius 1 }".to_owned(), "this `{` is not closed"),
    ] {
        let found = model(&text).expect_err(&text);
        if expected != "`part` here" {
            assert_eq!(found[0].message, expected, "{text}");
        }
    }
    // Equal after normalization: one error.
    let text = "jbt 1 part \"\u{e9}\" { point { radius 1 } } part \"e\u{301}\" { point { radius 2 } }";
    let errors = model(text).unwrap_err();
    assert_eq!((errors.len(), errors[0].message.as_str()), (1, "a second part `\u{e9}`"));
    // Trees built by hand.
    let twice = Tree::of_parts([("a", point([0; 3], 1)), ("a", point([3, 0, 0], 1))]);
    assert_eq!(Model::new(twice).check().unwrap_err()[0].message, "a second part `a`");
}

#[test]
fn a_word_is_a_part_with_a_name_in_quotes_alone() {
    let text = "jbt 1 attribute part 1 attribute empty 1 part 0.5 { empty 0.25 { point { radius 1 } } }";
    let tree = read(text).check().unwrap();
    assert!(tree.parts().is_empty());
    assert_eq!(walk(&tree, [0.0; 3]).attributes[1..], [vec![0.5], vec![0.25]]);
    assert_eq!(error("jbt 1 part { point { radius 1 } }"), "no node is called `part`");
}

#[test]
fn empty_is_nothing() {
    let lamp = "jbt 1 param on = 0 select on { empty point { radius 1 } }";
    let value = |on: f64, p: [f64; 3]| {
        let options = Options { parameters: vec![("on".to_owned(), on)], ..Options::default() };
        walk(&parse(lamp.as_bytes(), &options).unwrap().check().unwrap(), p).field
    };
    assert_eq!((value(0.0, [0.0; 3]), value(1.0, [0.0; 3])), (0.0, 1.0));
    assert!(read(lamp).check().unwrap().support().is_empty());
    assert!(print(&read(lamp)).contains("empty"), "{}", print(&read(lamp)));
    assert_reads_back(&read(lamp));
    // It changes nothing beside others.
    for operator in ["sum", "union", "difference", "blend ricci 3", "smooth_union 0.2"] {
        let of = |rest: &str| {
            let text = format!("jbt 1 {operator} {{ color (1 0 0) {{ point {{ radius 2 }} }} {rest} }}");
            walk(&read(&text).check().unwrap(), [0.5, 0.2, 0.1])
        };
        let (with, without) = (of("color (0 1 0) { empty }"), of(""));
        assert!((with.field - without.field).abs() <= 1e-12, "{operator}");
        assert_eq!(with.attributes[0], vec![1.0, 0.0, 0.0], "{operator}");
    }
    assert_eq!(
        walk(&read("jbt 1 intersection { point { radius 1 } empty }").check().unwrap(), [0.0; 3]).field,
        0.0
    );
}
