//! The list of generators of machine code.

use jbt_ir::Level;
use jbt_ir::engine::Backend;

use crate::cranelift::Cranelift;
use crate::wide::Wide;

/// All generators, from the general to the special: the last one that covers a level makes its code
/// ([`jbt_ir::engine::choose`]).
pub const BACKENDS: &[&dyn Backend] = &[&Cranelift::STANDARD, &Wide::STANDARD];

/// All generators with the levels whose code this CPU runs.
#[must_use]
pub fn available() -> Vec<(&'static dyn Backend, Level)> {
    let levels = |&backend: &&'static dyn Backend| Level::ALL.map(|level| (backend, level));
    let runs = |(backend, level): &(&'static dyn Backend, Level)| {
        backend.covers(*level) && backend.supports(*level).is_ok()
    };
    BACKENDS.iter().flat_map(levels).filter(runs).collect()
}
