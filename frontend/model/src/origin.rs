//! The origin of a model: the point of the world from which its f32 coordinates count.
//!
//! ```text
//! world p, in f64   p = o + q   texts, regions, cameras, files
//! local q, in f32   q = p - o   programs, lattices, boxes, meshes
//! ```
//!
//! An f32 has 24 binary digits: at 1e5 the last one is 0.008. The numbers that matter in a model there, sizes
//! and distances of its parts, are small, and they stay precise if its coordinates count from a point near
//! it. The origin enters the rows of leaves, warps and textures: the map `q = R p + t` to a leaf's own space
//! gets `t' = t + R o`, in f64, rounded once.
//!
//! The origin belongs to the checked model. It is found once; parameters, edits, boxes and lattices keep it,
//! because another origin changes the last digits of the field. Its coordinates are multiples of a power of
//! two, so exact numbers stay exact.

use crate::bounds::Bounds;
use glam::DVec3;

/// The distance of a model from the world's origin, in sizes of the model, beyond which it gets an origin of
/// its own.
const FAR: f64 = 64.0;

/// The point of the world from which local coordinates of a model count. See the module.
///
/// ```
/// use jbt_model::{builder::point, model::Model};
/// let ball = point([0.25, 0.0, 0.0], 1.0);
/// let near = Model::new(ball.clone()).check().unwrap();
/// assert_eq!(near.origin().point(), [0.0; 3]);
/// let far = Model::new(ball.translate([100_000.0, 0.0, 0.0])).check().unwrap();
/// assert_eq!(far.origin().point(), [100_000.0, 0.0, 0.0]);
/// assert_eq!(far.origin().local([100_000.5, 0.0, 1.0]), [0.5, 0.0, 1.0]);
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct ModelOrigin([f64; 3]);

impl ModelOrigin {
    /// The world's origin: local coordinates are world coordinates.
    pub const WORLD: Self = Self([0.0; 3]);

    /// An origin at a point of the world. Its coordinates are finite.
    #[must_use]
    pub const fn new(point: [f64; 3]) -> Self {
        Self(point)
    }

    /// The origin for a model in a box: the world's origin, unless the centre of the box is more than 64 of
    /// its longest sides away; else that centre, with each coordinate rounded to a multiple of the least
    /// power of two that is at least the longest side.
    #[must_use]
    pub fn of(bounds: Bounds) -> Self {
        let size = bounds.longest_side();
        if bounds.is_empty() || !bounds.is_finite() || !size.is_normal() {
            return Self::WORLD;
        }
        let center = bounds.min.midpoint(bounds.max);
        if center.length() <= FAR * size {
            return Self::WORLD;
        }
        // By the exponent bits: no logarithm, whose rounding could decide.
        let below = f64::from_bits(size.to_bits() & 0x7ff0_0000_0000_0000);
        let step = if below < size { 2.0 * below } else { below };
        Self(center.to_array().map(|x| (x / step).round() * step))
    }

    /// Its coordinates in the world.
    #[must_use]
    pub const fn point(self) -> [f64; 3] {
        self.0
    }

    /// Whether it is the world's origin.
    #[must_use]
    pub fn is_world(self) -> bool {
        self.0 == [0.0; 3]
    }

    /// The local coordinates of a point of the world.
    #[must_use]
    pub fn local(self, world: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| world[axis] - self.0[axis])
    }

    /// The local coordinates of a point of the world, rounded once to f32, as programs take them.
    #[must_use]
    pub fn rounded(self, world: [f64; 3]) -> [f32; 3] {
        self.local(world).map(|x| x as f32)
    }

    /// The point of the world with these local coordinates.
    #[must_use]
    pub fn world(self, local: [f64; 3]) -> [f64; 3] {
        // A sum with 0 would lose the sign of a zero.
        if self.is_world() { local } else { [0, 1, 2].map(|axis| local[axis] + self.0[axis]) }
    }

    /// A box of the world in local coordinates.
    #[must_use]
    pub fn local_bounds(self, bounds: Bounds) -> Bounds {
        bounds.moved(-DVec3::from(self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(center: [f64; 3], half: f64) -> [f64; 3] {
        let center = DVec3::from(center);
        ModelOrigin::of(Bounds::new(center - half, center + half)).point()
    }

    #[test]
    fn what_is_near_counts_from_the_world() {
        assert_eq!(of([0.0; 3], 1.0), [0.0; 3]);
        assert_eq!(of([128.0, 0.0, 0.0], 1.0), [0.0; 3]);
        assert_eq!(of([0.0, 1e9, 0.0], 1e8), [0.0; 3]);
        for bounds in [Bounds::EMPTY, Bounds::EVERYWHERE, Bounds::new(DVec3::ONE, DVec3::ONE)] {
            assert_eq!(ModelOrigin::of(bounds), ModelOrigin::WORLD);
        }
        let half_space = Bounds::new(DVec3::splat(1e6), DVec3::new(1e6 + 1.0, 1e6 + 1.0, f64::INFINITY));
        assert_eq!(ModelOrigin::of(half_space), ModelOrigin::WORLD);
    }

    #[test]
    fn what_is_far_counts_from_a_multiple_of_a_power_of_two() {
        assert_eq!(of([129.0, 0.0, 0.9], 1.0), [130.0, 0.0, 0.0]);
        assert_eq!(of([100_000.3, -100_000.0, 33_000.0], 1.5), [100_000.0, -100_000.0, 33_000.0]);
        assert_eq!(of([0.0, 0.0, -1.0], 0.001), [0.0, 0.0, -1.0]);
        for half in [0.3, 0.5, 0.7, 1.0, 3.0] {
            let center = [12_345.678, -9876.54, 0.31];
            for (origin, center) in of(center, half).into_iter().zip(center) {
                assert!((origin - center).abs() <= 2.0 * half, "{origin} is not near {center}");
                assert_eq!(origin * 16.0, (origin * 16.0).round());
            }
        }
    }

    #[test]
    fn local_and_world_are_inverse() {
        let origin = ModelOrigin::new([1024.0, -2048.0, 0.5]);
        let p = [1000.25, -2047.0, 0.125];
        assert_eq!(origin.world(origin.local(p)), p);
        assert_eq!(origin.rounded(p), [-23.75, 1.0, -0.375]);
        assert!(ModelOrigin::WORLD.world([-0.0; 3])[0].is_sign_negative());
        assert!(ModelOrigin::WORLD.local([-0.0; 3])[0].is_sign_negative());
    }
}
