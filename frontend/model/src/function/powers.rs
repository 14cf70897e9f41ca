//! Roots, powers and logarithms.

use jbt_ir::Domain;

use super::formulas::power;
use super::growth::Growth;
use super::member::FunctionMember;

/// Where powers of e are bounded.
const LARGEST_EXPONENT: f64 = 40.0;

/// The square root; in formulas of a point, that of a negative number is 0.
pub(super) struct Sqrt;

impl FunctionMember for Sqrt {
    const NAME: &'static str = "sqrt";
    const RESERVED: bool = true;

    fn value(x: &[f64]) -> f64 {
        x[0].sqrt()
    }

    fn total(x: &[f64]) -> f64 {
        x[0].max(0.0).sqrt()
    }

    fn kink_distance(x: &[f64]) -> f64 {
        x[0].abs().sqrt()
    }

    fn non_negative(_: &[bool]) -> bool {
        true
    }

    fn range(_: &[[f64; 2]]) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], positive: bool) -> D::Real {
        let zero = d.constant(0.0);
        let x = if positive { x[0] } else { d.max(x[0], zero) };
        d.sqrt(x)
    }
}

/// e to this power.
pub(super) struct Exp;

impl FunctionMember for Exp {
    const NAME: &'static str = "exp";
    const RESERVED: bool = true;

    fn value(x: &[f64]) -> f64 {
        x[0].exp()
    }

    fn kink_distance(_: &[f64]) -> f64 {
        f64::INFINITY
    }

    fn non_negative(_: &[bool]) -> bool {
        true
    }

    fn range(_: &[[f64; 2]]) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        let value = x[0].value.exp();
        let bounded = x[0].value <= LARGEST_EXPONENT;
        if bounded { Growth { value, slope: x[0].slope * value } } else { Growth::UNKNOWN }
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        d.exp(x[0])
    }
}

/// The natural logarithm; in formulas of a point, of at least the smallest normal f32.
pub(super) struct Ln;

impl FunctionMember for Ln {
    const NAME: &'static str = "ln";
    const RESERVED: bool = true;

    fn value(x: &[f64]) -> f64 {
        x[0].ln()
    }

    fn total(x: &[f64]) -> f64 {
        x[0].max(f64::from(f32::MIN_POSITIVE)).ln()
    }

    fn kink_distance(x: &[f64]) -> f64 {
        x[0].abs()
    }

    fn non_negative(_: &[bool]) -> bool {
        false
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let least = d.constant(f32::MIN_POSITIVE);
        let x = d.max(x[0], least);
        d.ln(x)
    }
}

/// The square.
pub(super) struct Square;

impl FunctionMember for Square {
    const NAME: &'static str = "square";

    fn value(x: &[f64]) -> f64 {
        x[0] * x[0]
    }

    fn kink_distance(_: &[f64]) -> f64 {
        f64::INFINITY
    }

    fn non_negative(_: &[bool]) -> bool {
        true
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        x[0].raised(2)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        d.mul(x[0], x[0])
    }
}

/// The first to the power of the second.
pub(super) struct Pow;

impl FunctionMember for Pow {
    const NAME: &'static str = "pow";
    const ARITY: (usize, usize) = (2, 2);
    const RESERVED: bool = true;

    fn value(x: &[f64]) -> f64 {
        x[0].powf(x[1])
    }

    fn kink_distance(x: &[f64]) -> f64 {
        x[0].abs()
    }

    fn non_negative(_: &[bool]) -> bool {
        true
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], positive: bool) -> D::Real {
        power(d, x[0], x[1], positive)
    }
}
