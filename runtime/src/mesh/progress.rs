//! Progress of the work, reported to a hook that may cancel it.

use std::error::Error;
use std::sync::{Mutex, PoisonError};

use super::error::MeshError;

/// The parts of the work that take long and are divided among threads.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Phase {
    /// The boxes of the lattice.
    Divide,
    /// The field at the points of bricks.
    Lattice,
    /// Everything at the vertices.
    Vertices,
    /// Parts that are thinner than a cell.
    Thin,
}

impl Phase {
    /// Its part of the whole work, an estimate for a progress bar.
    fn span(self) -> [f32; 2] {
        match self {
            Phase::Divide => [0.0, 0.1],
            Phase::Lattice => [0.1, 0.6],
            Phase::Vertices => [0.6, 0.97],
            Phase::Thin => [0.97, 1.0],
        }
    }
}

/// Counts finished pieces of work and tells the hook.
pub(crate) struct Progress<'a> {
    // Behind one lock, so that the hook need not be thread-safe and sees ascending fractions.
    state: Mutex<State<'a>>,
}

struct State<'a> {
    hook: &'a mut (dyn FnMut(f32) -> bool + Send),
    done: usize,
    fraction: f32,
    cancelled: bool,
}

impl State<'_> {
    fn tell<E: Error + 'static>(&mut self, fraction: f32) -> Result<(), MeshError<E>> {
        self.fraction = fraction;
        // A hook that has cancelled is not called again.
        self.cancelled = self.cancelled || !(self.hook)(fraction);
        if self.cancelled { Err(MeshError::Cancelled) } else { Ok(()) }
    }
}

impl<'a> Progress<'a> {
    pub(crate) fn new(hook: &'a mut (dyn FnMut(f32) -> bool + Send)) -> Self {
        Progress { state: Mutex::new(State { hook, done: 0, fraction: 0.0, cancelled: false }) }
    }

    fn with<T>(&self, act: impl FnOnce(&mut State<'a>) -> T) -> T {
        act(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Begins a part of the work.
    pub(crate) fn begin<E: Error + 'static>(&self, phase: Phase) -> Result<(), MeshError<E>> {
        self.with(|state| {
            state.done = 0;
            state.tell(phase.span()[0])
        })
    }

    /// Counts one more finished piece out of `total` of this part.
    pub(crate) fn advance<E: Error + 'static>(&self, phase: Phase, total: usize) -> Result<(), MeshError<E>> {
        self.with(|state| {
            state.done += 1;
            let [start, end] = phase.span();
            state.tell(start + (end - start) * (state.done as f32 / total as f32))
        })
    }

    /// Calls the hook without a step forward, where the number of pieces is unknown.
    pub(crate) fn check<E: Error + 'static>(&self) -> Result<(), MeshError<E>> {
        self.with(|state| state.tell(state.fraction))
    }

    /// All is done.
    pub(crate) fn finish<E: Error + 'static>(&self) -> Result<(), MeshError<E>> {
        self.with(|state| state.tell(1.0))
    }
}
