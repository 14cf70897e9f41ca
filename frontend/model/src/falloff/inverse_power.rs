//! The inverse power, in a form that is finite at the skeleton.
//!
//! ```text
//! 1 / (1 + (c r)^n)        c the cutoff, n the exponent
//! ```
//!
//! The potential `1 / d^n` of a charge is infinite at the charge. With the 1 in the divisor the field is 1
//! there, 1/2 at r = 1 / c, and close to the inverse power from about twice that distance on. So the cutoff
//! is the support radius in units of the distance at which the field is 1/2. n = 2 is Cauchy's (and
//! Lorentz's) curve.
//!
//! It never reaches zero. With an exact [`Edge`] the field jumps from `1 / (1 + c^n)` to zero at the rim, by
//! 1/17 for the defaults.
//!
//! A whole exponent is code: powers of s, and r once if it is odd. For n = 1 the field has a tip at the
//! skeleton.

use jbt_ir::Domain;

use super::{Edge, FalloffMember, Nearness, bisect, whole};
use crate::member::member;
use crate::power::{Exponent, power};

/// The largest exponent.
const MOST: u8 = 16;

member! {
    /// An inverse power. Text: `inverse_power { exponent 2 cutoff 4 edge smooth }`, which are the defaults;
    /// also `inverse`, `lorentz`.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct InversePower = "inverse_power" {
        /// n, in [1, 16].
        pub exponent: f64 [Within { least: 1.0, most: MOST as f64 }] = Real(2.0),
        /// The support radius, in units of the distance at which the field is 1/2, in [0.01, 16].
        pub cutoff: f64 [Within { least: 0.01, most: 16.0 }] = Real(4.0),
        /// What happens at the support radius.
        pub edge: Edge [Choice(Edge::WORDS)] = Edge::Smooth.to_field(),
    }
}

impl FalloffMember for InversePower {
    const ALIASES: &'static [&'static str] = &["inverse", "lorentz"];

    fn value(&self, s: f64) -> f64 {
        self.edge.factor(s) / (1.0 + (self.cutoff * s.sqrt()).powf(self.exponent))
    }

    fn inverse(&self, level: f64) -> f64 {
        bisect(|s| self.value(s), level)
    }

    fn steepness(&self) -> f64 {
        8.0 * self.exponent * self.cutoff.powf(self.exponent).max(1.0)
    }

    fn is_pointed(&self) -> bool {
        self.exponent <= 1.0
    }

    /// The edge in the lowest bit; above it the exponent, if it is whole.
    fn variant(&self, depends: bool) -> u8 {
        let exponent = if depends { 0 } else { whole(self.exponent, MOST).unwrap_or(0) };
        self.edge.bit() | exponent << 1
    }

    fn column_names(variant: u8) -> &'static [&'static str] {
        if variant >> 1 == 0 { &["falloff_scale", "half_exponent"] } else { &["falloff_scale"] }
    }

    fn columns(&self, variant: u8, row: &mut Vec<f64>) {
        row.push(self.cutoff.powf(self.exponent));
        if variant >> 1 == 0 {
            row.push(0.5 * self.exponent);
        }
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, near: Nearness<D::Real>, row: &[D::Real]) -> D::Real {
        let (s, one) = (near.square(d), d.constant(1.0));
        let power = match variant >> 1 {
            0 => d.pow(s, row[1]),
            1 => d.sqrt(s),
            n => {
                let even = power(d, s, Exponent::Integer(u32::from(n / 2)));
                if n % 2 == 0 {
                    even
                } else {
                    let r = d.sqrt(s);
                    d.mul(even, r)
                }
            }
        };
        let sum = d.fma(row[0], power, one);
        let value = d.div(one, sum);
        Edge::of_bit(variant).emit(d, near.u, value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::testing::Published;

    #[test]
    fn published_values() {
        for edge in [Edge::Exact, Edge::Smooth] {
            for (exponent, cutoff) in [(1.0, 4.0), (2.0, 4.0), (2.5, 3.0), (5.0, 2.0), (16.0, 2.0)] {
                // The slope n x^(n-1) / (1 + x^n)^2 in x = c r is largest where x^n = (n - 1) / (n + 1).
                let x = ((exponent - 1.0) / (exponent + 1.0f64)).powf(1.0 / exponent);
                let slope = cutoff * exponent * x.powf(exponent - 1.0) / (1.0 + x.powf(exponent)).powi(2);
                let steepest = (exponent > 1.0).then_some((x / cutoff, slope));
                Published { half: Some(1.0 / cutoff), steepest }
                    .check(InversePower { exponent, cutoff, edge }.into());
            }
        }
    }

    #[test]
    fn an_exact_edge_jumps() {
        let exact = InversePower { exponent: 2.0, cutoff: 4.0, edge: Edge::Exact };
        assert!((exact.value(1.0 - 1e-12) - 1.0 / 17.0).abs() < 1e-10);
        assert_eq!(exact.value(1.0), 0.0);
    }
}
