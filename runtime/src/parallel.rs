//! The one door to threads: rayon with the feature `parallel`, and the same words on one thread without.
//!
//! Whatever runs here gives the same bits for any number of threads, so the serial words are no second
//! meaning: they are the case of one thread.

use std::ops::{Deref, DerefMut};
use std::sync::Mutex;

use jbt_ir::watch::Watches;
use jbt_lower::Workers;

#[cfg(feature = "parallel")]
pub(crate) use rayon::{current_num_threads as thread_count, join, prelude::*};

#[cfg(not(feature = "parallel"))]
pub(crate) use serial::{IntoParallelIterator, ParallelIterator, ParallelSlice, join, thread_count};

/// What other crates have done on the threads of this one.
pub(crate) struct PoolWorkers;

impl Workers for PoolWorkers {
    fn each(&self, count: usize, task: &(dyn Fn(usize) + Sync)) {
        scatter(|watches| (0..count).into_par_iter().for_each(|index| watches.hold(|| task(index))));
    }
}

/// Gives work to the threads of the pool and waits for it. Whatever may be stopped of it is to be
/// [held](Watches::hold) by the watches that `give` gets. A thread that waits may do work of somebody else,
/// which these watches must not stop: whoever gives work and waits does it by this.
pub(crate) fn scatter<T>(give: impl FnOnce(&Watches) -> T) -> T {
    let watches = Watches::present();
    Watches::NONE.hold(|| give(&watches))
}

/// Items of unequal weight: a thread takes a sixteenth of its share of them without a look whether another
/// one is idle. Rayon alone ends with pieces of half a share, so that one of two threads may wait for a
/// quarter of the time.
#[cfg(feature = "parallel")]
pub(crate) fn in_pieces<I: IndexedParallelIterator>(
    items: I,
) -> impl IndexedParallelIterator<Item = I::Item> {
    let most = match thread_count() {
        1 => items.len(),
        threads => items.len() / (16 * threads),
    };
    items.with_max_len(most.max(1))
}

#[cfg(not(feature = "parallel"))]
pub(crate) fn in_pieces<I>(items: I) -> I {
    items
}

/// Rooms that pieces of work need one after the other, such as vectors that each of them fills anew. A room
/// is made when none is idle, so there are as many as threads. Rayon would make one for each piece: cold
/// memory, and a good part of the time of a small one.
pub(crate) struct Rooms<T, F: Fn() -> T> {
    make: F,
    idle: Mutex<Vec<T>>,
}

/// A room of [`Rooms`], until it is dropped.
pub(crate) struct Room<'a, T> {
    /// There is one up to the drop.
    room: Option<T>,
    idle: &'a Mutex<Vec<T>>,
}

impl<T, F: Fn() -> T> Rooms<T, F> {
    /// No room yet.
    pub(crate) fn new(make: F) -> Self {
        Self { make, idle: Mutex::new(Vec::new()) }
    }

    /// A room as whoever had it left it, or a new one.
    pub(crate) fn take(&self) -> Room<'_, T> {
        let idle = self.idle.lock().expect("nothing panics here").pop();
        Room { room: Some(idle.unwrap_or_else(&self.make)), idle: &self.idle }
    }
}

impl<T> Deref for Room<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.room.as_ref().expect("up to the drop")
    }
}

impl<T> DerefMut for Room<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        self.room.as_mut().expect("up to the drop")
    }
}

impl<T> Drop for Room<'_, T> {
    fn drop(&mut self) {
        // A lock that is not to be had costs no more than the room.
        if let (Some(room), Ok(mut idle)) = (self.room.take(), self.idle.lock()) {
            idle.push(room);
        }
    }
}

#[cfg(not(feature = "parallel"))]
mod serial {
    //! What this crate uses of rayon's interface, on iterators of the standard library.

    use std::slice::{Chunks, ChunksMut, Iter};

    /// One: the caller.
    pub(crate) fn thread_count() -> usize {
        1
    }

    /// Both, the first one first.
    pub(crate) fn join<A, B>(first: impl FnOnce() -> A, second: impl FnOnce() -> B) -> (A, B) {
        (first(), second())
    }

    pub(crate) trait IntoParallelIterator: IntoIterator + Sized {
        fn into_par_iter(self) -> Self::IntoIter {
            self.into_iter()
        }
    }

    impl<I: IntoIterator> IntoParallelIterator for I {}

