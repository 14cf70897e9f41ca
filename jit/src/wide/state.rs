//! Register allocation: which value is in which register, and what to spill.
//!
//! The list is walked once. An item's operand is read from its register, or from memory if the instruction
//! can do that. The result takes the register of an operand that dies, a free register, or the register of
//! the value whose next use is farthest. A value is stored at most once, when it is spilled for the first
//! time; a leaf is never stored.
//!
//! The contents of registers at the top of a loop are decided when the loop opens ([`super::loops`]), and
//! restored at the end of each iteration. So a register holds the same value at the top of each iteration.

use rustc_hash::FxHashMap as HashMap;

use super::encode::Shape;
use super::event::{Event, ValuePart};
use super::inst::{Inst, Label, Memory};
use super::linear::{Definition, LinearCode, LoopId, NONE, ValueName};
use super::lives::Lives;

/// A register: 0 to 31 are vectors, from 32 on masks. The first mask register is unused.
pub(crate) type Register = u8;

/// The difference between a mask register's number here and in an instruction.
pub(crate) const MASKS: Register = 32;
/// All registers.
pub(crate) const REGISTERS: usize = 40;
/// No register.
pub(crate) const NOWHERE: Register = u8::MAX;
/// The mask register for operands that are in no register.
pub(crate) const SPARE_MASK: u8 = 7;

/// Words at the start of the frame: first the caller's stack pointer, then a strip's start and the bytes of
/// the planes.
pub(crate) const STRIP_START: i32 = 8;
pub(crate) const ALL_BYTES: i32 = 16;
/// Where the integer registers of outer loops are saved.
pub(crate) const SAVED: i32 = 24;

/// How many registers may be used: vectors and masks.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct RegisterCount(pub(crate) [u8; 2]);

impl RegisterCount {
    /// The registers of a class.
    fn registers(self, class: usize) -> std::ops::Range<Register> {
        if class == 0 { 0..self.0[0] } else { MASKS + 1..MASKS + 1 + self.0[1] }
    }
}

/// An open loop.
pub(super) struct OpenLoop {
    pub(super) id: LoopId,
    /// The contents of the registers at the top of each iteration.
    pub(super) header: [ValuePart; REGISTERS],
    /// The length of the journal when the loop opened.
    pub(super) journal: usize,
    /// Where an iteration begins, and where the loop is left.
    pub(super) top: Label,
    pub(super) exit: Label,
    /// The target of early ends of iterations.
    pub(super) early: Option<Label>,
}

/// The walk over a list.
pub(crate) struct WalkState<'a> {
    pub(super) linear: &'a LinearCode,
    pub(super) lives: &'a Lives,
    /// The number of registers that each loop needs for the values that it computes.
    pub(super) pressure: Vec<[usize; 2]>,
    /// The number of vectors of a value.
    pub(super) vectors: u32,
    pub(super) shape: Shape,
    pub(super) count: RegisterCount,
    /// The number of input planes of the function: output planes follow them.
    pub(super) planes: usize,
    pub(super) strip_bytes: usize,
    pub(super) strides: Vec<usize>,
    pub(super) parents: Vec<Option<usize>>,

    pub(crate) code: Vec<Inst>,
    /// The parts that each instruction reads and writes, if the code is to be checked.
    pub(crate) notes: Option<Vec<([ValuePart; 3], ValuePart)>>,
    /// Events between instructions, for the same purpose.
    pub(crate) events: Vec<(usize, Event)>,
    pub(crate) labels: u32,
    pub(crate) constants: Vec<u8>,
    pub(super) numbers: HashMap<u32, i32>,
    /// Instructions that take the address of the first slot of a strip, which is known at the end.
    pub(crate) slot_addresses: Vec<usize>,

    /// What each register holds.
    pub(super) occupant: [ValuePart; REGISTERS],
    /// A bit for each register that holds a part.
    full: u64,
    /// The registers of each class, as bits.
    classes: [u64; 2],
    /// The next use of each register's part, and a bit for each register whose entry is valid.
    wanted: [u32; REGISTERS],
    looked_up: u64,
    /// The register of each part.
    pub(super) place: Vec<Register>,
    /// Whether the frame holds each part.
    pub(super) stored: Vec<bool>,
    /// The place of each part in the frame, if it has one.
    pub(super) frame: Vec<u32>,
    pub(super) free: Vec<u32>,
    pub(crate) frame_slots: u32,
    /// Parts that have been stored while loops are open, in order.
    pub(super) journal: Vec<ValuePart>,
    /// How many uses of each name the walk has passed.
    passed: Vec<u32>,
    /// The registers that the current instruction needs, as bits.
    pub(super) locked: u64,
    pub(super) position: u32,
    pub(super) open: Vec<OpenLoop>,
    /// The registers in which accumulators of the innermost loop begin an iteration.
    pub(super) reserved: u64,
    /// The accumulator whose next value a name is.
    pub(super) becomes: Vec<ValueName>,
    /// The loop over each table.
    pub(super) rows: Vec<Option<usize>>,
    /// The number of open folds.
    pub(super) depth: usize,
}

