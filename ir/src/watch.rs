//! Whether work is still wanted: what lowers, changes, emits and runs code looks every now and then, and
//! stops where it is.
//!
//! ```text
//! offer(watch, work)     what may be stopped below is stopped by this watch
//!   stoppable(work)      Err(Stopped) if a look was told to stop; work is half done then, and thrown away
//!     look()             in inner loops: costs a decrement, and asks the watch every few milliseconds
//!     Watches::present().hold(task)   a part of the work that another thread does
//!   go_on()?             outside of compiling: an error, for whoever has errors to answer
//! ```
//!
//! A function in progress has no meaning, so nobody between a loop and [`stoppable`] has anything to answer:
//! the stack is unwound, as by a panic, but without a message. Whoever is not inside of [`stoppable`] is
//! never stopped. A thread that waits for others while it is, waits under [no watch](Watches::NONE): it may
//! do work for somebody else meanwhile, which is neither stopped by this watch nor offered it.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::thread::LocalKey;
use std::time::{Duration, Instant};

/// A clock for somebody who looks at it often, and needs the time every few milliseconds: while looks follow
/// each other quickly, most of them are left out. A look at the real one takes as long as a block of points.
#[derive(Debug)]
pub struct SparseClock {
    /// Looks that are left out from now on, and those that were before the last one.
    left: Cell<u32>,
    step: Cell<u32>,
    last: Cell<Option<Instant>>,
}

impl SparseClock {
    /// Looks that are left out one after the other, at most: few, because the work between the next ones may
    /// take longer.
    const STEP: u32 = 3;
    /// The time from a look to the next one, up to which the looks that follow may be left out.
    const QUICK: Duration = Duration::from_millis(1);

    /// A clock that nobody has looked at.
    #[must_use]
    pub const fn new() -> Self {
        Self { left: Cell::new(0), step: Cell::new(0), last: Cell::new(None) }
    }

    /// The time; `None` if it is too early to look.
    pub fn now(&self) -> Option<Instant> {
        let left = self.left.get();
        if left > 0 {
            self.left.set(left - 1);
            return None;
        }
        let now = Instant::now();
        let is_quick =
            self.last.replace(Some(now)).is_some_and(|last| now.duration_since(last) < Self::QUICK);
        self.step.set(if is_quick { Self::STEP.min(2 * self.step.get() + 1) } else { 0 });
        self.left.set(self.step.get());
        Some(now)
    }
}

impl Default for SparseClock {
    fn default() -> Self {
        Self::new()
    }
}

/// Says whether to go on.
pub type Watch = Arc<dyn Fn() -> bool + Send + Sync>;

/// Looks that are not even worth a look at the clock: some microseconds.
const LOOKS: u32 = 64;
/// Between two questions of one thread.
const ASKED: Duration = Duration::from_millis(5);

thread_local! {
    static OFFERED: RefCell<Option<Watch>> = const { RefCell::new(None) };
    static ACTIVE: RefCell<Option<Watch>> = const { RefCell::new(None) };
    /// Looks until the next one at the clock.
    static LEFT: Cell<u32> = const { Cell::new(LOOKS) };
    /// When a watch was last asked.
    static LAST: Cell<Option<Instant>> = const { Cell::new(None) };
    static CLOCK: SparseClock = const { SparseClock::new() };
}

type WatchPlace = LocalKey<RefCell<Option<Watch>>>;

/// Work was stopped by its watch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Stopped;

/// Does work with a watch in a place. The one before comes back in the end.
fn with<T>(place: &'static WatchPlace, watch: Option<Watch>, work: impl FnOnce() -> T) -> T {
    struct WatchBefore(&'static WatchPlace, Option<Watch>);
    impl Drop for WatchBefore {
        fn drop(&mut self) {
            self.0.set(self.1.take());
        }
    }
    let _before = WatchBefore(place, place.replace(watch));
    work()
}

/// Does work that may be stopped by a watch, and by one that was offered around it.
pub fn offer<T>(watch: Watch, work: impl FnOnce() -> T) -> T {
    let both: Watch = match OFFERED.with_borrow(Clone::clone) {
        Some(around) => Arc::new(move || around() && watch()),
        None => watch,
    };
    with(&OFFERED, Some(both), work)
}

/// Whether the work is still wanted: the watch that was offered is asked, every few milliseconds. Cheap
/// beside a microsecond of work.
///
/// # Errors
/// It is not. Nothing is unwound: the caller answers an error of its own.
pub fn go_on() -> Result<(), Stopped> {
    if OFFERED.with_borrow(Option::is_none) || !is_due() {
        return Ok(());
    }
    match OFFERED.with_borrow(Clone::clone) {
        Some(watch) if !watch() => Err(Stopped),
        Some(_) | None => Ok(()),
    }
}

/// Whether no watch has been asked on this thread for a while. The caller asks one.
fn is_due() -> bool {
    let Some(now) = CLOCK.with(SparseClock::now) else { return false };
    let is_due = LAST.get().is_none_or(|last| now.duration_since(last) >= ASKED);
    if is_due {
        LAST.set(Some(now));
    }
    is_due
}

/// What a thread may be stopped by: for a part of its work that another thread does, or while it waits.
#[derive(Clone, Default)]
pub struct Watches {
    offered: Option<Watch>,
    active: Option<Watch>,
}

impl Watches {
    /// None: nobody stops the work, and none is offered.
    pub const NONE: Self = Self { offered: None, active: None };

    /// Those of the thread.
    #[must_use]
    pub fn present() -> Self {
        Self { offered: OFFERED.with_borrow(Clone::clone), active: ACTIVE.with_borrow(Clone::clone) }
    }

    /// Whether there is one that may stop the work in progress.
    #[must_use]
    pub fn may_stop(&self) -> bool {
        self.active.is_some()
    }

    /// Whether what they were offered for is still wanted. Each call asks: it is for whoever calls seldom.
    #[must_use]
    pub fn go_on(&self) -> bool {
        self.offered.as_ref().is_none_or(|watch| watch())
    }

    /// Does work under them and no others.
    pub fn hold<T>(&self, work: impl FnOnce() -> T) -> T {
        with(&OFFERED, self.offered.clone(), || with(&ACTIVE, self.active.clone(), work))
    }
}

impl fmt::Debug for Watches {
    /// Whether there are any.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { offered, active } = self;
        let any = |watch: &Option<Watch>| watch.is_some();
        f.debug_struct("Watches").field("offered", &any(offered)).field("active", &any(active)).finish()
    }
}

