//! `cost`: microseconds for each IR value, from text to running code, of models that mean well and of others.
//!
//! ```text
//! cargo run --release -p jbt-benches --bin cost [-- PART [LEVEL]]
//! ```
//!
//! Each model is read, checked, lowered, and taken through all passes to machine code, for its field, for all
//! answers and for ranges. A row tells the values of the longest function on the way (and the rows of its
//! tables, each of which counts as one), the time of each stage in ms, and what is beyond a millisecond for
//! each value, in us. Stages that take part of several programs (text, check, shapes) count to each. What is
//! beyond a limit ends with the stage that says so.
//!
//! Only models whose name has PART are measured. LEVEL is that of the machine code, the best as a rule:
//! `baseline` is Cranelift's. A row is the fastest of three runs; a `!` stands behind what takes more than
//! 15 us a value.
#![allow(clippy::print_stdout, reason = "it is a program")]

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::{Duration, Instant};

use jbt::internals::ir::engine::choose;
use jbt::internals::ir::pass::run_pipeline;
use jbt::internals::ir::{Function, Tables, verify};
use jbt::internals::kernel::{Purpose, passes};
use jbt::internals::lower::Lowering;
use jbt::{Engine, Level, Query, limits};

/// Runs of which the fastest counts.
const RUNS: usize = 3;
/// What a program may take besides its values, in us.
const FREE: f64 = 1000.0;
/// What a value may take, in us.
const MOST: f64 = 15.0;

const BALL: &str = "point { radius 1 }";

/// A text around another one, so often.
fn nested(count: usize, before: &str, after: &str) -> String {
    format!("{}{BALL}{}", before.repeat(count), after.repeat(count))
}

/// Definitions each of which uses the one before twice.
fn doubled(count: usize, both: &str) -> String {
    let mut text = format!("let a0 = {BALL}\n");
    for at in 0..count {
        let last = format!("use a{at}");
        let _ = writeln!(text, "let a{} = {}", at + 1, both.replace("LAST", &last));
    }
    text
}

/// A sum of terms, by number.
fn terms(count: usize, term: impl Fn(usize) -> String) -> String {
    let terms: Vec<String> = (1..=count).map(term).collect();
    format!("expression {{ {} }}", terms.join(" + "))
}

fn models() -> Vec<(&'static str, String)> {
    let moved = "sum { LAST translate (0.1 0 0) { LAST } }";
    let warped = "sum { twist axis z rate 0.1 { LAST } translate (0.1 0 0) { LAST } }";
    let kinds = ["point { RADIUS }", "segment { from (0 0 0) to (0 0 1) RADIUS }"];
    let falloffs = ["wyvill", "blinn { hardness 3 cutoff 1 edge smooth }", "soft"];
    let mixed = |count: usize| {
        let part = |at: usize| {
            let radius = format!("radius {} falloff {}", 1 + at % 7, falloffs[at % falloffs.len()]);
            format!("translate ({at} 0 0) {{ {} }}\n", kinds[at % kinds.len()].replace("RADIUS", &radius))
        };
        format!("sum {{ {} }}", (0..count).map(part).collect::<String>())
    };
    vec![
        ("a point", BALL.to_owned()),
        ("a sum of 10,000 points", format!("sum {{ {} }}", format!("{BALL}\n").repeat(10_000))),
        ("a sum of 300 kinds", mixed(300)),
        ("1,000 translations", nested(1000, "translate (0.001 0 0) { ", "}")),
        ("1,000 shells", nested(1000, "shell 0.1 { ", "}")),
        ("30 twists", nested(30, "twist axis z rate 1 { ", "}")),
        ("300 twists", nested(300, "twist axis z rate 1 { ", "}")),
        ("3,000 twists", nested(3000, "twist axis z rate 1 { ", "}")),
        ("11 doublings", format!("{}use a11", doubled(11, moved))),
        ("11 doublings under a twist", format!("{}twist axis z rate 1 {{ use a11 }}", doubled(11, moved))),
        ("7 doublings of twists", format!("{}use a7", doubled(7, warped))),
        ("11 doublings of twists", format!("{}use a11", doubled(11, warped))),
        ("100 sines in each other", format!("expression {{ {}x{} }}", "sin(".repeat(100), ")".repeat(100))),
        (
            "2,000 sines in each other",
            format!("expression {{ {}x{} }}", "sin(".repeat(2000), ")".repeat(2000)),
        ),
        ("a sum of 1,000 sines", terms(1000, |at| format!("sin({at}*x)"))),
        ("a sum of 10,000 sines", terms(10_000, |at| format!("sin({at}*x)"))),
        ("a polynomial of 1,000 terms", terms(1000, |at| format!("{at}*x^{}*y^{}", at % 9, at % 5))),
        ("a sum of 40,000 products", terms(40_000, |at| format!("{at}*y"))),
        ("a product of 3,000 sums", format!("expression {{ {} }}", vec!["(x+y*z)"; 3000].join("*"))),
        (
            "a minimum of 3,000",
            format!("expression {{ {}x{} }}", "min(y*z, ".repeat(3000), "+0.5)".repeat(3000)),
        ),
        ("4,000 logarithms of sines", terms(4000, |at| format!("ln(sin({at}*x))"))),
        (
            "a polyline of 20,000",
            format!(
                "polyline {{ points ({}) radius 1 }}",
                (0..20_000).map(|at| format!("({at} {} 0) ", at % 7)).collect::<String>()
            ),
        ),
    ]
}

