//! Lists of numbers.

use jbt_model::field::NumberText as _;
use jbt_model::particles::NumberArray;

/// A list of numbers, or of vectors of so many numbers. A long one is broken into lines.
pub(super) fn list(out: &mut String, numbers: &NumberArray, width: usize) {
    const NUMBERS_OF_A_LINE: usize = 12;
    let in_a_line = (NUMBERS_OF_A_LINE / width).max(1);
    out.push('(');
    for first in (0..numbers.len()).step_by(width) {
        if first > 0 {
            out.push(if (first / width).is_multiple_of(in_a_line) { '\n' } else { ' ' });
        }
        if width == 1 {
            out.push_str(&numbers.at(first).text());
            continue;
        }
        for index in first..numbers.len().min(first + width) {
            out.push(if index == first { '(' } else { ' ' });
            out.push_str(&numbers.at(index).text());
        }
        out.push(')');
    }
    out.push(')');
}
