//! A model that tells where the fields of two models may differ: where its field is 0, they are equal.
//!
//! ```text
//! d(a, b) = 0                              where a and b are equal subtrees
//!         = d of the child under the map   equal affine maps and warps
//!         = max of d(a_i, b_i)             equal operators and formulas, child by child
//!         = |a - b|                        anything else
//! ```
//!
//! Operands of sums, unions and intersections meet whatever their order is. One that is in one model alone
//! counts by its own field where a zero changes nothing, as in sums, and in unions with a field that is never
//! negative. In a union nothing differs where an equal operand is above all that have changed. A difference
//! compares what one more subtrahend leaves of its first operand.
//!
//! So the model has the changed subtrees, those that they compete with, and no others. Fields are equal there
//! as functions; sums in another order have other last digits.

use std::collections::HashMap;

use jbt_ir::watch;
use jbt_model::check::CheckedTree;
use jbt_model::combine::{
    Combinator, CombinatorKind, Difference, Extreme, Intersection, OperatorForm, ReduceCode, Sum, Union,
};
use jbt_model::kind::{NodeKind, chosen};
use jbt_model::model::Model;
use jbt_model::tree::Tree;
use jbt_model::written::{FieldNumber, Written};

use crate::hash::NodeHashes;
use crate::item::{NodeItem, node_words};
use crate::pairs::{Pair, Partners};

/// A model whose field is 0 where those of two models are equal as functions, and never negative. `None` if
/// their iso-values differ, and an operator asks for it.
///
/// ```
/// use jbt_text::{field_difference, model};
/// let [a, b] = ["", "point { at (9 0 0) radius 0.5 }"].map(|more| {
///     model(&format!("jbt 1 union {{ point {{ radius 5 }} {more} }}")).unwrap().check().unwrap()
/// });
/// let support = field_difference(&a, &b).unwrap().check().unwrap().support();
/// assert_eq!((support.low()[0], support.high()[0]), (8.5, 9.5));
/// ```
///
/// Cost: as that of the hashes of both.
#[must_use]
pub fn field_difference(first: &CheckedTree, second: &CheckedTree) -> Option<Model> {
    let trees = [first, second];
    let asks_iso = |tree: &CheckedTree| tree.nodes().iter().any(|node| asks_iso(&node.kind));
    if first.iso().to_bits() != second.iso().to_bits() && trees.iter().any(|tree| asks_iso(tree)) {
        return None;
    }
    watch::take((first.nodes().len() + second.nodes().len()) * NODE_BYTES);
    let mut non_negative = HashMap::new();
    let [a, b] = trees.map(|tree| plain(tree, &mut non_negative));
    let hashes = [NodeHashes::new(&a), NodeHashes::new(&b)];
    let search = FieldComparison { iso: first.iso(), hashes, non_negative, done: HashMap::new() };
    let root = search.run(&a, &b).unwrap_or_else(Tree::empty);
    Some(Model { iso: first.iso().into(), ..Model::new(root) })
}

/// What is kept for a node: two copies of it, its hash, its partners. 600 bytes were seen.
const NODE_BYTES: usize = 800;

/// Whether the field of a node depends on the iso-value.
fn asks_iso(kind: &NodeKind) -> bool {
    let NodeKind::Combine(operator) = kind else { return false };
    let free =
        [CombinatorKind::Sum, CombinatorKind::Ricci, CombinatorKind::Union, CombinatorKind::Intersection];
    !free.contains(&operator.kind())
}

