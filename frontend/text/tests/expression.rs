//! Formulas: what they mean, what is known of them, and what a text of one may be.

use glam::DVec3;

use jbt_model::builder::{param, point, x, y, z};
use jbt_model::expression::Expression;
use jbt_model::kind::NodeKind;
use jbt_model::model::Model;
use jbt_model::tree::Tree;
use jbt_model::walk::walk;
use jbt_testkit::scene::model as read;
use jbt_text::{Options, parse, print};

fn field(text: &str, p: [f64; 3]) -> f64 {
    walk(&read(text).check().unwrap_or_else(|errors| panic!("{text}: {errors:?}")), p).field
}

fn expression(tree: &Tree) -> Expression {
    match tree.node().written().evaluated(0.5).unwrap() {
        NodeKind::Expression(expression) => expression,
        other => panic!("{other:?}"),
    }
}

#[test]
fn values_by_hand() {
    let p = [3.0, 4.0, -0.25];
    for (formula, value) in [
        ("1 - sqrt(x^2 + y^2) / 10", 0.5),
        ("-x^2 + y * -2", -17.0),
        ("x^-1 + 2^-1", 1.0 / 3.0 + 0.5),
        ("length(x, y) + length(z)", 5.25),
        ("min(x, y, z) + max(x, y, z)", 3.75),
        ("clamp(x, 0, 1) + clamp(-x, 0, 1)", 1.0),
        ("mix(x, y, 0.25)", 3.25),
        ("step(3, x) + step(3.5, x)", 1.0),
        ("mod(y, x) + mod(z, 1) + mod(-x, -2)", 1.0 + 0.75 + 1.0),
        ("floor(z) + ceil(z) + round(z - 0.25)", -1.0),
        ("sign(x) + 10 * sign(z) + 100 * sign(x - 3)", -9.0),
        ("atan2(0, z) - 4 * atan(1)", 0.0),
        ("acos(-x) + asin(x)", 1.5 * std::f64::consts::PI),
        ("tan(0 * x) + exp(0 * x) + ln(1 + 0 * x)", 1.0),
        ("square(x) + abs(z)", 9.25),
        ("r = length(x, y), s = r + 1, r * s", 30.0),
        ("soft(x / 6) + wyvill(x) + soft(-x)", 1.5),
        // What has no value: 0.
        ("x / (y - 4) + sqrt(z) + (x - 3)^-2 + mod(x, y - 4)", 0.0),
        ("z^0.5", 0.0),
    ] {
        let found = field(&format!("jbt 1 expression {{ {formula} }}"), p);
        assert!((found - value).abs() < 1e-12, "{formula}: {found}, not {value}");
    }
}

#[test]
fn numbers_are_not_code() {
    let form = |text: &str| expression(&read(text).root).shared_form();
    let a = form("jbt 1 param p = 1 expression { r = x + 2, sqrt(2 * r) + p * r * r }");
    let b = form("jbt 1 expression { r = x + 3, sqrt(5 * r) + 2 * pi * r * r }");
    assert_eq!(a, b);
    assert_eq!(a.steps(), 6);
    assert_ne!(
        form("jbt 1 expression { x^2 }"),
        form("jbt 1 expression { x^3 }"),
        "a whole exponent is code"
    );
    assert_eq!(form("jbt 1 expression { square(x) }"), form("jbt 1 expression { pow(x, 2) }"));
}

#[test]
fn rust_and_text_make_the_same_form() {
    let r = (x() * x() + y().powf(2.0)).sqrt();
    let ball = point([0.0; 3], 2.0);
    let tree =
        Tree::expression_within(&r - param("p", 0.5) * (8.0 * &r).sin() + ball.field(), [-1.0; 3], [1.0; 3]);
    let text = "jbt 1 param p = 0.5 let ball = point { radius 2 }
        expression within (-1 -1 -1) to (1 1 1) { r = sqrt(x * x + y^2), r - p * sin(8 * r) + field(ball) }";
    let model = read(text);
    assert_eq!(model.root.node().written(), tree.node().written());
    assert_eq!(
        print(&model).lines().last().unwrap(),
        "expression within (-1 -1 -1) to (1 1 1) { t1 = sqrt(x * x + y^2), t1 - p * sin(8 * t1) + field(ball) }"
    );
    assert_eq!(read(&print(&model)), model);
}

