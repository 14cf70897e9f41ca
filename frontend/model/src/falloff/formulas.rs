//! Small formulas that several falloffs share.

use jbt_ir::Domain;

use crate::skeleton::positive_part;

/// The `s` in [0, 1] where a falling `value` passes `level`.
pub(super) fn bisect(value: impl Fn(f64) -> f64, level: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > f64::EPSILON * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if value(middle) >= level { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The exponent as a whole number, if it is whole and in [1, `most`]: then it is code.
pub(super) fn whole(exponent: f64, most: u8) -> Option<u8> {
    let n = exponent as u8;
    (f64::from(n) == exponent && (1..=most).contains(&n)).then_some(n)
}

/// `s = 1 - u`, from 0 to 1, for falloffs that are flat at the skeleton.
pub(super) fn emit_square<D: Domain>(d: &mut D, u: D::Real) -> D::Real {
    let one = d.constant(1.0);
    let s = d.sub(one, u);
    positive_part(d, s)
}

/// `r = sqrt(1 - u)`, from 0 to 1, for falloffs that are flat at the skeleton.
pub(super) fn emit_distance<D: Domain>(d: &mut D, u: D::Real) -> D::Real {
    let s = emit_square(d, u);
    d.sqrt(s)
}

/// `1 - r = u / (1 + r)`: this form is exactly 0 at the rim and rises with u.
pub(super) fn emit_depth<D: Domain>(d: &mut D, u: D::Real, r: D::Real) -> D::Real {
    let one = d.constant(1.0);
    let sum = d.add(one, r);
    d.div(u, sum)
}

/// `value`, or exactly 0 at u = 0.
pub(super) fn emit_inside<D: Domain>(d: &mut D, u: D::Real, value: D::Real) -> D::Real {
    let zero = d.constant(0.0);
    let inside = d.lt(zero, u);
    d.select(inside, value, zero)
}