/// The tree with plain numbers, without attributes and without what selectors leave out; and for each node
/// whether its field is never negative.
fn plain(tree: &CheckedTree, non_negative: &mut HashMap<usize, bool>) -> Tree {
    let mut plain: Vec<Tree> = Vec::with_capacity(tree.nodes().len());
    for node in tree.nodes() {
        let child = |place: usize| plain[node.children[place].0 as usize].clone();
        let below: Vec<bool> =
            node.children.iter().map(|child| non_negative[&plain[child.0 as usize].identity()]).collect();
        let all = below.iter().all(|known| *known);
        let (made, known) = match &node.kind {
            NodeKind::Attribute { .. } | NodeKind::Constant { .. } => (child(0), below[0]),
            NodeKind::Select(which) => (child(chosen(*which)), below[chosen(*which)]),
            kind => {
                let children = (0..node.children.len()).map(child).collect();
                let known = match kind {
                    NodeKind::Primitive(leaf) => leaf.strength >= 0.0,
                    NodeKind::Particles(particles) => particles.extent().negative.is_empty(),
                    NodeKind::Combine(operator) => operator.is_non_negative(&mut below.iter().copied(), true),
                    NodeKind::Expression(expression) => expression.non_negative(&below),
                    NodeKind::Affine(_)
                    | NodeKind::Warp(_)
                    | NodeKind::Select(_)
                    | NodeKind::Attribute { .. }
                    | NodeKind::Constant { .. } => all,
                };
                (Tree::new(kind.clone(), children), known)
            }
        };
        non_negative.insert(made.identity(), known);
        plain.push(made);
    }
    plain.pop().expect("a tree has a root")
}

/// How a node makes its field of those of its children.
#[derive(Clone, Copy, PartialEq, Eq)]
enum NodeForm {
    /// In any order, and a zero changes nothing.
    Sum,
    /// The largest one.
    Union,
    /// In any order.
    Unordered,
    /// The first one without the others, which come in any order.
    Difference,
    /// Each in its place.
    Ordered,
    /// The child stands elsewhere, or is deformed, by a second one perhaps.
    Elsewhere,
}

impl NodeForm {
    fn of(tree: &Tree) -> Self {
        match tree.node().written() {
            Written::Combine { combinator, fields } => {
                let values: Vec<_> = fields.iter().map(FieldNumber::value).collect();
                let operator = combinator.from_fields(&values);
                match operator.form(false) {
                    OperatorForm::Reduce(ReduceCode::Fold(_)) => {
                        let blends = matches!(operator, Combinator::Ricci(ricci) if ricci.exponent > 0.0);
                        let adds = blends || operator.kind() == CombinatorKind::Sum;
                        if adds { Self::Sum } else { Self::Unordered }
                    }
                    OperatorForm::Reduce(ReduceCode::Choice(Extreme::Largest)) => Self::Union,
                    OperatorForm::Reduce(ReduceCode::Choice(Extreme::Smallest)) => Self::Unordered,
                    OperatorForm::Difference => Self::Difference,
                    OperatorForm::Reduce(ReduceCode::Step(_)) | OperatorForm::Map(_) => Self::Ordered,
                }
            }
            Written::Map { .. } | Written::Warp { .. } | Written::FormulaWarp(_) => Self::Elsewhere,
            Written::Primitive { .. }
            | Written::Particles(_)
            | Written::Expression(_)
            | Written::Select(_)
            | Written::Attribute { .. }
            | Written::Constant { .. } => Self::Ordered,
        }
    }
}

/// What the children of two nodes have to do with each other.
struct ChildPlan {
    form: NodeForm,
    /// Equal ones.
    equal: Vec<Tree>,
    /// Those to compare.
    pairs: Vec<[Tree; 2]>,
    /// Those of one node alone.
    alone: Vec<Tree>,
}

struct FieldComparison {
    iso: f64,
    hashes: [NodeHashes; 2],
    non_negative: HashMap<usize, bool>,
    /// Where pairs of subtrees may differ; nothing if they do not.
    done: HashMap<(usize, usize), Option<Tree>>,
}

