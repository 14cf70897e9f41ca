//! The check: the only door from a model to a program.
//!
//! ```text
//! Model ── the iso-value, the attribute groups ──┐
//!   └── root ── every node once, children first ─┴─► every error, or a CheckedTree
//! ```
//!
//! What holds of a [`CheckedTree`], so that nothing behind it has to ask again:
//!
//! * Every number is finite and at most [`limits::MAX_NUMBER`] in magnitude; radii are at least [`limits::MIN_LENGTH`], and each
//!   parameter is what its [`FieldKind`] says.
//! * Leaves have no children, maps and attributes have one, warps one or two, combinators and selectors at least one, and these choose one that is
//!   there. A Ricci exponent is in
//!   [1, [`limits::MAX_RICCI_EXPONENT`]], or the negative of such a number; other numbers of operators are what their files say.
//! * Every affine map can be undone, and the numbers of its inverse are finite in f32.
//! * The origin has finite coordinates.
//! * The first attribute group is `color` with three reals; names are unique; attribute nodes name a group and fit its width.
//! * There are at most [`limits::MAX_NODES`] nodes and [`limits::MAX_OCCURRENCES`] paths from the root to leaves,
//!   those to each piece of a skeleton counted.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use glam::{DAffine3, DMat3};
use jbt_ir::limits;

use crate::affine;
use crate::attribute::AttributeGroup;
use crate::bounds::Bounds;
use crate::combine::Form;
use crate::combine::extent::Extent;
use crate::diagnostic::{Diagnostic, Diagnostics, SourceText, Span};
use crate::expression::Expression;
use crate::falloff::Falloff;
use crate::field::{Field, FieldKind, FieldValue};
use crate::model::Model;
use crate::number::Values;
use crate::origin::ModelOrigin;
use crate::parameter::{Parameter, collect, refresh};
use crate::recipe::Recipe;
use crate::report::Report;
use crate::tree::{NodeKind, Primitive};
use crate::warp::Warp;

mod groups;
mod numbers;
mod parameters;

pub(crate) use groups::is_identifier;
use groups::{check_attribute, check_groups, widths};
use numbers::{
    check_choice, check_combinator, check_count, check_expression, check_formula, check_list, check_number,
    check_numbers, check_within, check_words,
};
use parameters::{Dependence, check_iso};
pub(crate) use parameters::{not_finite, unknown};

/// The name of a node of a checked tree: its place in [`CheckedTree::nodes`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub struct NodeId(pub u32);

/// A node of a checked tree.
#[derive(Clone, PartialEq, Debug)]
pub struct CheckedNode {
    /// What it does.
    pub kind: NodeKind,
    /// Its children, in order. They come before it in the arena.
    pub children: Vec<NodeId>,
    /// Where it stands in its source text.
    pub span: Option<Span>,
}

/// A model that makes sense, as an arena: children before parents, shared nodes once, the root last.
#[derive(Clone, Debug)]
pub struct CheckedTree {
    iso: f64,
    attributes: Vec<AttributeGroup>,
    nodes: Arc<[CheckedNode]>,
    parameters: Vec<Parameter>,
    dependence: Arc<Dependence>,
    origin: ModelOrigin,
    /// The text that places are in.
    source: Option<SourceText>,
}

impl PartialEq for CheckedTree {
    /// The same nodes, attributes and parameters; the text that they came from does not matter.
    fn eq(&self, other: &Self) -> bool {
        let Self { iso, attributes, nodes, parameters, dependence, origin, source: _ } = self;
        *iso == other.iso
            && *attributes == other.attributes
            && *nodes == other.nodes
            && *parameters == other.parameters
            && *dependence == other.dependence
            && *origin == other.origin
    }
}

impl CheckedTree {
    /// Messages about this tree, located in the text that it came from.
    #[must_use]
    pub fn diagnostics(&self, list: Vec<Diagnostic>) -> Diagnostics {
        Diagnostics::new(list, self.source.clone())
    }

