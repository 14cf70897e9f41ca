//! The family `(1 - s)^n`, of degree 2n in the distance: Stolte's (n = 8 and others),
//! [`Quartic`](super::Quartic) for n = 2, [`Wyvill`](super::Wyvill) for n = 3.
//!
//! A whole exponent up to [`MOST_WHOLE`] is code, a chain of products; other exponents are powers. Below n =
//! 1 the slope grows without bounds towards the rim, but gradients stay finite, because u is 0 or at least
//! 2^-48.

use jbt_ir::Domain;

use super::{FalloffMember, Nearness, emit_inside, whole};
use crate::member::member;
use crate::power::{Exponent, power};

/// The largest whole exponent that is code.
const MOST_WHOLE: u8 = 64;

member! {
    /// `(1 - s)^n`. Text: `degree { exponent 4 }`, also `stolte`.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Degree = "degree" {
        /// n, in [0.001, 1024].
        pub exponent: f64 [Within { least: 0.001, most: 1024.0 }],
    }
}

impl FalloffMember for Degree {
    const ALIASES: &'static [&'static str] = &["stolte"];

    fn value(&self, s: f64) -> f64 {
        if s >= 1.0 { 0.0 } else { (1.0 - s).powf(self.exponent) }
    }

    fn inverse(&self, level: f64) -> f64 {
        1.0 - level.powf(1.0 / self.exponent)
    }

    fn steepness(&self) -> f64 {
        // The tangent of `pow` is 0 where the base is 0.
        self.exponent.max(1.0)
    }

    fn is_pointed(&self) -> bool {
        false
    }

    fn variant(&self, depends: bool) -> u8 {
        if depends { 0 } else { whole(self.exponent, MOST_WHOLE).unwrap_or(0) }
    }

    fn column_names(variant: u8) -> &'static [&'static str] {
        if variant == 0 { &["falloff_exponent"] } else { &[] }
    }

    fn columns(&self, variant: u8, row: &mut Vec<f64>) {
        if variant == 0 {
            row.push(self.exponent);
        }
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, near: Nearness<D::Real>, row: &[D::Real]) -> D::Real {
        let u = near.u;
        if variant > 0 {
            return power(d, u, Exponent::Integer(u32::from(variant)));
        }
        let power = d.pow(u, row[0]);
        // The power is 0 at 0, but ranges of powers are a little too wide.
        emit_inside(d, u, power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::Falloff;
    use crate::falloff::testing::Published;

    #[test]
    fn published_values() {
        for n in [2.0, 3.0, 2.5, 8.0, 64.0, 65.0] {
            let half = (1.0 - 2f64.powf(-1.0 / n)).sqrt();
            let r = 1.0 / (2.0 * n - 1.0f64).sqrt();
            let slope = 2.0 * n * r * (1.0 - r * r).powf(n - 1.0);
            Published { half: Some(half), steepest: Some((r, slope)) }.check(Degree { exponent: n }.into());
        }
        for s in [0.0, 0.3, 0.9, 1.0, 7.0] {
            assert!((Degree { exponent: 3.0 }.value(s) - Falloff::Wyvill.value(s)).abs() < 1e-15);
        }
    }

    #[test]
    fn whole_exponents_are_code() {
        let variant = |exponent, depends| Degree { exponent }.variant(depends);
        let found = [variant(1.0, false), variant(64.0, false), variant(65.0, false), variant(2.5, false)];
        assert_eq!((found, variant(2.0, true)), ([1, 64, 0, 0], 0));
    }
}