impl FieldComparison {
    fn run(mut self, first: &Tree, second: &Tree) -> Option<Tree> {
        let mut stack = vec![[first.clone(), second.clone()]];
        while let Some([a, b]) = stack.pop() {
            if self.done.contains_key(&ids(&a, &b)) {
                continue;
            }
            if self.are_equal(&a, &b) {
                self.done.insert(ids(&a, &b), None);
                continue;
            }
            let plan = self.plan(&a, &b);
            let missing = |[a, b]: &&[Tree; 2]| !self.done.contains_key(&ids(a, b));
            let below: Vec<[Tree; 2]> =
                plan.iter().flat_map(|plan| &plan.pairs).filter(missing).cloned().collect();
            if !below.is_empty() {
                stack.push([a, b]);
                stack.extend(below);
                continue;
            }
            let found = plan.map_or_else(|| Some(distance(&a, &b)), |plan| self.joined(&a, plan));
            self.done.insert(ids(&a, &b), found);
        }
        self.done.remove(&ids(first, second)).flatten()
    }

    fn are_equal(&self, a: &Tree, b: &Tree) -> bool {
        let [first, second] =
            [(0, a), (1, b)].map(|(side, tree): (usize, &Tree)| self.hashes[side].of(NodeItem::below(tree)));
        first == second
    }

    /// How two different nodes are compared child by child, if they can be.
    fn plan(&self, a: &Tree, b: &Tree) -> Option<ChildPlan> {
        if node_words(a) == node_words(b) {
            let children = [a, b].map(|tree| tree.node().children().to_vec());
            let is_leaf = children.iter().all(Vec::is_empty);
            return if is_leaf { None } else { self.plan_of(NodeForm::of(a), &children) };
        }
        // One operand is what a union, a sum or a difference of it alone is.
        let single = [
            (Combinator::from(Union {}), NodeForm::Union),
            (Sum {}.into(), NodeForm::Sum),
            (Difference {}.into(), NodeForm::Difference),
        ];
        let lists = single.map(|(operator, form)| {
            let is_operator = [a, b].map(|tree| *tree.node().written() == Written::from(operator));
            let list = |side: usize, tree: &Tree| {
                if is_operator[side] { tree.node().children().to_vec() } else { vec![tree.clone()] }
            };
            is_operator.contains(&true).then(|| (form, [list(0, a), list(1, b)]))
        });
        // That of which an operand is the other node already, if there is one.
        let has_equal = |[first, second]: &[Vec<Tree>; 2]| {
            first.iter().any(|a| second.iter().any(|b| self.are_equal(a, b)))
        };
        let (best, others): (Vec<_>, Vec<_>) =
            lists.into_iter().flatten().partition(|(_, children)| has_equal(children));
        let (form, children) = best.into_iter().chain(others).next()?;
        self.plan_of(form, &children)
    }

    fn plan_of(&self, form: NodeForm, children: &[Vec<Tree>; 2]) -> Option<ChildPlan> {
        let [first, second] = children;
        let fixed = match form {
            NodeForm::Sum | NodeForm::Union | NodeForm::Unordered => 0,
            NodeForm::Difference => 1,
            NodeForm::Ordered | NodeForm::Elsewhere => first.len(),
        };
        if first.len() < fixed || second.len() < fixed {
            return None;
        }
        let mut plan = ChildPlan { form, equal: Vec::new(), pairs: Vec::new(), alone: Vec::new() };
        for (a, b) in first[..fixed].iter().zip(second) {
            plan.pairs.push([a.clone(), b.clone()]);
        }
        for [a, b] in self.met(&first[fixed..], &second[fixed..]) {
            match (a, b) {
                (Some(a), Some(b)) if self.are_equal(&a, &b) => plan.equal.push(a),
                (Some(a), Some(b)) => plan.pairs.push([a, b]),
                (Some(alone), None) | (None, Some(alone)) => plan.alone.push(alone),
                (None, None) => {}
            }
        }
        let never = |tree: &Tree| self.non_negative[&tree.identity()];
        let is_fit = match form {
            NodeForm::Sum | NodeForm::Difference => true,
            // A zero changes nothing beside a field that is never negative.
            NodeForm::Union => {
                plan.alone.is_empty()
                    || plan.equal.iter().any(never)
                    || plan.pairs.iter().any(|[a, b]| never(a) && never(b))
            }
            NodeForm::Unordered | NodeForm::Ordered => plan.alone.is_empty(),
            // What deforms is the same, or else the deformed one is asked elsewhere.
            NodeForm::Elsewhere => {
                plan.alone.is_empty() && plan.pairs[1..].iter().all(|[a, b]| self.are_equal(a, b))
            }
        };
        is_fit.then_some(plan)
    }

