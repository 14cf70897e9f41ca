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

#[cfg(test)]
mod tests {
    use super::super::{Pruner, Region};
    use super::*;
    use crate::boxes::Divisible;
    use crate::compiler::Compiler;
    use crate::kernel::Engine;
    use fastrand::Rng;
    use jbt_model::builder::{param, point, segment};
    use jbt_model::model::Model;
    use jbt_model::tree::Tree;

    fn place(rng: &mut Rng) -> [f64; 3] {
        std::array::from_fn(|_| 8.0 * rng.f64() - 4.0)
    }

    fn points(rng: &mut Rng, count: usize) -> Vec<Tree> {
        (0..count).map(|_| point(place(rng), 0.1 + 0.3 * rng.f64())).collect()
    }

    fn pruner(tree: Tree) -> Pruner {
        Pruner::new(&Compiler::for_engine(Engine::Lanes), &Model::new(tree).check().expect("a good model"))
            .expect("it compiles")
    }

    fn small_box(rng: &mut Rng) -> Box3 {
        let low: [f32; 3] = place(rng).map(|side| side as f32);
        Box3::new(low, low.map(|side| side + 0.1 * rng.f32()))
    }

    fn region(pruner: &Pruner, bounds: Box3) -> Region {
        pruner.region(bounds).expect("a region")
    }

    /// Asks so often about small parts that there are trees.
    fn ask(pruner: &Pruner, rng: &mut Rng) {
        (0..=PASSES).for_each(|_| drop(region(pruner, small_box(rng))));
    }

    /// Compares with a pruner that makes passes.
    fn assert_as_passes(pruner: &Pruner, fresh: &Pruner, rng: &mut Rng) {
        let mut found = 0;
        for _ in 0..PASSES - 4 {
            let bounds = small_box(rng);
            let [a, b] = [pruner, fresh].map(|pruner| region(pruner, bounds));
            assert_eq!(a.selection(), b.selection(), "{bounds:?}");
            found += a.rows();
        }
        assert!(found > 100, "{found} rows");
        assert!(trees(fresh).iter().all(|&is_made| !is_made), "it makes passes");
    }

    /// Of which tables there are trees.
    fn trees(pruner: &Pruner) -> Vec<bool> {
        pruner.program.trees.trees.iter().map(|tree| tree.get().is_some()).collect()
    }

    #[test]
    fn questions_about_small_parts_are_counted() {
        let trees = RowTrees::new(0);
        let passes = || trees.passes.load(Ordering::Relaxed);
        trees.note(1600, 101);
        assert_eq!(passes(), 0, "it is not small");
        trees.note(1600, 100);
        assert_eq!(passes(), 1);
        (0..2 * PASSES).for_each(|_| trees.note(1600, 3));
        assert_eq!(passes(), PASSES, "so many are enough");
    }

    #[test]
    fn tables_of_many_rows_have_trees_once_they_pay() {
        for (count, expected) in [(FEWEST_ROWS - 1, false), (FEWEST_ROWS, true)] {
            let mut rng = Rng::with_seed(1);
            let all = points(&mut rng, 5000);
            let segments = (0..count).map(|_| segment(place(&mut rng), place(&mut rng), 0.1));
            let tree = Tree::sum(all.into_iter().chain(segments));
            let [pruner, fresh] = [pruner(tree.clone()), pruner(tree)];
            ask(&pruner, &mut rng);
            let made = trees(&pruner);
            assert_eq!(made.iter().filter(|&&made| made).count(), 1 + usize::from(expected), "{made:?}");
            assert!(!made[0], "the scene is one row");
            assert_as_passes(&pruner, &fresh, &mut rng);
        }
    }

    #[test]
    fn trees_find_the_rows_of_all_owners() {
        let mut rng = Rng::with_seed(2);
        let tree = Tree::union((0..100).map(|_| Tree::sum(points(&mut rng, 60))));
        let [pruner, fresh] = [pruner(tree.clone()), pruner(tree)];
        ask(&pruner, &mut rng);
        assert!(trees(&pruner).contains(&true));
        assert_as_passes(&pruner, &fresh, &mut rng);
    }

    #[test]
    fn trees_follow_edits() {
        let mut rng = Rng::with_seed(3);
        let moved = point([param("x", 0.5), 0.0.into(), 0.0.into()], 3.0);
        let model = Model::new(Tree::sum([moved].into_iter().chain(points(&mut rng, 5000))));
        let tree = model.check().expect("a good model");
        let compiler = Compiler::for_engine(Engine::Lanes);
        let before = Pruner::new(&compiler, &tree).expect("it compiles");
        ask(&before, &mut rng);
        let made = trees(&before);
        assert!(made.contains(&true), "{made:?}");
        let edited = tree.with_parameters(&[("x", -2.0)]).expect("a good number");
        let now = before.updated(&edited).expect("it compiles");
        assert_eq!(trees(&now), made, "an edited model keeps its trees");
        assert_as_passes(&now, &Pruner::new(&compiler, &edited).expect("it compiles"), &mut rng);
    }

    #[test]
    fn of_rows_that_reach_everywhere_those_that_win_are_found() {
        let mut rng = Rng::with_seed(4);
        let places: Vec<[f64; 3]> = (0..FEW + 1000).map(|_| place(&mut rng)).collect();
        let reaching = |strength: f64| places.iter().map(move |&at| point(at, 20.0).strength(strength));
        for tree in [Tree::union(reaching(1.0)), Tree::intersection(reaching(-1.0))] {
            let [pruner, fresh] = [pruner(tree.clone()), pruner(tree)];
            let taken = |pruner: &Pruner, rng: &mut Rng| {
                let before = pruner.counters().interval_evaluations;
                let rows = region(pruner, small_box(rng)).rows();
                assert!(rows < 300, "{rows} rows");
                pruner.counters().interval_evaluations - before
            };
            let passes = taken(&pruner, &mut rng);
            assert!(passes > FEW as u64, "a pass is a range for each row: {passes}");
            ask(&pruner, &mut rng);
            // Where hulls of rows are too wide, a pass is made after all.
            let few = (0..30).filter(|_| taken(&pruner, &mut rng) < passes / 4).count();
            assert!(few >= 10, "{few} of 30 boxes");
            assert_as_passes(&pruner, &fresh, &mut rng);
        }
    }
}
