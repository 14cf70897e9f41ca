//! Machine code for x86-64 in vectors of 256 and 512 bits, by an emitter of our own.
//!
//! ```text
//! Function, Plan ──► build ─────► lives ──────────► state, ops, loops ────► encode ──► bytes
//!                    a `Linear`   where values      one walk: registers     VEX, EVEX
//!                                 are used          and instructions
//! ```
//!
//! The code has the same ABI as Cranelift's code, see [`crate::entry`], and every op gives the same bits. It
//! is made in another way: one walk over a list, in time linear in the length of the list.
//!
//! * A *leaf* (a constant, a column, an input, a slot of a strip) is read from memory, as an operand of an
//!   instruction. With AVX-512 the operand may be a broadcast number. A leaf is loaded if it has another use
//!   soon and a register is free.
//! * A value that is the same in all lanes is one vector; any other value has as many vectors as the block.
//! * Registers are assigned during the walk. A loop's own need is counted beforehand, and the most valuable
//!   values from outside get the remaining registers.
//!
//! Emitting code needs no CPU that can run it.

mod assemble;
mod backend;
mod build;
mod check;
mod counters;
mod encode;
mod event;
mod frame;
mod inst;
mod linear;
#[cfg(any(feature = "listing", test))]
mod listing;
mod lives;
mod loops;
mod ops;
#[cfg(test)]
mod simulator;
mod state;
#[cfg(test)]
mod tests;
mod transfers;

use jbt_ir::pass::Gates;
use jbt_ir::plan::Plan;
use jbt_ir::plan::pressure::{self, FIELD_CARRIES};
use jbt_ir::{Entity, Function, Level, limits};

use self::build::list;
use self::check::Replay;
use self::encode::Shape;
use self::linear::{LinearCode, LinearItem};
use self::lives::Lives;
use self::state::{RegisterCount, WalkInput, WalkState};
use crate::blob::CodeBlob;
use crate::error::CompileError;
use crate::options::VectorCount;

pub use self::backend::Wide;

/// What is asked of the emitter.
#[derive(Clone, Copy, Debug)]
struct EmitterWish {
    level: Level,
    vectors: Option<VectorCount>,
    /// Replays the code, and fails if it is wrong; and gives it few registers if wanted.
    is_checked: bool,
    few_registers: bool,
}

/// Registers of a test that makes everything spill: vectors, masks.
const FEW: RegisterCount = RegisterCount([3, 1]);

/// The vectors and registers of a level.
const fn shape(level: Level) -> (Shape, RegisterCount) {
    match level {
        // Nobody emits for less than AVX2.
        Level::Baseline | Level::Avx2 => (Shape { bytes: 32, has_masks: false }, RegisterCount([16, 0])),
        Level::Avx512Vl => (Shape { bytes: 32, has_masks: true }, RegisterCount([32, 6])),
        Level::Avx512 => (Shape { bytes: 64, has_masks: true }, RegisterCount([32, 6])),
    }
}

/// Lanes of one vector of a level.
const fn lanes(level: Level) -> usize {
    shape(level).0.bytes / size_of::<f32>()
}

/// Emits a function in the pieces of a plan, which was made for it as the gates were.
///
/// # Errors
/// When the frame is too large; when it is checked and found wrong, which is a defect of the emitter.
fn emit(
    function: &Function,
    (plan, gates): (&Plan, &Gates),
    wish: &EmitterWish,
) -> Result<CodeBlob, CompileError> {
    let linear = list(function, plan, gates);
    let lives = Lives::new(&linear);
    let (shape, mut count) = shape(wish.level);
    if wish.few_registers {
        count = RegisterCount([FEW.0[0], if shape.has_masks { FEW.0[1] } else { 0 }]);
    }
    let mut vectors = match wish.vectors {
        // With this many vectors blocks have [`crate::Kernel::MAX_LANES`] points, at most.
        Some(VectorCount::Four) if shape.bytes == 64 => VectorCount::Two,
        Some(vectors) => vectors,
        None => unrolling(function, shape, plan),
    };
    loop {
        let (count_of, is_checked) = (vectors.count(), wish.is_checked);
        let tables = function.tables.values();
        let tables = tables.map(|schema| (4 * schema.columns.len(), schema.parent.map(Entity::index)));
        let mut state = WalkState::new(WalkInput {
            linear: &linear,
            lives: &lives,
            vectors: count_of,
            shape,
            count,
            planes: function.inputs.len(),
            strip_bytes: plan.strip_bytes(),
            tables: tables.collect(),
            is_checked,
        });
        walk(&mut state);
        check(&state, &linear, count_of, shape)?;
        let frame_bytes = assemble::frame_bytes(&state, plan.slot_bytes());
        if frame_bytes <= limits::MAX_JIT_FRAME_BYTES {
            let constants = state.constants.len();
            let (bytes, code_bytes) = assemble::assemble(state, frame_bytes, shape);
            let lanes = vectors.count() * shape.bytes / size_of::<f32>();
            return Ok(CodeBlob { bytes, code_bytes, constants, frame_bytes, lanes });
        }
        vectors = match vectors {
            VectorCount::Four if wish.vectors.is_none() => VectorCount::Two,
            VectorCount::Two if wish.vectors.is_none() => VectorCount::One,
            VectorCount::One | VectorCount::Two | VectorCount::Four => {
                let limit = limits::MAX_JIT_FRAME_BYTES;
                return Err(CompileError::Frame { bytes: frame_bytes, limit });
            }
        };
    }
}

/// Emits all items.
fn walk(state: &mut WalkState<'_>) {
    let (linear, lives) = (state.linear, state.lives);
    for (position, item) in (0..).zip(&linear.items) {
        state.position = position;
        jbt_ir::watch::look();
        match *item {
            LinearItem::Op { op, to, args } => state.op(op, to, args),
            LinearItem::Read { to, from } => state.read(to, from),
            LinearItem::Keep { slot, value } => state.keep(slot.0, value),
            LinearItem::Output { plane, value } => state.output(plane, value),
            LinearItem::Skip(id) => state.skip(id),
            LinearItem::Open(id) => state.open_loop(id),
            LinearItem::Close(id) => state.close_loop(id),
        }
        for index in lives.deaths(position) {
            state.end_life(lives.death(index));
        }
    }
}

/// Replays the code, if notes were taken.
fn check(
    state: &WalkState<'_>,
    linear: &LinearCode,
    vectors: usize,
    shape: Shape,
) -> Result<(), CompileError> {
    let Some(notes) = &state.notes else { return Ok(()) };
    let replay = Replay {
        linear,
        vectors: vectors as u32,
        vector_bytes: shape.bytes,
        has_masks: shape.has_masks,
        code: &state.code,
        notes,
        events: &state.events,
        constants: &state.constants,
    };
    replay.check().map_err(CompileError::Registers)
}

/// The number of vectors of a value. Two hide the latency of most instructions, and share the loads for a
/// row. Where loops carry few accumulators, four share more; the spills that this causes cost less than the
/// shared loads save.
fn unrolling(function: &Function, shape: Shape, plan: &Plan) -> VectorCount {
    let carried = pressure::carried_values(function);
    if carried <= FIELD_CARRIES {
        VectorCount::Four
    } else if shape.has_masks || !plan.is_whole() || VectorCount::Two.count() * carried <= 16 {
        VectorCount::Two
    } else {
        VectorCount::One
    }
}
