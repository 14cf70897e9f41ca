//! Programs of instructions (`.vm`): published samples against an interpreter of their own, every operation
//! by hand, and what strangers send.
//!
//! The samples are those of the folder `vm`, see `jbt_testkit::samples`.

use std::collections::HashMap;

use jbt_model::diagnostic::{Diagnostic, Source};
use jbt_model::walk::walk;
use jbt_testkit::samples;
use jbt_testkit::scene::assert_reads_back;
use jbt_text::import::vm;

/// The value of a program, line by line: from the meaning of the file alone.
fn interpret(text: &str, [x, y, z]: [f64; 3]) -> f64 {
    let mut values: HashMap<&str, f64> = HashMap::new();
    let mut last = f64::NAN;
    for line in text.lines().filter(|line| !line.starts_with('#') && !line.is_empty()) {
        let words: Vec<&str> = line.split(' ').collect();
        let a = || values[words[2]];
        let b = || values[words[3]];
        last = match words[1] {
            "var-x" => x,
            "var-y" => y,
            "var-z" => z,
            "const" => words[2].parse().unwrap(),
            "neg" => -a(),
            "abs" => a().abs(),
            "sqrt" => a().sqrt(),
            "square" => a() * a(),
            "sin" => a().sin(),
            "cos" => a().cos(),
            "exp" => a().exp(),
            "ln" => a().ln(),
            "add" => a() + b(),
            "sub" => a() - b(),
            "mul" => a() * b(),
            "div" => a() / b(),
            "min" => a().min(b()),
            "max" => a().max(b()),
            other => panic!("{other}"),
        };
        values.insert(words[0], last);
    }
    last
}

fn message(bytes: &[u8], diagnostics: &[Diagnostic]) -> String {
    let source = Source { name: "program", text: bytes };
    diagnostics.iter().map(|diagnostic| source.render(diagnostic) + "\n").collect()
}

#[test]
fn samples_have_the_values_of_their_instructions() {
    let Some(folder) = samples::folder("vm") else { return };
    let mut rng = fastrand::Rng::with_seed(11);
    for (name, size) in [("hi", 1.5), ("bear", 12.0), ("colonnade", 1.2), ("prospero", 1.0)] {
        let text = std::fs::read_to_string(folder.join(name).with_extension("vm")).unwrap();
        let model = vm(text.as_bytes())
            .unwrap_or_else(|errors| panic!("{}", message(text.as_bytes(), &errors)))
            .model;
        let tree = model.check().unwrap();
        for _ in 0..40 {
            let p: [f64; 3] = std::array::from_fn(|_| size * (2.0 * rng.f64() - 1.0));
            let (found, truth) = (walk(&tree, p).field, 0.5 - interpret(&text, p));
            // Far outside of the bear the logarithm of a sum of exponentials leaves the range of f32, and
            // stays at its end.
            let far = name == "bear" && truth < -2.0 && found < -2.0;
            let close = (found - truth).abs() <= 1e-9 * truth.abs().max(1.0);
            assert!(far || close, "{name}: {found}, not {truth}, at {p:?}");
        }
        assert_reads_back(&model);
    }
}

/// The field of a program.
fn field(program: &str, p: [f64; 3]) -> f64 {
    let text = program.replace("; ", "\n");
    let model =
        vm(text.as_bytes()).unwrap_or_else(|errors| panic!("{}", message(text.as_bytes(), &errors))).model;
    walk(&model.check().unwrap(), p).field
}

