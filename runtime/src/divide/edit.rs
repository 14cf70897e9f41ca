//! Where a model has changed.

use std::sync::atomic::AtomicU64;

use jbt_ir::watch;

use super::decide::Decide;
use super::node::{Division, Outcome};
use super::run::{DivideError, DivisionRun, Limits, Previous, Subtree};
use crate::boxes::{Box3, Divisible, MAX_PARTS};

/// The part of space in which an edited model may differ from what it was.
#[derive(Clone, PartialEq, Debug)]
pub enum Edit {
    /// In these boxes; nowhere, if there are none.
    Boxes(Vec<Box3>),
    /// Anywhere.
    Everywhere,
}

impl Edit {
    /// Whether the model may differ somewhere in a box.
    #[must_use]
    pub fn touches(&self, bounds: &Box3) -> bool {
        match self {
            Self::Boxes(boxes) => boxes.iter().any(|changed| changed.meets(bounds)),
            Self::Everywhere => true,
        }
    }

    /// The part of space in which either edit may make a difference.
    pub(crate) fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Boxes(boxes), Self::Boxes(others)) if boxes == others => Self::Boxes(boxes),
            (Self::Boxes(mut boxes), Self::Boxes(others)) => {
                watch::take_for(&boxes, others.len());
                boxes.extend(others);
                Self::Boxes(boxes)
            }
            (Self::Everywhere, _) | (_, Self::Everywhere) => Self::Everywhere,
        }
    }
}

/// A division before an edit.
struct Before<'a, R, D> {
    division: &'a Division<R, D>,
    edit: &'a Edit,
    /// For each node, how many leaves come before it; and all leaves.
    leaves: Vec<u32>,
    /// The region of a box that the edit does not touch, as it is now.
    renew: &'a (dyn Fn(&R) -> R + Sync),
}

impl<R: Sync, D: Clone + PartialEq + Sync> Previous<R, D> for Before<'_, R, D> {
    fn untouched(&self, node: usize) -> Option<Subtree<R, D>> {
        let nodes = &self.division.nodes[node..][..self.division.nodes[node].size as usize];
        if self.edit.touches(&nodes[0].bounds) {
            return None;
        }
        let [first, end] = [node, node + nodes.len()].map(|node| self.leaves[node] as usize);
        watch::take(size_of_val(nodes) + (end - first) * size_of::<R>());
        let regions = self.division.regions[first..end].iter().map(self.renew).collect();
        Some(Subtree { nodes: nodes.to_vec(), regions })
    }

    fn parts(&self, node: usize, boxes: &[Box3], data: &[D]) -> Option<[usize; MAX_PARTS]> {
        let mut parts = [0; MAX_PARTS];
        let mut count = 0;
        for (place, part) in self.division.parts(node).enumerate() {
            let old = &self.division.nodes[part];
            if boxes.get(place) != Some(&old.bounds) || data[place] != old.data {
                return None;
            }
            parts[place] = part;
            count += 1;
        }
        (count == boxes.len()).then_some(parts)
    }
}

impl<R: Send + Sync, D: Clone + PartialEq + Send + Sync> Division<R, D> {
    /// The division of an edited model: boxes that the edit does not touch, and whose split is as before, are
    /// not asked about again.
    ///
    /// `field` is the edited model, `edit` says where it differs from the one that was divided
    /// ([`Pruner::edit`](crate::Pruner::edit)), and `renew` makes the region of an untouched box from what it
    /// was (its rows may have other numbers now: [`Pruner::renewed`](crate::Pruner::renewed)). The rest is as
    /// in [`divide`](super::divide), and so is the answer, if `decide` depends on the cell and the data
    /// alone.
    ///
    /// # Errors
    /// Those of [`divide`](super::divide).
    pub fn redivide<F: Divisible<Region = R>>(
        &self,
        field: &F,
        edit: &Edit,
        renew: &(dyn Fn(&R) -> R + Sync),
        limits: &Limits,
        decide: &Decide<'_, F, D>,
    ) -> Result<Self, DivideError<F::Error>> {
        let work = || self.divided_again((field, renew), edit, limits, decide);
        watch::guarded_once(work).unwrap_or_else(|error| Err(error.into()))
    }

    fn divided_again<F: Divisible<Region = R>>(
        &self,
        (field, renew): (&F, &(dyn Fn(&R) -> R + Sync)),
        edit: &Edit,
        limits: &Limits,
        decide: &Decide<'_, F, D>,
    ) -> Result<Self, DivideError<F::Error>> {
        watch::take((self.nodes.len() + 1) * size_of::<u32>());
        let mut leaves = Vec::with_capacity(self.nodes.len() + 1);
        let mut count = 0;
        for node in &self.nodes {
            leaves.push(count);
            count += u32::from(node.outcome == Outcome::Leaf);
        }
        leaves.push(count);
        let before = Before { division: self, edit, leaves, renew };
        let boxes = AtomicU64::new(0);
        let run = DivisionRun { field, limits: limits.capped(), decide, boxes, previous: Some(&before) };
        let root = &self.nodes[0];
        run.start(root.bounds, root.data.clone())
    }
}
