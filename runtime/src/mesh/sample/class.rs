//! Classes of points of a brick: which bricks may own them, in the order of preference.

use super::super::brick::{SELF, direction};

/// Marks a class of points that a brick does not own.
pub(super) const FOREIGN: u16 = u16::MAX;

/// Low, middle or high along each axis.
pub(super) type Kinds = [u8; 3];
pub(super) const LOW: u8 = 0;
pub(super) const MIDDLE: u8 = 1;
pub(super) const HIGH: u8 = 2;

/// A brick that may own the points of a class: its direction, and the class of the points in it.
#[derive(Clone, Copy)]
pub(super) struct ClassOwner {
    pub(super) direction: u8,
    pub(super) kinds: Kinds,
}

/// Points of a brick with one kind along each axis.
#[derive(Clone, Copy)]
pub(super) struct Class {
    pub(super) kinds: Kinds,
    /// In the order of preference, up to the brick itself.
    pub(super) candidates: [ClassOwner; 8],
    pub(super) count: usize,
    /// The directions of all candidates but the brick itself, a bit each.
    pub(super) before: u32,
}

/// All classes; that of kinds `(a, b, c)` is `a + 3 b + 9 c`.
pub(super) static CLASSES: [Class; 27] = {
    let itself = ClassOwner { direction: SELF as u8, kinds: [LOW; 3] };
    let empty = Class { kinds: [LOW; 3], candidates: [itself; 8], count: 0, before: 0 };
    let mut classes = [empty; 27];
    let mut number = 0;
    while number < 27 {
        classes[number] = class([(number % 3) as u8, (number / 3 % 3) as u8, (number / 9) as u8], empty);
        number += 1;
    }
    classes
};

const fn class(kinds: Kinds, empty: Class) -> Class {
    let mut class = Class { kinds, ..empty };
    // The brick above along every axis comes first; a bit of `below` takes the one below along an axis
    // instead.
    let mut below = 0;
    while below < 8 {
        let (mut steps, mut seen, mut exists) = ([0_i8; 3], kinds, true);
        let mut axis = 0;
        while axis < 3 {
            let is_below = below >> axis & 1 == 1;
            match kinds[axis] {
                LOW if is_below => (steps[axis], seen[axis]) = (-1, HIGH),
                HIGH if !is_below => (steps[axis], seen[axis]) = (1, LOW),
                MIDDLE if is_below => exists = false,
                _ => {}
            }
            axis += 1;
        }
        if exists {
            let direction = direction(steps);
            class.candidates[class.count] = ClassOwner { direction: direction as u8, kinds: seen };
            class.count += 1;
            if direction == SELF {
                break;
            }
            class.before |= 1 << direction;
        }
        below += 1;
    }
    class
}

pub(super) const fn class_number(kinds: Kinds) -> usize {
    kinds[0] as usize + 3 * kinds[1] as usize + 9 * kinds[2] as usize
}

/// For each set of axes: the classes that are high on exactly these axes. The brick in that direction owns
/// them, if it exists.
pub(super) static SIDES: [(usize, &[usize]); 7] = [
    (direction([1, 0, 0]), &[2, 5, 11, 14]),
    (direction([0, 1, 0]), &[6, 7, 15, 16]),
    (direction([1, 1, 0]), &[8, 17]),
    (direction([0, 0, 1]), &[18, 19, 21, 22]),
    (direction([1, 0, 1]), &[20, 23]),
    (direction([0, 1, 1]), &[24, 25]),
    (direction([1, 1, 1]), &[26]),
];

/// The first index of a kind in a brick with this many cells along the axis, and the number of indices.
pub(super) fn span(kind: u8, cells: usize) -> (usize, usize) {
    match kind {
        LOW => (0, 1),
        MIDDLE => (1, cells - 1),
        _ => (cells, 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_stand_with_the_axes_that_they_are_high_on() {
        let mut seen = 0_u32;
        for (side, classes) in SIDES {
            for &class in classes {
                let Class { kinds, candidates, count, before } = CLASSES[class];
                let steps = kinds.map(|kind| i8::from(kind == HIGH));
                assert_eq!((direction(steps), class_number(kinds)), (side, class));
                // The half-open owner comes first, the brick itself last.
                assert_eq!(usize::from(candidates[0].direction), side);
                assert_eq!(usize::from(candidates[count - 1].direction), SELF);
                assert_eq!(candidates[count - 1].kinds, kinds);
                assert_eq!(before.count_ones() as usize, count - 1);
                seen |= 1 << class;
            }
        }
        assert_eq!(seen.count_ones(), 27 - 8);
    }
}
