//! Slots of a buffer: ranges that bricks have until they outgrow them, so that what stays the same stays
//! where it is.

/// The part of a buffer that a brick has.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct BufferSlot {
    /// Where it begins.
    pub(crate) start: usize,
    /// How much of it is used.
    pub(crate) len: usize,
    /// How much there is room for: 0, or the size of a class.
    capacity: usize,
}

impl BufferSlot {
    /// What is used.
    pub(crate) fn range(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.len
    }
}

/// The slots of a buffer that are free, and where the buffer ends.
///
/// Sizes are in classes, two for each power of two, so a free slot of a class fits the next brick of that
/// class, and a third of a slot is unused at most. Freed slots are never joined: the buffer ends where the
/// slots of all classes ended at their most.
#[derive(Clone, Default)]
pub(crate) struct BufferSlots {
    /// By class: where free slots begin, the last one freed at the end.
    free: Vec<Vec<usize>>,
    end: usize,
}

/// The smallest slot.
const SMALLEST: usize = 16;

/// The number of the class that has room for so much, and its size.
fn class(len: usize) -> (usize, usize) {
    let power = len.max(SMALLEST).next_power_of_two();
    let octave = 2 * (power / SMALLEST).ilog2() as usize;
    let below = power / 4 * 3;
    if len <= below && power > SMALLEST { (octave - 1, below) } else { (octave, power) }
}

impl BufferSlots {
    /// Where the last slot ends.
    pub(crate) fn end(&self) -> usize {
        self.end
    }

    /// Room for so much: a free slot, or the end of the buffer.
    pub(crate) fn take(&mut self, len: usize) -> BufferSlot {
        if len == 0 {
            return BufferSlot::default();
        }
        let (class, capacity) = class(len);
        if let Some(start) = self.free.get_mut(class).and_then(Vec::pop) {
            return BufferSlot { start, len, capacity };
        }
        let start = self.end;
        self.end += capacity;
        BufferSlot { start, len, capacity }
    }

    /// The same slot if there is room for so much, and not three times as much; else another one. The old one
    /// is free then.
    pub(crate) fn resize(&mut self, slot: BufferSlot, len: usize) -> BufferSlot {
        if len > 0 && len <= slot.capacity && class(len).1 > slot.capacity / 3 {
            return BufferSlot { len, ..slot };
        }
        self.put_back(slot);
        self.take(len)
    }

    /// Frees a slot.
    pub(crate) fn put_back(&mut self, slot: BufferSlot) {
        if slot.capacity > 0 {
            let (class, _) = class(slot.capacity);
            self.free.resize(self.free.len().max(class + 1), Vec::new());
            self.free[class].push(slot.start);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_have_room() {
        let sizes = [1, 16, 17, 24, 25, 32, 33, 48, 49, 64].map(class);
        let expected =
            [(0, 16), (0, 16), (1, 24), (1, 24), (2, 32), (2, 32), (3, 48), (3, 48), (4, 64), (4, 64)];
        assert_eq!(sizes, expected);
        assert!((1..5_000).all(|len| class(len).1 >= len && class(class(len).1) == class(len)));
    }

    /// BufferSlots that are in use never overlap, and what is freed is used again.
    #[test]
    fn slots_are_apart() {
        let mut random = fastrand::Rng::with_seed(5);
        let (mut slots, mut used) = (BufferSlots::default(), Vec::<BufferSlot>::new());
        for _ in 0..2_000 {
            let len = random.usize(0..200);
            match random.u8(0..3) {
                0 => used.push(slots.take(len)),
                1 if !used.is_empty() => {
                    let slot = used.swap_remove(random.usize(0..used.len()));
                    slots.put_back(slot);
                }
                _ if !used.is_empty() => {
                    let place = random.usize(0..used.len());
                    used[place] = slots.resize(used[place], len);
                    assert_eq!(used[place].len, len);
                }
                _ => {}
            }
            let mut rooms: Vec<_> = used
                .iter()
                .map(|slot| slot.start..slot.start + slot.capacity)
                .filter(|room| !room.is_empty())
                .collect();
            rooms.sort_by_key(|room| room.start);
            assert!(rooms.windows(2).all(|pair| pair[0].end <= pair[1].start));
            assert!(rooms.last().is_none_or(|room| room.end <= slots.end()));
        }
        let end = slots.end();
        used.drain(..).for_each(|slot| slots.put_back(slot));
        assert!(slots.take(100).start < end && slots.end() == end);
    }
}