    /// Operands that belong together: equal ones, and then those of equal kinds.
    fn met(&self, first: &[Tree], second: &[Tree]) -> Vec<[Option<Tree>; 2]> {
        let hash = |side: usize, trees: &[Tree]| -> Vec<_> {
            trees.iter().map(|tree| Some(self.hashes[side].of(NodeItem::below(tree)))).collect()
        };
        let kind = |trees: &[Tree]| -> Vec<String> {
            trees.iter().map(|tree| NodeItem::below(tree).kind()).collect()
        };
        let mut partners = Partners::new(first.len(), second.len());
        partners.meet(&hash(0, first), &hash(1, second), &None);
        if partners.is_open() {
            partners.meet(&kind(first), &kind(second), &String::new());
        }
        let pair =
            |Pair { places: [a, b], .. }| [a.map(|at| first[at].clone()), b.map(|at| second[at].clone())];
        partners.pairs().into_iter().map(pair).collect()
    }

    /// Where a node differs, from where its children do; nothing if they do nowhere.
    fn joined(&self, node: &Tree, plan: ChildPlan) -> Option<Tree> {
        let ChildPlan { form, equal, pairs, alone } = plan;
        let differ = |[a, b]: &[Tree; 2]| self.done[&ids(a, b)].clone();
        let mut places: Vec<Tree> = pairs.iter().filter_map(differ).collect();
        match form {
            NodeForm::Elsewhere => {
                let mut children = vec![places.pop()?];
                children.extend(pairs.into_iter().skip(1).map(|[weight, _]| weight));
                return Some(Tree::new(node.node().written().clone(), children));
            }
            NodeForm::Difference => {
                let whole = if differ(&pairs[0]).is_some() { 2 } else { 1 };
                let first = any_of(pairs[0][..whole].to_vec())?.field();
                let left = |tree: &Tree| (2.0 * self.iso - tree.field()).max(0.0);
                places.extend(alone.iter().map(|tree| Tree::expression((&first - left(tree)).max(0.0))));
            }
            NodeForm::Sum | NodeForm::Union | NodeForm::Unordered | NodeForm::Ordered => {
                places.extend(alone.iter().map(|tree| Tree::expression(tree.field().abs())));
            }
        }
        let places = any_of(places)?;
        if form != NodeForm::Union || equal.is_empty() {
            return Some(places);
        }
        let changed = pairs.into_iter().filter(|[a, b]| self.done[&ids(a, b)].is_some()).flatten();
        let changed = any_of(changed.chain(alone).collect())?.field();
        let above = Tree::expression((changed - any_of(equal)?.field()).max(0.0));
        Some(Tree::combine(Intersection {}, [places, above]))
    }
}

/// Both identities.
fn ids(a: &Tree, b: &Tree) -> (usize, usize) {
    (a.identity(), b.identity())
}

/// How far apart two fields are.
fn distance(a: &Tree, b: &Tree) -> Tree {
    Tree::expression((a.field() - b.field()).abs())
}

/// The largest of some fields, if there are any.
fn any_of(mut trees: Vec<Tree>) -> Option<Tree> {
    if trees.len() > 1 { Some(Tree::combine(Union {}, trees)) } else { trees.pop() }
}
