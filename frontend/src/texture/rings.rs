//! Rings: shells around an axis, as of a tree, shaken by noise.
//!
//! `t = wave(distance from the axis / width + turbulence * noise(p / size))`, where the wave goes from 0 to 1 and back in each width, and the
//! noise has three octaves.

use glam::DVec3;
use jbt_ir::Domain;

use super::marble::{Veins, emit_veins};
use super::{TextureMember, emit_dot, first_three};
use crate::field::{Field, FieldKind, FieldValue, Member};

/// Shells around an axis through the origin.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rings {
    /// The direction of the axis, of any length but 0.
    pub along: DVec3,
    /// The distance from one ring to the next, and what shakes them.
    pub veins: Veins,
}

impl Member for Rings {
    const NAME: &'static str = "rings";
    const FIELDS: &'static [Field] = &[
        Field { name: "along", kind: FieldKind::Direction, default: Some(FieldValue::Vector([0.0, 0.0, 1.0])) },
        Veins::WIDTH,
        Field { name: "turbulence", kind: FieldKind::Real, default: Some(FieldValue::Real(0.5)) },
        Veins::SIZE,
        Veins::SEED,
    ];

    fn from_fields(values: &[FieldValue]) -> Self {
        Self { along: values[0].vector().into(), veins: Veins::from_fields(&values[1..]) }
    }

    fn to_fields(&self) -> Vec<FieldValue> {
        let mut fields = vec![FieldValue::Vector(self.along.into())];
        fields.extend(self.veins.to_fields());
        fields
    }
}

impl TextureMember for Rings {
    fn value(&self, p: DVec3) -> f64 {
        let n = crate::skeleton::unit(self.along);
        self.veins.value(p, (p - p.dot(n) * n).length())
    }

    fn decision(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn columns(_variant: u8) -> &'static [&'static str] {
        &["along_x", "along_y", "along_z", "inv_width", "turbulence", "inv_size", "seed"]
    }

    fn push_columns(&self, _variant: u8, row: &mut Vec<f64>) {
        row.extend(crate::skeleton::unit(self.along).to_array());
        self.veins.push_columns(row);
    }

    fn emit<D: Domain>(d: &mut D, _variant: u8, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let along = first_three(row);
        let height = emit_dot(d, p, along);
        let down = d.neg(height);
        let off: [D::Real; 3] = std::array::from_fn(|axis| d.fma(down, along[axis], p[axis]));
        let square = emit_dot(d, off, off);
        let distance = d.sqrt(square);
        emit_veins(d, p, distance, &row[3..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::testing;

    fn rings(turbulence: f64) -> Rings {
        let veins = Veins { width: 0.5, turbulence, size: 1.0, seed: 3.0 };
        Rings { along: DVec3::new(0.0, 2.0, 0.0), veins }
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
