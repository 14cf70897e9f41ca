//! The lanes interpreter gives the bits of the scalar domain: every length, every instruction set, any
//! floating-point environment.

mod common;

use common::random;
use jbt_ir::domain::lanes::{Level, NotLegalized, Scratch, Tape};
use jbt_ir::domain::scalar::Scalar;
use jbt_ir::engine::RunError;
use jbt_ir::interpret;
use jbt_ir::pass::{PIPELINE, legalize, run_pipeline};
use jbt_ir::{
    Domain, FoldKind, Function, FunctionBuilder, Op, Rows, Rule, Schema, Selection, Table, Tables, Value,
    Verified, verify,
};
use jbt_testkit::bits::assert_same;

fn tape(function: &Verified) -> Tape {
    Tape::new(function).expect("the function is legal")
}

fn verified(function: Function) -> Verified {
    verify(function).expect("the function obeys the rules")
}

/// The output planes, each point on its own in the scalar domain.
fn reference(
    function: &Verified,
    (tables, selection): (&Tables, &Selection),
    inputs: &[Vec<f32>],
) -> Vec<Vec<f32>> {
    let mut planes = vec![Vec::new(); function.function().outputs.len()];
    for point in 0..inputs.first().map_or(1, Vec::len) {
        let at: Vec<f32> = inputs.iter().map(|plane| plane[point]).collect();
        let answers = interpret::run_selected(function, tables, selection, &mut Scalar, &at);
        for (plane, answer) in planes.iter_mut().zip(answers) {
            plane.push(answer);
        }
    }
    planes
}

/// The output planes at one level, over planes that are full of rubbish before.
fn lanes(
    level: Level,
    tape: &Tape,
    rows: (&Tables, &Selection),
    inputs: &[Vec<f32>],
    outputs: usize,
    scratch: &mut Scratch,
) -> Vec<Vec<f32>> {
    let points = inputs.first().map_or(1, Vec::len);
    let mut planes = vec![vec![-77.0; points]; outputs];
    let inputs: Vec<&[f32]> = inputs.iter().map(Vec::as_slice).collect();
    let mut views: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
    tape.run_at(level, rows, &inputs, &mut views, scratch).expect("the planes fit");
    planes
}

#[track_caller]
fn check(what: &str, function: &Verified, tables: &Tables, inputs: &[Vec<f32>], scratch: &mut Scratch) {
    let all = Selection::new(function.function(), tables);
    check_selected(what, function, (tables, &all), inputs, scratch);
    // Without every third row.
    let mut masks: Vec<u8> = (0..all.len()).map(|row| u8::from(row % 3 != 1)).collect();
    let mut some = [Selection::default()];
    all.narrow(&mut masks, &mut some);
    check_selected(what, function, (tables, &some[0]), inputs, scratch);
}

#[track_caller]
fn check_selected(
    what: &str,
    function: &Verified,
    rows: (&Tables, &Selection),
    inputs: &[Vec<f32>],
    scratch: &mut Scratch,
) {
    let expected = reference(function, rows, inputs);
    let tape = tape(function);
    for level in Level::available() {
        let given = lanes(level, &tape, rows, inputs, expected.len(), scratch);
        assert_same(&expected, &given, &format!("{what} at {}", level.name()));
    }
}

fn random_points(seed: u64, count: usize) -> Vec<Vec<f32>> {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..3).map(|_| (0..count).map(|_| random::number(&mut random)).collect()).collect()
}

fn table(b: &mut FunctionBuilder, columns: &[&str], parent: Option<Table>) -> Table {
    let columns = columns.iter().map(|&column| column.to_owned()).collect();
    b.table(Schema { name: "row".into(), columns, parent, slots: vec![] })
}

/// Columns, numbers, active rows, starts.
type Numbers<'a> = (usize, &'a [f32], &'a [u32], &'a [u32]);

