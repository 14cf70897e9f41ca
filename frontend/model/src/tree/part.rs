//! Parts: several solids in one model.
//!
//! ```text
//! part "hub" { .. }              union
//! part "rim" { .. }      =       ├─ hub, a part: union { .. }
//!                                └─ rim, a part: union { .. }
//! ```
//!
//! The field of the model is that of the union, so whoever asks for no parts sees one solid, whose attributes
//! are those of the part that decides. Each part is a tree, which can be asked by itself.

use super::Tree;
use crate::combine::{Combinator, Union};
use crate::diagnostic::Span;
use crate::expression::Formula;
use crate::label::NodeLabel;
use crate::written::Written;

impl Tree {
    /// The node whose field is 0 everywhere: nothing. A selector that chooses it turns its others off.
    ///
    /// ```
    /// use jbt_model::{builder::{param, point}, model::Model, tree::Tree};
    /// let lamp = Tree::select(param("on", 0.0), [Tree::empty(), point([0; 3], 1)]);
    /// assert!(Model::new(lamp.clone()).check()?.support().is_empty());
    /// let lit = Model::new(lamp).with_parameters(&[("on", 1.0)])?;
    /// assert!(!lit.check()?.support().is_empty());
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    #[must_use]
    pub fn empty() -> Self {
        Self::new(Written::Expression(Formula::zero()), Vec::new())
    }

    /// The tree as a part of a model: see [`of_parts`](Self::of_parts).
    #[must_use]
    pub fn part(&self, name: &str) -> Self {
        Self::part_of(name, vec![self.clone()], None)
    }

    /// Several trees as one part.
    #[must_use]
    pub fn part_of(name: &str, trees: Vec<Self>, span: Option<Span>) -> Self {
        let part = Self::assemble(Written::from(Combinator::from(Union {})), trees, span).named(name);
        let label = part.node().label().map(|label| NodeLabel::clone(label)).unwrap_or_default();
        part.labelled(Some(std::sync::Arc::new(NodeLabel { part: true, ..label })))
    }

    /// A model of several solids, each of which has a name: membership, volumes, meshes and overlaps can be
    /// asked of each.
    ///
    /// ```
    /// use jbt_model::{builder::point, model::Model, tree::Tree};
    /// let wheel = Tree::of_parts([("hub", point([0; 3], 1)), ("rim", point([3, 0, 0], 1))]);
    /// let tree = Model::new(wheel).check()?;
    /// let names: Vec<&str> = tree.parts().into_iter().map(|part| part.name).collect();
    /// assert_eq!(names, ["hub", "rim"]);
    /// # Ok::<(), jbt_model::diagnostic::Diagnostics>(())
    /// ```
    #[must_use]
    pub fn of_parts<'a>(parts: impl IntoIterator<Item = (&'a str, Self)>) -> Self {
        Self::new(Combinator::from(Union {}), parts.into_iter().map(|(name, tree)| tree.part(name)).collect())
    }

    /// The parts below this root; none if it is one solid.
    #[must_use]
    pub fn parts(&self) -> &[Self] {
        let children = self.node().children();
        let is_part = |tree: &Self| tree.node().label().is_some_and(|label| label.part);
        let is_union = *self.node().written() == Written::from(Combinator::from(Union {}));
        if is_union && children.iter().all(is_part) { children } else { &[] }
    }
}
