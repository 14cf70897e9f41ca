//! What several models say of themselves besides their trees, in one: iso-value, attributes, parameters.

use jbt::AttributeGroup;
use jbt_model::model::Model;
use pyo3::prelude::*;

use crate::error::refused;

/// What several models say of themselves besides their trees, in one.
pub(crate) fn merged<'a>(mut all: impl Iterator<Item = &'a Model>) -> PyResult<Model> {
    let Some(first) = all.next() else {
        return Err(refused("models: expected one model or more, got none"));
    };
    let mut merged = first.clone();
    for model in all {
        if merged.iso != model.iso {
            let (a, b) = (merged.iso.to_string(), model.iso.to_string());
            return Err(refused(format!(
                "models with the iso-values {a} and {b} cannot be combined: give both one by .with_iso(..)"
            )));
        }
        if merged.orientation != model.orientation {
            return Err(refused(
                "models that stand in different ways cannot be combined: give both one by .with_orientation(..)",
            ));
        }
        merge_groups(&mut merged.attributes, &model.attributes)?;
        for parameter in &model.parameters {
            match merged.parameters.iter().find(|known| known.name() == parameter.name()) {
                None => merged.parameters.push(parameter.clone()),
                Some(known) if known == parameter => {}
                Some(known) => {
                    let (name, a, b) = (known.name(), known.value(), parameter.value());
                    return Err(refused(format!(
                        "the parameter `{name}` is {a} in one model and {b} in another one"
                    )));
                }
            }
        }
        if model.origin.is_some() && merged.origin.is_some() && merged.origin != model.origin {
            merged.origin = None;
        } else {
            merged.origin = merged.origin.or(model.origin);
        }
        // Places are those of one text: of two texts none are told.
        merged.source = match (merged.source.take(), &model.source) {
            (Some(a), Some(b)) if a.name() == b.name() && a.text() == b.text() => Some(a),
            (Some(_), Some(_)) => None,
            (a, b) => a.or_else(|| b.clone()),
        };
    }
    Ok(merged)
}

fn merge_groups(groups: &mut Vec<AttributeGroup>, others: &[AttributeGroup]) -> PyResult<()> {
    for other in others {
        match groups.iter_mut().find(|known| known.name == other.name) {
            None => groups.push(other.clone()),
            Some(known) if known == other || *other == AttributeGroup::color() => {}
            Some(known) if *known == AttributeGroup::color() => *known = other.clone(),
            Some(known) => {
                return Err(refused(format!(
                    "the attribute `{}` is declared in two ways: give both models one by .group(..)",
                    known.name
                )));
            }
        }
    }
    Ok(())
}
