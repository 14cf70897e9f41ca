//! Noise: a smooth random number at every place (value noise: Perlin 1985 calls such a sum of octaves
//! turbulence).
//!
//! Every corner of a lattice of cubes has a random number, the hash of its integer coordinates; in a cube,
//! the numbers are mixed by `3 t^2 - 2 t^3` along each axis. Octave k has cubes of `size / 2^k` and half the
//! weight of octave k - 1; the weights add up to 1. With a fractional number of octaves the last octave has a
//! part of its weight.
//!
//! ```text
//! t = sum w_k n_k(p 2^k / size)        w_k ~ 2^-k clamp(octaves - k, 0, 1)
//! ```
//!
//! The hash is Jenkins' one-at-a-time (1997) over three words; only shifts, sums and exclusive ors of 32
//! bits.

use glam::DVec3;
use jbt_ir::Domain;

use super::{LARGEST_CELL, ROUND, TextureMember, cell, emit_cell, emit_smooth, emit_unit, smooth};
use crate::member::member;

/// The most octaves.
pub const MAX_OCTAVES: u8 = 8;
/// Added to the seed from octave to octave: 2^32 divided by the golden ratio.
pub(super) const NEXT_OCTAVE: u32 = 0x9E37_79B9;

member! {
    /// Smooth noise.
    #[derive(Clone, Copy, PartialEq, Debug)]
    pub struct Noise = "noise" {
        /// The side of a cube of the first octave.
        pub size: f64 [Positive] = Real(1.0),
        /// How many octaves, at most 8; less than one is one. The whole number above it selects code, unless
        /// it depends on a parameter: then all eight are computed.
        pub octaves: f64 [Positive] = Real(1.0),
        /// The nearest whole number, up to 2^21 in magnitude, tells one noise from another.
        pub seed: f64 [Real] = Real(0.0),
    }
}

impl Noise {
    /// The weights of the octaves: their sum is 1.
    fn weights(&self) -> [f64; MAX_OCTAVES as usize] {
        let raw = std::array::from_fn(|k| {
            let k = k as i32;
            2f64.powi(-k) * (self.octaves - f64::from(k)).clamp(0.0, 1.0)
        });
        let sum: f64 = raw.iter().sum();
        raw.map(|weight| weight / sum)
    }
}

impl TextureMember for Noise {
    fn fault(&self) -> Option<(String, String)> {
        let message = || format!("the `octaves` of the noise are {}", self.octaves);
        let many = self.octaves > f64::from(MAX_OCTAVES);
        many.then(|| (message(), format!("expected a number of at most {MAX_OCTAVES}")))
    }

    fn value(&self, p: DVec3) -> f64 {
        let mut p = p / self.size;
        let (mut sum, mut seed) = (0.0, seed_bits(self.seed));
        for weight in self.weights() {
            sum += weight * lattice_noise(p, seed);
            p *= 2.0;
            seed = seed.wrapping_add(NEXT_OCTAVE);
        }
        sum.clamp(0.0, 1.0)
    }

    fn kink_distance(&self, _p: DVec3) -> f64 {
        f64::INFINITY
    }

    fn variant(&self, depends: bool) -> u8 {
        if depends { MAX_OCTAVES } else { self.octaves.ceil().clamp(1.0, f64::from(MAX_OCTAVES)) as u8 }
    }

    fn columns(variant: u8) -> &'static [&'static str] {
        const ALL: [&str; 2 + MAX_OCTAVES as usize] =
            ["inv_size", "seed", "octave0", "octave1", "octave2", "octave3", "octave4", "octave5", "octave6", "octave7"];
        &ALL[..2 + variant as usize]
    }

    fn push_columns(&self, variant: u8, row: &mut Vec<f64>) {
        row.extend([1.0 / self.size, whole_seed(self.seed)]);
        row.extend(&self.weights()[..variant as usize]);
    }

    fn emit<D: Domain>(d: &mut D, _variant: u8, p: [D::Real; 3], row: &[D::Real]) -> D::Real {
        let seed = emit_seed(d, row[1]);
        emit_octaves(d, (p, row[0]), seed, &row[2..])
    }
}

