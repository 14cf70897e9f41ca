//! The cubic Hermite falloff `1 - 3 r^2 + 2 r^3`, whose slope bounds Hart's sphere tracing of blobs (1996).
//!
//! In `1 - 3 r^2 + 2 r^3 = (1 - r)^2 (1 + 2r)` one factor falls with r and the other rises. With
//! `1 - r = u / (1 + r)` both factors fall:
//!
//! ```text
//! u^2 (1 + 2r) / (1 + r)^2  =  u^2 (1 - n^2),   n = r / (1 + r) = 1 - 1 / (1 + r)
//! ```

use jbt_ir::Domain;

use super::{Nearness, PlainFalloff, emit_distance};

/// The cubic Hermite polynomial. Text: `hermite`, also `hart`, `smoothstep`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Hermite;

impl PlainFalloff for Hermite {
    const NAME: &'static str = "hermite";
    const ALIASES: &'static [&'static str] = &["hart", "smoothstep"];
    const STEEPNESS: f64 = 8.0;

    fn value(s: f64) -> f64 {
        if s >= 1.0 { 0.0 } else { 1.0 - 3.0 * s + 2.0 * s * s.sqrt() }
    }

    fn inverse(level: f64) -> f64 {
        super::bisect(Self::value, level)
    }

    fn emit<D: Domain>(d: &mut D, Nearness { u, .. }: Nearness<D::Real>) -> D::Real {
        let (r, one) = (emit_distance(d, u), d.constant(1.0));
        let sum = d.add(one, r);
        let inverse = d.div(one, sum);
        let n = d.sub(one, inverse);
        let square = d.mul(n, n);
        let factor = d.sub(one, square);
        let u2 = d.mul(u, u);
        d.mul(u2, factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::Falloff;
    use crate::falloff::testing::Published;

    #[test]
    fn published_values() {
        Published { half: Some(0.5), steepest: Some((0.5, 1.5)) }.check(Falloff::Hermite);
        assert_eq!(Hermite::value(1.0 / 16.0), 27.0 / 32.0);
    }
}
