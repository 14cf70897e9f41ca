//! The rows that an operator's rule keeps.

use std::ops::Range;

use jbt_lower::prune_info::Rule;

/// Turns the rows that reach boxes into the rows to keep. `masks` has a byte for each active row of a table,
/// with a bit for each box that the row reaches (a row without the bit is zero in the box); `starts` are the
/// starts of the selection.
pub(super) fn apply(rule: Rule, starts: &[u32], masks: &mut [u8], all: u8) {
    match rule {
        // A zero adds nothing.
        Rule::Neutral => {}
        Rule::Never => masks.fill(all),
        Rule::KeepOne => each_range(starts, masks, |range| {
            let mut zeros = 0;
            for mask in range {
                let first = all & !*mask & !zeros;
                zeros |= first;
                *mask |= first;
            }
        }),
        Rule::OnlyZero => each_range(starts, masks, |range| {
            let zeros = range.iter().fold(0, |zeros, mask| zeros | (all & !mask));
            let mut found = 0;
            for mask in range {
                let first = all & !*mask & !found;
                found |= first;
                *mask = (*mask & !zeros) | first;
            }
        }),
    }
}

/// Adds to the positions from `before` on, which are those of rows that reach a box, the zero rows to keep of
/// one owner, or lets those go that may. `owned` are the positions of all rows of the owner.
pub(super) fn complete(rule: Rule, owned: Range<u32>, before: usize, stay: &mut Vec<u32>) {
    // The first row that is zero.
    let reached = stay[before..].iter().map(Some).chain(std::iter::repeat(None));
    let zero = owned.clone().zip(reached).find(|(position, reached)| *reached != Some(position));
    let zero = zero.map(|(position, _)| position);
    match rule {
        Rule::Neutral => {}
        Rule::Never => {
            stay.truncate(before);
            stay.extend(owned);
        }
        Rule::KeepOne => {
            if let Some(zero) = zero {
                stay.insert(before + (zero - owned.start) as usize, zero);
            }
        }
        Rule::OnlyZero => {
            if let Some(zero) = zero {
                stay.truncate(before);
                stay.push(zero);
            }
        }
    }
}

fn each_range(starts: &[u32], masks: &mut [u8], mut what: impl FnMut(&mut [u8])) {
    for range in starts.windows(2) {
        what(&mut masks[range[0] as usize..range[1] as usize]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn applied(rule: Rule, starts: &[u32], mut masks: Vec<u8>) -> Vec<u8> {
        apply(rule, starts, &mut masks, 0b11);
        masks
    }

    #[test]
    fn each_rule() {
        let masks = || vec![0b00, 0b10, 0b00, 0b11, 0b01];
        assert_eq!(applied(Rule::Neutral, &[0, 5], masks()), masks());
        assert_eq!(applied(Rule::Never, &[0, 5], masks()), [0b11; 5]);
        // The first zero of each box stays.
        assert_eq!(applied(Rule::KeepOne, &[0, 5], masks()), [0b11, 0b10, 0b00, 0b11, 0b01]);
        assert_eq!(applied(Rule::KeepOne, &[0, 1, 5], masks()), [0b11, 0b11, 0b10, 0b11, 0b01]);
        // Where anything is zero, that alone stays.
        assert_eq!(applied(Rule::OnlyZero, &[0, 5], masks()), [0b11, 0, 0, 0, 0]);
        assert_eq!(applied(Rule::OnlyZero, &[0, 0, 3, 5], masks()), [0b11, 0, 0, 0b01, 0b11]);
    }

    #[test]
    fn positions_are_completed_as_masks_are() {
        let mut rng = fastrand::Rng::with_seed(1);
        for rule in [Rule::Neutral, Rule::Never, Rule::KeepOne, Rule::OnlyZero] {
            for _ in 0..200 {
                let (start, count) = (rng.u32(0..5), rng.u32(0..6));
                let mut masks: Vec<u8> = (0..count).map(|_| rng.u8(0..2)).collect();
                let owned = start..start + count;
                let places = |masks: &[u8]| -> Vec<u32> {
                    owned.clone().zip(masks).filter(|(_, mask)| **mask != 0).map(|(place, _)| place).collect()
                };
                let mut stay = vec![77];
                stay.extend(places(&masks));
                complete(rule, owned.clone(), 1, &mut stay);
                apply(rule, &[0, count], &mut masks, 1);
                assert_eq!(stay[1..], places(&masks), "{rule:?}");
            }
        }
    }
}
