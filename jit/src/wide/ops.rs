//! Instruction selection, op by op: operands in registers or memory, the register of the result, the
//! instruction.
//!
//! An op is emitted for all vectors of its value before the next op, so that an instruction rarely waits for
//! the one before.

use jbt_ir::Op;

use super::event::ValuePart;
use super::inst::{Base, Binary, FmaForm, Gpr, Inst, Integer, Memory, Operand, Predicate};
use super::linear::{Definition, Home, NONE, ValueName};
use super::state::{MASKS, NOWHERE, Register, SPARE_MASK, WalkState, copy, load, store};

/// The distance of the next use up to which a number is loaded into a register: beyond, it is read from
/// memory again.
const NEAR: u32 = 64;

/// An operand of the current instruction.
#[derive(Clone, Copy)]
enum OperandSource {
    Register(Register),
    /// Where memory has the part.
    Home(ValuePart),
}

impl WalkState<'_> {
    /// Emits an op for all vectors.
    pub(super) fn op(&mut self, op: Op, to: ValueName, args: [ValueName; 3]) {
        let count = self.parts(to).len() as u32;
        for vector in 0..count {
            let is_last = vector + 1 == count;
            let part = self.part(to, vector);
            let args = args.map(|arg| if arg == NONE { NONE } else { self.part(arg, vector) });
            self.op_part(op, part, args, is_last);
            self.locked = 0;
        }
    }

    fn op_part(&mut self, op: Op, to: ValuePart, [a, b, c]: [ValuePart; 3], is_last: bool) {
        let has_masks = self.shape.has_masks;
        match op {
            Op::Add => self.binary(Binary::Add, to, [a, b], is_last),
            Op::Sub => self.binary(Binary::Sub, to, [a, b], is_last),
            Op::Mul => self.binary(Binary::Mul, to, [a, b], is_last),
            Op::Div => self.binary(Binary::Div, to, [a, b], is_last),
            Op::Min => self.binary(Binary::Min, to, [a, b], is_last),
            Op::Max => self.binary(Binary::Max, to, [a, b], is_last),
            Op::BitAnd => self.binary(Binary::And, to, [a, b], is_last),
            Op::BitOr => self.binary(Binary::Or, to, [a, b], is_last),
            Op::BitXor => self.binary(Binary::Xor, to, [a, b], is_last),
            Op::IntAdd => self.binary(Binary::IntAdd, to, [a, b], is_last),
            Op::IntSub => self.binary(Binary::IntSub, to, [a, b], is_last),
            Op::Fma => self.fma(to, [a, b, c], is_last),
            Op::Neg => self.with_number(Binary::Xor, 0x8000_0000, to, a, is_last),
            Op::Abs => self.with_number(Binary::And, 0x7FFF_FFFF, to, a, is_last),
            Op::Sqrt => self.sqrt(to, a, is_last),
            Op::Lt => self.compare(Predicate::Less, to, [a, b], is_last),
            Op::Le => self.compare(Predicate::LessOrEqual, to, [a, b], is_last),
            Op::Eq => self.compare(Predicate::Equal, to, [a, b], is_last),
            Op::Both | Op::Either | Op::Not if has_masks => self.mask(op, to, [a, b], is_last),
            Op::Both => self.binary(Binary::And, to, [a, b], is_last),
            Op::Either => self.binary(Binary::Or, to, [a, b], is_last),
            Op::Not => self.with_number(Binary::Xor, u32::MAX, to, a, is_last),
            Op::Select => self.select(to, [a, b, c], is_last),
            Op::Shl => self.shift(true, to, [a, b], is_last),
            Op::Shr => self.shift(false, to, [a, b], is_last),
            Op::ToBits | Op::FromBits | Op::StopGradient | Op::LowEnd => {
                unreachable!("the list has other names for these")
            }
            Op::Sin | Op::Cos | Op::Exp | Op::Ln | Op::Pow | Op::SlopeX | Op::SlopeY | Op::SlopeZ => {
                unreachable!("functions are checked first")
            }
        }
    }

    // ── operands ─────────────────────────────────────────────────────────────────────────────────

    /// Whether a part is in no register, an instruction may read it from memory, and that is better than
    /// loading it.
    fn stays_in_memory(&mut self, part: ValuePart, is_last: bool) -> bool {
        let name = self.name(part);
        if self.register_of(part).is_some() || !self.can_be_operand(name) {
            return false;
        }
        if self.free_register(self.class(name)).is_none() {
            return true;
        }
        // One load serves all uses that come soon.
        let data = self.linear.names[name as usize];
        let soon = self.later_use(name).is_some_and(|at| at - self.position <= NEAR);
        let again = if data.is_uniform { !is_last && self.vectors > 2 } else { false };
        !(soon || again)
    }

    /// An operand that may be in memory.
    fn source(&mut self, part: ValuePart, is_last: bool) -> OperandSource {
        if self.stays_in_memory(part, is_last) {
            OperandSource::Home(part)
        } else {
            OperandSource::Register(self.fetch(part))
        }
    }

    /// The operand, just before its instruction.
    fn operand(&mut self, source: OperandSource) -> Operand {
        match source {
            OperandSource::Register(register) => Operand::Register(register),
            OperandSource::Home(part) => Operand::Memory(self.home(part)),
        }
    }

    /// Whether the instruction of one vector is the last use of a part.
    fn ends(&self, part: ValuePart, is_last: bool) -> bool {
        let name = self.name(part);
        (is_last || !self.linear.names[name as usize].is_uniform) && self.dies(name)
    }

    /// The register in which an accumulator begins an iteration, if the part is its next value and the
    /// register is available.
    fn wish(&self, to: ValuePart) -> Option<Register> {
        let name = self.name(to);
        let phi = self.becomes[name as usize];
        if phi == NONE {
            return None;
        }
        let phi = self.part(phi, to - name * self.vectors);
        let header = &self.open.last()?.header;
        let class = self.class(name);
        self.registers(class).find(|&register| header[register as usize] == phi)
    }

    /// A register for a result: if possible the register of an operand that dies, but not `taboo`. Operands
    /// that die are released.
    fn target(
        &mut self,
        to: ValuePart,
        args: &[ValuePart],
        is_last: bool,
        taboo: Option<Register>,
    ) -> Register {
        let class = self.class(self.name(to));
        let mut ending = [NOWHERE; 3];
        for (place, &arg) in ending.iter_mut().zip(args) {
            if let Some(register) = self.register_of(arg)
                && self.ends(arg, is_last)
                && (register >= MASKS) == (class == 1)
                && Some(register) != taboo
            {
                *place = register;
            }
        }
        let wish = self.wish(to).filter(|&wish| {
            Some(wish) != taboo
                && (self.occupant[wish as usize] == NONE && self.locked >> wish & 1 == 0
                    || ending.contains(&wish))
        });
        let is_reserved = |register: Register| self.reserved >> register & 1 == 1;
        let ended = ending.into_iter().filter(|&register| register != NOWHERE);
        let register = wish
            .or_else(|| ended.clone().find(|&register| !is_reserved(register)))
            .or_else(|| self.free_register(class).filter(|&register| !is_reserved(register)))
            .or_else(|| ended.clone().next())
            .unwrap_or_else(|| self.take_or_overwrite(class, args, taboo));
        let there = self.occupant[register as usize];
        if there != NONE {
            self.release(there);
        }
        self.bind(to, register);
        self.lock(register);
        register
    }

    /// An empty register. If the instruction needs all others, the register of an operand, which is stored:
    /// an instruction reads before it writes.
    fn take_or_overwrite(&mut self, class: usize, args: &[ValuePart], taboo: Option<Register>) -> Register {
        let mut registers = self.registers(class);
        if registers.any(|register| self.locked >> register & 1 == 0) {
            return self.take(class);
        }
        let of_class = |state: &Self, part| {
            state
                .register_of(part)
                .filter(|&register| (register >= MASKS) == (class == 1) && Some(register) != taboo)
        };
        let overwritten = args.iter().find_map(|&part| of_class(self, part));
        let register = overwritten.expect("an instruction needs fewer registers than there are");
        self.vacate(register);
        register
    }

    // ── vectors ──────────────────────────────────────────────────────────────────────────────────

    fn binary(&mut self, op: Binary, to: ValuePart, [mut a, mut b]: [ValuePart; 2], is_last: bool) {
        let in_register = |state: &Self, part| state.register_of(part).is_some();
        if op.commutes() && !in_register(self, a) && in_register(self, b) {
            (a, b) = (b, a);
        }
        if a == b {
            let register = self.fetch(a);
            let target = self.target(to, &[a], is_last, None);
            let inst = Inst::Binary { op, to: target, a: register, b: Operand::Register(register) };
            return self.emit(inst, &[a, a], to);
        }
        if self.stays_in_memory(a, is_last) {
            // Loads a directly into the register of the result, which must differ from the register of b.
            let source = self.source(b, is_last);
            let taboo = if let OperandSource::Register(register) = source { Some(register) } else { None };
            let target = self.target(to, &[], is_last, taboo);
            self.load_into(target, a);
            let operand = self.operand(source);
            return self.emit(Inst::Binary { op, to: target, a: target, b: operand }, &[a, b], to);
        }
        let register = self.fetch(a);
        let source = self.source(b, is_last);
        let target = self.target(to, &[a, b], is_last, None);
        let operand = self.operand(source);
        self.emit(Inst::Binary { op, to: target, a: register, b: operand }, &[a, b], to);
    }

    /// An instruction whose second operand is a number.
    fn with_number(&mut self, op: Binary, bits: u32, to: ValuePart, a: ValuePart, is_last: bool) {
        if self.stays_in_memory(a, is_last) {
            let target = self.target(to, &[], is_last, None);
            self.load_into(target, a);
            let b = Operand::Memory(self.number(bits));
            return self.emit(Inst::Binary { op, to: target, a: target, b }, &[a], to);
        }
        let register = self.fetch(a);
        let target = self.target(to, &[a], is_last, None);
        let b = Operand::Memory(self.number(bits));
        self.emit(Inst::Binary { op, to: target, a: register, b }, &[a], to);
    }

    fn sqrt(&mut self, to: ValuePart, a: ValuePart, is_last: bool) {
        let source = self.source(a, is_last);
        let target = self.target(to, &[a], is_last, None);
        let a_operand = self.operand(source);
        self.emit(Inst::Sqrt { to: target, a: a_operand }, &[a], to);
    }

    fn shift(&mut self, left: bool, to: ValuePart, [a, by]: [ValuePart; 2], is_last: bool) {
        let Definition::Leaf(Home::Number(amount)) = self.linear.names[self.name(by) as usize].kind else {
            unreachable!("a verified function shifts by constants")
        };
        let register = self.fetch(a);
        let target = self.target(to, &[a], is_last, None);
        let inst = Inst::Shift { left, to: target, a: register, amount: (amount % 32) as u8 };
        self.emit(inst, &[a], to);
    }

    fn compare(
        &mut self,
        mut predicate: Predicate,
        to: ValuePart,
        [mut a, mut b]: [ValuePart; 2],
        is_last: bool,
    ) {
        if self.register_of(a).is_none() && self.register_of(b).is_some() {
            (a, b, predicate) = (b, a, predicate.swapped());
        }
        let register = self.fetch(a);
        let source = if a == b { OperandSource::Register(register) } else { self.source(b, is_last) };
        let target = self.target(to, &[a, b], is_last, None);
        let b_operand = self.operand(source);
        let number = if target < MASKS { target } else { target - MASKS };
        self.emit(Inst::Compare { predicate, to: number, a: register, b: b_operand }, &[a, b], to);
    }

    /// The mask register of a mask: the spare one, if the mask is in none.
    fn mask_register(&mut self, part: ValuePart) -> u8 {
        if let Some(register) = self.register_of(part) {
            self.lock(register);
            return register - MASKS;
        }
        if self.free_register(1).is_some() {
            return self.fetch(part) - MASKS;
        }
        self.load_into(MASKS + SPARE_MASK, part);
        SPARE_MASK
    }

    /// `if mask { yes } else { no }`.
    fn select(&mut self, to: ValuePart, [mask, yes, no]: [ValuePart; 3], is_last: bool) {
        let has_masks = self.shape.has_masks;
        let mask_number = if has_masks { self.mask_register(mask) } else { self.fetch(mask) };
        if yes != no && self.stays_in_memory(no, is_last) {
            let source = self.source(yes, is_last);
            let yes_register =
                if let OperandSource::Register(register) = source { Some(register) } else { None };
            // Without mask registers the mask is a vector, and stays locked so that the result cannot
            // overwrite it.
            let target = self.target(to, &[], is_last, yes_register);
            self.load_into(target, no);
            let operand = self.operand(source);
            let inst = Inst::Blend { to: target, mask: mask_number, no: target, yes: operand };
            return self.emit(inst, &[mask, no, yes], to);
        }
        let no_register = self.fetch(no);
        let source = if yes == no { OperandSource::Register(no_register) } else { self.source(yes, is_last) };
        let target = self.target(to, &[no, yes, mask], is_last, None);
        let operand = self.operand(source);
        let inst = Inst::Blend { to: target, mask: mask_number, no: no_register, yes: operand };
        self.emit(inst, &[mask, no, yes], to);
    }

    /// Ops on mask registers.
    fn mask(&mut self, op: Op, to: ValuePart, [a, b]: [ValuePart; 2], is_last: bool) {
        if op == Op::Not {
            let register = self.mask_register(a);
            let target = self.target(to, &[a], is_last, None) - MASKS;
            return self.emit(Inst::MaskNot { to: target, a: register }, &[a], to);
        }
        // One of them may need the spare register, so the other one gets a register of its own.
        let first = self.fetch(a) - MASKS;
        let second = if a == b { first } else { self.mask_register(b) };
        let target = self.target(to, &[a, b], is_last, None) - MASKS;
        let inst = if op == Op::Both {
            Inst::MaskAnd { to: target, a: first, b: second }
        } else {
            Inst::MaskOr { to: target, a: first, b: second }
        };
        self.emit(inst, &[a, b], to);
    }

    // ── fma ──────────────────────────────────────────────────────────────────────────────────────

    /// `a * b + c`. The result takes the register of one operand: of one that dies, of one that is loaded for
    /// it, or of a copy.
    fn fma(&mut self, to: ValuePart, [mut a, mut b, c]: [ValuePart; 3], is_last: bool) {
        // One operand in memory may stay there: the last one in this order.
        let mut in_memory = NONE;
        for part in [c, b, a] {
            if part == in_memory {
                continue;
            }
            let is_twice = [a, b, c].iter().filter(|&&other| other == part).count() > 1;
            if in_memory == NONE && !is_twice && self.stays_in_memory(part, is_last) {
                in_memory = part;
            } else {
                self.fetch(part);
            }
        }
        if a == in_memory {
            (a, b) = (b, a);
        }
        // Now a is in a register, and at most one of b and c is in memory.
        let register = |state: &Self, part| state.register_of(part).unwrap_or(NOWHERE);
        let [ra, rb, rc] = [a, b, c].map(|part| register(self, part));
        let any_ends = [a, b, c].iter().any(|&part| part != in_memory && self.ends(part, is_last));
        if !any_ends && in_memory != NONE {
            let target = self.target(to, &[], is_last, None);
            self.load_into(target, in_memory);
            let (form, other, last) =
                if b == in_memory { (FmaForm::F213, ra, rc) } else { (FmaForm::F231, ra, rb) };
            // 213: to = other * to + last.  231: to = other * last + to.
            let reads = if b == in_memory { [b, a, c] } else { [c, a, b] };
            let inst = Inst::Fma { form, to: target, b: other, c: Operand::Register(last) };
            return self.emit(inst, &reads, to);
        }
        let target = self.fma_target(to, [a, b, c], in_memory, is_last);
        if target == rc && c != in_memory {
            let (other, last, other_part, last_part) = (ra, b, a, b);
            let operand =
                if last == in_memory { Operand::Memory(self.home(b)) } else { Operand::Register(rb) };
            let inst = Inst::Fma { form: FmaForm::F231, to: target, b: other, c: operand };
            return self.emit(inst, &[c, other_part, last_part], to);
        }
        // The target is a, or b, or a copy of a.
        let (factor, other, other_register) =
            if target == rb && b != in_memory { (b, a, ra) } else { (a, b, rb) };
        if target != ra && target != rb {
            self.emit(copy(target, ra), &[a], a);
        }
        let inst = if other == in_memory {
            let operand = Operand::Memory(self.home(other));
            (Inst::Fma { form: FmaForm::F132, to: target, b: rc, c: operand }, [factor, c, other])
        } else {
            let operand = if c == in_memory { Operand::Memory(self.home(c)) } else { Operand::Register(rc) };
            (Inst::Fma { form: FmaForm::F213, to: target, b: other_register, c: operand }, [factor, other, c])
        };
        self.emit(inst.0, &inst.1, to);
    }

    /// The register of an fma's result: the register of an operand that dies, or the target of a copy.
    fn fma_target(
        &mut self,
        to: ValuePart,
        args: [ValuePart; 3],
        in_memory: ValuePart,
        is_last: bool,
    ) -> Register {
        let ending = args
            .into_iter()
            .filter(|&part| part != in_memory && self.ends(part, is_last))
            .filter_map(|part| Some((part, self.register_of(part)?)));
        let wish = self.wish(to);
        let is_wish = |&(_, register): &(ValuePart, Register)| Some(register) == wish;
        let is_free = |&(_, register): &(ValuePart, Register)| self.reserved >> register & 1 == 0;
        let chosen = ending.clone().find(is_wish);
        let chosen = chosen.or_else(|| ending.clone().find(is_free)).or_else(|| ending.clone().next());
        match chosen {
            Some((part, register)) => {
                self.release(part);
                self.bind(to, register);
                register
            }
            None => self.target(to, &args[..1], is_last, None),
        }
    }

    // ── stores ───────────────────────────────────────────────────────────────────────────────────

    /// Copies a leaf into a computed value.
    pub(super) fn read(&mut self, to: ValueName, from: ValueName) {
        for vector in 0..self.parts(to).len() as u32 {
            let [to, from] = [to, from].map(|name| self.part(name, vector));
            let class = self.class(self.name(to));
            let there = self.register_of(from);
            if let Some(register) = there {
                self.lock(register);
            }
            let register = self.take(class);
            self.bind(to, register);
            match there {
                Some(there) => self.emit(copy(register, there), &[from], to),
                None => {
                    let memory = self.home(from);
                    self.emit(load(register, memory), &[from], to);
                }
            }
            self.locked = 0;
        }
    }

    /// Stores all vectors of a value at consecutive addresses.
    fn store_at(&mut self, value: ValueName, first: impl Fn(&mut Self) -> Memory) {
        let class = self.class(value);
        for vector in 0..self.vectors {
            let part = self.part(value, vector);
            let register = if class == 1 { self.mask_register(part) + MASKS } else { self.fetch(part) };
            let mut to = first(self);
            to.displacement += (vector as usize * self.shape.bytes) as i32;
            self.emit(store(register, to), &[part], NONE);
            self.locked = 0;
        }
    }

    pub(super) fn keep(&mut self, slot: usize, value: ValueName) {
        let displacement = self.strip_displacement(slot);
        self.store_at(value, |_| Memory::at(Gpr::R8, displacement));
    }

    pub(super) fn output(&mut self, plane: usize, value: ValueName) {
        let plane = i32::try_from(8 * (self.planes + plane)).expect("planes are limited");
        self.store_at(value, |state| {
            state.integer(Integer::LoadPointer { to: Gpr::Rax, from: Memory::at(Gpr::Rdi, plane) });
            Memory { base: Base::Sum(Gpr::Rax, Gpr::Rcx, 1), displacement: 0, is_one: false }
        });
    }
}
