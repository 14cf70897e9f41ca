//! Parts of a model by their names: a model of nothing else, and one without them.

use super::Model;
use crate::combine::{Combinator, CombinatorKind, Sum};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::field::FieldKind;
use crate::path::{MetNode, NamedNodes, NodePath, nowhere, search, too_many};
use crate::traverse::Visit;
use crate::tree::order::PlainNodes;
use crate::tree::{Node, Tree};
use crate::written::{FieldNumber, Written};

impl<'a> NamedNodes<'a> for PlainNodes<'a> {
    fn name(self, node: &'a Tree) -> Option<&'a str> {
        node.node().name()
    }

    fn word(self, node: &'a Tree) -> &'a str {
        word(node.node())
    }

    fn is_given(self, _node: &'a Tree) -> bool {
        false
    }
}

/// The name of a node, or the word of its kind.
fn word(node: &Node) -> &str {
    node.name().unwrap_or_else(|| match node.written() {
        Written::Primitive { skeleton, .. } => skeleton.name(),
        Written::Particles(_) => "particles",
        Written::Combine { combinator, .. } => combinator.name(),
        Written::Expression(_) => "expression",
        Written::Select(_) => "select",
        Written::Map { map, .. } => map.name(),
        Written::Warp { warp, .. } => warp.name(),
        Written::FormulaWarp(_) => "warp",
        Written::Attribute { name, .. } | Written::Constant { name, .. } => name,
    })
}

/// What is left of a subtree.
#[derive(Clone)]
enum Left {
    /// All of it.
    All,
    /// Another tree.
    Part(Tree),
    Nothing,
}

impl Left {
    fn tree(self, whole: &Tree) -> Option<Tree> {
        match self {
            Self::All => Some(whole.clone()),
            Self::Part(tree) => Some(tree),
            Self::Nothing => None,
        }
    }
}

impl Model {
    /// The model of those parts alone that a path of [names](crate::path) leads to, where they are and as
    /// they are: maps, warps and attributes above them stay. Of an operator the operands stay that have such
    /// parts, so that what a difference cuts with is seen by itself. Of a selector one child stays. A formula
    /// of several fields becomes the sum of those that stay.
    ///
    /// # Errors
    /// A path that leads nowhere.
    pub fn only(&self, path: &str) -> Result<Self, Diagnostics> {
        self.selected(path, Left::Nothing, Left::All, only)
    }

    /// The model without the parts that a path of [names](crate::path) leads to. An operator does without
    /// them, a difference without its first operand is nothing, and so is a formula without one of its
    /// fields. A selector that loses a child stays with the one that it chooses now.
    ///
    /// # Errors
    /// A path that leads nowhere, and a model of which nothing would be left.
    pub fn without(&self, path: &str) -> Result<Self, Diagnostics> {
        self.selected(path, Left::All, Left::Nothing, without)
    }

    fn selected(
        &self,
        text: &str,
        other: Left,
        found: Left,
        rebuild: fn(&Tree, Vec<Left>) -> Left,
    ) -> Result<Self, Diagnostics> {
        let path = NodePath::parse(text).map_err(|error| vec![error])?;
        let mut stack: Vec<Left> = Vec::new();
        let mut count = 0;
        let searched = search(PlainNodes::new(), &self.root, &path, false, |met, _, _| match met {
            MetNode::Other => stack.push(other.clone()),
            MetNode::Found(_) => {
                count += 1;
                stack.push(found.clone());
            }
            MetNode::Left(node) => {
                let first = stack.len() - node.node().children().len();
                let children = stack.split_off(first);
                stack.push(rebuild(node, children));
            }
        });
        searched.map_err(|_| vec![too_many(&path)])?;
        if count == 0 {
            let names = self.root.prefix(Visit::Nodes).filter_map(|tree| tree.node().name());
            return Err(Diagnostics::new(vec![nowhere(&path, names)], None));
        }
        let Some(root) = stack.pop().and_then(|left| left.tree(&self.root)) else {
            let message = format!("nothing is left of the model without `{path}`");
            return Err(Diagnostics::new(vec![Diagnostic::error(None, message)], None));
        };
        // What was shared is so again, where it is the same still.
        Ok(Self { root: root.share(), ..self.clone() })
    }
}

/// A node of whose children some stay.
fn only(node: &Tree, left: Vec<Left>) -> Left {
    if left.iter().all(|one| matches!(one, Left::Nothing)) {
        return Left::Nothing;
    }
    let whole = node.node().children();
    let mut children: Vec<Option<Tree>> =
        left.into_iter().zip(whole).map(|(left, whole)| left.tree(whole)).collect();
    let Some(first) = children.iter().flatten().next().cloned() else { return Left::Nothing };
    Left::Part(match node.node().written() {
        Written::Primitive { .. }
        | Written::Particles(_)
        | Written::Map { .. }
        | Written::Attribute { .. }
        | Written::Constant { .. } => node.with_children(vec![first]),
        Written::Warp { .. } | Written::FormulaWarp(_) => match children[0].take() {
            Some(child) => {
                node.with_children([child].into_iter().chain(whole[1..].iter().cloned()).collect())
            }
            None => first,
        },
        Written::Combine { .. } => node.with_children(children.into_iter().flatten().collect()),
        Written::Select(which) => {
            let chosen = chosen(which.value(), whole.len());
            children[chosen].take().unwrap_or(first)
        }
        Written::Expression(_) => {
            let mut kept: Vec<Tree> = children.into_iter().flatten().collect();
            match (kept.len(), whole.len()) {
                (1, 1) => node.with_children(kept),
                (1, _) => kept.remove(0),
                _ => Tree::new(Combinator::from(Sum {}), kept),
            }
        }
    })
}

/// A node of whose children some go.
fn without(node: &Tree, left: Vec<Left>) -> Left {
    if left.iter().all(|one| matches!(one, Left::All)) {
        return Left::All;
    }
    let whole = node.node().children();
    let mut children: Vec<Option<Tree>> =
        left.into_iter().zip(whole).map(|(left, whole)| left.tree(whole)).collect();
    let rest = match node.node().written() {
        Written::Primitive { .. } | Written::Particles(_) => return Left::All,
        Written::Map { .. }
        | Written::Attribute { .. }
        | Written::Constant { .. }
        | Written::Warp { .. }
        | Written::FormulaWarp(_) => {
            if children[0].is_none() {
                Vec::new()
            } else {
                children.into_iter().flatten().collect()
            }
        }
        Written::Combine { combinator, fields } => {
            let is_lost = children[0].is_none() && takes_away(*combinator, fields);
            if is_lost { Vec::new() } else { children.into_iter().flatten().collect() }
        }
        Written::Select(which) => {
            let chosen = chosen(which.value(), whole.len());
            return children[chosen].take().map_or(Left::Nothing, Left::Part);
        }
        Written::Expression(_) if children.iter().any(Option::is_none) => Vec::new(),
        Written::Expression(_) => children.into_iter().flatten().collect(),
    };
    if rest.is_empty() { Left::Nothing } else { Left::Part(node.with_children(rest)) }
}

/// The child that a selector chooses.
fn chosen(which: f64, count: usize) -> usize {
    (which.round().max(0.0) as usize).min(count - 1)
}

/// Whether an operator takes the others away from its first operand.
fn takes_away(kind: CombinatorKind, fields: &[FieldNumber]) -> bool {
    let mut numbers =
        kind.fields().iter().zip(fields).filter_map(|(field, value)| match (field.kind, value) {
            (FieldKind::Choice(words), FieldNumber::Real(number)) => words.get(number.value() as usize),
            _ => None,
        });
    matches!(kind.name(), "difference" | "smooth_difference") || numbers.any(|word| *word == "difference")
}
