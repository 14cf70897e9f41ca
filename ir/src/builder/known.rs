//! Which instructions there are, so that none is written twice: a table of values, found by what defines
//! them.
//!
//! It keeps four bytes for each place, because a function may have a million values: the value, and some bits
//! of its key's hash. What defines a value stands in the function, and whoever asks says where; the bits say
//! whether it is worth asking. An instruction has its place beside those that were written when it was: what
//! is looked at together is near in memory.
//!
//! ```text
//! places   [.. those whose last operand is near v700 ..][.. v710 ..] .. [.. v9000 ..]
//!            `- a few, from a place by the last operand;  then, where all of these are taken, from a place
//!               by the whole key: no choice of operands makes a long row of taken places
//! ```

use crate::entity::{Entity, Value};
use crate::function::InstKind;
use crate::limits::MAX_VALUES;
use crate::watch::{self, look};

/// What makes two instructions the same: what they are, and up to three numbers of theirs.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Key {
    what: u32,
    of: [u32; 3],
}

impl Key {
    /// A number that no operand has.
    const NONE: u32 = u32::MAX;
    /// What ops begin at.
    const OPS: u32 = 4;

    /// The key of an instruction; folds are never the same.
    pub(super) fn new(kind: &InstKind) -> Option<Self> {
        let (what, of) = match kind {
            InstKind::Input(index) => (0, [*index as u32, 0, 0]),
            InstKind::Constant(number) => (1, [number.to_bits(), 0, 0]),
            InstKind::BitsConstant(bits) => (2, [*bits, 0, 0]),
            InstKind::Column { table, column } => (3, [table.index() as u32, *column as u32, 0]),
            InstKind::Op { op, args } => {
                let mut of = [Self::NONE; 3];
                for (place, arg) in of.iter_mut().zip(args) {
                    *place = arg.index() as u32;
                }
                (Self::OPS + *op as u32, of)
            }
            InstKind::Fold(_) => return None,
        };
        Some(Self { what, of })
    }

    /// A number that tells keys apart. Keys are numbers that count up, which a product alone leaves in a row:
    /// both halves of a long product tell them apart.
    fn hash(self) -> u64 {
        const ODD: [u64; 2] = [0x9e37_79b9_7f4a_7c15, 0xd1b5_4a32_d192_ed03];
        let both = |low: u32, high: u32| u64::from(low) | u64::from(high) << 32;
        let [a, b] = [both(self.what, self.of[0]) ^ ODD[0], both(self.of[1], self.of[2]) ^ ODD[1]];
        let product = u128::from(a) * u128::from(b);
        product as u64 ^ (product >> 64) as u64
    }

    /// The last of the values that an op is done on.
    fn last_operand(self) -> Option<usize> {
        // `NONE` wraps to 0.
        let behind_last = self.of.map(|of| of.wrapping_add(1)).into_iter().fold(0, u32::max);
        (self.what >= Self::OPS).then(|| behind_last as usize - 1)
    }
}

/// Places beside the last operand that are tried.
const NEAR: usize = 16;
/// Places over which instructions on the same operand are spread.
const SPREAD: usize = 16;

/// A place of the table, for a key with this hash.
#[derive(Clone, Copy)]
pub(super) struct KnownPlace {
    at: usize,
    hash: u64,
}

/// What stands at a place: a value, and as many bits of its key's hash as the number of a value leaves.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Taken(u32);

impl Taken {
    /// A place that is free: values are kept as 1 and their index.
    const FREE: Self = Self(0);
    /// Bits of a value.
    const VALUE: u32 = (MAX_VALUES as u32 + 1).ilog2() + 1;

    fn new(value: Value, hash: u64) -> Self {
        let of = value.index() as u32 + 1;
        debug_assert!(of >> Self::VALUE == 0, "a full function keeps no more values");
        Self(of | Self::bits(hash))
    }

    /// The hash's bits, where they stand: the lowest and those in its middle say where a key is looked for.
    fn bits(hash: u64) -> u32 {
        (hash >> 32) as u32 >> Self::VALUE << Self::VALUE
    }

    /// Whether the value's key may have this hash.
    fn may_be(self, hash: u64) -> bool {
        (self.0 ^ Self::bits(hash)) >> Self::VALUE == 0
    }

    /// The value; `None` if the place is free.
    fn value(self) -> Option<Value> {
        (self != Self::FREE).then(|| Value::new((self.0 & ((1 << Self::VALUE) - 1)) as usize - 1))
    }
}

