//! Rings: shells around an axis, as of a tree, shaken by noise.
//!
//! They are [`Veins`] by the distance from the axis.

use glam::DVec3;
use jbt_ir::Domain;

use super::veins::{self, Veins};
use super::{TextureMember, emit_dot};
use crate::member::member;

member! {
    /// Shells around an axis through the origin.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Rings = "rings" {
        /// The direction of the axis, of any length but 0.
        pub along: DVec3 [Direction] = Vector([0.0, 0.0, 1.0]),
        /// The distance from one ring to the next.
        pub width: f64 [Positive] = Real(1.0),
        /// By how many widths noise moves them.
        pub turbulence: f64 [Real] = Real(0.5),
        /// The size of the noise's first octave.
        pub size: f64 [Positive] = Real(1.0),
        /// The nearest whole number, up to 2^21 in magnitude, tells one noise from another.
        pub seed: f64 [Real] = Real(0.0),
    }
}

impl Rings {
    const fn veins(&self) -> Veins {
        let Self { along, width, turbulence, size, seed } = *self;
        Veins { along, width, turbulence, size, seed }
    }
}

impl TextureMember for Rings {
    fn value(&self, p: DVec3) -> f64 {
        let n = self.veins().direction();
        self.veins().value(p, (p - p.dot(n) * n).length())
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
        let along = veins::direction(row);
        let height = emit_dot(d, p, along);
        let down = d.neg(height);
        let off: [D::Real; 3] = std::array::from_fn(|axis| d.fma(down, along[axis], p[axis]));
        let square = emit_dot(d, off, off);
        let distance = d.sqrt(square);
        veins::emit(d, p, distance, row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::testing;

    fn rings(turbulence: f64) -> Rings {
        let along = DVec3::new(0.0, 2.0, 0.0);
        Rings { along, width: 0.5, turbulence, size: 1.0, seed: 3.0 }
    }

    #[test]
    fn calm_rings_follow_the_distance_from_the_axis() {
        for (distance, expected) in [(0.0, 0.0), (0.25, 1.0), (0.5, 0.0), (0.125, 0.5), (1.25, 1.0)] {
            let value = rings(0.0).value(DVec3::new(0.6 * distance, 9.0, 0.8 * distance));
            assert!((value - expected).abs() < 1e-12, "{value} at {distance}");
        }
    }

    #[test]
    fn both_forms_agree() {
        testing::judge(|rng| rings(rng.f64()));
    }
}