    /// The field value of the surface.
    #[must_use]
    pub fn iso(&self) -> f64 {
        self.iso
    }

    /// The attribute groups, `color` first.
    #[must_use]
    pub fn attributes(&self) -> &[AttributeGroup] {
        &self.attributes
    }

    /// Where its local coordinates begin: programs, lattices, boxes and meshes of it are about them. The tree
    /// itself, its [support](Self::support) and the oracle are about the world.
    ///
    /// It is the one that the model sets, or else one that was found at the check; other values of parameters
    /// leave it.
    #[must_use]
    pub fn origin(&self) -> ModelOrigin {
        self.origin
    }

    /// The same tree with another origin, as that of a model of which it is an edit. Its coordinates are
    /// finite.
    #[must_use]
    pub fn with_origin(&self, origin: ModelOrigin) -> Self {
        Self { origin, ..self.clone() }
    }

    /// All nodes.
    #[must_use]
    pub fn nodes(&self) -> &[CheckedNode] {
        &self.nodes
    }

    /// A node.
    #[must_use]
    pub fn node(&self, id: NodeId) -> &CheckedNode {
        &self.nodes[id.0 as usize]
    }

    /// The root.
    #[must_use]
    pub fn root(&self) -> NodeId {
        NodeId(self.nodes.len() as u32 - 1)
    }

    /// How often each node is met from the root, along every path: 1 for the root, more below shared subtrees. In the order of
    /// [`nodes`](Self::nodes).
    #[must_use]
    pub fn uses(&self) -> Vec<u64> {
        paths(&self.nodes, |node| &node.children)
    }

    /// How often each node is asked from the root, along every path: as [`uses`](Self::uses), but through the chosen child of a
    /// selector alone.
    #[must_use]
    pub fn asked(&self) -> Vec<u64> {
        paths(&self.nodes, |node| node.kind.asked(&node.children))
    }

    /// Uses of leaves: paths from the root to a leaf, through the chosen child of a selector alone.
    #[must_use]
    pub fn leaf_uses(&self) -> u64 {
        let of = |(node, uses): (&CheckedNode, u64)| match node.kind {
            NodeKind::Primitive(_) => uses,
            NodeKind::Combine(_)
            | NodeKind::Expression(_)
            | NodeKind::Select(_)
            | NodeKind::Affine(_)
            | NodeKind::Warp(_)
            | NodeKind::Attribute { .. } => 0,
        };
        self.nodes.iter().zip(self.asked()).map(of).fold(0, u64::saturating_add)
    }

    /// A leaf under maps, the nearest first, each with the node of this tree that gives its weight, if it has one. They are those of a checked tree,
    /// or products of them, so they are not checked again. Its origin is that of the world.
    pub(crate) fn leaf_under(
        &self,
        leaf: Primitive,
        maps: impl IntoIterator<Item = (NodeKind, Option<NodeId>)>,
    ) -> Self {
        let mut nodes =
            vec![CheckedNode { kind: NodeKind::Primitive(leaf), children: Vec::new(), span: None }];
        for (kind, weight) in maps {
            let mut children = vec![NodeId(nodes.len() as u32 - 1)];
            children.extend(weight.map(|weight| self.copy_below(weight, &mut nodes)));
            nodes.push(CheckedNode { kind, children, span: None });
        }
        self.of_nodes(nodes)
    }

    /// A subtree as a tree of its own, with the iso-value of this one, no parameters, and an origin that is
    /// found for it.
    #[must_use]
    pub fn subtree(&self, root: NodeId) -> Self {
        let mut nodes = Vec::new();
        self.copy_below(root, &mut nodes);
        let tree = self.of_nodes(nodes);
        Self { origin: ModelOrigin::of(tree.support()), ..tree }
    }

