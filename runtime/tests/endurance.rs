//! What must not wear out: many compilations, models that change while threads ask, pages of machine code.
//!
//! `JBT_FAULTS=1` runs them at length: 100,000 compilations, and a minute of eight threads.
#![cfg(target_os = "linux")]
#![allow(clippy::print_stdout, reason = "a test may show its figures")]

mod common;

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use common::answers;
use jbt::{Compiler, Points, Query};
use jbt_testkit::bits::assert_same;
use jbt_testkit::random::Random;
use jbt_testkit::skip::short_or_long;

/// These tests look at the memory of the whole process: one at a time.
static ALONE: Mutex<()> = Mutex::new(());

/// Bytes of this process that are in memory.
fn resident() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux says so");
    let line = status.lines().find(|line| line.starts_with("VmRSS:")).expect("it has memory");
    let kilobytes: u64 = line.split_whitespace().nth(1).and_then(|word| word.parse().ok()).expect("a number");
    kilobytes << 10
}

/// Mappings that may be written and executed.
fn writable_and_executable() -> usize {
    let maps = std::fs::read_to_string("/proc/self/maps").expect("Linux lists the mappings");
    let rights = maps.lines().filter_map(|line| line.split(' ').nth(1));
    rights.filter(|rights| rights.contains('w') && rights.contains('x')).count()
}

#[test]
fn compiling_and_dropping_keeps_the_size_of_the_process() {
    let _alone = ALONE.lock();
    let cycles = short_or_long([1_000, 100_000]);
    let trees: Vec<_> = (0..8_u64)
        .map(|shape| {
            Random::new(shape, shape + 1).model(1 + shape as usize % 3).check().expect("a good model")
        })
        .collect();
    let points: Points = [[0.1, 0.2, 0.3], [0.0; 3]].into_iter().collect();
    let once = |cycle: usize| {
        let evaluator = Compiler::new().evaluator(&trees[cycle % 8], Query::FIELD).expect("it compiles");
        answers(&evaluator, &points)
    };
    // The allocator takes what it needs.
    (0..400).for_each(|cycle| drop(once(cycle)));
    let before = resident();
    (0..cycles).for_each(|cycle| drop(once(cycle)));
    let grown = resident().saturating_sub(before);
    println!("{cycles} cycles of compiling and dropping: {} KiB more", grown >> 10);
    assert!(grown <= 1 << 20, "{} KiB more", grown >> 10);
}

/// Two models that change their numbers and shapes, asked by eight threads: every answer is that of a model
/// which was there.
#[test]
fn eight_threads_ask_two_models_that_change() {
    let _alone = ALONE.lock();
    let lasts = Duration::from_secs(short_or_long([2, 60]));
    let points: Points = (0..40).map(|n| [n as f32 * 0.05 - 1.0, 0.2, n as f32 * 0.01]).collect();
    // Versions of two models: odd ones have another shape.
    let versions: Vec<Vec<_>> = (0..2_u64)
        .map(|model| {
            let of = |version: u64| Random::new(10 * model + version % 3, version).model(6);
            (0..9).map(|version| of(version).check().expect("a good model")).collect()
        })
        .collect();
    let expected: Vec<Vec<_>> = versions
        .iter()
        .map(|trees| {
            let of =
                |tree| answers(&Compiler::new().evaluator(tree, Query::ALL).expect("it compiles"), &points);
            trees.iter().map(of).collect()
        })
        .collect();
    let compilers = [Compiler::new(), Compiler::new()];
    let (compiled, is_over) = (AtomicU64::new(0), AtomicBool::new(false));
    let begin = Instant::now();
    let ask = |thread: usize| {
        let mut version = thread;
        while begin.elapsed() < lasts {
            let (model, at) = (version % 2, version / 2 % 9);
            let compiler = if version.is_multiple_of(5) { &Compiler::new() } else { &compilers[model] };
            let evaluator = compiler.evaluator(&versions[model][at], Query::ALL).expect("it compiles");
            let given = answers(&evaluator, &points);
            assert_same(expected[model][at].planes(), given.planes(), "another answer");
            compiled.fetch_add(1, Ordering::Relaxed);
            version += 7;
        }
    };
    std::thread::scope(|scope| {
        let look = scope.spawn(|| {
            let mut looks = 0_u64;
            while !is_over.load(Ordering::Relaxed) {
                assert_eq!(writable_and_executable(), 0, "a page is writable and executable");
                looks += 1;
            }
            looks
        });
        let ask = &ask;
        let asking: Vec<_> = (0..8).map(|thread| scope.spawn(move || ask(thread))).collect();
        let outcomes: Vec<_> = asking.into_iter().map(std::thread::ScopedJoinHandle::join).collect();
        is_over.store(true, Ordering::Relaxed);
        let looks = look.join().expect("no page is writable and executable");
        assert!(outcomes.iter().all(Result::is_ok), "an answer was another one");
        println!(
            "{} questions of eight threads, {looks} looks at all pages",
            compiled.load(Ordering::Relaxed)
        );
    });
}
