//! The programs of an edited model, from those of the model before: rows that changed are written anew.
//!
//! ```text
//!   sum of 4,096 ──edit──► sum of 4,096, one of them changed
//!                               └─► the same sum of a few: the changed one, and a few of each table
//!                                     └─ lowered: the same function? then its rows are the changed rows
//! ```
//!
//! Children of an operator that differ in numbers alone are rows of a table, so a model with fewer of them
//! has the same code, and a row of it has the numbers that it has in the whole. Whether the code is the same
//! is not guessed but compared, and so are the nodes behind the rows. Where anything differs, the edited
//! model is lowered as a whole, when it is asked for.

use std::ops::RangeInclusive;
use std::sync::Arc;

use jbt_ir::{Entity as _, Function, Table, Tables, watch};
use jbt_lower::prune_info::{PruneInfo, Support};
use jbt_lower::{Lowered, Lowering, RangeFunction};
use jbt_model::check::{CheckedTree, NodeId};
use jbt_model::kind::NodeKind;

use crate::compiler::Compiler;
use crate::program::{AnswerProgram, ModelProgram as _};
use crate::prune::program::RangeProgram;

/// The rows of each table that stay in the small model.
const ROWS_KEPT: usize = 3;
/// The small model has at most one child in so many.
const LEAST_PART: usize = 2;
/// The table of the one row in which everything else stands.
const SCENE: usize = 0;

/// The edit of a model, as one of some children of its topmost operator.
struct ChildrenEdit {
    /// The small model.
    small: CheckedTree,
    /// The node of the whole model behind each of its nodes.
    whole: Vec<NodeId>,
    /// The nodes of the changed children, ascending.
    changed: Vec<RangeInclusive<NodeId>>,
}

/// Rows that changed.
struct ChangedRows {
    /// By table: rows of the whole model, and of the small one.
    pairs: Vec<Vec<(usize, usize)>>,
}

/// The programs of a model that are there.
pub(super) struct PresentPrograms<'a> {
    pub(super) tree: &'a CheckedTree,
    pub(super) ranges: Option<&'a Arc<RangeProgram>>,
    /// Those for regions.
    pub(super) answers: Vec<&'a Arc<AnswerProgram>>,
}

/// The same programs of an edited model.
pub(super) struct PatchedPrograms {
    pub(super) ranges: RangeProgram,
    pub(super) answers: Vec<AnswerProgram>,
}

/// The programs of a model in which these nodes have changed; `None` if it has to be lowered as a whole.
pub(super) fn patch(
    before: &PresentPrograms<'_>,
    (compiler, edited): (&Compiler, &CheckedTree),
    changed: &[NodeId],
) -> Option<PatchedPrograms> {
    let old = before.ranges?;
    let edit = ChildrenEdit::new(before.tree, edited, changed, old)?;
    let lowering = Lowering::new(&edit.small);
    let RangeFunction { function, tables, info } = lowering.ranges().ok()?;
    if function != old.kernel().lowered {
        return None;
    }
    let rows = edit.rows(old.info(), &info, (old.tables(), &tables))?;
    let numbers = rows.written(&function, old.tables(), &tables);
    let mut answers = Vec::with_capacity(before.answers.len());
    for present in &before.answers {
        let Lowered { function, tables } = lowering.answers(present.query).ok()?;
        if function != present.bound.kernel.lowered {
            return None;
        }
        let numbers = rows.written(&function, present.bound.tables(), &tables);
        let bound = compiler.bind(&present.bound.kernel, numbers);
        answers.push(AnswerProgram::new(edited, present.query, bound));
    }
    compiler.count_patched();
    Some(PatchedPrograms { ranges: old.patched(compiler, numbers, &rows.supports(&info)), answers })
}

impl ChildrenEdit {
    fn new(
        before: &CheckedTree,
        edited: &CheckedTree,
        changed: &[NodeId],
        old: &RangeProgram,
    ) -> Option<Self> {
        let is_shared = edited.uses().iter().any(|&uses| uses != 1);
        // Columns of this name count operands. They are kept, so nothing else may be called like them.
        let is_unclear = edited.attributes().iter().any(|group| group.name.starts_with(ORDER));
        if is_shared || is_unclear {
            return None;
        }
        let root = topmost(edited)?;
        let children = &edited.node(root).children;
        let place = |id: NodeId| children.partition_point(|&child| child < id);
        let first = |place: usize| if place == 0 { NodeId(0) } else { NodeId(children[place - 1].0 + 1) };
        let (below, above) = changed.split_at(changed.partition_point(|&id| id < root));
        if above.iter().any(|&id| !is_same(before, edited, id)) {
            return None;
        }
        let mut places: Vec<usize> = below.iter().map(|&id| place(id)).collect();
        places.dedup();
        let changed: Vec<_> = places.iter().map(|&place| first(place)..=children[place]).collect();
        let selects = |id: u32| matches!(edited.node(NodeId(id)).kind, NodeKind::Select(_));
        if changed.iter().any(|nodes| (nodes.start().0..=nodes.end().0).any(selects)) {
            return None;
        }
        places.extend(kept_nodes(old, root)?.into_iter().map(place));
        places.sort_unstable();
        places.dedup();
        if places.len() * LEAST_PART > children.len() {
            return None;
        }
        let (small, whole) = edited.with_fewer_children(root, &places);
        Some(Self { small, whole, changed })
    }

