//! Interval evaluation encloses: every value that a function computes in a box lies in the range that the box
//! gives, whether the range is computed or emitted, and both give the same bits.
//!
//! `JBT_INTERVAL_EFFORT=20 cargo test --release --test interval` checks twenty times as many points.

mod common;

use common::random;
use fastrand::Rng;
use jbt_ir::domain::interval::enclose;
use jbt_ir::domain::lanes::{Level, Scratch, Tape};
use jbt_ir::domain::scalar::Scalar;
use jbt_ir::interpret::run;
use jbt_ir::pass::{GRADIENT, INTERVAL, PIPELINE, run_pipeline};
use jbt_ir::{
    Domain, FoldKind, Function, FunctionBuilder, Op, Rows, Rule, Schema, Selection, Tables, Type, Value,
    Verified, verify,
};

/// A range for each input plane.
type Box3 = [[f32; 2]; 3];

/// How many times more than usual is to be checked.
fn effort() -> u64 {
    std::env::var("JBT_INTERVAL_EFFORT").map_or(1, |effort| effort.parse().expect("a number of times"))
}

/// What was checked.
#[derive(Clone, Copy, Default, Debug)]
struct Checked {
    /// Values of outputs at points.
    values: u64,
    /// Those of them whose range was not everything.
    bounded: u64,
}

impl std::ops::AddAssign for Checked {
    fn add_assign(&mut self, other: Self) {
        self.values += other.values;
        self.bounded += other.bounded;
    }
}

/// A function, and the two ways to its ranges.
struct Subject {
    name: String,
    plain: Verified,
    emitted: Verified,
    /// Emitted, and through the pipeline.
    final_: Verified,
    tables: Tables,
}

impl Subject {
    fn new(name: String, function: &Function, tables: Tables) -> Self {
        let emitted = (INTERVAL.run)(function.clone());
        let final_ = run_pipeline(emitted.clone(), PIPELINE, &mut |_, _| {});
        let verified = |function: Function| match verify(function) {
            Ok(function) => function,
            Err(errors) => panic!("{name}: {errors:?}"),
        };
        let plain = verified(function.clone());
        let (emitted, final_) = (verified(emitted), verified(final_));
        tables.check(emitted.function()).expect("the tables keep their layout");
        Self { plain, emitted, final_, tables, name }
    }

    /// The ranges of the outputs. All ways to them agree, bit for bit.
    fn ranges(&self, region: &[[f32; 2]]) -> Vec<[f32; 2]> {
        let ranges = enclose(&self.plain, &self.tables, region);
        let planes: Vec<f32> = region.iter().flatten().copied().collect();
        for function in [&self.emitted, &self.final_] {
            let bounds = run(function, &self.tables, &mut Scalar, &planes);
            for (index, (bound, expected)) in bounds.iter().zip(ranges.iter().flatten()).enumerate() {
                assert_eq!(
                    bound.to_bits(),
                    expected.to_bits(),
                    "{}, bound {index} in {region:?}: {bound:e} is emitted, {expected:e} is computed\n{}",
                    self.name,
                    self.plain.function()
                );
            }
        }
        for [low, high] in &ranges {
            let finite = low.is_finite() && high.is_finite() && low <= high;
            let all = *low == f32::NEG_INFINITY && *high == f32::INFINITY;
            assert!(finite || all, "{}: [{low:e}, {high:e}] is no range", self.name);
        }
        ranges
    }

    fn check(&self, region: &Box3, points: &[[f32; 3]]) -> Checked {
        let ranges = self.ranges(region);
        let mut checked = Checked::default();
        for point in points {
            let values = run(&self.plain, &self.tables, &mut Scalar, point);
            for (index, (value, [low, high])) in values.iter().zip(&ranges).enumerate() {
                let everything = *low == f32::NEG_INFINITY;
                checked.values += 1;
                checked.bounded += u64::from(!everything);
                assert!(
                    everything || (low <= value && value <= high),
                    "{}: output {index} is {value:e} at {point:?}, outside of [{low:e}, {high:e}] of {region:?}\n{}",
                    self.name,
                    self.plain.function()
                );
            }
        }
        checked
    }
}

/// A range of any kind: tiny, large, astride zero, unbounded, a single number.
fn range(random: &mut Rng) -> [f32; 2] {
    let mut spicy = || loop {
        let number = random::number(random);
        if !number.is_nan() {
            return number;
        }
    };
    let (a, b) = (spicy(), spicy());
    let centre = (random.f32() - 0.5) * 6.0;
    match random.u8(0..16) {
        0 => [a, a],
        1 => [f32::NEG_INFINITY, f32::INFINITY],
        2 => [a, f32::INFINITY],
        3 => [a.min(b), a.max(b)],
        4 => [a, a.next_up()],
        5 => [-a.abs(), b.abs()],
        6 => [centre, centre],
        7..10 => [centre, centre + random.f32() * 0.01],
        _ => [centre, centre + random.f32() * 2.0],
    }
}