fn rows(tables: &[Numbers<'_>]) -> Tables {
    let mut result = Tables::default();
    for &(stride, numbers, active, starts) in tables {
        result.tables.push(Rows {
            count: numbers.len().checked_div(stride).unwrap_or(active.len()),
            stride,
            numbers: numbers.to_vec(),
            active: active.to_vec(),
            starts: starts.to_vec(),
            nodes: vec![],
        });
    }
    result
}

fn finish(b: FunctionBuilder, outputs: &[Value]) -> Verified {
    let outputs: Vec<(String, Value)> =
        outputs.iter().enumerate().map(|(index, &value)| (format!("out{index}"), value)).collect();
    verified(b.finish(&outputs))
}

#[test]
fn random_functions_have_the_bits_of_the_scalar_domain() {
    let mut scratch = Scratch::new();
    for seed in 0..300 {
        let size = 20 + (seed as usize % 6) * 40;
        let function = random::function(seed, size);
        let tables = random::tables(&function, seed);
        let function = verified(legalize(&function));
        check(&format!("random function {seed}"), &function, &tables, &random_points(seed, 37), &mut scratch);
    }
}

#[test]
fn random_functions_after_the_pipeline_too() {
    let mut scratch = Scratch::new();
    for seed in 5000..5150 {
        let function = random::function(seed, 200);
        let tables = random::tables(&function, seed);
        let function = verified(run_pipeline(function, PIPELINE, &mut |_, _| {}));
        check(&format!("random function {seed}"), &function, &tables, &random_points(seed, 33), &mut scratch);
    }
}

/// `sum (x - c)^2`, of the rows' c.
fn sum_of_squares() -> Verified {
    let mut b = FunctionBuilder::new("sum", &["x"]);
    let t = table(&mut b, &["c"], None);
    let (x, zero) = (b.input(0), b.constant(0.0));
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
    let c = b.column(t, 0);
    let d = b.sub(x, c);
    let next = b.fma(d, d, acc);
    let sum = b.end_fold(&[next])[0];
    finish(b, &[sum])
}

#[test]
fn all_lengths_around_the_block() {
    let function = sum_of_squares();
    let tables = rows(&[(1, &[1.0, 100.0, 3.0, 5.0], &[0, 2, 3], &[0, 3])]);
    let all = Selection::new(function.function(), &tables);
    let tape = tape(&function);
    let mut scratch = Scratch::new();
    let x: Vec<f32> = (0..2 * tape.block() + 1).map(|i| i as f32 / 4.0).collect();
    // Quarters up to a few hundred: the squares are exact.
    let square = |d: f32| d * d;
    let expected: Vec<f32> = x.iter().map(|x| square(x - 1.0) + square(x - 3.0) + square(x - 5.0)).collect();
    for level in Level::available().into_iter().rev() {
        for length in 0..=x.len() {
            let given = lanes(level, &tape, (&tables, &all), &[x[..length].to_vec()], 1, &mut scratch);
            assert_eq!(given[0], expected[..length], "{length} points at {}", level.name());
        }
    }
}

#[test]
fn a_sum_updates_its_accumulator_in_place() {
    // x, d and the accumulator: nothing is copied at the end of the body.
    assert_eq!(tape(&sum_of_squares()).registers(), 3);
}

#[test]
fn a_sum_of_sums_carries_one_accumulator() {
    let mut b = FunctionBuilder::new("sums", &["x"]);
    let (outer, x) = (table(&mut b, &["a"], None), b.input(0));
    let inner = table(&mut b, &["b"], Some(outer));
    let zero = b.constant(0.0);
    let acc = b.begin_fold(outer, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
    let part = b.begin_fold(inner, (FoldKind::Rows, Rule::Neutral), &[acc])[0];
    let column = b.column(inner, 0);
    let next = b.fma(column, x, part);
    let part = b.end_fold(&[next])[0];
    let sum = b.end_fold(&[part])[0];
    let function = finish(b, &[sum]);
    assert_eq!(tape(&function).registers(), 2);
    // Rows 0 and 1 of the inner table belong to outer row 0, rows 2 to 4 to row 2, which is active, and row 5
    // to row 3, which is not.
    let tables = rows(&[
        (1, &[0.0; 4], &[0, 1, 2], &[0, 3]),
        (1, &[1.0, 10.0, 100.0, 1e3, 1e4, 1e5], &[0, 1, 2, 4, 5], &[0, 2, 2, 4, 5]),
    ]);
    tables.check(function.function()).expect("the rows fit");
    let x = vec![vec![0.0, 1.0, -2.0, 0.5]];
    check("sum of sums", &function, &tables, &x, &mut Scratch::new());
    let all = Selection::new(function.function(), &tables);
    assert_eq!(reference(&function, (&tables, &all), &x)[0], [0.0, 10111.0, -20222.0, 5055.5]);
}

#[test]
fn columns_of_an_outer_row_are_seen_in_the_inner_body() {
    let mut b = FunctionBuilder::new("scaled", &["x"]);
    let (outer, x) = (table(&mut b, &["scale"], None), b.input(0));
    let inner = table(&mut b, &["c"], Some(outer));
    let zero = b.constant(0.0);
    let acc = b.begin_fold(outer, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
    let scale = b.column(outer, 0);
    let part = b.begin_fold(inner, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
    let c = b.column(inner, 0);
    // On numbers of rows alone, and one of them is of the outer row: a splat.
    let product = b.mul(scale, c);
    let next = b.fma(product, x, part);
    let part = b.end_fold(&[next])[0];
    let next = b.add(acc, part);
    let sum = b.end_fold(&[next])[0];
    let function = finish(b, &[sum]);
    let tables =
        rows(&[(1, &[2.0, 3.0], &[0, 1], &[0, 2]), (1, &[1.0, 10.0, 7.0, 100.0], &[0, 1, 3], &[0, 2, 3])]);
    let x = vec![vec![1.0, 4.0]];
    check("scaled", &function, &tables, &x, &mut Scratch::new());
    let all = Selection::new(function.function(), &tables);
    assert_eq!(reference(&function, (&tables, &all), &x)[0], [322.0, 1288.0]);
}

#[test]
fn accumulators_may_swap_and_rotate() {
    let mut b = FunctionBuilder::new("rotate", &["x", "y", "z"]);
    let t = table(&mut b, &["c"], None);
    let (x, y, z) = (b.input(0), b.input(1), b.input(2));
    let (one, two) = (b.constant(1.0), b.constant(2.0));
    // Three blocks and two splats rotate, two count as Fibonacci did, one is overwritten by an outer value.
    let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[x, y, z, one, two, x, y, x]);
    let next = b.add(acc[5], acc[6]);
    let result = b.end_fold(&[acc[1], acc[2], acc[0], acc[4], acc[3], acc[6], next, z]);
    let function = finish(b, &result);
    let numbers = [0.0; 8];
    let all: Vec<u32> = (0..8).collect();
    for count in 0..=8_u32 {
        let tables = rows(&[(1, &numbers, &all[..count as usize], &[0, count])]);
        let inputs = [vec![1.0, 5.0], vec![1.0, 6.0], vec![3.0, 7.0]];
        check(&format!("{count} rounds"), &function, &tables, &inputs, &mut Scratch::new());
    }
    let tables = rows(&[(1, &numbers, &all[..7], &[0, 7])]);
    let selection = Selection::new(function.function(), &tables);
    let given = lanes(
        Level::best(),
        &tape(&function),
        (&tables, &selection),
        &[vec![1.0], vec![1.0], vec![3.0]],
        8,
        &mut Scratch::new(),
    );
    assert_eq!(given.concat(), [1.0, 3.0, 1.0, 2.0, 1.0, 21.0, 34.0, 3.0]);
}

#[test]
fn a_fold_without_rows_gives_its_initial_values() {
    let function = sum_of_squares();
    let tables = rows(&[(1, &[5.0], &[], &[0, 0])]);
    let rows = (&tables, &Selection::new(function.function(), &tables));
    let given = lanes(Level::best(), &tape(&function), rows, &[vec![1.0; 40]], 1, &mut Scratch::new());
    assert_eq!(given, [vec![0.0; 40]]);
}

#[test]
fn outputs_may_be_constants_inputs_and_one_value_twice() {
    let mut b = FunctionBuilder::new("plain", &["x"]);
    let (x, seven) = (b.input(0), b.constant(7.0));
    let bits = b.to_bits(x);
    let again = b.from_bits(bits);
    let held = b.stop_gradient(again);
    let function = finish(b, &[seven, x, x, held]);
    assert_eq!(tape(&function).registers(), 1, "ops that rename cost nothing");
    let x = vec![vec![1.0, -0.0, f32::INFINITY]];
    check("plain", &function, &Tables::default(), &x, &mut Scratch::new());
}

#[test]
fn a_function_without_inputs_fills_its_planes() {
    let mut b = FunctionBuilder::new("constant", &[]);
    let (two, three) = (b.constant(2.0), b.constant(3.0));
    let product = b.mul(two, three);
    let function = finish(b, &[product]);
    let mut plane = [0.0; 5];
    let nothing = (&Tables::default(), &Selection::default());
    tape(&function).run(nothing, &[], &mut [&mut plane], &mut Scratch::new()).unwrap();
    assert_eq!(plane, [6.0; 5]);
}

#[test]
fn many_registers_make_short_blocks() {
    // All 3,000 values are alive at once: each is used twice after the last one, so none is the first of a
    // pair.
    let mut b = FunctionBuilder::new("wide", &["x"]);
    let x = b.input(0);
    let values: Vec<Value> = (0..3000_u16)
        .map(|i| {
            let number = b.constant(f32::from(i));
            b.add(x, number)
        })
        .collect();
    let mut sum = b.constant(0.0);
    for &value in values.iter().rev().chain(&values) {
        sum = b.add(sum, value);
    }
    let function = finish(b, &[sum]);
    let tape = tape(&function);
    assert!(tape.registers() >= 3000);
    assert!(tape.block() < 128);
    let x = vec![(0..150).map(|i| i as f32).collect()];
    check("wide", &function, &Tables::default(), &x, &mut Scratch::new());
}

#[test]
fn a_scratch_serves_tapes_of_all_sizes() {
    let mut scratch = Scratch::new();
    for seed in [3, 9, 3, 20, 4, 9] {
        let function = random::function(seed, 10 * seed as usize);
        let tables = random::tables(&function, seed);
        let function = verified(legalize(&function));
        check("a reused scratch", &function, &tables, &random_points(seed, 70), &mut scratch);
    }
}

#[test]
fn a_long_chain_of_folds_compiles() {
    let mut b = FunctionBuilder::new("chain", &["x"]);
    let (x, mut sum) = (b.input(0), b.constant(0.0));
    let count = 20_000;
    let mut tables = Tables::default();
    for _ in 0..count {
        let t = table(&mut b, &["c"], None);
        let acc = b.begin_fold(t, (FoldKind::Rows, Rule::Neutral), &[sum])[0];
        let c = b.column(t, 0);
        let next = b.fma(c, x, acc);
        sum = b.end_fold(&[next])[0];
        let rows = Rows {
            count: 1,
            stride: 1,
            numbers: vec![0.5],
            active: vec![0],
            starts: vec![0, 1],
            nodes: vec![],
        };
        tables.tables.push(rows);
    }
    let function = finish(b, &[sum]);
    let tape = tape(&function);
    assert_eq!(tape.registers(), 2);
    let all = Selection::new(function.function(), &tables);
    let given = lanes(Level::best(), &tape, (&tables, &all), &[vec![2.0]], 1, &mut Scratch::new());
    assert_eq!(given[0][0], count as f32);
}

#[test]
fn ops_that_have_to_be_expanded_are_named() {
    for op in Op::ALL.iter().copied().filter(|op| op.is_expanded()) {
        let mut b = FunctionBuilder::new("whole", &["x"]);
        let x = b.input(0);
        let value = b.op(op, &vec![x; op.operands().len()]);
        let error: NotLegalized = Tape::new(&finish(b, &[value])).expect_err("it is not legal");
        assert_eq!(error.op, op);
        let text = format!("inst1: {} must be expanded before the function is interpreted", op.name());
        assert_eq!(error.to_string(), text);
    }
}

#[test]
fn planes_that_do_not_fit_are_refused() {
    let function = sum_of_squares();
    let tape = tape(&function);
    let tables = rows(&[(1, &[], &[], &[0, 0])]);
    let (all, mut scratch) = (Selection::new(function.function(), &tables), Scratch::new());
    let tables = (&tables, &all);
    let (x, mut out, mut more) = ([0.0; 4], [0.0; 4], [0.0; 5]);
    let none = tape.run(tables, &[], &mut [&mut out], &mut scratch);
    assert_eq!(none, Err(RunError::Inputs { expected: 1, given: 0 }));
    let two = tape.run(tables, &[&x], &mut [&mut out, &mut more], &mut scratch);
    assert_eq!(two, Err(RunError::Outputs { expected: 1, given: 2 }));
    let longer = tape.run(tables, &[&x], &mut [&mut more], &mut scratch);
    assert_eq!(longer, Err(RunError::Length { plane: 1, expected: 4, given: 5 }));
    assert_eq!(longer.unwrap_err().to_string(), "the first plane has 4 points, plane 1 (inputs first) has 5");
}

#[test]
fn threads_share_a_tape() {
    const fn shared<T: Send + Sync>() {}
    shared::<Tape>();
    shared::<Scratch>();
}

#[test]
fn levels_ascend_from_the_baseline() {
    let levels = Level::available();
    assert_eq!(levels[0], Level::Baseline);
    assert!(levels.is_sorted());
    assert_eq!(levels.last(), Some(&Level::best()));
}

#[cfg(target_arch = "x86_64")]
#[test]
fn the_environment_of_the_caller_changes_nothing_and_is_restored() {
    use std::arch::asm;

    fn read() -> u32 {
        let mut bits: u32 = 0;
        // SAFETY: stmxcsr writes four bytes to where the pointer is.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut bits, options(nostack)) };
        bits
    }

    fn write(bits: u32) {
        // SAFETY: ldmxcsr reads four bytes; no reserved bit is set below.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const bits, options(nostack)) };
    }

    // A product that is subnormal, an operand that is, and a sum that depends on the direction of rounding.
    let mut b = FunctionBuilder::new("small", &["x", "y"]);
    let (x, y) = (b.input(0), b.input(1));
    let (product, sum) = (b.mul(x, y), b.add(x, y));
    let function = finish(b, &[product, sum]);
    let tape = tape(&function);
    let x = [1e-20, 1e-40, 1.0, 3.0];
    let y = [1e-20, 1.0, f32::EPSILON / 3.0, f32::EPSILON * 0.7];
    let expected = [
        [x[0] * y[0], x[1] * y[1], x[2] * y[2], x[3] * y[3]],
        [x[0] + y[0], x[1] + y[1], x[2] + y[2], x[3] + y[3]],
    ];
    assert!(expected[0][0].is_subnormal() && expected[0][1].is_subnormal());
    let flush_and_round_up = 0x1F80 | 1 << 15 | 1 << 6 | 0b10 << 13;
    for level in Level::available() {
        let (mut scratch, mut products, mut sums) = (Scratch::new(), [0.0; 4], [0.0; 4]);
        let before = read();
        write(flush_and_round_up);
        let nothing = (&Tables::default(), &Selection::default());
        let ran = tape.run_at(level, nothing, &[&x, &y], &mut [&mut products, &mut sums], &mut scratch);
        let after = read();
        write(before);
        assert_eq!(ran, Ok(()));
        assert_eq!(after, flush_and_round_up);
        assert_eq!(
            [products, sums].map(|plane| plane.map(f32::to_bits)),
            expected.map(|p| p.map(f32::to_bits))
        );
    }
}
