//! Sets of points under construction: operations of one kind become one node of many children.
//!
//! ```text
//! ((a | b) - c | d) - e                     as it is written: a difference in a difference, and so on
//! ((a | b) - (c | e)) | (d - e)             as a union of differences of unions
//! ```
//!
//! In a large model chains of unions and differences become the second form, so that those of any length and
//! order are rows of the same tables. A part is without those sets alone that its box meets. A chain that
//! would become many times as long stays as it is.

use std::collections::VecDeque;

use jbt_model::attribute::Precedence;
use jbt_model::bounds::Bounds;
use jbt_model::combine::{Combinator, Complement};
use jbt_model::constant::LeafConstant;
use jbt_model::diagnostic::Span;
use jbt_model::kind::NodeKind;
use jbt_model::number::Number;
use jbt_model::tree::Tree;
use jbt_model::written::Written;

use super::database::ProgramStep;
use super::leaf::LeafStyle;
use crate::color::linear;

/// How many times as many sets a chain may have in the second form, and how many it may always have.
const LONGEST: usize = 16;
const ALWAYS: usize = 256;

/// A tree, and a box around its points.
#[derive(Clone)]
pub(super) struct SetPart {
    pub(super) tree: Tree,
    pub(super) bounds: Bounds,
}

/// Sets that are united, without others.
struct Group {
    parts: VecDeque<SetPart>,
    bounds: Bounds,
    cuts: Vec<SetPart>,
}

/// What the parts of an operand are.
enum SetParts {
    /// It is not there.
    Missing,
    One(SetPart),
    /// The union of sets, and of groups.
    Union {
        parts: VecDeque<SetPart>,
        groups: Vec<Group>,
    },
    Intersection(VecDeque<SetPart>),
    /// The first without the others.
    Difference(VecDeque<SetPart>),
}

/// A set of points, or the place of one that is missing.
pub(super) struct PointSet {
    parts: SetParts,
    bounds: Bounds,
    /// The first colour in it.
    pub(super) color: Option<[u8; 3]>,
    /// How many sets it is written with, and of how many it is made.
    written: usize,
    made_of: usize,
}

/// What operations have to know.
#[derive(Clone, Copy)]
pub(super) struct CombinationSetting {
    /// Where the combination stands.
    pub(super) span: Span,
    pub(super) style: LeafStyle,
}

impl PointSet {
    /// What stands for an object that is not there.
    pub(super) const MISSING: Self =
        Self { parts: SetParts::Missing, bounds: Bounds::EMPTY, color: None, written: 0, made_of: 0 };

    /// One tree.
    pub(super) fn one(part: SetPart, color: Option<[u8; 3]>) -> Self {
        let bounds = part.bounds;
        Self { parts: SetParts::One(part), bounds, color, written: 1, made_of: 1 }
    }

    fn is_missing(&self) -> bool {
        matches!(self.parts, SetParts::Missing)
    }

    /// As one tree; `None` if it is missing.
    pub(super) fn part(self, span: Span) -> Option<SetPart> {
        let trees = |parts: VecDeque<SetPart>| parts.into_iter().map(|part| part.tree);
        let tree = match self.parts {
            SetParts::Missing => return None,
            SetParts::One(part) => return Some(part),
            SetParts::Union { parts, groups } => {
                Tree::union(trees(parts).chain(groups.into_iter().map(|group| group.tree(span))))
            }
            SetParts::Intersection(parts) => Tree::intersection(trees(parts)),
            SetParts::Difference(parts) => Tree::difference(trees(parts)),
        };
        Some(SetPart { tree: placed(tree, span), bounds: self.bounds })
    }

    fn into_union(self, span: Span) -> (VecDeque<SetPart>, Vec<Group>) {
        match self.parts {
            SetParts::Union { parts, groups } => (parts, groups),
            SetParts::Missing | SetParts::One(_) | SetParts::Intersection(_) | SetParts::Difference(_) => {
                (self.part(span).into_iter().collect(), Vec::new())
            }
        }
    }

    /// The result of an operation of two. Without one of them it is what the set is of those that are there:
    /// of a union the other one, of an intersection nothing.
    pub(super) fn combine(step: ProgramStep, left: Self, right: Self, setting: CombinationSetting) -> Self {
        let span = setting.span;
        match (step, left.is_missing(), right.is_missing()) {
            (ProgramStep::Intersection, true, _) | (ProgramStep::Intersection, _, true) => {
                return Self::MISSING;
            }
            (ProgramStep::Difference, true, _) => return Self::MISSING,
            (_, _, true) => return left,
            (_, true, false) => return right,
            _ => {}
        }
        let color = left.color.or(right.color);
        let (written, made_of) = (left.written + right.written, left.made_of + right.made_of);
        let both = left.bounds.hull(right.bounds);
        let of = |parts, bounds| Self { parts, bounds, color, written, made_of };
        match step {
            ProgramStep::Union => {
                let ((parts, mut groups), (others, more)) = (left.into_union(span), right.into_union(span));
                groups.extend(more);
                of(SetParts::Union { parts: joined(parts, others), groups }, both)
            }
            ProgramStep::Intersection => {
                let bounds = left.bounds.intersection(right.bounds);
                let list = |operand: Self| match operand.parts {
                    SetParts::Intersection(parts) => parts,
                    _ => operand.part(span).into_iter().collect(),
                };
                of(SetParts::Intersection(joined(list(left), list(right))), bounds)
            }
            ProgramStep::Difference => left.without(right, setting),
            ProgramStep::Exclusive | ProgramStep::Member | ProgramStep::Complement => {
                let trees = [left, right].into_iter().filter_map(|one| one.part(span)).map(|part| part.tree);
                let tree = placed(Tree::symmetric_difference(trees), span);
                Self { written: 1, ..of(SetParts::One(SetPart { tree, bounds: both }), both) }
            }
        }
    }

