//! The rows that an operator's rule keeps.

use jbt_lower::prune_info::Rule;

/// Turns the rows that reach boxes into the rows to keep. `masks` has a byte for each active row of a table,
/// with a bit for each box that the row reaches; `starts` are the starts of the selection.
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
}
