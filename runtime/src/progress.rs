//! How far work is, told by all of its threads to one hook that may cancel it.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use jbt_ir::watch::SparseClock;

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
    pulse: Pulse,
}

/// Tells when it is time to ask again, to threads that work.
pub(crate) struct Pulse {
    begun: Instant,
    /// Milliseconds from the beginning to the last question.
    asked: AtomicU64,
}

/// Milliseconds between two questions, if the work gives the opportunity: less than a third of what people
/// take for at once.
const PULSE: u64 = 15;
/// Work between two such opportunities, where it can be divided at will.
const PACE: Duration = Duration::from_millis(8);
/// The least that is worth a division: points of some blocks of every engine.
const LEAST_POINTS: usize = 256;

thread_local! {
    static CLOCK: SparseClock = const { SparseClock::new() };
}

impl Pulse {
    pub(crate) fn new() -> Self {
        Self { begun: Instant::now(), asked: AtomicU64::new(0) }
    }

    /// Whether it is time to ask. The caller does so.
    pub(crate) fn is_due(&self) -> bool {
        let Some(now) = CLOCK.with(SparseClock::now) else { return false };
        let now = now.duration_since(self.begun).as_millis() as u64;
        let is_due = now.saturating_sub(self.asked.load(Ordering::Relaxed)) >= PULSE;
        if is_due {
            self.asked.store(now, Ordering::Relaxed);
        }
        is_due
    }
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
        Self { state: Mutex::new(state), step, pulse: Pulse::new() }
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
        let is_due = self.pulse.is_due();
        self.with(|state| {
            state.done += share;
            if is_due || state.part() >= state.told + self.step {
                state.tell();
            }
        })
    }

    /// Asks the hook whether to go on, if nobody has done so for a while: between parts of a share.
    pub(crate) fn breathe(&self) -> Result<(), Cancelled> {
        if self.pulse.is_due() { self.ask() } else { Ok(()) }
    }

    /// Works on all points of a range, as many at once as take little time; `points` is how many that are, as
    /// the last call on this thread has found.
    pub(crate) fn paced<E: From<Cancelled>>(
        &self,
        count: usize,
        points: &mut usize,
        mut work: impl FnMut(Range<usize>) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut start = 0;
        while start < count {
            let end = count.min(start.saturating_add((*points).max(LEAST_POINTS)));
            let begun = Instant::now();
            work(start..end)?;
            let took = begun.elapsed().as_secs_f64().max(1e-9);
            *points = ((end - start) as f64 * PACE.as_secs_f64() / took) as usize;
            start = end;
            self.breathe()?;
        }
        Ok(())
    }

    /// Asks the hook whether to go on, where nobody knows how much is done.
    pub(crate) fn ask(&self) -> Result<(), Cancelled> {
        self.with(ProgressState::tell)
    }

    /// Whether nobody has said to stop so far; the hook is asked if nobody has done so for a while.
    pub(crate) fn check(&self) -> Result<(), Cancelled> {
        let is_due = self.pulse.is_due();
        self.with(|state| {
            if is_due {
                state.tell();
            }
        })
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
