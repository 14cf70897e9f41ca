//! The text form: what is printed reads back as the same function, and nothing that is read panics.

mod common;

use common::sample;
use fastrand::Rng;
use jbt_ir::limits::{MAX_ERRORS, MAX_FOLD_DEPTH, MAX_TABLES, MAX_VALUES};
use jbt_ir::{Function, InstKind, Origin, parse, verify};

/// How many random functions each test takes.
const SAMPLES: u64 = 300;

fn read(text: &str) -> Function {
    parse(text).unwrap_or_else(|errors| panic!("{}\n{text}", errors[0]))
}

#[test]
fn what_is_printed_reads_back() {
    for seed in 0..SAMPLES {
        let function = sample::function(&mut Rng::with_seed(seed));
        let text = function.to_string();
        let again = read(&text);
        assert_eq!(again.to_string(), text, "seed {seed}");
        assert_eq!(sample::canonical(&again), sample::canonical(&function), "seed {seed}");
        verify(again).expect("samples obey every rule");
    }
}

#[test]
fn every_encoding_of_a_constant_reads_back() {
    let mut rng = Rng::with_seed(1);
    for _ in 0..2000 {
        let bits = rng.u32(..);
        let mut function = read("function \"f\" () -> () {\nblock0:\n v0 = const 1.0\n yield\n}");
        let inst = function.blocks[function.body].insts[0];
        function.insts[inst].kind = InstKind::Constant(f32::from_bits(bits));
        let InstKind::Constant(number) = read(&function.to_string()).insts[inst].kind else {
            panic!("a constant stays one");
        };
        assert_eq!(number.to_bits(), bits);
    }
}

#[test]
fn damaged_texts_do_not_panic_and_what_reads_prints_the_same() {
    const SCRAPS: [&str; 16] = [
        "\"",
        "\\",
        "}",
        ")",
        "(",
        ",",
        ":",
        "@",
        "-",
        "nan:",
        "\n",
        "v3",
        "t9",
        "block0:",
        "\u{1f600}",
        "0x",
    ];
    let mut rng = Rng::with_seed(2);
    let mut readable = 0;
    for seed in 0..SAMPLES {
        let text = sample::function(&mut Rng::with_seed(seed)).to_string();
        for _ in 0..10 {
            let mut letters: Vec<char> = text.chars().collect();
            for _ in 0..rng.usize(1..4) {
                let at = rng.usize(0..letters.len());
                let end = letters.len().min(at + rng.usize(0..6));
                let scrap = rng.choice(SCRAPS).expect("there are scraps");
                letters.splice(at..end, scrap.chars().take(rng.usize(0..3)));
            }
            if let Ok(function) = parse(&letters.into_iter().collect::<String>()) {
                readable += 1;
                let printed = function.to_string();
                assert_eq!(read(&printed).to_string(), printed);
            }
        }
    }
    assert!(readable > 20, "too few damaged texts can be read for this to test much: {readable}");
}

#[test]
fn errors_are_located_by_character() {
    let errors = parse("; größe\nfunction \"größe\" (x ->\n").expect_err("a parenthesis is missing");
    assert_eq!((errors[0].line, errors[0].column), (2, 21));
    assert_eq!(errors[0].expected, "`)`");
    assert_eq!(errors[0].found, "`->`");
    assert!(errors[0].to_string().ends_with("\n                        ^"), "{}", errors[0]);
}

#[test]
fn errors_show_little_of_a_long_line_and_no_control_characters() {
    let line = format!("function \"{}\u{1b}[31m\u{202e}\" {}", "a".repeat(100_000), "%".repeat(100_000));
    let errors = parse(&line).expect_err("the names are missing");
    let shown = errors[0].to_string();
    assert!(shown.len() < 500, "{} bytes", shown.len());
    assert!(shown.chars().all(|letter| letter == '\n' || !letter.is_control() && letter != '\u{202e}'));
}

#[test]
fn reading_stops_after_too_many_errors() {
    let errors = parse(&"nonsense\n".repeat(MAX_ERRORS + 10)).expect_err("it is nonsense");
    assert_eq!(errors.len(), MAX_ERRORS);
    assert_eq!(parse("").expect_err("there is no function").len(), 1);
    assert!(parse(&"{".repeat(1 << 20)).is_err());
    assert!(parse(&"\"".repeat(1 << 20)).is_err());
}

/// Folds in each other.
fn nested(depth: usize) -> String {
    let mut text = "function \"f\" (x) -> () {\n".to_owned();
    text.extend((0..depth).map(|table| format!("table t{table} \"t\" ()\n")));
    text.push_str("block0:\n");
    text.extend((0..depth).map(|table| format!("fold t{table} rows neutral () block{}:\n", table + 1)));
    text + &"yield\n".repeat(depth + 1) + "}"
}

#[test]
fn the_depth_of_folds_is_limited() {
    verify(read(&nested(MAX_FOLD_DEPTH))).expect("the limit itself is allowed");
    let errors = parse(&nested(MAX_FOLD_DEPTH + 1)).expect_err("one too many");
    assert_eq!(errors.len(), 1, "one error, and none that follows from it");
    assert_eq!(errors[0].expected, "at most 64 folds in each other");
    assert!(parse(&nested(10_000)).is_err());
}

#[test]
fn numbers_of_values_and_tables_are_limited() {
    let value =
        |number: usize| format!("function \"f\" () -> () {{\nblock0:\nv{number} = const 1.0\nyield\n}}");
    assert_eq!(read(&value(MAX_VALUES - 1)).values.len(), MAX_VALUES);
    assert_eq!(
        parse(&value(MAX_VALUES)).expect_err("one too many")[0].expected,
        format!("at most v{}", MAX_VALUES - 1)
    );
    assert!(parse(&value(usize::MAX)).is_err());

    let tables = |count: usize| {
        let tables: String = (0..count).map(|table| format!("table t{table} \"t\" ()\n")).collect();
        format!("function \"f\" () -> () {{\n{tables}block0:\nyield\n}}")
    };
    assert_eq!(read(&tables(MAX_TABLES)).tables.len(), MAX_TABLES);
    assert_eq!(parse(&tables(MAX_TABLES + 1)).expect_err("one too many")[0].expected, "at most t99999");
}

#[test]
fn numbers_of_slots_are_limited() {
    let slot = |number: u64| {
        let table = format!("table t0 \"t\" (c) slots ({number})");
        format!("function \"f\" () -> () {{\n{table}\nblock0:\nv0 = const 1.0 @{number}.position\nyield\n}}")
    };
    let largest = u64::from(Origin::MAX_SLOT);
    let text = read(&slot(largest)).to_string();
    assert!(text.contains(&format!("@{largest}.position")), "{text}");
    for beyond in [largest + 1, 1 << 32] {
        assert!(parse(&slot(beyond)).is_err(), "{beyond}");
    }
}
