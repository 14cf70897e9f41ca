//! Small formulas over the ops that skeletons share.

use jbt_ir::Domain;

/// The distance from the z axis.
pub(super) fn emit_off_axis<D: Domain>(d: &mut D, p: [D::Real; 3]) -> D::Real {
    let square = sum_of_squares(d, p[0], p[1]);
    d.sqrt(square)
}

/// The squared distance from all points within `radius` of a set, from the squared distance from the set:
/// `max(sqrt(square) - radius, 0)^2`.
pub(super) fn outside_squared<D: Domain>(d: &mut D, square: D::Real, radius: D::Real) -> D::Real {
    let distance = d.sqrt(square);
    let past = d.sub(distance, radius);
    let outside = positive_part(d, past);
    d.mul(outside, outside)
}

/// How far `x` is outside of `[-half, half]`: `max(|x| - half, 0)`.
pub(super) fn beyond<D: Domain>(d: &mut D, x: D::Real, half: D::Real) -> D::Real {
    let size = d.abs(x);
    let past = d.sub(size, half);
    positive_part(d, past)
}

/// `a^2 + b^2`, with one fused step.
pub(super) fn sum_of_squares<D: Domain>(d: &mut D, a: D::Real, b: D::Real) -> D::Real {
    let square = d.mul(a, a);
    d.fma(b, b, square)
}

/// `a . b`, with two fused steps.
pub(super) fn dot<D: Domain>(d: &mut D, a: [D::Real; 3], b: [D::Real; 3]) -> D::Real {
    let x = d.mul(a[0], b[0]);
    let xy = d.fma(a[1], b[1], x);
    d.fma(a[2], b[2], xy)
}

/// `v - x u`, with one fused step for each coordinate.
pub(super) fn minus_multiple<D: Domain>(
    d: &mut D,
    v: [D::Real; 3],
    x: D::Real,
    u: [D::Real; 3],
) -> [D::Real; 3] {
    let back = d.neg(x);
    std::array::from_fn(|axis| d.fma(back, u[axis], v[axis]))
}

/// `|v|`.
pub(super) fn length<D: Domain>(d: &mut D, v: [D::Real; 3]) -> D::Real {
    let square = length_squared(d, v);
    d.sqrt(square)
}

/// `|v|^2`, with two fused steps.
pub(crate) fn length_squared<D: Domain>(d: &mut D, [x, y, z]: [D::Real; 3]) -> D::Real {
    let square = sum_of_squares(d, x, y);
    d.fma(z, z, square)
}

/// `max(x, 0)`: zero for NaN, and never -0.
pub(crate) fn positive_part<D: Domain>(d: &mut D, x: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    d.max(x, zero)
}

/// `x` between 0 and 1; 0 for NaN.
pub(crate) fn emit_unit<D: Domain>(d: &mut D, x: D::Real) -> D::Real {
    let (zero, one) = (d.constant(0.0), d.constant(1.0));
    let x = d.max(x, zero);
    d.min(x, one)
}
