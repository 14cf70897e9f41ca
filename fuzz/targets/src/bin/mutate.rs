//! Fuzzing without coverage, on any Rust: `mutate FOLDER SECONDS [TARGET ..]` changes the seeds that
//! `seeds FOLDER` wrote, at random, and runs each target for so long.
//!
//! An input that fails, or that takes longer than ten seconds, is written to `FOLDER/../artifacts/<target>/`.
//! `FOLDER/mutated.csv` gets a line for each target: its name, seconds, executions, failures, the seed.

#![allow(clippy::print_stdout, reason = "it says what it has done")]

use std::collections::BTreeSet;
use std::fs::{self, OpenOptions};
use std::io::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use fastrand::Rng;
use jbt_targets::{FuzzTarget, target, targets};

/// What one input may take.
const LONGEST: Duration = Duration::from_secs(10);
/// The longest input.
const MAX_BYTES: usize = 8 << 10;
/// Failures after which a target is left.
const MAX_FAILURES: usize = 5;

/// What a thread is running: since when, for which target.
type RunningInput = Mutex<Option<(Instant, String, Vec<u8>)>>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [folder, seconds, names @ ..] = &words[..] else {
        return Err("usage: mutate FOLDER SECONDS [TARGET ..]".into());
    };
    let (folder, lasts) = (PathBuf::from(folder), Duration::from_secs_f64(seconds.parse()?));
    let all: Vec<String> = targets().into_iter().map(|target| target.name).collect();
    let wanted: Vec<String> = if names.is_empty() { all } else { names.to_vec() };
    let (next, failures) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let running: Vec<RunningInput> = (0..threads).map(|_| Mutex::new(None)).collect();
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let workers: Vec<_> = running
            .iter()
            .map(|running| {
                scope.spawn(|| {
                    while let Some(name) = wanted.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let failed = fuzz(&target(name), &folder, lasts, running);
                        failures.fetch_add(failed, Ordering::Relaxed);
                    }
                })
            })
            .collect();
        scope.spawn(|| watch(&running, &folder, &is_over));
        workers.into_iter().for_each(|worker| worker.join().expect("failures are caught"));
        is_over.store(true, Ordering::Relaxed);
    });
    match failures.into_inner() {
        0 => Ok(()),
        failed => Err(format!("{failed} inputs failed").into()),
    }
}

/// Ends the process at an input that does not end.
fn watch(running: &[RunningInput], folder: &Path, is_over: &AtomicBool) {
    while !is_over.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(200));
        for one in running {
            let one = one.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            if let Some((since, name, bytes)) = &*one
                && since.elapsed() > LONGEST
            {
                println!(
                    "{name}: {} takes longer than {LONGEST:?}",
                    save(folder, name, "slow", bytes).display()
                );
                std::process::exit(1);
            }
        }
    }
}

/// Runs a target on changed seeds. How many inputs failed.
fn fuzz(target: &FuzzTarget, folder: &Path, lasts: Duration, running: &RunningInput) -> usize {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64);
    let mut rng = Rng::with_seed(now);
    let inputs: Vec<Vec<u8>> = fs::read_dir(folder.join(&target.name))
        .into_iter()
        .flatten()
        .filter_map(|entry| fs::read(entry.ok()?.path()).ok())
        .collect();
    let words = fs::read_to_string(folder.join(format!("{}.dict", target.name))).unwrap_or_default();
    let words: Vec<&[u8]> = words.lines().map(|line| line.trim_matches('"').as_bytes()).collect();
    assert!(!inputs.is_empty() && !words.is_empty(), "`seeds` has not run for {}", target.name);
    let (begin, mut executions, mut failures) = (Instant::now(), 0_u64, BTreeSet::new());
    while begin.elapsed() < lasts && failures.len() < MAX_FAILURES {
        let bytes = mutated(&mut rng, &inputs, &words);
        *running.lock().expect("nobody panics with it") =
            Some((Instant::now(), target.name.clone(), bytes.clone()));
        let outcome = catch_unwind(AssertUnwindSafe(|| target.run(&bytes)));
        *running.lock().expect("nobody panics with it") = None;
        executions += 1;
        if outcome.is_err() {
            failures.insert(save(folder, &target.name, "crash", &bytes));
        }
    }
    let seconds = begin.elapsed().as_secs_f64();
    println!("{}: {executions} executions in {seconds:.0} s, {} failed", target.name, failures.len());
    let line = format!("{},{seconds:.0},{executions},{},{now}\n", target.name, failures.len());
    let opened = OpenOptions::new().create(true).append(true).open(folder.join("mutated.csv"));
    opened.and_then(|mut file| file.write_all(line.as_bytes())).expect("the record takes a line");
    failures.len()
}

/// A seed with some changes: bytes, numbers, words, pieces of another one.
fn mutated(rng: &mut Rng, inputs: &[Vec<u8>], words: &[&[u8]]) -> Vec<u8> {
    let mut bytes = inputs[rng.usize(0..inputs.len())].clone();
    for _ in 0..1 + rng.usize(0..6) {
        let at = rng.usize(0..=bytes.len());
        let end = (at + rng.usize(1..32)).min(bytes.len());
        match rng.u8(0..10) {
            0 => drop(bytes.drain(at..end)),
            1 => {
                let copy = bytes[at..end].to_vec();
                let to = rng.usize(0..=bytes.len());
                bytes.splice(to..to, copy);
            }
            2 if at < bytes.len() => bytes[at] = rng.u8(..),
            3 if at < bytes.len() => bytes[at] ^= 1 << rng.u8(0..8),
            4 if rng.u8(0..4) == 0 => bytes.truncate(at),
            5 | 6 => {
                let word = words[rng.usize(0..words.len())];
                let to = if rng.bool() { at } else { end };
                bytes.splice(at..to, word.iter().copied());
            }
            7 => {
                let other = &inputs[rng.usize(0..inputs.len())];
                let from = rng.usize(0..=other.len());
                let to = (from + rng.usize(1..64)).min(other.len());
                bytes.splice(at..end, other[from..to].iter().copied());
            }
            _ => {
                // A number, wherever one stands.
                if let Some(digit) = bytes[at..].iter().position(u8::is_ascii_digit) {
                    let number = [b"0".as_slice(), b"-1", b"1e300", b"4294967296", b"nan", b"1e-300", b"7"];
                    let chosen = number[rng.usize(0..number.len())];
                    bytes.splice(at + digit..=at + digit, chosen.iter().copied());
                }
            }
        }
    }
    bytes.truncate(MAX_BYTES);
    bytes
}

/// Writes an input that failed, under a name of its bytes.
fn save(folder: &Path, name: &str, what: &str, bytes: &[u8]) -> PathBuf {
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3)
    });
    let room = folder.join("../artifacts").join(name);
    let path = room.join(format!("{what}-{hash:016x}"));
    fs::create_dir_all(&room).and_then(|()| fs::write(&path, bytes)).expect("the folder takes a file");
    path
}
