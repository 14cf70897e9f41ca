//! Long work: threads, progress, and Ctrl-C.
//!
//! ```text
//! the thread that calls          a pool of threads
//!   give the work away   ──────►   does it, and notes how far it is
//!   every 20 ms, without the interpreter's lock in between:
//!     signals? a watcher to tell?
//!     an exception       ──────►   is told to stop; the exception leaves after at most 60 ms
//!   the result           ◄──────
//! ```
//!
//! Work owns what it needs, so nobody has to wait for it to notice that it was stopped. Pools belong to a
//! process: after a fork the threads are gone, so the child makes new ones. All locks of this file are taken
//! with the interpreter's lock held, under which Python forks, so that no child inherits a locked one.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use jbt::limits::MAX_THREADS;
use jbt::{CancelToken, Compiler, Engine, Job};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::error::{Refusal, refused};

/// Between two looks at signals.
const TICK: Duration = Duration::from_millis(20);
/// Looks at the result after somebody has stopped the work, before the exception leaves.
const PATIENCE: u32 = 3;
/// Pools that a process keeps.
const KEPT: usize = 8;

/// The pools of a process, by the number of threads that was asked for; 0 is one for each CPU.
struct ProcessPools {
    process: u32,
    pools: Vec<(usize, Arc<ThreadPool>)>,
}

static POOLS: Mutex<ProcessPools> = Mutex::new(ProcessPools { process: 0, pools: Vec::new() });

/// A pool of as many threads; `None` is one for each CPU. It is made on first use, and again after a fork.
pub(crate) fn pool(_py: Python<'_>, threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    if threads.is_some_and(|threads| !(1..=MAX_THREADS).contains(&threads)) {
        let given = threads.unwrap_or_default();
        return Err(refused(format!("threads: expected 1 to {MAX_THREADS}, got {given}")));
    }
    let threads = threads.unwrap_or(0);
    let mut known = lock(&POOLS);
    if known.process != std::process::id() {
        // Their threads are those of the parent: nobody may wait for them.
        std::mem::take(&mut known.pools).into_iter().for_each(std::mem::forget);
        known.process = std::process::id();
    }
    if let Some((_, pool)) = known.pools.iter().find(|(count, _)| *count == threads) {
        return Ok(Arc::clone(pool));
    }
    let named = ThreadPoolBuilder::new().num_threads(threads).thread_name(|index| format!("jbt-{index}"));
    let made = named.build().map_err(|error| PyRuntimeError::new_err(format!("no threads: {error}")))?;
    let made = Arc::new(made);
    if known.pools.len() == KEPT {
        known.pools.remove(0);
    }
    known.pools.push((threads, Arc::clone(&made)));
    Ok(made)
}

/// The compiler of the process: models of one shape share their code. One for each engine.
pub(crate) fn compiler(engine: Option<Engine>) -> &'static Compiler {
    static BEST: OnceLock<Compiler> = OnceLock::new();
    static ENGINES: OnceLock<Vec<(Engine, Compiler)>> = OnceLock::new();
    let best = || BEST.get_or_init(Compiler::new);
    let Some(engine) = engine else { return best() };
    let all = ENGINES
        .get_or_init(|| Engine::ALL.iter().map(|&engine| (engine, Compiler::for_engine(engine))).collect());
    all.iter().find(|(known, _)| *known == engine).map_or_else(best, |(_, compiler)| compiler)
}

/// What the compiler of the process has made so far: `(programs, models, patched models)`.
#[pyfunction]
pub(crate) fn compile_counters() -> (u64, u64, u64) {
    let counters = compiler(None).counters();
    (counters.kernels, counters.bound, counters.patched)
}

/// Threads of a pool.
#[pyfunction]
#[pyo3(signature = (threads=None))]
pub(crate) fn thread_count(py: Python<'_>, threads: Option<usize>) -> PyResult<usize> {
    Ok(pool(py, threads)?.current_num_threads())
}

