//! Operands of the operations of a formula.

/// What an operation works on.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Operand {
    /// x, y or z: 0, 1 or 2.
    Coordinate(u8),
    /// The field of a child.
    Child(u32),
    /// A number of the row.
    Number(u32),
    /// The value of a step before.
    Step(u32),
}
