//! The sum of fields: the blend that made blobs famous (Blinn 1982). Homogeneous of degree 1, so the weight
//! of a child is its field.

use jbt_ir::Domain;

use crate::skeleton::positive_part;

pub(super) fn field(fields: &[f64]) -> f64 {
    fields.iter().sum()
}

pub(super) fn weights(fields: &[f64]) -> Vec<f64> {
    fields.iter().map(|f| f.max(0.0)).collect()
}

/// One operand more, over the ops.
pub(crate) fn step<D: Domain>(d: &mut D, sum: D::Real, field: D::Real) -> D::Real {
    d.add(sum, field)
}

/// The weight of an operand, over the ops.
pub(crate) fn weight<D: Domain>(d: &mut D, field: D::Real, non_negative: bool) -> D::Real {
    if non_negative { field } else { positive_part(d, field) }
}
