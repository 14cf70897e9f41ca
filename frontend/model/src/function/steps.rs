//! Functions with jumps and kinks, of one number or two.

use jbt_ir::Domain;

use super::formulas::{floor, nearest, remainder, to_whole};
use super::growth::Growth;
use super::member::{ANY, FunctionMember};

/// The magnitude.
pub(super) struct Abs;

impl FunctionMember for Abs {
    const NAME: &'static str = "abs";
    const RESERVED: bool = true;

    fn value(x: &[f64]) -> f64 {
        x[0].abs()
    }

    fn kink_distance(x: &[f64]) -> f64 {
        x[0].abs()
    }

    fn non_negative(_: &[bool]) -> bool {
        true
    }

    fn range(_: &[[f64; 2]]) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        x[0]
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        d.abs(x[0])
    }
}

/// -1, 0 or 1.
pub(super) struct Sign;

impl FunctionMember for Sign {
    const NAME: &'static str = "sign";

    fn value(x: &[f64]) -> f64 {
        if x[0] == 0.0 { 0.0 } else { x[0].signum() }
    }

    fn kink_distance(x: &[f64]) -> f64 {
        x[0].abs()
    }

    fn non_negative(x: &[bool]) -> bool {
        x.iter().all(|&sign| sign)
    }

    fn growth(_: &[Growth], _: Option<f64>) -> Growth {
        Growth::still(1.0)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        let (above, below) = (d.lt(zero, x[0]), d.lt(x[0], zero));
        let minus = d.constant(-1.0);
        let not_above = d.select(below, minus, zero);
        d.select(above, one, not_above)
    }
}

/// Down to a whole number.
pub(super) struct Floor;

impl FunctionMember for Floor {
    const NAME: &'static str = "floor";

    fn value(x: &[f64]) -> f64 {
        x[0].floor()
    }

    fn kink_distance(x: &[f64]) -> f64 {
        to_whole(x[0])
    }

    fn non_negative(x: &[bool]) -> bool {
        x.iter().all(|&sign| sign)
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        Growth::still(x[0].value + 1.0)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        floor(d, x[0])
    }
}

/// Up to a whole number.
pub(super) struct Ceil;

impl FunctionMember for Ceil {
    const NAME: &'static str = "ceil";

    fn value(x: &[f64]) -> f64 {
        x[0].ceil()
    }

    fn kink_distance(x: &[f64]) -> f64 {
        to_whole(x[0])
    }

    fn non_negative(x: &[bool]) -> bool {
        x.iter().all(|&sign| sign)
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        Growth::still(x[0].value + 1.0)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let minus = d.neg(x[0]);
        let floor = floor(d, minus);
        d.neg(floor)
    }
}

/// To the nearest whole number, ties to the even one.
pub(super) struct Round;

impl FunctionMember for Round {
    const NAME: &'static str = "round";

    fn value(x: &[f64]) -> f64 {
        x[0].round_ties_even()
    }

    fn kink_distance(x: &[f64]) -> f64 {
        to_whole(x[0] + 0.5)
    }

    fn non_negative(x: &[bool]) -> bool {
        x.iter().all(|&sign| sign)
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        Growth::still(x[0].value + 1.0)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        nearest(d, x[0])
    }
}

/// What is left of the first after whole multiples of the second: at least 0, and below the second's
/// magnitude.
pub(super) struct Mod;

impl FunctionMember for Mod {
    const NAME: &'static str = "mod";
    const ARITY: (usize, usize) = (2, 2);

    fn value(x: &[f64]) -> f64 {
        let by = x[1].abs();
        x[0] - by * (x[0] / by).floor()
    }

    fn total(x: &[f64]) -> f64 {
        if x[1] == 0.0 { 0.0 } else { Self::value(x) }
    }

    fn kink_distance(x: &[f64]) -> f64 {
        if x[1] == 0.0 { 0.0 } else { to_whole(x[0] / x[1]) * x[1].abs() }
    }

    fn non_negative(_: &[bool]) -> bool {
        true
    }

    fn range(x: &[[f64; 2]]) -> [f64; 2] {
        if x[0] == [0.0; 2] { [0.0; 2] } else { ANY }
    }

    fn growth(x: &[Growth], divisor: Option<f64>) -> Growth {
        let of = |divisor: f64| Growth { value: x[0].value + 2.0 * divisor, slope: x[0].slope };
        divisor.map_or(Growth::UNKNOWN, of)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        remainder(d, x[0], x[1])
    }
}

/// 0 where the second is below the first, else 1.
pub struct Step;

impl FunctionMember for Step {
    const NAME: &'static str = "step";
    const ARITY: (usize, usize) = (2, 2);

    fn value(x: &[f64]) -> f64 {
        f64::from(u8::from(x[1] >= x[0]))
    }

    fn kink_distance(x: &[f64]) -> f64 {
        (x[0] - x[1]).abs()
    }

    fn non_negative(_: &[bool]) -> bool {
        true
    }

    fn growth(_: &[Growth], _: Option<f64>) -> Growth {
        Growth::still(1.0)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let (zero, one) = (d.constant(0.0), d.constant(1.0));
        let reached = d.le(x[0], x[1]);
        d.select(reached, one, zero)
    }
}
