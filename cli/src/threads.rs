//! Work on as many threads as the command line says.

use crate::failure::Failure;

/// So many threads; no pool of their own, but one thread for each processor, if no number is given.
pub struct Threads(Option<rayon::ThreadPool>);

impl Threads {
    /// Starts them.
    pub fn new(threads: Option<u16>) -> Result<Self, Failure> {
        let build = |threads: u16| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(usize::from(threads))
                .build()
                .map_err(|error| Failure::Limit(format!("{threads} threads cannot be had: {error}")))
        };
        Ok(Self(threads.map(build).transpose()?))
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.as_ref().map_or_else(rayon::current_num_threads, rayon::ThreadPool::current_num_threads)
    }

    /// Runs the work on them.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}
