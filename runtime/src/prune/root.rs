//! The rows that reach one box, of all rows of a model.
//!
//! Whoever divides space asks once about all of it, and then goes from region to region, each of which knows
//! its rows. Rays, points and small parts begin with all rows again and again. So after many questions about
//! small parts there is a tree over the rows ([`RowTree`]), and such a question costs what it finds. A model
//! of which nobody asks that never pays for a tree; an edited one keeps it.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use jbt_ir::{Entity as _, Selection, Table, watch};
use jbt_lower::prune_info::{PruneInfo, Rule, SupportSpace};

use super::cull::{Boxes, RowSupports};
use super::rule;
use super::tree::RowTree;
use crate::boxes::Box3;
use crate::error::EvalError;

/// Tables of fewer rows have no tree.
const FEWEST_ROWS: usize = 1024;
/// So few rows that reach a part are looked at as they are. Of more, a contest may leave most out.
const FEW: usize = 4096;
/// A part is small if at most one of so many rows reaches it.
const SMALL: usize = 16;
/// After so many passes for small parts a tree is made. Of a million rows it takes as long as 65 passes
/// (0.3 s), so nobody pays more than twice what passes alone would have taken.
const PASSES: usize = 64;
/// With more edits at once a new tree is made when it is wanted.
const MOST_REFITTED: usize = 64;

/// The trees over the rows of a model.
pub(super) struct RowTrees {
    /// By table.
    trees: Vec<OnceLock<RowTree>>,
    /// How many passes over all rows have been made for small parts.
    passes: AtomicUsize,
}

/// Rows that may be left out by their supports: what is known of them, and their supports, by table.
#[derive(Clone, Copy)]
pub(super) struct BoundedRows<'a> {
    pub(super) all: &'a Selection,
    pub(super) info: &'a PruneInfo,
    /// `None` where rows are not left out by their supports.
    pub(super) supports: &'a [Option<RowSupports>],
}

impl BoundedRows<'_> {
    /// The supports of a table in the world, if rows may be left out by them.
    fn in_world(&self, table: Table) -> Option<&RowSupports> {
        match self.info.tables[table].space {
            SupportSpace::World => self.supports[table.index()].as_ref(),
            SupportSpace::Probed(_) | SupportSpace::Unknown => None,
        }
    }
}

impl RowTrees {
    pub(super) fn new(tables: usize) -> Self {
        Self { trees: (0..tables).map(|_| OnceLock::new()).collect(), passes: AtomicUsize::new(0) }
    }

    /// A question about a part has been answered with so many of all rows.
    pub(super) fn note(&self, all: usize, found: usize) {
        if found <= all / SMALL && self.passes.load(Ordering::Relaxed) < PASSES {
            self.passes.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// The rows whose supports in the world reach a box, and what rules keep of the others. `winners` are the
    /// positions of those of a table that may win a contest, if a tree tells.
    pub(super) fn reaching(
        &self,
        rows: BoundedRows<'_>,
        bounds: &Box3,
        winners: &mut dyn FnMut(Table) -> Result<Option<Vec<u32>>, EvalError>,
    ) -> Result<Selection, EvalError> {
        let all = rows.all;
        let boxes = Boxes::new(&[*bounds]);
        let pays = self.passes.load(Ordering::Relaxed) >= PASSES && !boxes.are_far();
        let reaches = |supports: &RowSupports, active: &[u32], position: u32| {
            supports.reach(active[position as usize], &boxes) != 0
        };
        let mut listed = |table: Table| {
            let Some(supports) = rows.in_world(table) else { return Ok(None) };
            let active = all.active(table);
            if !pays || active.len() < FEWEST_ROWS {
                return Ok(None);
            }
            let may_lose = match rows.info.tables[table].rule {
                Rule::Neutral | Rule::KeepOne => true,
                // Here a row that is not listed would count as zero, and leave the others out.
                Rule::Never | Rule::OnlyZero => false,
            };
            let place = &self.trees[table.index()];
            let tree = match place.get() {
                Some(tree) => tree,
                // Made outside of the lock: while it is made, this thread may take work that asks for it.
                None => {
                    let made = watch::stoppable(|| RowTree::new(supports, active))?;
                    place.get_or_init(|| made)
                }
            };
            let most = active.len() / 8;
            let reached = |most| tree.reached(bounds, most, |position| reaches(supports, active, position));
            if let Some(positions) = reached(most.min(FEW)) {
                return Ok(Some(positions));
            }
            if let Some(mut positions) = if may_lose { winners(table)? } else { None } {
                positions.retain(|&position| reaches(supports, active, position));
                return Ok(Some(positions));
            }
            Ok(reached(most))
        };
        let lists: Result<Vec<Option<Vec<u32>>>, EvalError> =
            (0..all.tables()).map(|table| listed(Table::new(table))).collect();
        let lists = lists?;
        let selection = all.picked(|table, owned, stay| {
            let Some(supports) = rows.in_world(table) else {
                stay.extend(owned);
                return;
            };
            let before = stay.len();
            match &lists[table.index()] {
                Some(list) => {
                    let first = list.partition_point(|&position| position < owned.start);
                    stay.extend(list[first..].iter().take_while(|&&position| position < owned.end));
                }
                None => {
                    let active = all.active(table);
                    stay.extend(owned.clone().filter(|&position| reaches(supports, active, position)));
                }
            }
            rule::complete(rows.info.tables[table].rule, owned, before, stay);
        });
        Ok(selection)
    }

    /// The trees for a program with the same rows, some of which have other supports.
    pub(super) fn refitted(
        &self,
        [before, now]: [BoundedRows<'_>; 2],
        changed: impl ExactSizeIterator<Item = (Table, usize)> + Clone,
    ) -> Self {
        let trees = Self::new(self.trees.len());
        if changed.len() > MOST_REFITTED {
            return trees;
        }
        trees.passes.store(self.passes.load(Ordering::Relaxed), Ordering::Relaxed);
        for table in now.info.tables.keys() {
            let (tree, active) = (self.trees[table.index()].get(), now.all.active(table));
            let Some((tree, supports)) = tree.zip(now.supports[table.index()].as_ref()) else { continue };
            if active != before.all.active(table) {
                continue;
            }
            let mut tree = tree.clone();
            for (_, row) in changed.clone().filter(|&(it, _)| it == table) {
                let position = active.iter().position(|&it| it as usize == row);
                position.into_iter().for_each(|position| tree.refit(position as u32, supports, active));
            }
            // The lock is new.
            let _ = trees.trees[table.index()].set(tree);
        }
        trees
    }
}
