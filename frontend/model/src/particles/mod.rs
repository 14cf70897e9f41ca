//! Particles: any number of points in one node, as arrays. They mean the sum of these points, in the order
//! of the arrays, and have the bits of that sum.
//!
//! ```text
//!  positions  x y z x y z x y z ..        ►   rows of one table: no node, no name and no allocation
//!  radius     r, or r r r ..                  for a point
//!  strength   s, or s s s ..
//!  values     of attribute groups
//! ```
//!
//! What was written is a [`WrittenParticles`](crate::written::WrittenParticles); here are plain values.

mod array;

use std::sync::Arc;

use glam::DVec3;

use crate::bounds::Bounds;
use crate::combine::extent::Extent;
use crate::falloff::Falloff;
use crate::skeleton::Point;

pub use array::{NumberArray, PerParticle};

/// The values of particles in an attribute group.
#[derive(Clone, PartialEq, Debug)]
pub struct ParticleValues {
    /// The group.
    pub name: Arc<str>,
    /// How many numbers a particle has in it, at least one.
    pub width: usize,
    /// The numbers of each particle, one particle after the other; or those of one, for all.
    pub numbers: NumberArray,
}

impl ParticleValues {
    /// The numbers of a particle. Panics if there are not as many.
    pub fn of(&self, particle: usize) -> impl Iterator<Item = f64> {
        let first = if self.is_one() { 0 } else { particle * self.width };
        (first..first + self.width).map(|index| self.numbers.at(index))
    }

    /// Those of some particles. Panics if there are not as many.
    pub(crate) fn picked(&self, particles: &[usize]) -> Self {
        let numbers =
            if self.is_one() { self.numbers.clone() } else { self.numbers.picked(particles, self.width) };
        Self { name: Arc::clone(&self.name), width: self.width, numbers }
    }

    /// Whether all particles have the same.
    fn is_one(&self) -> bool {
        self.numbers.len() == self.width
    }
}

/// Any number of points. See the module.
#[derive(Clone, Debug)]
pub struct Particles {
    positions: NumberArray,
    radius: PerParticle<f64>,
    strength: PerParticle<f64>,
    falloff: Falloff,
    values: Arc<[ParticleValues]>,
    extent: Extent,
}

impl PartialEq for Particles {
    /// Equal numbers; the extent follows from them.
    fn eq(&self, other: &Self) -> bool {
        let Self { positions, radius, strength, falloff, values, extent: _ } = self;
        *positions == other.positions
            && *radius == other.radius
            && *strength == other.strength
            && *falloff == other.falloff
            && *values == other.values
    }
}

impl Particles {
    /// Particles of these numbers: three for each position; radii of supports and strengths are one for all,
    /// or as many as there are positions. Panics if they are not.
    #[must_use]
    pub fn new(
        positions: NumberArray,
        radius: PerParticle<f64>,
        strength: PerParticle<f64>,
        falloff: Falloff,
        values: Arc<[ParticleValues]>,
    ) -> Self {
        let extent = Extent { support: Bounds::EMPTY, negative: Bounds::EMPTY };
        let mut particles = Self { positions, radius, strength, falloff, values, extent };
        particles.extent = particles.found_extent();
        particles
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len() / 3
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// All positions.
    #[must_use]
    pub fn positions(&self) -> &NumberArray {
        &self.positions
    }

    /// Where a particle is.
    #[must_use]
    #[inline]
    pub fn at(&self, particle: usize) -> DVec3 {
        self.positions.triple(particle).into()
    }

    /// A particle as a skeleton.
    #[must_use]
    #[inline]
    pub fn point(&self, particle: usize) -> Point {
        Point { at: self.at(particle) }
    }

    /// Where the field of a particle reaches zero.
    #[must_use]
    #[inline]
    pub fn radius(&self, particle: usize) -> f64 {
        self.radius.at(particle)
    }

    /// All radii.
    #[must_use]
    pub fn radii(&self) -> &PerParticle<f64> {
        &self.radius
    }

    /// The factor of the field of a particle.
    #[must_use]
    #[inline]
    pub fn strength(&self, particle: usize) -> f64 {
        self.strength.at(particle)
    }

    /// All strengths.
    #[must_use]
    pub fn strengths(&self) -> &PerParticle<f64> {
        &self.strength
    }

    /// How their fields fade.
    #[must_use]
    pub fn falloff(&self) -> &Falloff {
        &self.falloff
    }

    /// Their values in attribute groups: of other groups they have what is bound above them.
    #[must_use]
    pub fn values(&self) -> &Arc<[ParticleValues]> {
        &self.values
    }

    /// Their values in an attribute group; `None` if they have none of their own.
    #[must_use]
    pub fn values_of(&self, group: &str) -> Option<&ParticleValues> {
        self.values.iter().find(|values| *values.name == *group)
    }

    /// The same with values in one more group.
    pub(crate) fn with_values(&self, values: ParticleValues) -> Self {
        let values = self.values.iter().cloned().chain([values]).collect();
        Self { values, ..self.clone() }
    }

    /// Where the sum of their fields can be something else than zero, and negative.
    #[must_use]
    pub fn extent(&self) -> Extent {
        self.extent
    }

    fn found_extent(&self) -> Extent {
        let mut extent = self.extent;
        for particle in 0..self.len() {
            let at = self.at(particle);
            let support = Bounds::new(at, at).grown(self.radius(particle));
            extent.support = extent.support.hull(support);
            if self.strength(particle) < 0.0 {
                extent.negative = extent.negative.hull(support);
            }
        }
        extent
    }
}
