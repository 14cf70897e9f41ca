//! A model: a tree, and what its field means.

use crate::attribute::AttributeGroup;
use crate::tree::Tree;

/// A tree with the iso-value of its surface and its attribute groups. Inside means `field >= iso`.
#[derive(Clone, PartialEq, Debug)]
pub struct Model {
    /// The field value of the surface.
    pub iso: f64,
    /// The attribute groups; `color` is always the first.
    pub attributes: Vec<AttributeGroup>,
    /// The tree.
    pub root: Tree,
}

impl Model {
    /// The iso-value when nothing else is said.
    pub const DEFAULT_ISO: f64 = 0.5;

    /// A model with iso-value 1/2 and the colour group alone.
    #[must_use]
    pub fn new(root: Tree) -> Self {
        Self { iso: Self::DEFAULT_ISO, attributes: vec![AttributeGroup::color()], root }
    }
}
