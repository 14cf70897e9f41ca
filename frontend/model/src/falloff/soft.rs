//! The soft object's falloff (Wyvill, McPheeters and Wyvill 1986): a cubic in `s` that is 1/2 at half the
//! radius.
//!
//! ```text
//! 1 - 22/9 s + 17/9 s^2 - 4/9 s^3  =  u^2 (5 + 4u) / 9,   u = 1 - s
//! ```

use jbt_ir::Domain;

use super::{Nearness, PlainFalloff};

/// The falloff of soft objects. Text: `soft`, also `geoff`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Soft;

impl PlainFalloff for Soft {
    const NAME: &'static str = "soft";
    const ALIASES: &'static [&'static str] = &["geoff"];
    const STEEPNESS: f64 = 4.0;

    fn value(s: f64) -> f64 {
        if s >= 1.0 { 0.0 } else { 1.0 - s * (22.0 - s * (17.0 - 4.0 * s)) / 9.0 }
    }

    fn inverse(level: f64) -> f64 {
        super::bisect(Self::value, level)
    }

    fn emit<D: Domain>(d: &mut D, Nearness { u, .. }: Nearness<D::Real>) -> D::Real {
        let (four, five) = (d.constant(4.0 / 9.0), d.constant(5.0 / 9.0));
        let slope = d.fma(four, u, five);
        let square = d.mul(u, u);
        d.mul(square, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::Falloff;
    use crate::falloff::testing::Published;

    #[test]
    fn published_values() {
        Published { half: Some(0.5), steepest: Some((0.5035, 1.58343)) }.check(Falloff::Soft);
        assert!((Soft::value(0.25) - 0.5).abs() < 1e-15, "1/2 at half the radius");
        assert_eq!(Soft::value(0.0), 1.0);
        assert_eq!(Soft::value(1.0), 0.0);
        assert!((Soft::inverse(0.5) - 0.25).abs() < 1e-15);
    }
}
