//! The bytes of an instruction: VEX and EVEX prefixes, operands in memory, jumps.
//!
//! ```text
//! VEX    C5 RvvvvLpp                            opcode modrm [sib] [disp8 | disp32] [imm8]
//!        C4 RXBmmmmm WvvvvLpp                   the same
//! EVEX   62 RXBR'0mmm Wvvvv1pp zL'LbV'aaa       the same, but disp8 counts operands: 64, 32 or 4 bytes
//! ```
//!
//! A vector instruction has the EVEX form if it needs it (512 bits, registers from 16, mask registers, a
//! broadcast operand), and otherwise the shorter VEX form. Instructions on mask registers and integers have
//! no EVEX form.

use super::inst::{Base, Binary, Condition, FmaForm, Gpr, Inst, Integer, Label, Memory, Operand};

/// The width of vectors, and the features of the level.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Shape {
    /// Bytes of a vector: 32 or 64.
    pub(crate) bytes: usize,
    /// Whether there are mask registers, 32 vector registers, and broadcast operands in memory.
    pub(crate) has_masks: bool,
}

/// The opcode map.
#[derive(Clone, Copy)]
enum Map {
    M0F = 1,
    M0F38 = 2,
    M0F3A = 3,
}

/// The prefix that is part of an opcode.
#[derive(Clone, Copy)]
enum Prefix {
    None = 0,
    P66 = 1,
}

/// An opcode with its map and prefix.
#[derive(Clone, Copy)]
struct Opcode(Map, Prefix, u8);

/// The fields of an instruction with a VEX or EVEX prefix.
struct Vex {
    code: Opcode,
    /// The register in `modrm.reg`, or the extension of the opcode there.
    reg: u8,
    /// The register in `vvvv`, 0 if there is none.
    other: u8,
    rm: Operand,
    /// The mask register of a blend, else 0.
    mask: u8,
    /// Bytes of a vector: 16, 32 or 64.
    bytes: usize,
    /// Whether there is no VEX form.
    is_evex: bool,
    /// Bytes behind the operands.
    immediate: Option<u8>,
}

/// Writes instructions.
pub(crate) struct Encoder {
    pub(crate) bytes: Vec<u8>,
    shape: Shape,
    /// The position of each label.
    labels: Vec<Option<usize>>,
    /// Jumps to labels that were not known: the position of the displacement, and the label.
    jumps: Vec<(usize, Label)>,
    /// Operands among the constants: the position of the displacement, the end of the instruction, and the
    /// distance from the first constant.
    constants: Vec<(usize, usize, i32)>,
}

impl Encoder {
    pub(crate) fn new(shape: Shape, labels: u32) -> Self {
        let labels = vec![None; labels as usize];
        Self { bytes: Vec::new(), shape, labels, jumps: Vec::new(), constants: Vec::new() }
    }

    /// Appends the constants, and fills in where they and the labels are. Code and constants.
    pub(crate) fn finish(mut self, constants: &[u8]) -> Vec<u8> {
        for (at, label) in std::mem::take(&mut self.jumps) {
            let target = self.labels[label.0 as usize].expect("a label that is jumped to is placed");
            self.patch(at, target, at + 4);
        }
        let align = self.shape.bytes;
        self.bytes.resize(self.bytes.len().next_multiple_of(align), 0xCC);
        let first = self.bytes.len();
        for (at, next, offset) in std::mem::take(&mut self.constants) {
            self.patch(at, first + offset as usize, next);
        }
        self.bytes.extend_from_slice(constants);
        self.bytes
    }

    /// Writes the distance from the next instruction to a target.
    fn patch(&mut self, at: usize, target: usize, next: usize) {
        let distance = i32::try_from(target as i64 - next as i64);
        let distance = distance.expect("our limits keep code far below 2^31 bytes");
        self.bytes[at..at + 4].copy_from_slice(&distance.to_le_bytes());
    }