/// The input of a walk.
pub(crate) struct WalkInput<'a> {
    pub(crate) linear: &'a LinearCode,
    pub(crate) lives: &'a Lives,
    pub(crate) vectors: usize,
    pub(crate) shape: Shape,
    pub(crate) count: RegisterCount,
    pub(crate) planes: usize,
    pub(crate) strip_bytes: usize,
    /// For each table, the bytes of a row and the parent.
    pub(crate) tables: Vec<(usize, Option<usize>)>,
    pub(crate) is_checked: bool,
}

impl<'a> WalkState<'a> {
    pub(crate) fn new(task: WalkInput<'a>) -> Self {
        let WalkInput { linear, lives, vectors, shape, count, planes, strip_bytes, tables, is_checked } =
            task;
        let parts = linear.names.len() * vectors;
        let bits = |registers: std::ops::Range<Register>| registers.map(|register| 1 << register).sum();
        let mut becomes = vec![NONE; linear.names.len()];
        for phi in linear.loops.iter().flat_map(|data| &data.phis) {
            becomes[phi.next as usize] = phi.value;
        }
        Self {
            linear,
            lives,
            pressure: super::lives::pressure(linear, lives, vectors, shape.has_masks),
            vectors: vectors as u32,
            shape,
            count,
            planes,
            strip_bytes,
            strides: tables.iter().map(|&(stride, _)| stride).collect(),
            parents: tables.iter().map(|&(_, parent)| parent).collect(),
            code: Vec::with_capacity(2 * linear.items.len() * vectors),
            notes: is_checked.then(Vec::new),
            events: Vec::new(),
            labels: 0,
            constants: Vec::new(),
            numbers: HashMap::default(),
            slot_addresses: Vec::new(),
            occupant: [NONE; REGISTERS],
            full: 0,
            classes: [0, 1].map(|class| bits(count.registers(class))),
            wanted: [0; REGISTERS],
            looked_up: 0,
            place: vec![NOWHERE; parts],
            stored: vec![false; parts],
            frame: vec![NONE; parts],
            free: Vec::new(),
            frame_slots: 0,
            journal: Vec::new(),
            passed: vec![0; linear.names.len()],
            locked: 0,
            position: 0,
            open: Vec::new(),
            reserved: 0,
            becomes,
            rows: vec![None; tables.len()],
            depth: 0,
        }
    }

    // ── code ─────────────────────────────────────────────────────────────────────────────────────

    /// Appends an instruction on values, with the parts that it reads, in the order of its fields, and the
    /// part that it writes.
    pub(super) fn emit(&mut self, inst: Inst, reads: &[ValuePart], write: ValuePart) {
        self.code.push(inst);
        if let Some(notes) = &mut self.notes {
            let mut all = [NONE; 3];
            all[..reads.len()].copy_from_slice(reads);
            notes.push((all, write));
        }
    }

    /// Appends an instruction on integers, a jump, or a label.
    pub(super) fn integer(&mut self, inst: impl Into<Inst>) {
        self.emit(inst.into(), &[], NONE);
    }

    pub(super) fn event(&mut self, event: Event) {
        if self.notes.is_some() {
            self.events.push((self.code.len(), event));
        }
    }

    pub(super) fn label(&mut self) -> Label {
        self.labels += 1;
        Label(self.labels - 1)
    }

    // ── values ───────────────────────────────────────────────────────────────────────────────────

    pub(super) fn name(&self, part: ValuePart) -> ValueName {
        part / self.vectors
    }

    pub(super) fn part(&self, name: ValueName, vector: u32) -> ValuePart {
        let is_uniform = self.linear.names[name as usize].is_uniform;
        name * self.vectors + if is_uniform { 0 } else { vector }
    }

    /// The parts of a name.
    pub(super) fn parts(&self, name: ValueName) -> std::ops::Range<ValuePart> {
        let count = if self.linear.names[name as usize].is_uniform { 1 } else { self.vectors };
        name * self.vectors..name * self.vectors + count
    }

    /// 0 for a value in vectors, 1 for one in mask registers.
    pub(super) fn class(&self, name: ValueName) -> usize {
        usize::from(self.linear.names[name as usize].is_mask && self.shape.has_masks)
    }

    pub(super) fn is_leaf(&self, name: ValueName) -> bool {
        matches!(self.linear.names[name as usize].kind, Definition::Leaf(_))
    }

    /// The register that a part is in.
    pub(super) fn register_of(&self, part: ValuePart) -> Option<Register> {
        let register = self.place[part as usize];
        (register != NOWHERE).then_some(register)
    }

