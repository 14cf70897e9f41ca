//! The union: the largest field. The child that has it wins; of equals, the first.

use jbt_ir::Domain;

pub(super) fn field(fields: &[f64]) -> f64 {
    fields[winner(fields)]
}

pub(super) fn winner(fields: &[f64]) -> usize {
    (1..fields.len()).fold(0, |best, i| if fields[i] > fields[best] { i } else { best })
}

pub(super) fn kink_distance(fields: &[f64]) -> f64 {
    super::member::lead(fields.iter().copied())
}

/// The larger of two fields, over the ops; the accumulated one if they are equal.
pub(crate) fn step<D: Domain>(d: &mut D, largest: D::Real, field: D::Real) -> D::Real {
    d.max(field, largest)
}

/// Whether an operand beats the largest so far.
pub(crate) fn beats<D: Domain>(d: &mut D, largest: D::Real, field: D::Real) -> D::Mask {
    d.lt(largest, field)
}