/// A seed as a whole number that f32 holds.
pub(super) fn whole_seed(seed: f64) -> f64 {
    let largest = f64::from(LARGEST_CELL);
    seed.round().clamp(-largest, largest)
}

/// The initial value of the hash.
pub(super) fn seed_bits(seed: f64) -> u32 {
    whole_seed(seed) as i32 as u32
}

/// The initial value of the hash, from the number that [`whole_seed`] gives.
pub(super) fn emit_seed<D: Domain>(d: &mut D, seed: D::Real) -> D::Bits {
    let (round, offset) = (d.constant(ROUND), d.bits_constant(ROUND.to_bits()));
    let shifted = d.add(seed, round);
    let bits = d.to_bits(shifted);
    d.int_sub(bits, offset)
}

/// The sum of octaves with these weights at `p`, whose coordinates are multiplied with `inv_size`: from 0
/// to 1.
pub(super) fn emit_octaves<D: Domain>(
    d: &mut D,
    (p, inv_size): ([D::Real; 3], D::Real),
    mut seed: D::Bits,
    weights: &[D::Real],
) -> D::Real {
    let (two, next) = (d.constant(2.0), d.bits_constant(NEXT_OCTAVE));
    let mut p = p.map(|coordinate| d.mul(coordinate, inv_size));
    let mut sum = d.constant(0.0);
    for (octave, &weight) in weights.iter().enumerate() {
        if octave > 0 {
            p = p.map(|coordinate| d.mul(coordinate, two));
            seed = d.int_add(seed, next);
        }
        let value = emit_lattice_noise(d, p, seed);
        sum = d.fma(weight, value, sum);
    }
    // Rounding may leave it a little above 1.
    emit_unit(d, sum)
}

/// One octave with cubes of side 1, in f64.
pub(super) fn lattice_noise(p: DVec3, seed: u32) -> f64 {
    let [(x, u), (y, v), (z, w)] = p.to_array().map(cell);
    let corner = |i: i32| {
        let hash = absorb(absorb(absorb(seed, x + (i & 1)), y + (i >> 1 & 1)), z + (i >> 2));
        random(finish(hash))
    };
    let lerp = |a: f64, b: f64, t: f64| a + t * (b - a);
    let [u, v, w] = [u, v, w].map(smooth);
    let edge = |i: i32| lerp(corner(i), corner(i + 1), u);
    let side = |i: i32| lerp(edge(i), edge(i + 2), v);
    lerp(side(0), side(4), w)
}

/// One octave with cubes of side 1.
fn emit_lattice_noise<D: Domain>(d: &mut D, p: [D::Real; 3], seed: D::Bits) -> D::Real {
    let cells = p.map(|coordinate| emit_cell(d, coordinate));
    let one = d.bits_constant(1);
    let mut hashes = vec![seed];
    for cell in &cells {
        let next = d.int_add(cell.number, one);
        let both = [cell.number, next];
        hashes = hashes.iter().flat_map(|&hash| both.map(|number| emit_absorb(d, hash, number))).collect();
    }
    // Neighbours in the list differ along the last axis.
    let mut values: Vec<D::Real> = hashes.into_iter().map(|hash| emit_random(d, hash)).collect();
    for cell in cells.iter().rev() {
        let t = emit_smooth(d, cell.rest);
        let mix = |pair: &[D::Real]| {
            let way = d.sub(pair[1], pair[0]);
            d.fma(t, way, pair[0])
        };
        values = values.chunks_exact(2).map(mix).collect();
    }
    values[0]
}

/// Takes a word into the hash.
fn absorb(hash: u32, word: i32) -> u32 {
    let hash = hash.wrapping_add(word as u32);
    let hash = hash.wrapping_add(hash << 10);
    hash ^ hash >> 6
}

fn emit_absorb<D: Domain>(d: &mut D, hash: D::Bits, word: D::Bits) -> D::Bits {
    let hash = d.int_add(hash, word);
    let hash = emit_add_shifted(d, hash, 10);
    emit_xor_shifted(d, hash, 6)
}