    /// The tree in other coordinates, with the iso-value and the attributes of this one and no parameters: under one more affine node, whose
    /// map takes points of this tree's space to the new ones. It is given by rows, the last column is the
    /// shift; it can be undone. An origin that is not that of the world is mapped too.
    #[must_use]
    pub fn mapped(&self, rows: [[f64; 4]; 3]) -> Self {
        let column = |place: usize| rows.map(|row| row[place]);
        let columns: [[f64; 3]; 4] = std::array::from_fn(column);
        let mut nodes = self.nodes.to_vec();
        let map = DAffine3::from_cols_array_2d(&columns);
        nodes.push(CheckedNode { kind: NodeKind::Affine(map), children: vec![self.root()], span: None });
        let mapped = || ModelOrigin::new(map.transform_point3(self.origin.point().into()).to_array());
        let origin = if self.origin.is_world() { self.origin } else { mapped() };
        Self { origin, ..self.of_nodes(nodes) }
    }

    /// Copies a subtree behind other nodes; gives the place of its root.
    fn copy_below(&self, root: NodeId, nodes: &mut Vec<CheckedNode>) -> NodeId {
        let mut copies: BTreeMap<NodeId, NodeId> = BTreeMap::new();
        // Children come before their parents: whatever is below, from the last to the first.
        let mut below = std::collections::BTreeSet::from([root]);
        let mut order = Vec::new();
        while let Some(id) = below.pop_last() {
            below.extend(&self.node(id).children);
            order.push(id);
        }
        for id in order.into_iter().rev() {
            copies.insert(id, NodeId(nodes.len() as u32));
            let node = self.node(id);
            let children = node.children.iter().map(|child| copies[child]).collect();
            nodes.push(CheckedNode { children, ..node.clone() });
        }
        copies[&root]
    }

    fn of_nodes(&self, nodes: Vec<CheckedNode>) -> Self {
        Self {
            iso: self.iso,
            attributes: self.attributes.clone(),
            nodes: nodes.into(),
            parameters: Vec::new(),
            dependence: Arc::default(),
            origin: ModelOrigin::WORLD,
            source: self.source.clone(),
        }
    }
}

impl Model {
    /// The model as a tree that makes sense, or everything that is wrong with it.
    ///
    /// Cost: linear in the number of nodes, shared ones counted once.
    ///
    /// # Errors
    ///
    /// All errors, in the order of their places in the text; after [`limits::MAX_ERRORS`] of them, one more that counts the rest.
    pub fn check(&self) -> Result<CheckedTree, Diagnostics> {
        let checked = self.check_within(limits::MAX_NODES, limits::MAX_OCCURRENCES);
        checked.map_err(|list| Diagnostics::new(list, self.source.clone()))
    }

    fn check_within(&self, max_nodes: usize, max_occurrences: usize) -> Result<CheckedTree, Vec<Diagnostic>> {
        let mut report = Report::default();
        let (mut parameters, errors) = collect(&self.parameters, &self.iso, &self.root);
        report.extend(errors);
        parameters::check_names(&mut report, &parameters);
        let values = refresh(&mut parameters).unwrap_or_else(|errors| {
            report.extend(errors);
            Values::new()
        });
        if !report.is_empty() {
            return Err(report.finish());
        }
        let iso = check_iso(&mut report, &self.iso, &values);
        check_groups(&mut report, &self.attributes);
        if let Some(point) = self.origin {
            check_numbers(&mut report, None, "the origin", &point, f64::NEG_INFINITY);
        }
        let mut dependence = Dependence::new(&parameters, &self.iso);
        let nodes = self.arena(max_nodes, &mut report, (iso, &values), &mut dependence);
        if report.is_empty() {
            check_occurrences(&mut report, &nodes, max_occurrences);
        }
        if !report.is_empty() {
            report.sort();
            return Err(report.finish());
        }
        let (attributes, dependence) = (self.attributes.clone(), Arc::new(dependence));
        let (nodes, source) = (nodes.into(), self.source.clone());
        let origin = self.origin.map_or(ModelOrigin::WORLD, ModelOrigin::new);
        let tree = CheckedTree { iso, attributes, nodes, parameters, dependence, origin, source };
        let found = || ModelOrigin::of(tree.support());
        Ok(if self.origin.is_some() { tree } else { CheckedTree { origin: found(), ..tree } })
    }

