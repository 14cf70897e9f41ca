//! Vectors that threads fill side by side.
//!
//! A vector of zeros that one thread makes is written twice, and the first time by the wrong thread: the
//! system finds its pages one after the other, and each line of memory goes from one processor to another.
//! Here each part becomes zeros when the thread that fills it [opens](VectorPart::open) it, or takes
//! [values](VectorPart::fill) that are there.
//!
//! A large one asks for large pages as well. Whoever first writes to a page waits some microseconds for it,
//! and a third of these are its zeros: a mesh of 400,000 vertices is 6,000 pages of 4 KiB, or 13 of 2 MiB.

use std::mem::MaybeUninit;
use std::sync::atomic::{AtomicUsize, Ordering};

use bytemuck::Pod;
use jbt_ir::memory::{self, NoMemory};
use jbt_ir::watch;

use super::brick::split;

/// An empty vector with room for this many values, in large pages if it fills half of one.
pub(crate) fn room<T>(length: usize) -> Result<Vec<T>, NoMemory> {
    let mut values = memory::room(length)?;
    ask_for_large_pages(values.spare_capacity_mut());
    Ok(values)
}

/// The same in the memory of a vector whose values nobody needs any more, if it is large enough, and at most
/// half too large: its pages are there. Otherwise that memory is free before new one is asked for.
pub(super) fn room_in<T: Pod, U: Pod>(mut old: Vec<T>, length: usize) -> Result<Vec<U>, NoMemory> {
    old.clear();
    let there = old.capacity() * size_of::<T>() / size_of::<U>();
    let is_right = length > 0 && (length..=length / 2 * 3).contains(&there);
    let again = is_right.then(move || bytemuck::allocation::try_cast_vec(old)).and_then(Result::ok);
    again.map_or_else(|| room(length), Ok)
}

/// A vector of known length, to be filled in parts.
pub(super) struct FilledVector<T> {
    /// Room for the values, none of which is there yet.
    values: Vec<T>,
    length: usize,
    /// The number of places in parts that have been opened.
    opened: AtomicUsize,
}

/// Places of a vector that no other part has.
pub(super) struct VectorPart<'a, T> {
    room: &'a mut [MaybeUninit<T>],
    opened: &'a AtomicUsize,
}

impl<T: Copy + Default> FilledVector<T> {
    /// Room for this many values.
    pub(super) fn new(length: usize) -> Result<Self, NoMemory> {
        Ok(Self::in_room(room(length)?, length))
    }

    /// This many values, in an empty vector with room for as many or more.
    pub(super) fn in_room(values: Vec<T>, length: usize) -> Self {
        Self { values, length, opened: AtomicUsize::new(0) }
    }

    /// Room for the few values of an edit: without memory it does what vectors do.
    pub(super) fn few(length: usize) -> Self {
        Self::in_room(Vec::with_capacity(length), length)
    }

    /// Divides the vector among groups of bricks: the places of brick `b` are from `starts[b]` to
    /// `starts[b + 1]`, times `width`.
    pub(super) fn parts(&mut self, starts: &[usize], group: usize, width: usize) -> Vec<VectorPart<'_, T>> {
        // Callers zip the parts of several vectors.
        watch::take(4 * starts.len().div_ceil(group) * size_of::<VectorPart<'_, T>>());
        // What earlier parts have counted does not count.
        self.opened = AtomicUsize::new(0);
        let room = &mut self.values.spare_capacity_mut()[..self.length];
        let rooms = split(room, starts, group, width).into_iter();
        rooms.map(|room| VectorPart { room, opened: &self.opened }).collect()
    }

    /// The vector.
    ///
    /// # Panics
    /// Unless its parts were all of it, and each was opened.
    pub(super) fn finish(self) -> Vec<T> {
        let Self { mut values, length, opened } = self;
        assert_eq!(opened.into_inner(), length, "each part is opened");
        // SAFETY: there is room for `length` values. The parts of the last division share no place, nor
        // does what is taken from them; each counts its places once, when they are values, and they counted
        // all.
        unsafe { values.set_len(length) };
        values
    }
}