/// What work tells and is told.
#[derive(Clone, Default)]
pub(crate) struct Watch {
    token: CancelToken,
    /// How far it is, as the bits of an f32.
    part: Arc<AtomicU32>,
}

impl Watch {
    /// Runs a job that may be watched and stopped.
    pub(crate) fn run<T, E>(&self, job: Job<'_, T, E>) -> Result<T, E> {
        let part = Arc::clone(&self.part);
        job.on_progress(move |done| part.store(done.to_bits(), Ordering::Relaxed)).cancel(&self.token).run()
    }

    /// Whether somebody has stopped the work: for work that is no job. What it gives then is not looked at.
    pub(crate) fn is_stopped(&self) -> bool {
        self.token.is_cancelled()
    }

    fn part(&self) -> f32 {
        f32::from_bits(self.part.load(Ordering::Relaxed))
    }
}

/// Where a result arrives.
struct Arrival<T> {
    result: Mutex<Option<std::thread::Result<T>>>,
    bell: Condvar,
}

impl<T> Arrival<T> {
    fn put(&self, result: std::thread::Result<T>) {
        *lock(&self.result) = Some(result);
        self.bell.notify_all();
    }

    fn wait(&self) -> Option<std::thread::Result<T>> {
        let guard = lock(&self.result);
        let waited = self.bell.wait_timeout_while(guard, TICK, |result| result.is_none());
        waited.unwrap_or_else(PoisonError::into_inner).0.take()
    }
}

/// Where and how long work is done.
pub(crate) struct CallEffort<'py> {
    pub(crate) py: Python<'py>,
    pub(crate) threads: Option<usize>,
    /// A callable that is told how far the work is, from 0 to 1.
    pub(crate) progress: Option<Bound<'py, PyAny>>,
}

impl<'py> CallEffort<'py> {
    /// All threads, and nobody watches.
    pub(crate) fn quiet(py: Python<'py>) -> Self {
        Self { py, threads: None, progress: None }
    }

    /// Does work on the threads of a pool. See the module.
    pub(crate) fn run<T, E>(&self, work: impl FnOnce(&Watch) -> Result<T, E> + Send + 'static) -> PyResult<T>
    where
        T: Send + 'static,
        E: Into<Refusal> + Send + 'static,
    {
        let watch = Watch::default();
        let arrival: Arc<Arrival<Result<T, E>>> =
            Arc::new(Arrival { result: Mutex::new(None), bell: Condvar::new() });
        let (mine, watched) = (Arc::clone(&arrival), watch.clone());
        pool(self.py, self.threads)?.spawn(move || {
            mine.put(catch_unwind(AssertUnwindSafe(|| work(&watched))));
        });
        let mut told = -1.0;
        let mut stopped: Option<(PyErr, u32)> = None;
        loop {
            let arrived = self.py.detach(|| arrival.wait());
            if let Some((error, looks)) = stopped {
                if arrived.is_some() || looks == 1 {
                    return Err(error);
                }
                stopped = Some((error, looks - 1));
                continue;
            }
            if let Some(result) = arrived {
                let result = result.unwrap_or_else(|panic| resume_unwind(panic));
                let done = result.map_err(|error| error.into().raised(self.py))?;
                self.tell(1.0, &mut told)?;
                return Ok(done);
            }
            let looked = self.py.check_signals().and_then(|()| self.tell(watch.part(), &mut told));
            if let Err(error) = looked {
                watch.token.cancel();
                stopped = Some((error, PATIENCE));
            }
        }
    }

    /// Tells the watcher how far the work is, if it has gone on.
    fn tell(&self, part: f32, told: &mut f32) -> PyResult<()> {
        let Some(watcher) = self.progress.as_ref().filter(|_| part > *told) else { return Ok(()) };
        *told = part;
        watcher.call1((part,)).map(drop)
    }
}

/// A lock that nobody can have left broken: what it guards is whole between statements.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
