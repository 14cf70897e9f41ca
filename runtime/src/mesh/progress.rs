//! How far the work is, told to a hook that may cancel it.

use std::error::Error;
use std::sync::{Mutex, PoisonError};

use super::MeshError;

/// The share of the lattice in the whole work; the vertices are the rest. A guess, for a progress bar.
const LATTICE_SHARE: f32 = 0.8;

/// The two parts of the work that take long and are divided among threads.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Phase {
    /// The field at the lattice points.
    Lattice,
    /// Everything at the vertices.
    Vertices,
}

/// Counts finished pieces of work and tells the hook.
pub(crate) struct Progress<'a> {
    // Behind one lock, so that the hook need not be thread-safe and sees ascending fractions.
    state: Mutex<State<'a>>,
}

struct State<'a> {
    hook: &'a mut (dyn FnMut(f32) -> bool + Send),
    done: usize,
    cancelled: bool,
}

impl State<'_> {
    fn tell<E: Error + 'static>(&mut self, fraction: f32) -> Result<(), MeshError<E>> {
        // A hook that has said to stop is not asked again.
        self.cancelled = self.cancelled || !(self.hook)(fraction);
        if self.cancelled { Err(MeshError::Cancelled) } else { Ok(()) }
    }
}

impl<'a> Progress<'a> {
    pub(crate) fn new(hook: &'a mut (dyn FnMut(f32) -> bool + Send)) -> Self {
        Progress { state: Mutex::new(State { hook, done: 0, cancelled: false }) }
    }

    /// Begins a part of the work.
    pub(crate) fn begin<E: Error + 'static>(&self, phase: Phase) -> Result<(), MeshError<E>> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.done = 0;
        state.tell(fraction(phase, 0, 1))
    }

    /// Counts one more finished piece out of `total` of this part.
    pub(crate) fn advance<E: Error + 'static>(&self, phase: Phase, total: usize) -> Result<(), MeshError<E>> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.done += 1;
        let done = state.done;
        state.tell(fraction(phase, done, total))
    }

    /// All is done.
    pub(crate) fn finish<E: Error + 'static>(&self) -> Result<(), MeshError<E>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).tell(1.0)
    }
}

fn fraction(phase: Phase, done: usize, total: usize) -> f32 {
    let part = done as f32 / total as f32;
    match phase {
        Phase::Lattice => LATTICE_SHARE * part,
        Phase::Vertices => LATTICE_SHARE + (1.0 - LATTICE_SHARE) * part,
    }
}