/// Ends at which something happens.
const HARD: [f32; 13] = [
    f32::NEG_INFINITY,
    f32::MIN,
    -2.0,
    -1.0,
    -0.5,
    -f32::MIN_POSITIVE,
    0.0,
    f32::MIN_POSITIVE,
    0.5,
    1.0,
    2.0,
    f32::MAX,
    f32::INFINITY,
];

/// A range between hard ends.
fn hard_range(random: &mut Rng) -> [f32; 2] {
    let (a, b) = (random.usize(0..HARD.len()), random.usize(0..HARD.len()));
    [HARD[a.min(b)], HARD[a.max(b)]]
}

/// A number in the range: an end, next to one, or between.
fn inside(random: &mut Rng, [low, high]: [f32; 2]) -> f32 {
    if low == f32::NEG_INFINITY && high == f32::INFINITY {
        return random::number(random);
    }
    let (first, last) = (low.max(f32::MIN), high.min(f32::MAX));
    let number = match random.u8(0..10) {
        0 | 1 => low,
        2 | 3 => high,
        4 => low.next_up(),
        5 => high.next_down(),
        6 => 0.0,
        7 => random::number(random),
        _ => first * (1.0 - random.f32()) + last * random.f32(),
    };
    let number = if number.is_nan() { low } else { number };
    // A zero of either sign, where the range has one.
    let number = if number == 0.0 && random.bool() { -number } else { number };
    number.clamp(low, high)
}

fn check_boxes(subject: &Subject, random: &mut Rng, boxes: usize, points: usize) -> Checked {
    let mut checked = Checked::default();
    for at in 0..boxes {
        let range = if at % 4 == 3 { hard_range } else { range };
        let region: Box3 = std::array::from_fn(|_| range(random));
        let points: Vec<[f32; 3]> = (0..points).map(|_| region.map(|range| inside(random, range))).collect();
        checked += subject.check(&region, &points);
    }
    checked
}

#[test]
fn random_functions_with_everything_are_enclosed() {
    let mut checked = Checked::default();
    for seed in 0..400 * effort() {
        let function = random::function(seed, 10 + seed as usize % 50);
        let function = if seed % 4 == 3 { (GRADIENT.run)(function) } else { function };
        let tables = random::tables(&function, seed);
        let subject = Subject::new(format!("random function {seed}"), &function, tables);
        checked += check_boxes(&subject, &mut Rng::with_seed(seed), 8, 16);
    }
    assert!(checked.values > 1_000_000, "{checked:?}");
    assert!(checked.bounded > 200_000, "{checked:?}");
}

/// Writes functions that mostly stay finite: sums, products, roots and choices of small numbers.
struct Tame {
    random: Rng,
    builder: FunctionBuilder,
    values: Vec<Value>,
}

impl Tame {
    fn any(&mut self) -> Value {
        let from = self.values.len().saturating_sub(8);
        let range = if self.random.u8(0..3) == 0 { 0..self.values.len() } else { from..self.values.len() };
        self.values[self.random.usize(range)]
    }

    fn step(&mut self) {
        const OPS: [Op; 17] = [
            Op::Add,
            Op::Sub,
            Op::Sub,
            Op::Mul,
            Op::Mul,
            Op::Fma,
            Op::Fma,
            Op::Min,
            Op::Max,
            Op::Abs,
            Op::Neg,
            Op::Div,
            Op::Sin,
            Op::Cos,
            Op::StopGradient,
            Op::Select,
            Op::Sqrt,
        ];
        let op = OPS[self.random.usize(0..OPS.len())];
        let (x, y, z) = (self.any(), self.any(), self.any());
        let b = &mut self.builder;
        let value = match op {
            Op::Div => {
                // A divisor that is never 0, for most.
                let square = b.mul(y, y);
                let one = b.constant(0.5);
                let divisor = b.add(square, one);
                b.div(x, divisor)
            }
            Op::Sqrt => {
                let magnitude = b.abs(x);
                let root = b.sqrt(magnitude);
                let (one, half) = (b.constant(0.25), b.constant(0.75));
                let base = b.min(root, one);
                let power = b.pow(base, half);
                let exponent = b.sub(power, root);
                b.exp(exponent)
            }
            Op::Select => {
                let condition = if self.random.bool() { b.lt(x, y) } else { b.le(y, z) };
                b.select(condition, y, z)
            }
            Op::Fma if self.random.bool() => b.fma(x, x, z),
            Op::Mul if self.random.bool() => b.mul(x, x),
            other => b.op(other, &[x, y, z][..other.operands().len()]),
        };
        // What grows is made small again.
        let value = if matches!(op, Op::Mul | Op::Fma) && self.random.bool() { b.sin(value) } else { value };
        self.values.push(value);
    }

