//! Work on as many threads as the command line says, or as many as there can be.

use jbt::limits::MAX_THREADS;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::output::warn;

/// So many threads; no pool of their own, but one thread for each processor, if no number is given.
pub struct Threads(Option<ThreadPool>);

impl Threads {
    /// Starts them. Where not all of them can be had there are fewer, and where there are none the calling
    /// thread does the work; people are told.
    pub fn new(threads: Option<u16>) -> Self {
        Self(threads.and_then(|threads| started(clipped(threads.into(), "--threads"))))
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

/// Starts the threads of work without a pool of its own: one for each processor, or as many as
/// `RAYON_NUM_THREADS` says.
pub fn prepare() {
    let told = std::env::var("RAYON_NUM_THREADS").ok().and_then(|words| words.parse::<usize>().ok());
    let wanted = match told.filter(|&told| told > 0) {
        Some(told) => clipped(told, "RAYON_NUM_THREADS"),
        None => std::thread::available_parallelism().map_or(1, usize::from).min(MAX_THREADS),
    };
    // The pool of the process can be built once, and so after another one has shown that it can be had.
    let tried = started(wanted);
    let global = match tried.as_ref().map(ThreadPool::current_num_threads) {
        Some(threads) => ThreadPoolBuilder::new().num_threads(threads),
        None => ThreadPoolBuilder::new().num_threads(1).use_current_thread(),
    };
    drop(tried);
    if let Err(error) = global.build_global() {
        warn(&error.to_string());
    }
}

/// A number of threads that makes sense.
fn clipped(wanted: usize, who: &str) -> usize {
    if wanted > MAX_THREADS {
        warn(&format!("{who} asks for {wanted} threads; {MAX_THREADS} do the work"));
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
            Err(_) => threads /= 2,
        }
    }
    warn("no thread can be started besides the first");
    None
}
