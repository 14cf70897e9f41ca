//! Parameters of checked trees: what follows them, what setting them refuses, and how they print.

use jbt_model::builder::{Number, param, point};
use jbt_model::check::{CheckedTree, NodeId};
use jbt_model::diagnostic::Source;
use jbt_model::kind::NodeKind;
use jbt_model::model::Model;
use jbt_testkit::scene::model;
use jbt_text::{Options, number, parse, print};

fn radii(tree: &CheckedTree) -> Vec<f64> {
    let radius = |kind: &NodeKind| match kind {
        NodeKind::Primitive(leaf) => Some(leaf.radius),
        _ => None,
    };
    tree.nodes().iter().filter_map(|node| radius(&node.kind)).collect()
}

#[test]
fn setting_follows_through_parameters_unless_they_are_set() {
    let text = "jbt 1 param a = 1 param b = 2 * a param c = b + a
        sum { point { radius a } point { radius b } point { radius c } point { radius 9 } }";
    let tree = model(text).check().unwrap();
    let set = |settings: &[(&str, f64)]| radii(&tree.with_parameters(settings).unwrap());
    assert_eq!(set(&[]), [1.0, 2.0, 3.0, 9.0]);
    assert_eq!(set(&[("a", 3.0)]), [3.0, 6.0, 9.0, 9.0]);
    assert_eq!(set(&[("b", 5.0)]), [1.0, 5.0, 6.0, 9.0]);
    assert_eq!(set(&[("a", 2.0), ("b", 5.0), ("a", 3.0)]), [3.0, 5.0, 8.0, 9.0], "the last one counts");
    let stays = tree.with_parameters(&[("b", 5.0)]).unwrap().with_parameters(&[("a", 3.0)]).unwrap();
    assert_eq!(radii(&stays), [3.0, 5.0, 8.0, 9.0], "what has been set stays set");
    let shown: Vec<_> = stays.parameters().iter().map(|p| (p.name(), p.default(), p.value())).collect();
    assert_eq!(shown, [("a", 1.0, 3.0), ("b", 6.0, 5.0), ("c", 8.0, 8.0)]);
}

#[test]
fn the_affected_nodes_are_known() {
    let text = "jbt 1 param size = 0.2 param level = size param other = 1 iso level
        let leaf = point { at (other 0 0) radius 1 }
        union { use leaf use leaf point { surface_radius 0.5 } translate (0 size 0) { point { radius 1 } } }";
    let tree = model(text).check().unwrap();
    let kinds = |name: &str| tree.affected_by(name).into_iter().map(|NodeId(id)| id).collect::<Vec<_>>();
    assert_eq!(kinds("size"), [1, 3], "the surface radius through the iso-value, and the shift");
    assert_eq!(kinds("level"), [1]);
    assert_eq!(kinds("other"), [0], "shared, and there once");
    assert_eq!(kinds("none"), []);
    let changed = tree.with_parameters(&[("size", 0.4)]).unwrap();
    assert_eq!(changed.iso(), 0.4);
    let different: Vec<u32> = (0..)
        .zip(tree.nodes().iter().zip(changed.nodes()))
        .filter(|(_, (a, b))| a != b)
        .map(|(id, _)| id)
        .collect();
    assert_eq!(different, [1, 3]);
}

