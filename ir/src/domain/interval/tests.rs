//! Ranges that are known by hand, and what keeps them sharp.

use super::facts::Sign;
use super::*;
use crate::domain::counting::evaluations;
use crate::domain::scalar::Scalar;
use crate::function::InstKind;
use crate::pass::{PIPELINE, interval, run_pipeline};
use crate::table::{Rows, Tables};
use crate::text::parse;
use crate::{Entity, FoldKind, Function, FunctionBuilder, Origin, Part, Rule, Schema, Value, verify};

const ALL: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

/// The range of a function of x, y and z.
fn range_of(
    inputs: &[[f32; 2]],
    write: impl FnOnce(&mut FunctionBuilder, Value, Value, Value) -> Value,
) -> [f32; 2] {
    let mut b = FunctionBuilder::new("f", &["x", "y", "z"]);
    let (x, y, z) = (b.input(0), b.input(1), b.input(2));
    let out = write(&mut b, x, y, z);
    let function = verify(b.finish(&[("out".into(), out)])).expect("it obeys the rules");
    let inputs: Vec<[f32; 2]> = (0..3).map(|i| inputs.get(i).copied().unwrap_or([0.0, 0.0])).collect();
    enclose(&function, &Tables::default(), &inputs)[0]
}

fn constant(number: f32) -> impl Fn(&mut FunctionBuilder) -> Value {
    move |b| b.constant(number)
}

#[test]
fn a_parabola() {
    // x^2 - 2x on [1, 2] is [-1, 0]; the two uses of x in the difference are not seen as one.
    let range = range_of(&[[1.0, 2.0]], |b, x, _, _| {
        let (two, square) = (constant(2.0)(b), b.mul(x, x));
        let double = b.mul(two, x);
        b.sub(square, double)
    });
    assert_eq!(range, [-3.0, 2.0]);
}

#[test]
fn a_plane() {
    let plane = |b: &mut FunctionBuilder, x, y, z| {
        let (two, three, four) = (b.constant(2.0), b.constant(-3.0), b.constant(4.0));
        let sum = b.add(z, four);
        let sum = b.fma(y, three, sum);
        b.fma(two, x, sum)
    };
    assert_eq!(range_of(&[[0.0, 1.0], [-1.0, 1.0], [2.0, 3.0]], plane), [3.0, 12.0]);
    assert_eq!(range_of(&[[0.0, 1.0], [-1.0, 3.0], [2.0, 3.0]], plane), [-3.0, 12.0]);
}

#[test]
fn squares_are_not_negative() {
    let square = |b: &mut FunctionBuilder, x, _, _| b.mul(x, x);
    assert_eq!(range_of(&[[-3.0, 2.0]], square), [0.0, 9.0]);
    assert_eq!(range_of(&[[2.0, 3.0]], square), [4.0, 9.0]);
    assert_eq!(range_of(&[[-3.0, -2.0]], square), [4.0, 9.0]);
    let plus = |b: &mut FunctionBuilder, x, y, _| b.fma(x, x, y);
    assert_eq!(range_of(&[[-3.0, 2.0], [1.0, 2.0]], plus), [1.0, 11.0]);
    // Two values that have one range are two values, and one that was held is still one.
    let product = |b: &mut FunctionBuilder, x, y, _| b.mul(x, y);
    assert_eq!(range_of(&[[-3.0, 2.0], [-3.0, 2.0]], product), [-6.0, 9.0]);
    let held = |b: &mut FunctionBuilder, x, _, _| {
        let still = b.stop_gradient(x);
        b.mul(x, still)
    };
    assert_eq!(range_of(&[[-3.0, 2.0]], held), [0.0, 9.0]);
}

