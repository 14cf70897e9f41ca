//! Every pass, and the whole pipeline, keeps the bits of random functions at spicy inputs; long chains do not
//! overflow a stack.

mod common;

use common::random;
use jbt_ir::domain::scalar::Scalar;
use jbt_ir::interpret::run;
use jbt_ir::pass::{GRADIENT, PIPELINE, Pass, dce, max_live, row_interval, run_pipeline, schedule};
use jbt_ir::translate::rewrite;
use jbt_ir::{Domain, Entity, Function, FunctionBuilder, InstKind, Op, Origin, Part, Tables, Value, verify};
use jbt_testkit::bits::assert_same;

const FUNCTIONS: u64 = 120;

fn outputs(function: &Function, tables: &Tables, points: &[[f32; 3]]) -> Vec<f32> {
    let function = verify(function.clone()).expect("a pass keeps the rules");
    points.iter().flat_map(|point| run(&function, tables, &mut Scalar, point)).collect()
}

fn points(seed: u64) -> Vec<[f32; 3]> {
    let mut random = fastrand::Rng::with_seed(seed);
    (0..6).map(|_| std::array::from_fn(|_| random::number(&mut random))).collect()
}

#[test]
fn each_pass_keeps_the_bits() {
    for pass in PIPELINE {
        for seed in 0..FUNCTIONS {
            let before = random::function(seed, 20 + (seed as usize % 5) * 30);
            let after = (pass.run)(before.clone());
            let (tables, points) = (random::tables(&before, seed), points(seed));
            let what = format!("{} on random function {seed}", pass.name);
            tables.check(&after).expect("the tables keep their layout");
            assert_eq!(before.outputs, after.outputs);
            assert_same(&[outputs(&before, &tables, &points)], &[outputs(&after, &tables, &points)], &what);
        }
    }
}

#[test]
fn the_pipeline_keeps_the_bits() {
    let (mut finite, mut total) = (0, 0);
    for seed in 1000..1000 + FUNCTIONS {
        let before = random::function(seed, 150);
        let (tables, points) = (random::tables(&before, seed), points(seed));
        let expected = outputs(&before, &tables, &points);
        let mut stages = Vec::new();
        let after = run_pipeline(before, PIPELINE, &mut |name, function| {
            stages.push(name.to_owned());
            let what = format!("{name} after the passes before it, on random function {seed}");
            assert_same(&[&expected], &[&outputs(function, &tables, &points)], &what);
        });
        assert_eq!(stages, PIPELINE.iter().map(|pass| pass.name).collect::<Vec<_>>());
        assert_same(&[&expected], &[&outputs(&after, &tables, &points)], "the pipeline");
        finite += expected.iter().filter(|number| number.is_finite()).count();
        total += expected.len();
    }
    assert!(finite * 2 > total, "only {finite} of {total} results are finite: the test says little");
}

#[test]
fn the_pipeline_keeps_the_bits_of_gradients() {
    for seed in 2000..2000 + FUNCTIONS / 2 {
        let before = (GRADIENT.run)(random::function(seed, 60));
        let (tables, points) = (random::tables(&before, seed), points(seed));
        let expected = outputs(&before, &tables, &points);
        let after = run_pipeline(before, PIPELINE, &mut |_, _| {});
        assert_same(&[&expected], &[&outputs(&after, &tables, &points)], &format!("gradient of {seed}"));
    }
}

#[test]
fn a_wrong_pass_would_be_noticed() {
    // Adding 0 looks harmless, but it makes +0 of -0.
    let mut noticed = 0u64;
    for seed in 0..3 * FUNCTIONS {
        let before = random::function(seed, 80);
        let after = rewrite(&before, |b, op, args| {
            if op == Op::Neg {
                let zero = b.constant(0.0);
                b.sub(zero, args[0])
            } else {
                b.op(op, args)
            }
        });
        let (tables, points) = (random::tables(&before, seed), points(seed));
        let (old, new) = (outputs(&before, &tables, &points), outputs(&after, &tables, &points));
        noticed +=
            u64::from(old.iter().zip(&new).any(|(old, new)| old.to_bits() != new.to_bits() && !old.is_nan()));
    }
    assert!(noticed > FUNCTIONS / 10, "noticed in only {noticed} of 3 * {FUNCTIONS} functions");
}

#[test]
fn passes_are_deterministic() {
    for seed in 0..50 {
        let once = run_pipeline(random::function(seed, 150), PIPELINE, &mut |_, _| {});
        let twice = run_pipeline(random::function(seed, 150), PIPELINE, &mut |_, _| {});
        assert_eq!(format!("{once:?}"), format!("{twice:?}"));
    }
}

#[test]
fn nothing_dead_is_left() {
    for seed in 0..FUNCTIONS {
        let function = run_pipeline(random::function(seed, 150), PIPELINE, &mut |_, _| {});
        let mut used = vec![false; function.values.len()];
        let blocks = function.blocks.values().flat_map(|block| &block.results);
        let insts = function.insts.keys().flat_map(|inst| function.operands(inst));
        for &value in blocks.chain(insts) {
            used[value.index()] = true;
        }
        for data in function.insts.values() {
            let any = data.results.iter().any(|&value| used[value.index()]);
            // The final value of a fold's helper accumulator may have no reader.
            assert!(any || matches!(data.kind, InstKind::Fold(_)), "dead: {data:?}");
        }
    }
}

