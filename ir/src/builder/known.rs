//! Which instructions there are, so that none is written twice: a table of values, found by what defines
//! them.
//!
//! It keeps four bytes for each place, because a function may have a million values: what defines a value
//! stands in the function, and whoever asks says where. An instruction has its place beside those that were
//! written when it was: what is looked at together is near in memory.
//!
//! ```text
//! places   [.. those whose last operand is near v700 ..][.. v710 ..] .. [.. v9000 ..]
//!            `- a few, from a place by the last operand;  then, where all of these are taken, from a place
//!               by the whole key: no choice of operands makes a long row of taken places
//! ```

use crate::entity::{Entity, Value};
use crate::function::InstKind;
use crate::watch::look;

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

    /// The places where it is looked for, one after the other, of so many and one.
    fn places(self, most: usize) -> impl Iterator<Item = usize> {
        let hash = self.hash();
        let near = self.last_operand().map(|last| 2 * last + (hash >> 32) as usize % SPREAD);
        let near = near.into_iter().flat_map(move |first| (first..first + NEAR).map(move |at| at & most));
        near.chain((0..).map(move |at| (hash as usize).wrapping_add(at) & most))
    }

    /// The last of the values that an op is done on.
    fn last_operand(self) -> Option<usize> {
        let is_op = self.what >= Self::OPS;
        is_op
            .then(|| self.of.into_iter().filter(|&of| of != Self::NONE).max())
            .flatten()
            .map(|of| of as usize)
    }
}

/// Places beside the last operand that are tried.
const NEAR: usize = 16;
/// Places over which instructions on the same operand are spread.
const SPREAD: usize = 16;

/// A place of the table.
#[derive(Clone, Copy)]
pub(super) struct KnownPlace(usize);

/// The table. At most half of its places are taken, so that a free one is near.
#[derive(Default)]
pub(super) struct KnownInsts {
    /// Values, as 1 and their index; 0 is free. Their number is a power of two.
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
        let before = std::mem::replace(&mut self.places, vec![0; wanted]);
        for place in before.into_iter().filter(|&place| place != 0) {
            look();
            if let Some(key) = key_of(value_at(place)) {
                let KnownPlace(free) = self.place(key, |_| false);
                self.places[free] = place;
            }
        }
    }

    /// Where a key is, or would be: whoever asks says which values have it. There is room for it.
    fn place(&self, key: Key, has_key: impl Fn(Value) -> bool) -> KnownPlace {
        let is_it = |&place: &usize| self.places[place] == 0 || has_key(value_at(self.places[place]));
        KnownPlace(key.places(self.places.len() - 1).find(is_it).expect("at most half of them are taken"))
    }

    /// The value that a key has, and its place, which is free if there is none.
    pub(super) fn find(
        &mut self,
        key: Key,
        key_of: impl Fn(Value) -> Option<Key>,
    ) -> (Option<Value>, KnownPlace) {
        self.reserve(1, &key_of);
        let KnownPlace(place) = self.place(key, |value| key_of(value) == Some(key));
        (Some(self.places[place]).filter(|&taken| taken != 0).map(value_at), KnownPlace(place))
    }

    /// Gives a place its value: a new one, or one that takes the place of another with the same key.
    pub(super) fn set(&mut self, KnownPlace(place): KnownPlace, value: Value) {
        self.taken += usize::from(self.places[place] == 0);
        self.places[place] = value.index() as u32 + 1;
    }
}

fn value_at(place: u32) -> Value {
    Value::new(place as usize - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps beyond the first place until a place is found, on average, for keys that come one after another.
    fn steps(keys: impl Iterator<Item = [u32; 3]>) -> f64 {
        let (mut known, mut steps, mut count) = (KnownInsts::default(), 0, 0);
        known.reserve(100_000, |_| None);
        let most = known.places.len() - 1;
        for of in keys {
            let key = Key { what: Key::OPS, of };
            let place = known.place(key, |_| false);
            steps += key.places(most).position(|at| at == place.0).expect("it is one of them");
            known.set(place, Value::new(count));
            count += 1;
        }
        steps as f64 / count as f64
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
        let (most, none) = (1 << 20, u32::MAX);
        let first = |of| Key { what: Key::OPS, of }.places(most - 1).next().expect("there is one");
        let places: Vec<usize> = (0..1000).map(|i| first([i, 0, none])).collect();
        assert!(places.windows(2).all(|two| two[0].abs_diff(two[1]) < 2 * SPREAD), "{places:?}");
    }
}
