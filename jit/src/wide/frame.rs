//! Memory of values: homes of leaves, and the frame for computed values.

use jbt_ir::Entity;

use super::counters::SAVED_BYTES;
use super::event::ValuePart;
use super::inst::{Base, Gpr, Inst, Memory};
use super::linear::{Definition, Home, NONE, ValueName};
use super::state::{NOWHERE, Register, SAVED, WalkState, load, store};

impl WalkState<'_> {
    /// The place of a part in the frame; the first call allocates it.
    pub(super) fn frame_memory(&mut self, part: ValuePart) -> Memory {
        if self.frame[part as usize] == NONE {
            self.frame[part as usize] = self.fresh_slot().0;
        }
        Memory::at(Gpr::Rsp, self.slot_displacement(self.frame[part as usize]))
    }

    fn slot_displacement(&self, slot: u32) -> i32 {
        let saved = SAVED as usize + SAVED_BYTES * self.linear.depth.saturating_sub(2);
        let first = saved.next_multiple_of(self.shape.bytes);
        i32::try_from(first + slot as usize * self.shape.bytes).expect("values and vectors are limited")
    }

    /// Bytes of the frame, without slots of strips.
    pub(crate) fn frame_bytes(&self) -> usize {
        self.slot_displacement(self.frame_slots) as usize
    }

    /// Gives the frame's place of a part to another part with the same bits.
    pub(super) fn hand_over_frame(&mut self, from: ValuePart, to: ValuePart) {
        self.frame[to as usize] = std::mem::replace(&mut self.frame[from as usize], NONE);
        self.stored[from as usize] = false;
    }

    /// Stores a part if it is in no memory yet.
    pub(super) fn store(&mut self, part: ValuePart) {
        if self.stored[part as usize] || self.is_leaf(self.name(part)) {
            return;
        }
        let from = self.place[part as usize];
        debug_assert_ne!(from, NOWHERE, "a value is somewhere");
        let to = self.frame_memory(part);
        self.emit(store(from, to), &[part], part);
        self.stored[part as usize] = true;
        self.journal.push(part);
    }

    /// Releases the registers and the memory of a name.
    pub(super) fn bury(&mut self, name: ValueName) {
        for part in self.parts(name) {
            self.release(part);
            let slot = std::mem::replace(&mut self.frame[part as usize], NONE);
            if slot != NONE {
                self.free.push(slot);
            }
            self.stored[part as usize] = false;
        }
    }

    /// Ends a live range of a name at the current position; for an accumulator this may be only the range
    /// inside of its loop.
    pub(crate) fn end_life(&mut self, name: ValueName) {
        if self.lives.last[name as usize] == self.position {
            return self.bury(name);
        }
        if let Definition::Phi(id) = self.linear.names[name as usize].kind
            && self.linear.loops[id as usize].close != self.position
        {
            // It is set again at the end of the iteration, in the same place.
            for part in self.parts(name) {
                self.release(part);
            }
        }
    }

    /// Where memory has a part. A column is one f32 at the row's address (see `counters`) plus 4 times its
    /// index: `vbroadcastss` loads it, or with AVX-512 the arithmetic instruction broadcasts it. The address
    /// may be in `rax`, so it holds until the next instruction only.
    pub(super) fn home(&mut self, part: ValuePart) -> Memory {
        let name = self.name(part);
        let vector = (part - name * self.vectors) as i32;
        let displacement = vector * self.shape.bytes as i32;
        match self.linear.names[name as usize].kind {
            Definition::Computed | Definition::Phi(_) => {
                debug_assert!(self.stored[part as usize], "a value is somewhere");
                self.frame_memory(part)
            }
            Definition::Leaf(Home::Number(bits)) => self.number(bits),
            Definition::Leaf(Home::Column(table, column)) => {
                let base = Base::Register(self.row(table.index()));
                let displacement = i32::try_from(4 * column).expect("a row has fewer bytes");
                Memory { base, displacement, is_one: true }
            }
            Definition::Leaf(Home::Input(plane)) => self.input(plane, displacement),
            Definition::Leaf(Home::Slot(slot)) => {
                Memory::at(Gpr::R8, self.strip_displacement(slot.0) + displacement)
            }
        }
    }

    pub(super) fn strip_displacement(&self, slot: usize) -> i32 {
        i32::try_from(slot * self.strip_bytes).expect("a plan with so many slots is not made")
    }

    /// The place of a number among the constants.
    pub(super) fn number(&mut self, bits: u32) -> Memory {
        let copies = if self.shape.has_masks { 1 } else { self.shape.bytes / 4 };
        let constants = &mut self.constants;
        let displacement = *self.numbers.entry(bits).or_insert_with(|| {
            let at = constants.len() as i32;
            (0..copies).for_each(|_| constants.extend(bits.to_le_bytes()));
            at
        });
        Memory { base: Base::Constants, displacement, is_one: self.shape.has_masks }
    }

    /// Whether an arithmetic instruction can read a part from its memory. AVX2 has no operands that
    /// broadcast, so there columns are loaded first.
    pub(super) fn can_be_operand(&self, name: ValueName) -> bool {
        let is_column = matches!(self.linear.names[name as usize].kind, Definition::Leaf(Home::Column(..)));
        self.class(name) == 0 && (self.shape.has_masks || !is_column)
    }

    /// A place in the frame that belongs to no part, and its number.
    pub(super) fn fresh_slot(&mut self) -> (u32, Memory) {
        let slot = self.free.pop().unwrap_or_else(|| {
            self.frame_slots += 1;
            self.frame_slots - 1
        });
        (slot, Memory::at(Gpr::Rsp, self.slot_displacement(slot)))
    }

    /// Releases such places.
    pub(super) fn give_back(&mut self, slots: Vec<u32>) {
        self.free.extend(slots);
    }

    /// Loads a part into a register.
    pub(super) fn load_into(&mut self, register: Register, part: ValuePart) {
        self.load_as(register, part, part);
    }

    /// Loads a part into a register, as another part.
    pub(super) fn load_as(&mut self, register: Register, part: ValuePart, to: ValuePart) {
        let is_zero =
            matches!(self.linear.names[self.name(part) as usize].kind, Definition::Leaf(Home::Number(0)));
        if is_zero {
            self.emit(Inst::Zero { to: register }, &[], to);
            return;
        }
        let from = self.home(part);
        self.emit(load(register, from), &[part], to);
    }

    /// The register of a part, which is loaded if necessary.
    pub(super) fn fetch(&mut self, part: ValuePart) -> Register {
        let name = self.name(part);
        let register = self.register_of(part).unwrap_or_else(|| {
            let register = self.take(self.class(name));
            self.load_into(register, part);
            self.bind(part, register);
            register
        });
        self.lock(register);
        register
    }
}