    fn fresh(&mut self) {
        let number = (self.random.f32() - 0.5) * 4.0;
        let constant = self.builder.constant(number);
        self.values.push(constant);
    }
}

/// A function with a fold that mostly stays finite, and its rows.
fn tame(seed: u64) -> (Function, Tables) {
    let mut tame = Tame {
        random: Rng::with_seed(seed),
        builder: FunctionBuilder::new("tame", &random::INPUTS),
        values: Vec::new(),
    };
    for index in 0..3 {
        let input = tame.builder.input(index);
        tame.values.push(input);
        tame.fresh();
    }
    for _ in 0..tame.random.usize(2..10) {
        tame.step();
    }
    let columns = vec!["a".into(), "b".into()];
    let table = tame.builder.table(Schema { name: "row".into(), columns, parent: None, slots: vec![] });
    let zero = tame.builder.constant(0.0);
    let initial = [zero, tame.any(), zero];
    let accumulators = tame.builder.begin_fold(table, (FoldKind::Rows, Rule::Neutral), &initial);
    let outside = tame.values.len();
    for column in 0..2 {
        let column = tame.builder.column(table, column);
        tame.values.push(column);
    }
    tame.values.push(accumulators[1]);
    for _ in 0..tame.random.usize(2..12) {
        tame.step();
    }
    let (x, y, z) = (tame.any(), tame.any(), tame.any());
    let square = tame.builder.fma(x, x, accumulators[0]);
    let wave = tame.builder.sin(y);
    let sum = tame.builder.add(accumulators[2], z);
    let results = tame.builder.end_fold(&[square, wave, sum]);
    tame.values.truncate(outside);
    tame.values.extend(results);
    for _ in 0..tame.random.usize(1..5) {
        tame.step();
    }
    let last = tame.values.len() - 8;
    let outputs: Vec<(String, Value)> =
        tame.values[last..].iter().enumerate().map(|(i, &value)| (format!("out{i}"), value)).collect();
    let function = tame.builder.finish(&outputs);
    let count = tame.random.usize(0..5);
    let numbers = (0..2 * count).map(|_| (tame.random.f32() - 0.5) * 3.0).collect();
    let active: Vec<u32> = (0..count as u32).collect();
    let rows =
        Rows { count, stride: 2, numbers, starts: vec![0, active.len() as u32], active, nodes: vec![] };
    let mut tables = Tables::default();
    tables.tables.push(rows);
    (function, tables)
}

#[test]
fn finite_functions_and_their_gradients_are_enclosed() {
    let mut checked = Checked::default();
    for seed in 0..500 * effort() {
        let (function, tables) = tame(seed);
        let function = if seed % 3 == 2 { (GRADIENT.run)(function) } else { function };
        let subject = Subject::new(format!("finite function {seed}"), &function, tables);
        checked += check_boxes(&subject, &mut Rng::with_seed(seed), 16, 24);
    }
    assert!(checked.bounded > 1_000_000, "{checked:?}");
}

/// An operand about which something else is known each time.
fn operand(b: &mut FunctionBuilder, random: &mut Rng, index: usize, table: jbt_ir::Table) -> Value {
    let input = b.input(index);
    let column = b.column(table, index);
    match random.u8(0..14) {
        0 => b.abs(input),
        // Zero times infinity, astride nothing.
        10 | 11 => {
            let other = b.input((index + 1) % 3);
            let (magnitude, other) = (b.abs(input), b.abs(other));
            let product = b.mul(magnitude, other);
            if random.bool() { product } else { b.neg(product) }
        }
        1 => {
            let magnitude = b.abs(input);
            b.neg(magnitude)
        }
        2 => {
            let number = random::number(random);
            b.constant(number)
        }
        3 => column,
        4 => b.mul(column, column),
        5 => b.sub(input, column),
        6 => b.mul(input, column),
        7 => {
            let other = b.input((index + 1) % 3);
            b.mul(input, other)
        }
        8 => {
            let zero = b.constant(0.0);
            b.max(input, zero)
        }
        9 => {
            let bits = b.to_bits(column);
            b.from_bits(bits)
        }
        _ => input,
    }
}