    /// This set without another one.
    fn without(self, other: Self, CombinationSetting { span, style }: CombinationSetting) -> Self {
        let (color, bounds) = (self.color, self.bounds);
        let made_of = self.made_of + other.made_of;
        // What is without a union is without each part of it. The cut has the colour of what is cut.
        let cuts = match other.parts {
            SetParts::Union { parts, groups } if groups.is_empty() => parts,
            _ => other.part(span).into_iter().collect(),
        };
        let cuts = cuts.into_iter().map(|cut| match color {
            Some(color) => SetPart { tree: colored(cut.tree, color, Precedence::Nearest, span), ..cut },
            None => cut,
        });
        let cuts: Vec<SetPart> = cuts.collect();
        let groups = match &self.parts {
            SetParts::Union { groups, .. } => groups.len() + 1,
            _ => 1,
        };
        let written = self.written + groups * cuts.len();
        if style == LeafStyle::Plain || written > ALWAYS.max(LONGEST * made_of) {
            let written = self.written + cuts.len();
            let mut parts: VecDeque<SetPart> = match self.parts {
                SetParts::Difference(parts) => parts,
                _ => self.part(span).into_iter().collect(),
            };
            parts.extend(cuts);
            // As one tree it is one set for what follows.
            let written = if style == LeafStyle::Plain { written } else { 1 };
            return Self { parts: SetParts::Difference(parts), bounds, color, written, made_of };
        }
        let (parts, mut groups) = self.into_union(span);
        if !parts.is_empty() {
            let bounds = parts.iter().fold(Bounds::EMPTY, |all, part| all.hull(part.bounds));
            groups.push(Group { parts, bounds, cuts: Vec::new() });
        }
        let mut written = 0;
        for group in &mut groups {
            let meets = |cut: &&SetPart| !cut.bounds.intersection(group.bounds).is_empty();
            group
                .cuts
                .extend(cuts.iter().filter(meets).map(|cut| SetPart { tree: copied(&cut.tree), ..*cut }));
            written += group.parts.len() + group.cuts.len();
        }
        Self { parts: SetParts::Union { parts: VecDeque::new(), groups }, bounds, color, written, made_of }
    }

    /// What is outside.
    pub(super) fn complement(self, span: Span) -> Self {
        let color = self.color;
        match self.part(span) {
            Some(part) => {
                // What is outside of what is outside is inside.
                let node = part.tree.node();
                let is_complement = *node.written() == Written::from(Combinator::from(Complement {}));
                let tree = match node.children() {
                    [child] if is_complement => child.clone(),
                    _ => placed(part.tree.complement(), span),
                };
                Self::one(SetPart { tree, bounds: Bounds::EVERYWHERE }, color)
            }
            None => Self::MISSING,
        }
    }
}

impl Group {
    fn tree(self, span: Span) -> Tree {
        let united = |parts: &mut dyn Iterator<Item = SetPart>| {
            placed(Tree::union(parts.map(|part| part.tree).collect::<Vec<_>>()), span)
        };
        let whole = united(&mut self.parts.into_iter());
        if self.cuts.is_empty() {
            return whole;
        }
        placed(Tree::difference([whole, united(&mut self.cuts.into_iter())]), span)
    }
}

/// Both lists. The shorter one moves, so that chains to either side take time by their length.
fn joined(mut left: VecDeque<SetPart>, mut right: VecDeque<SetPart>) -> VecDeque<SetPart> {
    if left.len() >= right.len() {
        left.append(&mut right);
        return left;
    }
    while let Some(part) = left.pop_back() {
        right.push_front(part);
    }
    right
}

/// The same root at a place.
fn placed(tree: Tree, span: Span) -> Tree {
    Tree::at(span, tree.node().written().clone(), tree.node().children().to_vec())
}

/// A leaf of its own, with the maps and colours above it: shared ones would be computed in front of all that
/// use them, and be no rows.
fn copied(tree: &Tree) -> Tree {
    let mut way = vec![tree];
    while let [child] = way[way.len() - 1].node().children() {
        way.push(child);
    }
    let last = way[way.len() - 1].node();
    if !last.children().is_empty() {
        return tree.clone();
    }
    let copy = |node: &jbt_model::tree::Node, children| match node.span() {
        Some(span) => Tree::at(span, node.written().clone(), children),
        None => Tree::new(node.written().clone(), children),
    };
    let mut made = copy(last, Vec::new());
    for tree in way.iter().rev().skip(1) {
        made = copy(tree.node(), vec![made]);
    }
    made
}

/// A tree in a colour, which screens have in these bytes.
pub(super) fn colored(tree: Tree, color: [u8; 3], precedence: Precedence, span: Span) -> Tree {
    let values = color.map(|byte| linear(&Number::from(f64::from(byte) / 255.0)).value());
    let kind = NodeKind::Attribute { name: "color".into(), value: values.to_vec().into(), precedence };
    Tree::at(span, kind, vec![tree])
}

/// A part whose leaves have a constant.
pub(super) fn with_constant(
    part: SetPart,
    (name, value, precedence): (&str, LeafConstant, Precedence),
    span: Span,
) -> SetPart {
    let kind = NodeKind::Constant { name: name.into(), value, precedence };
    SetPart { tree: Tree::at(span, kind, vec![part.tree]), ..part }
}