#[test]
fn odd_powers_grow() {
    type Power = fn(&mut FunctionBuilder, Value, Value, Value) -> Value;
    let cube: Power = |b, x, _, _| {
        let square = b.mul(x, x);
        b.mul(square, x)
    };
    let fifth: Power = |b, x, y, z| {
        let (cube, square) = (cube_of(b, x, y, z), b.mul(x, x));
        b.mul(square, cube)
    };
    let seventh: Power = |b, x, y, z| {
        let (cube, square) = (cube_of(b, x, y, z), b.mul(x, x));
        let fourth = b.mul(square, square);
        b.fma(cube, fourth, y)
    };
    fn cube_of(b: &mut FunctionBuilder, x: Value, _: Value, _: Value) -> Value {
        let square = b.mul(x, x);
        b.mul(x, square)
    }
    assert_eq!(range_of(&[[-2.0, 1.0]], cube), [-8.0, 1.0]);
    assert_eq!(range_of(&[[-2.0, 1.0]], cube_of), [-8.0, 1.0]);
    assert_eq!(range_of(&[[-2.0, 3.0]], fifth), [-32.0, 243.0]);
    assert_eq!(range_of(&[[-1.0, 2.0], [1.0, 1.0]], seventh), [0.0, 129.0]);
    assert_eq!(range_of(&[[-2.0, -1.0]], cube), [-8.0, -1.0]);
    // The square of an odd power, and a value that only looks like the base.
    let sixth: Power = |b, x, y, z| {
        let cube = cube_of(b, x, y, z);
        b.mul(cube, cube)
    };
    assert_eq!(range_of(&[[-2.0, 1.0]], sixth), [0.0, 64.0]);
    let other: Power = |b, x, y, _| {
        let square = b.mul(x, x);
        b.mul(square, y)
    };
    assert_eq!(range_of(&[[-2.0, 1.0], [-2.0, 1.0]], other), [-8.0, 4.0]);
    for none in [ALL, [1.0, 0.0], [f32::NAN, 1.0]] {
        assert_eq!(range_of(&[none], cube), ALL, "{none:?} admits NaN");
    }
    assert_eq!(range_of(&[[-1e20, 1.0]], cube), ALL, "infinity is no finite bound");
}

#[test]
fn odd_powers_hold_what_they_compute() {
    // Random numbers of any size: where x^5 rounds, overflows or vanishes.
    let mut rng = fastrand::Rng::with_seed(5);
    let mut bounded = 0;
    for _ in 0..2000 {
        let scale = [1.0, 1e-9, 1e-14, 1e-20, 1e7, 1e9][rng.usize(0..6)];
        let mut ends = [(); 2].map(|()| scale * (2.0 * rng.f32() - 1.0));
        ends.sort_by(f32::total_cmp);
        let fifth = |b: &mut FunctionBuilder, x, _, _| {
            let square = b.mul(x, x);
            let cube = b.mul(x, square);
            b.mul(cube, square)
        };
        let [low, high] = range_of(&[ends], fifth);
        bounded += u32::from([low, high] != ALL);
        for part in 0..=20 {
            let x = (ends[0] + (ends[1] - ends[0]) * part as f32 / 20.0).clamp(ends[0], ends[1]);
            let square = x * x;
            let value = (x * square) * square;
            assert!(low <= value && value <= high, "{value:e} at {x:e} in [{low:e}, {high:e}]");
        }
    }
    assert!(bounded > 1000, "{bounded}");
}

#[test]
fn everything_and_what_is_made_of_it() {
    let square = |b: &mut FunctionBuilder, x, _, _| b.mul(x, x);
    for none in [ALL, [1.0, 0.0], [f32::NAN, 1.0], [0.0, f32::NAN]] {
        assert_eq!(range_of(&[none], square), ALL, "{none:?} admits NaN");
    }
    assert_eq!(range_of(&[[1e30, 1e30]], square), ALL, "infinity is no finite bound");
    // `max(NaN, 0)` is 0 and `max(0, NaN)` is NaN.
    let clamp = |b: &mut FunctionBuilder, x, _, _| {
        let (zero, one) = (b.constant(0.0), b.constant(1.0));
        let falling = b.sub(one, x);
        let low = b.max(falling, zero);
        b.min(low, one)
    };
    assert_eq!(range_of(&[ALL], clamp), [0.0, 1.0]);
    let other_way = |b: &mut FunctionBuilder, x, _, _| {
        let (zero, one) = (b.constant(0.0), b.constant(1.0));
        let low = b.max(zero, x);
        b.min(one, low)
    };
    assert_eq!(range_of(&[ALL], other_way), ALL);
    assert_eq!(range_of(&[[-1.0, 7.0]], other_way), [0.0, 1.0]);
}