#[test]
fn every_operation_by_hand() {
    let p = [0.5, -2.0, 3.0];
    for (program, value) in [
        ("neg x", -0.5),
        ("abs y", 2.0),
        ("recip y", -0.5),
        ("recip o", 0.0),
        ("sqrt z", 3f64.sqrt()),
        ("square z", 9.0),
        ("floor x", 0.0),
        ("ceil x", 1.0),
        ("round z", 3.0),
        ("sin x", 0.5f64.sin()),
        ("cos x", 0.5f64.cos()),
        ("tan x", 0.5f64.tan()),
        ("asin x", 0.5f64.asin()),
        ("acos x", 0.5f64.acos()),
        ("atan y", (-2f64).atan()),
        ("exp x", 0.5f64.exp()),
        ("ln z", 3f64.ln()),
        ("not x", 0.0),
        ("not o", 1.0),
        ("add x y", -1.5),
        ("sub x y", 2.5),
        ("mul y z", -6.0),
        ("div y z", -2.0 / 3.0),
        ("pow z x", 3f64.sqrt()),
        ("min x y", -2.0),
        ("max x y", 0.5),
        ("mod y z", 1.0),
        ("atan2 y z", (-2f64).atan2(3.0)),
        ("compare x y", 1.0),
        ("compare y x", -1.0),
        ("compare x x", 0.0),
        ("and x y", -2.0),
        ("and o y", 0.0),
        ("or x y", 0.5),
        ("or o y", -2.0),
    ] {
        let lines = format!("x var-x; y var-y; z var-z; c const 0; o mul x c; _r {program}");
        let found = 0.5 - field(&lines, p);
        assert!((found - value).abs() < 1e-12, "{program}: {found}, not {value}");
    }
}

#[test]
fn inside_is_negative() {
    let ball = "_0 var-x; _1 square _0; _2 var-y; _3 square _2; _4 add _1 _3; _5 const 0.25; _6 sub _4 _5";
    assert!(field(ball, [0.4, 0.0, 0.0]) > 0.5);
    assert_eq!(field(ball, [0.5, 0.0, 0.0]), 0.5);
    assert!(field(ball, [0.6, 0.0, 0.0]) < 0.5);
    // Two balls less a third, through a minus sign.
    let cut = format!("{ball}; h const 0.3; a sub _6 h; m neg a; b max _6 m; c min b _0");
    assert_eq!(field(&cut, [0.1, 0.0, 0.0]), 0.5 - 0.1_f64.min((0.01_f64 - 0.25).max(0.54)));
}

#[test]
fn bad_programs_are_located_errors() {
    let text = b"# a comment\n_0 var-x\n_1 sqare _0\n_2 add _0\n_3 add _0 _9\n_0 const 1\n_4 const one\n_5\n_6 var-w\n";
    let shown = message(text, &vm(text).unwrap_err());
    let expected = "\
program:3:4: error: there is no operation `sqare`
  3 | _1 sqare _0
    |    ^^^^^ perhaps `square`
program:4:1: error: `add` has 1 operands
  4 | _2 add _0
    | ^^^^^^^^^ expected 2 operands
program:5:11: error: no line above is called `_9`
  5 | _3 add _0 _9
    |           ^^
program:6:1: error: a second line is called `_0`
  6 | _0 const 1
    | ^^
program:7:10: error: `one` is no finite number
  7 | _4 const one
    |          ^^^ expected a number
program:8:1: error: an operation is missing
  8 | _5
    | ^^ expected a name, an operation and its operands
program:9:4: error: there is no operation `var-w`
  9 | _6 var-w
    |    ^^^^^ perhaps `var-x`
";
    assert_eq!(shown, expected);
    assert!(vm(b"# nothing\n").unwrap_err()[0].message.contains("no instruction"));
    assert!(vm(b"\xff\xfe var-x").is_ok(), "a name is any bytes");
    let zero = vm(b"a var-x\nb const 0\nc div a b").unwrap().model.check().unwrap_err();
    assert_eq!((&*zero[0].message, zero[0].span.map(|span| span.start)), ("division by zero", Some(18)));
}

#[test]
fn a_chain_of_any_length_does_not_recurse() {
    use std::fmt::Write as _;
    let mut text = "_0 var-x\n_1 var-y\n".to_owned();
    for line in 2..50_000 {
        let _ = writeln!(text, "_{line} {} _{} _{}", ["add", "min", "sub"][line % 3], line - 1, line - 2);
    }
    assert!(vm(text.as_bytes()).unwrap().model.check().is_ok());
    // The minimum of all partial sums: split, each would be written out from the first summand on.
    let mut text = "s0 var-x\nm0 var-y\n".to_owned();
    for line in 1..10_000 {
        let _ = writeln!(text, "s{line} add s{0} s0\nm{line} min m{0} s{line}", line - 1);
    }
    let model = vm(text.as_bytes()).unwrap().model;
    assert!(model.root.node().children().is_empty());
    let sample = walk(&model.check().unwrap(), [-2.0, 0.0, 0.0]);
    assert_eq!(sample.field, 0.5 + 20_000.0);
}
