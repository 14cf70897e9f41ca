//! From instructions to a function: prologue and epilogue, the bytes, and the constants after them.
//!
//! ```text
//! push rbx, rbp, r12 .. r15
//! rax = rsp
//! rsp -= frame, page by page          so that an overflow hits the guard page and nothing else
//! rsp &= -64;  [rsp] = rax
//! ...
//! rsp = [rsp]
//! pop r15 .. r12, rbp, rbx;  vzeroupper;  ret
//! ```

use super::encode::{Encoder, Shape};
use super::inst::{Inst, Integer};
use super::state::WalkState;

/// The frame begins at a multiple of this.
const ALIGNMENT: usize = 64;
/// What the system guards: touched one after the other.
const PAGE: usize = 4096;

/// Bytes of stack that the code takes, besides the registers that it saves.
pub(super) fn frame_bytes(state: &WalkState<'_>, slot_bytes: usize) -> usize {
    state.frame_bytes().next_multiple_of(ALIGNMENT) + slot_bytes + ALIGNMENT
}

/// The bytes of code and constants, and how many are code.
pub(super) fn assemble(mut state: WalkState<'_>, frame_bytes: usize, shape: Shape) -> (Vec<u8>, usize) {
    let slots = state.frame_bytes().next_multiple_of(ALIGNMENT);
    for &index in &state.slot_addresses {
        if let Inst::Integer(Integer::Address { of, .. }) = &mut state.code[index] {
            of.displacement = i32::try_from(slots).expect("frames are limited");
        }
    }
    let mut encoder = Encoder::new(shape, state.labels);
    prologue(&mut encoder.bytes, frame_bytes);
    for inst in &state.code {
        encoder.inst(inst);
    }
    epilogue(&mut encoder.bytes);
    let code_bytes = encoder.bytes.len();
    (encoder.finish(&state.constants), code_bytes)
}

fn prologue(bytes: &mut Vec<u8>, frame: usize) {
    // push rbx, rbp, r12, r13, r14, r15
    bytes.extend([0x53, 0x55, 0x41, 0x54, 0x41, 0x55, 0x41, 0x56, 0x41, 0x57]);
    bytes.extend([0x48, 0x89, 0xE0]); // mov rax, rsp
    let size = i32::try_from(frame).expect("frames are limited");
    if frame <= PAGE {
        bytes.extend([0x48, 0x81, 0xEC]); // sub rsp, size
        bytes.extend(size.to_le_bytes());
    } else {
        bytes.extend([0x4C, 0x8D, 0x8C, 0x24]); // lea r9, [rsp - size]
        bytes.extend((-size).to_le_bytes());
        let top = bytes.len();
        bytes.extend([0x48, 0x81, 0xEC]); // sub rsp, PAGE
        bytes.extend((PAGE as i32).to_le_bytes());
        bytes.extend([0x48, 0x83, 0x0C, 0x24, 0x00]); // or qword [rsp], 0
        bytes.extend([0x4C, 0x39, 0xCC]); // cmp rsp, r9
        let back = top as i64 - (bytes.len() as i64 + 2);
        bytes.extend([0x77, back as u8]); // ja top
        bytes.extend([0x4C, 0x89, 0xCC]); // mov rsp, r9
    }
    bytes.extend([0x48, 0x83, 0xE4, 0xC0]); // and rsp, -64
    bytes.extend([0x48, 0x89, 0x04, 0x24]); // mov [rsp], rax
}

fn epilogue(bytes: &mut Vec<u8>) {
    bytes.extend([0x48, 0x8B, 0x24, 0x24]); // mov rsp, [rsp]
    // pop r15, r14, r13, r12, rbp, rbx
    bytes.extend([0x41, 0x5F, 0x41, 0x5E, 0x41, 0x5D, 0x41, 0x5C, 0x5D, 0x5B]);
    bytes.extend([0xC5, 0xF8, 0x77]); // vzeroupper
    bytes.push(0xC3); // ret
}
