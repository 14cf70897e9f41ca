//! From arrays to a model: what all files of particles have in common.

use std::collections::HashSet;

use jbt_ir::watch;

use super::anisotropic::{FluidKernel, kernels};
use super::options::{ParticleForm, ParticleOptions};
use crate::import::imported::ReadModel;
use crate::import::srgb::decoded;
use jbt_model::attribute::{AttributeGroup, Mixing};
use jbt_model::diagnostic::Diagnostic;
use jbt_model::falloff::{Blinn, Edge};
use jbt_model::model::Model;
use jbt_model::number::Number;
use jbt_model::particles::{NumberArray, ParticleValues, PerParticle};
use jbt_model::report::clip;
use jbt_model::tree::Tree;
use jbt_model::written::{ParticleRadius, WrittenParticles};

/// Up to so many points are looked at for those that stand at one place.
const MOST_COMPARED: usize = 1 << 20;
/// How far Blinn's field reaches, in radii.
const CUTOFF: f64 = 4.0;

/// Points with what a file says about them.
#[derive(Default)]
pub(super) struct Cloud {
    /// Three numbers for each.
    pub(super) positions: Option<NumberArray>,
    /// One for each, if there are any.
    pub(super) radii: Option<NumberArray>,
    pub(super) strengths: Option<NumberArray>,
    /// Linear red, green and blue for each, if there are any.
    pub(super) colors: Option<NumberArray>,
    /// Arrays by name, with as many numbers for each point.
    pub(super) values: Vec<(String, usize, NumberArray)>,
    pub(super) warnings: Vec<Diagnostic>,
}

impl Cloud {
    /// Points at these places.
    pub(super) fn at(positions: impl Into<NumberArray>) -> Self {
        Self { positions: Some(positions.into()), ..Self::default() }
    }

    /// The model.
    pub(super) fn model(mut self, options: &ParticleOptions) -> ReadModel {
        self.find(&options.values)?;
        let positions = self.positions.take().unwrap_or_else(|| Vec::<f32>::new().into());
        if positions.is_empty() {
            return Err(vec![Diagnostic::error(None, "there are no points")]);
        }
        let bad = (0..positions.len()).find(|&index| !positions.at(index).is_finite());
        if let Some(index) = bad {
            let [x, y, z] = positions.triple(index / 3);
            let message = format!("point {} is at ({x} {y} {z})", index / 3);
            return Err(vec![Diagnostic::error(None, message).expected("expected finite numbers")]);
        }
        let radius = self.radius(options)?;
        self.count_repeated(&positions);
        let kernels = self.shaped(&positions, options)?;
        let (radius, strength, falloff, iso) =
            formed(options.form.unwrap_or_default(), radius, self.strengths);
        let mut particles = WrittenParticles { strength, ..WrittenParticles::new(positions, radius) };
        if let Some(falloff) = falloff {
            particles.falloff = falloff.into();
        }
        if let Some(numbers) = self.colors {
            particles = particles.with_values(ParticleValues { name: "color".into(), width: 3, numbers });
        }
        let mut groups = Vec::new();
        for (name, width, numbers) in self.values {
            let name = identifier(&name);
            groups.push(AttributeGroup {
                name: name.as_str().into(),
                default: vec![0.0; width],
                mixing: Mixing::Blend,
                ..AttributeGroup::color()
            });
            particles = particles.with_values(ParticleValues { name: name.into(), width, numbers });
        }
        let mut tree = Tree::new(particles, Vec::new());
        if let Some(kernels) = kernels {
            let points = tree.as_points();
            let both = points.node().children().iter().zip(kernels);
            tree = Tree::sum(both.map(|(point, kernel)| point.affine(kernel.rows)));
        }
        let mut model = Model::new(tree);
        model.iso = Number::from(iso);
        model.attributes.extend(groups);
        Ok((model, self.warnings))
    }

    /// Makes sure that arrays that are asked for are there.
    fn find(&self, names: &[String]) -> Result<(), Vec<Diagnostic>> {
        let is_there = |name: &&String| self.values.iter().any(|(known, ..)| known == *name);
        match names.iter().find(|name| !is_there(name)) {
            Some(name) => {
                let message = format!("points have no array `{}`", clip(name));
                Err(vec![Diagnostic::error(None, message)])
            }
            None => Ok(()),
        }
    }

    /// The kernels of the points, if they are to follow their neighbourhoods; their strengths are in those of
    /// the points then.
    fn shaped(
        &mut self,
        positions: &NumberArray,
        options: &ParticleOptions,
    ) -> Result<Option<Vec<FluidKernel>>, Vec<Diagnostic>> {
        let Some(radius) = options.anisotropic else { return Ok(None) };
        if !(radius > 0.0 && radius.is_finite()) {
            let message = format!("the radius of neighbourhoods is {radius}");
            return Err(vec![Diagnostic::error(None, message).expected("expected a number above 0")]);
        }
        let kernels = kernels(positions, radius)?;
        let strength = |n: usize| self.strengths.as_ref().map_or(1.0, |strengths| strengths.at(n));
        let strengths: Vec<f64> =
            kernels.iter().enumerate().map(|(n, kernel)| kernel.strength * strength(n)).collect();
        self.strengths = Some(strengths.into());
        Ok(Some(kernels))
    }

