//! Veins: waves across space that noise shakes (Perlin 1985), the common part of marble and tree rings.
//!
//! `t = wave(distance / width + turbulence * noise(p / size))`, where the wave goes from 0 to 1 and back in
//! each width, and the noise has three octaves. Each texture defines its own distance.

use glam::DVec3;
use jbt_ir::Domain;

use super::noise::{NEXT_OCTAVE, emit_octaves, emit_seed, lattice_noise, seed_bits, whole_seed};
use super::{emit_wave, first_three, wave};

/// The weights of the octaves that shake veins.
const OCTAVES: [f32; 3] = [4.0 / 7.0, 2.0 / 7.0, 1.0 / 7.0];

/// Waves that noise shakes.
pub(super) struct Veins {
    /// A direction, of any length but 0.
    pub(super) along: DVec3,
    /// The length of a wave.
    pub(super) width: f64,
    /// How many wave lengths the noise moves them.
    pub(super) turbulence: f64,
    /// The size of the noise's first octave.
    pub(super) size: f64,
    /// The nearest whole number, up to 2^21 in magnitude, tells one noise from another.
    pub(super) seed: f64,
}

impl Veins {
    /// Names of the columns that [`push_columns`](Self::push_columns) fills, in order.
    pub(super) const COLUMNS: &'static [&'static str] =
        &["along_x", "along_y", "along_z", "inv_width", "turbulence", "inv_size", "seed"];

    /// The direction with length 1.
    pub(super) fn direction(&self) -> DVec3 {
        crate::skeleton::unit(self.along)
    }

    /// The number at `p`, where the wave's distance is `distance`.
    pub(super) fn value(&self, p: DVec3, distance: f64) -> f64 {
        let octave = |k: usize| {
            let seed = seed_bits(self.seed).wrapping_add((k as u32).wrapping_mul(NEXT_OCTAVE));
            f64::from(OCTAVES[k]) * lattice_noise(p / self.size * f64::from(1 << k), seed)
        };
        let noise: f64 = (0..OCTAVES.len()).map(octave).sum();
        wave(distance / self.width + self.turbulence * noise)
    }

    pub(super) fn push_columns(&self, row: &mut Vec<f64>) {
        row.extend(self.direction().to_array());
        row.extend([1.0 / self.width, self.turbulence, 1.0 / self.size, whole_seed(self.seed)]);
    }
}

/// The direction, of a row of veins.
pub(super) fn direction<R: Copy>(row: &[R]) -> [R; 3] {
    first_three(row)
}

/// The number at `p`, where the wave's distance is `distance`; `row` holds the columns.
pub(super) fn emit<D: Domain>(d: &mut D, p: [D::Real; 3], distance: D::Real, row: &[D::Real]) -> D::Real {
    let &[_, _, _, inv_width, turbulence, inv_size, seed] = row else { panic!("veins have seven columns") };
    let seed = emit_seed(d, seed);
    let weights = OCTAVES.map(|weight| d.constant(weight));
    let noise = emit_octaves(d, (p, inv_size), seed, &weights);
    let calm = d.mul(distance, inv_width);
    let shaken = d.fma(turbulence, noise, calm);
    emit_wave(d, shaken)
}