#[test]
fn what_is_zero_where_the_children_are() {
    let vanishes = |formula: &str| {
        let text = format!(
            "jbt 1 let a = point {{ radius 1 }} let b = point {{ radius 2 }} expression {{ {formula} }}"
        );
        expression(&read(&text).root).vanishes()
    };
    for formula in [
        "0.7 * field(a) * field(b) - 0.3 * field(a)^2",
        "field(a) * exp(x) / y",
        "max(field(a) - field(b), 0)",
        "min(field(a), 3)",
        "clamp(field(a), -1, 1)",
        "sqrt(field(a)) + sin(field(b))",
        "x - x + field(a) * 0 * y + cos(field(a)) - 1",
    ] {
        let expected = !formula.contains("x - x");
        assert_eq!(vanishes(formula), expected, "{formula}");
    }
    for formula in ["field(a) + 1", "x * y", "1 - field(a)", "cos(field(a))", "max(field(a), x)"] {
        assert!(!vanishes(formula), "{formula}");
    }
}

#[test]
fn supports_are_those_of_children_and_boxes() {
    let support = |text: &str| read(text).check().unwrap().support();
    let text = "jbt 1 let a = point { radius 1 } let b = point { at (1 0 0) radius 1 } expression ";
    assert_eq!(support(&format!("{text} {{ field(a) * field(b) }}")).high(), [2.0, 1.0, 1.0]);
    assert!(!support(&format!("{text} {{ field(a) + 0.1 }}")).is_finite());
    let boxed = format!("{text} within (0 0 0) to (0.5 3 3) {{ field(a) + 0.1 * field(b) }}");
    assert_eq!(support(&boxed).high(), [0.5, 1.0, 1.0]);
    let leaf = "jbt 1 translate (1 0 0) { expression within (-1 -1 -1) to (1 1 1) { x } }";
    assert_eq!((support(leaf).low(), support(leaf).high()), ([0.0, -1.0, -1.0], [2.0, 1.0, 1.0]));
    assert_eq!(field(leaf, [1.5, 0.0, 0.0]), 0.5);
    assert_eq!(field(leaf, [2.5, 0.0, 0.0]), 0.0);
}

#[test]
fn attributes_mix_by_what_children_contribute() {
    // f g with f = 2, g = 1/2 weighs both alike; f^3 g weighs f three times.
    let red = Tree::expression(2.0 + 0.0 * z()).color([1.0, 0.0, 0.0]);
    let blue = Tree::expression(0.5 + 0.0 * z()).color([0.0, 0.0, 1.0]);
    let color = |tree: Tree| walk(&Model::new(tree).check().unwrap(), [0.0; 3]).attributes[0].clone();
    let near = |a: Vec<f64>, b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(near(color(Tree::expression(red.field() * blue.field())), [0.5, 0.0, 0.5]));
    assert!(near(color(Tree::expression(red.field().powf(3.0) * blue.field())), [0.75, 0.0, 0.25]));
    // What takes away has no weight; nobody has any: the default.
    assert!(near(color(Tree::expression(red.field() - blue.field())), [1.0, 0.0, 0.0]));
    assert!(near(color(Tree::expression(-(red.field() + blue.field()))), [1.0; 3]));
    // An only child hands its attributes on, whatever the formula does.
    assert!(near(color(Tree::expression(1.0 - blue.field())), [0.0, 0.0, 1.0]));
    assert!(near(color(Tree::expression(x()).color([0.25, 0.5, 0.75])), [0.25, 0.5, 0.75]));
}

#[test]
fn weights_are_slopes() {
    let ball = point([0.0; 3], 1.0);
    let other = point([1.0; 3], 1.0);
    let tree = Tree::expression(ball.field().square() * 3.0 + other.field() * x());
    let weights = expression(&tree).weights(DVec3::new(2.0, 0.0, 0.0), &[0.5, 0.25]);
    assert!((weights[0] - 1.5).abs() < 1e-9 && (weights[1] - 0.5).abs() < 1e-9, "{weights:?}");
}

