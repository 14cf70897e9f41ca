//! Machine instructions, with registers assigned.
//!
//! A vector register is a number from 0 to 31, a mask register one from 1 to 7, an integer register a
//! [`Gpr`]. Where the level has no mask registers a mask is a vector, all ones or all zeros in each lane.

/// An integer register.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[repr(u8)]
pub(crate) enum Gpr {
    Rax,
    Rcx,
    Rdx,
    Rbx,
    Rsp,
    Rbp,
    Rsi,
    Rdi,
    R8,
    R9,
    R10,
    R11,
    R12,
    R13,
    R14,
    R15,
}

/// The base of an address.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Base {
    /// At an address in a register.
    Register(Gpr),
    /// The sum of two registers. The second one, which is not `rsp`, is multiplied by 1, 2, 4 or 8.
    Sum(Gpr, Gpr, u8),
    /// The first constant after the code.
    Constants,
}

/// An operand in memory.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) struct Memory {
    pub(crate) base: Base,
    /// Added to the base, in bytes.
    pub(crate) displacement: i32,
    /// Whether it is one number, broadcast to all lanes. Arithmetic instructions accept such an operand only
    /// where the level has mask registers.
    pub(crate) is_one: bool,
}

impl Memory {
    /// A whole vector at a displacement from an address in a register.
    pub(crate) const fn at(base: Gpr, displacement: i32) -> Self {
        Self { base: Base::Register(base), displacement, is_one: false }
    }
}

/// The last operand of most instructions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Operand {
    Register(u8),
    Memory(Memory),
}

/// Instructions `to = a op b` on vectors.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    /// `a < b ? a : b`.
    Min,
    /// `a > b ? a : b`.
    Max,
    And,
    Or,
    Xor,
    IntAdd,
    IntSub,
}

impl Binary {
    #[cfg(test)]
    pub(crate) const ALL: [Self; 11] = [
        Self::Add,
        Self::Sub,
        Self::Mul,
        Self::Div,
        Self::Min,
        Self::Max,
        Self::And,
        Self::Or,
        Self::Xor,
        Self::IntAdd,
        Self::IntSub,
    ];

    /// Whether the operands may be swapped. (This may change the payload of a NaN, which is unspecified.)
    pub(crate) const fn commutes(self) -> bool {
        match self {
            Self::Add | Self::Mul | Self::And | Self::Or | Self::Xor | Self::IntAdd => true,
            Self::Sub | Self::Div | Self::Min | Self::Max | Self::IntSub => false,
        }
    }
}

/// Which two of `to`, `b`, `c` an fma multiplies. The third is added.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum FmaForm {
    /// `to = to * c + b`.
    F132,
    /// `to = b * to + c`.
    F213,
    /// `to = b * c + to`.
    F231,
}

/// The comparison of `a` and `b`. False if either is NaN.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub(crate) enum Predicate {
    Equal = 0x00,
    Less = 0x11,
    LessOrEqual = 0x12,
    GreaterOrEqual = 0x1D,
    Greater = 0x1E,
}

impl Predicate {
    #[cfg(test)]
    pub(crate) const ALL: [Self; 5] =
        [Self::Equal, Self::Less, Self::LessOrEqual, Self::GreaterOrEqual, Self::Greater];

    /// The comparison of b and a with the same meaning.
    pub(crate) const fn swapped(self) -> Self {
        match self {
            Self::Equal => Self::Equal,
            Self::Less => Self::Greater,
            Self::LessOrEqual => Self::GreaterOrEqual,
            Self::GreaterOrEqual => Self::LessOrEqual,
            Self::Greater => Self::Less,
        }
    }
}

/// The condition of a jump, after a comparison of unsigned integers; [`Equal`](Self::Equal) also means that a
/// test found only zeros.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Condition {
    Below,
    Equal,
    NotEqual,
}

/// A place in the code.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Label(pub(crate) u32);

/// An instruction. It writes `to`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Inst {
    Binary {
        op: Binary,
        to: u8,
        a: u8,
        b: Operand,
    },
    Sqrt {
        to: u8,
        a: Operand,
    },
    /// Reads `to` as well.
    Fma {
        form: FmaForm,
        to: u8,
        b: u8,
        c: Operand,
    },
    /// Shifts each lane by an amount below 32.
    Shift {
        left: bool,
        to: u8,
        a: u8,
        amount: u8,
    },
    /// Writes a mask register, or a vector at levels without mask registers.
    Compare {
        predicate: Predicate,
        to: u8,
        a: u8,
        b: Operand,
    },
    /// Tests whether all bits of a vector are 0, for the next jump. At levels with mask registers the next
    /// two instructions do this.
    Test {
        a: u8,
    },
    /// Finds the lanes that are not 0.
    TestToMask {
        to: u8,
        a: u8,
    },
    /// Tests whether no lane is true, for the next jump.
    TestMask {
        a: u8,
    },
    /// `yes` where the mask is true.
    Blend {
        to: u8,
        mask: u8,
        no: u8,
        yes: Operand,
    },
    /// Zeros in all lanes.
    Zero {
        to: u8,
    },
    Move {
        to: u8,
        from: u8,
    },
    /// Loads a vector, or broadcasts one number.
    Load {
        to: u8,
        from: Memory,
    },
    Store {
        to: Memory,
        from: u8,
    },

    MaskAnd {
        to: u8,
        a: u8,
        b: u8,
    },
    MaskOr {
        to: u8,
        a: u8,
        b: u8,
    },
    MaskNot {
        to: u8,
        a: u8,
    },
    MaskMove {
        to: u8,
        from: u8,
    },
    MaskLoad {
        to: u8,
        from: Memory,
    },
    MaskStore {
        to: Memory,
        from: u8,
    },

    Integer(Integer),
    Jump {
        condition: Condition,
        to: Label,
    },
    Here(Label),
}

impl From<Integer> for Inst {
    fn from(inst: Integer) -> Self {
        Self::Integer(inst)
    }
}

/// An instruction on integer registers of 64 bits, except that a word is read with 32.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Integer {
    /// Reads an address.
    LoadPointer {
        to: Gpr,
        from: Memory,
    },
    StorePointer {
        to: Memory,
        from: Gpr,
    },
    /// Reads 32 bits; the others become 0.
    LoadWord {
        to: Gpr,
        from: Memory,
    },
    AddPointer {
        to: Gpr,
        from: Memory,
    },
    SubPointer {
        to: Gpr,
        from: Memory,
    },
    AddRegister {
        to: Gpr,
        from: Gpr,
    },
    AddConstant {
        to: Gpr,
        number: i32,
    },
    Multiply {
        to: Gpr,
        number: i32,
    },
    /// The address of an operand.
    Address {
        to: Gpr,
        of: Memory,
    },
    ClearRegister {
        to: Gpr,
    },
    /// Takes the number in memory if the preceding comparison found the register above it.
    TakeIfAbove {
        to: Gpr,
        from: Memory,
    },
    Compare64 {
        a: Gpr,
        b: Gpr,
    },
    CompareMemory {
        a: Gpr,
        b: Memory,
    },
}