    /// Appends an instruction.
    pub(crate) fn inst(&mut self, inst: &Inst) {
        match *inst {
            Inst::Binary { op, to, a, b } => self.vector(binary(op), to, a, b),
            Inst::Sqrt { to, a } => self.vector(Opcode(Map::M0F, Prefix::None, 0x51), to, 0, a),
            Inst::Fma { form, to, b, c } => {
                let opcode = match form {
                    FmaForm::F132 => 0x98,
                    FmaForm::F213 => 0xA8,
                    FmaForm::F231 => 0xB8,
                };
                self.vector(Opcode(Map::M0F38, Prefix::P66, opcode), to, b, c);
            }
            Inst::Shift { left, to, a, amount } => {
                let code = Opcode(Map::M0F, Prefix::P66, 0x72);
                let (reg, rm) = (if left { 6 } else { 2 }, Operand::Register(a));
                self.vex(&Vex { immediate: Some(amount), ..self.plain(code, reg, to, rm) });
            }
            Inst::Compare { predicate, to, a, b } => {
                let code = Opcode(Map::M0F, Prefix::None, 0xC2);
                let vex = self.plain(code, to, a, b);
                let is_evex = vex.is_evex || self.shape.has_masks;
                self.vex(&Vex { immediate: Some(predicate as u8), is_evex, ..vex });
            }
            Inst::Test { a } => {
                self.vector(Opcode(Map::M0F38, Prefix::P66, 0x17), a, 0, Operand::Register(a));
            }
            Inst::TestToMask { to, a } => {
                let vex = self.plain(Opcode(Map::M0F38, Prefix::P66, 0x27), to, a, Operand::Register(a));
                self.vex(&Vex { is_evex: true, ..vex });
            }
            Inst::Blend { to, mask, no, yes } if self.shape.has_masks => {
                let vex = self.plain(Opcode(Map::M0F38, Prefix::P66, 0x65), to, no, yes);
                self.vex(&Vex { mask, is_evex: true, ..vex });
            }
            Inst::Blend { to, mask, no, yes } => {
                let vex = self.plain(Opcode(Map::M0F3A, Prefix::P66, 0x4A), to, no, yes);
                self.vex(&Vex { immediate: Some(mask << 4), ..vex });
            }
            Inst::Zero { .. } | Inst::Move { .. } | Inst::Load { .. } | Inst::Store { .. } => self.copy(inst),
            Inst::MaskAnd { .. }
            | Inst::MaskOr { .. }
            | Inst::MaskNot { .. }
            | Inst::MaskMove { .. }
            | Inst::MaskLoad { .. }
            | Inst::MaskStore { .. }
            | Inst::TestMask { .. } => self.mask(inst),
            Inst::Jump { condition, to } => self.jump(condition, to),
            Inst::Here(label) => self.labels[label.0 as usize] = Some(self.bytes.len()),
            Inst::Integer(ref inst) => self.integer(inst),
        }
    }

    /// Instructions that fill a vector register, or store one.
    fn copy(&mut self, inst: &Inst) {
        match *inst {
            Inst::Zero { to } => {
                let (code, rm) = (Opcode(Map::M0F, Prefix::P66, 0xEF), Operand::Register(to));
                // 128 bits are written, the others become 0.
                self.vex(&Vex { bytes: 16, is_evex: to > 15, ..self.plain(code, to, to, rm) });
            }
            Inst::Move { to, from } => {
                self.vector(Opcode(Map::M0F, Prefix::None, 0x28), to, 0, Operand::Register(from));
            }
            Inst::Load { to, from } if from.is_one => {
                let vex = self.plain(Opcode(Map::M0F38, Prefix::P66, 0x18), to, 0, Operand::Memory(from));
                let is_evex = to > 15 || self.shape.bytes == 64;
                self.vex(&Vex { is_evex, ..vex });
            }
            Inst::Load { to, from } => {
                self.vector(Opcode(Map::M0F, Prefix::None, 0x10), to, 0, Operand::Memory(from));
            }
            Inst::Store { to, from } => {
                self.vector(Opcode(Map::M0F, Prefix::None, 0x11), from, 0, Operand::Memory(to));
            }
            _ => unreachable!("only instructions that copy vectors come here"),
        }
    }

    /// An instruction on whole vectors, without anything special.
    fn vector(&mut self, code: Opcode, reg: u8, other: u8, rm: Operand) {
        self.vex(&self.plain(code, reg, other, rm));
    }

    fn plain(&self, code: Opcode, reg: u8, other: u8, rm: Operand) -> Vex {
        let is_high = reg > 15 || other > 15 || matches!(rm, Operand::Register(rm) if rm > 15);
        let is_one = matches!(rm, Operand::Memory(memory) if memory.is_one);
        let is_evex = is_high || is_one || self.shape.bytes == 64;
        Vex { code, reg, other, rm, mask: 0, bytes: self.shape.bytes, is_evex, immediate: None }
    }

