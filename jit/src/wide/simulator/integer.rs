//! Instructions on integers: addresses, counters, the stack.

use iced_x86::{Instruction, Mnemonic, OpKind, Register};

use super::machine::Machine;
use super::memory::Simulated;

impl Machine {
    pub(super) fn integer(&mut self, inst: &Instruction) -> Simulated {
        match inst.mnemonic() {
            Mnemonic::Push => {
                let number = self.operand(inst, 0)?;
                let top = self.get(Register::RSP) - 8;
                self.set(Register::RSP, top);
                self.memory.write(top, &number.to_le_bytes())
            }
            Mnemonic::Pop => {
                let number = self.pop()?;
                self.put(inst, number)
            }
            Mnemonic::Mov => {
                let number = self.operand(inst, 1)?;
                self.put(inst, number)
            }
            Mnemonic::Lea => {
                let address = self.address(inst)?;
                self.put(inst, address)
            }
            Mnemonic::Add => self.combine(inst, u64::wrapping_add),
            Mnemonic::Sub => self.combine(inst, u64::wrapping_sub),
            Mnemonic::And => self.combine(inst, |a, b| a & b),
            Mnemonic::Or => self.combine(inst, |a, b| a | b),
            Mnemonic::Xor => self.combine(inst, |a, b| a ^ b),
            Mnemonic::Imul => {
                let (a, b) = (self.operand(inst, 1)?, self.operand(inst, 2)?);
                self.put(inst, a.wrapping_mul(b))
            }
            Mnemonic::Cmp => {
                let (a, b) = (self.operand(inst, 0)?, self.operand(inst, 1)?);
                (self.equal, self.below) = (a == b, a < b);
                Ok(())
            }
            Mnemonic::Cmova => {
                // It reads its operand whatever the flags say.
                let number = self.operand(inst, 1)?;
                if self.below || self.equal { Ok(()) } else { self.put(inst, number) }
            }
            _ => Err("nobody emits this instruction".to_owned()),
        }
    }

    /// Takes an address or a register's number from the stack.
    pub(super) fn pop(&mut self) -> Simulated<u64> {
        let top = self.get(Register::RSP);
        let number = self.memory.read_pointer(top)?;
        self.set(Register::RSP, top + 8);
        Ok(number)
    }

    /// `first = first op second`. The flags that follow are read by nobody.
    fn combine(&mut self, inst: &Instruction, op: impl Fn(u64, u64) -> u64) -> Simulated {
        let (a, b) = (self.operand(inst, 0)?, self.operand(inst, 1)?);
        self.put(inst, op(a, b))
    }

    /// An operand, as 64 bits.
    fn operand(&self, inst: &Instruction, index: u32) -> Simulated<u64> {
        match inst.op_kind(index) {
            OpKind::Register => Ok(self.get(inst.op_register(index))),
            OpKind::Memory => match inst.memory_size().size() {
                4 => Ok(u64::from(self.memory.read_word(self.address(inst)?)?)),
                8 => self.memory.read_pointer(self.address(inst)?),
                bytes => Err(format!("an integer of {bytes} bytes")),
            },
            _ => Ok(inst.immediate(index)),
        }
    }

    /// Writes the first operand.
    fn put(&mut self, inst: &Instruction, number: u64) -> Simulated {
        match inst.op_kind(0) {
            OpKind::Register => self.set(inst.op_register(0), number),
            _ => self.memory.write(self.address(inst)?, &number.to_le_bytes())?,
        }
        Ok(())
    }
}