    /// All nodes, children before parents, each checked by itself.
    fn arena(
        &self,
        max_nodes: usize,
        report: &mut Report,
        (iso, values): (f64, &Values),
        dependence: &mut Dependence,
    ) -> Vec<CheckedNode> {
        let groups = widths(&self.attributes);
        let mut nodes: Vec<CheckedNode> = Vec::new();
        let mut ids: HashMap<usize, NodeId> = HashMap::new();
        // Each entry is a node, and whether its children are done.
        let mut stack = vec![(&self.root, false)];
        while let Some((tree, done)) = stack.pop() {
            if ids.contains_key(&tree.identity()) {
                continue;
            }
            let node = tree.node();
            if !done {
                stack.push((tree, true));
                stack.extend(node.children().iter().rev().map(|child| (child, false)));
                continue;
            }
            if nodes.len() == max_nodes {
                let message = format!("the tree has more than {max_nodes} nodes");
                report.add_last(Diagnostic::limit(node.span(), message));
                break;
            }
            let id = NodeId(nodes.len() as u32);
            if let Some(recipe) = node.recipe() {
                dependence.add(id, recipe);
            } else if let NodeKind::Combine(combinator) = node.kind()
                && combinator.asks_iso()
                && self.iso.follows()
            {
                // It has to be checked again when the iso-value moves.
                dependence.add(id, &Arc::new(Recipe::of_combinator(*combinator)));
            }
            if let Some(formula) = node.recipe().and_then(|recipe| recipe.formula()) {
                check_words(report, formula, node.span());
            }
            let made = node.recipe().map_or_else(
                || Ok(node.kind().clone()),
                |recipe| parameters::cook(recipe, values, iso, node.span()),
            );
            let kind = match made {
                Ok(kind) => {
                    check_node(report, &kind, node.children().len(), node.span(), &groups, iso);
                    kind
                }
                Err(error) => {
                    report.add(|| error);
                    node.kind().clone()
                }
            };
            let children = node.children().iter().map(|child| ids[&child.identity()]).collect();
            ids.insert(tree.identity(), id);
            nodes.push(CheckedNode { kind, children, span: node.span() });
        }
        nodes
    }
}

impl CheckedTree {
    /// A box that holds the support of the field: outside of it the field is exactly zero. Empty if the field is zero everywhere.
    ///
    /// Its sides may be infinite, as those of a half space are. Cost: linear in the number of nodes, shared ones counted once.
    #[must_use]
    pub fn support(&self) -> Bounds {
        let mut done: Vec<Extent> = Vec::with_capacity(self.nodes.len());
        for node in &*self.nodes {
            let children: Vec<_> = node.children.iter().map(|id| done[id.0 as usize]).collect();
            done.push(node_extent(&node.kind, &children, self.iso));
        }
        done.last().map_or(Bounds::EMPTY, |root| root.support)
    }

    /// The [support](Self::support) in local coordinates.
    #[must_use]
    pub fn local_support(&self) -> Bounds {
        self.origin.local_bounds(self.support())
    }
}

