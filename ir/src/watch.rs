//! Whether work is still wanted: what lowers, changes, emits and runs code looks every now and then, and
//! stops where it is.
//!
//! ```text
//! offer(watch, work)     what may be stopped below is stopped by this watch
//!   stoppable(work)      Err(Ended) if a look was told to stop; work is half done then, and thrown away
//!     look()             in inner loops: costs a decrement, and asks the watch every few milliseconds
//!     take(bytes)        before memory is asked for: costs a subtraction, and stops if it is not to be had
//!     Watches::present().hold(task)   a part of the work that another thread does
//! guarded(work)          Err(NoMemory) if a `take` found too little; guarded_once: if nobody around answers
//!   go_on()?             outside of compiling: an error, for whoever has errors to answer
//! ```
//!
//! A function in progress has no meaning, so nobody between a loop and [`stoppable`] has anything to answer:
//! the stack is unwound, as by a panic, but without a message. Whoever is not inside of [`stoppable`] is
//! never stopped. [`guarded`] is the same for work that nobody watches: memory alone ends it. A thread that
//! waits for others while it is stoppable waits under [no watch](Watches::NONE): it may do work for somebody
//! else meanwhile, which is neither stopped by this watch nor offered it.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::collections::BinaryHeap;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::thread::LocalKey;
use std::time::{Duration, Instant};

use super::memory::{NoMemory, probe};

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
    static ACTIVE: RefCell<WorkEnd> = const { RefCell::new(WorkEnd::Nothing) };
    /// Looks until the next one at the clock.
    static LEFT: Cell<u32> = const { Cell::new(LOOKS) };
    /// When a watch was last asked.
    static LAST: Cell<Option<Instant>> = const { Cell::new(None) };
    static CLOCK: SparseClock = const { SparseClock::new() };
    /// Bytes that were there when this thread last asked, and that nobody has taken since.
    static FORESEEN: Cell<usize> = const { Cell::new(0) };
}

/// Bytes that are asked for at once, for many small parts.
const PORTION: usize = 2 << 20;

/// What may end the work in progress.
#[derive(Clone, Default)]
enum WorkEnd {
    #[default]
    Nothing,
    /// Want of memory.
    Memory,
    /// The same, and a watch.
    Watched(Watch),
}

/// Work was stopped by its watch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Stopped;

/// Why work ended before it was done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Ended {
    /// Its watch stopped it.
    Stopped,
    /// There was no memory for it.
    NoMemory(NoMemory),
}

/// Does work with a value in a place. The one before comes back in the end.
fn with<V: Default, T>(place: &'static LocalKey<RefCell<V>>, value: V, work: impl FnOnce() -> T) -> T {
    struct ValueBefore<V: Default + 'static>(&'static LocalKey<RefCell<V>>, V);
    impl<V: Default> Drop for ValueBefore<V> {
        fn drop(&mut self) {
            self.0.set(std::mem::take(&mut self.1));
        }
    }
    let _before = ValueBefore(place, place.replace(value));
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
    active: WorkEnd,
}

impl Watches {
    /// None: nobody stops the work, and none is offered.
    pub const NONE: Self = Self { offered: None, active: WorkEnd::Nothing };

    /// Those of the thread.
    #[must_use]
    pub fn present() -> Self {
        Self { offered: OFFERED.with_borrow(Clone::clone), active: ACTIVE.with_borrow(Clone::clone) }
    }

    /// Those that are offered to the thread: nobody ends the work in progress.
    #[must_use]
    pub fn offered() -> Self {
        Self { active: WorkEnd::Nothing, ..Self::present() }
    }

