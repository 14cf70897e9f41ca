//! Every op on every engine and level of this CPU against the scalar reference, bit for bit.
//!
//! ```text
//! exact --record FILE          all 2^32 inputs of each op of one operand; resumes where FILE ends
//! exact --stride 65537         every 65,537th input, some seconds
//! exact --ops sin,sqrt         these ops alone
//! ```
//!
//! Ops of two operands meet all pairs of 512 special numbers, ops of three operands random triples
//! (`--triples`, 10^8 with a stride of 1). For transcendentals of one operand it also says the largest
//! error in units of the last place, against the f64 functions of the standard library.

#![allow(clippy::print_stdout, reason = "it says what it has found")]

use std::collections::BTreeMap;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::sync::Arc;
use std::time::Instant;

use jbt::Engine;
use jbt::internals::ir::domain::scalar::Scalar;
use jbt::internals::ir::engine::BoundProgram;
use jbt::internals::ir::op::{Any, apply};
use jbt::internals::ir::pass::{PIPELINE, run_pipeline};
use jbt::internals::ir::{Domain as _, FunctionBuilder, Level, Op, Tables, Type, Value, verify};
use jbt_targets::commit;
use jbt_testkit::bits::same;
use jbt_testkit::ops::{operand, reals};

/// Inputs that are kept at once.
const BATCH: usize = 1 << 14;
/// Inputs of one line of a record.
const CHUNK: u64 = 1 << 28;
/// What a record says of a part of an op's inputs: how many answers of all engines were compared and how many
/// differ, the largest error in ULP and where, the time, the commit. The part's name is that of the op, a
/// shift, the stride, and which inputs.
const COLUMNS: &str = "part,compared,differing,ulp,at,seconds,commit";
/// How far shifts go: constants, one function each.
const SHIFTS: [u32; 8] = [0, 1, 9, 23, 31, 32, 47, u32::MAX];

/// What was found for some inputs of an op.
#[derive(Clone, Copy, Default)]
struct Found {
    compared: u64,
    differing: u64,
    /// The largest error in units of the last place, and where.
    worst: (f64, f32),
}

impl Found {
    fn add(&mut self, other: Self) {
        self.compared += other.compared;
        self.differing += other.differing;
        if other.worst.0 > self.worst.0 {
            self.worst = other.worst;
        }
    }
}

/// An op as programs of all engines, with a constant second operand if it is a shift.
struct Subject {
    op: Op,
    shift: u32,
    programs: Vec<BoundProgram>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let options = options()?;
    let number = |name: &str, default: u64| options.get(name).map_or(Ok(default), |text| text.parse());
    let stride = number("stride", 1)?;
    let triples = number("triples", 100_000_000 / stride.clamp(1, 1000))?;
    let named: Vec<&str> = options.get("ops").map_or_else(Vec::new, |names| names.split(',').collect());
    if let Some(name) = named.iter().find(|name| !Op::ALL.iter().any(|op| op.name() == **name)) {
        return Err(format!("there is no op {name}").into());
    }
    let record = options.get("record");
    let done = record.and_then(|path| std::fs::read_to_string(path).ok()).unwrap_or_default();
    let (begin, commit) = (Instant::now(), commit());
    let mut total = Found::default();
    // A slope is one of the whole function, and the reference has none of a value alone.
    let asked = |op: &&Op| !op.is_slope() && (named.is_empty() || named.contains(&op.name()));
    for subject in Op::ALL.iter().filter(asked).flat_map(|&op| subjects(op)) {
        let mut all = Found::default();
        for (name, run) in parts(&subject, stride, triples) {
            if let Some(line) = done.lines().find(|line| line.starts_with(&format!("{name},"))) {
                all.add(read(line).ok_or_else(|| format!("the record has a bad line: {line}"))?);
                continue;
            }
            let part = Instant::now();
            let found = run();
            all.add(found);
            if let Some(path) = record {
                let mut file = OpenOptions::new().create(true).append(true).open(path)?;
                if file.metadata()?.len() == 0 {
                    writeln!(file, "{COLUMNS}")?;
                }
                let (Found { compared, differing, worst: (worst, at) }, seconds) = (found, part.elapsed());
                let seconds = seconds.as_secs_f64();
                writeln!(file, "{name},{compared},{differing},{worst},{at},{seconds:.1},{commit}")?;
            }
        }
        let error = if truth(subject.op).is_some() {
            format!(", at most {:.3} ULP, at {:e}", all.worst.0, all.worst.1)
        } else {
            String::new()
        };
        let shift = if subject.shift == 0 { String::new() } else { format!(" by {}", subject.shift) };
        println!("{}{shift}: {} answers, {} differ{error}", subject.op.name(), all.compared, all.differing);
        total.add(all);
    }
    println!("{} answers, {} differ, {:.0?}", total.compared, total.differing, begin.elapsed());
    if total.differing > 0 { Err("answers differ".into()) } else { Ok(()) }
}

