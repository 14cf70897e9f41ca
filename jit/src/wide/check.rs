//! An independent check of register allocation: replays the code and tracks what each register and each place
//! in the frame holds.
//!
//! The allocator notes which values each instruction reads and writes. The check does not use the allocator's
//! own places: it takes the places from the finished instructions. A loop is replayed until the facts at its
//! top reach a fixed point.

use std::collections::HashMap;

use super::event::{Event, NEXT, PartPlace, ValuePart};
use super::inst::{Base, Gpr, Inst, Memory, Operand};
use super::linear::{Definition, Home, LinearCode, NONE};
use super::state::MASKS;

/// The part at each place.
type PlaceContents = HashMap<PartPlace, ValuePart>;

/// A finished walk.
pub(crate) struct Replay<'a> {
    pub(crate) linear: &'a LinearCode,
    pub(crate) vectors: u32,
    pub(crate) vector_bytes: usize,
    pub(crate) has_masks: bool,
    pub(crate) code: &'a [Inst],
    pub(crate) notes: &'a [([ValuePart; 3], ValuePart)],
    pub(crate) events: &'a [(usize, Event)],
    pub(crate) constants: &'a [u8],
}

impl Replay<'_> {
    /// The first instruction that reads a wrong part, in words.
    pub(crate) fn check(&self) -> Result<(), String> {
        let mut contents = PlaceContents::new();
        self.walk(0, 0, &mut contents)?;
        Ok(())
    }

    /// Replays from an instruction and an event to the end of the innermost loop; returns the position of
    /// that end.
    fn walk(
        &self,
        mut at: usize,
        mut event: usize,
        contents: &mut PlaceContents,
    ) -> Result<(usize, usize), String> {
        // The contents at early ends of iterations.
        let mut early: Vec<PlaceContents> = Vec::new();
        loop {
            let next = self.events.get(event);
            match next {
                Some(&(place, what)) if place == at => {
                    event += 1;
                    match what {
                        Event::Rename { from, to } => {
                            let mut places = contents.values_mut().filter(|part| **part == from).peekable();
                            if places.peek().is_none() {
                                return Err(format!("{at}: part {from} is nowhere and becomes {to}"));
                            }
                            places.for_each(|part| *part = to);
                        }
                        Event::Next { from, to, at: place } => {
                            let there = contents.insert(place, to | NEXT);
                            if there != Some(from) {
                                return Err(format!("{at}: part {from} is not at {place:?}, to become {to}"));
                            }
                        }
                        Event::Skip => early.push(contents.clone()),
                        Event::Close => {
                            let next: Vec<ValuePart> = contents
                                .values()
                                .filter(|&&part| part & NEXT != 0)
                                .map(|part| part ^ NEXT)
                                .collect();
                            contents.retain(|_, part| !next.contains(part));
                            contents.values_mut().for_each(|part| *part &= !NEXT);
                            contents.retain(|place, part| early.iter().all(|it| it.get(place) == Some(part)));
                            return Ok((at, event));
                        }
                        Event::Open => loop {
                            let mut round = contents.clone();
                            let end = self.walk(at, event, &mut round)?;
                            let before = contents.len();
                            contents.retain(|place, part| round.get(place) == Some(part));
                            if contents.len() == before {
                                (at, event) = end;
                                break;
                            }
                        },
                    }
                }
                Some(_) | None if at < self.code.len() => {
                    self.step(at, contents)?;
                    at += 1;
                }
                Some(_) | None => return Ok((at, event)),
            }
        }
    }

    /// Replays one instruction.
    fn step(&self, at: usize, contents: &mut PlaceContents) -> Result<(), String> {
        let inst = &self.code[at];
        let (reads, write) = self.places(inst);
        let (read_parts, written) = &self.notes[at];
        for (place, &part) in reads.into_iter().zip(read_parts) {
            let (Some(place), true) = (place, part != NONE) else { continue };
            let is_there = match place {
                PartPlace::Elsewhere(memory) => self.is_home(memory, part),
                PartPlace::Register(_) | PartPlace::Frame(_) => contents.get(&place) == Some(&part),
            };
            if !is_there {
                let there = contents.get(&place);
                return Err(format!("{at}: {inst:?} reads part {part} at {place:?}, where {there:?} is"));
            }
        }
        match write {
            Some(place @ (PartPlace::Register(_) | PartPlace::Frame(_))) => {
                contents.insert(place, *written);
            }
            Some(PartPlace::Elsewhere(_)) | None => {}
        }
        Ok(())
    }

    /// Whether an address is the home of a leaf.
    fn is_home(&self, memory: Memory, part: ValuePart) -> bool {
        let data = &self.linear.names[(part / self.vectors) as usize];
        let vector = (part % self.vectors) as i32 * self.vector_bytes as i32;
        match data.kind {
            Definition::Computed | Definition::Phi(_) => false,
            Definition::Leaf(Home::Number(bits)) => {
                let at = memory.displacement as usize;
                memory.base == Base::Constants && self.constants[at..at + 4] == bits.to_le_bytes()
            }
            Definition::Leaf(Home::Column(_, column)) => {
                memory.is_one && memory.displacement == 4 * column as i32
            }
            Definition::Leaf(Home::Input(_)) => !memory.is_one && memory.displacement == vector,
            Definition::Leaf(Home::Slot(_)) => memory.base == Base::Register(Gpr::R8),
        }
    }

    /// The places that an instruction reads, in the order of its note, and the place that it writes.
    fn places(&self, inst: &Inst) -> ([Option<PartPlace>; 3], Option<PartPlace>) {
        let vector = |number: u8| Some(PartPlace::Register(number));
        let mask = |number: u8| Some(PartPlace::Register(MASKS + number));
        let operand = |operand: Operand| match operand {
            Operand::Register(number) => vector(number),
            Operand::Memory(memory) => Some(in_memory(memory)),
        };
        let condition = |number| if self.has_masks { mask(number) } else { vector(number) };
        match *inst {
            Inst::Binary { to, a, b, .. } => ([vector(a), operand(b), None], vector(to)),
            Inst::Sqrt { to, a } => ([operand(a), None, None], vector(to)),
            Inst::Fma { to, b, c, .. } => ([vector(to), vector(b), operand(c)], vector(to)),
            Inst::Shift { to, a, .. } => ([vector(a), None, None], vector(to)),
            Inst::Compare { to, a, b, .. } => ([vector(a), operand(b), None], condition(to)),
            Inst::Blend { to, mask, no, yes } => ([condition(mask), vector(no), operand(yes)], vector(to)),
            Inst::Test { a } => ([vector(a), None, None], None),
            Inst::TestToMask { to, a } => ([vector(a), None, None], mask(to)),
            Inst::TestMask { a } => ([mask(a), None, None], None),
            Inst::Zero { to } => ([None; 3], vector(to)),
            Inst::Move { to, from } => ([vector(from), None, None], vector(to)),
            Inst::Load { to, from } => ([Some(in_memory(from)), None, None], vector(to)),
            Inst::Store { to, from } => ([vector(from), None, None], Some(in_memory(to))),
            Inst::MaskAnd { to, a, b } | Inst::MaskOr { to, a, b } => ([mask(a), mask(b), None], mask(to)),
            Inst::MaskNot { to, a } => ([mask(a), None, None], mask(to)),
            Inst::MaskMove { to, from } => ([mask(from), None, None], mask(to)),
            Inst::MaskLoad { to, from } => ([Some(in_memory(from)), None, None], mask(to)),
            Inst::MaskStore { to, from } => ([mask(from), None, None], Some(in_memory(to))),
            Inst::Integer(_) | Inst::Jump { .. } | Inst::Here(_) => ([None; 3], None),
        }
    }
}

fn in_memory(memory: Memory) -> PartPlace {
    match memory.base {
        Base::Register(Gpr::Rsp) => PartPlace::Frame(memory.displacement),
        Base::Register(_) | Base::Sum(..) | Base::Constants => PartPlace::Elsewhere(memory),
    }
}
