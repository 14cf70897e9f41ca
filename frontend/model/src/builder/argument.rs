//! Arguments of the functions that build nodes, as parameters of members.

use crate::number::{Number, Vector};
use crate::written::FieldNumber;

pub(super) fn vector(value: impl Into<Vector>) -> FieldNumber {
    FieldNumber::Vector(value.into().0)
}

pub(super) fn vectors(points: impl IntoIterator<Item = impl Into<Vector>>) -> FieldNumber {
    FieldNumber::Vectors(points.into_iter().map(|point| point.into().0).collect())
}

pub(super) fn real(value: impl Into<Number>) -> FieldNumber {
    FieldNumber::Real(value.into())
}
