//! `files`: seconds and memory for large files of other programs.
//!
//! ```text
//! cargo run --release -p jbt-benches --bin files
//! ```
//!
//! A structure of a molecule of 52 MB, to the rows of its field; and two databases of 8,000 solids, one of
//! 1,000 parts, the other of one part that is used 1,000 times, to a mesh over 128 cells along the longest
//! side. Files are in memory. Each row is a process of its own, whose peak of memory (`VmHWM`, Linux) it tells,
//! with the file. (`rows` does it for an array of numpy.)
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a program")]

use std::process::{Command, ExitCode};
use std::time::Instant;

use jbt::{Compiler, Fineness, Polygonize, Query, Scene};
use jbt_benches::files::{database, structure};
use jbt_benches::memory::peak;

/// Atoms of the structure.
const ATOMS: usize = 640_000;
/// Cells of a mesh along its longest side.
const CELLS: usize = 128;
/// Runs of which the fastest counts.
const RUNS: usize = 3;

/// A file by its row's name, and how it is called.
fn file(name: &str) -> Option<(Vec<u8>, &'static str)> {
    match name {
        "structure" => Some((structure(ATOMS), "structure.pdb")),
        "parts" => Some((database(false), "parts.asc")),
        "part" => Some((database(true), "part.asc")),
        _ => None,
    }
}

/// Reads a file in this process, makes rows or a mesh of it, and prints the row of the table.
fn run(name: &str) -> Option<()> {
    let (bytes, path) = file(name)?;
    let mut best = [f64::INFINITY; 2];
    let mut made = String::new();
    for _ in 0..RUNS {
        let begin = Instant::now();
        let tree = Scene::from_bytes(path, &bytes).expect("it is a good file").check().expect("a good model");
        best[0] = best[0].min(begin.elapsed().as_secs_f64());
        let compiler = Compiler::new();
        if name == "structure" {
            let evaluator = compiler.evaluator(&tree, Query::FIELD).expect("it compiles");
            best[1] = best[1].min(begin.elapsed().as_secs_f64());
            made = format!("{ATOMS} rows");
            drop(evaluator);
        } else {
            let polygonize = Polygonize { fineness: Fineness::Resolution(CELLS), ..Polygonize::default() };
            let mesh = polygonize.mesh(&compiler, &tree).run().expect("it has a mesh").mesh;
            best[1] = best[1].min(begin.elapsed().as_secs_f64());
            made = format!("{} triangles", mesh.triangles.len());
        }
    }
    let memory = peak().map_or_else(|| "?".to_owned(), |bytes| format!("{:.0}", bytes as f64 / 1e6));
    let [model, rest] = best;
    println!("| {path} | {:.1} | {model:.3} | {rest:.3} | {made} | {memory} |", bytes.len() as f64 / 1e6);
    Some(())
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let [name] = words.as_slice()
        && run(name).is_some()
    {
        return ExitCode::SUCCESS;
    }
    if !words.is_empty() {
        eprintln!("usage: files, or files structure|parts|part");
        return ExitCode::from(2);
    }
    println!("| file | MB | seconds to a checked model | to the end | of | peak MB |");
    println!("|---|---:|---:|---:|---:|---:|");
    for name in ["structure", "parts", "part"] {
        let ran = std::env::current_exe().and_then(|program| Command::new(program).arg(name).status());
        match ran {
            Ok(status) if status.success() => {}
            Ok(status) => {
                eprintln!("{name}: {status}");
                return ExitCode::FAILURE;
            }
            Err(error) => {
                eprintln!("{error}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}
