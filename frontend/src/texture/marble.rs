//! Marble: veins across a direction, shaken by noise (Perlin 1985).
//!
//! `t = wave(p . along / width + turbulence * noise(p / size))`, where the wave goes from 0 to 1 and back in each width, and the noise has
//! three octaves.

use glam::DVec3;
use jbt_ir::Domain;

use super::noise::{emit_octaves, emit_seed, lattice_noise, seed_bits, whole_seed};
use super::{TextureMember, emit_dot, emit_wave, first_three, wave};
use crate::field::{Field, FieldKind, FieldValue, Member};

/// The weights of the octaves that shake veins.
const OCTAVES: [f32; 3] = [4.0 / 7.0, 2.0 / 7.0, 1.0 / 7.0];

/// Waves that noise shakes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Veins {
    /// The length of a wave.
    pub width: f64,
    /// How many wave lengths the noise moves them.
    pub turbulence: f64,
    /// The size of the noise's first octave.
    pub size: f64,
    /// The nearest whole number, up to 2^21 in magnitude, tells one noise from another.
    pub seed: f64,
}

impl Veins {
    pub(super) const WIDTH: Field =
        Field { name: "width", kind: FieldKind::Positive, default: Some(FieldValue::Real(1.0)) };
    pub(super) const SIZE: Field =
        Field { name: "size", kind: FieldKind::Positive, default: Some(FieldValue::Real(1.0)) };
    pub(super) const SEED: Field =
        Field { name: "seed", kind: FieldKind::Real, default: Some(FieldValue::Real(0.0)) };

    pub(super) fn from_fields(values: &[FieldValue]) -> Self {
        let [width, turbulence, size, seed] = [0, 1, 2, 3].map(|index: usize| values[index].real());
        Self { width, turbulence, size, seed }
    }

    pub(super) fn to_fields(self) -> [FieldValue; 4] {
        [self.width, self.turbulence, self.size, self.seed].map(FieldValue::Real)
    }

    /// The number at `p`, where the waves have come this far.
    pub(super) fn value(&self, p: DVec3, distance: f64) -> f64 {
        let octave = |k: usize| {
            let seed = seed_bits(self.seed).wrapping_add((k as u32).wrapping_mul(super::noise::NEXT_OCTAVE));
            f64::from(OCTAVES[k]) * lattice_noise(p / self.size * f64::from(1 << k), seed)
        };
        let noise: f64 = (0..OCTAVES.len()).map(octave).sum();
        wave(distance / self.width + self.turbulence * noise)
    }

    pub(super) fn push_columns(&self, row: &mut Vec<f64>) {
        row.extend([1.0 / self.width, self.turbulence, 1.0 / self.size, whole_seed(self.seed)]);
    }
}

/// The number at `p`, where the waves have come this far; `row` holds the columns of the veins.
pub(super) fn emit_veins<D: Domain>(
    d: &mut D,
    p: [D::Real; 3],
    distance: D::Real,
    row: &[D::Real],
) -> D::Real {
    let &[inv_width, turbulence, inv_size, seed] = row else { panic!("veins have four columns") };
    let seed = emit_seed(d, seed);
    let weights = OCTAVES.map(|weight| d.constant(weight));
    let noise = emit_octaves(d, (p, inv_size), seed, &weights);
    let calm = d.mul(distance, inv_width);
    let shaken = d.fma(turbulence, noise, calm);
    emit_wave(d, shaken)
}

/// Veins across a direction.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Marble {
    /// The direction in which they follow each other, of any length but 0.
    pub along: DVec3,
    /// The distance from one vein to the next, and what shakes them.
    pub veins: Veins,
}

impl Member for Marble {
    const NAME: &'static str = "marble";
    const FIELDS: &'static [Field] = &[
        Field { name: "along", kind: FieldKind::Direction, default: Some(FieldValue::Vector([1.0, 0.0, 0.0])) },
        Veins::WIDTH,
        Field { name: "turbulence", kind: FieldKind::Real, default: Some(FieldValue::Real(1.5)) },
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

impl TextureMember for Marble {
    fn value(&self, p: DVec3) -> f64 {
        self.veins.value(p, p.dot(crate::skeleton::unit(self.along)))
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
        let distance = emit_dot(d, p, first_three(row));
        emit_veins(d, p, distance, &row[3..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::testing;

    #[test]
    fn calm_veins_are_waves() {
        let veins = Veins { width: 2.0, turbulence: 0.0, size: 1.0, seed: 0.0 };
        let marble = Marble { along: DVec3::Z, veins };
        for (z, expected) in [(0.0, 0.0), (0.5, 0.5), (1.0, 1.0), (2.0, 0.0), (-1.0, 1.0)] {
            assert!((marble.value(DVec3::new(4.0, 4.0, z)) - expected).abs() < 1e-12, "{z}");
        }
    }

    #[test]
    fn both_forms_agree() {
        testing::judge(|rng| {
            let veins = Veins { width: 0.5 + rng.f64(), turbulence: 2.0 * rng.f64(), size: 1.0, seed: 9.0 };
            Marble { along: DVec3::new(1.0, rng.f64(), 0.0), veins }
        });
    }
}