#[test]
fn parameters_reach_numbers_without_changing_the_form() {
    let text = "jbt 1 param p = 2 expression { p * x + 3 * p / (1 + y^2) }";
    let tree = read(text).check().unwrap();
    let other = tree.with_parameters(&[("p", 4.0)]).unwrap();
    assert_eq!(walk(&tree, [1.0, 1.0, 0.0]).field, 5.0);
    assert_eq!(walk(&other, [1.0, 1.0, 0.0]).field, 10.0);
    let text = "jbt 1 param p = 2 expression { x / p }";
    let errors = read(text).check().unwrap().with_parameters(&[("p", 0.0)]).unwrap_err();
    assert_eq!(errors[0].message, "division by zero");
}

#[test]
fn numbers_that_make_no_sense_are_errors() {
    let message = |tree: Tree| Model::new(tree).check().unwrap_err()[0].message.clone();
    assert_eq!(message(Tree::expression(x() / 0.0)), "division by zero");
    assert_eq!(message(Tree::expression(x() * f64::NAN)), "a number of the expression is NaN");
    assert_eq!(message(Tree::expression(x() * param("y", 1.0))), "an expression mentions the parameter `y`");
    let inside_out = Tree::expression_within(x(), [0.0; 3], [1.0, -1.0, 1.0]);
    assert!(message(inside_out).starts_with("the box of the expression goes from"));
    let (one, two) = (point([0.0; 3], 1.0), point([0.0; 3], 1.0));
    let both = expression(&Tree::expression(one.field() + two.field()));
    assert_eq!(
        message(Tree::new(NodeKind::Expression(both), vec![one])),
        "the expression has 1 children and 0 numbers"
    );
}

#[test]
fn long_formulas_are_linear_and_deep_ones_do_not_recurse() {
    let sum = (0..50_000).fold(x(), |sum, _| sum + y());
    let tree = Tree::expression(sum);
    assert_eq!(expression(&tree).form().steps(), 50_000);
    assert_eq!(walk(&Model::new(tree.clone()).check().unwrap(), [1.0, 2.0, 0.0]).field, 100_001.0);
    assert_eq!(read(&print(&Model::new(tree.clone()))).root, tree);
    // A chain of squares of itself: 60 steps, and more paths than there are atoms.
    let power = (0..60).fold(x(), |so_far, _| 0.5 * (&so_far + &so_far));
    let tree = Tree::expression(power);
    assert_eq!(walk(&Model::new(tree.clone()).check().unwrap(), [1.5, 0.0, 0.0]).field, 1.5);
    assert_eq!(read(&print(&Model::new(tree.clone()))).root, tree);
    let nested = format!("jbt 1 expression {{ {}x{} }}", "(".repeat(10_000), ")".repeat(10_000));
    assert_eq!(field(&nested, [2.0, 0.0, 0.0]), 2.0);
    let long = format!("jbt 1 expression {{ x{} }}", " + y".repeat(jbt_ir::limits::MAX_EXPRESSION_STEPS));
    assert!(read(&long).check().is_ok());
    let too_long = parse((long.replace("x +", "x + x +")).as_bytes(), &Options::default()).unwrap_err();
    assert_eq!(too_long[0].message, "the expression has 100001 operations; it may have 100000");
}

/// Sixteen operations are a unit of work, and each use of a formula counts.
#[test]
fn the_work_of_a_point_has_a_limit() {
    let most = jbt_ir::limits::MAX_POINT_WORK;
    let scene = |uses: usize| {
        let unit = format!("let unit = expression {{ x{} }}", " + y".repeat(16));
        format!("jbt 1 {unit} union {{ {} }}", "use unit ".repeat(uses))
    };
    assert!(read(&scene(most)).check().is_ok());
    let errors = read(&scene(most + 1)).check().unwrap_err();
    let expected = format!(
        "unfolded, a point of the model would take {} pieces of curves and parts of formulas; it may take {most}",
        most + 1
    );
    assert_eq!(errors[0].message, expected);
}
