//! Marble: veins across a direction, shaken by noise (Perlin 1985).
//!
//! It is [`Veins`] by the distance along the direction.

use glam::DVec3;
use jbt_ir::Domain;

use super::veins::{self, Veins};
use super::{TextureMember, emit_dot};
use crate::member::member;

member! {
    /// Veins across a direction.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Marble = "marble" {
        /// The direction in which they follow each other, of any length but 0.
        pub along: DVec3 [Direction] = Vector([1.0, 0.0, 0.0]),
        /// The distance from one vein to the next.
        pub width: f64 [Positive] = Real(1.0),
        /// By how many widths noise moves them.
        pub turbulence: f64 [Real] = Real(1.5),
        /// The size of the noise's first octave.
        pub size: f64 [Positive] = Real(1.0),
        /// The nearest whole number, up to 2^21 in magnitude, tells one noise from another.
        pub seed: f64 [Real] = Real(0.0),
    }
}

impl Marble {
    const fn veins(&self) -> Veins {
        let Self { along, width, turbulence, size, seed } = *self;
        Veins { along, width, turbulence, size, seed }
    }
}

impl TextureMember for Marble {
    fn value(&self, p: DVec3) -> f64 {
        self.veins().value(p, p.dot(self.veins().direction()))
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn columns(_variant: u8) -> &'static [&'static str] {
        Veins::COLUMNS
    }

    fn push_columns(&self, _variant: u8, row: &mut Vec<f64>) {
        self.veins().push_columns(row);
    }

    fn emit<D: Domain>(d: &mut D, _variant: u8, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let distance = emit_dot(d, p, veins::direction(row));
        veins::emit(d, p, distance, row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::testing;

    #[test]
    fn calm_veins_are_waves() {
        let marble = Marble { along: DVec3::Z, width: 2.0, turbulence: 0.0, size: 1.0, seed: 0.0 };
        for (z, expected) in [(0.0, 0.0), (0.5, 0.5), (1.0, 1.0), (2.0, 0.0), (-1.0, 1.0)] {
            assert!((marble.value(DVec3::new(4.0, 4.0, z)) - expected).abs() < 1e-12, "{z}");
        }
    }

    #[test]
    fn both_forms_agree() {
        testing::judge(|rng| {
            let (width, turbulence) = (0.5 + rng.f64(), 2.0 * rng.f64());
            let along = DVec3::new(1.0, rng.f64(), 0.0);
            Marble { along, width, turbulence, size: 1.0, seed: 9.0 }
        });
    }
}
