//! The machine instructions that kernels are made of, with registers chosen.
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

/// Where an operand begins in memory.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Base {
    /// At an address in a register.
    Register(Gpr),
    /// At the sum of two registers, of which the second, that is not `rsp`, is multiplied by 1, 2, 4 or 8.
    Sum(Gpr, Gpr, u8),
    /// In the constants behind the code: so many bytes from the first one.
    Constants,
}

/// An operand in memory.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) struct Memory {
    pub(crate) base: Base,
    /// Bytes that are added.
    pub(crate) displacement: i32,
    /// Whether it is one number for all lanes. An instruction that computes takes such an operand where the
    /// level has mask registers.
    pub(crate) is_one: bool,
}

impl Memory {
    /// All lanes, so many bytes behind an address in a register.
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

    /// Whether the operands may change places. (The payload of a NaN may change, and is nobody's.)
    pub(crate) const fn commutes(self) -> bool {
        match self {
            Self::Add | Self::Mul | Self::And | Self::Or | Self::Xor | Self::IntAdd => true,
            Self::Sub | Self::Div | Self::Min | Self::Max | Self::IntSub => false,
        }
    }
}

/// Which two of `to`, `b`, `c` an fma multiplies. The third is added.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Form {
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

    /// The comparison of b and a that says the same.
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

/// When a jump is taken, after a comparison of unsigned integers; [`Equal`](Self::Equal) after a test that
/// found zeros alone.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Condition {
    Below,
    Equal,
    NotEqual,
}

/// A place in the code.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Label(pub(crate) u32);

/// An instruction. `to` is what it writes.
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
        form: Form,
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
    /// To a mask register, or to a vector where there are none.
    Compare {
        predicate: Predicate,
        to: u8,
        a: u8,
        b: Operand,
    },
    /// Whether all bits of a vector are 0, for the next jump. Where there are mask registers, this is done by
    /// way of one of them: the next two.
    Test {
        a: u8,
    },
    /// Which lanes are not 0.
    TestToMask {
        to: u8,
        a: u8,
    },
    /// Whether no lane is true, for the next jump.
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
    /// One number for all lanes, or all of them.
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

/// An instruction on integer registers, of 64 bits but for a word that is read.
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
    /// Takes the number in memory if the comparison before has found the register above it.
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
