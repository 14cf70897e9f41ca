//! The state of the CPU, and its way through the code.

use std::collections::HashMap;
use std::fmt;

use iced_x86::{Decoder, DecoderOptions, Instruction, Mnemonic, Register};

use super::memory::{CALLER, CODE, Simulated, SimulatedMemory};

/// What went wrong, and where.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct MachineFault {
    what: String,
    at: String,
}

impl fmt::Display for MachineFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, at {}", self.what, self.at)
    }
}

/// Instructions of one run, jumps counted as often as they are met.
const MOST_STEPS: u64 = 1 << 22;
/// What is in lanes before anybody has written them: a NaN.
const POISON: u32 = 0x7FA0_0BAD;
/// Registers that a callee gives back as they were.
const KEPT: [Register; 6] =
    [Register::RBX, Register::RBP, Register::R12, Register::R13, Register::R14, Register::R15];

/// All that instructions change.
pub(super) struct Machine {
    integers: [u64; 16],
    /// Lanes that a vector does not have are 0.
    pub(super) vectors: [[u32; 16]; 32],
    pub(super) masks: [u16; 8],
    /// Of the last comparison: equal, and below as unsigned numbers.
    pub(super) equal: bool,
    pub(super) below: bool,
    pub(super) memory: SimulatedMemory,
}

impl Machine {
    /// As a function finds it: registers hold nothing, but for the upper halves of vectors that the caller
    /// has cleared, see [`crate::memory`].
    pub(super) fn new(memory: SimulatedMemory) -> Self {
        let mut vectors = [[POISON; 16]; 32];
        vectors[..16].iter_mut().for_each(|lanes| lanes[4..].fill(0));
        let integers = [0x5EED_5EED_5EED_5EED; 16];
        Self { integers, vectors, masks: [0x5A5A; 8], equal: false, below: false, memory }
    }

    /// Executes code from its first instruction until it returns.
    pub(super) fn execute(&mut self, code: &[u8]) -> Result<(), MachineFault> {
        let insts: Vec<Instruction> =
            Decoder::with_ip(64, code, CODE, DecoderOptions::NONE).into_iter().collect();
        let positions: HashMap<u64, usize> =
            insts.iter().enumerate().map(|(index, inst)| (inst.ip(), index)).collect();
        let before = KEPT.map(|register| self.get(register));
        let stack = self.get(Register::RSP);
        let mut at = CODE;
        for _ in 0..MOST_STEPS {
            let Some(&index) = positions.get(&at) else {
                let what = "the code jumps to where no instruction begins".to_owned();
                return Err(MachineFault { what, at: format!("{at:x}") });
            };
            let inst = &insts[index];
            let fault = |what| MachineFault { what, at: format!("{:x}: {inst}", inst.ip() - CODE) };
            at = self.step(inst).map_err(fault)?;
            if at == CALLER {
                let is_kept = KEPT.map(|register| self.get(register)) == before;
                // The address that it returned to is no longer on the stack.
                if !is_kept || self.get(Register::RSP) != stack + 8 {
                    return Err(fault("the caller's registers are not as they were".to_owned()));
                }
                // An instruction that clears them leaves those from 16 on as they are.
                if self.vectors[..16].iter().any(|lanes| lanes[4..].iter().any(|&lane| lane != 0)) {
                    return Err(fault("the upper halves of vectors are not cleared".to_owned()));
                }
                return Ok(());
            }
        }
        Err(MachineFault { what: "the code does not end".to_owned(), at: format!("{at:x}") })
    }

    /// Executes one instruction; where the next one is.
    fn step(&mut self, inst: &Instruction) -> Simulated<u64> {
        let next = inst.next_ip();
        let jump = |condition: bool| if condition { inst.near_branch_target() } else { next };
        match inst.mnemonic() {
            Mnemonic::Ja => return Ok(jump(!self.below && !self.equal)),
            Mnemonic::Jb => return Ok(jump(self.below)),
            Mnemonic::Je => return Ok(jump(self.equal)),
            Mnemonic::Jne => return Ok(jump(!self.equal)),
            Mnemonic::Ret => return self.pop(),
            _ => {}
        }
        let is_vector = (0..inst.op_count()).any(|op| {
            let register = inst.op_register(op);
            register.is_vector_register() || register.is_k()
        });
        if is_vector || inst.mnemonic() == Mnemonic::Vzeroupper {
            self.vector(inst)?;
        } else {
            self.integer(inst)?;
        }
        Ok(next)
    }

    /// The number in an integer register; of 32 bits if it has as many.
    pub(super) fn get(&self, register: Register) -> u64 {
        let number = self.integers[register.full_register().number()];
        if register.size() == 4 { number & 0xFFFF_FFFF } else { number }
    }

    /// Writes an integer register: 32 bits clear the others.
    pub(super) fn set(&mut self, register: Register, number: u64) {
        let number = if register.size() == 4 { number & 0xFFFF_FFFF } else { number };
        self.integers[register.full_register().number()] = number;
    }

    /// The address of an instruction's operand in memory.
    pub(super) fn address(&self, inst: &Instruction) -> Simulated<u64> {
        let known = |register: Register| register.is_gpr64().then(|| self.get(register));
        if inst.is_ip_rel_memory_operand() {
            return Ok(inst.ip_rel_memory_address());
        }
        let part = |register| if register == Register::None { Some(0) } else { known(register) };
        let (base, index) = (part(inst.memory_base()), part(inst.memory_index()));
        let (Some(base), Some(index)) = (base, index) else {
            return Err("an address is made of other registers".to_owned());
        };
        let index = index.wrapping_mul(u64::from(inst.memory_index_scale()));
        Ok(base.wrapping_add(index).wrapping_add(inst.memory_displacement64()))
    }
}