/// The extent of a node, from those of its children.
fn node_extent(kind: &NodeKind, children: &[Extent], iso: f64) -> Extent {
    match kind {
        NodeKind::Primitive(leaf) => {
            let support = leaf.skeleton.bounds_within(leaf.radius);
            Extent { support, negative: if leaf.strength < 0.0 { support } else { Bounds::EMPTY } }
        }
        NodeKind::Combine(combinator) if children.len() == 1 && combinator.passes_single() => children[0],
        NodeKind::Combine(combinator) => Extent::of(*combinator, children, iso),
        NodeKind::Expression(expression) => {
            let signs: Vec<bool> = children.iter().map(|child| child.negative.is_empty()).collect();
            let hull = || children.iter().fold(Bounds::EMPTY, |all, child| all.hull(child.support));
            let reach = if expression.vanishes() { hull() } else { Bounds::EVERYWHERE };
            let support = expression.bounds().map_or(reach, |bounds| reach.intersection(bounds));
            let support = if support.is_empty() { Bounds::EMPTY } else { support };
            Extent {
                support,
                negative: if expression.non_negative(&signs) { Bounds::EMPTY } else { support },
            }
        }
        NodeKind::Select(_) => kind.asked(children)[0],
        NodeKind::Affine(map) => children[0].map(|bounds| affine::map_bounds(map, bounds)),
        NodeKind::Warp(_) if children.len() > 1 => children[0].weighted(&children[1]),
        NodeKind::Warp(warp) => children[0].map(|bounds| warp.forward_bounds(bounds)),
        NodeKind::Attribute { .. } => children[0],
    }
}

/// The smallest reciprocal condition number of an affine map's linear part: below it, the map counts as singular.
///
/// It is `1 / (|A| |A^-1|)` in the largest column sum norm, computed in f64: 1 for a rotation at best, 0 for a singular map, and
/// unchanged by uniform scale. At 1e-12, an f64 inverse is still right to about four digits.
pub const MIN_RECIPROCAL_CONDITION: f64 = 1e-12;

fn check_node(
    report: &mut Report,
    kind: &NodeKind,
    count: usize,
    span: Option<Span>,
    groups: &BTreeMap<&str, usize>,
    iso: f64,
) {
    let fits = match kind {
        NodeKind::Primitive(leaf) => {
            check_primitive(report, span, leaf);
            (count == 0, "no children")
        }
        NodeKind::Combine(combinator) => {
            check_combinator(report, span, *combinator, iso);
            match combinator.form() {
                Form::Map(_) => (count == 1, "one child"),
                Form::Fold | Form::Difference | Form::Step(_) => (count >= 1, "at least one child"),
            }
        }
        NodeKind::Expression(expression) => {
            check_expressed(report, span, expression, (1, count));
            (true, "as many children as the formula names")
        }
        NodeKind::Select(which) => {
            check_choice(report, span, *which, count);
            (count >= 1, "at least one child")
        }
        NodeKind::Affine(map) => {
            check_affine(report, span, map);
            (count == 1, "one child")
        }
        NodeKind::Warp(warp) => {
            check_fields(report, span, warp.name(), warp.fields(), &warp.to_fields());
            if let Warp::Formula(warp) = warp {
                check_formula(report, span, "the warp", &warp.form, &warp.numbers);
                for falloff in warp.form.falloffs() {
                    check_falloff(report, span, &falloff);
                }
            }
            if let Some(fault) = warp.fault() {
                report.add(|| Diagnostic::error(span, fault.message).expected(fault.expected));
            }
            (count == 1 || count == 2, "one child, or a second one that gives its weight")
        }
        NodeKind::Attribute { name, value } => {
            check_attribute(report, span, name, value, groups);
            (count == 1, "one child")
        }
    };
    if let (false, expected) = fits {
        let message = format!("{} has {count} children", describe(kind));
        report.add(|| Diagnostic::error(span, message).expected(format!("expected {expected}")));
    }
}