    /// Instructions on mask registers. They operate on 16 lanes, of which the lower ones count, as many as a
    /// vector has.
    fn mask(&mut self, inst: &Inst) {
        let none = |opcode| Opcode(Map::M0F, Prefix::None, opcode);
        let (code, reg, other, rm, bytes) = match *inst {
            Inst::MaskAnd { to, a, b } => (none(0x41), to, a, Operand::Register(b), 32),
            Inst::MaskOr { to, a, b } => (none(0x45), to, a, Operand::Register(b), 32),
            Inst::MaskNot { to, a } => (none(0x44), to, 0, Operand::Register(a), 16),
            Inst::MaskMove { to, from } => (none(0x90), to, 0, Operand::Register(from), 16),
            Inst::MaskLoad { to, from } => (none(0x90), to, 0, Operand::Memory(from), 16),
            Inst::MaskStore { to, from } => (none(0x91), from, 0, Operand::Memory(to), 16),
            Inst::TestMask { a } => (none(0x98), a, 0, Operand::Register(a), 16),
            _ => unreachable!("only instructions on mask registers come here"),
        };
        self.vex(&Vex { code, reg, other, rm, mask: 0, bytes, is_evex: false, immediate: None });
    }

    /// An instruction with a prefix of either form.
    fn vex(&mut self, vex: &Vex) {
        let Opcode(map, prefix, opcode) = vex.code;
        let (x, b) = match vex.rm {
            Operand::Register(rm) => (rm >> 4 & 1, rm >> 3 & 1),
            Operand::Memory(Memory { base, .. }) => match base {
                Base::Register(base) => (0, base as u8 >> 3),
                Base::Sum(base, index, _) => (index as u8 >> 3, base as u8 >> 3),
                Base::Constants => (0, 0),
            },
        };
        let (r, v) = (vex.reg >> 3 & 1, !vex.other & 15);
        let length = (vex.bytes / 32) as u8;
        let mut scale = 1;
        if vex.is_evex {
            let is_one = matches!(vex.rm, Operand::Memory(memory) if memory.is_one);
            // A broadcast load has an opcode of its own; other instructions have a broadcast bit.
            let is_variant = is_one && opcode != 0x18;
            scale = if is_one { 4 } else { vex.bytes as i32 };
            let first =
                (!r & 1) << 7 | (!x & 1) << 6 | (!b & 1) << 5 | (!(vex.reg >> 4) & 1) << 4 | map as u8;
            let third = length << 5 | u8::from(is_variant) << 4 | (!(vex.other >> 4) & 1) << 3 | vex.mask;
            self.bytes.extend([0x62, first, v << 3 | 1 << 2 | prefix as u8, third]);
        } else {
            let last = v << 3 | length << 2 | prefix as u8;
            if x == 0 && b == 0 && matches!(map, Map::M0F) {
                self.bytes.extend([0xC5, (!r & 1) << 7 | last]);
            } else {
                let first = (!r & 1) << 7 | (!x & 1) << 6 | (!b & 1) << 5 | map as u8;
                self.bytes.extend([0xC4, first, last]);
            }
        }
        self.bytes.push(opcode);
        self.operands(vex.reg, vex.rm, scale, usize::from(vex.immediate.is_some()));
        self.bytes.extend(vex.immediate);
    }

    /// The operands after an opcode. A displacement of one byte counts units of `scale` bytes; `behind` bytes
    /// follow the operands.
    fn operands(&mut self, reg: u8, rm: Operand, scale: i32, behind: usize) {
        let reg = (reg & 7) << 3;
        let memory = match rm {
            Operand::Register(rm) => return self.bytes.push(0xC0 | reg | rm & 7),
            Operand::Memory(memory) => memory,
        };
        let Memory { displacement, .. } = memory;
        let (base, sib) = match memory.base {
            Base::Constants => {
                self.bytes.push(reg | 5);
                let at = self.bytes.len();
                self.constants.push((at, at + 4 + behind, displacement));
                self.bytes.extend([0; 4]);
                return;
            }
            // `rsp` and `r12` as a base need a second byte, which says that there is no index.
            Base::Register(base) => (base as u8 & 7, (base as u8 & 7 == 4).then_some(0x24)),
            Base::Sum(base, index, scale) => {
                let scale = (scale.trailing_zeros() as u8) << 6;
                (base as u8 & 7, Some(scale | (index as u8 & 7) << 3 | base as u8 & 7))
            }
        };
        let rm = if sib.is_some() { 4 } else { base };
        let short = (displacement % scale == 0).then(|| i8::try_from(displacement / scale).ok()).flatten();
        // `rbp` and `r13` as a base always have a displacement.
        let mode = match short {
            Some(0) if base != 5 => 0,
            Some(_) => 1,
            None => 2,
        };
        self.bytes.push(mode << 6 | reg | rm);
        self.bytes.extend(sib);
        match (mode, short) {
            (0, _) => {}
            (1, Some(short)) => self.bytes.push(short as u8),
            (_, _) => self.bytes.extend(displacement.to_le_bytes()),
        }
    }