    /// Whether there is one that may stop the work in progress.
    #[must_use]
    pub fn may_stop(&self) -> bool {
        matches!(self.active, WorkEnd::Watched(_))
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
        let Self { offered, active: _ } = self;
        let (offered, active) = (offered.is_some(), self.may_stop());
        f.debug_struct("Watches").field("offered", &offered).field("active", &active).finish()
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
    let WorkEnd::Watched(watch) = ACTIVE.with_borrow(Clone::clone) else { return };
    if is_due() && !watch() {
        resume_unwind(Box::new(Ended::Stopped));
    }
}

/// Before so many bytes are asked for, at once or in parts: stops the work here if they are not to be had.
#[inline]
pub fn take(bytes: usize) {
    match FORESEEN.get().checked_sub(bytes) {
        Some(left) => FORESEEN.set(left),
        None => foresee(bytes),
    }
}

/// The bytes that a list asks for if so many more values are pushed: 0 if it has room for them. Lists that
/// grow together are asked for together.
#[inline]
#[must_use]
pub const fn growth<T>(list: &Vec<T>, more: usize) -> usize {
    grown_bytes::<T>([list.len(), list.capacity()], more)
}

/// Before so many values are pushed: as [`take`], if the list has to grow for them.
#[inline]
pub fn take_for<T>(list: &Vec<T>, more: usize) {
    take(growth(list, more));
}

/// Before a value is pushed: as [`take`], if the heap has to grow for it.
#[inline]
pub fn take_for_heap<T>(heap: &BinaryHeap<T>) {
    take(grown_bytes::<T>([heap.len(), heap.capacity()], 1));
}

const fn grown_bytes<T>([length, capacity]: [usize; 2], more: usize) -> usize {
    if capacity - length >= more {
        return 0;
    }
    let (twice, exact) = (2 * capacity, length + more);
    let values = if twice > exact { twice } else { exact };
    values * size_of::<T>()
}

#[cold]
fn foresee(bytes: usize) {
    FORESEEN.set(0);
    if cfg!(panic = "abort") || ACTIVE.with_borrow(|active| matches!(active, WorkEnd::Nothing)) {
        return;
    }
    // Many small parts are asked for together.
    let portion = bytes.max(PORTION);
    match probe(portion) {
        Ok(()) => FORESEEN.set(portion - bytes),
        Err(error) => resume_unwind(Box::new(Ended::NoMemory(error))),
    }
}

/// Does work that may be stopped, by the watch that was offered or for want of memory.
///
/// # Errors
/// It was stopped. What it changed is as it was left, so it should own all that it changes.
pub fn stoppable<T>(work: impl FnOnce() -> T) -> Result<T, Ended> {
    match OFFERED.with_borrow(Clone::clone) {
        Some(watch) if !watch() => Err(Ended::Stopped),
        Some(watch) => ending(WorkEnd::Watched(watch), work),
        None => ending(WorkEnd::Memory, work),
    }
}

/// Does work that ends where there is no memory for it. Whatever may stop it besides does so as before.
///
/// # Errors
/// There is none. What it changed is as it was left, so it should own all that it changes.
pub fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, NoMemory> {
    let active = match ACTIVE.with_borrow(Clone::clone) {
        WorkEnd::Nothing => WorkEnd::Memory,
        around => around,
    };
    ending(active, work).map_err(|end| match end {
        Ended::NoMemory(error) => error,
        Ended::Stopped => resume_unwind(Box::new(end)),
    })
}

/// As [`guarded`], unless work around this one already ends for want of memory: then that answers for this
/// one too. For small questions, of which larger work asks many.
///
/// # Errors
/// Those of [`guarded`].
pub fn guarded_once<T>(work: impl FnOnce() -> T) -> Result<T, NoMemory> {
    if ACTIVE.with_borrow(|active| matches!(active, WorkEnd::Nothing)) { guarded(work) } else { Ok(work()) }
}

/// Does work that a look may end.
fn ending<T>(active: WorkEnd, work: impl FnOnce() -> T) -> Result<T, Ended> {
    // What was there before may be gone.
    FORESEEN.set(0);
    let watched = || with(&ACTIVE, active, work);
    catch_unwind(AssertUnwindSafe(watched)).map_err(|payload| match payload.downcast() {
        Ok(end) => *end,
        Err(payload) => resume_unwind(payload),
    })
}

/// Whether a caught panic is the end of stopped work, for whoever catches panics on its way.
#[must_use]
pub fn is_stop(payload: &(dyn Any + Send)) -> bool {
    payload.is::<Ended>()
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
        assert_eq!(offer(watch, || stoppable(endless)), Err(Ended::Stopped));
        assert_eq!(asked.load(Ordering::Relaxed), 4);
        assert!(!Watches::present().may_stop(), "the watch is gone");
        (0..1000).for_each(|_| look());
    }

    #[test]
    #[cfg_attr(miri, ignore = "there an allocation that fails ends the run")]
    fn want_of_memory_ends_the_innermost_work_that_answers_for_it() {
        const HUGE: usize = isize::MAX as usize;
        let none = NoMemory { bytes: HUGE };
        assert_eq!(guarded_once(|| take(HUGE)), Err(none));
        assert_eq!(guarded(|| guarded(|| take(HUGE))), Ok(Err(none)));
        assert_eq!(guarded(|| guarded_once(|| take(HUGE))), Err(none));
        assert_eq!(guarded_once(|| 1), Ok(1));
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
    #[cfg_attr(miri, ignore = "there an allocation that fails ends the run")]
    fn work_ends_where_there_is_no_memory() {
        const HUGE: usize = isize::MAX as usize;
        let no_memory = NoMemory { bytes: HUGE };
        take(HUGE);
        let all = || (0..1_000_000).for_each(|_| take(100));
        assert_eq!(stoppable(all), Ok(()));
        assert_eq!(stoppable(|| take(HUGE)), Err(Ended::NoMemory(no_memory)));
        assert_eq!(guarded(|| take(HUGE)), Err(no_memory));
        assert_eq!(stoppable(|| guarded(|| take(HUGE))), Ok(Err(no_memory)), "the inner one answers");
        let list = vec![0_u8; 10];
        assert_eq!(guarded(|| take_for(&list, 1)), Ok(()));
        assert_eq!(guarded(|| take_for(&list, HUGE - 10)), Err(no_memory));
        assert_eq!(guarded(|| take_for_heap(&BinaryHeap::from([1, 2]))), Ok(()));
    }

    #[test]
    fn a_stop_goes_through_work_that_is_guarded() {
        let asked = Arc::new(AtomicUsize::new(0));
        let watch: Watch = Arc::new(move || asked.fetch_add(1, Ordering::Relaxed) < 3);
        assert_eq!(offer(watch, || stoppable(|| guarded(endless))), Err(Ended::Stopped));
    }

    #[test]
    fn other_panics_go_on() {
        let caught = catch_unwind(|| stoppable(|| panic!("a defect")));
        assert!(caught.is_err_and(|payload| !is_stop(&*payload)));
    }
}
