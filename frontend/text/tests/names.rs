//! Names: they stay with their nodes, paths of them lead to places, comments stay with statements.

use jbt_model::builder::{Axis, point};
use jbt_model::combine::CombinatorKind;
use jbt_model::map::MapKind;
use jbt_model::model::Model;
use jbt_model::owner::owner;
use jbt_model::skeleton::SkeletonKind;
use jbt_model::traverse::Visit;
use jbt_model::walk::walk;
use jbt_model::warp::WarpKind;
use jbt_model::weights::WeightOf;
use jbt_testkit::scene::assert_reads_back;
use jbt_text::{Options, model, parse, print};

/// All names in the order of a model's nodes, each node once.
fn names(model: &Model) -> Vec<String> {
    model.root.prefix(Visit::Nodes).filter_map(|tree| tree.node().name()).map(str::to_owned).collect()
}

fn read(text: &str) -> Model {
    model(text).unwrap_or_else(|error| panic!("{error}"))
}

const ROBOT: &str = "jbt 1
let hand = union { point { radius 1 } finger: translate (1 0 0) { point { radius 0.5 } } }
let spare = point { at (9 9 9) radius 1 }
robot: difference {
    body: union {
        point { radius 2 }
        arm: translate (5 0 0) { use hand }
        arm: color (1 0 0) { translate (-5 0 0) { use hand } }
        leg: segment { from (0 0 -2) to (0 0 -5) radius 1 }
    }
    cut: point { at (0 0 1) radius 1 }
}";

#[test]
fn names_are_printed_and_read() {
    let robot = read(ROBOT);
    assert_eq!(names(&robot), ["robot", "body", "arm", "hand", "finger", "arm", "leg", "cut"]);
    let printed = print(&robot);
    assert_eq!(
        printed,
        "jbt 1\niso 0.5\n\nlet hand = union {\n    point { radius 1 }\n    \
         finger: translate (1 0 0) { point { radius 0.5 } }\n}\n\nrobot: difference {\n    body: union {\n        \
         point { radius 2 }\n        arm: translate (5 0 0) { use hand }\n        \
         arm: color (1 0 0) { translate (-5 0 0) { use hand } }\n        \
         leg: segment { from (0 0 -2) to (0 0 -5) radius 1 }\n    }\n    cut: point { at (0 0 1) radius 1 }\n}\n"
    );
    let again = assert_reads_back(&robot);
    assert_eq!(names(&again), names(&robot));
    assert_eq!(print(&again), printed);
}

#[test]
fn names_of_every_kind_survive() {
    for text in [
        "jbt 1 let iso = point { radius 1 } let use = point { radius 2 } let sum = point { radius 3 }
         union { use iso use use use sum color: point { radius 4 } for: point { radius 5 } union: union { use sum } }",
        // Two nodes of one name that both need a `let`.
        "jbt 1 def f(r) { let tip = point { radius r } use tip use tip } union { sum { f(1) } sum { f(2) } }",
        // A name that a printer would have made, and one that a parameter has.
        "jbt 1 param p = 1 let n1 = point { radius p } let q = union { use n1 use n1 } union { point { radius 2 } use q use q }",
        "jbt 1 param p = 1 def f() { let p = point { radius 3 } use p use p } union { f() point { radius p } }",
        "jbt 1 let ball = point { radius 1 } all: expression { field(ball) + x }",
    ] {
        let model = read(text);
        let again = assert_reads_back(&model);
        assert_eq!(names(&again), names(&model), "{}", print(&model));
        assert_eq!(print(&again), print(&model));
    }
}

