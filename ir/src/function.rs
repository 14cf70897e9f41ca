//! A function: inputs and outputs are named planes, the body is SSA with one structured loop, the [`Fold`].
//!
//! ```text
//! function "sum" (x, y, z) -> (field) {
//!     table t0 "point" (tx, ty, tz, neg_inv_r2) slots (0)
//! block0:
//!     v0 = input x
//!     ...
//!     v3 = const 0.0
//!     v4 = fold t0 rows neutral (v3) block1(v5):
//!         v6 = column t0.tx @0.position
//!         v7 = sub v0, v6 @0.position
//!         ...
//!         yield v20
//!     yield v4
//! }
//! ```
//!
//! [`crate::text`] defines this form.
//!
//! There are no calls, traps or stores. A fold runs its body once for each *active row* of a table, in
//! ascending row order; the body sees the row's columns (the same in all lanes), every value of the enclosing
//! blocks, and the accumulators. If the table has a parent, the fold stands in the parent's body and runs
//! over the rows that the parent's current row owns.

use std::sync::Arc;

use crate::entity::{Block, Entity, Inst, Results, Store, Table, Value, Values};
use crate::op::{Op, Type};
use crate::origin::Origin;
use crate::watch;

/// The meaning of the rows of a fold.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum FoldKind {
    /// Operands of one operator: any number of them.
    Rows,
    /// One row, or none: an operand under a guard, or the choice of a selector. With a row, the fold yields
    /// the row's answer; without one, its initial values.
    Guard,
    /// The pieces of one leaf.
    Pieces,
}

impl FoldKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Rows, Self::Guard, Self::Pieces];

    /// The name in the text form.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rows => "rows",
            Self::Guard => "guard",
            Self::Pieces => "pieces",
        }
    }
}

/// Which rows of a fold may be left out in a region of space where their fields are zero, without changing a
/// bit of an answer.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Rule {
    /// All zero rows may be left out: rows of sums, of Ricci blends, of unions without negative operands and
    /// of selectors, guards that start at 0, and pieces whose distance counts within the support radius only.
    Neutral,
    /// The first zero row of each parent row stays, the other zero rows may be left out: rows of unions and
    /// intersections with negative operands, and of steps whose result one zero limits for good.
    KeepOne,
    /// If a row is zero, all other rows of the same parent row may be left out, zero or not; one zero row
    /// stays. Rows of intersections without negative operands, of products and of Ricci blends with negative
    /// exponents: where these are 0, they have no slope, even if one that is left out has one.
    OnlyZero,
    /// A zero row may not be left out: the scene, guards that do not start at 0, points inside of warps,
    /// R-functions, rows that may answer for the whole model, and pieces that count everywhere.
    Never,
}

impl Rule {
    /// All rules.
    pub const ALL: [Self; 4] = [Self::Neutral, Self::KeepOne, Self::OnlyZero, Self::Never];

    /// The name in the text form.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Neutral => "neutral",
            Self::KeepOne => "keep_one",
            Self::OnlyZero => "only_zero",
            Self::Never => "never",
        }
    }
}

/// The columns of a table, and where it hangs.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Schema {
    /// The shape of its rows, for people.
    pub name: String,
    /// Column names, for people; a column is named by its index.
    pub columns: Vec<String>,
    /// The table whose rows own ranges of this one.
    pub parent: Option<Table>,
    /// The leaf slots (see [`crate::origin`]) that one row fills, in the order of
    /// [`crate::table::Rows::nodes`].
    pub slots: Vec<u32>,
}

/// The loop over the active rows of a table.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Fold {
    /// The table.
    pub table: Table,
    /// What its rows are.
    pub kind: FoldKind,
    /// What may be done with rows that are zero.
    pub rule: Rule,
    /// Accumulators before the first row.
    pub initial: Values,
    /// The body: its parameters are the accumulators, its results their next values.
    pub body: Block,
}

/// What an instruction does.
#[derive(Clone, PartialEq, Debug)]
pub enum InstKind {
    /// Reads the input plane with this index.
    Input(usize),
    /// The same number in every lane. Constants are told apart by their bits.
    Constant(f32),
    /// The same bits in every lane.
    BitsConstant(u32),
    /// A column of the current row of a table whose fold encloses this.
    Column {
        /// The table.
        table: Table,
        /// The index of the column.
        column: usize,
    },
    /// An op on one to three values.
    Op {
        /// The op.
        op: Op,
        /// Its operands.
        args: Values,
    },
    /// The loop over a table. There are few of them, and there may be a million instructions.
    Fold(Box<Fold>),
}

