//! Which parts of a region have the same rows.

use jbt_ir::selection::MAX_PARTS;

/// Whose rows a part has.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum PartSelection {
    /// All of the region's.
    Whole,
    /// Those of an earlier part.
    Part(usize),
    /// Others than the region and all earlier parts.
    Own,
}

/// For each part of a region, whose rows it has.
pub(super) struct Sharing {
    pub(super) parts: [PartSelection; MAX_PARTS],
    /// How many parts have rows of their own.
    pub(super) own: usize,
}

impl Sharing {
    /// By masks of rows, with a bit for each part in which the row matters.
    pub(super) fn of(masks: &[u8], count: usize) -> Self {
        let whole = masks.iter().fold(u8::MAX, |all, mask| all & mask);
        // Bit `i` of an entry `n`: a row matters in one of the parts `i` and `i + n`, and not in the other.
        let differs: [u8; MAX_PARTS] =
            std::array::from_fn(|n| masks.iter().fold(0, |any, mask| any | (mask ^ mask >> n)));
        let of = |part: usize| {
            if whole >> part & 1 == 1 {
                return PartSelection::Whole;
            }
            let twin = (0..part).find(|earlier| differs[part - earlier] >> earlier & 1 == 0);
            twin.map_or(PartSelection::Own, PartSelection::Part)
        };
        let parts = std::array::from_fn(of);
        Self { parts, own: parts[..count].iter().filter(|&&of| of == PartSelection::Own).count() }
    }

    /// Moves the bits of the parts that have rows of their own to the low end.
    pub(super) fn gather(&self, masks: &mut [u8]) {
        let own = (0..MAX_PARTS).filter(|&part| self.parts[part] == PartSelection::Own);
        let mut places = [0; MAX_PARTS];
        places.iter_mut().zip(own.take(self.own)).for_each(|(place, part)| *place = part);
        for mask in masks {
            *mask = (0..self.own).fold(0, |bits, bit| bits | (*mask >> places[bit] & 1) << bit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twins_share_and_others_are_gathered() {
        use PartSelection::{Own, Part, Whole};
        let of = |parts: &[Option<usize>]| {
            // `Some` is the only row that matters there, `None` stands for all.
            let row = |row: usize| {
                (0..parts.len())
                    .fold(0, |bits, n| bits | u8::from(parts[n].is_none_or(|one| one == row)) << n)
            };
            let mut masks: Vec<u8> = (0..3).map(row).collect();
            let sharing = Sharing::of(&masks, parts.len());
            sharing.gather(&mut masks);
            (sharing.parts[..parts.len()].to_vec(), sharing.own, masks)
        };
        assert_eq!(of(&[None, None]), (vec![Whole, Whole], 0, vec![0; 3]));
        let parts = [Some(2), None, Some(2), Some(0), Some(2), Some(0), Some(1), None];
        let expected = vec![Own, Whole, Part(0), Own, Part(0), Part(3), Own, Whole];
        assert_eq!(of(&parts), (expected, 3, vec![2, 4, 1]));
    }
}