#[test]
fn a_use_may_have_a_name() {
    let text = "jbt 1
        let arm = point { radius 1 }
        # The other one.
        let b = use arm
        def f() { tip: point { at (0 0 3) radius 1 } }
        let c = f()
        union {
            left: use arm
            translate (3 0 0) { use arm }
            translate (6 0 0) { use b }
            translate (9 0 0) { right: f() }
            use c
            twice: left2: f()
        }";
    let model = read(text);
    assert_eq!(names(&model), ["left", "arm", "b", "right", "tip", "c", "twice", "left2"]);
    let tree = model.check().unwrap();
    let paths = |path: &str| tree.find(path).unwrap().into_iter().map(|found| found.path).collect::<Vec<_>>();
    assert_eq!(paths("arm"), ["left/arm", "/arm", "b/arm"]);
    assert_eq!([paths("left"), paths("b"), paths("right")], [["left"], ["b"], ["right"]]);
    assert_eq!(paths("tip"), ["right/tip", "c/tip", "twice/left2/tip"]);
    assert!(tree.with_weights(WeightOf::Named("left")).is_ok());
    assert!(tree.with_weights(WeightOf::Named("/arm")).is_err(), "one of two places of a shared node");
    let found = owner(&tree, [6.1, 0.0, 0.0]).unwrap();
    assert_eq!(found.part(&tree).as_deref(), Some("b/arm"));
    same_field(&model.only("left").unwrap(), "jbt 1 point { radius 1 }");
    same_field(&model.only("b").unwrap(), "jbt 1 translate (6 0 0) { point { radius 1 } }");
    let printed = print(&model);
    for line in ["    left: use arm\n", "# The other one.\nlet b = use arm\n", "{ right: use tip }"] {
        assert!(printed.contains(line), "{line}: {printed}");
    }
    let again = assert_reads_back(&model);
    assert_eq!((names(&again), print(&again)), (names(&model), printed));
    // The subtree stays one, and the field is what it was.
    let arm = model.root.prefix(Visit::Nodes).filter(|tree| tree.node().name() == Some("arm")).count();
    assert_eq!(arm, 1);
    let plain = "jbt 1 let arm = point { radius 1 } def f() { point { at (0 0 3) radius 1 } }
        union { use arm translate (3 0 0) { use arm } translate (6 0 0) { use arm } translate (9 0 0) { f() } f() f() }";
    same_field(&model, plain);
    // The name that it has already is no second one.
    let same =
        read("jbt 1 let arm = point { radius 1 } union { arm: use arm translate (3 0 0) { arm: use arm } }");
    assert_eq!(same.root.count(), 3);
}

#[test]
fn every_word_may_be_a_name() {
    let skeletons = SkeletonKind::ALL.iter().map(|kind| kind.name());
    let operators = CombinatorKind::ALL.iter().map(|kind| kind.name());
    let warps = WarpKind::ALL.iter().map(|kind| kind.name());
    let members = skeletons.chain(operators).chain(warps).chain(MapKind::ALL.iter().map(|kind| kind.name()));
    let others = [
        "jbt",
        "iso",
        "origin",
        "orientation",
        "param",
        "attribute",
        "let",
        "def",
        "style",
        "part",
        "include",
        "for",
        "in",
        "if",
        "else",
        "and",
        "or",
        "not",
        "constant",
        "override",
        "with",
        "empty",
        "root",
        "default",
        "x",
        "field",
        "pi",
        "sqrt",
        "count",
        "srgb",
        "color",
        "t0",
        "n1",
        "step",
        "up",
        "handed",
        "yes",
        "no",
    ];
    for word in members.chain(others) {
        for text in [
            format!("jbt 1 let {word} = point {{ radius 1 }} use {word}"),
            format!("jbt 1 {word}: point {{ radius 1 }}"),
            format!(
                "jbt 1 # First.\nlet a = point {{ radius 1 }}\n# Second.\n{word}: union {{ use a use a }}"
            ),
            format!(
                "jbt 1 union {{ {word}: point {{ radius 1 }} {word}: sum {{ {word}: point {{ radius 2 }} }} }}"
            ),
            format!("jbt 1 let {word} = point {{ radius 1 }} union {{ use {word} a: use {word} }}"),
            format!("jbt 1 let a = point {{ radius 1 }} union {{ {word}: use a use a }}"),
            format!("jbt 1 part \"a\" {{ {word}: point {{ radius 1 }} }} part \"b\" {{ {word}: empty }}"),
            format!(
                "jbt 1 def f(a) {{ {word}: point {{ radius 1 }} use a }} union {{ f({word}: point {{ radius 2 }}) }}"
            ),
            format!("jbt 1 union {{ for i in 0 .. 2 {{ {word}: point {{ radius i + 1 }} }} }}"),
            format!("jbt 1 union {{ if 1 {{ point {{ radius 1 }} }} {word}: point {{ radius 2 }} }}"),
        ] {
            let model = read(&text);
            assert!(names(&model).iter().any(|name| name == word), "{text}");
            let printed = print(&model);
            let again =
                jbt_text::model(&printed).unwrap_or_else(|error| panic!("{text}\n{printed}\n{error}"));
            assert_eq!(again, model, "{printed}");
            assert_eq!((names(&again), print(&again)), (names(&model), printed));
            assert_eq!(again.comments, model.comments, "{text}");
        }
    }
}

