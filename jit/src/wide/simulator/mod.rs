//! A CPU of our own: executes decoded wide code, instruction by instruction, at levels that this machine may
//! lack.
//!
//! ```text
//! code ──iced-x86──► instructions ──► Machine { integers, vectors, masks, flags, memory }
//!                                       step by step, until the code returns
//! ```
//!
//! It knows the few dozen instructions that we emit, and nothing else: an instruction that it does not know
//! is a fault. So is each byte that the code reads or writes outside of what it may touch ([`memory`]), a
//! jump into the middle of an instruction, a register that a callee has to keep and does not, and code that
//! never ends.

mod integer;
mod machine;
mod memory;
mod tests;
mod vector;

use iced_x86::Register;

use self::machine::{Machine, MachineFault};
use self::memory::{Call, SimulatedMemory};
use super::CodeBlob;

/// Runs a function; its output planes.
fn run(blob: &CodeBlob, call: &Call<'_>) -> Result<Vec<Vec<f32>>, MachineFault> {
    let (memory, layout) = SimulatedMemory::new(blob, call);
    let mut machine = Machine::new(memory);
    let bytes = (call.inputs.first().map_or(0, Vec::len) * size_of::<f32>()) as u64;
    for (register, number) in [
        (Register::RDI, layout.planes),
        (Register::RSI, bytes),
        (Register::RDX, layout.views),
        (Register::RSP, layout.stack),
    ] {
        machine.set(register, number);
    }
    machine.execute(&blob.bytes[..blob.code_bytes])?;
    Ok(machine.memory.outputs(&layout))
}
