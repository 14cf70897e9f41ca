//! The product, each field in units of the iso-value: `F = iso prod (f_i / iso)`, for two `f_1 f_2 / iso`.
//!
//! It is an intersection that blends: 0 as soon as one field is, and iso where all are. A child whose field
//! is iso changes nothing, a larger one fattens the others. (ParsIP's smooth difference `a (1 - b)`, whose
//! iso is 1/2, is half the product of a and the complement of b.) `f_i dF/df_i` is F for every child, so
//! attributes mix with equal weights, where F is positive.

use jbt_ir::Domain;

pub(super) fn field(fields: &[f64], iso: f64) -> f64 {
    iso * fields.iter().map(|f| f / iso).product::<f64>()
}

pub(super) fn weights(fields: &[f64], iso: f64) -> Vec<f64> {
    let weight = if field(fields, iso) > 0.0 { 1.0 } else { 0.0 };
    vec![weight; fields.len()]
}

/// The product of no operands, over the ops: iso.
pub(crate) fn start<D: Domain>(d: &mut D, iso2: D::Real) -> D::Real {
    let half = d.constant(0.5);
    d.mul(iso2, half)
}

/// One operand more, over the ops. A zero makes it a zero of some sign, for good.
pub(crate) fn step<D: Domain>(d: &mut D, product: D::Real, field: D::Real, iso2: D::Real) -> D::Real {
    let two = d.constant(2.0);
    let inverse = d.div(two, iso2);
    let relative = d.mul(field, inverse);
    d.mul(product, relative)
}

/// The field, over the ops: no zero is negative.
pub(crate) fn finish<D: Domain>(d: &mut D, product: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    d.add(product, zero)
}
