//! A contour in a quadtree, in two modes: the published algorithm, which decides by samples, and jbt's
//! division, which decides by ranges.
//!
//! ```text
//! cargo run --release -p jbt --example quadtree -- [--svg FILE]
//! ```
//!
//! The scene is twenty soft circles in a square; the contour is where their fields sum to 1/2. It crosses
//! 1,534 of the 256 x 256 cells. The published algorithm misses two of them. The example prints what either
//! mode finds and what that takes, and with `--svg` draws them side by side: circles' radii in red, cells of
//! the contour in green, blocks in grey.
//!
//! A level of the quadtree is two halvings of the division, which makes 16 of its depths 8 of the other's.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example prints")]

#[path = "quadtree/circles.rs"]
mod circles;
#[path = "quadtree/divided.rs"]
mod divided;
#[path = "quadtree/lattice.rs"]
mod lattice;
#[path = "quadtree/picture.rs"]
mod picture;
#[path = "quadtree/published.rs"]
mod published;

use std::error::Error;
use std::process::ExitCode;

use jbt::Compiler;

use circles::CIRCLES;
use divided::Divided;
use picture::{Panel, svg};
use published::Published;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let file = match &arguments[..] {
        [] => None,
        [option, file] if option == "--svg" => Some(file),
        _ => {
            eprintln!("usage: quadtree [--svg FILE]");
            return ExitCode::from(2);
        }
    };
    match run(file.map(String::as_str)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("quadtree: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(file: Option<&str>) -> Result<(), Box<dyn Error>> {
    let published = published::run(&CIRCLES);
    let divided = divided::run(&Compiler::new(), &CIRCLES)?;
    print_counts(&published, &divided);
    if let Some(file) = file {
        let panels = [
            Panel {
                blocks: published.nodes.iter().map(|node| node.square).collect(),
                cells: published.leaves().map(|node| node.square.low).collect(),
            },
            Panel { blocks: divided.blocks, cells: divided.found },
        ];
        std::fs::write(file, svg(&CIRCLES, &panels))?;
    }
    Ok(())
}

fn print_counts(published: &Published, divided: &Divided) {
    let count = |length: usize| Some(length as u64);
    let rows = [
        ("crossing cells found", count(published.leaves().count()), count(divided.found.len())),
        ("crossing cells missed", count(published.missed.len()), count(divided.missed.len())),
        ("smallest squares", count(published.leaves().count()), count(divided.leaves)),
        ("nodes created, without the root", count(published.created), count(divided.decided - 1)),
        ("nodes after pruning, with the root", count(published.nodes.len()), None),
        ("greatest depth", Some(published.depth().into()), Some(divided.depth)),
        ("lookups of a point", Some(published.lookups), None),
        ("points reused", Some(published.reused()), None),
        ("points evaluated", Some(published.evaluated), Some(divided.evaluated)),
        ("circle evaluations", Some(published.circle_evaluations), Some(divided.circle_evaluations)),
        ("blocks whose range was computed", None, Some(divided.ranges)),
        ("circle-interval evaluations", None, Some(divided.interval_evaluations)),
    ];
    let text = |count: Option<u64>| count.map_or("-".to_owned(), |count| count.to_string());
    println!("{:36}{:>11}{:>11}", "", "published", "divided");
    for (what, published, divided) in rows {
        println!("{what:36}{:>11}{:>11}", text(published), text(divided));
    }
}
