//! The check of particles: the numbers of arrays, of which the first bad ones are named by their place.

use std::collections::BTreeMap;

use jbt_ir::limits;

use super::fields::check_falloff;
use super::groups::{another_width, known_width};
use super::numbers::{check_number, check_numbers};
use crate::diagnostic::{Diagnostic, Span};
use crate::particles::{ParticleValues, Particles, PerParticle};
use crate::report::{Report, clip};

pub(super) fn check_particles(
    report: &mut Report,
    span: Option<Span>,
    particles: &Particles,
    groups: &BTreeMap<&str, usize>,
) {
    check_falloff(report, span, particles.falloff());
    let count = particles.len();
    let is_bad = |place: &usize| !particles.positions().triple(*place).into_iter().all(is_ordinary);
    if let Some(place) = (0..count).find(is_bad) {
        let what = format!("the position of particle {place}");
        check_numbers(report, span, what, &particles.positions().triple(place), f64::NEG_INFINITY);
    }
    check_each(report, span, "radius", particles.radii(), limits::MIN_LENGTH);
    check_each(report, span, "strength", particles.strengths(), f64::NEG_INFINITY);
    for (place, ParticleValues { name, width, numbers }) in particles.values().iter().enumerate() {
        if particles.values()[..place].iter().any(|other| other.name == *name) {
            let message = format!("particles have the attribute `{}` twice", clip(name));
            report.add(|| Diagnostic::error(span, message));
        }
        let Some(expected) = known_width(report, span, name, groups) else { continue };
        if expected != *width {
            report.add(|| another_width(span, name, expected, *width));
        }
        if let Some(place) = (0..numbers.len()).find(|&place| !is_ordinary(numbers.at(place))) {
            let what = format!("the attribute `{name}` of particle {}", place / width);
            check_number(report, span, what, numbers.at(place), f64::NEG_INFINITY);
        }
    }
}

/// Numbers of particles: the first that is no good one.
fn check_each(report: &mut Report, span: Option<Span>, what: &str, numbers: &PerParticle<f64>, least: f64) {
    match numbers {
        PerParticle::All(number) => {
            check_number(report, span, format_args!("the {what}"), *number, least);
        }
        PerParticle::Each(numbers) => {
            let is_bad = |place: &usize| !(is_ordinary(numbers.at(*place)) && numbers.at(*place) >= least);
            if let Some(place) = (0..numbers.len()).find(is_bad) {
                let what = format!("the {what} of particle {place}");
                check_number(report, span, what, numbers.at(place), least);
            }
        }
    }
}

/// Whether a number is finite, and not too large.
fn is_ordinary(number: f64) -> bool {
    number.abs() <= limits::MAX_NUMBER
}
