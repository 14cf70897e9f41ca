//! Long work, described before it is done: it may be watched, and cancelled from elsewhere.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use jbt_ir::memory::NoMemory;
use jbt_ir::watch::{self, Watches};

/// What inner loops are given: it is told how far the work is, from 0 to 1, and says whether to go on.
pub(crate) type Hook<'h> = &'h mut (dyn FnMut(f32) -> bool + Send);

/// The error of a job. Work may be stopped while it compiles, evaluates or does something else: whoever ran
/// the job gets one answer. Wherever there is no memory for the work, it ends with this error.
pub(crate) trait JobError: From<NoMemory> {
    /// The error; its `Cancelled` in place of whatever else says that a token has stopped the work.
    fn told(self) -> Self;
}

/// Work that tells a hook how far it is.
type Work<'a, T, E> = dyn FnOnce(Hook<'_>) -> Result<T, E> + 'a;

/// Long work that is ready to run: a mesh, a picture, a slice, samples, measures. Nothing is done before
/// [`run`](Self::run).
///
/// It runs on the threads of the rayon pool in which `run` is called.
///
/// ```
/// use jbt::build::point;
/// use jbt::{CancelToken, Compiler, Model, Polygonize};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let tree = Model::new(point([0, 0, 0], 1)).check()?;
/// let compiler = Compiler::new();
/// let made = Polygonize::default().mesh(&compiler, &tree).run()?;
/// assert!(made.report.closed);
///
/// let token = CancelToken::new(); // its clones may go to other threads
/// let mut seen = 0.0;
/// let again = Polygonize::default()
///     .mesh(&compiler, &tree)
///     .on_progress(|part| {
///         seen = part;
///         if part > 0.5 {
///             token.cancel();
///         }
///     })
///     .cancel(&token)
///     .run();
/// assert!(again.is_err() && seen > 0.5);
/// # Ok(())
/// # }
/// ```
#[must_use = "nothing is done before it runs"]
pub struct Job<'a, T, E> {
    work: Box<Work<'a, T, E>>,
    watchers: Vec<Box<dyn FnMut(f32) + Send + 'a>>,
    tokens: Vec<CancelToken>,
}

impl<'a, T, E> Job<'a, T, E> {
    /// Work that tells a hook how far it is, and stops soon with an error of its own once that returns false.
    pub(crate) fn new(work: impl FnOnce(Hook<'_>) -> Result<T, E> + 'a) -> Self
    where
        E: JobError,
    {
        let work = move |hook: Hook<'_>| match watch::guarded(|| work(hook)) {
            Ok(made) => made.map_err(E::told),
            Err(error) => Err(error.into()),
        };
        Self { work: Box::new(work), watchers: Vec::new(), tokens: Vec::new() }
    }

    /// The same, and `watch` is told how far the work is: ascending parts of it, from 0 to 1. It is called
    /// from any of the threads that work, never
    /// twice at once; the work waits for it.
    pub fn on_progress(mut self, watch: impl FnMut(f32) + Send + 'a) -> Self {
        self.watchers.push(Box::new(watch));
        self
    }

    /// The same, and it stops soon with its error `Cancelled` once the token is cancelled, from any thread.
    pub fn cancel(mut self, token: &CancelToken) -> Self {
        self.tokens.push(token.clone());
        self
    }

    /// Does the work.
    ///
    /// # Errors
    /// Those of the work, and its `Cancelled`.
    pub fn run(self) -> Result<T, E> {
        let Self { work, mut watchers, tokens } = self;
        let goes_on = move || !tokens.iter().any(CancelToken::is_cancelled);
        let (asked, around) = (goes_on.clone(), Watches::present());
        let mut hook = move |part| {
            // The watchers' own work is not ended from here.
            Watches::offered().hold(|| watchers.iter_mut().for_each(|watch| watch(part)));
            // Whoever does a job on the way of other work may have a token for all of it.
            asked() && around.go_on()
        };
        watch::offer(Arc::new(goes_on), || work(&mut hook))
    }
}

impl<T, E> fmt::Debug for Job<'_, T, E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Job").field("watchers", &self.watchers.len()).finish_non_exhaustive()
    }
}

/// Tells work to stop, from any thread. Clones are one token; it stays cancelled.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// A token that nobody has cancelled.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Tells all work that has it to stop soon.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Release);
    }

    /// Does work that is no job, or has jobs in it: whatever it compiles or evaluates stops within some
    /// hundredths of a second once the token is cancelled, with
    /// [`CompileError::Cancelled`](crate::CompileError::Cancelled),
    /// [`EvalError::Cancelled`](crate::EvalError::Cancelled) or the like:
    /// [`ErrorKind::Cancelled`](crate::ErrorKind::Cancelled).
    pub fn watches<T>(&self, work: impl FnOnce() -> T) -> T {
        let token = self.clone();
        watch::offer(Arc::new(move || !token.is_cancelled()), work)
    }

    /// Whether it has been cancelled.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }
}