    /// The radii: those of the file, or the one that was asked for.
    fn radius(&self, options: &ParticleOptions) -> Result<PerParticle<Number>, Vec<Diagnostic>> {
        let scale = options.scale.unwrap_or(1.0);
        if !(scale > 0.0 && scale.is_finite()) {
            let message = format!("the scale of radii is {scale}");
            return Err(vec![Diagnostic::error(None, message).expected("expected a number above 0")]);
        }
        match (&self.radii, options.radius) {
            (_, Some(radius)) => Ok(PerParticle::All((radius * scale).into())),
            (Some(radii), None) if scale == 1.0 => Ok(PerParticle::Each(radii.clone())),
            (Some(radii), None) => {
                Ok(PerParticle::Each(radii.iter().map(|radius| scale * radius).collect::<Vec<f64>>().into()))
            }
            (None, None) => Err(vec![
                Diagnostic::error(None, "the points have no radius of their own")
                    .expected("expected a radius for all of them, as by --radius 0.1"),
            ]),
        }
    }

    /// A note about points that stand where others stand: they add up.
    fn count_repeated(&mut self, positions: &NumberArray) {
        let count = positions.len() / 3;
        if count > MOST_COMPARED {
            return;
        }
        // A table has a power of two of places, of which it fills seven of eight, and a byte more for each.
        watch::take((count * 8 / 7).next_power_of_two() * (size_of::<[u64; 3]>() + 1));
        let mut seen = HashSet::with_capacity(count);
        let places = (0..count).map(|index| positions.triple(index).map(|x| (x + 0.0).to_bits()));
        let repeated = places.filter(|place| !seen.insert(*place)).count();
        if repeated > 0 {
            let (plural, verb) = if repeated == 1 { ("", "stands") } else { ("s", "stand") };
            let message = format!("{repeated} point{plural} {verb} where another one does: they add up");
            self.warnings.push(Diagnostic::warning(None, message));
        }
    }
}

/// Radii, strengths, falloff and iso-value of a form.
fn formed(
    form: ParticleForm,
    radius: PerParticle<Number>,
    strengths: Option<NumberArray>,
) -> (ParticleRadius, PerParticle<Number>, Option<Blinn>, f64) {
    match form {
        ParticleForm::Soft => {
            let is_plain = strengths.is_none();
            let strength = strengths.map_or_else(|| 1.0.into(), PerParticle::Each);
            // A strength moves the surface; the radius is that of a particle of strength 1.
            let radius = if is_plain { ParticleRadius::Surface(radius) } else { times(radius, 2.0) };
            (radius, strength, None, Model::DEFAULT_ISO)
        }
        ParticleForm::Blinn(hardness) => {
            let peak = hardness.exp();
            let strength = match strengths {
                None => PerParticle::All(peak.into()),
                Some(each) => PerParticle::Each(each.iter().map(|it| it * peak).collect::<Vec<f64>>().into()),
            };
            let falloff = Blinn { hardness, cutoff: CUTOFF, edge: Edge::Exact };
            (times(radius, CUTOFF), strength, Some(falloff), 1.0)
        }
    }
}

/// Support radii that are so many times these.
fn times(radius: PerParticle<Number>, factor: f64) -> ParticleRadius {
    ParticleRadius::Support(match radius {
        PerParticle::All(radius) => PerParticle::All(radius * factor),
        PerParticle::Each(each) => {
            PerParticle::Each(each.iter().map(|radius| factor * radius).collect::<Vec<f64>>().into())
        }
    })
}

/// A name that an attribute may have, made of one of a file.
fn identifier(name: &str) -> String {
    let letter = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '_' };
    let made: String = clip(name).chars().map(letter).collect();
    let first = made.chars().next().is_some_and(|c| c.is_ascii_alphabetic());
    let is_taken = matches!(made.as_str(), "color" | "x" | "y" | "z" | "field" | "gx" | "gy" | "gz");
    if first && !is_taken { made } else { format!("a_{made}") }
}

/// Linear colours of those that a screen is given: of bytes, if any number is above 1.
pub(super) fn linear_colors(mut screen: Vec<f32>, are_bytes: bool) -> NumberArray {
    let scale = if are_bytes || screen.iter().any(|&number| number > 1.0) { 255.0 } else { 1.0 };
    // Bytes are most of them.
    let table: Vec<f32> = (0..=255).map(|byte| decoded(f64::from(byte) / 255.0) as f32).collect();
    for number in &mut screen {
        *number = match table.get(*number as usize) {
            Some(&linear) if scale > 1.0 && number.fract() == 0.0 && *number >= 0.0 => linear,
            _ => decoded(f64::from(*number).max(0.0) / scale) as f32,
        };
    }
    screen.into()
}
