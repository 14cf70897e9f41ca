//! Primitives: a skeleton in a falloff.

use super::Number;
use crate::falloff::Falloff;
use crate::skeleton::{Skeleton, SkeletonKind};
use crate::tree::Tree;
use crate::written::{FieldNumber, Radius, Written, as_written};

/// A primitive of strength 1 with the soft object's falloff; `radius` is where its field reaches zero.
#[must_use]
pub fn primitive(skeleton: impl Into<Skeleton>, radius: impl Into<Number>) -> Tree {
    let skeleton = skeleton.into();
    leaf(skeleton.kind(), as_written(skeleton.to_fields()), radius)
}

/// A primitive whose skeleton's parameters may follow those of the model.
pub(super) fn leaf(skeleton: SkeletonKind, fields: Vec<FieldNumber>, radius: impl Into<Number>) -> Tree {
    let (falloff, radius) = (Falloff::Soft.into(), Radius::Support(radius.into()));
    let written = Written::Primitive { skeleton, fields, falloff, radius, strength: 1.0.into() };
    Tree::new(written, Vec::new())
}
