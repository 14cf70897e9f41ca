//! Random models by their seeds, through a target: `models TARGET FIRST COUNT [RECORD]`.
//!
//! With a record it goes on behind the last seed that the record has. A model that does not hold ends it, and
//! its seed is said: `models TARGET SEED 1` runs it again.

#![allow(clippy::print_stdout, reason = "it says what it has done")]

use std::fs::OpenOptions;
use std::io::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Seeds of one line of a record.
const CHUNK: u64 = 500;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (name, first, count, record) = match &words[..] {
        [name, first, count] => (name, first.parse()?, count.parse::<u64>()?, None),
        [name, first, count, record] => (name, first.parse()?, count.parse()?, Some(record)),
        _ => return Err("usage: models TARGET FIRST COUNT [RECORD]".into()),
    };
    let end = first + count;
    let done = record.and_then(|path| std::fs::read_to_string(path).ok()).unwrap_or_default();
    // A line: target, first seed, seed behind the last one, seconds.
    let mut from: u64 = first;
    for line in done.lines().filter(|line| line.starts_with(&format!("{name},"))) {
        from = from.max(line.split(',').nth(2).ok_or("the record has a bad line")?.parse()?);
    }
    while from < end {
        let to = end.min(from + CHUNK);
        let begin = Instant::now();
        chunk(name, from, to)?;
        let took = begin.elapsed();
        println!("{name}: seeds {from} to {to} hold, {took:.0?}");
        if let Some(path) = record {
            let mut file = OpenOptions::new().create(true).append(true).open(path)?;
            writeln!(file, "{name},{from},{to},{:.1}", took.as_secs_f64())?;
        }
        from = to;
    }
    Ok(())
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
                    let bytes: Vec<u8> = (0..18).map(|_| rng.u8(..)).collect();
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