/// A node's kind in words.
fn describe(kind: &NodeKind) -> String {
    match kind {
        NodeKind::Primitive(leaf) => format!("a {}", leaf.skeleton.kind().name()),
        NodeKind::Combine(combinator) => format!("a node `{}`", combinator.name()),
        NodeKind::Select(_) => "a node `select`".to_owned(),
        NodeKind::Expression(_) => "a node `expression`".to_owned(),
        NodeKind::Affine(_) => "an affine map".to_owned(),
        NodeKind::Warp(warp) => format!("a {}", warp.name()),
        NodeKind::Attribute { name, .. } => format!("the attribute node `{name}`"),
    }
}

fn check_primitive(report: &mut Report, span: Option<Span>, leaf: &Primitive) {
    let kind = leaf.skeleton.kind();
    let well = check_fields(report, span, kind.name(), kind.fields(), &leaf.skeleton.to_fields());
    if let Some(fault) = leaf.skeleton.fault().filter(|_| well) {
        report.add(|| Diagnostic { span, ..fault });
    }
    check_falloff(report, span, &leaf.falloff);
    check_number(report, span, "the radius", leaf.radius, limits::MIN_LENGTH);
    check_number(report, span, "the strength", leaf.strength, f64::NEG_INFINITY);
}

fn check_falloff(report: &mut Report, span: Option<Span>, falloff: &Falloff) {
    let owner = format!("{} falloff", falloff.name());
    check_fields(report, span, &owner, falloff.kind().fields(), &falloff.to_fields());
}

/// The parameters of a skeleton, a falloff or a warp, each by its kind: whether all are well.
fn check_fields(
    report: &mut Report,
    span: Option<Span>,
    owner: &str,
    fields: &[Field],
    values: &[FieldValue],
) -> bool {
    let before = report.len();
    for (field, value) in fields.iter().zip(values) {
        let what = format!("the `{}` of the {owner}", field.name);
        match field.kind {
            FieldKind::Real => {
                check_number(report, span, &what, value.real(), f64::NEG_INFINITY);
            }
            FieldKind::Positive => {
                check_number(report, span, &what, value.real(), limits::MIN_LENGTH);
            }
            FieldKind::NonNegative => {
                check_number(report, span, &what, value.real(), 0.0);
            }
            FieldKind::Within { least, most } => {
                check_within(report, span, &what, value.real(), least..=most);
            }
            FieldKind::Choice(words) => {
                check_within(report, span, &what, value.real(), 0.0..=words.len() as f64 - 1.0);
            }
            FieldKind::Count => check_count(report, span, &what, value.real()),
            FieldKind::Degrees => check_within(report, span, &what, value.real(), 0.0..=360.0),
            FieldKind::Extents => check_numbers(report, span, &what, &value.vector(), 0.0),
            FieldKind::Stretches => check_numbers(report, span, &what, &value.vector(), limits::MIN_LENGTH),
            FieldKind::Position => check_numbers(report, span, &what, &value.vector(), f64::NEG_INFINITY),
            FieldKind::Direction | FieldKind::Axis => {
                check_numbers(report, span, &what, &value.vector(), f64::NEG_INFINITY);
                if value.vector() == [0.0; 3] {
                    report.add(|| {
                        Diagnostic::error(span, format!("{what} is (0 0 0)")).expected("expected a direction")
                    });
                }
            }
            FieldKind::Positions => {
                let what = |index: usize| format!("number {} of {what}", index + 1);
                check_list(report, span, &what, value.vectors(), f64::NEG_INFINITY);
            }
            FieldKind::Lengths => {
                let what = |index: usize| format!("number {} of {what}", index + 1);
                let (values, _) = value.reals().as_chunks::<1>();
                check_list(report, span, &what, values, 0.0);
            }
            FieldKind::Flag => {
                check_number(report, span, &what, value.real(), 0.0);
            }
        }
    }
    report.len() == before
}