/// Times of stages, in order.
#[derive(Clone, Default)]
struct Times(Vec<(&'static str, Duration)>);

impl Times {
    fn time<T>(&mut self, stage: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let answer = work();
        self.0.push((stage, start.elapsed()));
        answer
    }

    fn total(&self) -> Duration {
        self.0.iter().map(|(_, took)| *took).sum()
    }
}

/// What became of a program.
struct ProgramCost {
    times: Times,
    /// Values of the longest function, and rows.
    units: usize,
    end: String,
}

fn is_long(function: &Function) -> bool {
    function.values.len() > limits::MAX_VALUES
}

/// The programs of a model: for its field, for all answers, for ranges.
const PROGRAMS: [(&str, Purpose); 3] = [
    ("field", Purpose::Answers(Query::FIELD)),
    ("all", Purpose::Answers(Query::ALL)),
    ("ranges", Purpose::Ranges),
];

fn program(text: &str, purpose: Purpose, level: Level) -> ProgramCost {
    let mut times = Times::default();
    let refused = |times, stage: &str, units| ProgramCost { times, units, end: format!("refused: {stage}") };
    let read = times.time("read", || jbt::text::parse(text.as_bytes(), &jbt::text::Options::default()));
    let model = read.unwrap_or_else(|error| panic!("what is measured reads: {error}"));
    let Ok(tree) = times.time("check", || model.check()) else { return refused(times, "check", 0) };
    let lowering = times.time("shapes", || Lowering::new(&tree));
    let lowered = times.time("lower", || match purpose {
        Purpose::Answers(query) => lowering.answers(query).map(|lowered| (lowered.function, lowered.tables)),
        Purpose::FiniteGradient | Purpose::Ranges | Purpose::RowRanges => {
            lowering.ranges().map(|ranges| (ranges.function, ranges.tables))
        }
    });
    let Ok((mut function, tables)) = lowered else { return refused(times, "lower", limits::MAX_VALUES) };
    let rows = |tables: &Tables| tables.tables.values().map(|rows| rows.count).sum::<usize>();
    let rows = rows(&tables);
    let mut units = function.values.len() + rows;
    for pass in passes(purpose) {
        let before = function;
        function = times.time(pass.name, || run_pipeline(before, [pass], &mut |_, _| {}));
        units = units.max(function.values.len() + rows);
        if is_long(&function) {
            return refused(times, pass.name, units);
        }
    }
    let verified = times.time("verify", || verify(function)).expect("passes keep the rules");
    let verified = Arc::new(verified);
    let backend = choose(Engine::Jit.backends(), level).expect("machine code is built in");
    let end = match times.time("code", || backend.compile(&verified, level)) {
        Ok(_) => "code".to_owned(),
        Err(_) => {
            let lanes = choose(Engine::Lanes.backends(), level).expect("the interpreter is built in");
            times.time("tape", || lanes.compile(&verified, level)).expect("the interpreter takes all");
            "tape".to_owned()
        }
    };
    ProgramCost { times, units, end }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let part = arguments.next().unwrap_or_default();
    let level = arguments.next().map_or_else(Level::best, |name| name.parse().expect("a level"));
    println!("{:30} {:7} {:>9} {:>9} {:>9}  stages in ms", "model", "program", "units", "ms", "us/unit");
    for (name, text) in models().into_iter().filter(|(name, _)| name.contains(&part)) {
        let text = format!("jbt 1\n{text}\n");
        for (what, purpose) in PROGRAMS {
            let runs = (0..RUNS).map(|_| program(&text, purpose, level));
            let ProgramCost { times, units, end } =
                runs.min_by_key(|run| run.times.total()).expect("there are several runs");
            let total = times.total().as_secs_f64() * 1e6;
            let each = (total - FREE).max(0.0) / units.max(1) as f64;
            let mark = if each > MOST { "!" } else { "" };
            let mut stages = String::new();
            for (stage, took) in &times.0 {
                let took = took.as_secs_f64() * 1e6;
                if took > 0.05 * total {
                    let _ = write!(stages, "{stage} {:.2}, ", took / 1e3);
                }
            }
            println!("{name:30} {what:7} {units:9} {:9.2} {each:8.2}{mark:1}  {stages}{end}", total / 1e3);
        }
    }
}
