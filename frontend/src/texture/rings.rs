//! Rings: shells around an axis, as of a tree, shaken by noise.
//!
//! They are [`Veins`] by the distance from the axis.

use glam::DVec3;
use jbt_ir::Domain;

use super::veins::{self, Veins};
use super::{TextureMember, emit_dot};
use crate::field::{Field, FieldValue, Member};

/// Shells around an axis through the origin.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rings {
    /// The direction of the axis, the distance from one ring to the next, and what shakes them.
    pub veins: Veins,
}

impl Member for Rings {
    const NAME: &'static str = "rings";
    const FIELDS: &'static [Field] = &Veins::fields([0.0, 0.0, 1.0], 0.5);

    fn from_fields(values: &[FieldValue]) -> Self {
        Self { veins: Veins::from_fields(values) }
    }

    fn to_fields(&self) -> Vec<FieldValue> {
        self.veins.to_fields()
    }
}

impl TextureMember for Rings {
    fn value(&self, p: DVec3) -> f64 {
        let n = self.veins.direction();
        self.veins.value(p, (p - p.dot(n) * n).length())
    }

    fn decision(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn columns(_variant: u8) -> &'static [&'static str] {
        Veins::COLUMNS
    }

    fn push_columns(&self, _variant: u8, row: &mut Vec<f64>) {
        self.veins.push_columns(row);
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
        Rings { veins: Veins { along, width: 0.5, turbulence, size: 1.0, seed: 3.0 } }
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
