//! The written of particles.

use std::sync::Arc;

use jbt_ir::limits;

use super::falloff::WrittenFalloff;
use super::field::FieldNumber;
use super::surface::{support_radius, surface_scale};
use crate::falloff::Falloff;
use crate::number::Number;
use crate::particles::{NumberArray, ParticleValues, Particles, PerParticle};
use crate::report::{Fault, clip};

/// The radii of particles.
#[derive(Clone, PartialEq, Debug)]
pub enum ParticleRadius {
    /// Where their fields reach zero.
    Support(PerParticle<Number>),
    /// Where each alone meets the iso-value of the model.
    Surface(PerParticle<Number>),
}

impl ParticleRadius {
    pub(super) fn numbers(&self) -> &PerParticle<Number> {
        match self {
            Self::Support(numbers) | Self::Surface(numbers) => numbers,
        }
    }

    fn numbers_mut(&mut self) -> &mut PerParticle<Number> {
        match self {
            Self::Support(numbers) | Self::Surface(numbers) => numbers,
        }
    }
}

/// Any number of points, as arrays: see [`particles`](crate::particles). What is one number for all of them
/// may follow a parameter.
#[derive(Clone, PartialEq, Debug)]
pub struct WrittenParticles {
    /// Three numbers for each.
    pub positions: NumberArray,
    /// How far their fields reach.
    pub radius: ParticleRadius,
    /// The factors of their fields.
    pub strength: PerParticle<Number>,
    /// How their fields fade.
    pub falloff: WrittenFalloff,
    /// Their values in attribute groups, each group at most once.
    pub values: Arc<[ParticleValues]>,
}

impl WrittenParticles {
    /// Particles of strength 1 with the soft object's falloff, without attributes.
    #[must_use]
    pub fn new(positions: impl Into<NumberArray>, radius: ParticleRadius) -> Self {
        Self {
            positions: positions.into(),
            radius,
            strength: 1.0.into(),
            falloff: Falloff::Soft.into(),
            values: Arc::default(),
        }
    }

    /// The same with these values in an attribute group, instead of others.
    #[must_use]
    pub fn with_values(mut self, values: ParticleValues) -> Self {
        let mut all: Vec<ParticleValues> = self.values.to_vec();
        all.retain(|other| other.name != values.name);
        all.push(values);
        self.values = all.into();
        self
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

    /// Some of the particles, by their places in the arrays. Panics if there are not as many, or if arrays
    /// have other lengths than they should.
    #[must_use]
    pub fn picked(&self, particles: &[usize]) -> Self {
        let radius = self.radius.numbers().picked(particles);
        Self {
            positions: self.positions.picked(particles, 3),
            radius: match &self.radius {
                ParticleRadius::Support(_) => ParticleRadius::Support(radius),
                ParticleRadius::Surface(_) => ParticleRadius::Surface(radius),
            },
            strength: self.strength.picked(particles),
            falloff: self.falloff.clone(),
            values: self.values.iter().map(|values| values.picked(particles)).collect(),
        }
    }

    /// The numbers that may follow parameters, but for those of the falloff: at most two.
    pub(super) fn own_numbers(&self) -> [Option<&Number>; 2] {
        [self.radius.numbers().all(), self.strength.all()]
    }

    pub(super) fn numbers_mut(&mut self) -> impl Iterator<Item = &mut Number> {
        let own = [self.radius.numbers_mut(), &mut self.strength];
        let own = own.into_iter().filter_map(|numbers| match numbers {
            PerParticle::All(number) => Some(number),
            PerParticle::Each(_) => None,
        });
        self.falloff.fields_mut().iter_mut().flat_map(FieldNumber::numbers_mut).chain(own)
    }

    /// What they mean with the present values of numbers, in a model of this iso-value.
    pub(super) fn particles(&self, iso: f64) -> Result<Particles, Fault> {
        self.check_lengths()?;
        let (falloff, strength) = (self.falloff.falloff(), self.strength.value());
        let radius = match &self.radius {
            ParticleRadius::Support(radius) => radius.value(),
            ParticleRadius::Surface(radius) => self.supports(&radius.value(), (falloff, &strength), iso)?,
        };
        Ok(Particles::new(self.positions.clone(), radius, strength, falloff, Arc::clone(&self.values)))
    }

    /// The support radii of these surface radii.
    fn supports(
        &self,
        radius: &PerParticle<f64>,
        (falloff, strength): (Falloff, &PerParticle<f64>),
        iso: f64,
    ) -> Result<PerParticle<f64>, Fault> {
        let of = |particle: usize, fault: Fault| {
            let message = format!("of particle {particle}: {}", fault.message);
            Fault { message, ..fault }
        };
        match (radius, strength) {
            (PerParticle::All(radius), PerParticle::All(strength)) => {
                Ok(PerParticle::All(support_radius(*radius, falloff, *strength, iso)?))
            }
            (_, PerParticle::All(strength)) => {
                // Of one strength, all have the same scale.
                let scale = surface_scale(falloff, *strength, iso)?;
                let support = |particle: usize| {
                    let radius = radius.at(particle);
                    if radius > 0.0 {
                        return Ok(radius / scale);
                    }
                    support_radius(radius, falloff, *strength, iso).map_err(|fault| of(particle, fault))
                };
                let radii: Vec<f64> = (0..self.len()).map(support).collect::<Result<_, _>>()?;
                Ok(PerParticle::Each(radii.into()))
            }
            (_, PerParticle::Each(strengths)) => {
                let support = |particle: usize| {
                    support_radius(radius.at(particle), falloff, strengths.at(particle), iso)
                        .map_err(|fault| of(particle, fault))
                };
                let radii: Vec<f64> = (0..self.len()).map(support).collect::<Result<_, _>>()?;
                Ok(PerParticle::Each(radii.into()))
            }
        }
    }

    /// Lists have to be as long as there are particles.
    fn check_lengths(&self) -> Result<(), Fault> {
        let count = self.len();
        let fault = |message: String, help| Err(Fault { message, help: Some(help) });
        if !self.positions.len().is_multiple_of(3) {
            return fault(
                format!("the positions of particles are {} numbers", self.positions.len()),
                "expected three for each particle",
            );
        }
        if count == 0 {
            return fault("there are no particles".to_owned(), "expected at least one");
        }
        if count > limits::MAX_PARTICLES {
            let message = format!("{count} particles; there may be {}", limits::MAX_PARTICLES);
            return fault(message, "expected fewer particles");
        }
        for ParticleValues { name, width, numbers } in &*self.values {
            let fits = [Some(*width), width.checked_mul(count)].contains(&Some(numbers.len())) && *width > 0;
            if !fits {
                let message = format!("{count} particles have {} numbers of `{}`", numbers.len(), clip(name));
                return fault(message, "expected those of one particle, or those of each");
            }
        }
        for (what, numbers) in [("radii", self.radius.numbers()), ("strengths", &self.strength)] {
            if let PerParticle::Each(numbers) = numbers
                && numbers.len() != count
            {
                let message = format!("{count} particles have {} {what}", numbers.len());
                return fault(message, "expected one number for all, or one for each");
            }
        }
        Ok(())
    }
}

impl From<Particles> for WrittenParticles {
    fn from(particles: Particles) -> Self {
        Self {
            positions: particles.positions().clone(),
            radius: ParticleRadius::Support(particles.radii().clone().into()),
            strength: particles.strengths().clone().into(),
            falloff: (*particles.falloff()).into(),
            values: Arc::clone(particles.values()),
        }
    }
}
