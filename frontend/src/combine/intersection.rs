//! The intersection: the smallest field. The child that has it wins; of equals, the first.

use jbt_ir::Domain;

pub(super) fn field(fields: &[f64]) -> f64 {
    fields[winner(fields)]
}

pub(super) fn winner(fields: &[f64]) -> usize {
    (1..fields.len()).fold(0, |best, i| if fields[i] < fields[best] { i } else { best })
}

pub(super) fn kink_distance(fields: &[f64]) -> f64 {
    super::member::lead(fields.iter().map(|f| -f))
}

/// The smaller of two fields, over the ops; the accumulated one if they are equal.
pub(crate) fn step<D: Domain>(d: &mut D, smallest: D::Real, field: D::Real) -> D::Real {
    d.min(field, smallest)
}

/// Whether an operand beats the smallest so far.
pub(crate) fn beats<D: Domain>(d: &mut D, smallest: D::Real, field: D::Real) -> D::Mask {
    d.lt(field, smallest)
}