    pub(crate) trait ParallelSlice<T> {
        fn par_iter(&self) -> Iter<'_, T>;
        fn par_chunks(&self, size: usize) -> Chunks<'_, T>;
        fn par_chunks_mut(&mut self, size: usize) -> ChunksMut<'_, T>;
        fn par_sort_unstable_by_key<K: Ord>(&mut self, key: impl FnMut(&T) -> K);
    }

    impl<T> ParallelSlice<T> for [T] {
        fn par_iter(&self) -> Iter<'_, T> {
            self.iter()
        }

        fn par_chunks(&self, size: usize) -> Chunks<'_, T> {
            self.chunks(size)
        }

        fn par_chunks_mut(&mut self, size: usize) -> ChunksMut<'_, T> {
            self.chunks_mut(size)
        }

        fn par_sort_unstable_by_key<K: Ord>(&mut self, key: impl FnMut(&T) -> K) {
            self.sort_unstable_by_key(key);
        }
    }

    /// What rayon's iterators have beyond those of the standard library.
    pub(crate) trait ParallelIterator: Iterator + Sized {
        fn with_min_len(self, _length: usize) -> Self {
            self
        }

        fn map_init<S, R>(
            self,
            start: impl FnOnce() -> S,
            mut each: impl FnMut(&mut S, Self::Item) -> R,
        ) -> impl Iterator<Item = R> {
            let mut state = start();
            self.map(move |item| each(&mut state, item))
        }

        fn try_for_each_init<S, E>(
            mut self,
            start: impl FnOnce() -> S,
            mut each: impl FnMut(&mut S, Self::Item) -> Result<(), E>,
        ) -> Result<(), E> {
            let mut state = start();
            self.try_for_each(|item| each(&mut state, item))
        }

        fn find_map_first<R>(mut self, each: impl FnMut(Self::Item) -> Option<R>) -> Option<R> {
            self.find_map(each)
        }

        fn try_reduce<T, E>(
            mut self,
            start: impl FnOnce() -> T,
            mut both: impl FnMut(T, T) -> Result<T, E>,
        ) -> Result<T, E>
        where
            Self: Iterator<Item = Result<T, E>>,
        {
            self.try_fold(start(), |all, one| both(all, one?))
        }
    }

    impl<I: Iterator> ParallelIterator for I {}
}

#[cfg(all(test, feature = "parallel"))]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{Arc, Mutex};

    use jbt_ir::watch::{self, Ended};

    use super::*;

    #[test]
    fn work_of_somebody_else_is_not_stopped_by_the_watch_of_who_waits() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        let (answers, parts) = (Arc::new(Mutex::new(Vec::new())), AtomicUsize::new(0));
        let told = Arc::clone(&answers);
        pool.install(|| {
            // The watch of the work lets it go on to its parts, and would stop whatever asks it afterwards.
            watch::offer(Arc::new(|| false), || {
                PoolWorkers.each(2, &|index| {
                    parts.fetch_add(1, Ordering::Relaxed);
                    if index == 0 {
                        // Somebody else's, which the only thread does while it waits for the other part.
                        let told = Arc::clone(&told);
                        rayon::spawn(move || {
                            told.lock().expect("one at a time").push(watch::stoppable(|| ()));
                        });
                    }
                });
                assert_eq!(watch::stoppable(|| ()), Err(Ended::Stopped), "the watch is back");
            });
        });
        // A thread does all that it was given before it does what comes later.
        pool.install(rayon::yield_now);
        assert_eq!(parts.into_inner(), 2);
        assert_eq!(*answers.lock().expect("one at a time"), [Ok(())]);
    }

    #[test]
    fn rooms_are_as_many_as_are_taken_at_once() {
        let made = AtomicUsize::new(0);
        let rooms = Rooms::new(|| {
            made.fetch_add(1, Ordering::Relaxed);
            Vec::new()
        });
        for piece in 0..3 {
            // As the last piece left them.
            let (mut a, mut b) = (rooms.take(), rooms.take());
            assert_eq!((a.len(), b.len()), (piece, piece));
            a.push(0);
            b.push(1);
        }
        assert_eq!(made.load(Ordering::Relaxed), 2);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("a pool");
        let pieces = || (0..1000).into_par_iter().for_each(|piece| rooms.take().push(piece));
        pool.install(pieces);
        let kept: usize = rooms.idle.lock().expect("nobody else").iter().map(Vec::len).sum();
        assert_eq!((kept, made.load(Ordering::Relaxed)), (1006, 2));
    }
}
