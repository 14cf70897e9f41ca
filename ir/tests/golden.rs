//! Runs the golden files in `tests/golden`: one folder for each stage, text in, text out.

use std::fmt::Write as _;
use std::fs;

use jbt_ir::domain::scalar::Scalar;
use jbt_ir::pass::{GRADIENT, GUARDED_GRADIENT, INTERVAL, PIPELINE};
use jbt_ir::text::annotated;
use jbt_ir::{Any, Function, Op, Type, apply, parse, verify};
use jbt_testkit::golden::{check_golden, differ, files, folder};

/// Parses the input of a pass and checks it: a golden file with a broken input is itself wrong.
fn verified(text: &str) -> Function {
    let function = parse(text).unwrap_or_else(|errors| panic!("{text}\n{}", lines(&errors)));
    verify(function.clone())
        .unwrap_or_else(|errors| panic!("{}", annotated(&function, &errors)))
        .into_function()
}

fn lines<T: ToString>(items: &[T]) -> String {
    items.iter().map(|item| item.to_string() + "\n").collect()
}

/// A pass is a stage from text to text. Its golden files are in `tests/golden/<name>`; both sides obey every
/// rule.
#[test]
fn passes() {
    for pass in [&GRADIENT, &GUARDED_GRADIENT, &INTERVAL].into_iter().chain(PIPELINE) {
        check_golden(pass.name, |input| verified(&(pass.run)(verified(input)).to_string()).to_string());
    }
}

#[test]
fn text() {
    check_golden("text", |input| match parse(input) {
        Ok(function) => function.to_string(),
        Err(errors) => lines(&errors),
    });
}

/// The number of rules at the head of the verifier. The last one, on limits, is tested with functions built
/// by hand: the parser refuses texts beyond them.
const RULES_WITH_A_FILE: usize = 13;

/// Each file is a broken function in the printed form, with the errors on the lines that earn them. Its name
/// begins with the number of the only rule that it breaks.
#[test]
fn verify_rules() {
    let mut failures = String::new();
    let mut tested = [false; RULES_WITH_A_FILE + 1];
    for (path, text) in files("verify", "txt") {
        let function =
            parse(&text).unwrap_or_else(|errors| panic!("{}:\n{}", path.display(), lines(&errors)));
        let errors = verify(function.clone()).err().unwrap_or_default();
        let name = path.file_stem().and_then(|name| name.to_str()).expect("names are ASCII");
        let rule: u32 = name[..2].parse().expect("a name begins with a rule's two digits");
        if errors.is_empty() || errors.iter().any(|error| error.rule != rule) {
            writeln!(failures, "{}: breaks other rules than {rule}:\n{}", path.display(), lines(&errors))
                .expect("a string takes all text");
        }
        tested[rule as usize] = true;
        let comment = &text[..text.find("\nfunction ").expect("a comment stands before it") + 1];
        let found = format!("{comment}{}", annotated(&function, &errors));
        if found != text {
            differ(&path, &text, &found, &mut failures);
        }
    }
    assert!(failures.is_empty(), "{failures}");
    assert!(tested[1..].iter().all(|tested| *tested), "a rule has no golden file: {:?}", &tested[1..]);
}

/// A value in the golden file of an op.
#[derive(Clone, Copy, Debug)]
enum Literal {
    /// A number, compared by its bits; a NaN equals only itself.
    Real(f32),
    /// Some NaN: written `nan` where a result is expected.
    AnyNan,
    Mask(bool),
    Bits(u32),
}

impl Literal {
    /// Reads `1.5`, `-inf`, `nan`, `nan:0x7fc00001`, `true` or `0x0000001f`.
    fn read(text: &str, type_: Type) -> Option<Self> {
        let hex = |text: &str| u32::from_str_radix(text.strip_prefix("0x")?, 16).ok();
        match type_ {
            Type::Mask => text.parse().ok().map(Self::Mask),
            Type::Bits => hex(text).map(Self::Bits),
            Type::Real if text == "nan" => Some(Self::AnyNan),
            Type::Real => match text.strip_prefix("nan:") {
                Some(bits) => hex(bits).map(f32::from_bits).filter(|number| number.is_nan()).map(Self::Real),
                None => text.parse().ok().map(Self::Real),
            },
        }
    }

