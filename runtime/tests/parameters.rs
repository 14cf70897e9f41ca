//! Parameters at run time: setting one writes numbers and compiles nothing, whatever the value, and gives
//! what the model with that number written in gives.

mod common;

use common::answers;
use jbt::build::{Axis, Number, param, point};
use jbt::{CheckedTree, Compiler, Engine, Evaluator, Model, Points, Query, Samples, Update};
use jbt_model::walk::walk;
use jbt_testkit::scene::assert_reads_back;
use jbt_text::{Options, parse};

/// Models with the parameter `p`, each in another place that numbers can have.
const SWEPT: [(&str, f64, f64, &str); 27] = [
    ("radius", 0.1, 3.0, "point { at (0.1 0 0) radius p }"),
    ("place", -2.0, 2.0, "sum { point { at (p 0 p * p) radius 1 } point { radius 1 } }"),
    ("strength", -2.0, 2.0, "sum { point { radius 1 strength p } point { at (0.4 0 0) radius 1 } }"),
    (
        "strength of one of many",
        -2.0,
        2.0,
        "union { point { radius 1 strength p } sum { point { at (0.4 0 0) radius 1 } point { at (0 0.2 0) radius 1 strength p } } }",
    ),
    ("surface radius", 0.1, 2.0, "point { surface_radius p / 2 strength 1 + p }"),
    ("skeleton's size", 0.0, 2.0, "box { half (p 0.3 p / 2) radius 0.7 }"),
    (
        "direction",
        -2.0,
        2.0,
        "sum { disc { normal (p 0 1) disc_radius 0.5 radius 0.8 } ring { normal (0 p 0.1) ring_radius 0.4 radius 0.5 } }",
    ),
    (
        "end",
        -2.0,
        2.0,
        "union { segment { from (0 0 -1) to (p 0 1) radius 0.8 } cylinder { from (p p -1) to (p 0 1) cylinder_radius 0.2 radius 0.6 } }",
    ),
    ("corner", -2.0, 2.0, "triangle { a (p 0 0) b (0 1 p) c (0 0 1) radius 0.8 }"),
    (
        "exponent",
        1.0,
        9.0,
        "blend ricci p { color (1 0 0) { point { radius 1 } } point { at (0.5 0 0) radius 1 } box { half (0.2 0.2 0.2) radius 0.9 } }",
    ),
    (
        "nested exponents",
        1.0,
        9.0,
        "blend ricci p { blend ricci 4 { point { radius 1 } point { at (0.5 0 0) radius 1 } } blend ricci 10 - p { point { at (0 0.5 0) radius 1 } } }",
    ),
    (
        "an exponent inside a plain one",
        1.0,
        9.0,
        "blend ricci 4 { blend ricci p { point { radius 1 } point { at (0.5 0 0) radius 1 } } point { at (0 0.5 0) radius 1 } }",
    ),
    (
        "shift",
        -2.0,
        2.0,
        "translate (p 0 0) { twist axis z rate 1 { translate (0 p 0) { box { half (0.3 0.2 0.1) radius 0.7 } } } }",
    ),
    (
        "rotation",
        -360.0,
        360.0,
        "rotate axis z degrees p { union { box { half (0.3 0.2 0.1) radius 0.7 } translate (0.5 0 0) { point { radius 0.6 } } } }",
    ),
    (
        "rotation in radians",
        -7.0,
        7.0,
        "twist axis x rate 0.5 { rotate axis (1 p 0.5) radians p { segment { from (0 0 0) to (0 0 1) radius 0.7 } } }",
    ),
    (
        "scale",
        0.1,
        3.0,
        "scale p { twist axis y rate 0.4 { scale 1 / p { sum { box { half (0.3 0.2 0.1) radius 0.7 } triangle { a (0 0 0) b (1 0 0) c (0 1 0) radius 0.5 } } } } }",
    ),
    (
        "mirror",
        -1.5,
        1.5,
        "scale p / abs(p) { sum { triangle { a (0 0 0) b (1 0 0) c (0 1 0) radius 0.5 } ring { normal (1 0 0) ring_radius 0.4 radius 0.5 } } }",
    ),
    (
        "scales along axes",
        0.1,
        3.0,
        "scale (p 1 1) { sum { point { radius 0.7 } disc { disc_radius 0.3 radius 0.5 } } }",
    ),
    (
        "rotation between scales",
        -180.0,
        180.0,
        "scale (2 1 1) { rotate axis z degrees p { scale (0.5 1 1) { point { radius 0.9 } } } }",
    ),
    (
        "matrix",
        0.25,
        2.0,
        "affine (p 0 0 0  0 1 p - 1 0  0 0 1 p - 1) { twist axis z rate p - 1 { point { at (0.3 0 0) radius 0.9 } } }",
    ),
    (
        "attribute",
        -2.0,
        2.0,
        "sum { color (p 0.5 p * p) { point { radius 1 } } color (0 1 0) { point { at (0.5 0 0) radius 1 } } }",
    ),
    (
        "texture",
        0.1,
        8.0,
        "color noise { a (p 0 0) b (0 p 1) size p octaves p seed p } { sum { point { radius 1 } color rings { a (1 1 1) b (0 0 0) along (p 1 0) width p } { point { at (0.5 0 0) radius 1 } } } }",
    ),
    (
        "place of a texture",
        -2.0,
        2.0,
        "rotate axis (0 1 1) degrees 90 * p { color gradient { a (0 0 0) b (1 1 1) from (0 0 0) to (p 1 p) } { sum { point { radius 1 } translate (p 0 0) { box { half (0.2 0.1 0.3) radius 1 } } } } }",
    ),
    (
        "formula of an attribute",
        -2.0,
        2.0,
        "rotate axis z degrees 90 * p { color expression { t = p * x + y, (sin(t), t * p, p) } { sum { point { radius 1 } translate (p 0 0) { box { half (0.2 0.1 0.3) radius 1 } } } } }",
    ),
    (
        "uv",
        -2.0,
        2.0,
        "attribute uv 2 uv scale (p 1) rotate 45 * p shift (0 p) { sum { segment { from (0 0 -1) to (p 0 1) radius 0.8 } rotate axis (1 0 1) degrees 90 * p { ring { ring_radius 0.4 radius 0.5 } } } }",
    ),
    (
        "two places that meet",
        -2.0,
        2.0,
        "let a = union { box { half (0.2 0.3 0.4) radius 0.6 } point { at (0.3 0 0) radius 0.5 } } blend ricci 2 { translate (p 0 0) { use a } translate (1 0 0) { use a } translate (2 * p 0 0) { use a } use a }",
    ),
    (
        "iso",
        0.1,
        0.9,
        "iso p difference { point { surface_radius 0.7 strength 1.1 } point { at (0.5 0 0) surface_radius 0.5 } }",
    ),
];