/// A function of one op on such operands, as both of which the same may stand.
fn single(op: Op, seed: u64) -> (Function, Tables) {
    let mut random = Rng::with_seed(seed);
    let mut b = FunctionBuilder::new(op.name(), &random::INPUTS);
    let columns = vec!["a".into(), "b".into(), "c".into()];
    let table = b.table(Schema { name: "row".into(), columns, parent: None, slots: vec![] });
    let zero = b.constant(0.0);
    b.begin_fold(table, (FoldKind::Guard, Rule::Neutral), &[zero; 4]);
    let mut reals: Vec<Value> = (0..3).map(|index| operand(&mut b, &mut random, index, table)).collect();
    if random.u8(0..6) == 0 {
        reals[1] = reals[0];
    }
    let masks = [b.lt(reals[0], reals[1]), b.le(reals[1], reals[2]), b.eq(reals[0], reals[2])];
    let bits = reals.iter().map(|&real| b.to_bits(real)).collect::<Vec<_>>();
    let mut args: Vec<Value> = op
        .operands()
        .iter()
        .enumerate()
        .map(|(place, type_)| match type_ {
            Type::Real => reals[place],
            Type::Mask => masks[random.usize(0..3)],
            Type::Bits => bits[place],
        })
        .collect();
    if matches!(op, Op::Shl | Op::Shr) {
        args[1] = b.bits_constant(random.u32(0..40));
    }
    let result = b.op(op, &args);
    let result = match op.result() {
        Type::Real => result,
        Type::Mask => b.select(result, reals[0], reals[2]),
        Type::Bits => b.from_bits(result),
    };
    // A range that is open at one end is everything outside. What limits it shows whether the other end is
    // sound.
    let number = random::number(&mut random);
    let limit = b.constant(if number.is_nan() { 1.0 } else { number });
    let (smaller, larger) = (b.min(result, limit), b.max(result, limit));
    // And what is known of the sign of a range is used by a product with one of which nothing is known.
    let other = b.input(2);
    let product = b.mul(result, other);
    let results = b.end_fold(&[result, smaller, larger, product]);
    let names = ["out", "smaller", "larger", "product"].map(String::from);
    let function = b.finish(&names.into_iter().zip(results).collect::<Vec<_>>());
    let numbers = (0..3).map(|_| random::number(&mut random)).collect();
    let mut tables = Tables::default();
    tables.tables.push(Rows {
        count: 1,
        stride: 3,
        numbers,
        active: vec![0],
        starts: vec![0, 1],
        nodes: vec![],
    });
    (function, tables)
}

#[test]
fn every_op_is_enclosed() {
    // The range of an end is the end, and encloses nothing.
    for &op in Op::ALL.iter().filter(|&&op| op != Op::LowEnd) {
        let mut checked = Checked::default();
        let decides = matches!(op, Op::Min | Op::Max | Op::Lt | Op::Le | Op::Eq | Op::Select);
        for seed in 0..if decides { 600 } else { 150 } * effort() {
            let (function, tables) = single(op, seed);
            let subject = Subject::new(format!("{} {seed}", op.name()), &function, tables);
            checked += check_boxes(&subject, &mut Rng::with_seed(seed), 16, 10);
        }
        assert!(checked.values >= 90_000, "{}: {checked:?}", op.name());
        // An encoding is known of a point only.
        let least = if op.operands().contains(&Type::Bits) || op == Op::ToBits { 0 } else { 4_000 };
        assert!(checked.bounded >= least, "{}: {checked:?}", op.name());
    }
}

#[test]
fn lanes_of_boxes_have_the_same_bits() {
    let mut scratch = Scratch::new();
    for seed in 0..20 {
        let (function, tables) = tame(seed);
        let subject = Subject::new(format!("finite function {seed}"), &function, tables);
        let mut random = Rng::with_seed(seed);
        let boxes: Vec<Box3> = (0..37).map(|_| std::array::from_fn(|_| range(&mut random))).collect();
        let plane = |bound: usize| boxes.iter().map(|region| region[bound / 2][bound % 2]).collect();
        let planes: Vec<Vec<f32>> = (0..6).map(plane).collect();
        let planes: Vec<&[f32]> = planes.iter().map(Vec::as_slice).collect();
        let expected: Vec<Vec<[f32; 2]>> = boxes.iter().map(|region| subject.ranges(region)).collect();
        let all = Selection::new(subject.final_.function(), &subject.tables);
        let tape = Tape::new(&subject.final_).expect("the function is legal");
        for level in Level::available() {
            let mut outputs = vec![vec![0.0; boxes.len()]; 2 * expected[0].len()];
            let mut views: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
            let rows = (&subject.tables, &all);
            tape.run_at(level, rows, &planes, &mut views, &mut scratch).expect("the planes fit");
            for (lane, expected) in expected.iter().enumerate() {
                for (bound, expected) in outputs.iter().zip(expected.iter().flatten()) {
                    assert_eq!(
                        bound[lane].to_bits(),
                        expected.to_bits(),
                        "{} at {}",
                        subject.name,
                        level.name()
                    );
                }
            }
        }
    }
}