#[test]
fn a_falloff_reaches_exactly_zero() {
    // max(1 - |p|^2, 0)^2 beyond its support, also in a box without end.
    let falloff = |b: &mut FunctionBuilder, x, y, z| {
        let (zero, one, minus) = (b.constant(0.0), b.constant(1.0), b.constant(-1.0));
        let sum = b.mul(x, x);
        let sum = b.fma(y, y, sum);
        let sum = b.fma(z, z, sum);
        let u = b.fma(sum, minus, one);
        let u = b.max(u, zero);
        b.mul(u, u)
    };
    assert_eq!(range_of(&[[2.0, 3.0], [-1.0, 1.0], [-1.0, 1.0]], falloff), [0.0, 0.0]);
    assert_eq!(range_of(&[[-1.0, 0.5]; 3], falloff), [0.0, 1.0]);
    assert_eq!(range_of(&[ALL; 3], falloff), [0.0, 1.0]);
}

#[test]
fn quotients() {
    let quotient = |b: &mut FunctionBuilder, x, y, _| b.div(x, y);
    assert_eq!(range_of(&[[-1.0, 2.0], [2.0, 4.0]], quotient), [-0.5, 1.0]);
    assert_eq!(range_of(&[[1.0, 2.0], [-4.0, -2.0]], quotient), [-1.0, -0.25]);
    for with_zero in [[0.0, 1.0], [-1.0, 0.0], [-1.0, 1.0]] {
        assert_eq!(range_of(&[[1.0, 2.0], with_zero], quotient), ALL);
    }
    let over_positive = |b: &mut FunctionBuilder, x, y, _| {
        let magnitude = b.abs(y);
        b.div(x, magnitude)
    };
    assert_eq!(range_of(&[[-1.0, 2.0], [-4.0, -2.0]], over_positive), [-0.5, 1.0]);
    assert_eq!(range_of(&[[1.0, 2.0], [-4.0, 0.0]], over_positive), ALL);
}

#[test]
fn choices_that_are_certain_are_taken() {
    let smaller = |b: &mut FunctionBuilder, x, y, _| {
        let less = b.lt(x, y);
        b.select(less, x, y)
    };
    assert_eq!(range_of(&[[0.0, 1.0], [2.0, 3.0]], smaller), [0.0, 1.0]);
    assert_eq!(range_of(&[[2.0, 3.0], [0.0, 2.0]], smaller), [0.0, 2.0]);
    assert_eq!(range_of(&[[0.0, 5.0], [2.0, 3.0]], smaller), [0.0, 5.0]);
}

#[track_caller]
fn close([low, high]: [f32; 2], [expected_low, expected_high]: [f64; 2]) {
    let (low, high) = (f64::from(low), f64::from(high));
    let (slack_low, slack_high) = (1e-6 * expected_low.abs() + 1e-40, 1e-6 * expected_high.abs() + 1e-40);
    assert!(low <= expected_low && low >= expected_low - slack_low, "{low} for {expected_low}");
    assert!(high >= expected_high && high <= expected_high + slack_high, "{high} for {expected_high}");
}