    /// Where an operand may be any NaN, it is the usual one.
    const fn scalar(self) -> Any<Scalar> {
        match self {
            Self::Real(number) => Any::Real(number),
            Self::AnyNan => Any::Real(f32::from_bits(0x7fc0_0000)),
            Self::Mask(truth) => Any::Mask(truth),
            Self::Bits(bits) => Any::Bits(bits),
        }
    }

    fn is(self, found: Any<Scalar>) -> bool {
        match (self, found) {
            (Self::Real(expected), Any::Real(found)) => expected.to_bits() == found.to_bits(),
            (Self::AnyNan, Any::Real(found)) => found.is_nan(),
            (Self::Mask(expected), Any::Mask(found)) => expected == found,
            (Self::Bits(expected), Any::Bits(found)) => expected == found,
            (Self::Real(_) | Self::AnyNan | Self::Mask(_) | Self::Bits(_), _) => false,
        }
    }
}

/// One line of the golden file of an op: `add 1.0 2.0 = 3.0`.
fn read_case(op: Op, line: &str) -> Option<(Vec<Literal>, Literal)> {
    let (left, right) = line.split_once(" = ")?;
    let mut words = left.split_whitespace();
    if words.next()? != op.name() {
        return None;
    }
    let types = op.operands();
    let words: Vec<&str> = words.collect();
    if words.len() != types.len() {
        return None;
    }
    let args: Option<Vec<Literal>> =
        words.iter().zip(types).map(|(word, &type_)| Literal::read(word, type_)).collect();
    Some((args?, Literal::read(right.trim(), op.result())?))
}

/// Holds ops to `tests/golden/op/<op>.txt`. The expected results are the definition, written by hand: they
/// are never blessed.
fn check_ops(ops: &[Op]) {
    let mut failures = String::new();
    for &op in ops {
        let path = folder("op").join(format!("{}.txt", op.name()));
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut cases = 0;
        for (number, line) in text.lines().enumerate() {
            let line = line.split(';').next().unwrap_or_default().trim();
            if line.is_empty() {
                continue;
            }
            cases += 1;
            let (args, expected) = read_case(op, line)
                .unwrap_or_else(|| panic!("{}:{}: not a case: {line}", path.display(), number + 1));
            let args: Vec<Any<Scalar>> = args.iter().map(|arg| arg.scalar()).collect();
            let found = apply(&mut Scalar, op, &args);
            if !expected.is(found) {
                let found = match found {
                    Any::Real(number) => format!("{number:?} ({:#010x})", number.to_bits()),
                    Any::Mask(truth) => truth.to_string(),
                    Any::Bits(bits) => format!("{bits:#010x}"),
                };
                writeln!(failures, "{}:{}: {line}, but found {found}", path.display(), number + 1)
                    .expect("a string takes all text");
            }
        }
        assert!(cases > 0, "{} has no case", path.display());
    }
    assert!(failures.is_empty(), "\n{failures}");
}

#[test]
fn ops_give_what_their_rows_define() {
    let ops: Vec<Op> = Op::ALL.iter().copied().filter(|op| !op.is_expanded()).collect();
    check_ops(&ops);
}

#[test]
fn transcendental_ops_give_what_their_rows_define() {
    let ops: Vec<Op> = Op::ALL.iter().copied().filter(|op| op.is_expanded()).collect();
    check_ops(&ops);
}

#[test]
fn every_op_file_belongs_to_an_op() {
    for (path, _) in files("op", "txt") {
        let name = path.file_stem().and_then(|name| name.to_str()).expect("names are ASCII");
        assert!(Op::ALL.iter().any(|op| op.name() == name), "{} belongs to no op", path.display());
    }
}