#[test]
fn letters_of_any_script_are_names() {
    let text = "jbt 1 param größe = 2 attribute 光 1
        let колесо = point { radius größe }
        def ρόδα(ακτίνα) { point { radius ακτίνα } }
        चक्र: union { עיגול: use колесо 光 0.5 { ρόδα(3) } ñandú: point { radius 1 } }";
    let model = read(text);
    assert_eq!(names(&model), ["चक्र", "עיגול", "колесо", "ñandú"]);
    assert_eq!(names(&assert_reads_back(&model)), names(&model));
    let tree = model.check().unwrap();
    assert_eq!(tree.find("चक्र/ñandú").unwrap().len(), 1);
    assert_eq!(tree.with_parameters(&[("größe", 4.0)]).unwrap().support().high()[0], 4.0);
    // The same letter as one character and as two, in whatever asks for it.
    let (one, two) = ("caf\u{e9}", "cafe\u{301}");
    assert_ne!(one, two);
    let text = format!("jbt 1 let {one} = point {{ radius 1 }} let {two} = point {{ radius 2 }} use {one}");
    let error = parse(text.as_bytes(), &Options::default()).unwrap_err().to_string();
    assert!(error.contains("a second `let caf\u{e9}`") && error.matches("error:").count() == 1, "{error}");
    let model = read(&format!("jbt 1 param {two} = 1 {two}: point {{ radius {one} }}"));
    assert_eq!(names(&model), [one]);
    let tree = model.check().unwrap();
    assert!(tree.with_parameters(&[(two, 3.0)]).is_ok());
    assert_eq!(tree.find(two).unwrap()[0].path, one);
    assert_eq!(point([0; 3], 1).named(two).node().name(), Some(one));
    // What is no letter is none: blanks of any kind, marks of direction, digits in front.
    for name in ["a\u{202e}b", "a\u{200b}b", "a\u{a0}b", "٣", "€", "a\u{2028}b", "\u{301}a"] {
        let text = format!("jbt 1 let {name} = point {{ radius 1 }} point {{ radius 1 }}");
        assert!(parse(text.as_bytes(), &Options::default()).is_err(), "{name:?}");
    }
}

#[test]
fn paths_lead_to_places() {
    let tree = read(ROBOT).check().unwrap();
    let paths = |path: &str| {
        let found = tree.find(path).unwrap_or_else(|error| panic!("{error}"));
        found.into_iter().map(|found| found.path).collect::<Vec<_>>()
    };
    assert_eq!(paths("leg"), ["robot/body/leg"]);
    assert_eq!(paths("arm"), ["robot/body/arm.0", "robot/body/arm.1"]);
    assert_eq!(paths("hand"), ["robot/body/arm.0/hand", "robot/body/arm.1/hand"]);
    assert_eq!(paths("arm.1/hand/finger"), ["robot/body/arm.1/hand/finger"]);
    assert_eq!(paths("robot"), ["robot"]);
    // Each path that is told leads to that place alone.
    for name in ["robot", "body", "arm", "hand", "finger", "leg", "cut"] {
        for found in tree.find(name).unwrap() {
            assert_eq!(tree.find(&found.path).unwrap(), [found]);
        }
    }
    let error = |path: &str| tree.find(path).unwrap_err().to_string();
    assert!(
        error("lag").contains("nothing in the model is called `lag`\n  perhaps `leg`"),
        "{}",
        error("lag")
    );
    assert!(error("arm.2").contains("there are arm, body, cut"), "{}", error("arm.2"));
    assert!(error("body/cut").contains("nothing in the model is called"));
    for path in ["", "/", "a//b", "a.", "a.x", "a.-1", "1", "a b", "a.99999999999999999999"] {
        assert!(error(path).contains("is no path"), "{path}: {}", error(path));
    }
}

