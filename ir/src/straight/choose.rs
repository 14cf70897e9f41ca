//! Which tables become straight code.

use crate::entity::{Entity, Table};
use crate::function::{FoldKind, Function, InstKind};
use crate::table::{Rows, Tables};

/// Rows of one table that may become straight code, under one row of its parent.
const MAX_ROWS: usize = 64;
/// Which tables become straight code.
pub(super) struct Chosen {
    pub(super) root: Table,
    /// By table.
    pub(super) straight: Vec<bool>,
}

impl Chosen {
    /// `None` if no table does.
    pub(super) fn new(function: &Function, tables: &Tables) -> Option<Self> {
        let root = Table::new(0);
        let count = function.tables.len();
        if count == 0 || tables.tables[root].active.len() != 1 {
            return None;
        }
        let mut leaves = vec![false; count];
        // Parents come before their children.
        for (table, schema) in function.tables.iter().collect::<Vec<_>>().into_iter().rev() {
            leaves[table.index()] |= !schema.slots.is_empty();
            if let Some(parent) = schema.parent {
                leaves[parent.index()] |= leaves[table.index()];
            }
        }
        let is_whole = |rows: &Rows| rows.active.len() == rows.len();
        // Rows of selectors come and go.
        let chooses = !tables.tables.values().all(is_whole);
        let mut kinds = vec![FoldKind::Rows; count];
        for data in function.insts.values() {
            if let InstKind::Fold(fold) = &data.kind {
                kinds[fold.table.index()] = fold.kind;
            }
        }
        let mut straight = vec![false; count];
        for (table, schema) in function.tables.iter() {
            let Some(parent) = schema.parent else { continue };
            let rows = &tables.tables[table];
            let few = rows.starts.windows(2).all(|pair| (pair[1] - pair[0]) as usize <= MAX_ROWS);
            let stays = chooses && kinds[table.index()] == FoldKind::Guard;
            straight[table.index()] = (parent == root || straight[parent.index()])
                && !leaves[table.index()]
                && is_whole(rows)
                && few
                && !stays
                && kinds[table.index()] != FoldKind::Pieces;
        }
        straight.iter().any(|&it| it).then_some(Self { root, straight })
    }
}