#[test]
fn what_a_setting_breaks_is_shown_where_it_stands() {
    let text = "jbt 1\nparam p = 1\nparam q = sqrt(p)\nattribute uv 2 default (0 1 * q)\nsum {\n    \
                point { radius 2 - p }\n    point { radius 1 / (p - 3) + 2 surface_radius 1 }\n}\n";
    let text = text.replace(" surface_radius 1", "");
    let tree = model(&text).check().unwrap();
    let shown = |settings: &[(&str, f64)]| {
        let errors = tree.with_parameters(settings).unwrap_err();
        let source = Source { name: "a.jbt", text: text.as_bytes() };
        errors.iter().map(|error| source.render(error)).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(
        shown(&[("p", -1.0)]),
        "a.jbt:3:11: error: sqrt(-1) is not a finite number\n  3 | param q = sqrt(p)\n    |           ^^^^^^^"
    );
    assert_eq!(
        shown(&[("q", 1.0), ("p", 3.0)]),
        "a.jbt:6:5: error: the radius is -1\n  6 |     point { radius 2 - p }\n    |     ^^^^^^^^^^^^^^^^^^^^^^ expected a \
         number of at least 1e-15\na.jbt:7:20: error: division by zero\n  7 |     point { radius 1 / (p - 3) + 2 }\n\
         \x20   |                    ^^^^^^^^^^^^^^^"
    );
    assert!(shown(&[("q", 2.0)]).starts_with("a.jbt:4:24: error: `q` stands in a declaration"));
    assert_eq!(
        shown(&[("pp", 1.0), ("p", f64::NAN)]),
        "a.jbt: error: the model has no parameter `pp` to set\n  perhaps `p`; it has p, q\na.jbt: error: the value of `p` \
         is not finite"
    );
}

#[test]
fn parameters_and_expressions_print_as_such() {
    let text = "jbt 1 param p = 0.5 param q = -p ^ 2 * (1 - p) param unused = 3 iso p
        attribute rough 1 attribute scale 1
        let a = point { at (p -q (p + 1) / 2) surface_radius p strength max(1, p, 2 + q) falloff wyvill }
        blend ricci 2 + p {
            use a
            rotate axis (p 0 1) degrees 90 * p { use a }
            rotate axis x radians -p { scale (p + 1) * 2 { scale (1 p 1) { color (p 0 -p) { use a } } } }
            rough (p + 1) * 2 { with scale p { twist axis y rate p { disc { normal (0 p 1) disc_radius p radius 1 } } } }
            affine (1 0 0 p 0 1 0 0 0 0 1 0) { translate (0 0 p) { box { half (p 1 1) radius 1 - -p - (p - 1) } } }
        }";
    let first = model(text);
    let printed = print(&first);
    assert_eq!(model(&printed), first, "{printed}");
    assert_eq!(print(&model(&printed)), printed);
    for part in [
        "param q = -p^2 * (1 - p)",
        "iso p",
        "at (p -q (p + 1) / 2) surface_radius p falloff wyvill strength max(1, p, 2 + q)",
        "rotate axis (1 0 0) radians -p { scale (p + 1) * 2 {",
        "rough (p + 1) * 2 { with scale p {",
        "radius 1 - -p - (p - 1)",
    ] {
        assert!(printed.contains(part), "{part} in {printed}");
    }
    // Another setting is another model, also once it is printed.
    let options = Options { parameters: vec![("p".to_owned(), 0.25)], ..Options::default() };
    let set = parse(text.as_bytes(), &options).unwrap();
    assert_ne!(set, first);
    assert_eq!(model(&print(&set)), set);
    assert_eq!(
        set.check().unwrap().nodes(),
        first.check().unwrap().with_parameters(&[("p", 0.25)]).unwrap().nodes()
    );
}

#[test]
fn a_strange_default_is_refused() {
    let messages =
        |root| Model::new(root).check().unwrap_err().into_iter().map(|e| e.message).collect::<Vec<_>>();
    let ball = |radius: Number| point([0.0; 3], radius);
    assert_eq!(
        messages(ball(param("a", 1.0)) + ball(param("a", 2.0))),
        ["the parameter `a` has two defaults: 1 and 2"]
    );
    for name in ["pi", "sin", "iso", "1st", "", "a b"] {
        assert_eq!(messages(ball(param(name, 1.0))), [format!("a parameter is called `{name}`")]);
    }
    assert_eq!(messages(ball(param("a", f64::NAN))), ["the parameter `a` is NaN"]);
    assert_eq!(messages(ball(1.0 / param("a", 0.0))), ["division by zero"]);
    assert_eq!(
        messages(point([0.0; 3], 1.0).rotate((param("a", 0.0), 0.0, 0.0), 90.0)),
        ["the axis has no direction"]
    );
}

#[test]
fn changing_primitives_keeps_what_it_leaves_alone() {
    let p = param("p", 0.5);
    let ball = point((&p, 0.0, 0.0), &p * 2.0).strength(1.5 + &p);
    let moved = ball.map_primitives(|leaf| leaf.radius = 3.0);
    let tree = Model::new(moved).check().unwrap().with_parameters(&[("p", 1.0)]).unwrap();
    let NodeKind::Primitive(leaf) = &tree.node(tree.root()).kind else { panic!() };
    assert_eq!((leaf.radius, leaf.strength), (3.0, 2.5));
    assert_eq!(tree.support().low(), [-2.0, -3.0, -3.0]);
}

#[test]
fn long_formulas_and_long_chains_of_parameters() {
    // Sums that group to the left and powers that group to the right; neither may recurse or take quadratic
    // time.
    let long = 200_000;
    let sum = "p + ".repeat(long) + "1";
    let nested = "(1 + ".repeat(long) + "p" + &")".repeat(long);
    for formula in [&sum, &nested] {
        let text = format!("jbt 1 param p = 0.001 point {{ radius {formula} }}");
        let first = model(&text);
        let tree = first.check().unwrap().with_parameters(&[("p", 0.002)]).unwrap();
        assert!(radii(&tree)[0] > 1.0);
        assert_eq!(model(&print(&first)), first);
    }
    let chain: String = (1..100_000).map(|i| format!("param p{i} = p{} + 0\n", i - 1)).collect();
    let text = format!("jbt 1 param p0 = 1 {chain} point {{ radius p99999 }}");
    let tree = model(&text).check().unwrap();
    assert_eq!(tree.affected_by("p0"), [tree.root()]);
    assert_eq!(radii(&tree.with_parameters(&[("p0", 2.0)]).unwrap()), [2.0]);
}

#[test]
fn numbers_of_the_command_line() {
    assert_eq!(number("2*pi"), Ok(2.0 * std::f64::consts::PI));
    assert_eq!(number(" -(1 + 2)^2 "), Ok(-9.0));
    for bad in ["", "1 2", "x", "1/0", "(1", "1)", "jbt 1"] {
        assert!(number(bad).is_err(), "{bad}");
    }
}
