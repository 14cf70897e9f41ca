//! What the walk that chooses registers tells of its work, for the replay that [checks](super::check) it.

use super::inst::Memory;

/// One vector of a value: its name times the vectors of a value, plus which.
pub(crate) type Part = u32;

/// What happens between two instructions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Event {
    /// A loop begins.
    Open,
    /// Its round may end here: what is where it is at the top has to be there now.
    Skip,
    /// Its last instruction on values is behind.
    Close,
    /// Wherever one part is, it is the other one from now on.
    Rename { from: Part, to: Part },
    /// A part that is at a place is the next value of an accumulator there.
    Next { from: Part, to: Part, at: Place },
}

/// Marks an accumulator as that of the next round, until the loop closes: so it is told from that of this
/// round.
pub(crate) const NEXT: Part = 1 << 31;

/// Where a value can be.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Place {
    /// With masks behind vectors.
    Register(u8),
    /// So many bytes from the stack pointer.
    Frame(i32),
    /// Among numbers that the code does not write.
    Elsewhere(Memory),
}
