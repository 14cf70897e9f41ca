//! The BlobTree: an immutable directed acyclic graph with shared subtrees.
//!
//! ```text
//!            union                      leaves: a skeleton in a falloff
//!           /     \                     combinators: fields of the children become one field
//!      color        difference          affine, warp, attribute: change the question on its way down,
//!        |           /      \           or the answer on its way up; they have one child
//!      point      rotate    box
//!                    \      /
//!                     (shared)
//! ```
//!
//! Cloning a [`Tree`] is cheap and shares it. Everything that walks a tree is iterative, dropping it
//! included: a chain of a million nodes is a tree like any other.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use crate::diagnostic::Span;
use crate::label::NodeLabel;
use crate::traverse::Visit;
use crate::word::normalized;
use crate::written::Written;

pub(crate) mod order;
mod part;
mod share;
mod style;

pub use style::StyleUse;

/// The iso-value of a model when nothing else is said.
pub(crate) const DEFAULT_ISO: f64 = 0.5;

/// A node and its children.
pub struct Node {
    written: Written,
    children: Vec<Tree>,
    span: Option<Span>,
    /// Its name, and the calls around it.
    label: Option<Arc<NodeLabel>>,
    /// Whether a number of this node, or of one below, depends on a parameter.
    depends: bool,
    /// How many nodes the tree has at most: shared ones are counted with every use.
    unfolded: u32,
}

impl Node {
    /// What it was written as.
    #[must_use]
    pub fn written(&self) -> &Written {
        &self.written
    }

    /// What its text says about it besides what it means.
    #[must_use]
    pub fn label(&self) -> Option<&Arc<NodeLabel>> {
        self.label.as_ref()
    }

    /// Its name: that of its `let`, or the one that [`Tree::named`] has given it.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.label.as_ref()?.name.as_deref()
    }

    /// Whether a number of this node, or of one below, depends on a parameter.
    #[must_use]
    pub fn depends_on_parameters(&self) -> bool {
        self.depends
    }

    /// How many nodes the tree has at most.
    pub(crate) fn unfolded(&self) -> usize {
        self.unfolded as usize
    }

    /// Its children, in order.
    #[must_use]
    pub fn children(&self) -> &[Tree] {
        &self.children
    }

    /// Where it stands in its source text: a primitive from its name to `}`, a node with children its words
    /// before the block. Errors of the check about any of its numbers have this place.
    #[must_use]
    pub fn span(&self) -> Option<Span> {
        self.span
    }
}

/// A shared, immutable tree. See the module.
#[derive(Clone)]
pub struct Tree(Arc<Node>);

impl Tree {
    /// A node over children. Anything can be built; [`Model::check`](crate::check) says whether it makes
    /// sense.
    #[must_use]
    pub fn new(written: impl Into<Written>, children: Vec<Self>) -> Self {
        Self::assemble(written.into(), children, None)
    }

    /// A node that stands at a place in a text.
    #[must_use]
    pub fn at(span: Span, written: impl Into<Written>, children: Vec<Self>) -> Self {
        Self::assemble(written.into(), children, Some(span))
    }

    /// A node of all its parts.
    pub(crate) fn assemble(written: Written, children: Vec<Self>, span: Option<Span>) -> Self {
        jbt_ir::watch::take(size_of::<Node>() + size_of_val(&*children));
        let depends =
            written.dependent_numbers().next().is_some() || children.iter().any(|child| child.0.depends);
        let unfolded = children.iter().fold(1, |all: u32, child| all.saturating_add(child.0.unfolded));
        Self(Arc::new(Node { written, children, span, label: None, depends, unfolded }))
    }