fn text(body: &str, head: &str) -> String {
    // The iso-value stands before the nodes, and a subtree before its uses.
    format!("jbt 1 {head} {body}")
}

fn tree(text: &str, set: Option<f64>) -> CheckedTree {
    let parameters = set.map(|value| ("p".to_owned(), value)).into_iter().collect();
    let model =
        parse(text.as_bytes(), &Options { parameters, ..Options::default() }).and_then(|model| model.check());
    model.unwrap_or_else(|errors| panic!("{text}\n{errors:?}"))
}

fn points() -> Points {
    let mut rng = fastrand::Rng::with_seed(7);
    let mut at = || std::array::from_fn(|_| rng.f32() * 3.0 - 1.5);
    std::iter::once([0.0; 3]).chain((0..24).map(|_| at())).collect()
}

fn same_bits(a: &Samples, b: &Samples) -> bool {
    a.planes().iter().zip(b.planes()).all(|(a, b)| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits()))
}

/// The values of a sweep: a thousand, and whatever whole numbers, halves, zero and one are among them.
fn sweep(low: f64, high: f64) -> impl Iterator<Item = f64> {
    let even = (0..1000).map(move |i| low + (high - low) * f64::from(i) / 999.0);
    let whole = (-14..=720).map(|i| f64::from(i) * 0.5).filter(move |x| (low..=high).contains(x));
    even.chain(whole)
}

