//! The quartic falloff `(1 - s)^2`, of degree 4 in the distance, used by POV-Ray's blobs and by Murakami and
//! Ichihara (1987).

use jbt_ir::Domain;

use super::{Nearness, PlainFalloff};

/// The quartic. Text: `quartic`, also `murakami`, `pov`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Quartic;

impl PlainFalloff for Quartic {
    const NAME: &'static str = "quartic";
    const ALIASES: &'static [&'static str] = &["murakami", "pov"];
    const STEEPNESS: f64 = 4.0;

    fn value(s: f64) -> f64 {
        if s >= 1.0 { 0.0 } else { (1.0 - s).powi(2) }
    }

    fn inverse(level: f64) -> f64 {
        1.0 - level.sqrt()
    }

    fn emit<D: Domain>(d: &mut D, Nearness { u, .. }: Nearness<D::Real>) -> D::Real {
        d.mul(u, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::Falloff;
    use crate::falloff::testing::Published;

    #[test]
    fn published_values() {
        let slope = 8.0 / (3.0 * 3f64.sqrt());
        Published { half: Some(0.541_196_1), steepest: Some((1.0 / 3f64.sqrt(), slope)) }.check(Falloff::Quartic);
        assert_eq!(Quartic::value(0.75), 1.0 / 16.0);
    }
}
