//! The metaball of Nishimura et al. (1985), as on the LINKS-1 machine: two parabolas in the distance.
//!
//! ```text
//! 1 - 3 r^2            r <= 1/3
//! 3/2 (1 - r)^2        1/3 <= r <= 1
//! ```
//!
//! The pieces touch at r = 1/3 and the second is never below the first, so the field is a sum: the second
//! piece up to `u = 1 - r^2 = 8/9`, and beyond that the increase of the first. With the depth
//! `v(u) = 1 - r = u / (1 + sqrt(1 - u))`:
//!
//! ```text
//! 3/2 v(min(u, 8/9))^2 + 3 max(u - 8/9, 0)
//! ```

use jbt_ir::Domain;

use super::{Nearness, PlainFalloff, emit_depth, emit_distance};
use crate::skeleton::positive_part;

/// Nishimura's metaball. Text: `metaball`, also `nishimura`, `links`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Metaball;

impl PlainFalloff for Metaball {
    const NAME: &'static str = "metaball";
    const ALIASES: &'static [&'static str] = &["nishimura", "links"];
    const STEEPNESS: f64 = 16.0;

    fn value(s: f64) -> f64 {
        if s >= 1.0 {
            0.0
        } else if s <= 1.0 / 9.0 {
            1.0 - 3.0 * s
        } else {
            1.5 * (1.0 - s.sqrt()).powi(2)
        }
    }

    fn inverse(level: f64) -> f64 {
        if level >= 2.0 / 3.0 { (1.0 - level) / 3.0 } else { (1.0 - (level / 1.5).sqrt()).powi(2) }
    }

    fn emit<D: Domain>(d: &mut D, Nearness { u, .. }: Nearness<D::Real>) -> D::Real {
        let [seam, three, three_halves] = [8.0 / 9.0, 3.0, 1.5].map(|number| d.constant(number));
        // At the seam itself `before` has the slope of u, and the other term is 0 without a slope.
        let before = d.min(seam, u);
        let r = emit_distance(d, before);
        let depth = emit_depth(d, before, r);
        let outer = d.mul(depth, depth);
        let outer = d.mul(three_halves, outer);
        let past = d.sub(u, seam);
        let inner = positive_part(d, past);
        d.fma(three, inner, outer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::Falloff;
    use crate::falloff::testing::Published;

    #[test]
    fn published_values() {
        // 1.5 (1 - r)^2 = 1/2 where r = 1 - 1/sqrt 3.
        Published { half: Some(0.422_649_7), steepest: Some((1.0 / 3.0, 2.0)) }.check(Falloff::Metaball);
        assert!((Metaball::value(1.0 / 9.0) - 2.0 / 3.0).abs() < 1e-15);
        assert!((Metaball::value(0.25) - 0.375).abs() < 1e-15);
    }
}
