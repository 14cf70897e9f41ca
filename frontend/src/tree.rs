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
//! Cloning a [`Tree`] is cheap and shares it. Everything that walks a tree is iterative, dropping it included: a chain of a
//! million nodes is a tree like any other.

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use crate::attribute::AttributeValue;
use crate::combine::Combinator;
use crate::diagnostic::Span;
use crate::expression::Expression;
use crate::falloff::Falloff;
use crate::model::Model;
use crate::number::Number;
use crate::recipe::{Fault, Recipe};
use crate::skeleton::{Point, Skeleton};
use crate::traverse::Visit;
use crate::warp::Warp;

/// A leaf: a skeleton, and the field around it.
///
/// The field at squared distance `d^2` from the skeleton is `strength * falloff(d^2 / radius^2)`.
#[derive(Clone, PartialEq, Debug)]
pub struct Primitive {
    /// What the distance is measured to.
    pub skeleton: Skeleton,
    /// How the field fades.
    pub falloff: Falloff,
    /// The support radius: where the field reaches zero.
    pub radius: f64,
    /// The factor of the field; negative ones push surfaces away.
    pub strength: f64,
}

/// What a node does.
#[derive(Clone, PartialEq, Debug)]
pub enum NodeKind {
    /// A leaf.
    Primitive(Primitive),
    /// Fields of the children become one field.
    Combine(Combinator),
    /// The field is a formula of the coordinates and of the children's fields: a leaf, if it has no children.
    Expression(Expression),
    /// One child answers, the others do not count: that whose place, from 0, is nearest to this number.
    Select(f64),
    /// The child stands elsewhere: the map takes the child's space to the parent's.
    Affine(DAffine3),
    /// The child is deformed. A second child, if there is one, gives the weight of the deformation: see [`warp`](crate::warp).
    Warp(Warp),
    /// The leaves below have this attribute, unless another node of the same name stands nearer to them.
    Attribute {
        /// The attribute group.
        name: Arc<str>,
        /// What they have.
        value: AttributeValue,
    },
}

impl NodeKind {
    /// The skeleton whose uv the field of a leaf has: a formula has that of a point at the origin of its space.
    #[must_use]
    pub(crate) fn uv_skeleton(&self) -> &Skeleton {
        static ORIGIN: Skeleton = Skeleton::Point(Point { at: DVec3::ZERO });
        match self {
            Self::Primitive(primitive) => &primitive.skeleton,
            Self::Combine(_)
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Affine(_)
            | Self::Warp(_)
            | Self::Attribute { .. } => &ORIGIN,
        }
    }

    /// The rows of an affine map, the last column of which is the shift; `None` for any other node.
    #[must_use]
    pub fn rows(&self) -> Option<[[f64; 4]; 3]> {
        match self {
            Self::Affine(map) => {
                let columns = map.to_cols_array_2d();
                Some([0, 1, 2].map(|row| columns.map(|column| column[row])))
            }
            Self::Primitive(_)
            | Self::Combine(_)
            | Self::Expression(_)
            | Self::Select(_)
            | Self::Warp(_)
            | Self::Attribute { .. } => None,
        }
    }

    /// The children that answer: of a selector the chosen one, of any other node all. Panics, if a selector's number is near no child:
    /// the check has excluded it.
    #[must_use]
    pub fn asked<'a, T>(&self, children: &'a [T]) -> &'a [T] {
        match self {
            Self::Select(which) => std::slice::from_ref(&children[chosen(*which)]),
            Self::Primitive(_)
            | Self::Combine(_)
            | Self::Expression(_)
            | Self::Affine(_)
            | Self::Warp(_)
            | Self::Attribute { .. } => children,
        }
    }
}

/// The place of the child that a selector's number stands for: the nearest whole number. The number has been checked.
pub(crate) fn chosen(which: f64) -> usize {
    which.round() as usize
}

/// A node and its children.
pub struct Node {
    kind: NodeKind,
    /// What the kind was made of, if a number in it follows a parameter.
    recipe: Option<Arc<Recipe>>,
    children: Vec<Tree>,
    span: Option<Span>,
    /// Whether this node or one below has a recipe.
    follows: bool,
}

impl Node {
    /// What it does.
    #[must_use]
    pub fn kind(&self) -> &NodeKind {
        &self.kind
    }

    /// The node before its formulas were evaluated, if one of its numbers follows a parameter.
    #[must_use]
    pub fn recipe(&self) -> Option<&Arc<Recipe>> {
        self.recipe.as_ref()
    }

    /// Whether a number of this node, or of one below, follows a parameter.
    #[must_use]
    pub fn follows(&self) -> bool {
        self.follows
    }