#[test]
fn owners_are_told_in_words() {
    let tree = read(ROBOT).check().unwrap();
    let part = |p: [f64; 3]| owner(&tree, p).and_then(|owner| owner.part(&tree));
    assert_eq!(part([5.1, 0.0, 0.0]).as_deref(), Some("robot/body/arm.0/hand"));
    assert_eq!(part([-3.9, 0.0, 0.1]).as_deref(), Some("robot/body/arm.1/hand/finger"));
    assert_eq!(part([0.0, 0.0, -4.0]).as_deref(), Some("robot/body/leg"));
    assert_eq!(part([0.0, 0.0, 0.4]).as_deref(), Some("robot/cut"));
    assert_eq!(part([0.1, 0.0, 0.0]).as_deref(), Some("robot/body"));
    assert_eq!(part([50.0, 0.0, 0.0]), None);
    let found = owner(&tree, [0.0, 0.0, -4.0]).unwrap();
    assert_eq!(found.path(&tree), "robot/body/leg");
    let plain = read("jbt 1 union { point { radius 1 } }").check().unwrap();
    assert_eq!(owner(&plain, [0.0; 3]).unwrap().part(&plain), None);
}

/// The fields of two models are the same at some points.
#[track_caller]
fn same_field(a: &Model, b: &str) {
    let (a, b) = (a.check().unwrap(), read(b).check().unwrap());
    for step in 0..400 {
        let t = f64::from(step);
        let p = [(t * 0.37).sin() * 7.0, (t * 0.71).cos() * 3.0, (t * 1.13).sin() * 6.0];
        assert_eq!(walk(&a, p).field.to_bits(), walk(&b, p).field.to_bits(), "{p:?}");
    }
}

#[test]
fn parts_alone_and_the_rest_without_them() {
    let robot = read(ROBOT);
    let hand = "union { point { radius 1 } translate (1 0 0) { point { radius 0.5 } } }";
    same_field(&robot.only("leg").unwrap(), "jbt 1 segment { from (0 0 -2) to (0 0 -5) radius 1 }");
    same_field(&robot.only("arm.1/hand").unwrap(), &format!("jbt 1 translate (-5 0 0) {{ {hand} }}"));
    same_field(
        &robot.only("finger").unwrap(),
        "jbt 1 union { translate (6 0 0) { point { radius 0.5 } } translate (-4 0 0) { point { radius 0.5 } } }",
    );
    same_field(&robot.only("cut").unwrap(), "jbt 1 point { at (0 0 1) radius 1 }");
    same_field(&robot.only("robot").unwrap(), ROBOT);
    same_field(
        &robot.without("arm").unwrap(),
        "jbt 1 difference {
            union { point { radius 2 } segment { from (0 0 -2) to (0 0 -5) radius 1 } } point { at (0 0 1) radius 1 } }",
    );
    same_field(
        &robot.without("cut").unwrap().without("arm.0").unwrap().without("finger").unwrap(),
        "jbt 1 union { point { radius 2 } translate (-5 0 0) { point { radius 1 } } segment { from (0 0 -2) to (0 0 -5) radius 1 } }",
    );
    let nothing = |path: &str| robot.without(path).unwrap_err().to_string();
    assert!(nothing("body").contains("nothing is left of the model without `body`"), "{}", nothing("body"));
    assert!(nothing("robot").contains("nothing is left"));
    assert!(nothing("nose").contains("nothing in the model is called `nose`"));
    assert!(robot.only("nose").is_err());
    // What was shared is shared still.
    assert_eq!(robot.only("hand").unwrap().root.count(), robot.only("arm").unwrap().root.count());
}