#[test]
fn what_may_be_no_number_is_not_certainly_infinite() {
    // NaN <= inf does not hold, and NaN == inf neither: then y is taken, which is negative.
    for x in [ALL, [0.0, f32::INFINITY]] {
        for equal in [false, true] {
            let range = range_of(&[x, [-2.0, -1.0]], |b, x, y, _| {
                let (infinity, one) = (b.constant(f32::INFINITY), b.constant(1.0));
                let size = b.abs(x);
                let holds = if equal { b.eq(size, infinity) } else { b.le(size, infinity) };
                let chosen = b.select(holds, size, y);
                b.min(chosen, one)
            });
            assert!(range[0] <= -2.0, "{range:?}");
        }
    }
}

#[test]
fn transcendentals_are_sharp() {
    let sin = |range| range_of(&[range], |b, x, _, _| b.sin(x));
    let cos = |range| range_of(&[range], |b, x, _, _| b.cos(x));
    close(sin([0.1, 0.2]), [f64::from(0.1f32).sin(), f64::from(0.2f32).sin()]);
    close(sin([1.0, 2.0]), [1f64.sin(), 1.0]);
    close(sin([4.0, 5.0]), [-1.0, 4f64.sin()]);
    close(sin([1.0, 6.0]), [-1.0, 1.0]);
    close(sin([1000.25, 1000.5]), [1000.25f64.sin(), 1000.5f64.sin()]);
    close(cos([-0.5, 1.0]), [1f64.cos(), 1.0]);
    close(cos([3.0, 4.0]), [-1.0, 4f64.cos()]);
    close(cos([1.0, 2.0]), [2f64.cos(), 1f64.cos()]);
    assert_eq!(sin([0.0, 200_000.0]), [-1.0, 1.0]);
    assert_eq!(cos([150_000.0, 150_000.0]), [-1.0, 1.0]);
    assert_eq!(sin([0.0, f32::INFINITY]), ALL);

    let exp = |range| range_of(&[range], |b, x, _, _| b.exp(x));
    close(exp([-1.0, 2.0]), [(-1f64).exp(), 2f64.exp()]);
    assert_eq!(exp([-1000.0, -200.0])[0], 0.0);
    assert_eq!(exp([0.0, 100.0]), ALL);
    let ln = |range| range_of(&[range], |b, x, _, _| b.ln(x));
    close(ln([0.5, 2.0]), [0.5f64.ln(), 2f64.ln()]);
    assert_eq!(ln([0.0, 2.0]), ALL);
    let sqrt = |range| range_of(&[range], |b, x, _, _| b.sqrt(x));
    assert_eq!(sqrt([4.0, 9.0]), [2.0, 3.0]);
    assert_eq!(sqrt([-1.0, 9.0]), ALL);
}

#[test]
fn powers_have_their_extremes_at_corners() {
    let pow = |a, b| range_of(&[a, b], |d, x, y, _| d.pow(x, y));
    close(pow([0.5, 2.0], [1.0, 3.0]), [0.125, 8.0]);
    close(pow([0.5, 2.0], [-1.0, 3.0]), [0.125, 8.0]);
    close(pow([0.25, 0.5], [-1.0, 1.0]), [0.25, 4.0]);
    assert_eq!(pow([-1.0, 2.0], [1.0, 2.0]), ALL);
    assert_eq!(pow([0.0, 2.0], [-1.0, 2.0]), ALL);
    let cube = |a| {
        range_of(&[a], |d, x, _, _| {
            let three = d.constant(3.0);
            d.pow(x, three)
        })
    };
    close(cube([0.5, 2.0]), [0.125, 8.0]);
    close(cube([0.0, 2.0]), [0.0, 8.0]);
}

