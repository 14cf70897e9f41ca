//! Instructions on vectors and masks, lane by lane.

use iced_x86::{Instruction, Mnemonic, OpKind, Register};

use super::machine::Machine;
use super::memory::Simulated;

/// The lanes of a vector; those that it does not have are 0.
type VectorLanes = [u32; 16];

/// How many lanes of 32 bits a register has.
fn lanes_of(register: Register) -> usize {
    register.size() / 4
}

/// Both operands and the result as numbers.
fn reals(a: u32, b: u32, op: impl Fn(f32, f32) -> f32) -> u32 {
    op(f32::from_bits(a), f32::from_bits(b)).to_bits()
}

impl Machine {
    pub(super) fn vector(&mut self, inst: &Instruction) -> Simulated {
        match inst.mnemonic() {
            Mnemonic::Vaddps => self.binary(inst, |a, b| reals(a, b, |a, b| a + b)),
            Mnemonic::Vsubps => self.binary(inst, |a, b| reals(a, b, |a, b| a - b)),
            Mnemonic::Vmulps => self.binary(inst, |a, b| reals(a, b, |a, b| a * b)),
            Mnemonic::Vdivps => self.binary(inst, |a, b| reals(a, b, |a, b| a / b)),
            Mnemonic::Vminps => self.binary(inst, |a, b| reals(a, b, |a, b| if a < b { a } else { b })),
            Mnemonic::Vmaxps => self.binary(inst, |a, b| reals(a, b, |a, b| if a > b { a } else { b })),
            Mnemonic::Vpand | Mnemonic::Vpandd => self.binary(inst, |a, b| a & b),
            Mnemonic::Vpor | Mnemonic::Vpord => self.binary(inst, |a, b| a | b),
            Mnemonic::Vpxor | Mnemonic::Vpxord => self.binary(inst, |a, b| a ^ b),
            Mnemonic::Vpaddd => self.binary(inst, u32::wrapping_add),
            Mnemonic::Vpsubd => self.binary(inst, u32::wrapping_sub),
            Mnemonic::Vpslld => self.shift(inst, |a, by| a << by),
            Mnemonic::Vpsrld => self.shift(inst, |a, by| a >> by),
            Mnemonic::Vsqrtps => {
                let a = self.lanes(inst, 1)?;
                self.put_lanes(inst, a.map(|a| f32::from_bits(a).sqrt().to_bits()))
            }
            Mnemonic::Vfmadd132ps => self.fma(inst, |[to, b, c]| (to, c, b)),
            Mnemonic::Vfmadd213ps => self.fma(inst, |[to, b, c]| (b, to, c)),
            Mnemonic::Vfmadd231ps => self.fma(inst, |[to, b, c]| (b, c, to)),
            Mnemonic::Vcmpps => self.compare(inst),
            Mnemonic::Vptest => {
                let (a, b) = (self.lanes(inst, 0)?, self.lanes(inst, 1)?);
                self.equal = a.iter().zip(b).all(|(a, b)| a & b == 0);
                Ok(())
            }
            Mnemonic::Vptestmd => {
                let (a, b) = (self.lanes(inst, 1)?, self.lanes(inst, 2)?);
                let bits = (0..16).map(|lane| u16::from(a[lane] & b[lane] != 0) << lane);
                self.masks[inst.op_register(0).number()] = bits.sum();
                Ok(())
            }
            Mnemonic::Kortestw => {
                let [a, b] = [0, 1].map(|op| self.masks[inst.op_register(op).number()]);
                self.equal = a | b == 0;
                Ok(())
            }
            Mnemonic::Vblendvps => {
                let mask = self.lanes(inst, 3)?;
                self.blend(inst, |lane| mask[lane] >> 31 == 1)
            }
            Mnemonic::Vblendmps => {
                let mask = self.masks[inst.op_mask().number()];
                if inst.op_mask() == Register::None {
                    return Err("a blend without a mask".to_owned());
                }
                self.blend(inst, |lane| mask >> lane & 1 == 1)
            }
            Mnemonic::Vmovaps | Mnemonic::Vmovups | Mnemonic::Vbroadcastss => self.copy(inst),
            Mnemonic::Vzeroupper => {
                self.vectors.iter_mut().for_each(|lanes| lanes[4..].fill(0));
                Ok(())
            }
            Mnemonic::Kandw | Mnemonic::Korw | Mnemonic::Knotw | Mnemonic::Kmovw => self.mask(inst),
            _ => Err("nobody emits this instruction".to_owned()),
        }
    }

    /// The lanes of an operand: of a vector register, of memory, or one number of memory in all of them.
    fn lanes(&self, inst: &Instruction, index: u32) -> Simulated<VectorLanes> {
        if inst.op_kind(index) == OpKind::Register {
            return Ok(self.vectors[inst.op_register(index).number()]);
        }
        let address = self.address(inst)?;
        if inst.is_broadcast() || inst.mnemonic() == Mnemonic::Vbroadcastss {
            return Ok([self.memory.read_word(address)?; 16]);
        }
        let mut lanes = [0; 16];
        let bytes = self.memory.read(address, inst.memory_size().size())?;
        for (lane, word) in lanes.iter_mut().zip(bytes.chunks_exact(4)) {
            *lane = u32::from_le_bytes(word.try_into().expect("a chunk has four bytes"));
        }
        Ok(lanes)
    }