#[test]
fn parts_of_selectors_formulas_and_warps() {
    let text = |which: usize| {
        format!(
            "jbt 1 param w = {which} let a = point {{ radius 1 }} let b = point {{ at (2 0 0) radius 1 }}
             union {{ select w {{ use a use b }}
               warped: twist axis z rate 1 weighted {{ inner: point {{ at (0 3 0) radius 1 }} weight: point {{ at (0 3 0) radius 2 }} }}
               made: expression {{ field(a) + 2 * field(b) }} }}"
        )
    };
    let model = read(&text(1));
    let tree = model.without("made").unwrap().without("warped").unwrap();
    same_field(&tree.without("a").unwrap(), "jbt 1 point { at (2 0 0) radius 1 }");
    assert!(tree.without("b").is_err(), "the selector has nothing to choose");
    same_field(&tree.only("a").unwrap(), "jbt 1 point { radius 1 }");
    same_field(&model.only("weight").unwrap(), "jbt 1 point { at (0 3 0) radius 2 }");
    same_field(
        &model.only("inner").unwrap(),
        "jbt 1 twist axis z rate 1 weighted { point { at (0 3 0) radius 1 } point { at (0 3 0) radius 2 } }",
    );
    same_field(
        &model.only("made").unwrap(),
        "jbt 1 let a = point { radius 1 } let b = point { at (2 0 0) radius 1 } expression { field(a) + 2 * field(b) }",
    );
    same_field(
        &model.without("a").unwrap().without("warped").unwrap(),
        "jbt 1 point { at (2 0 0) radius 1 }",
    );
}

#[test]
fn many_places_are_a_limit() {
    let lets: String =
        (1..60).map(|n| format!("let a{n} = union {{ use a{} use a{} }}\n", n - 1, n - 1)).collect();
    let model = read(&format!("jbt 1 let a0 = point {{ radius 1 }} {lets} use a59"));
    assert!(model.only("a0").unwrap_err().to_string().contains("is looked for in more than"));
    assert_eq!(model.only("a59").unwrap().root.count(), 60);
}

#[test]
fn errors_of_built_trees_say_where() {
    let arm = (point([0; 3], 1) + point([1, 0, 0], -2).named("hand")).named("arm");
    let tree = point([0; 3], 3) | arm.translate([1, 0, 0]) | point([0; 3], 1).twist(Axis::X, f64::NAN);
    let error = Model::new(tree).check().unwrap_err().to_string();
    assert!(
        error.contains("error: the radius is -2\n  expected a number of at least 1e-15\n  at arm/hand"),
        "{error}"
    );
    assert!(error.contains("\n  at 0.union/1.twist"), "{error}");
    let error = Model::new(point([0; 3], 1).named("my hand")).check().unwrap_err().to_string();
    assert!(error.contains("a node is called `my hand`"), "{error}");
}

