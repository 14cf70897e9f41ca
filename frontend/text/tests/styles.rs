//! Styles: attributes and constants that have a name together, how they are read and printed, and what is
//! wrong with them.

use std::sync::Arc;

use jbt_model::attribute::AttributeGroup;
use jbt_model::builder::point;
use jbt_model::model::Model;
use jbt_model::traverse::Visit;
use jbt_model::walk::walk;
use jbt_testkit::scene::assert_reads_back;
use jbt_text::files::{FileRequest, Files, NamedFile, ResolveError, Resolver};
use jbt_text::{Options, compare, hash, model, parse, print, print_rust};

fn read(text: &str) -> Model {
    model(&format!("jbt 1 {text}")).unwrap_or_else(|error| panic!("{error}"))
}

/// All errors of a text, of reading or of the check.
fn error(text: &str) -> String {
    let text = format!("jbt 1 {text}");
    model(&text).and_then(|model| model.check()).expect_err(&text).to_string()
}

const OAK: &str = "attribute rough 1 default 0.5
    style oak = { color (0.5 0.25 0.125) rough 0.75 constant material \"oak\" }";

#[test]
fn a_style_is_its_attributes_and_constants() {
    let used = read(&format!(
        "{OAK} union {{ style oak {{ point {{ radius 1 }} }} point {{ at (3 0 0) radius 1 }} }}"
    ));
    let plain = read(
        "attribute rough 1 default 0.5 union {
            color (0.5 0.25 0.125) { rough 0.75 { constant material \"oak\" { point { radius 1 } } } }
            point { at (3 0 0) radius 1 } }",
    );
    assert_eq!(used.root, plain.root);
    assert_eq!(hash(&used), hash(&plain));
    assert!(compare(&used, &plain).is_empty());
    let tree = used.check().unwrap();
    assert_eq!(walk(&tree, [0.0; 3]).attributes.concat(), [0.5, 0.25, 0.125, 0.75]);
    assert_eq!(walk(&tree, [3.0, 0.0, 0.0]).attributes.concat(), [1.0, 1.0, 1.0, 0.5]);
    assert_eq!(tree.constants()[0].values, ["oak".into()]);
}

#[test]
fn they_are_printed_once_and_keep_their_names() {
    let statement = "style oak = { color (0.5 0.25 0.125) rough 0.75 constant material \"oak\" }";
    for (text, uses) in [
        (
            format!(
                "{OAK} union {{ style oak {{ point {{ radius 1 }} }} style oak {{ point {{ radius 2 }} }} }}"
            ),
            2,
        ),
        (format!("{OAK} bowl: style oak {{ rim: point {{ radius 1 }} }}"), 1),
        // Used where nothing else stands above.
        (
            format!(
                "{OAK} let a = style oak {{ point {{ radius 1 }} }} sum {{ use a translate (1 0 0) {{ use a }} }}"
            ),
            1,
        ),
        (
            format!(
                "{OAK} def leg(x) {{ style oak {{ point {{ at (x 0 0) radius 1 }} }} }} sum {{ leg(0) leg(1) }}"
            ),
            2,
        ),
        (format!("{OAK} sum {{ for i in 0 .. 3 {{ style oak {{ point {{ at (i 0 0) radius 1 }} }} }} }}"), 3),
        (format!("{OAK} part \"a\" {{ style oak {{ point {{ radius 1 }} }} }}"), 1),
        (format!("{OAK} style oak {{ color (1 1 1) {{ point {{ radius 1 }} }} }}"), 1),
    ] {
        let model = read(&text);
        assert_reads_back(&model);
        let printed = print(&model);
        assert_eq!(printed.matches(statement).count(), 1, "{printed}");
        assert_eq!(printed.matches("style oak {").count(), uses, "{printed}");
        assert_eq!(print(&jbt_text::model(&printed).unwrap()), printed);
    }
    // Nodes that are equal to those of a style, and shared with it, stand by themselves.
    let shared = read(&format!(
        "{OAK} sum {{ style oak {{ point {{ radius 1 }} }} rough 0.75 {{ constant material \"oak\" {{ point {{ radius 1 }} }} }} }}"
    ));
    let shared = Model { root: shared.root.share(), ..shared };
    assert!(print(&shared).contains("style oak { use n1 }"), "{}", print(&shared));
    assert_reads_back(&shared);
}

#[test]
fn any_attribute_may_be_in_a_style() {
    let text = "param p = 0.5 attribute uv 2 attribute rough 1
        # Wood of the oak.
        style oak = {
            color noise { a (1 0 0) b (p 0 0) size 0.5 }
            override rough expression { d = x * p, d * d }
            uv
            constant part 3 * 4
        }
        style pine = { uv scale (2 2) with color (0 1 0) }
        sum { style oak { point { radius 1 } } override style pine { point { radius 2 } } }";
    let model = read(text);
    assert_reads_back(&model);
    let printed = print(&model);
    for line in [
        "# Wood of the oak.\nstyle oak = { color noise {",
        " uv rotate 0 constant part 12 }\n",
        "style pine = { uv scale (2 2) color (0 1 0) }\n",
        "    override style pine { point {",
    ] {
        assert!(printed.contains(line), "{line}: {printed}");
    }
    assert_eq!(print(&jbt_text::model(&printed).unwrap()), printed);
}

/// A uv without a map ends where the next value begins, whatever that begins with.
#[test]
fn a_uv_without_a_map_may_stand_anywhere() {
    let groups = "attribute uv 2 attribute map 2 attribute rough 1 attribute sphere 1";
    for values in [
        "uv color (0 0 1)",
        "color (0 0 1) uv",
        "uv map",
        "uv constant part 2",
        "uv override rough 0.5",
        "map uv scale 2 rough 1",
        "uv with sphere 0.5",
        "uv scale (2 2) map rotate 30 rough 0.25",
    ] {
        let text = format!("{groups} style oak = {{ {values} }} style oak {{ point {{ radius 1 }} }}");
        let model = read(&text);
        assert_reads_back(&model);
        assert!(print(&model).contains("style oak {"), "{text}");
    }
    let found = error(&format!("{groups} uv color (1 0 0) {{ point {{ radius 1 }} }}"));
    assert!(found.contains("expected `{`"), "{found}");
}

/// What no text can define is printed as its values.
#[test]
fn what_cannot_be_defined_has_no_name() {
    let ball = point([0; 3], 1);
    let twice = ball.styled("oak", |tree| tree.color([1, 0, 0]).color([0, 1, 0]));
    let beside = Model::new(ball.styled("oak", |tree| tree.attribute("style", &[1])));
    let group = AttributeGroup { name: "style".into(), default: vec![0.0], ..AttributeGroup::color() };
    for model in [
        Model::new(twice),
        Model::new(ball.styled("two words", |tree| tree.color([1, 0, 0]))),
        Model { attributes: vec![AttributeGroup::color(), group], ..beside },
    ] {
        assert_reads_back(&model);
        assert!(!print(&model).contains("style oak ="), "{}", print(&model));
    }
}

#[test]
fn a_style_overrides_as_a_whole() {
    let of = |text: &str| {
        let tree = read(&format!("{OAK} {text}")).check().unwrap();
        walk(&tree, [0.0; 3]).attributes.concat()
    };
    let inner = "color (1 1 1) { rough 0 { point { radius 1 } } }";
    assert_eq!(of(&format!("style oak {{ {inner} }}")), [1.0, 1.0, 1.0, 0.0]);
    assert_eq!(of(&format!("override style oak {{ {inner} }}")), [0.5, 0.25, 0.125, 0.75]);
}

/// The file `wood.jbt`.
#[derive(Debug)]
struct Wood;

impl Resolver for Wood {
    fn resolve(&self, request: &FileRequest<'_>) -> Result<NamedFile, ResolveError> {
        let bytes = b"jbt 1 attribute rough 1 style oak = { rough 0.75 }".to_vec();
        Ok(NamedFile { identity: request.name.to_owned(), path: request.name.to_owned(), bytes })
    }
}

#[test]
fn files_bring_styles() {
    let scene = b"jbt 1 include \"wood.jbt\" style oak { point { radius 1 } }";
    let options = Options { files: Files::new(Arc::new(Wood)), ..Options::default() };
    let model = parse(scene, &options).unwrap_or_else(|error| panic!("{error}"));
    assert!(print(&model).contains("style oak = { rough 0.75 }"), "{}", print(&model));
}

#[test]
fn they_are_built() {
    let oak = |tree: jbt_model::tree::Tree| tree.constant("material", "oak").color([0.5, 0.25, 0.125]);
    let leg = |x: f64| point([x, 0.0, 0.0], 1).styled("oak", oak);
    let table = Model::new(leg(0.0) + leg(2.0) + leg(4.0).overriding());
    let printed = print(&table);
    for line in [
        "style oak = { color (0.5 0.25 0.125) constant material \"oak\" }",
        "    style oak { point { at (2 0 0)",
        "    override style oak { point { at (4 0 0)",
    ] {
        assert!(printed.contains(line), "{line}: {printed}");
    }
    let rust = print_rust(&table);
    assert_eq!(
        rust.matches(".styled(\"oak\", |tree| tree.constant(\"material\", \"oak\").color(").count(),
        3,
        "{rust}"
    );
    assert_eq!(rust.matches(").overriding()").count(), 1, "{rust}");
    // What an edit has changed is no use of the style any more.
    let first = table.root.prefix(Visit::Nodes).find(|tree| tree.style().is_some()).unwrap().clone();
    let other = point([9, 0, 0], 1).styled("oak", |tree| tree.color([0, 0, 0]));
    let edited = print(&Model::new(first + other));
    assert!(edited.contains("    color (0 0 0) { point { at (9 0 0)"), "{edited}");
    assert!(point([0; 3], 1).with_style("oak", &point([0; 3], 1)).is_none());
    let ball = point([0; 3], 1);
    assert!(ball.clone().with_style("oak", &ball).is_none(), "nothing is no style");
}

#[test]
fn what_is_called_style_is_what_it_was() {
    let group = read("attribute style 1 style 0.5 { point { radius 1 } }");
    assert_eq!(walk(&group.check().unwrap(), [0.0; 3]).attributes[1], [0.5]);
    assert_reads_back(&group);
    let def = read("def style(r) { point { radius r } } style(2)");
    assert_eq!(walk(&def.check().unwrap(), [0.0; 3]).field, 1.0);
    assert_reads_back(&read("let style = point { radius 1 } sum { use style style: point { radius 1 } }"));
    for text in [
        "let style = point { radius 2 } def of(node) { use node } of(style)",
        "param style = 2 def ball(r) { point { radius r } } ball(style)",
        "param override = 1 let b = override * 2 def ball(r) { point { radius r } } ball(b)",
    ] {
        let tree = read(text).check().unwrap();
        assert_eq!(walk(&tree, [0.0; 3]).field, 1.0, "{text}");
    }
}

#[test]
fn what_is_wrong_has_its_place() {
    for (text, message, caret) in [
        ("style oak { point { radius 1 } }", "no `style oak` stands above", "^^^"),
        ("style oak = { color (1 0 0) } style oka { point { radius 1 } }", "perhaps `oak`", "^^^"),
        (
            "style a = { color (1 0 0) } style a = { color (0 1 0) } style a { point { radius 1 } }",
            "a second `style a`",
            "^",
        ),
        ("style a = { } point { radius 1 }", "`style a` gives nothing", "^"),
        ("style a = color (1 0 0) point { radius 1 }", "expected `{` and attributes or constants", "^^^^^"),
        (
            "style a = { point { radius 1 } } point { radius 1 }",
            "expected an attribute, a constant, or `}`",
            "^^^^^",
        ),
        ("style a = { color (1 0) } point { radius 1 }", "", "^"),
        ("style a = { with gloss 1 } point { radius 1 }", "no attribute is named `gloss`", "^^^^^"),
        (
            "style a = { color (1 0 0) color (0 1 0) } point { radius 1 }",
            "gives `color (0 1 0)` a second time",
            "^^^^^^^^^^^^^",
        ),
        ("style a = { color (1 0 0) } style a { }", "`style` has no node in its block", "^^^^^^^"),
        ("style { point { radius 1 } }", "expected the name of a style", "^"),
        (
            "style a = { color checker { a (1 0 0) b (0 0 0) size 0 } } style a { point { radius 1 } }",
            "in `a`, which is used",
            "^^^^^^^",
        ),
    ] {
        let found = error(text);
        assert!(found.contains(message) && found.contains(caret), "{text}: {found}");
    }
    // An error of a definition is told once, however often it is used.
    let found = error(
        "style a = { constant m 1.5 } sum { style a { point { radius 1 } } style a { point { radius 1 } } }",
    );
    assert_eq!(found.matches("error:").count(), 1, "{found}");
}

#[test]
fn uses_are_charged() {
    let long = "0".repeat(1 << 16);
    let text = format!(
        "jbt 1 style a = {{ constant m \"{long}\" }} sum {{ for i in 0 .. 100000 {{ style a {{ point {{ radius 1 }} }} }} }}"
    );
    let found = model(&text).unwrap_err().to_string();
    assert!(found.contains("this use of `style a`"), "{found}");
}