/// A sum of points with the soft object's falloff, and its rows.
fn sum_of_points(rows: usize) -> (Function, Tables) {
    let mut b = FunctionBuilder::new("points", &["x", "y", "z"]);
    let columns = ["x", "y", "z", "neg_inv_r2"].map(String::from).to_vec();
    let table = b.table(Schema { name: "point".into(), columns, parent: None, slots: vec![7] });
    let inputs: [Value; 3] = std::array::from_fn(|index| b.input(index));
    let (zero, one, four, five) = (b.constant(0.0), b.constant(1.0), b.constant(4.0), b.constant(5.0));
    let acc = b.begin_fold(table, (FoldKind::Rows, Rule::Neutral), &[zero])[0];
    b.set_origin(Origin::leaf(7, Part::Position));
    let [dx, dy, dz] = std::array::from_fn(|index| {
        let column = b.column(table, index);
        b.sub(inputs[index], column)
    });
    let distance = b.mul(dx, dx);
    let distance = b.fma(dy, dy, distance);
    b.set_origin(Origin::leaf(7, Part::Distance));
    let distance = b.fma(dz, dz, distance);
    b.set_origin(Origin::leaf(7, Part::Falloff));
    let scale = b.column(table, 3);
    let u = b.fma(distance, scale, one);
    let u = b.max(u, zero);
    let square = b.mul(u, u);
    let rest = b.fma(u, four, five);
    let next = b.fma(square, rest, acc);
    b.set_origin(Origin::SHARED);
    let sum = b.end_fold(&[next])[0];
    let function = b.finish(&[("field".into(), sum)]);
    let number = |i: usize| 0.3 * (i % 17) as f32 - 2.0;
    let numbers = (0..rows).flat_map(|i| [number(i), number(3 * i), number(5 * i), -0.5]).collect();
    let active: Vec<u32> = (0..u32::try_from(rows).expect("there are few")).collect();
    let rows = Rows {
        count: rows,
        stride: 4,
        numbers,
        starts: vec![0, u32::try_from(rows).expect("there are few")],
        nodes: active.clone(),
        active,
    };
    let mut tables = Tables::default();
    tables.tables.push(rows);
    (function, tables)
}

/// Ops in the body of the only fold.
fn ops_of_a_row(function: &Function) -> usize {
    let body = function.insts.values().find_map(|data| match &data.kind {
        InstKind::Fold(fold) => Some(fold.body),
        InstKind::Input(_)
        | InstKind::Constant(_)
        | InstKind::BitsConstant(_)
        | InstKind::Column { .. }
        | InstKind::Op { .. } => None,
    });
    let insts = &function.blocks[body.expect("there is a fold")].insts;
    insts.iter().filter(|inst| matches!(function.insts[**inst].kind, InstKind::Op { .. })).count()
}

#[test]
fn a_row_stays_small_and_its_distance_is_one() {
    let (function, tables) = sum_of_points(20);
    let plain = run_pipeline(function.clone(), PIPELINE, &mut |_, _| {});
    let ranges = run_pipeline(interval(&function), PIPELINE, &mut |_, _| {});
    assert_eq!((ops_of_a_row(&plain), ops_of_a_row(&ranges)), (11, 38));
    let [plain, ranges] = [plain, ranges].map(|function| verify(function).expect("it obeys the rules"));
    assert_eq!(evaluations(&plain, &tables), evaluations(&ranges, &tables));
    assert_eq!(evaluations(&ranges, &tables).total, 20);
}

#[test]
fn the_domain_runs_in_the_interpreter_too() {
    let (function, tables) = sum_of_points(9);
    let function = verify(function).expect("it obeys the rules");
    let mut domain = Interval::new(Scalar);
    let box_ = [[-0.5, 0.25], [0.0, 0.5], [-1.0, -0.5]];
    let inputs = box_.map(|[low, high]| domain.input(low, high));
    let result = crate::interpret::run(&function, &tables, &mut domain, &inputs)[0];
    assert_eq!(domain.output(result), enclose(&function, &tables, &box_)[0]);
}