#[test]
fn comments_in_front_of_statements_stay() {
    let text = "# What this shows.\n# In two lines.\n\n// And a third.\njbt 1 # not this one\n\n# How thick.\nparam r = 0.5\n# When inside.\niso 0.4\n\n# Far away.\norigin (0 0 0)\n# Rough.\nattribute rough 1 default 0 blend\n\n# An arm,\n#   indented.\nlet arm = segment { from (0 0 0) to (1 0 0) radius r }\n\n# All of it.\nunion {\n    # Comments in blocks are not kept.\n    use arm\n    point { radius 1 }\n}\n# The end.\n";
    let model = read(text);
    let printed = print(&model);
    assert_eq!(
        printed,
        "# What this shows.\n# In two lines.\n\n# And a third.\njbt 1\n# How thick.\nparam r = 0.5\n# When inside.\niso 0.4\n# Far away.\norigin (0 0 0)\n# Rough.\nattribute rough 1 default 0 blend\n\n# An arm,\n#   indented.\nlet arm = segment { from (0 0 0) to (1 0 0) radius r }\n\n# All of it.\nunion {\n    use arm\n    point { radius 1 }\n}\n# The end.\n"
    );
    let again = assert_reads_back(&model);
    assert_eq!(print(&again), printed);
    assert_eq!(again.comments, model.comments);
    // Line ends of any system, and what a terminal would obey.
    let other = read(&text.replace('\n', "\r\n"));
    assert_eq!(print(&other), printed);
    let hostile = print(&read("# \u{1b}[2J \u{202e}x\njbt 1 point { radius 1 }"));
    assert!(hostile.starts_with("# \\u{1b}[2J \\u{202e}x\njbt 1"), "{hostile}");
    let mut built = Model::new(point([0; 3], 1));
    built.comments.insert("root".to_owned(), "}\nunion {".into());
    assert_eq!(assert_reads_back(&built), built);
}

#[test]
fn comments_stay_at_their_places() {
    let text = "# Before.\njbt 1\n# About all of it.\niso 0.4\nparam r = 1\n# Up.\norientation up y\n\n\
                # A helper.\ndef f() { point { radius r } }\n# A value.\nlet n = 2\n# Unused.\n\
                let spare = point { radius 2 }\n# A part.\npart \"hub\" { f() }\n\n# The end.\n\n# Really.";
    let model = read(text);
    let printed = print(&model);
    assert_eq!(
        printed,
        "# Before.\njbt 1\n# About all of it.\nparam r = 1\niso 0.4\n# Up.\n\
         orientation up y handed right\n\n# A part.\npart \"hub\" {\n    point { radius r }\n}\n\
         # The end.\n\n# Really.\n"
    );
    let again = assert_reads_back(&model);
    assert_eq!(print(&again), printed);
    // In front of what is no head of a text, a comment is about that.
    let plain = "jbt 1\niso 0.5\n\n# A ball.\npoint { radius 1 }\n";
    assert_eq!(print(&read(&plain.replace("iso 0.5\n\n", ""))), plain);
}

#[test]
fn marks_inside_of_words_are_parts_of_names() {
    // The Tibetan tsheg, Hebrew gershayim.
    for name in ["བོད་ཡིག", "צה״ל"] {
        let model = read(&format!("jbt 1 {name}: point {{ radius 1 }}"));
        assert_eq!(names(&assert_reads_back(&model)), [name]);
        assert_eq!(model.check().unwrap().find(name).unwrap().len(), 1);
    }
    for name in ["d\u{2019}or", "a\u{2010}b", "\u{f0b}a"] {
        assert!(model(&format!("jbt 1 {name}: point {{ radius 1 }}")).is_err(), "{name}");
    }
}

#[test]
fn names_of_groups_are_normalized_wherever_they_stand() {
    let (one, two) = ("gr\u{f6}\u{df}e", "gro\u{308}\u{df}e");
    let group = jbt_model::attribute::AttributeGroup::direction(two, [0.0; 3]);
    let ball = point([0; 3], jbt_model::number::param(two, 1.0)).attribute(two, &[1, 2, 3]).constant(two, 7);
    let attributes = vec![jbt_model::attribute::AttributeGroup::color(), group];
    let model = Model { attributes, ..Model::new(ball) };
    let tree = model.check().unwrap();
    assert_eq!(&*tree.attributes()[1].name, one);
    assert_eq!(tree.parameters()[0].name(), one);
    assert_eq!(tree.of_attributes(&[two]).unwrap().attributes().len(), 1);
    assert_eq!(&*tree.with_coverage(two).unwrap().attributes()[2].name, format!("{one}.defined"));
    let found = owner(&tree, [0.1; 3]).unwrap();
    assert_eq!(found.constants(&tree)[one], &7.into());
    assert_eq!(assert_reads_back(&model), model);
}
