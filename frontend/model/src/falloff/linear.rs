//! The distance itself: `1 - r`, a cone. Formulas of a falloff begin with it, because `1 - field` is the
//! distance over the radius.
//!
//! With `1 - r = u / (1 + r)` it rises with u, and is exactly 0 at the rim.

use jbt_ir::Domain;

use super::{Nearness, PlainFalloff, emit_depth};

/// A cone, with its tip at the skeleton. Text: `linear`, also `cone`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Linear;

impl PlainFalloff for Linear {
    const NAME: &'static str = "linear";
    const ALIASES: &'static [&'static str] = &["cone"];
    const STEEPNESS: f64 = 4.0;
    const IS_POINTED: bool = true;

    fn value(s: f64) -> f64 {
        if s >= 1.0 { 0.0 } else { 1.0 - s.sqrt() }
    }

    fn inverse(level: f64) -> f64 {
        (1.0 - level).powi(2)
    }

    fn emit<D: Domain>(d: &mut D, near: Nearness<D::Real>) -> D::Real {
        let r = near.distance(d);
        emit_depth(d, near.u, r)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::Falloff;
    use crate::falloff::testing::Published;

    #[test]
    fn it_is_one_minus_the_distance() {
        Published { half: Some(0.5), steepest: Some((0.5, 1.0)) }.check(Falloff::Linear);
        assert_eq!([0.0625, 0.25, 0.5625].map(Linear::value), [0.75, 0.5, 0.25]);
    }
}