    /// The same node with a name, by which messages, paths and exported files know it: letters, digits and
    /// underscores, beginning with a letter. Other parts of a model may have the same name.
    ///
    /// ```
    /// use jbt_model::builder::point;
    /// let hub = point([0; 3], 1).named("hub");
    /// assert_eq!(hub.node().name(), Some("hub"));
    /// ```
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        let label = self.node().label().map(|label| NodeLabel::clone(label)).unwrap_or_default();
        let name = Some(normalized(name).into());
        self.labelled(Some(Arc::new(NodeLabel { name, ..label })))
    }

    /// The same node with another label.
    #[must_use]
    pub fn labelled(mut self, label: Option<Arc<NodeLabel>>) -> Self {
        if let Some(node) = Arc::get_mut(&mut self.0) {
            node.label = label;
            return self;
        }
        let Node { written, children, span, .. } = &*self.0;
        Self::assemble(written.clone(), children.clone(), *span).labelled(label)
    }

    /// The same tree as a part of what stands at a place: its nodes without a place of their own have that
    /// one, down to those that have one, or that other trees share.
    #[must_use]
    pub fn located(mut self, span: Span) -> Self {
        let mut stack = vec![&mut self];
        while let Some(tree) = stack.pop() {
            if let Some(node) = Arc::get_mut(&mut tree.0).filter(|node| node.span.is_none()) {
                node.span = Some(span);
                stack.extend(&mut node.children);
            }
        }
        self
    }

    /// Adds a last child to the root. Trees that share the root keep it as it was.
    pub(crate) fn push(&mut self, child: Self) {
        if let Some(node) = Arc::get_mut(&mut self.0) {
            node.depends |= child.0.depends;
            node.unfolded = node.unfolded.saturating_add(child.0.unfolded);
            node.children.push(child);
            return;
        }
        let Node { written, children, span, label, .. } = &*self.0;
        let children = children.iter().cloned().chain([child]).collect();
        *self = Self::assemble(written.clone(), children, *span).labelled(label.clone());
    }

    /// The root node.
    #[must_use]
    pub fn node(&self) -> &Node {
        &self.0
    }

    /// An identity for maps: equal for clones of one tree, as long as one of them lives.
    #[must_use]
    pub fn identity(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }

    /// Whether anything else may hold the same node: another parent, or a clone.
    pub(crate) fn is_shared(&self) -> bool {
        Arc::strong_count(&self.0) > 1
    }
}

impl Drop for Node {
    /// Takes a tree apart without recursion: whatever only this node holds is moved to a list and emptied
    /// there.
    fn drop(&mut self) {
        let mut list: Vec<Tree> = std::mem::take(&mut self.children);
        while let Some(tree) = list.pop() {
            if let Some(mut node) = Arc::into_inner(tree.0) {
                list.append(&mut node.children);
            }
        }
    }
}

impl fmt::Debug for Node {
    /// The node alone: its children by number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of {} children", self.written, self.children.len())
    }
}

impl fmt::Debug for Tree {
    /// Every node once, numbered, children first: a list and not a nest, so that depth and sharing do no
    /// harm.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut numbers = HashMap::new();
        let mut map = f.debug_map();
        for (number, tree) in self.postfix(Visit::Nodes).enumerate() {
            let children: Vec<usize> =
                tree.0.children.iter().map(|child| numbers[&child.identity()]).collect();
            numbers.insert(tree.identity(), number);
            map.entry(&number, &(&tree.0.written, children));
        }
        map.finish()
    }
}

impl PartialEq for Tree {
    /// The same nodes with the same numbers in the same order; places in texts do not matter. Shared pairs
    /// are compared once.
    fn eq(&self, other: &Self) -> bool {
        let mut seen = std::collections::HashSet::new();
        let mut pairs = vec![(self, other)];
        while let Some((a, b)) = pairs.pop() {
            if a.identity() == b.identity() || !seen.insert((a.identity(), b.identity())) {
                continue;
            }
            let (a, b) = (a.node(), b.node());
            if a.written != b.written || a.children.len() != b.children.len() {
                return false;
            }
            pairs.extend(a.children.iter().zip(&b.children));
        }
        true
    }
}
