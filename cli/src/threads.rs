//! Work on as many threads as the command line says, or as many as there can be.

use std::time::Duration;

use jbt::limits::MAX_THREADS;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::output::warn;

/// So many threads; the threads that are there, if no number is given.
pub struct Threads(Option<ThreadPool>);

impl Threads {
    /// Starts them. Where not all of them can be had there are fewer, and where there are none the calling
    /// thread does the work; people are told.
    pub fn new(threads: Option<u16>) -> Self {
        Self(threads.and_then(|threads| started(clipped(threads.into(), "--threads", "threads"))))
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.as_ref().map_or_else(rayon::current_num_threads, ThreadPool::current_num_threads)
    }

    /// Runs the work on them.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}

/// Does all work on threads for it: one for each processor, or as many as `RAYON_NUM_THREADS` says. The pool
/// that rayon makes by itself is none for us: where its threads cannot be had it panics.
pub fn run_all<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let told = std::env::var("RAYON_NUM_THREADS").ok().and_then(|words| words.parse::<usize>().ok());
    let wanted = match told.filter(|&told| told > 0) {
        Some(told) => clipped(told, "RAYON_NUM_THREADS", "threads"),
        None => std::thread::available_parallelism().map_or(1, usize::from).min(MAX_THREADS),
    };
    match started(wanted) {
        Some(pool) => pool.install(work),
        None => {
            // The pool of the calling thread alone starts none.
            let alone = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
            alone.unwrap_or_else(|error| warn(&error.to_string()));
            work()
        }
    }
}

/// A number of threads or processes that makes sense.
pub fn clipped(wanted: usize, who: &str, what: &str) -> usize {
    if wanted > MAX_THREADS {
        warn(&format!("{who} asks for {wanted} {what}; {MAX_THREADS} do the work"));
    }
    wanted.min(MAX_THREADS)
}

/// The most threads that can be had: so many, or half of them, and so on.
fn started(wanted: usize) -> Option<ThreadPool> {
    let mut threads = wanted;
    while threads > 0 {
        match ThreadPoolBuilder::new().num_threads(threads).build() {
            Ok(pool) => {
                if threads < wanted {
                    warn(&format!("{threads} of {wanted} threads can be started"));
                }
                return Some(pool);
            }
            Err(_) => {
                threads /= 2;
                // Those of the pool that did not come about count until they have ended; nobody says when.
                std::thread::sleep(Duration::from_millis(5));
            }
        }
    }
    warn("no thread can be started besides the first");
    None
}
