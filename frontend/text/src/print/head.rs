//! Heads of the nodes of a printed model.

use std::fmt::Write as _;

use super::attribute::{attribute, before};
use super::formula::{expression, formula_warp};
use super::list::list;
use super::numbers::group_values;
use crate::particles::AT;
use crate::words::{COMMON_FIELDS, GROUP_NODE, PARTICLES, field_word, is_reserved};
use jbt_model::combine::{CombinatorKind, Syntax};
use jbt_model::falloff::FalloffKind;
use jbt_model::field::FieldKind;
use jbt_model::number::Number;
use jbt_model::particles::{ParticleValues, PerParticle};
use jbt_model::word::CONSTANT;
use jbt_model::written::{FieldNumber, ParticleRadius, Radius, Written, WrittenFalloff, WrittenParticles};

/// The head of an operator. Numbers are written even where they have their defaults.
fn operator(out: &mut String, kind: CombinatorKind, fields: &[FieldNumber]) {
    out.push_str(kind.head());
    for (described, value) in kind.fields().iter().zip(fields) {
        let FieldNumber::Real(number) = value else { unreachable!("operators have numbers") };
        let _ = match (described.kind, kind.syntax()) {
            (FieldKind::Choice(words), _) => {
                write!(out, " {}", words.get(number.value() as usize).unwrap_or(&words[0]))
            }
            (_, Syntax::Named) => write!(out, " {} {number}", described.name),
            (_, Syntax::Labelled | Syntax::Alone) => write!(out, " {number}"),
        };
    }
}

/// What stands before a node's block; of a primitive, all of it. Names of definitions begin with
/// `definitions`.
pub(crate) fn head(out: &mut String, written: &Written, definitions: &str) {
    match written {
        Written::Primitive { skeleton: kind, fields, falloff, radius, strength } => {
            let _ = write!(out, "{} {{", kind.name());
            for (described, value) in kind.fields().iter().zip(fields) {
                described.write(out, &field_word(*kind, described), value);
            }
            let _ = match radius {
                Radius::Support(radius) => write!(out, " radius {radius}"),
                Radius::Surface(radius) => write!(out, " surface_radius {radius}"),
            };
            falloff_of_leaf(out, falloff);
            if strength.depends_on_parameters() || strength.value().to_bits() != 1f64.to_bits() {
                let _ = write!(out, " strength {strength}");
            }
            out.push_str(" }");
        }
        Written::Particles(written) => particles(out, written),
        Written::Combine { combinator, fields } => operator(out, *combinator, fields),
        Written::Expression(formula) => expression(out, formula, |place| format!("n{place}"), definitions),
        Written::Select(which) => {
            let _ = write!(out, "select {which}");
        }
        Written::Map { map, fields } => {
            out.push_str(map.name());
            if map.is_named() {
                map.fields()
                    .iter()
                    .zip(fields)
                    .for_each(|(field, value)| field.write(out, field.name, value));
            } else {
                let all: Vec<&Number> = fields.iter().flat_map(FieldNumber::numbers).collect();
                let _ = write!(out, " {}", group_values(all));
            }
        }
        Written::Warp { warp, fields } => {
            out.push_str(warp.name());
            for (described, value) in warp.fields().iter().zip(fields) {
                described.write(out, described.name, value);
            }
        }
        Written::FormulaWarp(formula) => formula_warp(out, formula, definitions),
        Written::Attribute { name, value, precedence } => {
            before(out, *precedence);
            attribute(out, name, value, definitions);
        }
        Written::Constant { name, value, precedence } => {
            before(out, *precedence);
            let _ = write!(out, "{CONSTANT} {name} {value}");
        }
    }
}

/// The falloff of a primitive, or of particles.
fn falloff_of_leaf(out: &mut String, falloff: &WrittenFalloff) {
    if falloff.kind() != FalloffKind::Soft {
        let _ = write!(out, " falloff {}", falloff.kind().text(falloff.fields()));
    }
}

/// Particles: all of the node.
fn particles(out: &mut String, written: &WrittenParticles) {
    let WrittenParticles { positions, radius, strength, falloff, values } = written;
    let _ = write!(out, "{PARTICLES} {{");
    match radius {
        ParticleRadius::Support(radius) => per_particle(out, "radius", radius),
        ParticleRadius::Surface(radius) => per_particle(out, "surface_radius", radius),
    }
    falloff_of_leaf(out, falloff);
    let is_one =
        |number: &Number| !number.depends_on_parameters() && number.value().to_bits() == 1f64.to_bits();
    if !strength.all().is_some_and(is_one) {
        per_particle(out, "strength", strength);
    }
    for ParticleValues { name, width, numbers } in &**values {
        let is_taken = is_reserved(name) || **name == *AT || COMMON_FIELDS.contains(&&**name);
        let _ = if is_taken { write!(out, " {GROUP_NODE} {name} ") } else { write!(out, " {name} ") };
        if numbers.len() == *width {
            out.push_str(&group_values(numbers.iter()));
        } else {
            list(out, numbers, *width);
        }
    }
    let _ = write!(out, " {AT} ");
    list(out, positions, 3);
    out.push_str(" }");
}

fn per_particle(out: &mut String, word: &str, numbers: &PerParticle<Number>) {
    let _ = match numbers {
        PerParticle::All(number) => write!(out, " {word} {number}"),
        PerParticle::Each(numbers) => write!(out, " {word} ").map(|()| list(out, numbers, 1)),
    };
}
