//! Events of register allocation, for the replay that [checks](super::check) it.

use super::inst::Memory;

/// One vector of a value: the value's name times the vectors of a value, plus the index of the vector.
pub(crate) type ValuePart = u32;

/// An event between two instructions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Event {
    /// A loop begins.
    Open,
    /// The iteration may end here: all values that the top relies on are in their places now.
    Skip,
    /// The loop's last instruction on values has passed.
    Close,
    /// From now on one part stands for the other, in every place.
    Rename { from: ValuePart, to: ValuePart },
    /// The part at a place is the next value of an accumulator there.
    Next { from: ValuePart, to: ValuePart, at: PartPlace },
}

/// Marks an accumulator of the next iteration, until the loop closes, to tell it from the current one.
pub(crate) const NEXT: ValuePart = 1 << 31;

/// The place of a value.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum PartPlace {
    /// A register; masks follow vectors.
    Register(u8),
    /// A displacement from the stack pointer, in bytes.
    Frame(i32),
    /// Memory that the code does not write.
    Elsewhere(Memory),
}
