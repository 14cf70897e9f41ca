//! What the formula of a field may be about, besides numbers.

use std::collections::HashMap;

use jbt_model::number::Variable;
use jbt_model::tree::Tree;
use jbt_model::word::{COORDINATES, FIELD};

/// What a formula may be about besides numbers.
#[derive(Default)]
pub(super) struct FormulaScope<'a> {
    /// Whether it may ask for no fields.
    pub(super) fieldless: bool,
    /// The place of each definition.
    pub(super) definitions: HashMap<&'a str, u32>,
    /// The subtrees whose fields it asks for, each once, and the place of each by its identity.
    pub(super) children: Vec<Tree>,
    pub(super) places: HashMap<usize, u32>,
    /// It is about a point, which follows from no field.
    pub(super) pointwise: bool,
}

impl FormulaScope<'_> {
    /// The words that stand for something.
    pub(super) fn words(&self) -> impl Iterator<Item = &str> {
        let field = (!self.fieldless).then_some(FIELD);
        COORDINATES.into_iter().chain(field).chain(self.definitions.keys().copied())
    }

    pub(super) fn child(&mut self, tree: Tree) -> Variable {
        let next = self.children.len() as u32;
        let place = *self.places.entry(tree.identity()).or_insert(next);
        if place == next {
            self.children.push(tree);
        }
        Variable::Child(place)
    }
}