/// An affine map has to have an inverse, in numbers that f32 can hold.
fn check_affine(report: &mut Report, span: Option<Span>, map: &DAffine3) {
    let numbers = map.to_cols_array();
    if !numbers.iter().all(|x| x.is_finite() && x.abs() <= limits::MAX_NUMBER) {
        check_numbers(report, span, "the affine map (by columns)", &numbers, f64::NEG_INFINITY);
        return;
    }
    let size = largest(map.matrix3);
    let inverse = (map.matrix3 * (1.0 / size)).inverse();
    // A singular matrix has an inverse of infinities and NaNs.
    let condition = if inverse.is_finite() { 1.0 / (norm(map.matrix3) / size * norm(inverse)) } else { 0.0 };
    if condition < MIN_RECIPROCAL_CONDITION {
        let message = format!("the affine map is singular: its reciprocal condition is {condition:.1e}");
        let least = MIN_RECIPROCAL_CONDITION;
        report.add(|| Diagnostic::error(span, message).expected(format!("expected at least {least:e}")));
        return;
    }
    // With |t| <= MAX_NUMBER this bounds the inverse's translation too, at 3e30: finite in f32.
    let least = limits::MIN_LENGTH;
    if largest(inverse) / size > 1.0 / least {
        let message = format!("the affine map shrinks {:.1e} times", largest(inverse) / size);
        report.add(|| {
            Diagnostic::error(span, message).expected(format!("expected a scale of at least {least:e}"))
        });
    }
}

/// The largest magnitude of a matrix's numbers.
fn largest(m: DMat3) -> f64 {
    m.to_cols_array().iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// The largest sum of magnitudes of a column.
fn norm(m: DMat3) -> f64 {
    [m.x_axis, m.y_axis, m.z_axis].iter().map(|column| column.abs().element_sum()).fold(0.0, f64::max)
}

/// The number of paths from the root to each node, through these children of each. Children come before their parents.
fn paths(nodes: &[CheckedNode], below: impl Fn(&CheckedNode) -> &[NodeId]) -> Vec<u64> {
    let mut paths = vec![0_u64; nodes.len()];
    if let Some(root) = paths.last_mut() {
        *root = 1;
    }
    for (index, node) in nodes.iter().enumerate().rev() {
        for child in below(node) {
            let child = child.0 as usize;
            paths[child] = paths[child].saturating_add(paths[index]);
        }
    }
    paths
}

/// Counts the paths from the root to all nodes: what lowering may have to go through, and rows in the end.
fn check_occurrences(report: &mut Report, nodes: &[CheckedNode], most: usize) {
    let weights = nodes.iter().map(|node| match &node.kind {
        // Each piece is a row as well.
        NodeKind::Primitive(leaf) => 1 + leaf.skeleton.piece_count(leaf.radius, most) as u64,
        NodeKind::Combine(_)
        | NodeKind::Expression(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Warp(_)
        | NodeKind::Attribute { .. } => 1,
    });
    let paths = paths(nodes, |node| &node.children);
    let mut uses = paths.iter().fold(0, |all: u64, paths| all.saturating_add(*paths));
    let what = if uses > most as u64 { "nodes" } else { "nodes and pieces" };
    for (paths, weight) in paths.into_iter().zip(weights) {
        // Pieces take longer to count than nodes.
        if uses > most as u64 {
            break;
        }
        uses = uses.saturating_add(paths.saturating_mul(weight - 1));
    }
    if uses > most as u64 {
        let span = nodes.last().and_then(|root| root.span);
        let count = if uses == u64::MAX { "more than 10^19".to_owned() } else { uses.to_string() };
        report.add(|| {
            Diagnostic::limit(span, format!("unfolded, the tree has {count} {what}; it may have {most}"))
                .expected("share fewer subtrees")
        });
    }
}

/// A formula with so many values and children, and the falloffs in it.
fn check_expressed(report: &mut Report, span: Option<Span>, formula: &Expression, counts: (usize, usize)) {
    check_expression(report, span, formula, counts);
    for falloff in formula.form().falloffs() {
        check_falloff(report, span, &falloff);
    }
}

#[cfg(test)]
mod tests;
