//! Primitives: a skeleton in a falloff.

use super::Number;
use crate::falloff::Falloff;
use crate::skeleton::{Skeleton, SkeletonKind};
use crate::tree::Tree;
use crate::written::{FieldNumber, Radius, Written, as_written};

/// The radius at which a primitive alone meets the iso-value of its model, in place of its radius of support.
///
/// ```
/// use jbt_model::builder::{sphere, surface};
/// use jbt_model::{model::Model, walk::walk};
/// let ball = Model::new(sphere([0; 3], 2, surface(0.5))).check()?;
/// assert_eq!(walk(&ball, [2.5, 0.0, 0.0]).field, 0.5);
/// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
/// ```
#[must_use]
pub fn surface(radius: impl Into<Number>) -> Radius {
    Radius::Surface(radius.into())
}

/// A primitive of strength 1 with the soft object's falloff; `radius` is where its field reaches zero.
#[must_use]
pub fn primitive(skeleton: impl Into<Skeleton>, radius: impl Into<Radius>) -> Tree {
    let skeleton = skeleton.into();
    leaf(skeleton.kind(), as_written(skeleton.to_fields()), radius)
}

/// A primitive whose skeleton's parameters may follow those of the model.
pub(super) fn leaf(skeleton: SkeletonKind, fields: Vec<FieldNumber>, radius: impl Into<Radius>) -> Tree {
    let (falloff, radius) = (Falloff::Soft.into(), radius.into());
    let written = Written::Primitive { skeleton, fields, falloff, radius, strength: 1.0.into() };
    Tree::new(written, Vec::new())
}
