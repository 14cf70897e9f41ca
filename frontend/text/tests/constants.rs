//! Constants of leaves: how they are read, printed and compared, who answers them, what is wrong with them.

use jbt_ir::limits::MAX_CONSTANTS;
use jbt_model::builder::point;
use jbt_model::constant::LeafConstant;
use jbt_model::model::Model;
use jbt_model::owner::owner;
use jbt_model::tree::Tree;
use jbt_model::walk::walk;
use jbt_testkit::scene::assert_reads_back;
use jbt_text::{compare, hash, model, print};

fn read(text: &str) -> Model {
    model(&format!("jbt 1 {text}")).unwrap_or_else(|error| panic!("{error}"))
}

/// All errors of a text, of reading or of the check.
fn error(text: &str) -> String {
    let text = format!("jbt 1 {text}");
    model(&text).and_then(|model| model.check()).expect_err(&text).to_string()
}

const PLATE: &str = "constant material \"steel\" { union {
    point { radius 1 }
    translate (3 0 0) { constant material \"brass\" { constant part 17 { point { radius 1 } } } }
    constant part -1 { twist axis z rate 1 { point { at (6 0 0) radius 1 } } }
} }";

#[test]
fn the_owner_answers_the_nearest_of_each_name() {
    let tree = read(PLATE).check().unwrap();
    let told = |x: f64| -> Vec<String> {
        let owner = owner(&tree, [x, 0.1, 0.0]).unwrap();
        owner.constants(&tree).into_iter().map(|(name, value)| format!("{name} {value}")).collect()
    };
    assert_eq!(told(0.0), ["material \"steel\""]);
    assert_eq!(told(3.0), ["material \"brass\"", "part 17"]);
    assert_eq!(told(6.0), ["material \"steel\"", "part -1"]);
    let all = tree.constants();
    assert_eq!(all.iter().map(|one| &*one.name).collect::<Vec<_>>(), ["material", "part"]);
    assert_eq!(all[0].values, ["steel".into(), LeafConstant::from("brass")]);
    assert_eq!(all[1].values, [17.into(), LeafConstant::from(-1)]);
    // They stay where other answers are left out, or more are asked for.
    assert_eq!(tree.of_attributes(&["color"]).unwrap().constants(), all);
    assert_eq!(tree.with_owners().unwrap().constants(), all);
    // What nobody is below of does not count.
    let hidden = read("constant a 1 { constant a 2 { point { radius 1 } } }").check().unwrap();
    assert_eq!(hidden.constants()[0].values, [2.into()]);
    let weighed = "twist axis z rate 1 weighted { point { radius 1 } constant a 1 { point { radius 1 } } }";
    assert!(read(weighed).check().unwrap().constants().is_empty());
    let chosen = read("select 1 { constant a 1 { point { radius 1 } } constant a 2 { point { radius 1 } } }");
    assert_eq!(chosen.check().unwrap().constants()[0].values, [2.into()]);
}

#[test]
fn parts_have_their_own() {
    let text = "part \"hub\" { constant a 1 { point { radius 1 } } } part \"rim\" { point { radius 1 } }";
    let pieces = read(text).check().unwrap().constants_of_pieces();
    assert_eq!(pieces.iter().map(Vec::len).collect::<Vec<_>>(), [1, 0]);
    // What parts share counts for each of them, in the order of each.
    let shared = "let arm = union { constant a 2 { point { radius 1 } } constant a 3 { point { radius 2 } } }
        part \"hub\" { constant a 1 { union { use arm point { radius 4 } } } }
        part \"rim\" { use arm constant a 2 { use arm } constant a 4 { point { radius 1 } } }
        part \"pin\" { use arm }";
    let pieces = read(shared).check().unwrap().constants_of_pieces();
    let told: Vec<String> = pieces.iter().map(|piece| format!("{:?}", piece[0].values)).collect();
    let of =
        |numbers: &[i64]| format!("{:?}", numbers.iter().map(|&n| LeafConstant::from(n)).collect::<Vec<_>>());
    assert_eq!(told, [of(&[1, 2, 3]), of(&[2, 3, 4]), of(&[2, 3])]);
    // What is selected keeps what stands above it.
    let selected = read("constant a 1 { union { x: point { radius 1 } y: point { at (3 0 0) radius 1 } } }");
    assert_eq!(selected.only("y").unwrap().check().unwrap().constants()[0].values, [1.into()]);
}

#[test]
fn they_are_printed_and_read() {
    for text in [
        PLATE,
        "constant color \"of rust # no comment\" { color (1 0 0) { point { radius 1 } } }",
        "constant n \"\" { point { radius 1 } }",
        "constant n 9007199254740992 { point { radius 1 } }",
        "constant größe \"7 µm\" { point { radius 1 } }",
        "let a = constant n 1 { point { radius 1 } } union { use a translate (1 0 0) { use a } }",
    ] {
        assert_reads_back(&read(text));
    }
    let printed = print(&read("constant part 3 * 4 + 5 { constant m \"steel\" { point { radius 1 } } }"));
    assert!(
        printed.ends_with("\nconstant part 17 { constant m \"steel\" { point { radius 1 } } }\n"),
        "{printed}"
    );
    let built = Model::new(point([0; 3], 1).constant("m", "steel").constant("part", 17));
    assert_eq!(print(&built), printed);
    let each = read("union { for i in 0 .. 3 { constant part i { point { at (i 0 0) radius 1 } } } }");
    assert_eq!(each.check().unwrap().constants()[0].values, [0.into(), 1.into(), LeafConstant::from(2)]);
}

