//! `rows`: seconds and memory from numbers to compiled rows, by number of particles.
//!
//! ```text
//! cargo run --release -p jbt-benches --bin rows [-- LARGEST]
//! ```
//!
//! The same coloured particles as a sum of nodes, as arrays, and as a file of numpy of their places (f32,
//! three numbers each) that is in memory. Each row is a process of its own, whose peak of memory (`VmHWM`,
//! Linux) it tells: arrays and files count. Told are a checked model; with it the rows of its field, as an
//! evaluator has them; and all that a mesh asks for instead: ranges, supports, and the rows of all answers.
//! LARGEST is the largest number of particles, 10,000,000 as a rule; of nodes there are a tenth of it.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a program")]

use std::process::{Command, ExitCode};
use std::time::Instant;

use jbt::import::particles::ParticleOptions;
use jbt::sample::Sampler;
use jbt::{CheckedTree, Compiler, Query, SceneFormat, text};
use jbt_benches::memory::peak;
use jbt_benches::model::{Blob, cloud, particles, tree};

/// The largest number of particles, unless another one is asked for.
const LARGEST: usize = 10_000_000;
/// Runs of which the fastest counts.
const RUNS: usize = 3;

/// What is read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ParticleInput {
    Nodes,
    Arrays,
    Numpy,
}

impl ParticleInput {
    const ALL: [(Self, &'static str); 3] =
        [(Self::Nodes, "nodes"), (Self::Arrays, "arrays"), (Self::Numpy, "npy")];
}

/// The file of these places, as numpy writes it.
fn numpy(blobs: &[Blob]) -> Vec<u8> {
    let count = blobs.len();
    let dict = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({count}, 3), }}");
    let length = (10 + dict.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{dict:<width$}\n", width = length - 1).bytes());
    bytes.reserve_exact(12 * count);
    bytes.extend(blobs.iter().flat_map(|blob| blob.center).flat_map(f32::to_le_bytes));
    bytes
}

/// Makes rows in this process, and prints the row of the table.
fn run(given: ParticleInput, name: &str, count: usize) {
    let blobs = particles(count, 1);
    let count = blobs.len();
    let radius = f64::from(blobs[0].radius);
    let particles = ParticleOptions { radius: Some(radius / 2.0), ..ParticleOptions::default() };
    let options = text::Options { particles, ..text::Options::default() };
    let mut blobs = blobs;
    let mut file = Vec::new();
    if given == ParticleInput::Numpy {
        file = numpy(&blobs);
        blobs = Vec::new();
    }
    let checked = || -> CheckedTree {
        match given {
            ParticleInput::Nodes => tree(&blobs),
            ParticleInput::Arrays => cloud(&blobs),
            ParticleInput::Numpy => {
                let read = SceneFormat::Npy.read("places.npy", &file, &options).expect("it is a good file");
                read.model.check().expect("particles are a good model")
            }
        }
    };
    let mut best = [f64::INFINITY; 3];
    let mut memory = [None; 2];
    for part in 0..2 {
        for _ in 0..RUNS {
            let begin = Instant::now();
            let tree = checked();
            best[0] = best[0].min(begin.elapsed().as_secs_f64());
            let compiler = Compiler::new();
            let made: Box<dyn std::any::Any> = match part {
                0 => Box::new(compiler.evaluator(&tree, Query::FIELD).expect("it compiles")),
                _ => Box::new(Sampler::new(&compiler, &tree, Query::ALL).expect("it compiles")),
            };
            best[part + 1] = best[part + 1].min(begin.elapsed().as_secs_f64());
            drop(made);
        }
        memory[part] = peak();
    }
    let [one, all] =
        memory.map(|bytes| bytes.map_or_else(|| "?".to_owned(), |it| format!("{:.0}", it as f64 / 1e6)));
    let [model, rows, mesh] = best;
    println!("| {name} | {count} | {model:.3} | {rows:.3} | {one} | {mesh:.3} | {all} |");
}

/// Runs each row in a process of its own.
fn table(largest: usize) -> std::io::Result<ExitCode> {
    println!(
        "| given | particles | seconds to a checked model | to rows | peak MB | to all for a mesh | peak MB |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|");
    let counts = [largest / 100, largest / 10, largest];
    for (given, name) in ParticleInput::ALL {
        for count in counts.into_iter().filter(|&count| given != ParticleInput::Nodes || count < largest) {
            let status = Command::new(std::env::current_exe()?).args([name, &count.to_string()]).status()?;
            if !status.success() {
                eprintln!("{name} of {count}: {status}");
                return Ok(ExitCode::FAILURE);
            }
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let number =
        |text: &str| text.replace(',', "").parse().ok().filter(|count| (1_000..=100_000_000).contains(count));
    let largest = match words.as_slice() {
        [given, count] => {
            let given = ParticleInput::ALL.into_iter().find(|(_, name)| name == given);
            if let (Some((given, name)), Some(count)) = (given, number(count)) {
                run(given, name, count);
                return ExitCode::SUCCESS;
            }
            None
        }
        [largest] => number(largest),
        [] => Some(LARGEST),
        _ => None,
    };
    let Some(largest) = largest else {
        eprintln!("usage: rows [LARGEST], or rows nodes|arrays|npy COUNT, from 1,000 to 100,000,000");
        return ExitCode::from(2);
    };
    table(largest).unwrap_or_else(|error| {
        eprintln!("{error}");
        ExitCode::FAILURE
    })
}
