//! The contents of registers at the top of a loop: decided and loaded when the loop opens.

use super::event::{Event, ValuePart};
use super::inst::{Binary, Condition, Inst, Operand};
use super::linear::{Definition, LoopId, NONE, Over, Phi, ValueName};
use super::state::{MASKS, OpenLoop, REGISTERS, Register, SPARE_MASK, WalkState, copy, store};

impl WalkState<'_> {
    /// Closes a loop.
    pub(super) fn close_loop(&mut self, id: LoopId) {
        match self.linear.loops[id as usize].over {
            Over::Strips | Over::RowsOfStrip(_) => self.clear(),
            Over::Points | Over::Rows(_) | Over::Guard(_) => self.put_back(id),
        }
        self.event(Event::Close);
        let open = self.open.pop().expect("a loop opens before it closes");
        if let Some(label) = open.early {
            self.integer(Inst::Here(label));
        }
        for part in self.journal.split_off(open.journal) {
            self.stored[part as usize] = false;
        }
        self.reserve();
        self.look_up_again();
        self.end(id, &open);
    }

    /// Opens a loop.
    pub(super) fn open_loop(&mut self, id: LoopId) {
        self.find(id);
        match self.linear.loops[id as usize].over {
            // Between loops over points all registers are empty.
            Over::Strips | Over::RowsOfStrip(_) => self.clear(),
            Over::Points | Over::Rows(_) | Over::Guard(_) => self.fill(id),
        }
        let (top, exit) = (self.label(), self.label());
        let has_gate = !self.linear.loops[id as usize].gate.is_empty();
        let early = has_gate.then(|| self.label());
        let header = self.occupant;
        self.open.push(OpenLoop { id, header, journal: self.journal.len(), top, exit, early });
        self.reserve();
        self.look_up_again();
        self.event(Event::Open);
        self.begin(id, top);
    }

    /// Ends the iteration of the innermost loop here if the values of its gate have the gate's bits in all
    /// lanes.
    pub(super) fn skip(&mut self, id: LoopId) {
        self.put_header_back();
        let linear = self.linear;
        let gate = &linear.loops[id as usize].gate;
        let wanted = |&(name, bits): &(ValueName, u32)| self.parts(name).map(move |part| (part, bits));
        let parts: Vec<(ValuePart, u32)> = gate.iter().flat_map(wanted).collect();
        let tested = match (&parts[..], self.register_of(parts[0].0)) {
            ([(_, 0)], Some(register)) => register,
            (_, _) => self.different_bits(&parts),
        };
        if self.shape.has_masks {
            self.emit(Inst::TestToMask { to: SPARE_MASK, a: tested }, &[], NONE);
            self.emit(Inst::TestMask { a: SPARE_MASK }, &[], NONE);
        } else {
            self.emit(Inst::Test { a: tested }, &[], NONE);
        }
        self.event(Event::Skip);
        let early = self.open.last().and_then(|open| open.early);
        let to = early.expect("a loop knows whether its rounds end early");
        self.integer(Inst::Jump { condition: Condition::Equal, to });
    }

    /// A register with all differences between some parts and their wanted bits. Its old contents must be
    /// unused.
    fn different_bits(&mut self, parts: &[(ValuePart, u32)]) -> Register {
        let header = self.open.last().expect("a loop is open").header;
        let is_empty = |&register: &Register| self.occupant[register as usize] == NONE;
        let is_free = |&register: &Register| header[register as usize] == NONE;
        let (mut free, rest): (Vec<_>, Vec<_>) = self.registers(0).filter(is_free).partition(is_empty);
        free.extend(rest);
        // They are empty at the top, where [`choose`](Self::choose) leaves some free.
        let [all, one] = [free[0], free[1]];
        self.vacate(all);
        self.vacate(one);
        let mut so_far = None;
        for &(part, bits) in parts {
            let to = if so_far.is_none() { all } else { one };
            let mut place = self.register_of(part);
            if place.is_none() && (bits != 0 || so_far.is_none()) {
                self.load_into(to, part);
                place = Some(to);
            }
            let mut read = part;
            if let Some(a) = place.filter(|_| bits != 0) {
                let b = Operand::Memory(self.number(bits));
                self.emit(Inst::Binary { op: Binary::Xor, to, a, b }, &[part, NONE], NONE);
                (place, read) = (Some(to), NONE);
            }
            so_far = match (so_far, place) {
                (None, place) => place,
                (Some(a), place) => {
                    let b = place.map_or_else(|| Operand::Memory(self.home(part)), Operand::Register);
                    self.emit(Inst::Binary { op: Binary::Or, to: all, a, b }, &[NONE, read], NONE);
                    Some(all)
                }
            };
        }
        so_far.expect("a gate asks for something")
    }

    /// Restores the values that the top of an iteration relies on, and keeps or spills the other values.
    fn put_header_back(&mut self) {
        let header = self.open.last().expect("a loop is open").header;
        for (register, &part) in (0..).zip(&header) {
            if part == NONE || self.occupant[register as usize] == part {
                continue;
            }
            self.vacate(register);
            match self.register_of(part) {
                Some(source) => {
                    self.emit(copy(register, source), &[part], part);
                    self.release(part);
                }
                None => self.load_into(register, part),
            }
            self.bind(part, register);
        }
    }

    /// Records the registers in which accumulators of the innermost loop begin an iteration.
    fn reserve(&mut self) {
        self.reserved = 0;
        let Some(open) = self.open.last() else { return };
        for (register, &part) in open.header.iter().enumerate() {
            if part != NONE && self.linear.names[self.name(part) as usize].kind == Definition::Phi(open.id) {
                self.reserved |= 1 << register;
            }
        }
    }

    /// Empties all registers.
    fn clear(&mut self) {
        for register in 0..REGISTERS {
            self.vacate(register as Register);
        }
    }

    /// Decides the contents of registers at the top of each iteration, and loads them.
    fn fill(&mut self, id: LoopId) {
        let chosen = self.choose(id);
        let linear = self.linear;
        let phis = &linear.loops[id as usize].phis;
        let mut initials: Vec<ValueName> = phis.iter().map(|phi| phi.initial).collect();
        initials.sort_unstable();
        let mut copies = Vec::new();
        for phi in phis {
            let is_chosen = chosen.contains(&phi.value);
            let before = initials.partition_point(|&initial| initial < phi.initial);
            let is_alone = initials.get(before + 1) != Some(&phi.initial);
            for vector in 0..self.vectors {
                let (to, from) = (self.part(phi.value, vector), self.part(phi.initial, vector));
                if !self.take_over(from, to, is_alone, is_chosen) {
                    copies.push((from, to, is_chosen));
                }
            }
        }
        for &(from, to, _) in copies.iter().filter(|&&(_, _, is_chosen)| !is_chosen) {
            self.begin_in_frame(from, to);
        }
        let is_source =
            |part: ValuePart| copies.iter().any(|&(from, _, is_chosen)| is_chosen && from == part);
        for register in 0..REGISTERS as Register {
            let part = self.occupant[register as usize];
            if part != NONE && !chosen.contains(&self.name(part)) && !is_source(part) {
                self.leave_register(part);
            }
        }
        for &(from, to, _) in copies.iter().filter(|&&(_, _, is_chosen)| is_chosen) {
            self.begin_in_register(from, to);
        }
        for &(from, ..) in &copies {
            if self.register_of(from).is_some() && !chosen.contains(&self.name(from)) {
                self.leave_register(from);
            }
        }
        if !matches!(linear.loops[id as usize].over, Over::Guard(_)) {
            self.load_chosen(&chosen, phis);
        }
        for phi in phis {
            for part in self.parts(phi.value) {
                self.stored[part as usize] = self.register_of(part).is_none();
            }
        }
    }

    /// Takes a part out of its register; stores it if it has a later use.
    fn leave_register(&mut self, part: ValuePart) {
        if !self.dies(self.name(part)) {
            self.store(part);
        }
        self.release(part);
    }

    /// Loads chosen values that are in no register, as far as registers are free.
    fn load_chosen(&mut self, chosen: &[ValueName], phis: &[Phi]) {
        for &name in chosen {
            if phis.iter().any(|phi| phi.value == name) {
                continue;
            }
            for part in self.parts(name) {
                if self.register_of(part).is_none()
                    && let Some(register) = self.free_register(self.class(name))
                {
                    self.load_into(register, part);
                    self.bind(part, register);
                }
            }
        }
    }

    /// Lets an accumulator begin in the place of its initial value, if nothing else needs that value.
    fn take_over(&mut self, from: ValuePart, to: ValuePart, is_alone: bool, is_chosen: bool) -> bool {
        let name = self.name(from);
        let is_mine = is_alone && self.dies(name) && !self.is_leaf(name);
        if !is_mine || self.linear.names[name as usize].is_uniform {
            return false;
        }
        match (is_chosen, self.register_of(from)) {
            (true, Some(register)) => {
                self.release(from);
                self.bind(to, register);
            }
            // The place of an accumulator inside of its loop is needed again at the end of the iteration.
            (false, _) if self.stored[from as usize] && self.lives.last[name as usize] == self.position => {
                self.release(from);
                self.hand_over_frame(from, to);
                self.stored[to as usize] = true;
            }
            (true, None) | (false, _) => return false,
        }
        self.event(Event::Rename { from, to });
        true
    }

    /// Stores the initial value of an accumulator that lives in the frame.
    fn begin_in_frame(&mut self, from: ValuePart, to: ValuePart) {
        let class = self.class(self.name(from));
        let register = match self.register_of(from) {
            Some(register) => register,
            None => {
                let register = if class == 1 { MASKS + SPARE_MASK } else { self.take(0) };
                self.load_into(register, from);
                register
            }
        };
        let memory = self.frame_memory(to);
        self.emit(store(register, memory), &[from], to);
        self.stored[to as usize] = true;
    }

    /// Copies the initial value of an accumulator that lives in a register.
    fn begin_in_register(&mut self, from: ValuePart, to: ValuePart) {
        let class = self.class(self.name(to));
        let source = self.register_of(from);
        if let Some(source) = source {
            self.lock(source);
        }
        let register = self.take(class);
        match source {
            Some(source) => self.emit(copy(register, source), &[from], to),
            None => self.load_as(register, from, to),
        }
        self.bind(to, register);
        self.locked = 0;
    }

    /// The values to hold in registers at the top of each iteration, the most valuable first.
    fn choose(&mut self, id: LoopId) -> Vec<ValueName> {
        let data = &self.linear.loops[id as usize];
        let is_guard = matches!(data.over, Over::Guard(_));
        let mut candidates: Vec<(f32, ValueName)> = Vec::new();
        for captured in &self.lives.captured[id as usize] {
            let name = captured.name;
            let is_mine = self.linear.names[name as usize].kind == Definition::Phi(id);
            let is_there = self.parts(name).all(|part| self.register_of(part).is_some());
            if is_mine || is_there || !is_guard {
                candidates.push((self.value_of(name, captured.weight, is_mine), name));
            }
        }
        // A value that the loop does not read may stay in its register, if there is room.
        for register in 0..REGISTERS {
            let part = self.occupant[register];
            if part != NONE && !self.dies(self.name(part)) {
                let weight = if self.is_leaf(self.name(part)) { 0.01 } else { 0.1 };
                candidates.push((weight, self.name(part)));
            }
        }
        candidates.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let spare = if self.shape.has_masks && data.gate.is_empty() { 1 } else { 2 };
        let mut left = [0, 1].map(|class| {
            let registers = self.registers(class).len();
            registers.saturating_sub(self.pressure[id as usize][class] + if class == 0 { spare } else { 0 })
        });
        let mut chosen = Vec::new();
        for (_, name) in candidates {
            let (class, cost) = (self.class(name), self.parts(name).len());
            if cost <= left[class] && !chosen.contains(&name) {
                left[class] -= cost;
                chosen.push(name);
            }
        }
        chosen
    }

    /// The value of holding a name in registers, for each register that it takes.
    fn value_of(&self, name: ValueName, weight: f32, is_accumulator: bool) -> f32 {
        let data = &self.linear.names[name as usize];
        let reads = if data.is_uniform { self.vectors as f32 } else { 1.0 };
        let loads = if self.can_be_operand(name) { 1.0 } else { 2.0 };
        weight * reads * loads * if is_accumulator { 4.0 } else { 1.0 }
    }
}