impl InstKind {
    /// Whether it computes nothing: an input, a constant or a column.
    #[must_use]
    pub const fn is_leaf(&self) -> bool {
        match self {
            Self::Input(_) | Self::Constant(_) | Self::BitsConstant(_) | Self::Column { .. } => true,
            Self::Op { .. } | Self::Fold(_) => false,
        }
    }

    /// The type of the result. For a fold this is only the usual type: accumulators have the types of their
    /// initial values.
    #[must_use]
    pub const fn result_type(&self) -> Type {
        match self {
            Self::Input(_) | Self::Constant(_) | Self::Column { .. } | Self::Fold(_) => Type::Real,
            Self::BitsConstant(_) => Type::Bits,
            Self::Op { op, .. } => op.result(),
        }
    }
}

/// An instruction.
#[derive(Clone, PartialEq, Debug)]
pub struct InstData {
    /// What it does.
    pub kind: InstKind,
    /// What it defines: one value, or the final accumulators of a fold.
    pub results: Results,
    /// Where it comes from.
    pub origin: Origin,
}

/// A list of instructions.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct BlockData {
    /// What the block binds: the accumulators of a fold; nothing for the function's body.
    pub params: Values,
    /// Its instructions, in order of execution.
    pub insts: Vec<Inst>,
    /// What it yields: the next accumulators, or the function's outputs.
    pub results: Values,
}

/// A program: points in, answers out.
#[derive(Clone, PartialEq, Debug)]
pub struct Function {
    /// A name for people.
    pub name: String,
    /// Names of the input planes.
    pub inputs: Vec<String>,
    /// Names of the output planes, in the order of the body's results.
    pub outputs: Vec<String>,
    /// The tables that it folds. Its rewrites share them.
    pub tables: Arc<Store<Table, Schema>>,
    /// The type of every value.
    pub values: Store<Value, Type>,
    /// All instructions.
    pub insts: Store<Inst, InstData>,
    /// All blocks.
    pub blocks: Store<Block, BlockData>,
    /// The body.
    pub body: Block,
}

impl Function {
    /// A copy: stops the work here if there is no memory for it. See [`watch::take`].
    #[must_use]
    pub fn copied(&self) -> Self {
        let each = size_of::<InstData>() + size_of::<Inst>();
        watch::take(self.values.len() * size_of::<Type>() + self.insts.len() * each);
        let mut insts = Store::new();
        insts.reserve(self.insts.len());
        for data in self.insts.values() {
            watch::look();
            insts.push(data.clone());
        }
        let Self { name, inputs, outputs, tables, values, insts: _, blocks, body } = self;
        let (name, inputs, outputs) = (name.clone(), inputs.clone(), outputs.clone());
        let (tables, values, blocks) = (Arc::clone(tables), values.clone(), blocks.clone());
        Self { name, inputs, outputs, tables, values, insts, blocks, body: *body }
    }

    /// A function without instructions.
    #[must_use]
    pub fn new(name: &str, inputs: &[&str]) -> Self {
        let mut blocks = Store::new();
        let body = blocks.push(BlockData::default());
        Self {
            name: name.to_owned(),
            inputs: inputs.iter().map(|&input| input.to_owned()).collect(),
            outputs: Vec::new(),
            tables: Arc::default(),
            values: Store::new(),
            insts: Store::new(),
            blocks,
            body,
        }
    }

    /// The values that an instruction reads in its own block: operands, or a fold's initial accumulators.
    #[must_use]
    pub fn operands(&self, inst: Inst) -> &[Value] {
        match &self.insts[inst].kind {
            InstKind::Input(_)
            | InstKind::Constant(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. } => &[],
            InstKind::Op { args, .. } => args,
            InstKind::Fold(fold) => &fold.initial,
        }
    }

    /// The fold over each table, by table. `None` where a table is not folded.
    #[must_use]
    pub fn folds(&self) -> Vec<Option<Inst>> {
        let mut folds = vec![None; self.tables.len()];
        for (inst, data) in self.insts.iter() {
            if let InstKind::Fold(fold) = &data.kind {
                folds[fold.table.index()] = Some(inst);
            }
        }
        folds
    }

    /// The position of the output plane with this name.
    #[must_use]
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|output| output == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// There may be a million of them, in several programs at once.
    #[test]
    fn instructions_and_names_are_small() {
        assert!(size_of::<InstData>() <= 64, "{}", size_of::<InstData>());
        assert_eq!(size_of::<Option<Value>>(), size_of::<u32>());
        assert_eq!(size_of::<Option<Inst>>(), size_of::<u32>());
    }
}
