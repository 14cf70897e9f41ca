//! `scale`: seconds and memory of meshes, by number of blobs and by size of the lattice.
//!
//! ```text
//! cargo run --release -p jbt-benches --bin scale [-- LARGEST]
//! ```
//!
//! Blobs overlap alike at any number, and there are two cells between neighbours, so the surface grows with
//! their number. LARGEST is the largest number of blobs, 1,000,000 as a rule, which takes 1 GB. Each row
//! is a process of its own, whose peak of memory (`VmHWM`, Linux) it tells. Everything from the blobs on
//! counts: tree, check, code, mesh with normals and colours.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "it is a program")]

use std::process::{Command, ExitCode};
use std::time::Instant;

use jbt::{Box3, Compiler, Fineness, Polygonize};
use jbt_benches::memory::peak;
use jbt_benches::model::{Blob, blobs, cloud};

/// The largest number of blobs, unless another one is asked for.
const LARGEST: usize = 1_000_000;
/// Blobs of the small model in large lattices, and how much of the lattice's edge they take.
const SMALL: (usize, f32) = (64, 1.0 / 32.0);
/// Cells along an axis of those lattices.
const LATTICES: [usize; 5] = [256, 512, 1024, 2048, 4096];
/// Runs of which the fastest counts; fewer, once they have taken [`SECONDS`].
const RUNS: usize = 5;
/// See [`RUNS`].
const SECONDS: f64 = 5.0;

/// What is meshed over [-1, 1]^3.
#[derive(Clone, Copy)]
struct Row {
    blobs: usize,
    /// The edge of the cube that holds them, of the lattice's.
    share: f32,
    cells: usize,
    threads: usize,
}

impl Row {
    /// Two cells between neighbours.
    fn of_blobs(blobs: usize, threads: usize) -> Self {
        Self { blobs, share: 1.0, cells: (2.0 * (blobs as f64).cbrt() / 0.9).round() as usize, threads }
    }

    fn of_lattice(cells: usize, threads: usize) -> Self {
        Self { blobs: SMALL.0, share: SMALL.1, cells, threads }
    }

    fn words(self) -> [String; 4] {
        [self.blobs.to_string(), self.share.to_string(), self.cells.to_string(), self.threads.to_string()]
    }

    fn from_words(words: &[String]) -> Option<Self> {
        let [blobs, share, cells, threads] = words else { return None };
        Some(Self {
            blobs: blobs.parse().ok()?,
            share: share.parse().ok()?,
            cells: cells.parse().ok()?,
            threads: threads.parse().ok()?,
        })
    }

    /// Meshes in this process, and prints the row of the table.
    fn run(self) {
        let shrunk = |blob: Blob| Blob {
            center: blob.center.map(|place| self.share * place),
            radius: self.share * blob.radius,
            ..blob
        };
        let blobs: Vec<Blob> = blobs(self.blobs, 1).into_iter().map(shrunk).collect();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build();
        let pool = pool.expect("threads can be made");
        let polygonize = Polygonize {
            region: Some(Box3::new([-1.0; 3], [1.0; 3])),
            fineness: Fineness::Resolution(self.cells),
            verify: false,
            thin_parts: false,
            sharp: true,
        };
        let (mut best, mut spent, mut triangles) = (f64::INFINITY, 0.0, 0);
        for _ in 0..RUNS {
            let begin = Instant::now();
            let made = pool.install(|| polygonize.mesh(&Compiler::new(), &cloud(&blobs)).run());
            let seconds = begin.elapsed().as_secs_f64();
            (best, spent) = (best.min(seconds), spent + seconds);
            triangles = made.expect("blobs have a mesh").mesh.triangles.len();
            if spent > SECONDS {
                break;
            }
        }
        println!(
            "| {} | {}^3 | {} | {triangles} | {best:.4} | {:.1} | {} |",
            self.blobs,
            self.cells + 1,
            self.threads,
            best * 1e9 / triangles as f64,
            peak().map_or_else(|| "?".to_owned(), |bytes| format!("{:.0}", bytes as f64 / 1e6)),
        );
    }
}

/// Runs each row in a process of its own.
fn table(largest: usize) -> std::io::Result<ExitCode> {
    println!("| blobs | lattice | threads | triangles | seconds | ns a triangle | peak MB |");
    println!("|---:|---:|---:|---:|---:|---:|---:|");
    let counts = (3..).map(|power| 10_usize.pow(power)).take_while(|&count| count <= largest);
    let blobs = counts.flat_map(|count| [1, 2].map(|threads| Row::of_blobs(count, threads)));
    let lattices = LATTICES.iter().flat_map(|&cells| [1, 2].map(|threads| Row::of_lattice(cells, threads)));
    for row in blobs.chain(lattices) {
        let status = Command::new(std::env::current_exe()?).args(row.words()).status()?;
        if !status.success() {
            eprintln!("{:?}: {status}", row.words());
            return Ok(ExitCode::FAILURE);
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let Some(row) = Row::from_words(&words) {
        row.run();
        return ExitCode::SUCCESS;
    }
    let largest = match words.as_slice() {
        [] => Some(LARGEST),
        [largest] => {
            largest.replace(',', "").parse().ok().filter(|largest| (1_000..=10_000_000).contains(largest))
        }
        _ => None,
    };
    let Some(largest) = largest else {
        eprintln!("usage: scale [LARGEST], a number of blobs from 1,000 to 10,000,000");
        return ExitCode::from(2);
    };
    table(largest).unwrap_or_else(|error| {
        eprintln!("{error}");
        ExitCode::FAILURE
    })
}