    /// The next use of the name, at this position or later.
    pub(super) fn next_use(&mut self, name: ValueName) -> u32 {
        let (uses, passed) = (self.lives.uses(name), &mut self.passed[name as usize]);
        while uses.get(*passed as usize).is_some_and(|&at| at < self.position) {
            *passed += 1;
        }
        let end = self.lives.end(self.linear, name, self.position);
        match uses.get(*passed as usize) {
            Some(&at) if at <= end => at,
            // Alive for the next iteration, or dead.
            Some(_) | None => end.max(self.position),
        }
    }

    /// The next use of the name after the current position, if it has one.
    pub(super) fn later_use(&mut self, name: ValueName) -> Option<u32> {
        self.next_use(name);
        let uses = self.lives.uses(name);
        let mut index = self.passed[name as usize] as usize;
        while uses.get(index).is_some_and(|&at| at <= self.position) {
            index += 1;
        }
        let end = self.lives.end(self.linear, name, self.position);
        uses.get(index).copied().filter(|&at| at <= end)
    }

    /// Whether the name has no use after the current position.
    pub(super) fn dies(&self, name: ValueName) -> bool {
        self.lives.end(self.linear, name, self.position) <= self.position
    }

    // ── registers ────────────────────────────────────────────────────────────────────────────────

    /// The registers of a class.
    pub(super) fn registers(&self, class: usize) -> std::ops::Range<Register> {
        self.count.registers(class)
    }

    pub(super) fn lock(&mut self, register: Register) {
        self.locked |= 1 << register;
    }

    /// An empty register, if possible one that no accumulator is to begin an iteration in.
    pub(super) fn free_register(&self, class: usize) -> Option<Register> {
        let free = self.classes[class] & !self.full & !self.locked;
        let best = free & !self.reserved;
        let first = if best == 0 { free } else { best }.trailing_zeros();
        (free != 0).then_some(first as Register)
    }

    /// An empty register; if there is none, one is spilled.
    pub(super) fn take(&mut self, class: usize) -> Register {
        if let Some(register) = self.free_register(class) {
            return register;
        }
        let (mut best, mut best_score) = (NOWHERE, 0);
        let mut left = self.classes[class] & !self.locked;
        while left != 0 {
            let register = left.trailing_zeros() as Register;
            left &= left - 1;
            let part = self.occupant[register as usize];
            let score = 1 + self.reluctance(register, part);
            if score > best_score {
                (best, best_score) = (register, score);
            }
        }
        assert!(best != NOWHERE, "an instruction needs fewer registers than there are");
        self.vacate(best);
        best
    }

    /// The priority of a register for spilling: the distance of the next use of its part, more if nothing has
    /// to be stored.
    fn reluctance(&mut self, register: Register, part: ValuePart) -> u64 {
        let name = self.name(part);
        let index = register as usize;
        // The next use stays the same until the walk passes it.
        if self.looked_up >> register & 1 == 0 || self.wanted[index] < self.position {
            let mut next = self.next_use(name);
            if let Some(open) = self.open.last()
                && open.header[index] == part
            {
                next = next.min(self.linear.loops[open.id as usize].close);
            }
            self.wanted[index] = next;
            self.looked_up |= 1 << register;
        }
        let distance = u64::from(self.wanted[index].saturating_sub(self.position));
        if self.stored[part as usize] || self.is_leaf(name) { 3 * distance } else { 2 * distance }
    }

    /// Forgets the next uses: another loop is the innermost one now.
    pub(super) fn look_up_again(&mut self) {
        self.looked_up = 0;
    }

    /// Empties a register; its part is stored first, if it is still needed.
    pub(super) fn vacate(&mut self, register: Register) {
        let part = self.occupant[register as usize];
        if part == NONE {
            return;
        }
        self.store(part);
        self.release(part);
    }

    /// Records that a part is in no register.
    pub(super) fn release(&mut self, part: ValuePart) {
        let register = std::mem::replace(&mut self.place[part as usize], NOWHERE);
        if register != NOWHERE {
            self.occupant[register as usize] = NONE;
            self.full &= !(1 << register);
        }
    }

    /// Records that a part is in a register, which was empty.
    pub(super) fn bind(&mut self, part: ValuePart, register: Register) {
        debug_assert_eq!(self.occupant[register as usize], NONE, "a register holds one thing");
        self.occupant[register as usize] = part;
        self.full |= 1 << register;
        self.looked_up &= !(1 << register);
        self.place[part as usize] = register;
    }
}

/// The instruction that loads a register of either class.
pub(super) fn load(to: Register, from: Memory) -> Inst {
    if to < MASKS { Inst::Load { to, from } } else { Inst::MaskLoad { to: to - MASKS, from } }
}

/// The instruction that stores a register of either class.
pub(super) fn store(from: Register, to: Memory) -> Inst {
    if from < MASKS { Inst::Store { to, from } } else { Inst::MaskStore { to, from: from - MASKS } }
}

/// The instruction that copies a register to one of the same class.
pub(super) fn copy(to: Register, from: Register) -> Inst {
    if to < MASKS { Inst::Move { to, from } } else { Inst::MaskMove { to: to - MASKS, from: from - MASKS } }
}