    /// Writes the first operand, a vector register: lanes that it does not have become 0.
    fn put_lanes(&mut self, inst: &Instruction, mut lanes: VectorLanes) -> Simulated {
        let register = inst.op_register(0);
        lanes[lanes_of(register)..].fill(0);
        self.vectors[register.number()] = lanes;
        Ok(())
    }

    fn binary(&mut self, inst: &Instruction, op: impl Fn(u32, u32) -> u32) -> Simulated {
        let (a, b) = (self.lanes(inst, 1)?, self.lanes(inst, 2)?);
        self.put_lanes(inst, std::array::from_fn(|lane| op(a[lane], b[lane])))
    }

    fn shift(&mut self, inst: &Instruction, op: impl Fn(u32, u32) -> u32) -> Simulated {
        let (a, by) = (self.lanes(inst, 1)?, inst.immediate(2) as u32);
        self.put_lanes(inst, a.map(|a| if by < 32 { op(a, by) } else { 0 }))
    }

    /// `order` picks the factors and what is added of the three operands.
    fn fma(&mut self, inst: &Instruction, order: impl Fn([u32; 3]) -> (u32, u32, u32)) -> Simulated {
        let [a, b, c] = [self.lanes(inst, 0)?, self.lanes(inst, 1)?, self.lanes(inst, 2)?];
        let lane = |lane: usize| {
            let (a, b, c) = order([a[lane], b[lane], c[lane]]);
            f32::from_bits(a).mul_add(f32::from_bits(b), f32::from_bits(c)).to_bits()
        };
        self.put_lanes(inst, std::array::from_fn(lane))
    }

    /// To a mask register, or to lanes of all ones.
    fn compare(&mut self, inst: &Instruction) -> Simulated {
        let (a, b) = (self.lanes(inst, 1)?, self.lanes(inst, 2)?);
        let predicate = inst.immediate8();
        let holds = |lane: usize| {
            let (a, b) = (f32::from_bits(a[lane]), f32::from_bits(b[lane]));
            match predicate {
                0x00 => Ok(a == b),
                0x11 => Ok(a < b),
                0x12 => Ok(a <= b),
                0x1D => Ok(a >= b),
                0x1E => Ok(a > b),
                _ => Err(format!("nobody emits the comparison {predicate:x}")),
            }
        };
        let mut bits = 0_u16;
        for lane in 0..lanes_of(inst.op_register(1)) {
            bits |= u16::from(holds(lane)?) << lane;
        }
        let to = inst.op_register(0);
        if to.is_k() {
            self.masks[to.number()] = bits;
            return Ok(());
        }
        self.put_lanes(inst, std::array::from_fn(|lane| if bits >> lane & 1 == 1 { u32::MAX } else { 0 }))
    }

    /// The second operand where the mask is true, else the first one.
    fn blend(&mut self, inst: &Instruction, is_true: impl Fn(usize) -> bool) -> Simulated {
        let (no, yes) = (self.lanes(inst, 1)?, self.lanes(inst, 2)?);
        self.put_lanes(inst, std::array::from_fn(|lane| if is_true(lane) { yes[lane] } else { no[lane] }))
    }

    fn copy(&mut self, inst: &Instruction) -> Simulated {
        if inst.op_kind(0) == OpKind::Register {
            let lanes = self.lanes(inst, 1)?;
            return self.put_lanes(inst, lanes);
        }
        let from = inst.op_register(1);
        let lanes = self.vectors[from.number()];
        let bytes: Vec<u8> = lanes[..lanes_of(from)].iter().flat_map(|lane| lane.to_le_bytes()).collect();
        let address = self.address(inst)?;
        self.memory.write(address, &bytes)
    }

    /// Instructions on mask registers of 16 bits.
    fn mask(&mut self, inst: &Instruction) -> Simulated {
        let source = |machine: &Self, index: u32| -> Simulated<u16> {
            if inst.op_kind(index) == OpKind::Register {
                return Ok(machine.masks[inst.op_register(index).number()]);
            }
            let bytes = machine.memory.read(machine.address(inst)?, 2)?;
            Ok(u16::from_le_bytes(bytes.try_into().expect("two bytes were read")))
        };
        let bits = match inst.mnemonic() {
            Mnemonic::Kandw => source(self, 1)? & source(self, 2)?,
            Mnemonic::Korw => source(self, 1)? | source(self, 2)?,
            Mnemonic::Knotw => !source(self, 1)?,
            _ => source(self, 1)?,
        };
        if inst.op_kind(0) == OpKind::Register {
            self.masks[inst.op_register(0).number()] = bits;
            return Ok(());
        }
        let address = self.address(inst)?;
        self.memory.write(address, &bits.to_le_bytes())
    }
}