/// Spreads the absorbed words over all bits.
fn finish(hash: u32) -> u32 {
    let hash = hash.wrapping_add(hash << 3);
    let hash = hash ^ hash >> 11;
    hash.wrapping_add(hash << 15)
}

/// The upper 23 bits as a number from 0 to 1, which is not reached.
fn random(hash: u32) -> f64 {
    f64::from(hash >> 9) / f64::from(1 << 23)
}

/// [`finish`] and [`random`]. The bits become the mantissa of a number in [1, 2); subtracting 1 is exact.
fn emit_random<D: Domain>(d: &mut D, hash: D::Bits) -> D::Real {
    let hash = emit_add_shifted(d, hash, 3);
    let hash = emit_xor_shifted(d, hash, 11);
    let hash = emit_add_shifted(d, hash, 15);
    let (nine, exponent) = (d.bits_constant(9), d.bits_constant(1f32.to_bits()));
    let fraction = d.shr(hash, nine);
    let bits = d.bit_or(fraction, exponent);
    let (above_one, one) = (d.from_bits(bits), d.constant(1.0));
    d.sub(above_one, one)
}

fn emit_add_shifted<D: Domain>(d: &mut D, bits: D::Bits, by: u32) -> D::Bits {
    let by = d.bits_constant(by);
    let shifted = d.shl(bits, by);
    d.int_add(bits, shifted)
}

fn emit_xor_shifted<D: Domain>(d: &mut D, bits: D::Bits, by: u32) -> D::Bits {
    let by = d.bits_constant(by);
    let shifted = d.shr(bits, by);
    d.bit_xor(bits, shifted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::testing;

    #[test]
    fn corners_have_the_numbers_of_the_hash() {
        let noise = Noise { size: 2.0, octaves: 1.0, seed: -7.0 };
        for corner in [[0, 0, 0], [1, -3, 5], [-100, 2, 7]] {
            let [x, y, z] = corner;
            let hash = finish(absorb(absorb(absorb(-7i32 as u32, x), y), z));
            let p = DVec3::from_array(corner.map(f64::from)) * 2.0;
            assert!((noise.value(p) - random(hash)).abs() < 1e-12);
            let got = testing::emitted(&noise, p.as_vec3().to_array());
            assert_eq!(f64::from(got), random(hash), "whole numbers of 23 bits are exact");
        }
    }

    #[test]
    fn numbers_of_corners_are_spread_evenly() {
        let mut bins = [0; 10];
        for x in -20..20 {
            for y in -20..20 {
                for z in -20..20 {
                    bins[(random(finish(absorb(absorb(absorb(0, x), y), z))) * 10.0) as usize] += 1;
                }
            }
        }
        assert!(bins.iter().all(|&count| (5800..7000).contains(&count)), "{bins:?}");
        // Neighbours are uncorrelated.
        let value = |x: i32| random(finish(absorb(absorb(absorb(0, x), 0), 0))) - 0.5;
        let correlation: f64 = (0..10_000).map(|x| value(x) * value(x + 1)).sum::<f64>() / 10_000.0;
        assert!(correlation.abs() < 0.005, "{correlation}");
    }

    #[test]
    fn octaves_are_faults_outside_of_their_range() {
        let noise = |octaves| Noise { size: 1.0, octaves, seed: 0.0 };
        assert!(noise(9.0).fault().is_some() && noise(8.0).fault().is_none());
        assert_eq!(noise(0.25).value(DVec3::splat(0.3)), noise(1.0).value(DVec3::splat(0.3)));
    }

    #[test]
    fn both_forms_agree() {
        let [least, mean, most] = testing::judge(|rng| Noise {
            size: 0.5 + rng.f64(),
            octaves: 1.0 + 4.0 * rng.f64(),
            seed: 100.0 * rng.f64() - 50.0,
        });
        assert!(least < 0.15 && most > 0.85 && (mean - 0.5).abs() < 0.05, "{least} {mean} {most}");
    }
}
