//! Moves at the end of an iteration that restore the contents of registers at its top: next values of
//! accumulators, and values that were spilled in between. The moves are parallel: all sources are read before
//! any target is written, in an order that needs few extra places.

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use super::event::{Event, NEXT, PartPlace, ValuePart};
use super::inst::Memory;
use super::linear::{Definition, LoopId, NONE};
use super::state::{MASKS, REGISTERS, Register, SPARE_MASK, WalkState, copy, load, store};

/// The place of a value that a transfer reads.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum TransferSource {
    Register(Register),
    Memory(Memory),
    Leaf,
}

/// A value that has to be at another place when an iteration begins.
#[derive(Clone, Copy)]
struct Transfer {
    from: ValuePart,
    source: TransferSource,
    /// The part that it becomes there.
    to: ValuePart,
    /// [`TransferSource::Register`] or [`TransferSource::Memory`].
    target: TransferSource,
}

impl WalkState<'_> {
    /// Restores all values that the top of an iteration relies on.
    pub(super) fn put_back(&mut self, id: LoopId) {
        let header = self.open.last().expect("the loop is open").header;
        let (mut transfers, mut renames) = self.transfers(id, &header);
        // A move from memory to memory, or a move through memory because its target is also a source.
        let sources: HashSet<TransferSource> = transfers.iter().map(|transfer| transfer.source).collect();
        let needs_register = transfers.iter().any(|transfer| {
            matches!(transfer.target, TransferSource::Memory(_))
                && self.class(self.name(transfer.to)) == 0
                && (!matches!(transfer.source, TransferSource::Register(_))
                    || sources.contains(&transfer.target))
        });
        let mut spare = MASKS;
        if needs_register {
            // A register that is empty at the top. There is one, since [`choose`](Self::choose) does not give
            // away all.
            let mut registers = self.registers(0);
            spare = registers.find(|&register| header[register as usize] == NONE).unwrap_or(0);
            self.vacate(spare);
            (transfers, renames) = self.transfers(id, &header);
        }
        self.transfer_all(transfers, spare);
        for (from, to, at) in renames {
            if from != to {
                self.event(Event::Next { from, to, at });
            }
        }
        for register in 0..REGISTERS {
            let part = self.occupant[register];
            if part != NONE {
                self.release(part);
            }
        }
        for (register, &part) in header.iter().enumerate().filter(|&(_, &part)| part != NONE) {
            self.bind(part, register as Register);
        }
    }

    /// Transfers as if all sources were read before the first target is written.
    fn transfer_all(&mut self, mut transfers: Vec<Transfer>, spare: Register) {
        if transfers.is_empty() {
            return;
        }
        // Registers first: where only cycles are left, a cycle is broken at a register.
        transfers.sort_by_key(|transfer| !matches!(transfer.source, TransferSource::Register(_)));
        // The readers of a place, how many of them are still pending, and the writer of the place.
        let mut readers: HashMap<TransferSource, (Vec<usize>, usize)> = HashMap::default();
        let mut writer: HashMap<TransferSource, usize> = HashMap::default();
        for (index, transfer) in transfers.iter().enumerate() {
            let (list, left) = readers.entry(transfer.source).or_default();
            list.push(index);
            *left += 1;
            writer.insert(transfer.target, index);
        }
        let is_read = |index: &usize| readers.contains_key(&transfers[*index].target);
        let mut ready: Vec<usize> = (0..transfers.len()).filter(|index| !is_read(index)).collect();
        let (mut is_done, mut first) = (vec![false; transfers.len()], 0);
        let mut fresh = Vec::new();
        while first < transfers.len() {
            let Some(index) = ready.pop() else {
                if is_done[first] {
                    first += 1;
                    continue;
                }
                let aside = transfers[first].source;
                let memory = self.set_aside(transfers[first], spare, &mut fresh);
                let (list, _) = readers.remove(&aside).unwrap_or_default();
                for index in list {
                    transfers[index].source = TransferSource::Memory(memory);
                }
                ready.extend(writer.get(&aside));
                continue;
            };
            is_done[index] = true;
            self.transfer(transfers[index], spare);
            let source = transfers[index].source;
            if let Some((_, left)) = readers.get_mut(&source) {
                *left -= 1;
                if *left == 0 {
                    ready.extend(writer.get(&source).filter(|&&next| !is_done[next]));
                }
            }
        }
        self.give_back(fresh);
    }

    /// All values that are not in their places, and all accumulators that are.
    fn transfers(
        &mut self,
        id: LoopId,
        header: &[ValuePart; REGISTERS],
    ) -> (Vec<Transfer>, Vec<(ValuePart, ValuePart, PartPlace)>) {
        let linear = self.linear;
        let (mut transfers, mut renames) = (Vec::new(), Vec::new());
        for phi in &linear.loops[id as usize].phis {
            for vector in 0..self.vectors {
                let (from, to) = (self.part(phi.next, vector), self.part(phi.value, vector));
                let target = match header.iter().position(|&part| part == to) {
                    Some(register) => TransferSource::Register(register as Register),
                    None => TransferSource::Memory(self.frame_memory(to)),
                };
                let source = self.whereabouts(from);
                if source == target {
                    let place = match target {
                        TransferSource::Register(register) => PartPlace::Register(register),
                        TransferSource::Memory(memory) => PartPlace::Frame(memory.displacement),
                        TransferSource::Leaf => unreachable!("leaves are not written"),
                    };
                    renames.push((from, to, place));
                } else {
                    transfers.push(Transfer { from, source, to, target });
                }
            }
        }
        for (register, &part) in header.iter().enumerate() {
            let is_phi = part != NONE && linear.names[self.name(part) as usize].kind == Definition::Phi(id);
            if part == NONE || is_phi || usize::from(self.place[part as usize]) == register {
                continue;
            }
            let (source, target) = (self.whereabouts(part), TransferSource::Register(register as Register));
            transfers.push(Transfer { from: part, source, to: part, target });
        }
        (transfers, renames)
    }

    fn whereabouts(&mut self, part: ValuePart) -> TransferSource {
        match self.register_of(part) {
            Some(register) => TransferSource::Register(register),
            None if self.is_leaf(self.name(part)) => TransferSource::Leaf,
            None => TransferSource::Memory(self.frame_memory(part)),
        }
    }

    fn transfer(&mut self, Transfer { from, source, to, target }: Transfer, spare: Register) {
        let next = |part: ValuePart| if part == from { part } else { part | NEXT };
        let mask = MASKS + SPARE_MASK;
        let spare = if self.class(self.name(to)) == 1 { mask } else { spare };
        match (source, target) {
            (TransferSource::Register(source), TransferSource::Register(target)) => {
                self.emit(copy(target, source), &[from], next(to));
            }
            (TransferSource::Register(source), TransferSource::Memory(target)) => {
                self.emit(store(source, target), &[from], next(to));
            }
            (TransferSource::Memory(source), TransferSource::Register(target)) => {
                self.emit(load(target, source), &[from], next(to));
            }
            (TransferSource::Leaf, TransferSource::Register(target)) => self.load_as(target, from, next(to)),
            (TransferSource::Memory(source), TransferSource::Memory(target)) => {
                self.emit(load(spare, source), &[from], from);
                self.emit(store(spare, target), &[from], next(to));
            }
            (TransferSource::Leaf, TransferSource::Memory(target)) => {
                self.load_into(spare, from);
                self.emit(store(spare, target), &[from], next(to));
            }
            (_, TransferSource::Leaf) => unreachable!("leaves are not written"),
        }
    }

    /// Copies the source of a transfer to a fresh place.
    fn set_aside(&mut self, transfer: Transfer, spare: Register, fresh: &mut Vec<u32>) -> Memory {
        let (slot, memory) = self.fresh_slot();
        fresh.push(slot);
        let target = TransferSource::Memory(memory);
        self.transfer(Transfer { to: transfer.from, target, ..transfer }, spare);
        memory
    }
}
