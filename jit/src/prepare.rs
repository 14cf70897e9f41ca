//! What all generators do before they begin: the limits that they share, and the pieces of a function.

use jbt_ir::limits::MAX_JIT_VALUES;
use jbt_ir::plan::Plan;
use jbt_ir::{Function, InstKind};

use crate::error::CompileError;
use crate::options::Pieces;

/// Instructions of a piece: its code fits what the processor keeps decoded, and what one block of points
/// waits for in it leaves room for the next block to begin. From 100 to 500 the speed is the same.
const PIECE: usize = 200;
/// Bytes of slots beyond which they are not in the nearer caches when the next piece reads them.
const MOST_SLOT_BYTES: usize = 256 << 10;

/// The pieces of a function. What is open is chosen: a function of at most so many values is whole.
pub(crate) fn plan(function: &Function, pieces: Option<Pieces>, whole_up_to: usize) -> Plan {
    let is_short = function.values.len() <= whole_up_to;
    let plan = match pieces.unwrap_or(if is_short { Pieces::One } else { Pieces::Of(PIECE) }) {
        Pieces::One => Plan::whole(function),
        Pieces::Of(longest) => Plan::cut(function, longest),
    };
    if plan.slot_bytes() > MOST_SLOT_BYTES { Plan::whole(function) } else { plan }
}

/// Looks for what is declined before anything is planned.
pub(crate) fn check(function: &Function) -> Result<(), CompileError> {
    let values = function.values.len();
    if values > MAX_JIT_VALUES {
        return Err(CompileError::Values { values, limit: MAX_JIT_VALUES });
    }
    for (inst, data) in function.insts.iter() {
        match data.kind {
            InstKind::Op { op, .. } if op.is_expanded() => return Err(CompileError::Op { op, inst }),
            InstKind::Op { .. }
            | InstKind::Input(_)
            | InstKind::Constant(_)
            | InstKind::BitsConstant(_)
            | InstKind::Column { .. }
            | InstKind::Fold(_) => {}
        }
    }
    Ok(())
}
