//! What counts whatever stands below: how it is read, printed and compared, and what is wrong with it.

use jbt_model::builder::point;
use jbt_model::model::Model;
use jbt_model::owner::owner;
use jbt_model::tour::TourEvent;
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

/// The attributes at the middle of a ball.
fn attributes(text: &str) -> Vec<f64> {
    walk(&read(text).check().unwrap(), [0.0; 3]).attributes.concat()
}

const RED: &str = "color (1 0 0) { point { radius 1 } }";

#[test]
fn the_outermost_override_counts() {
    let (red, green, blue) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    for (text, expected) in [
        (format!("color (0 1 0) {{ {RED} }}"), red),
        (format!("override color (0 1 0) {{ {RED} }}"), green),
        (format!("override color (0 1 0) {{ override {RED} }}"), green),
        (format!("color (0 1 0) {{ override {RED} }}"), red),
        (format!("color (0 0 1) {{ override color (0 1 0) {{ {RED} }} }}"), green),
        (
            format!(
                "override color (0 0 1) {{ translate (0 0 0) {{ override color (0 1 0) {{ {RED} }} }} }}"
            ),
            blue,
        ),
        (format!("override with color (0 1 0) {{ {RED} }}"), green),
        ("override color (0 1 0) { particles { at ((0 0 0)) radius 1 color ((1 0 0)) } }".to_owned(), green),
        (format!("override color checker {{ a (0 1 0) b (0 1 0) }} {{ {RED} }}"), green),
    ] {
        assert_eq!(attributes(&text), expected, "{text}");
        assert_reads_back(&read(&text));
    }
    // Other groups have nothing to do with it.
    let text = format!("attribute rough 1 override rough 0.5 {{ rough 0.25 {{ {RED} }} }}");
    assert_eq!(attributes(&text), [1.0, 0.0, 0.0, 0.5]);
}

#[test]
fn constants_override_likewise() {
    let text = "override constant m \"steel\" { union {
        constant m \"oak\" { constant n 1 { point { radius 1 } } }
        override constant n 2 { translate (3 0 0) { constant n 3 { constant m \"oak\" { point { radius 1 } } } } }
    } }";
    let tree = read(text).check().unwrap();
    let told = |x: f64| -> Vec<String> {
        let owner = owner(&tree, [x, 0.1, 0.0]).unwrap();
        owner.constants(&tree).into_iter().map(|(name, value)| format!("{name} {value}")).collect()
    };
    assert_eq!([told(0.0), told(3.0)], [["m \"steel\"", "n 1"], ["m \"steel\"", "n 2"]]);
    let all = tree.constants();
    assert_eq!(all[0].values, ["steel".into()], "the oak does not count");
    assert_eq!(all[1].values, [1.into(), 2.into()]);
    let leaves = tree.tour().filter_map(|event| match event {
        TourEvent::Enter(step) if tree.node(step.node).children.is_empty() => Some(step),
        TourEvent::Enter(_) | TourEvent::Leave(_) => None,
    });
    let bound = |node| format!("{:?}", tree.node(node).kind.constant().unwrap());
    let bound: Vec<Vec<String>> =
        leaves.map(|step| step.bound().iter().map(|&node| bound(node)).collect()).collect();
    assert_eq!(bound[0], ["(\"m\", Text(\"steel\"))", "(\"n\", Whole(1))"]);
    assert_eq!(bound[1], ["(\"m\", Text(\"steel\"))", "(\"n\", Whole(2))"]);
    assert_reads_back(&read(text));
}

#[test]
fn they_are_a_part_of_what_a_model_means() {
    let [plain, over] = [RED.to_owned(), format!("override {RED}")].map(|text| read(&text));
    assert_ne!(hash(&plain), hash(&over));
    let found = compare(&plain, &over);
    assert_eq!((found.len(), &*found[0].path), (1, "color"));
    assert_eq!(found[0].second.as_deref(), Some("override color (1 0 0)"));
    let ball = point([0; 3], 1).color([1, 0, 0]).overriding().constant("n", 1).overriding();
    let printed = print(&Model::new(ball));
    assert!(printed.contains("\noverride constant n 1 { override color (1 0 0) { point {"), "{printed}");
}

#[test]
fn a_group_of_this_name_is_what_it_was() {
    let text = "attribute override 1 override 0.5 { point { radius 1 } }";
    assert_eq!(attributes(text)[3], 0.5);
    assert_reads_back(&read(text));
    let def = read("def override(r) { point { radius r } } override(2)");
    assert_eq!(walk(&def.check().unwrap(), [0.0; 3]).field, 1.0);
    let both = Model { root: point([0; 3], 1).color([1, 0, 0]).overriding(), ..read(text) };
    let found = both.check().unwrap_err().to_string();
    assert!(found.contains("`override` beside an attribute of this name"), "{found}");
}

#[test]
fn what_is_wrong_has_its_place() {
    for (text, message, caret) in [
        ("override { point { radius 1 } }", "expected an attribute's name, `constant` or `style`", "^"),
        ("override point { radius 1 }", "expected an attribute's name, `constant` or `style`", "^^^^^"),
        ("override with { point { radius 1 } }", "expected an attribute's name", "^"),
        ("override color (1 0 0) { }", "`override` has no node in its block", "^^^^^^^^^^^^^^^^^^^^^^"),
        ("overide color (1 0 0) { point { radius 1 } }", "perhaps `override`", "^^^^^^^"),
        ("override constant m 1.5 { point { radius 1 } }", "a constant is 1.5", "^^^"),
    ] {
        let found = error(text);
        assert!(found.contains(message) && found.contains(caret), "{text}: {found}");
    }
}
