//! Particles as nodes: each a point by itself.

use std::sync::Arc;

use super::{ParticleRadius, Radius, Written, WrittenAttribute, WrittenParticles};
use crate::field::FieldOf;
use crate::number::Number;
use crate::particles::{ParticleValues, PerParticle};
use crate::skeleton::SkeletonKind;

/// A point, and the attributes that it has of its own.
pub type WrittenPoint = (Written, Vec<(Arc<str>, WrittenAttribute)>);

impl WrittenParticles {
    /// The points whose sum they mean, as nodes of their own, each with the attributes that it has. Panics if
    /// arrays have other lengths than they should.
    #[must_use]
    pub fn points(&self) -> Vec<WrittenPoint> {
        let number = |numbers: &PerParticle<Number>, particle: usize| match numbers {
            PerParticle::All(number) => number.clone(),
            PerParticle::Each(numbers) => numbers.at(particle).into(),
        };
        let point = |particle: usize| {
            let radius = number(self.radius.numbers(), particle);
            let written = Written::Primitive {
                skeleton: SkeletonKind::Point,
                fields: vec![FieldOf::Vector(self.positions.triple(particle)).into()],
                falloff: self.falloff.clone(),
                radius: match &self.radius {
                    ParticleRadius::Support(_) => Radius::Support(radius),
                    ParticleRadius::Surface(_) => Radius::Surface(radius),
                },
                strength: number(&self.strength, particle),
            };
            let given = |values: &ParticleValues| {
                let numbers = values.of(particle).map(Number::from).collect();
                (Arc::clone(&values.name), WrittenAttribute::Numbers(numbers))
            };
            (written, self.values.iter().map(given).collect())
        };
        (0..self.len()).map(point).collect()
    }
}

impl From<WrittenParticles> for Written {
    fn from(particles: WrittenParticles) -> Self {
        Self::Particles(Box::new(particles))
    }
}