#[test]
fn the_schedule_never_needs_more() {
    let mut better = 0u64;
    for seed in 0..FUNCTIONS {
        let before = dce(random::function(seed, 200));
        let after = schedule(before.clone());
        assert!(max_live(&after) <= max_live(&before), "random function {seed}");
        better += u64::from(max_live(&after) < max_live(&before));
    }
    assert!(better > FUNCTIONS / 10, "only {better} of {FUNCTIONS} got better");
}

/// The peaks of the gradients of random functions, together: what makes a heuristic worse shows here. The
/// number is no truth but what the schedule has reached; one that is better may lower it.
#[test]
fn orders_are_as_good_as_they_were() {
    let (mut before, mut after) = (0, 0);
    for (size, seed) in
        [60, 100, 200].into_iter().flat_map(|size| (0..FUNCTIONS).map(move |seed| (size, seed)))
    {
        let unordered = PIPELINE.iter().filter(|pass| pass.name != "schedule");
        let function = (GRADIENT.run)(random::function(seed, size));
        let function = run_pipeline(function, unordered, &mut |_, _| {});
        before += max_live(&function);
        after += max_live(&schedule(function));
    }
    assert!(after <= 6195, "{after} values at the peaks together, {before} as they were written");
}

#[test]
fn a_chain_of_100000_ops_goes_through_every_pass() {
    let mut b = FunctionBuilder::new("chain", &["x", "y", "z"]);
    let (x, y) = (b.input(0), b.input(1));
    let mut value = x;
    for i in 0..100_000u32 {
        value = match i % 3 {
            0 => b.add(value, y),
            1 => b.min(y, value),
            _ => b.sub(value, x),
        };
    }
    let function = b.finish(&[("out".into(), value)]);
    let expected = outputs(&function, &Tables::default(), &[[0.25, -3.0, 0.0]]);
    let function = run_pipeline(function, PIPELINE, &mut |_, function| {
        assert_same(&[&expected], &[&outputs(function, &Tables::default(), &[[0.25, -3.0, 0.0]])], "a chain");
    });
    assert!(max_live(&function) <= 4);
}

#[test]
fn origins_and_names_stay() {
    let mut b = FunctionBuilder::new("named", &["x"]);
    let x = b.input(0);
    b.set_origin(Origin::leaf(7, Part::Distance));
    let distance = b.mul(x, x);
    b.set_origin(Origin::leaf(7, Part::Falloff));
    let falloff = b.exp(distance);
    let outputs: [(String, Value); 2] = [("field".into(), falloff), ("again".into(), falloff)];
    let function = run_pipeline(b.finish(&outputs), PIPELINE, &mut |_, _| {});
    assert_eq!((function.name.as_str(), function.inputs.as_slice()), ("named", ["x".to_owned()].as_slice()));
    assert_eq!(function.outputs, ["field", "again"]);
    let count = |origin| function.insts.values().filter(|data| data.origin == origin).count();
    assert_eq!(count(Origin::leaf(7, Part::Distance)), 1);
    assert!(count(Origin::leaf(7, Part::Falloff)) > 10, "what an op expands to has its origin");
}

#[test]
fn a_distance_stays_one_when_something_else_has_its_value() {
    let mut b = FunctionBuilder::new("distance", &["x"]);
    let x = b.input(0);
    b.set_origin(Origin::leaf(3, Part::Position));
    let square = b.mul(x, x);
    b.set_origin(Origin::leaf(3, Part::Distance));
    let zero = b.constant(-0.0);
    let distance = b.fma(x, x, zero);
    let sum = b.add(square, distance);
    let function = run_pipeline(b.finish(&[("out".into(), sum)]), PIPELINE, &mut |_, _| {});
    let distances = function.insts.values().filter(|data| data.origin == Origin::leaf(3, Part::Distance));
    let ops = distances.filter(|data| matches!(data.kind, InstKind::Op { op: Op::Mul, .. }));
    assert_eq!(ops.count(), 1);
}

#[test]
fn a_pass_list_can_be_extended() {
    let nothing = Pass { name: "nothing", what: "Changes nothing.", run: |function| function };
    let mut stages = Vec::new();
    let passes = [&nothing].into_iter().chain(PIPELINE);
    let _ = run_pipeline(random::function(1, 50), passes, &mut |name, _| stages.push(name.to_owned()));
    assert_eq!((stages[0].as_str(), stages.len()), ("nothing", PIPELINE.len() + 1));
}

#[test]
fn numbers_behind_the_point_stay_numbers() {
    let mut b = FunctionBuilder::new("row", &["x", "y", "z", "a", "b"]);
    let (x, first, second) = (b.input(0), b.input(3), b.input(4));
    let outputs = [("first".to_owned(), b.add(x, first)), ("second".to_owned(), b.add(x, second))];
    let ranges = row_interval(&b.finish(&outputs));
    assert_eq!(ranges.inputs, ["x.low", "x.high", "y.low", "y.high", "z.low", "z.high", "a", "b"]);
    let planes = [1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 10.0, 20.0];
    let ranges = verify(ranges).expect("it keeps the rules");
    assert_eq!(run(&ranges, &Tables::default(), &mut Scalar, &planes), [11.0, 12.0, 21.0, 22.0]);
}
