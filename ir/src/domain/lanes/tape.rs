//! The compiled form of a function for the lanes interpreter, and the memory of a run.

use crate::entity::Table;
use crate::op::Op;
use crate::watch;

use super::ops::{Chunk, WIDTH};
use super::pairs::{FusedPair, MOST_OPERANDS};
use super::place::ScratchPlace;

/// A function that is ready to run on blocks of points. It never changes, so threads may share it, each with
/// its own [`Scratch`].
///
/// ```
/// use jbt_ir::domain::lanes::{Scratch, Tape};
/// use jbt_ir::{Domain, FunctionBuilder, Selection, Tables, verify};
///
/// let mut b = FunctionBuilder::new("square", &["x"]);
/// let x = b.input(0);
/// let square = b.mul(x, x);
/// let function = b.finish(&[("field".to_owned(), square)]);
/// let tape = Tape::new(&verify(function).unwrap()).unwrap();
///
/// let mut field = [0.0; 3];
/// let (x, mut scratch) = ([1.0, 2.0, 3.0], Scratch::new());
/// tape.run((&Tables::default(), &Selection::default()), &[&x], &mut [&mut field], &mut scratch).unwrap();
/// assert_eq!(field, [1.0, 4.0, 9.0]);
/// ```
#[derive(Clone, Debug)]
pub struct Tape {
    /// Number of input planes.
    pub(super) inputs: usize,
    /// The place that each output plane is copied from.
    pub(super) outputs: Vec<ScratchPlace>,
    /// The program.
    pub(super) steps: Vec<Step>,
    /// The ops, in the order of the steps that run them.
    pub(super) ops: Vec<OpStep>,
    /// The folds, by the number in their steps.
    pub(super) folds: Vec<FoldStep>,
    /// The bits of the first splats, which nothing writes.
    pub(super) constants: Vec<u32>,
    /// Number of splats.
    pub(super) splats: usize,
    /// Number of registers.
    pub(super) registers: usize,
    /// Number of tables.
    pub(super) tables: usize,
}

/// One step of a tape.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Step {
    /// Reads the block's points of an input plane into a register.
    Input { plane: u32, register: u32 },
    /// Copies a value, or spreads a splat into a register.
    Move { from: ScratchPlace, to: ScratchPlace },
    /// Runs these ops, one after the other.
    Ops { first: u32, end: u32 },
    /// Makes the first active row the current one; without active rows, jumps behind the end of the fold.
    Begin { fold: u32 },
    /// Makes the next active row the current one and steps back to the beginning of the body, if there is
    /// one.
    End { fold: u32 },
}

/// One op, or two in one loop.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct OpStep {
    pub code: Code,
    /// The operands, then unused places.
    pub args: [ScratchPlace; MOST_OPERANDS],
    pub result: ScratchPlace,
}

/// What an [`OpStep`] does.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Code {
    Op(Op),
    Pair(FusedPair),
}

/// One fold.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct FoldStep {
    pub table: Table,
    /// The table whose current row owns the rows.
    pub parent: Option<Table>,
    /// The position of the first step of the body.
    pub body: usize,
    /// The position behind the fold's end.
    pub after: usize,
    /// Columns that are read, and the splats that they go to.
    pub columns: Vec<(u32, u32)>,
}

/// The memory of a run: registers and splats. It grows to the need of the largest tape and is then reused.
#[derive(Clone, Default, Debug)]
pub struct Scratch {
    pub(super) file: Vec<Chunk>,
    pub(super) splats: Vec<u32>,
    /// The position of the current row of each table among its active rows.
    pub(super) positions: Vec<u32>,
    pub(super) open: Vec<OpenFold>,
}

/// A fold that is running: what is left of its active rows, as positions in the list of active rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenFold {
    pub next: u32,
    pub end: u32,
}

impl Scratch {
    /// No memory yet: the first run allocates it.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }
}

/// Bytes for the registers of a block: three quarters of a common first-level cache, for rows and the program
/// live there too.
const FILE_BYTES: usize = 24 << 10;
/// Fewer chunks than this, and an op costs more to find than to do: a wide function rather leaves the
/// first-level cache.
const MIN_CHUNKS: usize = 2;
/// More chunks than this gain nothing.
const MAX_CHUNKS: usize = 24;

impl Tape {
    /// Number of registers: as many blocks of points are alive at once.
    #[must_use]
    pub const fn registers(&self) -> usize {
        self.registers
    }

    /// Number of points that run together: a multiple of [`WIDTH`](super::WIDTH). The last block of a plane
    /// is shorter: it has the points that are left, rounded up to a multiple of `WIDTH`.
    #[must_use]
    pub fn block(&self) -> usize {
        (FILE_BYTES / (self.stride() * size_of::<Chunk>())).clamp(MIN_CHUNKS, MAX_CHUNKS) * WIDTH
    }

    /// The distance in chunks between a register's consecutive chunks. It is odd, so that the chunks of one
    /// register are spread over all sets of the cache.
    pub(super) const fn stride(&self) -> usize {
        self.registers | 1
    }

    /// The steps that are two ops.
    #[cfg(test)]
    pub(super) fn pairs(&self) -> impl Iterator<Item = FusedPair> {
        self.ops.iter().filter_map(|step| match step.code {
            Code::Op(_) => None,
            Code::Pair(pair) => Some(pair),
        })
    }
}

impl Scratch {
    /// Makes room for a tape, and writes its constants.
    pub(super) fn reserve(&mut self, tape: &Tape) {
        let chunks = tape.block() / WIDTH * tape.stride();
        if self.file.len() < chunks {
            watch::take(chunks * size_of::<Chunk>());
            self.file.resize(chunks, Chunk::ZERO);
        }
        if self.splats.len() < tape.splats {
            self.splats.resize(tape.splats, 0);
        }
        if self.positions.len() < tape.tables {
            self.positions.resize(tape.tables, 0);
        }
        self.splats[..tape.constants.len()].copy_from_slice(&tape.constants);
        self.open.clear();
    }
}
