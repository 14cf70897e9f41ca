//! Falloffs with parameters, for [`Tree::falloff`](crate::tree::Tree::falloff). The others are there by their names, as
//! [`Falloff::Wyvill`](crate::falloff::Falloff::Wyvill).

use super::real;
use crate::falloff::{Edge, FalloffKind};
use crate::number::Number;
use crate::recipe::{FalloffRecipe, FieldNumber};

/// A falloff `(1 - r^2)^n`. See [`Degree`](crate::falloff::Degree).
#[must_use]
pub fn degree(exponent: impl Into<Number>) -> FalloffRecipe {
    FalloffRecipe::new(FalloffKind::Degree(0), vec![real(exponent)])
}

/// A Gaussian falloff. See [`Blinn`](crate::falloff::Blinn).
#[must_use]
pub fn blinn(hardness: impl Into<Number>, cutoff: impl Into<Number>, edge: Edge) -> FalloffRecipe {
    FalloffRecipe::new(FalloffKind::Blinn(0), vec![real(hardness), real(cutoff), word(edge)])
}

/// A falloff that is a step at half the radius. See [`ArcTan`](crate::falloff::ArcTan).
#[must_use]
pub fn arctan(stiffness: impl Into<Number>, edge: Edge) -> FalloffRecipe {
    FalloffRecipe::new(FalloffKind::ArcTan(0), vec![real(stiffness), word(edge)])
}

/// A falloff like that of a charge's potential. See [`InversePower`](crate::falloff::InversePower).
#[must_use]
pub fn inverse_power(exponent: impl Into<Number>, cutoff: impl Into<Number>, edge: Edge) -> FalloffRecipe {
    FalloffRecipe::new(FalloffKind::InversePower(0), vec![real(exponent), real(cutoff), word(edge)])
}

/// Blanc and Schlick's falloff. See [`Blanc`](crate::falloff::Blanc).
#[must_use]
pub fn blanc(hardness: impl Into<Number>) -> FalloffRecipe {
    FalloffRecipe::new(FalloffKind::Blanc(0), vec![real(hardness)])
}

fn word(edge: Edge) -> FieldNumber {
    edge.to_field().into()
}
