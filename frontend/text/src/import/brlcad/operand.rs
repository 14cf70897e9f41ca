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

use jbt_model::bounds::Bounds;
use jbt_model::diagnostic::Span;
use jbt_model::tree::Tree;

use super::build::colored;
use super::database::SetStep;
use super::leaf::LeafStyle;

/// How many times as many sets a chain may have in the second form, and how many it may always have.
const LONGEST: usize = 16;
const ALWAYS: usize = 256;

/// A tree, and a box around its points.
#[derive(Clone)]
pub(super) struct Part {
    pub(super) tree: Tree,
    pub(super) bounds: Bounds,
}

/// Sets that are united, without others.
struct Group {
    parts: VecDeque<Part>,
    bounds: Bounds,
    cuts: Vec<Part>,
}

/// What the parts of an operand are.
enum Parts {
    /// It is not there.
    Missing,
    One(Part),
    /// The union of sets, and of groups.
    Union {
        parts: VecDeque<Part>,
        groups: Vec<Group>,
    },
    Intersection(VecDeque<Part>),
    /// The first without the others.
    Difference(VecDeque<Part>),
}

/// A set of points, or the place of one that is missing.
pub(super) struct Operand {
    parts: Parts,
    bounds: Bounds,
    /// The first colour in it.
    pub(super) color: Option<[u8; 3]>,
    /// How many sets it is written with, and of how many it is made.
    written: usize,
    made_of: usize,
}

/// What operations have to know.
#[derive(Clone, Copy)]
pub(super) struct Setting {
    /// Where the combination stands.
    pub(super) span: Span,
    pub(super) style: LeafStyle,
}

impl Operand {
    /// What stands for an object that is not there.
    pub(super) const MISSING: Self =
        Self { parts: Parts::Missing, bounds: Bounds::EMPTY, color: None, written: 0, made_of: 0 };

    /// One tree.
    pub(super) fn one(part: Part, color: Option<[u8; 3]>) -> Self {
        let bounds = part.bounds;
        Self { parts: Parts::One(part), bounds, color, written: 1, made_of: 1 }
    }

    fn is_missing(&self) -> bool {
        matches!(self.parts, Parts::Missing)
    }

    /// As one tree; `None` if it is missing.
    pub(super) fn part(self, span: Span) -> Option<Part> {
        let trees = |parts: VecDeque<Part>| parts.into_iter().map(|part| part.tree);
        let tree = match self.parts {
            Parts::Missing => return None,
            Parts::One(part) => return Some(part),
            Parts::Union { parts, groups } => {
                Tree::union(trees(parts).chain(groups.into_iter().map(|group| group.tree(span))))
            }
            Parts::Intersection(parts) => Tree::intersection(trees(parts)),
            Parts::Difference(parts) => Tree::difference(trees(parts)),
        };
        Some(Part { tree: placed(tree, span), bounds: self.bounds })
    }

    fn into_union(self, span: Span) -> (VecDeque<Part>, Vec<Group>) {
        match self.parts {
            Parts::Union { parts, groups } => (parts, groups),
            Parts::Missing | Parts::One(_) | Parts::Intersection(_) | Parts::Difference(_) => {
                (self.part(span).into_iter().collect(), Vec::new())
            }
        }
    }

    /// The result of an operation of two. Without one of them it is what the set is of those that are there:
    /// of a union the other one, of an intersection nothing.
    pub(super) fn combine(step: SetStep, left: Self, right: Self, setting: Setting) -> Self {
        let span = setting.span;
        match (step, left.is_missing(), right.is_missing()) {
            (SetStep::Intersection, true, _) | (SetStep::Intersection, _, true) => return Self::MISSING,
            (SetStep::Difference, true, _) => return Self::MISSING,
            (_, _, true) => return left,
            (_, true, false) => return right,
            _ => {}
        }
        let color = left.color.or(right.color);
        let (written, made_of) = (left.written + right.written, left.made_of + right.made_of);
        let both = left.bounds.hull(right.bounds);
        let of = |parts, bounds| Self { parts, bounds, color, written, made_of };
        match step {
            SetStep::Union => {
                let ((parts, mut groups), (others, more)) = (left.into_union(span), right.into_union(span));
                groups.extend(more);
                of(Parts::Union { parts: joined(parts, others), groups }, both)
            }
            SetStep::Intersection => {
                let bounds = left.bounds.intersection(right.bounds);
                let list = |operand: Self| match operand.parts {
                    Parts::Intersection(parts) => parts,
                    _ => operand.part(span).into_iter().collect(),
                };
                of(Parts::Intersection(joined(list(left), list(right))), bounds)
            }
            SetStep::Difference => left.without(right, setting),
            SetStep::Exclusive | SetStep::Member | SetStep::Complement => {
                let trees = [left, right].into_iter().filter_map(|one| one.part(span)).map(|part| part.tree);
                let tree = placed(Tree::symmetric_difference(trees), span);
                Self { written: 1, ..of(Parts::One(Part { tree, bounds: both }), both) }
            }
        }
    }

    /// This set without another one.
    fn without(self, other: Self, Setting { span, style }: Setting) -> Self {
        let (color, bounds) = (self.color, self.bounds);
        let made_of = self.made_of + other.made_of;
        // What is without a union is without each part of it. The cut has the colour of what is cut.
        let cuts = match other.parts {
            Parts::Union { parts, groups } if groups.is_empty() => parts,
            _ => other.part(span).into_iter().collect(),
        };
        let cuts = cuts.into_iter().map(|cut| match color {
            Some(color) => Part { tree: colored(cut.tree, color, span), ..cut },
            None => cut,
        });
        let cuts: Vec<Part> = cuts.collect();
        let groups = match &self.parts {
            Parts::Union { groups, .. } => groups.len() + 1,
            _ => 1,
        };
        let written = self.written + groups * cuts.len();
        if style == LeafStyle::Plain || written > ALWAYS.max(LONGEST * made_of) {
            let written = self.written + cuts.len();
            let mut parts: VecDeque<Part> = match self.parts {
                Parts::Difference(parts) => parts,
                _ => self.part(span).into_iter().collect(),
            };
            parts.extend(cuts);
            // As one tree it is one set for what follows.
            let written = if style == LeafStyle::Plain { written } else { 1 };
            return Self { parts: Parts::Difference(parts), bounds, color, written, made_of };
        }
        let (parts, mut groups) = self.into_union(span);
        if !parts.is_empty() {
            let bounds = parts.iter().fold(Bounds::EMPTY, |all, part| all.hull(part.bounds));
            groups.push(Group { parts, bounds, cuts: Vec::new() });
        }
        let mut written = 0;
        for group in &mut groups {
            let meets = |cut: &&Part| !cut.bounds.intersection(group.bounds).is_empty();
            group.cuts.extend(cuts.iter().filter(meets).map(|cut| Part { tree: copied(&cut.tree), ..*cut }));
            written += group.parts.len() + group.cuts.len();
        }
        Self { parts: Parts::Union { parts: VecDeque::new(), groups }, bounds, color, written, made_of }
    }

    /// What is outside.
    pub(super) fn complement(self, span: Span) -> Self {
        let color = self.color;
        match self.part(span) {
            Some(part) => {
                let tree = placed(part.tree.complement(), span);
                Self::one(Part { tree, bounds: Bounds::EVERYWHERE }, color)
            }
            None => Self::MISSING,
        }
    }
}

impl Group {
    fn tree(self, span: Span) -> Tree {
        let united = |parts: &mut dyn Iterator<Item = Part>| {
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
fn joined(mut left: VecDeque<Part>, mut right: VecDeque<Part>) -> VecDeque<Part> {
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
