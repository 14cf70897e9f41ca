//! `compare`: ours against the physical limit and other people's libraries, in one run.
//!
//! ```text
//! cargo run --release -p jbt-benches --features peers --bin compare -- [CASE ...] [--json] [--quick] [--threads N] [--level L]
//! ```
//!
//! Everybody is built alike, with the workspace's `[profile.release]`: `opt-level = 3`, `codegen-units = 1`,
//! no link-time optimisation, for any CPU of the architecture. Vector instructions beyond that are chosen
//! when the program runs, by those who can.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a program")]

use std::process::{Command, ExitCode};

use clap::Parser;
use jbt::level::{Level, VARIABLE};
use jbt_benches::compare::{Case, Options, heading, line};

/// Times the compiler, the hand-written limit and the peers on the same work, one after the other, and prints
/// the medians.
#[derive(Parser, Debug)]
#[command(after_help = after_help())]
struct Arguments {
    /// Cases to run; all of them if none is named
    #[arg(value_name = "CASE")]
    cases: Vec<String>,

    /// One JSON object per line
    #[arg(long)]
    json: bool,

    /// Less of everything: two minutes for all cases. What takes more than 5 s runs once, ours and the limit
    /// too; mesh-4096 without the peers, fidget's other meshes by its fastest formulation alone
    #[arg(long)]
    quick: bool,

    /// Threads of the cases that mesh; all others run on one, but for those that say two
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,

    /// The largest instruction set of ours and of the limit: baseline, avx2, avx512vl or avx512 [default: the
    /// best that this CPU has, or JBT_LEVEL]. Peers take what they like
    #[arg(long)]
    level: Option<Level>,
}

/// What keeps freed memory with the process, as other allocators and programs that mesh again and again have
/// it. By itself glibc gives it back, and takes it again page by page, or does not: by what has been freed
/// before, in whose turn, on which thread. That is a quarter of the time of a mesh, and by luck.
const KEPT: [(&str, &str); 3] = [
    ("MALLOC_TRIM_THRESHOLD_", "1000000000"),
    ("MALLOC_MMAP_THRESHOLD_", "33554432"),
    // Not only room on top: a heap of a thread goes back to the system unless the one before has less room.
    ("MALLOC_TOP_PAD_", "134217728"),
];

/// The variables that this program wants and does not have.
fn wanted(level: Option<Level>) -> Result<Vec<(&'static str, &'static str)>, String> {
    let mut wanted = Vec::new();
    if cfg!(all(target_os = "linux", target_env = "gnu")) {
        wanted.extend(KEPT.iter().filter(|(name, _)| std::env::var_os(name).is_none()));
    }
    if let Some(level) = level.filter(|&level| Level::allowed() != Some(level)) {
        if !level.is_available() {
            let available: Vec<&str> = Level::available().into_iter().map(Level::name).collect();
            return Err(format!("this CPU has no level {level}; it has {}", available.join(", ")));
        }
        wanted.push((VARIABLE, level.name()));
    }
    Ok(wanted)
}

/// Runs this program again, with some variables for everything in it.
fn again(variables: Vec<(&'static str, &'static str)>) -> Result<ExitCode, String> {
    let failed = |error: std::io::Error| format!("cannot run again with {variables:?}: {error}");
    let program = std::env::current_exe().map_err(failed)?;
    let arguments = std::env::args_os().skip(1);
    let status = Command::new(program).args(arguments).envs(variables.iter().copied()).status();
    let code = status.map_err(failed)?.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

fn after_help() -> String {
    format!(
        "Cases:\n{}\n\
Every contestant is checked against the f64 oracle before any time is reported; who disagrees is named under `check` and has no time.
Times are medians: of at least 5 runs for ours and for the limit, of 1 run for others that take more than 2 s. With --quick, others run
once if they take more than 0.04 s, and all do if they take more than 5 s.

Keys of --json: case, what (it measures), of (which of its works, if there are several), primitives, points, unit (what the times are of), and for each contestant NAME_ns and, where it has several
forms, NAME_form, the fastest. NAME is one of:
  ours        the compiler, on its best engine (key engine); the lanes interpreter for the case interpreter
  limit       hand-written loops for sums of points (key limit_level: their instruction set, which --level bounds too)
  searched    the compiler, with the search for parts that its mesh misses
  whole       the compiler, everything made anew after an edit but the code
  one_thread  the compiler on one thread, where ours has several
  apart       the same work on each of these threads at once, with one thread each
  lanes       the lanes interpreter, beside ours where both take part
  fidget_jit  fidget's machine code          fidget_vm  its interpreter
  splashsurf  another surface of the same particles
  walk        a tree walker                  separate   a walk for each answer; gradients by differences
ratio_limit is ours / limit, ratio_fidget is fidget / ours, ratio_threads is one_thread / ours, medians over rounds in which both ran;
ratio_machine is one_thread / apart times the threads: how many times as fast threads that wait for nobody are, on this machine;
checksum is ok, or says who disagrees. Cases that mesh have threads and triangles, too; pictures have frame_ms, the part that finds the camera; the train has evaluations_per_second, and what its authors published. Its scene and the programs are not bundled:
the environment variable JBT_SAMPLES names a folder that has them as parsip/train_corrected.scene and vm/*.vm.

All are built alike: opt-level 3, one codegen unit for each crate, no link-time optimisation, for any CPU of the architecture.
Memory that is freed stays with the process, where glibc's allocator is used: everybody finds warm pages. MALLOC_TRIM_THRESHOLD_,
MALLOC_MMAP_THRESHOLD_ and MALLOC_TOP_PAD_ may say otherwise.

Exit codes: 0 fine, 1 somebody disagrees or a scene is missing, 2 usage.",
        list()
    )
}

fn list() -> String {
    Case::ALL.iter().map(|case| format!("  {:<16}{}\n", case.name, case.what)).collect()
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let done = wanted(arguments.level)
        .and_then(|variables| if variables.is_empty() { Ok(None) } else { again(variables).map(Some) });
    match done {
        Ok(None) => {}
        Ok(Some(code)) => return code,
        Err(message) => {
            eprintln!("error: {message}");
            return ExitCode::from(2);
        }
    }
    let mut cases = Vec::new();
    for name in &arguments.cases {
        match Case::named(name) {
            Some(case) => cases.push(case),
            None => {
                eprintln!("error: there is no case `{}`; the cases are:\n{}", name.escape_debug(), list());
                return ExitCode::from(2);
            }
        }
    }
    if cases.is_empty() {
        cases.extend(Case::ALL);
    }
    let options = Options { quick: arguments.quick, threads: usize::from(arguments.threads) };
    if !arguments.json {
        println!("{}", heading());
    }
    let mut fine = true;
    let rows = |case: &'static Case| case.run(options).into_iter().map(move |row| (case, row));
    for (case, row) in cases.into_iter().flat_map(rows) {
        fine &= row.checksum() == "ok";
        if arguments.json {
            println!("{}", row.json(case.what));
        } else {
            println!("{}", line(&row));
        }
    }
    if fine { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