/// The table. At most half of its places are taken, so that a free one is near.
#[derive(Default)]
pub(super) struct KnownInsts {
    /// What is [`Taken`]. Their number is a power of two. Numbers, because the system has zeros ready.
    places: Vec<u32>,
    taken: usize,
}

impl KnownInsts {
    /// Room for so many more.
    pub(super) fn reserve(&mut self, more: usize, key_of: impl Fn(Value) -> Option<Key>) {
        let wanted = ((self.taken + more) * 2).next_power_of_two().max(16);
        if wanted <= self.places.len() {
            return;
        }
        watch::take(wanted * size_of::<u32>());
        let before = std::mem::replace(&mut self.places, vec![Taken::FREE.0; wanted]);
        for value in before.into_iter().filter_map(|place| Taken(place).value()) {
            look();
            if let Some(key) = key_of(value) {
                let hash = key.hash();
                let place = self.place(key, hash, |taken| taken == Taken::FREE);
                self.places[place] = Taken::new(value, hash).0;
            }
        }
    }

    /// The first place, of those where a key with this hash is looked for, that is the one. There is room for
    /// the key.
    #[inline]
    fn place(&self, key: Key, hash: u64, is_it: impl Fn(Taken) -> bool) -> usize {
        let most = self.places.len() - 1;
        if let Some(last) = key.last_operand() {
            let first = 2 * last + (hash >> 32) as usize % SPREAD;
            for at in first..first + NEAR {
                if is_it(Taken(self.places[at & most])) {
                    return at & most;
                }
            }
        }
        let mut at = hash as usize & most;
        // At most half of them are taken.
        while !is_it(Taken(self.places[at])) {
            at = (at + 1) & most;
        }
        at
    }

    /// The value that a key has, and its place, which is free if there is none.
    pub(super) fn find(
        &mut self,
        key: Key,
        key_of: impl Fn(Value) -> Option<Key>,
    ) -> (Option<Value>, KnownPlace) {
        self.reserve(1, &key_of);
        let hash = key.hash();
        let at = self.place(key, hash, |taken| {
            taken.value().is_none_or(|value| taken.may_be(hash) && key_of(value) == Some(key))
        });
        (Taken(self.places[at]).value(), KnownPlace { at, hash })
    }

    /// Gives a place its value: a new one, or one that takes the place of another with the same key.
    pub(super) fn set(&mut self, KnownPlace { at, hash }: KnownPlace, value: Value) {
        self.taken += usize::from(Taken(self.places[at]) == Taken::FREE);
        self.places[at] = Taken::new(value, hash).0;
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Steps beyond the first place until a place is found, on average, for keys that come one after another.
    fn steps(keys: impl Iterator<Item = [u32; 3]>) -> f64 {
        let (mut known, looked, mut count) = (KnownInsts::default(), Cell::new(0), 0);
        known.reserve(100_000, |_| None);
        for of in keys {
            let key = Key { what: Key::OPS, of };
            let hash = key.hash();
            let at = known.place(key, hash, |taken| {
                looked.set(looked.get() + 1);
                taken == Taken::FREE
            });
            known.set(KnownPlace { at, hash }, Value::new(count));
            count += 1;
        }
        f64::from(looked.get()) / count as f64 - 1.0
    }

    #[test]
    fn chains_sums_and_products_find_their_places_at_once() {
        let none = u32::MAX;
        // Miri takes a thousand times as long.
        let count = if cfg!(miri) { 1_000 } else { 100_000 };
        let chain = steps((0..count).map(|i| [i, 0, none]));
        let pairs = steps((1..count).map(|i| [i, i - 1, none]));
        let sums = steps((0..count).map(|i| [3 * i + 2, 3 * i + 4, none]));
        let fused = steps((0..count).map(|i| [2 * i + 1, 7, 2 * i]));
        for (what, steps) in [("chain", chain), ("pairs", pairs), ("sums", sums), ("fused", fused)] {
            assert!(steps < 2.0, "{what}: {steps}");
        }
        // All of them are beside one place.
        let star = steps((0..count).map(|i| [i, count, none]));
        assert!(star < NEAR as f64 + 2.0, "{star}");
    }

    #[test]
    fn neighbours_are_found_side_by_side() {
        let mut known = KnownInsts::default();
        known.reserve(1 << 19, |_| None);
        let first = |of| {
            let key = Key { what: Key::OPS, of };
            known.place(key, key.hash(), |_| true)
        };
        let places: Vec<usize> = (0..1000).map(|i| first([i, 0, u32::MAX])).collect();
        assert!(places.windows(2).all(|two| two[0].abs_diff(two[1]) < 2 * SPREAD), "{places:?}");
    }
}
