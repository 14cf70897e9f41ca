//! Functions of several numbers.

use jbt_ir::Domain;

use super::formulas::lead;
use super::growth::Growth;
use super::member::FunctionMember;

/// The smallest.
pub(super) struct Min;

impl FunctionMember for Min {
    const NAME: &'static str = "min";
    const ARITY: (usize, usize) = (1, usize::MAX);
    const RESERVED: bool = true;

    fn value(x: &[f64]) -> f64 {
        x.iter().copied().fold(x[0], f64::min)
    }

    fn kink_distance(x: &[f64]) -> f64 {
        lead(x.iter().map(|x| -x))
    }

    fn non_negative(x: &[bool]) -> bool {
        x.iter().all(|&sign| sign)
    }

    fn range(x: &[[f64; 2]]) -> [f64; 2] {
        [0, 1].map(|side| x.iter().map(|range| range[side]).fold(f64::INFINITY, f64::min))
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        any(x)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        x[1..].iter().fold(x[0], |least, &x| d.min(least, x))
    }
}

/// The largest.
pub(super) struct Max;

impl FunctionMember for Max {
    const NAME: &'static str = "max";
    const ARITY: (usize, usize) = (1, usize::MAX);
    const RESERVED: bool = true;

    fn value(x: &[f64]) -> f64 {
        x.iter().copied().fold(x[0], f64::max)
    }

    fn kink_distance(x: &[f64]) -> f64 {
        lead(x.iter().copied())
    }

    fn non_negative(x: &[bool]) -> bool {
        x.contains(&true)
    }

    fn range(x: &[[f64; 2]]) -> [f64; 2] {
        [0, 1].map(|side| x.iter().map(|range| range[side]).fold(f64::NEG_INFINITY, f64::max))
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        any(x)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        x[1..].iter().fold(x[0], |most, &x| d.max(most, x))
    }
}

/// The first, but not below the second and not above the third.
pub(super) struct Clamp;

impl FunctionMember for Clamp {
    const NAME: &'static str = "clamp";
    const ARITY: (usize, usize) = (3, 3);

    fn value(x: &[f64]) -> f64 {
        x[0].max(x[1]).min(x[2])
    }

    fn kink_distance(x: &[f64]) -> f64 {
        (x[0] - x[1]).abs().min((x[0] - x[2]).abs())
    }

    fn non_negative(x: &[bool]) -> bool {
        (x[0] || x[1]) && x[2]
    }

    fn range(x: &[[f64; 2]]) -> [f64; 2] {
        [0, 1].map(|side| x[0][side].max(x[1][side]).min(x[2][side]))
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        any(x)
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let above = d.max(x[0], x[1]);
        d.min(above, x[2])
    }
}

/// From the first to the second, as the third goes from 0 to 1.
pub(super) struct Mix;

impl FunctionMember for Mix {
    const NAME: &'static str = "mix";
    const ARITY: (usize, usize) = (3, 3);

    fn value(x: &[f64]) -> f64 {
        x[0] + (x[1] - x[0]) * x[2]
    }

    fn kink_distance(_: &[f64]) -> f64 {
        f64::INFINITY
    }

    fn non_negative(_: &[bool]) -> bool {
        false
    }

    fn growth(x: &[Growth], _: Option<f64>) -> Growth {
        x[0].plus(x[1]).times(x[2]).plus(x[0])
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let way = d.sub(x[1], x[0]);
        d.fma(way, x[2], x[0])
    }
}

/// The length of a vector.
pub(super) struct Length;

impl FunctionMember for Length {
    const NAME: &'static str = "length";
    const ARITY: (usize, usize) = (1, usize::MAX);

    fn value(x: &[f64]) -> f64 {
        x.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    fn kink_distance(x: &[f64]) -> f64 {
        Self::value(x)
    }

    fn non_negative(_: &[bool]) -> bool {
        true
    }

    fn range(_: &[[f64; 2]]) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }

    fn emit<D: Domain>(d: &mut D, x: &[D::Real], _: bool) -> D::Real {
        let first = d.mul(x[0], x[0]);
        let square = x[1..].iter().fold(first, |sum, &x| d.fma(x, x, sum));
        d.sqrt(square)
    }
}

/// Bounds of any of them, or of a sum of parts.
fn any(x: &[Growth]) -> Growth {
    x[1..].iter().fold(x[0], |all, &x| all.plus(x))
}
