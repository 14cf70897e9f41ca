//! Random models: a shape from one seed, its numbers from another, so that one shape can be tried with many
//! sets of numbers.
//!
//! ```text
//! Settings ─► Random ── model ──► a tree, top down        mod.rs
//!                        ├ leaf, warp, map, attribute     members.rs: from the lists of members
//!                        ├ combinator                     combinators.rs
//!                        ├ formulas                       formulas.rs
//!                        └ what a parameter may be        numbers.rs: ordinary or hostile
//! ```
//!
//! A new skeleton, falloff, warp, map or texture is in random models by its line in the list of its family.

mod combinators;
mod formulas;
mod members;
mod numbers;

use fastrand::Rng;
use jbt_model::attribute::{AttributeGroup, GroupKind, Mixing};
use jbt_model::model::Model;
use jbt_model::number::{Number, param};
use jbt_model::tree::Tree;

pub use numbers::vector;

/// What numbers are like.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Numbers {
    /// Positions and lengths of about 1. The check accepts models of them.
    Ordinary,
    /// Any finite number, often a simple one: zeros of both signs, subnormals, the largest ones, any bits.
    Hostile,
}

/// What random models are made of.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Settings {
    /// Ordinary numbers make good models. Hostile ones often make models that the check refuses, and that can
    /// be written and read all the same.
    pub numbers: Numbers,
    /// How many operators may stand above each other.
    pub depth: usize,
    /// Whether some leaves have a negative strength.
    pub negative: bool,
    /// Whether fields jump at the sides of boxes, as those of `within` do.
    pub walls: bool,
    /// Whether selectors choose some of the subtrees.
    pub selectors: bool,
    /// Whether some numbers depend on parameters, each its own.
    pub parameters: bool,
}

impl Default for Settings {
    /// Everything, with ordinary numbers.
    fn default() -> Self {
        Self {
            numbers: Numbers::Ordinary,
            depth: 7,
            negative: true,
            walls: true,
            selectors: true,
            parameters: true,
        }
    }
}

/// The generator of models, and of their parts.
#[derive(Clone, Debug)]
pub struct Random {
    settings: Settings,
    /// What selects code comes from here.
    shape: Rng,
    /// Everything else comes from here.
    numbers: Rng,
    /// Trees that may be used once more.
    done: Vec<Tree>,
    /// How many parameters there are.
    parameters: usize,
}

impl Random {
    /// The generator of a shape and a set of numbers, with the default settings.
    #[must_use]
    pub fn new(shape: u64, numbers: u64) -> Self {
        Self::with_settings(shape, numbers, Settings::default())
    }

    /// The generator of a shape and a set of numbers.
    #[must_use]
    pub fn with_settings(shape: u64, numbers: u64, settings: Settings) -> Self {
        Self {
            settings,
            shape: Rng::with_seed(shape),
            numbers: Rng::with_seed(numbers),
            done: Vec::new(),
            parameters: 0,
        }
    }

    /// A model of about `leaves` leaves, with colours and some other groups.
    pub fn model(&mut self, leaves: usize) -> Model {
        self.done.clear();
        self.parameters = 0;
        let attributes = self.groups();
        let root = self.tree(leaves, &attributes, 0);
        Model { iso: self.between(0.3, 0.6).into(), attributes, ..Model::new(root) }
    }

    /// The colours and up to two other groups, of directions some; hostile ones are up to 64 wide.
    fn groups(&mut self) -> Vec<AttributeGroup> {
        let mut groups = vec![AttributeGroup::color()];
        for index in 0..self.shape.usize(0..3) {
            let widest = if self.is_hostile() { 64 } else { 7 };
            let pick = self.shape.usize(0..6);
            let width = [1, 2, 2, 3, 4, widest][pick];
            groups.push(AttributeGroup {
                // Some names are words of the text format too.
                name: ["rough", "scale"][index].into(),
                default: (0..width).map(|_| self.between(-1.0, 1.0)).collect(),
                mixing: if self.shape.bool() { Mixing::Blend } else { Mixing::Dominant },
                kind: if pick == 3 { GroupKind::Direction } else { GroupKind::Numbers },
                ..AttributeGroup::color()
            });
        }
        if self.is_hostile() && self.shape.bool() {
            groups[0].default = vec![0.5, -0.0, 1.0];
            groups[0].mixing = Mixing::Dominant;
        }
        groups
    }

    fn tree(&mut self, leaves: usize, attributes: &[AttributeGroup], depth: usize) -> Tree {
        if !self.done.is_empty() && self.shape.u8(0..10) == 0 {
            let again = self.done[self.shape.usize(0..self.done.len())].clone();
            return self.unary(again, attributes);
        }
        let tree = if leaves <= 1 || depth >= self.settings.depth {
            self.leaf()
        } else {
            let parts = self.shape.usize(1..leaves.min(5) + 1);
            let children: Vec<Tree> =
                (0..parts).map(|_| self.tree(leaves / parts, attributes, depth + 1)).collect();
            self.operator(children)
        };
        let tree = self.unary(tree, attributes);
        self.done.push(tree.clone());
        tree
    }

    /// The tree under up to two unary nodes.
    fn unary(&mut self, mut tree: Tree, attributes: &[AttributeGroup]) -> Tree {
        for _ in 0..self.shape.usize(0..3) {
            tree = match self.shape.u8(0..11) {
                0..3 => {
                    let group = &attributes[self.shape.usize(0..attributes.len())];
                    self.attributed(&tree, group)
                }
                3 => self.warped(tree),
                4 if self.settings.parameters => self.following(&tree),
                10 => Tree::new(self.field_map(), vec![tree]),
                _ => Tree::new(self.map(), vec![tree]),
            };
        }
        tree
    }

    /// A number that depends on a parameter of its own, or none if there are no parameters.
    fn parameter(&mut self, kind: &str, value: f64) -> Number {
        if !self.settings.parameters {
            return value.into();
        }
        self.parameters += 1;
        param(&format!("{kind}{}", self.parameters), value)
    }

    /// The tree under a map that depends on a parameter of its own: its code serves all values.
    fn following(&mut self, tree: &Tree) -> Tree {
        // Times 90 it is still finite.
        let value = self.between(-1.0, 1.0).clamp(-1e300, 1e300);
        let depends = self.parameter("map", value);
        match self.shape.u8(0..3) {
            0 => tree.translate((depends, 0.0, self.between(-0.5, 0.5))),
            1 => tree.scale(1.0 + 0.4 * depends),
            _ => tree.rotate([0.3, 0.5, 1.0], 90.0 * depends),
        }
    }
}

#[cfg(test)]
mod tests;