#[test]
fn a_sweep_writes_numbers_and_agrees_with_the_model_with_the_number_written_in() {
    let points = points();
    for (what, low, high, body) in SWEPT {
        let parametrised = text(body, &format!("param p = {}", 0.3 * low + 0.7 * high));
        let start = tree(&parametrised, None);
        let mut evaluator = Compiler::for_engine(Engine::Lanes).evaluator(&start, Query::ALL).unwrap();
        let mut literal = Compiler::for_engine(Engine::Lanes).evaluator(&start, Query::ALL).unwrap();
        for (index, value) in sweep(low, high).enumerate() {
            if what == "mirror" && value == 0.0 {
                continue;
            }
            let set =
                start.with_parameters(&[("p", value)]).unwrap_or_else(|e| panic!("{what} {value}: {e:?}"));
            assert_eq!(evaluator.update(&set).unwrap(), Update::Numbers, "{what} at {value}");
            if index % 9 != 0 && index < 1000 {
                continue;
            }
            let found = answers(&evaluator, &points);
            // The value from outside gives the same model; the number instead of the name one that may have
            // another shape.
            assert_eq!(tree(&parametrised, Some(value)).nodes(), set.nodes(), "{what} at {value}");
            let plain = tree(&substituted(body, value), None);
            assert!(!plain.depends_on_parameters());
            literal.update(&plain).unwrap();
            if literal.program().function() == evaluator.program().function() {
                assert!(same_bits(&found, &answers(&literal, &points)), "{what} at {value}");
            }
            for index in 0..points.len() {
                let expected = walk(&set, points.get(index).map(f64::from)).field;
                let error = (f64::from(found.field()[index]) - expected).abs();
                assert!(error < 1e-5, "{what} at {value}, {:?}: off by {error:e}", points.get(index));
                let written = walk(&plain, points.get(index).map(f64::from)).field;
                assert!((written - expected).abs() < 1e-12, "{what} at {value}");
            }
        }
    }
}

/// The text with a number in place of the parameter.
fn substituted(body: &str, value: f64) -> String {
    let mut out = String::new();
    let mut rest = body;
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    while let Some(at) = rest.find('p') {
        let before = rest[..at].chars().last().is_some_and(is_word);
        let after = rest[at + 1..].chars().next().is_some_and(is_word);
        out.push_str(&rest[..at]);
        if before || after {
            out.push('p');
        } else {
            out.push_str(&format!("({value:?})"));
        }
        rest = &rest[at + 1..];
    }
    out.push_str(rest);
    text(&out, "")
}

#[test]
fn all_engines_take_new_values() {
    let points = points();
    let start = tree(&text(SWEPT[9].3, "param p = 2"), None);
    let mut engines =
        Engine::ALL.map(|engine| Compiler::for_engine(engine).evaluator(&start, Query::ALL).unwrap());
    for value in [1.0, 3.0, 3.5, 1024.0] {
        let set = start.with_parameters(&[("p", value)]).unwrap();
        let all = engines.each_mut().map(|evaluator| {
            assert_eq!(evaluator.update(&set).unwrap(), Update::Numbers);
            answers(evaluator, &points)
        });
        assert!(same_bits(&all[0], &all[1]) && same_bits(&all[0], &all[2]));
    }
}

#[test]
fn parameters_of_rust() {
    let bulge = param("bulge", 0.6);
    let turn: Number = 90.0 * &bulge;
    let body = (point([0.0; 3], &bulge * 2.0) - point((&bulge, 0.0, 0.0), 0.5))
        .rotate([0.0, 0.0, 1.0], turn)
        .twist(Axis::Z, &bulge - 0.1)
        .color((1.0, bulge.min(1.0), 0.0))
        .strength(bulge.sqrt());
    let model = Model::new(body);
    assert_eq!(model.parameters.len(), 1);
    assert_reads_back(&model);
    let start = model.check().unwrap();
    let mut evaluator = Evaluator::compile(&start, Query::ALL).unwrap();
    for value in [0.3, 1.0, 2.0] {
        let set = start.with_parameters(&[("bulge", value)]).unwrap();
        assert_eq!(evaluator.update(&set).unwrap(), Update::Numbers);
        let found = answers(&evaluator, &points());
        for (index, field) in found.field().iter().enumerate() {
            let expected = walk(&set, points().get(index).map(f64::from)).field;
            assert!((f64::from(*field) - expected).abs() < 1e-5, "{field} {expected}");
        }
    }
}
