//! Sets of points under construction: operations of one kind become one node of many children.

use std::collections::VecDeque;

use jbt_model::combine::{Combinator, Difference, Intersection, SymmetricDifference, Union};
use jbt_model::diagnostic::Span;
use jbt_model::tree::Tree;

use super::build::colored;
use super::database::SetStep;

/// A set of points, or the place of one that is missing.
pub(super) struct Operand {
    /// The operation whose children these are; of one tree there is none.
    kind: OperandKind,
    trees: VecDeque<Tree>,
    /// The first colour in it.
    pub(super) color: Option<[u8; 3]>,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum OperandKind {
    Missing,
    One,
    Union,
    Intersection,
    /// The first without the others.
    Difference,
}

impl Operand {
    /// What stands for an object that is not there.
    pub(super) const MISSING: Self = Self { kind: OperandKind::Missing, trees: VecDeque::new(), color: None };

    /// One tree.
    pub(super) fn one(tree: Tree, color: Option<[u8; 3]>) -> Self {
        Self { kind: OperandKind::One, trees: [tree].into(), color }
    }

    fn is_missing(&self) -> bool {
        self.kind == OperandKind::Missing
    }

    /// As one tree; `None` if it is missing.
    pub(super) fn tree(mut self, span: Span) -> Option<Tree> {
        let combinator = match self.kind {
            OperandKind::Missing => return None,
            OperandKind::One => return self.trees.pop_front(),
            OperandKind::Union => Combinator::from(Union {}),
            OperandKind::Intersection => Intersection {}.into(),
            OperandKind::Difference => Difference {}.into(),
        };
        Some(Tree::at(span, combinator, self.trees.into()))
    }

    /// The children that it has in an operation of this kind.
    fn children(self, kind: OperandKind, span: Span) -> VecDeque<Tree> {
        if self.kind == kind { self.trees } else { self.tree(span).into_iter().collect() }
    }

    /// The result of an operation of two. Without one of them it is what the set is of those that are there:
    /// of a union the other one, of an intersection nothing.
    pub(super) fn combine(step: SetStep, left: Self, right: Self, span: Span) -> Self {
        let color = left.color.or(right.color);
        let kind = match (step, left.is_missing(), right.is_missing()) {
            (SetStep::Intersection, true, _) | (SetStep::Intersection, _, true) => return Self::MISSING,
            (SetStep::Difference, true, _) => return Self::MISSING,
            (_, _, true) => return left,
            (_, true, false) => return right,
            (SetStep::Union, ..) => OperandKind::Union,
            (SetStep::Intersection, ..) => OperandKind::Intersection,
            (SetStep::Difference, ..) => {
                let color = left.color;
                let mut trees = left.children(OperandKind::Difference, span);
                // What is without a union is without each part of it. The cut has the colour of what is cut.
                let cuts = right.children(OperandKind::Union, span).into_iter();
                trees.extend(cuts.map(|cut| match color {
                    Some(color) => colored(cut, color, span),
                    None => cut,
                }));
                return Self { kind: OperandKind::Difference, trees, color };
            }
            (SetStep::Exclusive | SetStep::Member | SetStep::Complement, ..) => {
                let children: Vec<Tree> =
                    [left, right].into_iter().filter_map(|one| one.tree(span)).collect();
                let tree = Tree::at(span, Combinator::from(SymmetricDifference {}), children);
                return Self::one(tree, color);
            }
        };
        let (mut left, mut right) = (left.children(kind, span), right.children(kind, span));
        // The shorter list moves, so that chains to either side take time by their length.
        let trees = if left.len() >= right.len() {
            left.append(&mut right);
            left
        } else {
            while let Some(tree) = left.pop_back() {
                right.push_front(tree);
            }
            right
        };
        Self { kind, trees, color }
    }

    /// What is outside.
    pub(super) fn complement(self, span: Span) -> Self {
        let color = self.color;
        match self.tree(span) {
            Some(tree) => {
                let combinator = Combinator::from(jbt_model::combine::Complement {});
                Self::one(Tree::at(span, combinator, vec![tree]), color)
            }
            None => Self::MISSING,
        }
    }
}
