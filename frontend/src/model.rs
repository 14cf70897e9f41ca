//! A model: a tree, and what its field means.

use crate::attribute::AttributeGroup;
use crate::number::Number;
use crate::parameter::{Parameter, collect};
use crate::tree::Tree;

/// A tree with the iso-value of its surface and its attribute groups. Inside means `field >= iso`.
#[derive(Clone, PartialEq, Debug)]
pub struct Model {
    /// The field value of the surface.
    pub iso: Number,
    /// The attribute groups; `color` is always the first.
    pub attributes: Vec<AttributeGroup>,
    /// The tree.
    pub root: Tree,
    /// The named parameters, in the order of their declarations. Those that the tree mentions and that are not here have the
    /// defaults of their first uses.
    pub parameters: Vec<Parameter>,
}

impl Model {
    /// The iso-value when nothing else is said.
    pub const DEFAULT_ISO: f64 = 0.5;

    /// A model with iso-value 1/2, the colour group alone, and the parameters that the tree mentions.
    #[must_use]
    pub fn new(root: Tree) -> Self {
        let iso = Number::from(Self::DEFAULT_ISO);
        let (parameters, _) = collect(&[], &iso, &root);
        Self { iso, attributes: vec![AttributeGroup::color()], root, parameters }
    }
}
