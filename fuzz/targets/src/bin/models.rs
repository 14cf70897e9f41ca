//! Random models by their seeds, through a target: `models TARGET FIRST COUNT [RECORD]`.
//!
//! With a record, a CSV file, it goes on behind the last seed that the record has. A model that does not hold
//! ends it, and its seed is said: `models TARGET SEED 1` runs it again. Most models are of few nodes: errors
//! of engines show in small models, and many of those take the time of a large one.

#![allow(clippy::print_stdout, reason = "it says what it has done")]

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use jbt_targets::commit;

/// Seeds of one line of a record.
const CHUNK: u64 = 500;
/// The byte that says how many nodes a model has, less than this many.
const SIZE: usize = 16;
const MAX_SIZE: u8 = 24;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (name, first, count, record) = match &words[..] {
        [name, first, count] => (name, first.parse()?, count.parse::<u64>()?, None),
        [name, first, count, record] => (name, first.parse()?, count.parse()?, Some(record)),
        _ => return Err("usage: models TARGET FIRST COUNT [RECORD]".into()),
    };
    let end = first + count;
    let mut done = record.map_or_else(|| Ok(Vec::new()), |path| read(path))?;
    let mut from = done.iter().filter(|row| row.target == *name).map(|row| row.end).fold(first, u64::max);
    let commit = commit();
    while from < end {
        let to = end.min(from + CHUNK);
        let begin = Instant::now();
        chunk(name, from, to)?;
        let took = begin.elapsed();
        println!("{name}: seeds {from} to {to} hold, {took:.0?}");
        if let Some(path) = record {
            add(
                &mut done,
                SeedRange {
                    target: name.clone(),
                    first: from,
                    end: to,
                    seconds: took.as_secs_f64(),
                    commit: commit.clone(),
                },
            );
            write(path, &done)?;
        }
        from = to;
    }
    Ok(())
}

/// Seeds that hold: from the first one to the one behind the last.
struct SeedRange {
    target: String,
    first: u64,
    end: u64,
    seconds: f64,
    commit: String,
}

const COLUMNS: &str = "target,first,end,seconds,commit";

/// The rows of a record; none if there is no such file.
fn read(path: &str) -> Result<Vec<SeedRange>, Box<dyn std::error::Error>> {
    let Ok(text) = fs::read_to_string(path) else { return Ok(Vec::new()) };
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let [target, first, end, seconds, commit] = cells[..] else {
            return Err(format!("{path}: this is no row: {line}").into());
        };
        let (target, commit) = (target.to_owned(), commit.to_owned());
        Ok(SeedRange { target, first: first.parse()?, end: end.parse()?, seconds: seconds.parse()?, commit })
    };
    text.lines().skip(1).map(row).collect()
}

/// Writes the rows, in place of the file.
fn write(path: &str, rows: &[SeedRange]) -> std::io::Result<()> {
    let mut text = format!("{COLUMNS}\n");
    for SeedRange { target, first, end, seconds, commit } in rows {
        text += &format!("{target},{first},{end},{seconds:.1},{commit}\n");
    }
    let new = format!("{path}.new");
    fs::write(&new, text)?;
    fs::rename(&new, path)
}

/// A row more, or a longer one.
fn add(rows: &mut Vec<SeedRange>, next: SeedRange) {
    let goes_on = |row: &&mut SeedRange| {
        row.target == next.target && row.commit == next.commit && row.end == next.first
    };
    match rows.iter_mut().find(goes_on) {
        Some(row) => (row.end, row.seconds) = (next.end, row.seconds + next.seconds),
        None => rows.push(next),
    }
}

/// The seeds on all threads.
fn chunk(name: &str, from: u64, to: u64) -> Result<(), String> {
    let (next, failed) = (AtomicU64::new(from), AtomicU64::new(u64::MAX));
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                let target = jbt_targets::target(name);
                while failed.load(Ordering::Relaxed) == u64::MAX {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= to {
                        break;
                    }
                    let mut rng = fastrand::Rng::with_seed(seed);
                    let mut bytes: Vec<u8> = (0..18).map(|_| rng.u8(..)).collect();
                    bytes[SIZE] = (0..3).map(|_| rng.u8(0..MAX_SIZE)).min().unwrap_or(0);
                    if catch_unwind(AssertUnwindSafe(|| target.run(&bytes))).is_err() {
                        failed.fetch_min(seed, Ordering::Relaxed);
                    }
                }
            });
        }
    });
    match failed.into_inner() {
        u64::MAX => Ok(()),
        seed => Err(format!("{name}: seed {seed} does not hold")),
    }
}
