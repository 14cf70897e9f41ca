//! The cubic falloff `(1 - s)^3`, used by Galin, Blender and others under Wyvill's name.

use jbt_ir::Domain;

use super::{Nearness, PlainFalloff};

/// The Wyvill cubic. Text: `wyvill`, also `cubic`, `galin`, `blender`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Wyvill;

impl PlainFalloff for Wyvill {
    const NAME: &'static str = "wyvill";
    const ALIASES: &'static [&'static str] = &["cubic", "galin", "blender"];
    const STEEPNESS: f64 = 8.0;

    fn value(s: f64) -> f64 {
        if s >= 1.0 { 0.0 } else { (1.0 - s).powi(3) }
    }

    fn inverse(level: f64) -> f64 {
        1.0 - level.cbrt()
    }

    fn emit<D: Domain>(d: &mut D, Nearness { u, .. }: Nearness<D::Real>) -> D::Real {
        let square = d.mul(u, u);
        d.mul(square, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::Falloff;
    use crate::falloff::testing::Published;

    #[test]
    fn published_values() {
        let slope = 6.0 / 5f64.sqrt() * 16.0 / 25.0;
        Published { half: Some(0.454_202_0), steepest: Some((1.0 / 5f64.sqrt(), slope)) }.check(Falloff::Wyvill);
        assert!((Wyvill::inverse(0.5).sqrt() - 0.454_202_0).abs() < 5e-8);
        assert!((Wyvill::value(0.454_202_0f64.powi(2)) - 0.5).abs() < 1e-6);
        assert_eq!(Wyvill::value(1.0), 0.0);
    }
}