    /// The changed rows, if rows of both models stand for the same nodes.
    fn rows(&self, old: &PruneInfo, small: &PruneInfo, (was, is): (&Tables, &Tables)) -> Option<ChangedRows> {
        let has = |node: NodeId| {
            let place = self.changed.partition_point(|nodes| *nodes.end() < node);
            self.changed.get(place).is_some_and(|nodes| nodes.contains(&node))
        };
        let mut pairs = Vec::with_capacity(old.tables.len());
        for (table, info) in old.tables.iter() {
            let now = &small.tables.get(table)?.nodes;
            let mut mine = now.iter().enumerate().map(|(row, node)| (row, self.whole[node.0 as usize]));
            if table.index() == SCENE {
                // What stands in the one row is in both.
                let slots = is.tables[table].nodes.iter().map(|&node| self.whole[node as usize].0);
                if now.len() != 1 || !slots.eq(was.tables[table].nodes.iter().copied()) {
                    return None;
                }
                pairs.push(vec![(0, 0)]);
                continue;
            }
            let mut rows = Vec::new();
            for (row, &node) in info.nodes.iter().enumerate().filter(|&(_, &node)| has(node)) {
                let (other, other_node) = mine.by_ref().find(|&(_, node)| has(node))?;
                if other_node != node {
                    return None;
                }
                rows.push((row, other));
            }
            if mine.any(|(_, node)| has(node)) {
                return None;
            }
            pairs.push(rows);
        }
        Some(ChangedRows { pairs })
    }
}

/// The first operator from the root on with several children, of which each can do without the others.
fn topmost(tree: &CheckedTree) -> Option<NodeId> {
    let mut id = tree.root();
    loop {
        let node = tree.node(id);
        match (&node.kind, &node.children[..]) {
            (NodeKind::Combine(_), [_, _, ..]) => return Some(id),
            (_, [only]) => id = *only,
            _ => return None,
        }
    }
}

/// Whether a node is as it was, to the sign of zeros.
fn is_same(before: &CheckedTree, edited: &CheckedTree, id: NodeId) -> bool {
    let [was, is] = [before, edited].map(|tree| &tree.node(id).kind);
    was == is && format!("{was:?}") == format!("{is:?}")
}

/// Nodes whose rows the small model has to have, for its code to be that of the whole. `None` if a row
/// depends on all children.
fn kept_nodes(old: &RangeProgram, root: NodeId) -> Option<Vec<NodeId>> {
    let mut kept = Vec::new();
    for (table, info) in old.info().tables.iter() {
        if table.index() == SCENE {
            kept.extend(old.tables().tables[table].nodes.iter().map(|&node| NodeId(node)));
            continue;
        }
        if info.nodes.iter().any(|&node| node >= root) {
            return None;
        }
        kept.extend(info.nodes.iter().take(ROWS_KEPT));
    }
    kept.retain(|&node| node < root);
    Some(kept)
}

/// What the columns are called that count operands.
const ORDER: &str = "order";

impl ChangedRows {
    /// The numbers of the whole model, with those of changed rows.
    fn written(&self, function: &Function, old: &Tables, small: &Tables) -> Tables {
        watch::take(old.tables.values().map(|rows| size_of_val(&*rows.numbers)).sum::<usize>());
        let mut tables = old.clone();
        for (index, pairs) in self.pairs.iter().enumerate() {
            let table = Table::new(index);
            let columns = &function.tables[table].columns;
            let (rows, from) = (&mut tables.tables[table], &small.tables[table]);
            for &(row, other) in pairs {
                let numbers = &mut rows.numbers[row * rows.stride..][..rows.stride];
                for ((number, &new), name) in numbers.iter_mut().zip(from.row(other)).zip(columns) {
                    if !name.starts_with(ORDER) {
                        *number = new;
                    }
                }
            }
        }
        tables
    }

    /// The supports of changed rows. That of the scene is not known from a part of it.
    fn supports(&self, small: &PruneInfo) -> Vec<(Table, usize, Support)> {
        let of_table = |(index, pairs): (usize, &Vec<(usize, usize)>)| {
            let table = Table::new(index);
            let support = move |row: usize| {
                if index == SCENE { Support::EVERYWHERE } else { small.tables[table].supports[row] }
            };
            pairs.iter().map(move |&(row, other)| (table, row, support(other))).collect::<Vec<_>>()
        };
        self.pairs.iter().enumerate().flat_map(of_table).collect()
    }
}
