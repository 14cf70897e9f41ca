//! The function as one list: every instruction, loop and store in the order of the code.
//!
//! ```text
//! open points                      once for each block of points
//!   n3 = mul n0, n1                    a name for each value
//!   open rows t0: n5 = phi(n4, n9)     a fold; after it n5 is its result
//!     skip n7                            the next row, if n7 is 0 in all lanes
//!     n9 = fma n7, n3, n5
//!   close rows
//!   output 0, n5
//! close points
//! ```
//!
//! *Leaves* (constants, columns, inputs, values kept by other pieces) are not in the list. They have a home
//! in memory, where instructions read them. Ops that change no bit (`stop_gradient`, `to_bits`, `from_bits`)
//! are not in the list either: their result has the name of their operand.

use jbt_ir::plan::Slot;
use jbt_ir::{Op, Table};

/// A value of the list.
pub(crate) type ValueName = u32;

/// A loop of the list.
pub(crate) type LoopId = u32;

/// No name, loop or position.
pub(crate) const NONE: u32 = u32::MAX;

/// Where memory holds a leaf.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Home {
    /// Among the constants.
    Number(u32),
    /// In the current row of a table.
    Column(Table, usize),
    /// In the current block of points of an input plane.
    Input(usize),
    /// In the current block of points of a slot.
    Slot(Slot),
}

/// The definition of a name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Definition {
    Leaf(Home),
    /// Computed by one item.
    Computed,
    /// An accumulator: defined by a loop, set again at the end of each iteration, and the loop's result.
    Phi(LoopId),
}

/// A value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Data {
    pub(crate) kind: Definition,
    /// Whether all lanes have the same number.
    pub(crate) is_uniform: bool,
    pub(crate) is_mask: bool,
    /// The innermost loop that changes it: outside of this loop it is undefined. For a phi, the loop around
    /// its own loop.
    pub(crate) scope: LoopId,
}

/// An item of the list.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LinearItem {
    Op {
        op: Op,
        to: ValueName,
        args: [ValueName; 3],
    },
    /// Copies a leaf now, because its home will be overwritten.
    Read {
        to: ValueName,
        from: ValueName,
    },
    Keep {
        slot: Slot,
        value: ValueName,
    },
    Output {
        plane: usize,
        value: ValueName,
    },
    /// Continues with the next iteration of the innermost loop if the values of the loop's gate have the
    /// gate's bits in all lanes.
    Skip(LoopId),
    Open(LoopId),
    Close(LoopId),
}

/// An accumulator of a loop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Phi {
    pub(crate) value: ValueName,
    pub(crate) initial: ValueName,
    pub(crate) next: ValueName,
}

/// What a loop iterates over.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Over {
    /// Strips of points.
    Strips,
    /// Blocks of points.
    Points,
    /// Rows of a table, with points inside.
    RowsOfStrip(Table),
    /// Rows of a table, for one block of points.
    Rows(Table),
    /// Rows of a table, usually one or none.
    Guard(Table),
}

impl Over {
    /// The table of a loop over rows.
    pub(crate) fn table(self) -> Option<Table> {
        match self {
            Self::Strips | Self::Points => None,
            Self::RowsOfStrip(table) | Self::Rows(table) | Self::Guard(table) => Some(table),
        }
    }
}

/// A loop.
#[derive(Debug)]
pub(crate) struct LinearLoop {
    pub(crate) over: Over,
    /// The loop around it, or [`NONE`].
    pub(crate) parent: LoopId,
    /// Positions of its items.
    pub(crate) open: u32,
    pub(crate) close: u32,
    pub(crate) phis: Vec<Phi>,
    /// For a loop over points: the input planes that it reads, a bit each, for the first [`POINTERS`] planes.
    pub(crate) inputs: u32,
    /// If an iteration may end early: the condition for it, values and their bits.
    pub(crate) gate: Vec<(ValueName, u32)>,
}

/// The number of input planes whose address in the current block of points has a register.
pub(crate) const POINTERS: usize = 3;

/// The list.
#[derive(Debug, Default)]
pub(crate) struct LinearCode {
    pub(crate) items: Vec<LinearItem>,
    pub(crate) loops: Vec<LinearLoop>,
    pub(crate) names: Vec<Data>,
    /// The depth of nested folds.
    pub(crate) depth: usize,
}

impl LinearCode {
    /// The loops from `from` outwards, up to but without `to`.
    pub(crate) fn outwards(&self, from: LoopId, to: LoopId) -> impl Iterator<Item = LoopId> {
        let mut next = from;
        std::iter::from_fn(move || {
            let this = next;
            if this == to || this == NONE {
                return None;
            }
            next = self.loops[this as usize].parent;
            Some(this)
        })
    }
}
