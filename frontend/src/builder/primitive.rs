//! Primitives: a skeleton in a falloff.

use super::Number;
use crate::falloff::Falloff;
use crate::recipe::{FieldNumber, Radius, Recipe};
use crate::skeleton::{Skeleton, SkeletonKind};
use crate::tree::{NodeKind, Primitive, Tree};

/// A primitive of strength 1 with the soft object's falloff; `radius` is where its field reaches zero.
#[must_use]
pub fn primitive(skeleton: impl Into<Skeleton>, radius: impl Into<Number>) -> Tree {
    let (skeleton, radius) = (skeleton.into(), radius.into());
    if radius.follows() {
        let fields = skeleton.to_fields().into_iter().map(FieldNumber::from).collect();
        return leaf(skeleton.kind(), fields, radius);
    }
    let leaf = Primitive { skeleton, falloff: Falloff::Soft, radius: radius.value(), strength: 1.0 };
    Tree::new(NodeKind::Primitive(leaf), Vec::new())
}

/// A primitive whose skeleton's parameters may follow those of the model.
pub(super) fn leaf(skeleton: SkeletonKind, fields: Vec<FieldNumber>, radius: impl Into<Number>) -> Tree {
    let (falloff, radius) = (Falloff::Soft.into(), Radius::Support(radius.into()));
    let recipe = Recipe::Primitive { skeleton, fields, falloff, radius, strength: 1.0.into() };
    Tree::of(recipe, Vec::new())
}
