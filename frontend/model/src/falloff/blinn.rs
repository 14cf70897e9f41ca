//! Blinn's Gaussian (1982): the field of a density of electrons around an atom.
//!
//! ```text
//! exp(-h (c r)^2)        h the hardness, c the cutoff, r = d / R
//! ```
//!
//! Blinn writes `b exp(-a d^2)`: here b is the strength of the primitive and `a = h c^2 / R^2`. Written with
//! his blobbiness B as `exp(B d^2 / R0^2 - B)`, h is -B, and R0 is the support radius over the cutoff, R / c.
//! So a cutoff of 2 makes the support twice as large as the radius that the hardness is meant for.
//!
//! The Gaussian never reaches zero. With an exact [`Edge`] the field jumps from `exp(-h c^2)` to zero at the
//! rim, by 0.00034 for the defaults.

use jbt_ir::Domain;

use super::{Edge, FalloffMember, Nearness, bisect};
use crate::member::member;

member! {
    /// A Gaussian. Text: `blinn { hardness 2 cutoff 2 edge smooth }`, which are the defaults; also
    /// `gaussian`, `blobby`.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Blinn = "blinn" {
        /// How fast it falls, in [0.001, 1000].
        pub hardness: f64 [Within { least: 0.001, most: 1000.0 }] = Real(2.0),
        /// The support radius, in units of the radius that the hardness is meant for, in [0.01, 16].
        pub cutoff: f64 [Within { least: 0.01, most: 16.0 }] = Real(2.0),
        /// What happens at the support radius.
        pub edge: Edge [Choice(Edge::WORDS)] = Edge::Smooth.to_field(),
    }
}

impl Blinn {
    /// `h c^2`: the field is `exp(-rate s)`.
    fn rate(&self) -> f64 {
        self.hardness * self.cutoff * self.cutoff
    }
}

impl FalloffMember for Blinn {
    const ALIASES: &'static [&'static str] = &["gaussian", "blobby"];

    fn value(&self, s: f64) -> f64 {
        (-self.rate() * s).exp() * self.edge.factor(s)
    }

    fn inverse(&self, level: f64) -> f64 {
        bisect(|s| self.value(s), level)
    }

    fn steepness(&self) -> f64 {
        8.0 * self.rate().max(1.0)
    }

    fn is_pointed(&self) -> bool {
        false
    }

    fn variant(&self, _follows: bool) -> u8 {
        self.edge.bit()
    }

    fn column_names(_variant: u8) -> &'static [&'static str] {
        &["falloff_rate"]
    }

    fn columns(&self, _variant: u8, row: &mut Vec<f64>) {
        row.push(self.rate());
    }

    fn emit<D: Domain>(d: &mut D, variant: u8, near: Nearness<D::Real>, row: &[D::Real]) -> D::Real {
        let u = near.u;
        // -rate s, exactly 0 at the skeleton.
        let whole = d.neg(row[0]);
        let exponent = d.fma(row[0], u, whole);
        let value = d.exp(exponent);
        Edge::of_bit(variant).emit(d, u, value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::falloff::testing::Published;

    #[test]
    fn published_values() {
        for edge in [Edge::Exact, Edge::Smooth] {
            for (hardness, cutoff) in [(2.0, 2.0), (3.0, 1.5), (20.0, 1.0)] {
                // The largest slope of exp(-a r^2) is sqrt(2a / e).
                let a: f64 = hardness * cutoff * cutoff;
                let slope = (2.0 * a / std::f64::consts::E).sqrt();
                let steepest = Some(((0.5 / a).sqrt(), slope));
                Published { half: Some((2f64.ln() / a).sqrt()), steepest }
                    .check(Blinn { hardness, cutoff, edge }.into());
            }
        }
    }

    #[test]
    fn an_exact_edge_jumps() {
        let exact = Blinn { hardness: 3.0, cutoff: 1.0, edge: Edge::Exact };
        assert!((exact.value(1.0 - 1e-12) - (-3f64).exp()).abs() < 1e-10);
        assert_eq!(exact.value(1.0), 0.0);
        assert!((exact.inverse(0.01) - 1.0).abs() < 1e-15, "it jumps over this level at the rim");
    }
}