    /// Instructions on integers of 64 bits, except that a word is read with 32.
    fn integer(&mut self, inst: &Integer) {
        match *inst {
            Integer::LoadPointer { to, from } => self.rex(true, &[0x8B], to, Operand::Memory(from)),
            Integer::StorePointer { to, from } => self.rex(true, &[0x89], from, Operand::Memory(to)),
            Integer::LoadWord { to, from } => self.rex(false, &[0x8B], to, Operand::Memory(from)),
            Integer::AddPointer { to, from } => self.rex(true, &[0x03], to, Operand::Memory(from)),
            Integer::SubPointer { to, from } => self.rex(true, &[0x2B], to, Operand::Memory(from)),
            Integer::AddRegister { to, from } => self.rex(true, &[0x03], to, Operand::Register(from as u8)),
            Integer::Address { to, of } => self.rex(true, &[0x8D], to, Operand::Memory(of)),
            Integer::ClearRegister { to } => self.rex(false, &[0x33], to, Operand::Register(to as u8)),
            Integer::TakeIfAbove { to, from } => self.rex(true, &[0x0F, 0x47], to, Operand::Memory(from)),
            Integer::Compare64 { a, b } => self.rex(true, &[0x3B], a, Operand::Register(b as u8)),
            Integer::CompareMemory { a, b } => self.rex(true, &[0x3B], a, Operand::Memory(b)),
            Integer::AddConstant { to, number } => {
                let short = i8::try_from(number).ok();
                let opcode = if short.is_some() { 0x83 } else { 0x81 };
                self.rex(true, &[opcode], Gpr::Rax, Operand::Register(to as u8));
                match short {
                    Some(short) => self.bytes.push(short as u8),
                    None => self.bytes.extend(number.to_le_bytes()),
                }
            }
            Integer::Multiply { to, number } => {
                self.rex(true, &[0x69], to, Operand::Register(to as u8));
                self.bytes.extend(number.to_le_bytes());
            }
        }
    }

    /// An integer instruction of 64 or 32 bits.
    fn rex(&mut self, is_wide: bool, opcode: &[u8], reg: Gpr, rm: Operand) {
        let (x, b) = match rm {
            Operand::Register(rm) => (0, rm >> 3),
            Operand::Memory(Memory { base: Base::Register(base), .. }) => (0, base as u8 >> 3),
            Operand::Memory(Memory { base: Base::Sum(base, index, _), .. }) => {
                (index as u8 >> 3, base as u8 >> 3)
            }
            Operand::Memory(Memory { base: Base::Constants, .. }) => (0, 0),
        };
        let rex = u8::from(is_wide) << 3 | (reg as u8 >> 3) << 2 | x << 1 | b;
        if rex != 0 {
            self.bytes.push(0x40 | rex);
        }
        self.bytes.extend(opcode);
        self.operands(reg as u8, rm, 1, 0);
    }

    /// A jump: short if it goes back to a label within reach.
    fn jump(&mut self, condition: Condition, label: Label) {
        let code = match condition {
            Condition::Below => 2,
            Condition::Equal => 4,
            Condition::NotEqual => 5,
        };
        if let Some(target) = self.labels[label.0 as usize] {
            let distance = target as i64 - (self.bytes.len() as i64 + 2);
            if let Ok(short) = i8::try_from(distance) {
                self.bytes.extend([0x70 | code, short as u8]);
                return;
            }
        }
        self.bytes.extend([0x0F, 0x80 | code]);
        self.jumps.push((self.bytes.len(), label));
        self.bytes.extend([0; 4]);
    }
}

const fn binary(op: Binary) -> Opcode {
    match op {
        Binary::Add => Opcode(Map::M0F, Prefix::None, 0x58),
        Binary::Sub => Opcode(Map::M0F, Prefix::None, 0x5C),
        Binary::Mul => Opcode(Map::M0F, Prefix::None, 0x59),
        Binary::Div => Opcode(Map::M0F, Prefix::None, 0x5E),
        Binary::Min => Opcode(Map::M0F, Prefix::None, 0x5D),
        Binary::Max => Opcode(Map::M0F, Prefix::None, 0x5F),
        Binary::And => Opcode(Map::M0F, Prefix::P66, 0xDB),
        Binary::Or => Opcode(Map::M0F, Prefix::P66, 0xEB),
        Binary::Xor => Opcode(Map::M0F, Prefix::P66, 0xEF),
        Binary::IntAdd => Opcode(Map::M0F, Prefix::P66, 0xFE),
        Binary::IntSub => Opcode(Map::M0F, Prefix::P66, 0xFA),
    }
}