/// `--name value` pairs.
fn options() -> Result<BTreeMap<String, String>, String> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let pairs = words.chunks(2).map(|pair| match pair {
        [name, value] if ["--stride", "--triples", "--ops", "--record"].contains(&name.as_str()) => {
            Ok((name[2..].to_owned(), value.clone()))
        }
        _ => Err(format!(
            "usage: exact [--stride N] [--triples N] [--ops NAMES] [--record FILE]; found {pair:?}"
        )),
    });
    pairs.collect()
}

/// A line of a record.
fn read(line: &str) -> Option<Found> {
    let words: Vec<&str> = line.split(',').collect();
    let [_, compared, differing, worst, at, _, _] = words[..] else { return None };
    Some(Found {
        compared: compared.parse().ok()?,
        differing: differing.parse().ok()?,
        worst: (worst.parse().ok()?, at.parse().ok()?),
    })
}

/// The parts of an op's inputs, each with its name in a record and what compares it.
fn parts<'a>(subject: &'a Subject, stride: u64, triples: u64) -> Vec<(String, Box<dyn Fn() -> Found + 'a>)> {
    let name = format!("{}.{}.{stride}", subject.op.name(), subject.shift);
    let operands = if is_shift(subject.op) { 1 } else { subject.op.operands().len() };
    match operands {
        1 => (0..(1_u64 << 32) / CHUNK)
            .map(|chunk| {
                let from = chunk * CHUNK;
                let run = move || {
                    each(from / stride, (from + CHUNK) / stride, |n| [bits(n * stride), 0.0, 0.0], subject)
                };
                (format!("{name}.{chunk}"), Box::new(run) as Box<dyn Fn() -> Found>)
            })
            .collect(),
        2 => {
            let special = special();
            let count = (special.len() * special.len()) as u64;
            let run = move || {
                let at = |n: u64| special[n as usize % special.len()];
                each(0, count, |n| [at(n / 512), at(n), 0.0], subject)
            };
            vec![(format!("{name}.pairs"), Box::new(run))]
        }
        _ => {
            let special = special();
            let run = move || {
                let at = |n: u64, operand: u64| {
                    // A number of SplitMix64 for each operand of each triple.
                    let mut z = (3 * n + operand + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
                    z ^= z >> 31;
                    if z & 1 == 0 { special[(z >> 1) as usize % 512] } else { bits(z >> 32) }
                };
                each(0, triples, |n| [at(n, 0), at(n, 1), at(n, 2)], subject)
            };
            vec![(format!("{name}.{triples}"), Box::new(run))]
        }
    }
}

fn bits(number: u64) -> f32 {
    f32::from_bits(number as u32)
}

/// 512 numbers: both signs, 64 exponents from subnormals to NaN, four mantissas.
fn special() -> Vec<f32> {
    let exponents = (0..3).chain(100..158).chain(253..256);
    let magnitudes =
        exponents.flat_map(|exponent| [0, 1, 0x40_0000, 0x7f_ffff].map(|mantissa| exponent << 23 | mantissa));
    magnitudes.flat_map(|magnitude: u32| [magnitude, magnitude | 1 << 31]).map(f32::from_bits).collect()
}

fn is_shift(op: Op) -> bool {
    matches!(op, Op::Shl | Op::Shr)
}

/// The programs of an op: of a shift, for each of some amounts.
fn subjects(op: Op) -> Vec<Subject> {
    let shifts: &[u32] = if is_shift(op) { &SHIFTS } else { &[0] };
    shifts.iter().map(|&shift| Subject { op, shift, programs: programs(op, shift) }).collect()
}

fn programs(op: Op, shift: u32) -> Vec<BoundProgram> {
    let mut b = FunctionBuilder::new(op.name(), &["a", "b", "c"]);
    let mut operands: Vec<Value> =
        (0..).zip(op.operands()).map(|(plane, &type_)| operand(&mut b, plane, type_)).collect();
    if is_shift(op) {
        operands[1] = b.bits_constant(shift);
    }
    let value = b.op(op, &operands);
    let outputs: Vec<(String, Value)> = reals(&mut b, value, op.result())
        .into_iter()
        .enumerate()
        .map(|(place, value)| (format!("o{place}"), value))
        .collect();
    let function = run_pipeline(b.finish(&outputs), PIPELINE, &mut |_, _| {});
    let function = Arc::new(verify(function).expect("passes keep the rules"));
    let mut programs = Vec::new();
    for backend in [Engine::Lanes, Engine::Jit].into_iter().flat_map(Engine::backends) {
        for level in Level::available().into_iter().filter(|&level| backend.covers(level)) {
            let program = backend.compile(&function, level).expect("an op compiles");
            programs
                .push(BoundProgram::new(program, Arc::new(Tables::default())).expect("there are no tables"));
        }
    }
    programs
}

/// What the reference gives, as planes of reals.
fn reference(op: Op, shift: u32, inputs: [f32; 3]) -> [f32; 2] {
    let mut operands: [Any<Scalar>; 3] = [Any::Real(0.0); 3];
    for (plane, type_) in op.operands().iter().enumerate() {
        operands[plane] = match type_ {
            _ if is_shift(op) && plane == 1 => Any::Bits(shift),
            Type::Real => Any::Real(inputs[plane]),
            Type::Mask => Any::Mask(inputs[plane] < 0.25),
            Type::Bits => Any::Bits(inputs[plane].to_bits()),
        };
    }
    match apply(&mut Scalar, op, &operands[..op.operands().len()]) {
        Any::Real(real) => [real, 0.0],
        Any::Mask(mask) => [if mask { 1.0 } else { -0.0 }, 0.0],
        Any::Bits(bits) => [bits & 0xFFFF, bits >> 16].map(|half| f32::from_bits(half | 0x3F80_0000)),
    }
}

/// The function that a transcendental of one operand approximates.
fn truth(op: Op) -> Option<fn(f64) -> f64> {
    match op.name() {
        "sin" => Some(f64::sin),
        "cos" => Some(f64::cos),
        "exp" => Some(f64::exp),
        "ln" => Some(f64::ln),
        _ => None,
    }
}

/// The error of a finite answer in units of the last place of the truth; beyond the largest finite number the
/// units are those of the last binade. Angles beyond the largest one count as zeros by definition.
fn error(op: Op, input: f32, answer: f32) -> f64 {
    let Some(truth) = truth(op) else { return 0.0 };
    let is_angle = matches!(op.name(), "sin" | "cos");
    if is_angle && input.abs() > jbt::internals::ir::math::LARGEST_ANGLE {
        return 0.0;
    }
    let end = 2f64.powi(128);
    let truth = truth(f64::from(input));
    if answer.is_nan() || truth.is_nan() {
        return if answer.is_nan() && truth.is_nan() { 0.0 } else { f64::INFINITY };
    }
    if truth.is_infinite() && answer.is_infinite() {
        return if truth.signum() == f64::from(answer).signum() { 0.0 } else { f64::INFINITY };
    }
    let truth = truth.clamp(-end, end);
    let answer = if answer.is_infinite() { end.copysign(f64::from(answer)) } else { f64::from(answer) };
    // Of subnormals of f64, and of zero, the exponent is lower, too.
    let exponent = (truth.to_bits() >> 52 & 0x7FF).cast_signed() - 1023;
    let unit = exponent.clamp(-126, 127) - 23;
    (answer - truth).abs() * f64::from_bits((1023 - unit).cast_unsigned() << 52)
}

/// Compares inputs of these numbers, on all threads.
fn each(from: u64, to: u64, input: impl Fn(u64) -> [f32; 3] + Sync, subject: &Subject) -> Found {
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let mut all = Found::default();
    std::thread::scope(|scope| {
        let share = |thread: u64| from + (to - from) * thread / threads;
        let run = |thread| {
            let (from, to, input) = (share(thread), share(thread + 1), &input);
            scope.spawn(move || stretch(from, to, input, subject))
        };
        let running: Vec<_> = (0..threads).map(run).collect();
        running.into_iter().for_each(|one| all.add(one.join().expect("it does not panic")));
    });
    all
}

/// How many answers differ. Any NaN equals any NaN, but most answers have equal bits.
fn differing(expected: &[f32], given: &[f32]) -> u64 {
    let pairs = || expected.iter().zip(given);
    if pairs().fold(0, |bits, (a, b)| bits | (a.to_bits() ^ b.to_bits())) == 0 {
        return 0;
    }
    pairs().filter(|(a, b)| !same(**a, **b)).count() as u64
}

fn stretch(from: u64, to: u64, input: &impl Fn(u64) -> [f32; 3], subject: &Subject) -> Found {
    let Subject { op, shift, programs } = subject;
    let outputs = if op.result() == Type::Bits { 2 } else { 1 };
    let mut planes = vec![Vec::new(); outputs];
    let mut found = Found::default();
    let mut next = from;
    while next < to {
        let count = BATCH.min((to - next) as usize);
        let mut inputs = [(); 3].map(|()| vec![0.0_f32; count]);
        let mut expected = vec![vec![0.0_f32; count]; outputs];
        for point in 0..count {
            let at = input(next + point as u64);
            let answers = reference(*op, *shift, at);
            inputs.iter_mut().zip(at).for_each(|(plane, number)| plane[point] = number);
            expected.iter_mut().zip(answers).for_each(|(plane, answer)| plane[point] = answer);
            if truth(*op).is_some() {
                let error = error(*op, at[0], answers[0]);
                if error > found.worst.0 {
                    found.worst = (error, at[0]);
                }
            }
        }
        for program in programs {
            planes.iter_mut().for_each(|plane| {
                plane.clear();
                plane.resize(count, -7.0);
            });
            let mut views: Vec<&mut [f32]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
            let inputs = inputs.each_ref().map(Vec::as_slice);
            program.run(&inputs, &mut views).expect("the planes fit");
            for (expected, plane) in expected.iter().zip(&planes) {
                found.differing += differing(expected, plane);
            }
            found.compared += count as u64;
        }
        next += count as u64;
    }
    found
}