#[test]
fn a_group_of_this_name_is_what_it_was() {
    let text = "attribute constant 1 constant 0.5 { point { radius 1 } }";
    let group = read(text);
    assert_eq!(walk(&group.check().unwrap(), [0.0; 3]).attributes[1], [0.5]);
    assert_reads_back(&group);
    let def = read("def constant(r) { point { radius r } } constant(2)");
    assert_eq!(walk(&def.check().unwrap(), [0.0; 3]).field, 1.0);
    let both = Model { root: point([0; 3], 1).constant("a", 1), ..group };
    let found = both.check().unwrap_err().to_string();
    assert!(found.contains("a constant beside an attribute that is called `constant`"), "{found}");
}

#[test]
fn hashes_and_differences_see_them() {
    let [steel, oak, other, none] = [
        "constant m \"steel\" { point { radius 1 } }",
        "constant m \"oak\" { point { radius 1 } }",
        "constant n \"steel\" { point { radius 1 } }",
        "point { radius 1 }",
    ]
    .map(read);
    let hashes: std::collections::HashSet<_> = [&steel, &oak, &other, &none].map(hash).into();
    assert_eq!(hashes.len(), 4);
    let found = compare(&steel, &oak);
    assert_eq!((found.len(), &*found[0].path), (1, "constant"));
    assert_eq!(found[0].second.as_deref(), Some("constant m \"oak\""));
    let shared = Tree::union([steel.root.clone(), oak.root.clone()]).share();
    assert_eq!(shared.count(), 4, "the leaf is shared, the constants are not");
}

#[test]
fn what_is_wrong_has_its_place() {
    for (text, message, caret) in [
        ("constant m 1.5 { point { radius 1 } }", "a constant is 1.5", "^^^"),
        ("constant m 1e15 * 1000 { point { radius 1 } }", "a constant is 1000000000000000000", "^^^^"),
        ("constant m { point { radius 1 } }", "expected text in quotes, or a whole number", "^"),
        ("constant 5 { point { radius 1 } }", "expected the name of a constant", "^"),
        ("constant m \"a\" { }", "`constant` has no node in its block", "^^^^^^^^^^^^^^"),
        ("constnt m 1 { point { radius 1 } }", "perhaps `constant`", "^^^^^^^"),
    ] {
        let found = error(text);
        assert!(found.contains(message) && found.contains(caret), "{text}: {found}");
    }
    // Whole numbers are told apart up to 2^53; what may have been rounded is none.
    for (number, is_fine) in [
        ("9007199254740992", true),
        ("-9007199254740992", true),
        ("9007199254740991 - 1", true),
        ("9007199254740993", false),
        ("-9007199254740993", false),
        ("9007199254740992 + 1", false),
        ("2^53", false),
        ("1e300", false),
    ] {
        let found = model(&format!("jbt 1 constant m {number} {{ point {{ radius 1 }} }}"));
        assert_eq!(found.is_ok(), is_fine, "{number}");
        let told = found.map_or_else(|error| error.to_string(), |model| print(&model));
        let expected = if is_fine { "constant m" } else { "expected at most 9007199254740992 in magnitude" };
        assert!(told.contains(expected), "{number}: {told}");
    }
    let of = |name: &str, value: LeafConstant| Model::new(point([0; 3], 1).constant(name, value)).check();
    for (name, value, message) in [
        ("a b", 1.into(), "a constant is called `a b`"),
        ("a", "two\nlines".into(), "the constant `a` has a quote or a line end"),
        ("a", "a \" quote".into(), "the constant `a` has a quote or a line end"),
        ("a", ((1_i64 << 53) + 1).into(), "the constant `a` is 9007199254740993"),
    ] {
        let found = of(name, value).unwrap_err().to_string();
        assert!(found.contains(message), "{found}");
    }
    // A parameter that it depends on can be set before alone.
    let tree = read("param n = 3 constant m n { point { radius n } }").check().unwrap();
    assert!(tree.with_parameters(&[("n", 4.0)]).is_err());
}

#[test]
fn there_is_a_bound_of_names() {
    let of = |count: usize| {
        let tree = (0..count).fold(point([0; 3], 1), |tree, n| tree.constant(&format!("n{n}"), 1));
        Model::new(tree).check()
    };
    assert_eq!(of(MAX_CONSTANTS).unwrap().constants().len(), MAX_CONSTANTS);
    let found = of(MAX_CONSTANTS + 1).unwrap_err().to_string();
    assert!(found.contains("more than 64 names of constants"), "{found}");
}
