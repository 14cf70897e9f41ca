//! How far work is, told by all of its threads to one hook that may cancel it.

use std::sync::{Mutex, PoisonError};

use crate::job::Hook;

/// The hook said to stop. Every error of long work is made of it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Cancelled;

/// Adds up finished shares of the work and tells the hook. Threads may share it.
pub(crate) struct Progress<'h> {
    // Behind one lock, so that the hook need not be thread-safe and sees ascending parts.
    state: Mutex<ProgressState<'h>>,
    /// The part of the work between two calls of the hook.
    step: f64,
}

/// For pieces that take long: each is told.
pub(crate) const EACH: f64 = 0.0;
/// For many small pieces: a call of the hook takes longer than some of them.
pub(crate) const SOME: f64 = 1.0 / 256.0;

struct ProgressState<'h> {
    hook: Hook<'h>,
    /// Where the present stage begins and ends in the whole work.
    span: [f64; 2],
    /// How much of the stage is done, from 0 to 1.
    done: f64,
    told: f64,
    cancelled: bool,
}

impl ProgressState<'_> {
    /// How much of the whole work is done.
    fn part(&self) -> f64 {
        let [start, end] = self.span;
        start + (end - start) * self.done.min(1.0)
    }

    fn tell(&mut self) {
        self.told = self.part();
        // A hook that has said to stop is not asked again.
        self.cancelled = self.cancelled || !(self.hook)(self.told as f32);
    }
}

impl<'h> Progress<'h> {
    /// Work of one stage. The hook is told that it begins, and then of every step.
    pub(crate) fn new(hook: Hook<'h>, step: f64) -> Self {
        let mut state = ProgressState { hook, span: [0.0, 1.0], done: 0.0, told: 0.0, cancelled: false };
        state.tell();
        Self { state: Mutex::new(state), step }
    }

    /// Begins a stage that makes this part of the whole work.
    pub(crate) fn begin(&self, span: [f64; 2]) -> Result<(), Cancelled> {
        self.with(|state| {
            (state.span, state.done) = (span, 0.0);
            state.tell();
        })
    }

    /// A share of the stage is done, in (0, 1].
    pub(crate) fn add(&self, share: f64) -> Result<(), Cancelled> {
        self.with(|state| {
            state.done += share;
            if state.part() >= state.told + self.step {
                state.tell();
            }
        })
    }

    /// Asks the hook whether to go on, where nobody knows how much is done.
    pub(crate) fn ask(&self) -> Result<(), Cancelled> {
        self.with(ProgressState::tell)
    }

    /// Whether nobody has said to stop so far; the hook is not asked.
    pub(crate) fn check(&self) -> Result<(), Cancelled> {
        self.with(|_| ())
    }

    /// All is done.
    pub(crate) fn finish(&self) -> Result<(), Cancelled> {
        self.begin([1.0; 2])
    }

    fn with(&self, act: impl FnOnce(&mut ProgressState<'h>)) -> Result<(), Cancelled> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        act(&mut state);
        if state.cancelled { Err(Cancelled) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a hook is told that stops at a part.
    fn told(step: f64, stop: f32, work: impl FnOnce(&Progress<'_>) -> Result<(), Cancelled>) -> Vec<f32> {
        let mut told = Vec::new();
        let mut hook = |part| {
            told.push(part);
            part < stop
        };
        let done = work(&Progress::new(&mut hook, step));
        assert_eq!(done.is_err(), stop <= 1.0);
        told
    }

    #[test]
    fn stages_add_up() {
        let work = |progress: &Progress<'_>| {
            progress.begin([0.0, 0.5])?;
            progress.add(0.5)?;
            progress.add(0.5)?;
            progress.begin([0.5, 1.0])?;
            progress.ask()?;
            progress.add(0.5)?;
            progress.finish()
        };
        assert_eq!(told(EACH, 2.0, work), [0.0, 0.0, 0.25, 0.5, 0.5, 0.5, 0.75, 1.0]);
        assert_eq!(told(EACH, 0.25, work), [0.0, 0.0, 0.25]);
    }

    #[test]
    fn small_pieces_are_told_by_steps() {
        let told = told(0.25, 0.5, |progress| (0..100).try_for_each(|_| progress.add(0.01)));
        assert_eq!(told.len(), 3, "{told:?}");
    }
}
