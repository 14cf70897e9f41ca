//! What a division leaves: every box that was decided, and the regions of its leaves.

use crate::boxes::{Box3, Range};

/// What became of a box.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Outcome {
    /// It was split: its parts are nodes.
    Split,
    /// It was kept.
    Leaf,
    /// It was done with.
    Stop,
}

/// A box that was decided.
#[derive(Clone, PartialEq, Debug)]
pub struct DivisionNode<D> {
    /// The box.
    pub bounds: Box3,
    /// A range of the field in it, if the decider asked for one.
    pub range: Option<Range>,
    /// What the decider gave it on its way down.
    pub data: D,
    /// What became of it.
    pub outcome: Outcome,
    /// How often a box was split to get here.
    pub depth: u16,
    /// The nodes of its subtree, itself included.
    pub(super) size: u32,
}

/// A divided box: all nodes in the order of a walk down the tree, parts in the order of their split.
#[derive(Clone, PartialEq, Debug)]
pub struct Division<R, D> {
    pub(super) nodes: Vec<DivisionNode<D>>,
    /// Those of the leaves, in order.
    pub(super) regions: Vec<R>,
    pub(super) decisions: u64,
}

/// How many boxes of which outcome.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[non_exhaustive]
pub struct Tally {
    /// Boxes that were split.
    pub splits: u64,
    /// Boxes that were kept.
    pub leaves: u64,
    /// Boxes that were done with.
    pub stops: u64,
    /// The deepest box.
    pub depth: usize,
}

impl<R, D> Division<R, D> {
    /// All boxes.
    #[must_use]
    pub fn nodes(&self) -> &[DivisionNode<D>] {
        &self.nodes
    }

    /// The kept boxes, each with its region.
    pub fn leaves(&self) -> impl Iterator<Item = (&DivisionNode<D>, &R)> {
        self.nodes.iter().filter(|node| node.outcome == Outcome::Leaf).zip(&self.regions)
    }

    /// The kept boxes' regions, in the order of [`leaves`](Self::leaves).
    #[must_use]
    pub fn into_regions(self) -> Vec<R> {
        self.regions
    }

    /// The parts of a node, by index.
    pub fn parts(&self, node: usize) -> impl Iterator<Item = usize> {
        let end = node + self.nodes[node].size as usize;
        let first = (node + 1 < end).then_some(node + 1);
        std::iter::successors(first, move |&part| {
            let next = part + self.nodes[part].size as usize;
            (next < end).then_some(next)
        })
    }

    /// How many decisions it took: one for each box, or after a redivision one for each box that was asked
    /// about again.
    #[must_use]
    pub fn decisions(&self) -> u64 {
        self.decisions
    }

    /// How many boxes of which outcome.
    #[must_use]
    pub fn tally(&self) -> Tally {
        let mut tally = Tally::default();
        for node in &self.nodes {
            match node.outcome {
                Outcome::Split => tally.splits += 1,
                Outcome::Leaf => tally.leaves += 1,
                Outcome::Stop => tally.stops += 1,
            }
            tally.depth = tally.depth.max(usize::from(node.depth));
        }
        tally
    }
}