/// Asks the system for large pages, those at the ends of the room included: what lies beside it in these is
/// most often the next one. Nothing changes where there are none, or they are not given.
#[cfg(all(target_os = "linux", feature = "parallel", not(miri)))]
fn ask_for_large_pages<T>(room: &mut [MaybeUninit<T>]) {
    /// Bytes of a page, where small ones have 4 KiB.
    const LARGE: usize = 2 << 20;
    let (start, bytes) = (room.as_mut_ptr().cast::<std::ffi::c_void>(), size_of_val(room));
    if bytes >= LARGE / 2 {
        let first = start.addr() / LARGE * LARGE;
        let end = (start.addr() + bytes).next_multiple_of(LARGE);
        let advice = rustix::mm::Advice::LinuxHugepage;
        // SAFETY: this advice is about the pages that the system takes for memory from now on. No value
        // changes, be it of the room or of what is beside it.
        let _ = unsafe { rustix::mm::madvise(start.map_addr(|_| first), end - first, advice) };
    }
}

#[cfg(not(all(target_os = "linux", feature = "parallel", not(miri))))]
fn ask_for_large_pages<T>(_: &mut [MaybeUninit<T>]) {}

impl<'a, T: Copy + Default> VectorPart<'a, T> {
    /// Takes the next places from the part, so that whoever fills it brick by brick needs no ranges.
    ///
    /// # Panics
    /// There are fewer.
    pub(super) fn take(&mut self, count: usize) -> Self {
        let (room, rest) = std::mem::take(&mut self.room).split_at_mut(count);
        self.room = rest;
        Self { room, opened: self.opened }
    }

    /// The places of the part, as zeros.
    pub(super) fn open(self) -> &'a mut [T] {
        for place in &mut *self.room {
            place.write(T::default());
        }
        self.opened.fetch_add(self.room.len(), Ordering::Relaxed);
        // SAFETY: each of them has just been written.
        unsafe { self.room.assume_init_mut() }
    }

    /// Fills the part with values, as many as it has places.
    pub(super) fn fill(self, values: &[T]) {
        self.room.write_copy_of_slice(values);
        self.opened.fetch_add(self.room.len(), Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::{FilledVector, NoMemory, room, room_in};

    #[test]
    fn parts_make_the_whole() {
        let mut vector = FilledVector::<u32>::new(12).expect("some bytes");
        let [first, mut second] = vector.parts(&[0, 1, 1, 4], 2, 3).try_into().ok().expect("two parts");
        let places = first.open();
        assert_eq!(places, [0; 3]);
        places.fill(1);
        second.take(2).open().copy_from_slice(&[2, 3]);
        second.fill(&[4, 5, 6, 7, 8, 9, 10]);
        assert_eq!(vector.finish(), [1, 1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
        assert!(FilledVector::<u32>::few(0).finish().is_empty());
        let too_many = FilledVector::<u32>::new(usize::MAX / 4).err();
        assert_eq!(too_many, Some(NoMemory { bytes: usize::MAX - 3 }));
    }

    #[test]
    fn memory_is_used_again_if_it_is_enough() {
        let old = |length| room::<f32>(length).expect("some bytes");
        let values = old(9);
        let before = values.as_ptr().addr();
        let mut again = FilledVector::in_room(room_in::<_, [u32; 3]>(values, 2).expect("some bytes"), 2);
        again.parts(&[0, 2], 1, 1).pop().expect("one part").fill(&[[1; 3], [2; 3]]);
        let again = again.finish();
        assert_eq!((again.capacity(), &again[..]), (3, &[[1; 3], [2; 3]][..]));
        assert_eq!(again.as_ptr().addr(), before);
        // Too few, too many, none, and no whole number of values.
        for (length, wanted) in [(12, 5), (12, 2), (12, 0), (13, 4)] {
            assert_eq!(room_in::<_, [u32; 3]>(old(length), wanted).expect("some bytes").capacity(), wanted);
        }
    }

    #[test]
    #[should_panic(expected = "each part is opened")]
    fn a_part_that_was_not_opened_is_noticed() {
        let mut vector = FilledVector::<u8>::few(4);
        for division in 0..2 {
            let mut parts = vector.parts(&[0, 2, 4], 1, 1).into_iter();
            // Once the first part, once the second: four places in all.
            parts.nth(division).map(super::VectorPart::open);
        }
        vector.finish();
    }
}
