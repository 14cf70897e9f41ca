//! Functions of angles.

use jbt_ir::Domain;

use super::formulas::{arc_sides, quotient};
use super::growth::Growth;
use super::member::FunctionMember;
use crate::angle::atan2;

/// The sine of an angle in radians.
pub(super) struct Sin;

impl FunctionMember for Sin {
    const NAME: &'static str = "sin";
    const RESERVED: bool = true;

    fn value(x: &[f64]) -> f64 {
        x[0].sin()
    }

    fn kink_distance(_: &[f64]) -> f64 {
        f64::INFINITY
    }

    fn non_negative(_: &[bool]) -> bool {
        false
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        Growth { value: 1.0, slope: x[0].slope }
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        d.sin(x[0])
    }
}

/// The cosine of an angle in radians.
pub(super) struct Cos;

impl FunctionMember for Cos {
    const NAME: &'static str = "cos";
    const RESERVED: bool = true;

    fn value(x: &[f64]) -> f64 {
        x[0].cos()
    }

    fn kink_distance(_: &[f64]) -> f64 {
        f64::INFINITY
    }

    fn non_negative(_: &[bool]) -> bool {
        false
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        Growth { value: 1.0, slope: x[0].slope }
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        d.cos(x[0])
    }
}

/// The tangent of an angle in radians.
pub(super) struct Tan;

impl FunctionMember for Tan {
    const NAME: &'static str = "tan";

    fn value(x: &[f64]) -> f64 {
        x[0].tan()
    }

    fn kink_distance(x: &[f64]) -> f64 {
        x[0].cos().abs()
    }

    fn non_negative(_: &[bool]) -> bool {
        false
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let (sin, cos) = (d.sin(x[0]), d.cos(x[0]));
        quotient(d, sin, cos)
    }
}

/// The angle in radians that has this sine.
pub(super) struct Asin;

impl FunctionMember for Asin {
    const NAME: &'static str = "asin";

    fn value(x: &[f64]) -> f64 {
        x[0].asin()
    }

    fn total(x: &[f64]) -> f64 {
        x[0].clamp(-1.0, 1.0).asin()
    }

    fn kink_distance(x: &[f64]) -> f64 {
        (1.0 - x[0].abs()).abs()
    }

    fn non_negative(x: &[bool]) -> bool {
        x.iter().all(|&sign| sign)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let (sin, cos) = arc_sides(d, x[0]);
        atan2(d, sin, cos)
    }
}

/// The angle in radians that has this cosine.
pub(super) struct Acos;

impl FunctionMember for Acos {
    const NAME: &'static str = "acos";

    fn value(x: &[f64]) -> f64 {
        x[0].acos()
    }

    fn total(x: &[f64]) -> f64 {
        x[0].clamp(-1.0, 1.0).acos()
    }

    fn kink_distance(x: &[f64]) -> f64 {
        (1.0 - x[0].abs()).abs()
    }

    fn non_negative(_: &[bool]) -> bool {
        true
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let (cos, sin) = arc_sides(d, x[0]);
        atan2(d, sin, cos)
    }
}

/// The angle in radians that has this tangent.
pub(super) struct Atan;

impl FunctionMember for Atan {
    const NAME: &'static str = "atan";

    fn value(x: &[f64]) -> f64 {
        x[0].atan()
    }

    fn kink_distance(_: &[f64]) -> f64 {
        f64::INFINITY
    }

    fn non_negative(x: &[bool]) -> bool {
        x.iter().all(|&sign| sign)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let one = d.constant(1.0);
        atan2(d, x[0], one)
    }
}

/// The angle of the point (second, first).
pub(super) struct Atan2;

impl FunctionMember for Atan2 {
    const NAME: &'static str = "atan2";
    const ARITY: (usize, usize) = (2, 2);

    fn value(x: &[f64]) -> f64 {
        x[0].atan2(x[1])
    }

    fn kink_distance(x: &[f64]) -> f64 {
        if x[1] < 0.0 { x[0].abs() } else { x[0].hypot(x[1]) }
    }

    fn non_negative(x: &[bool]) -> bool {
        x[0]
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        atan2(d, x[0], x[1])
    }
}