#[test]
fn facts_hold_in_every_iteration() {
    // The second row makes the sum negative: it is not known to be otherwise, though it starts at 0.
    let text = "function \"f\" (x) -> (a, b) {
    table t0 \"row\" (c)
block0:
    v0 = input x
    v1 = const 0.0
    v2, v3 = fold t0 rows neutral (v1, v1) block1(v4, v5):
        v6 = column t0.c
        v7 = fma v0, v6, v4
        v8 = add v5, v4
        yield v7, v8
    v9 = mul v2, v3
    yield v9, v3
}
";
    let function = verify(parse(text).expect("it parses")).expect("it obeys the rules");
    let facts = crate::facts::facts::<Facts>(function.function());
    for value in [4, 5] {
        assert_eq!(facts[value].sign, Sign::Unknown, "{}", Value::new(value));
        assert!(!facts[value].point);
    }
    let mut tables = Tables::default();
    tables.tables.push(Rows {
        count: 2,
        stride: 1,
        numbers: vec![1.0, -4.0],
        active: vec![0, 1],
        starts: vec![0, 2],
        nodes: vec![],
    });
    // v2: [1, 2] - 4 [1, 2] = [-7, -2]; v3: what v2 was: [1, 2].
    assert_eq!(enclose(&function, &tables, &[[1.0, 2.0]]), [[-14.0, -2.0], [1.0, 2.0]]);
}

#[test]
fn a_value_and_its_complement_are_not_both_on_one_side() {
    // max(x, 3 - x) and the minimum, with others between.
    let of = |is_max: bool, again: bool| {
        range_of(&[[-3.0, 8.0], [-9.0, -7.0]], |b, x, y, _| {
            let (three, zero) = (b.constant(3.0), b.constant(if is_max { -5.0 } else { 5.0 }));
            let rest = b.sub(three, x);
            let y = if is_max { y } else { b.neg(y) };
            let other = if again { b.sub(three, x) } else { x };
            let step = |b: &mut FunctionBuilder, so_far, next| {
                if is_max { b.max(next, so_far) } else { b.min(next, so_far) }
            };
            let so_far = step(b, zero, other);
            let so_far = step(b, so_far, y);
            step(b, so_far, rest)
        })
    };
    assert_eq!(of(true, false), [1.5, 8.0]);
    assert_eq!(of(false, false), [-5.0, 1.5]);
    // Not of the complement twice.
    assert_eq!(of(true, true), [-5.0, 6.0]);
    // What may be NaN may be it on both sides.
    let both = |b: &mut FunctionBuilder, x, _, _| {
        let three = b.constant(3.0);
        let root = b.sqrt(x);
        let rest = b.sub(three, root);
        b.max(root, rest)
    };
    assert_eq!(range_of(&[[-1.0, 4.0]], both), ALL);
    assert_eq!(range_of(&[[0.0, 16.0]], both), [1.5, 4.0]);
}

#[test]
fn an_end_is_a_number() {
    let low = |b: &mut FunctionBuilder, x, _, _| b.low_end(x);
    assert_eq!(range_of(&[[-3.0, 2.0]], low), [-3.0, -3.0]);
    assert_eq!(range_of(&[[f32::NEG_INFINITY, 2.0]], low), ALL);
    assert_eq!(range_of(&[[-3.0, f32::INFINITY]], low), ALL);
    // x - x^3 / 16 grows here; op by op it is [-2.5, 2.5].
    let bounded = |b: &mut FunctionBuilder, x, _, _| {
        let part = b.constant(-1.0 / 16.0);
        let cubic = |b: &mut FunctionBuilder, x| {
            let square = b.mul(x, x);
            let cube = b.mul(square, x);
            b.fma(cube, part, x)
        };
        let plain = cubic(b, x);
        let minus = b.neg(x);
        let (low, high) = (b.low_end(x), b.low_end(minus));
        let high = b.neg(high);
        let (low, high) = (cubic(b, low), cubic(b, high));
        let below = b.min(high, plain);
        b.max(low, below)
    };
    assert_eq!(range_of(&[[-2.0, 2.0]], bounded), [-1.5, 1.5]);
}
