//! Styles: attributes and constants that have a name together.
//!
//! ```text
//! style oak = { color (0.4 0.2 0.1) rough 0.7 }
//! style oak { box }                  =        color (0.4 0.2 0.1), a style `oak` of 2
//!                                             └─ rough 0.7
//!                                                └─ box
//! ```
//!
//! A tree has the nodes that a style stands for. The first of them says what the style is called and how many
//! nodes it has, so that a text is printed with the style again.

use std::sync::Arc;

use super::Tree;
use crate::attribute::Precedence;
use crate::label::{NodeLabel, NodeStyle};
use crate::written::Written;

/// A use of a style: what it gives, and to what.
#[derive(Clone, Debug)]
pub struct StyleUse<'a> {
    /// What the style is called.
    pub name: &'a str,
    /// Whether all of it overrides what stands below.
    pub precedence: Precedence,
    /// Its attributes and constants, the outermost first.
    pub values: Vec<&'a Written>,
    /// What has them.
    pub below: &'a Tree,
}

impl StyleUse<'_> {
    /// The attributes and constants as the style has them: without the override of this use.
    #[must_use]
    pub fn definition(&self) -> Vec<Written> {
        let plain = |written: &&Written| match self.precedence {
            Precedence::Nearest => Written::clone(written),
            Precedence::Override => Written::clone(written).with_precedence(Precedence::Nearest),
        };
        self.values.iter().map(plain).collect()
    }

    /// Whether it is a use of the style that has these attributes and constants.
    #[must_use]
    pub fn is_of(&self, definition: &[Written]) -> bool {
        let is_one = |(value, defined): (&&Written, &Written)| match self.precedence {
            Precedence::Nearest => *value == defined,
            Precedence::Override => **value == defined.clone().with_precedence(Precedence::Override),
        };
        self.values.len() == definition.len() && self.values.iter().zip(definition).all(is_one)
    }
}

impl Tree {
    /// The tree with attributes and constants that have a name together, as a text has them by `style`. The
    /// model means what it would mean without the name.
    ///
    /// ```
    /// use jbt_model::{builder::point, model::Model, tree::Tree};
    /// let oak = |wood: &Tree| wood.styled("oak", |tree| tree.constant("material", "oak").color([0.5, 0.3, 0.1]));
    /// let bowl = oak(&point([0; 3], 1)) | oak(&point([2, 0, 0], 1));
    /// let text = jbt_text::print(&Model::new(bowl));
    /// assert!(text.contains("style oak = { color (0.5 0.3 0.1) constant material \"oak\" }"), "{text}");
    /// assert_eq!(text.matches("style oak { point").count(), 2);
    /// ```
    ///
    /// # Panics
    /// If `style` gives anything else than the tree with attributes and constants around it.
    #[must_use]
    pub fn styled(&self, name: &str, style: impl FnOnce(Self) -> Self) -> Self {
        style(self.clone())
            .with_style(name, self)
            .expect("a style puts attributes and constants around a tree, and nothing else")
    }

    /// The same tree, whose attributes and constants down to `below` are a style; `None` if there are none,
    /// or anything else is there.
    #[must_use]
    pub fn with_style(self, name: &str, below: &Self) -> Option<Self> {
        let mut count = 0;
        let mut next = &self;
        while next.identity() != below.identity() {
            next = next.wearer()?;
            count += 1;
        }
        let name = crate::word::normalized(name).into();
        let style = NodeStyle { name, count, precedence: Precedence::Nearest };
        (count > 0).then(|| self.with_style_label(style))
    }

    fn with_style_label(self, style: NodeStyle) -> Self {
        let label = self.node().label().map(|label| NodeLabel::clone(label)).unwrap_or_default();
        self.labelled(Some(Arc::new(NodeLabel { style: Some(style), ..label })))
    }

    /// What an attribute node or a constant is put around.
    fn wearer(&self) -> Option<&Self> {
        let is_given = matches!(self.node().written(), Written::Attribute { .. } | Written::Constant { .. });
        self.node().children().first().filter(|_| is_given && self.node().children().len() == 1)
    }

    /// The style that the tree begins with, if its nodes are still there.
    #[must_use]
    pub fn style(&self) -> Option<StyleUse<'_>> {
        let NodeStyle { name, count, precedence } = self.node().label()?.style.as_ref()?;
        let mut values = Vec::new();
        let mut below = self;
        while values.len() < *count {
            if !values.is_empty() && below.node().name().is_some() {
                return None;
            }
            values.push(below.node().written());
            below = below.wearer()?;
        }
        Some(StyleUse { name, precedence: *precedence, values, below })
    }

    /// The same, but what the tree begins with, an attribute, a constant or a style, counts for all leaves
    /// below, whatever stands nearer to them. Of several that override, the one nearest to the root counts.
    ///
    /// ```
    /// use jbt_model::builder::point;
    /// use jbt_model::{model::Model, tree::Tree, walk::walk};
    /// let red = point([0; 3], 1).color([1, 0, 0]);
    /// let of = |tree: Tree| walk(&Model::new(tree).check().unwrap(), [0.0; 3]).attributes.concat();
    /// assert_eq!(of(red.color([0, 0, 1])), [1.0, 0.0, 0.0]);
    /// assert_eq!(of(red.color([0, 0, 1]).overriding()), [0.0, 0.0, 1.0]);
    /// ```
    ///
    /// # Panics
    /// If the tree begins with anything else.
    #[must_use]
    pub fn overriding(&self) -> Self {
        self.try_overriding().expect("an attribute, a constant or a style can override, and nothing else")
    }

    /// [`overriding`](Self::overriding); `None` if the tree begins with anything else.
    #[must_use]
    pub fn try_overriding(&self) -> Option<Self> {
        let over = |written: &Written| written.clone().with_precedence(Precedence::Override);
        let Some(StyleUse { values, below, .. }) = self.style() else {
            self.wearer()?;
            return Some(self.with_written(over(self.node().written())));
        };
        let mut nodes: Vec<&Self> = Vec::new();
        let mut next = self;
        for _ in &values {
            nodes.push(next);
            next = &next.node().children()[0];
        }
        let put = |tree: Self, node: &&Self| {
            node.with_written(over(node.node().written())).with_children(vec![tree])
        };
        let made = nodes.iter().rev().fold(below.clone(), put);
        let style = made.node().label().and_then(|label| label.style.clone())?;
        Some(made.with_style_label(NodeStyle { precedence: Precedence::Override, ..style }))
    }
}
