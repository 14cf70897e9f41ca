//! Which elements of two lists belong together, and which of them stand in another order.
//!
//! ```text
//! a b c d      b c a x        b c in place, a has moved, d and x are in one alone
//! ```

use std::collections::HashMap;
use std::hash::Hash;

/// An element of one list, or one of each.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Pair {
    /// Its places in both.
    pub places: [Option<usize>; 2],
    /// Both places, if others stay in their order when this one is moved.
    pub moved: Option<[usize; 2]>,
}

/// Partners so far.
pub(super) struct Partners {
    /// That of each element of the first list.
    first: Vec<Option<usize>>,
    /// Which elements of the second list have one.
    taken: Vec<bool>,
}

impl Partners {
    /// Nobody has a partner yet.
    pub(super) fn new(first: usize, second: usize) -> Self {
        Self { first: vec![None; first], taken: vec![false; second] }
    }

    /// Whether elements of both lists have none.
    pub(super) fn is_open(&self) -> bool {
        self.first.contains(&None) && self.taken.contains(&false)
    }

    /// Those without a partner meet those with an equal key, in order. Nobody meets by the key `none`.
    pub(super) fn meet<K: Eq + Hash>(&mut self, first: &[K], second: &[K], none: &K) {
        let mut waiting: HashMap<&K, Vec<usize>> = HashMap::new();
        for (place, key) in second.iter().enumerate().rev().filter(|(place, _)| !self.taken[*place]) {
            waiting.entry(key).or_default().push(place);
        }
        for (partner, key) in self.first.iter_mut().zip(first) {
            if partner.is_none() && key != none {
                *partner = waiting.get_mut(key).and_then(Vec::pop);
                partner.iter().for_each(|&at| self.taken[at] = true);
            }
        }
    }

    /// All elements: those of the first list in order, then those of the second alone.
    pub(super) fn pairs(self) -> Vec<Pair> {
        let in_place = longest_rising(self.first.iter().copied().flatten());
        let mut stays = in_place.into_iter();
        let mut pairs: Vec<Pair> = Vec::with_capacity(self.first.len());
        for (place, &partner) in self.first.iter().enumerate() {
            let stays = partner.is_none() || stays.next() == Some(true);
            let moved = partner.filter(|_| !stays).map(|partner| [place, partner]);
            pairs.push(Pair { places: [Some(place), partner], moved });
        }
        let alone = (0..self.taken.len()).filter(|&place| !self.taken[place]);
        pairs.extend(alone.map(|place| Pair { places: [None, Some(place)], moved: None }));
        pairs
    }
}

/// Which numbers are part of a longest rising sequence among these, of which no two are equal (Schensted
/// 1961).
fn longest_rising(numbers: impl Iterator<Item = usize>) -> Vec<bool> {
    let numbers: Vec<usize> = numbers.collect();
    // The place of the least last number of a rising sequence of each length, and what stands before it.
    let mut ends: Vec<usize> = Vec::new();
    let mut before: Vec<Option<usize>> = Vec::with_capacity(numbers.len());
    for (place, &number) in numbers.iter().enumerate() {
        let length = ends.partition_point(|&end| numbers[end] < number);
        before.push(length.checked_sub(1).map(|shorter| ends[shorter]));
        if length == ends.len() {
            ends.push(place);
        } else {
            ends[length] = place;
        }
    }
    let mut chosen = vec![false; numbers.len()];
    let mut next = ends.last().copied();
    while let Some(place) = next {
        chosen[place] = true;
        next = before[place];
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(first: &str, second: &str) -> Vec<(String, Option<[usize; 2]>)> {
        let [first, second]: [Vec<char>; 2] = [first, second].map(|text| text.chars().collect());
        let mut partners = Partners::new(first.len(), second.len());
        partners.meet(&first, &second, &'-');
        let word = |list: &[char], place: Option<usize>| place.map_or(' ', |at| list[at]);
        let pair =
            |Pair { places: [a, b], moved }| (format!("{}{}", word(&first, a), word(&second, b)), moved);
        partners.pairs().into_iter().map(pair).collect()
    }

    #[test]
    fn what_moves_is_as_little_as_may_be() {
        let plain = |text: &str| (text.to_owned(), None);
        let moved = |text: &str, from, to| (text.to_owned(), Some([from, to]));
        assert_eq!(told("ab", "ab"), [plain("aa"), plain("bb")]);
        assert_eq!(
            told("abcd", "bcax"),
            [moved("aa", 0, 2), plain("bb"), plain("cc"), plain("d "), plain(" x")]
        );
        assert_eq!(told("-a", "a-"), [plain("- "), plain("aa"), plain(" -")]);
        // Equal ones meet in order.
        assert_eq!(told("aab", "aba").iter().filter(|pair| pair.1.is_some()).count(), 1);
        let count = |text: &str| told("abcdefgh", text).iter().filter(|pair| pair.1.is_some()).count();
        assert_eq!(
            [count("bcdefgha"), count("habcdefg"), count("hgfedcba"), count("badcfehg")],
            [1, 1, 7, 4]
        );
    }
}