/// Stops the work here if nobody wants it any more.
#[inline]
pub fn look() {
    let left = LEFT.get();
    LEFT.set(left.saturating_sub(1));
    if left == 0 {
        look_closely();
    }
}

/// Looks without counting: for whoever has waited for some milliseconds.
pub fn look_now() {
    look_closely();
}

#[cold]
fn look_closely() {
    LEFT.set(LOOKS);
    // There a stop would be the end of the process: work ends first, and is stopped where the next begins.
    if cfg!(panic = "abort") {
        return;
    }
    let Some(watch) = ACTIVE.with_borrow(Clone::clone) else { return };
    if is_due() && !watch() {
        resume_unwind(Box::new(Stopped));
    }
}

/// Does work that may be stopped, by the watch that was offered.
///
/// # Errors
/// It was stopped. What it changed is as it was left, so it should own all that it changes.
pub fn stoppable<T>(work: impl FnOnce() -> T) -> Result<T, Stopped> {
    let watch = OFFERED.with_borrow(Clone::clone);
    if watch.as_ref().is_some_and(|watch| !watch()) {
        return Err(Stopped);
    }
    let watched = || with(&ACTIVE, watch, work);
    catch_unwind(AssertUnwindSafe(watched)).map_err(|payload| match is_stop(&*payload) {
        true => Stopped,
        false => resume_unwind(payload),
    })
}

/// Whether a caught panic is the end of stopped work, for whoever catches panics on its way.
#[must_use]
pub fn is_stop(payload: &(dyn Any + Send)) -> bool {
    payload.is::<Stopped>()
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    fn endless() {
        loop {
            look();
        }
    }

    #[test]
    fn work_stops_when_its_watch_says_so() {
        let asked = Arc::new(AtomicUsize::new(0));
        let counted = Arc::clone(&asked);
        let watch: Watch = Arc::new(move || counted.fetch_add(1, Ordering::Relaxed) < 3);
        assert_eq!(offer(watch, || stoppable(endless)), Err(Stopped));
        assert_eq!(asked.load(Ordering::Relaxed), 4);
        assert!(ACTIVE.with_borrow(Option::is_none), "the watch is gone");
        (0..1000).for_each(|_| look());
    }

    #[test]
    fn work_goes_on_as_long_as_all_watches_around_it_say_so() {
        assert_eq!(go_on(), Ok(()), "nobody watches");
        let count = Arc::new(AtomicUsize::new(0));
        let counted = Arc::clone(&count);
        let outer: Watch = Arc::new(move || counted.fetch_add(1, Ordering::Relaxed) < 3);
        offer(outer, || {
            offer(Arc::new(|| true), || while go_on().is_ok() {});
            assert_eq!(count.load(Ordering::Relaxed), 4, "it was asked every few milliseconds");
            Watches::NONE.hold(|| (0..1000).for_each(|_| assert_eq!(go_on(), Ok(()))));
        });
    }

    #[test]
    fn a_clock_leaves_looks_out_while_they_are_quick() {
        let clock = SparseClock::new();
        let seen = (0..4_000).filter(|_| clock.now().is_some()).count();
        assert!(seen >= 1_000, "{seen}: at most three of four are left out");
        let slow = || {
            std::thread::sleep(SparseClock::QUICK);
            clock.now().is_some()
        };
        for _ in 0..=SparseClock::STEP {
            slow();
        }
        assert!((0..4).all(|_| slow()), "slow looks are all seen");
    }

    #[test]
    fn other_panics_go_on() {
        let caught = catch_unwind(|| stoppable(|| panic!("a defect")));
        assert!(caught.is_err_and(|payload| !is_stop(&*payload)));
    }
}
