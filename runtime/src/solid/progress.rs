//! How far the work is, told to a hook that may cancel it.

use std::sync::{Mutex, PoisonError};

/// Adds up finished shares of the work and tells the hook. Threads may share it.
pub(crate) struct Progress<'a>(Mutex<State<'a>>);

struct State<'a> {
    hook: &'a mut (dyn FnMut(f32) -> bool + Send),
    done: f64,
    told: f64,
    cancelled: bool,
}

/// The share of the work between two calls of the hook.
const STEP: f64 = 1.0 / 256.0;

impl<'a> Progress<'a> {
    pub(crate) fn new(hook: &'a mut (dyn FnMut(f32) -> bool + Send)) -> Self {
        let cancelled = !hook(0.0);
        Self(Mutex::new(State { hook, done: 0.0, told: 0.0, cancelled }))
    }

    /// A share of the work is done, in (0, 1]. Returns whether to go on.
    pub(crate) fn add(&self, share: f64) -> bool {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        state.done += share;
        if !state.cancelled && state.done >= state.told + STEP {
            state.told = state.done;
            let fraction = state.done.min(1.0) as f32;
            state.cancelled = !(state.hook)(fraction);
        }
        !state.cancelled
    }

    /// Whether the hook said to stop.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).cancelled
    }
}