    /// Its children, in order.
    #[must_use]
    pub fn children(&self) -> &[Tree] {
        &self.children
    }

    /// Where it stands in its source text.
    #[must_use]
    pub fn span(&self) -> Option<Span> {
        self.span
    }
}

/// A shared, immutable tree. See the module.
#[derive(Clone)]
pub struct Tree(Arc<Node>);

impl Tree {
    /// A node over children. Anything can be built; [`Model::check`](crate::check) says whether it makes sense.
    #[must_use]
    pub fn new(kind: NodeKind, children: Vec<Self>) -> Self {
        Self::assemble(kind, None, children, None)
    }

    /// A node whose numbers may follow parameters. Until the check, which knows better, a surface radius is that of the usual
    /// iso-value.
    #[must_use]
    pub fn of(recipe: Recipe, children: Vec<Self>) -> Self {
        let iso = Number::from(Model::DEFAULT_ISO);
        let (kind, asks_iso) = (recipe.kind(iso.value()), recipe.asks_iso());
        // What it cannot be now, it may be for other values; the check says what is wrong.
        let broken = || NodeKind::Affine(DAffine3::from_translation(DVec3::NAN));
        let kept = (kind.is_err() || asks_iso || recipe.follows(&iso)).then(|| Arc::new(recipe));
        Self::assemble(kind.unwrap_or_else(|_| broken()), kept, children, None)
    }

    /// The node of a recipe, which is kept if a number in it follows a parameter.
    pub(crate) fn cook(
        recipe: Recipe,
        iso: &Number,
        children: Vec<Self>,
        span: Option<Span>,
    ) -> Result<Self, Fault> {
        let kind = recipe.kind(iso.value())?;
        let kept = recipe.follows(iso).then(|| Arc::new(recipe));
        Ok(Self::assemble(kind, kept, children, span))
    }

    /// A node of all its parts.
    pub(crate) fn assemble(
        kind: NodeKind,
        recipe: Option<Arc<Recipe>>,
        children: Vec<Self>,
        span: Option<Span>,
    ) -> Self {
        let follows = recipe.is_some() || children.iter().any(|child| child.0.follows);
        Self(Arc::new(Node { kind, recipe, children, span, follows }))
    }

    /// A node that stands at a place in a text.
    #[must_use]
    pub fn at(span: Span, kind: NodeKind, children: Vec<Self>) -> Self {
        Self::assemble(kind, None, children, Some(span))
    }

    /// Adds a last child to the root. Trees that share the root keep it as it was.
    pub(crate) fn push(&mut self, child: Self) {
        if let Some(node) = Arc::get_mut(&mut self.0) {
            node.follows |= child.0.follows;
            node.children.push(child);
            return;
        }
        let Node { kind, recipe, children, span, .. } = &*self.0;
        let children = children.iter().cloned().chain([child]).collect();
        *self = Self::assemble(kind.clone(), recipe.clone(), children, *span);
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
}

impl Drop for Node {
    /// Takes a tree apart without recursion: whatever only this node holds is moved to a list and emptied there.
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
        write!(f, "{:?} of {} children", self.kind, self.children.len())
    }
}

impl fmt::Debug for Tree {
    /// Every node once, numbered, children first: a list and not a nest, so that depth and sharing do no harm.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut numbers = HashMap::new();
        let mut map = f.debug_map();
        for (number, tree) in self.postfix(Visit::Nodes).enumerate() {
            let children: Vec<usize> =
                tree.0.children.iter().map(|child| numbers[&child.identity()]).collect();
            numbers.insert(tree.identity(), number);
            map.entry(&number, &(&tree.0.kind, children));
        }
        map.finish()
    }
}

impl PartialEq for Tree {
    /// The same nodes with the same numbers in the same order; places in texts do not matter. Shared pairs are compared once.
    fn eq(&self, other: &Self) -> bool {
        let mut seen = std::collections::HashSet::new();
        let mut pairs = vec![(self, other)];
        while let Some((a, b)) = pairs.pop() {
            if a.identity() == b.identity() || !seen.insert((a.identity(), b.identity())) {
                continue;
            }
            let (a, b) = (a.node(), b.node());
            let same = match (&a.recipe, &b.recipe) {
                // Values are those of parameters that somebody else compares.
                (Some(a), Some(b)) => a == b,
                (None, None) => a.kind == b.kind,
                (Some(_), None) | (None, Some(_)) => false,
            };
            if !same || a.children.len() != b.children.len() {
                return false;
            }
            pairs.extend(a.children.iter().zip(&b.children));
        }
        true
    }
}
